//! Writes the files that other parts have of the tables of documents: `make schema`.

use wavesplat_document::{scene_schema, written};

/// Each file, from the root of the repository, and its text.
pub fn files() -> [(String, String); 1] {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    [(format!("{root}/python/wavesplat/_scene/documents/scene.schema.json"), written(&scene_schema(), 0) + "\n")]
}

fn main() -> std::io::Result<()> {
    files().into_iter().try_for_each(|(path, text)| std::fs::write(path, text))
}
