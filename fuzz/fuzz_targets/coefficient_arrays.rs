//! Fuzz target: damaged arrays of a file of wavelet coefficients are read, then decoded.

#![no_main]

#[path = "../../crates/wavelet/tests/damage/mod.rs"]
mod damage;

use damage::{Bytes, check, damaged};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let mut bytes = Bytes(data);
    let arrays = damaged(&mut bytes);
    check(&arrays, &mut bytes);
});
