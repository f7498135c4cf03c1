//! Volumes of small files are those that Python's readers find: size, type, samples, affine and facts.
//!
//! `cases.jsonl` has the files and what Python found; `python/tests/shared/file_cases.py` writes it.

use flate2::Crc;
use serde_json::{Value, json};
use wavesplat_core::Samples;
use wavesplat_files::{FileVolume, read};

/// The cases: name, bytes, and what is expected.
fn cases() -> Vec<(String, Vec<u8>, Value)> {
    let lines = include_str!("cases.jsonl").lines();
    let case = |line| {
        let case: Value = serde_json::from_str(line).unwrap();
        let text = case["bytes"].as_str().unwrap();
        let bytes = (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect();
        (case["file"].as_str().unwrap().to_owned(), bytes, case)
    };
    lines.map(case).collect()
}

/// A ramp of numbers, as the file beside a header has it.
fn other(name: &str) -> Result<Vec<u8>, String> {
    let samples = (0_i16..24).flat_map(|number| (number * 7 - 20).to_le_bytes());
    if name == "detached.raw" { Ok(samples.collect()) } else { Err("there is none".to_owned()) }
}

/// Type and checksum of the samples, as little-endian bytes.
fn described(volume: &FileVolume) -> (&'static str, u32) {
    macro_rules! bytes {
        ($name:literal, $samples:expr) => {
            ($name, $samples.iter().flat_map(|sample| sample.to_le_bytes()).collect::<Vec<u8>>())
        };
    }
    let (name, bytes) = match volume.samples() {
        Samples::U8(s) => bytes!("uint8", s),
        Samples::I8(s) => bytes!("int8", s),
        Samples::U16(s) => bytes!("uint16", s),
        Samples::I16(s) => bytes!("int16", s),
        Samples::U32(s) => bytes!("uint32", s),
        Samples::I32(s) => bytes!("int32", s),
        Samples::F32(s) => bytes!("float32", s),
        Samples::F64(s) => bytes!("float64", s),
    };
    let mut crc = Crc::new();
    crc.update(&bytes);
    (name, crc.sum())
}

#[test]
fn volumes_are_those_of_python() {
    let mut n_read = 0;
    for (name, bytes, expected) in cases() {
        let found = read(&name, &bytes, other);
        if let Some(word) = expected["refused"].as_str() {
            let error = found.expect_err(&name).to_string();
            assert!(error.contains(word) && error.ends_with(&name), "{name}: {error}");
            continue;
        }
        let volume = found.unwrap_or_else(|error| panic!("{error}"));
        n_read += 1;
        assert_eq!(json!(volume.size), expected["size"], "{name}");
        let (sample_type, crc) = described(&volume);
        assert_eq!((json!(sample_type), json!(crc)), (expected["type"].clone(), expected["crc32"].clone()), "{name}");
        let facts = &volume.facts;
        let facts = json!({
            "unit": facts.unit,
            "is_anatomical": facts.is_anatomical,
            "modality": facts.modality,
            "value_unit": facts.value_unit,
            "quantity": facts.quantity,
            "conventions": facts.conventions,
            "guesses": facts.guesses,
        });
        assert_eq!(facts, expected["facts"], "{name}");
        let affine = volume.world_from_index.to_cols_array_2d();
        let largest = affine[..3].as_flattened().iter().fold(0.0_f64, |most, number| most.max(number.abs()));
        // Rotations of quaternions are calculated with more digits there.
        let is_rotated = name.contains("qform") || name == "second.nii";
        let off = if is_rotated { 4.0 * f64::EPSILON * largest } else { 0.0 };
        for (row, column) in (0..12).map(|at| (at / 4, at % 4)) {
            let (ours, theirs) = (affine[column][row], expected["affine"][row][column].as_f64().unwrap());
            assert!((ours - theirs).abs() <= off, "{name}: {ours} is not {theirs}, row {row}, column {column}");
        }
    }
    assert!(n_read > 40);
}

/// Every file cut at every length, and with every byte of its header changed, is read or refused, without a panic.
#[test]
fn damaged_files_are_refused_or_read() {
    for (name, bytes, _) in cases() {
        for end in 0..bytes.len() {
            let _ = read(&name, &bytes[..end], other);
        }
        for at in 0..bytes.len().min(400) {
            for value in [0, 0x7f, 0x80, 0xff, bytes[at].wrapping_add(1), b'9', b'-', b' '] {
                let mut changed = bytes.clone();
                changed[at] = value;
                if let Ok(volume) = read(&name, &changed, other) {
                    let _ = volume.volume();
                }
            }
        }
    }
}
