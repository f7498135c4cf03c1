//! The module's twin: the same calls, answered by this processor. `web/wasm` compares the two, `benches/wasm.py` their
//! times.
//!
//! A call is a line of JSON: `{"new": true}`, `{"open": NAME, "hex": BYTES}` or `{"open": NAME, "path": FILE}`,
//! `{"samples": HEAD, "path": FILE}`, `{"ask": QUESTION, "asked": {...}}`. The answer is one too: `text` or `error`, or
//! `crc32` of an answer in numbers, which `"save": FILE` keeps; and `ms` of processor time, where the system tells it. The
//! first argument names the vectors to use.

use std::io::{BufRead, Write};

use flate2::Crc;
use serde_json::{Value, json};
use wavesplat_wasm::opened::OpenedVolume;
use wavesplat_wasm::questions::{Answer, answer};

/// Questions whose answers are numbers.
const OF_NUMBERS: [&str; 4] = ["samples", "draw", "floats", "slice"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(vectors) = std::env::args().nth(1) {
        wavesplat::use_simd(&vectors)?;
    }
    let mut opened = None;
    for line in std::io::stdin().lock().lines() {
        let call: Value = serde_json::from_str(&line?)?;
        let bytes = match (call["path"].as_str(), call["hex"].as_str()) {
            (Some(path), _) => std::fs::read(path)?,
            (None, hex) => bytes_of(hex.unwrap_or_default())?,
        };
        let before = processor_ms();
        let found = answered(&mut opened, &call, bytes);
        let ms = processor_ms() - before;
        let told = match found {
            Err(error) => json!({"error": error, "ms": ms}),
            Ok(numbers) if OF_NUMBERS.iter().any(|question| call["ask"] == *question) => {
                let mut crc = Crc::new();
                crc.update(numbers.bytes());
                if let Some(file) = call["save"].as_str() {
                    std::fs::write(file, numbers.bytes())?;
                }
                json!({"crc32": crc.sum(), "ms": ms})
            }
            Ok(text) => json!({"text": String::from_utf8_lossy(text.bytes()), "ms": ms}),
        };
        writeln!(std::io::stdout(), "{told}")?;
    }
    Ok(())
}

/// The answer to a call, as the functions of the module give it.
fn answered(opened: &mut Option<OpenedVolume>, call: &Value, bytes: Vec<u8>) -> Result<Answer, String> {
    if let Some(question) = call["ask"].as_str() {
        return answer(opened, question, call["asked"].to_string().as_bytes());
    }
    *opened = None;
    if call["new"] == true {
        return Ok(Answer::text(&Value::Null));
    }
    let volume = match call["open"].as_str() {
        Some(name) => OpenedVolume::read(name, &bytes)?,
        None => OpenedVolume::of_samples(&call["samples"], bytes)?,
    };
    Ok(Answer::text(&opened.insert(volume).described()))
}

fn bytes_of(hex: &str) -> Result<Vec<u8>, std::num::ParseIntError> {
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16)).collect()
}

/// Processor time of this thread, the only one; 0 where the system does not tell it.
fn processor_ms() -> f64 {
    // Linux counts up to the last tick or change of threads; this is one.
    std::thread::yield_now();
    let spent = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    spent.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) / 1e6
}
