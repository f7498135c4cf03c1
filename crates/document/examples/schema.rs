//! Writes the files that other parts have of the tables of documents: `make schema`.
//!
//! With a number it writes that many random cases instead of those that the tests of the page keep.

use serde_json::Value;
use wavesplat_document::{scene_schema, state_types, written};

#[path = "../tests/cases/mod.rs"]
mod cases;

/// Cases that are kept.
const N: usize = 300;

/// Each file, from the root of the repository, and its text.
pub fn files(n: usize) -> [(String, String); 3] {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let state: Value = include_str!("../../../web/schema/state.json").parse().unwrap_or_default();
    let lines: Vec<String> = cases::cases(&state, n).iter().map(Value::to_string).collect();
    [
        (format!("{root}/python/wavesplat/_scene/documents/scene.schema.json"), written(&scene_schema(), 0) + "\n"),
        (format!("{root}/web/src/state/document.generated.ts"), state_types()),
        (format!("{root}/web/schema/random.jsonl"), lines.join("\n") + "\n"),
    ]
}

fn main() -> std::io::Result<()> {
    let n = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(N);
    files(n).into_iter().try_for_each(|(path, text)| std::fs::write(path, text))
}
