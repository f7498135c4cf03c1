//! Fuzz target: JSON documents are read, checked and patched without a panic, and errors say where.

#![no_main]

use serde_json::Value;
use wavesplat_document::{
    CameraDocument, CurvesDocument, LookDocument, MaterialsDocument, TableDocument, check_document, check_view, patched,
};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let mut texts = data.split(|byte| *byte == b'\n').map(serde_json::from_slice::<Value>);
    let (Some(Ok(document)), operations) = (texts.next(), texts.next()) else { return };
    let changed = match operations {
        Some(Ok(operations)) => patched(&document, &operations),
        _ => Ok(document),
    };
    let document = match changed {
        Ok(document) => document,
        Err(error) => return assert!(error.to_string().starts_with("patch: ")),
    };
    let node = &&document;
    let found = [
        ("camera", CameraDocument::read(node).err()),
        ("scene: view", check_view(node).err()),
        ("scene", check_document(node, "scene").err()),
        ("scene", check_document(node, "state").err()),
        ("transfer function", CurvesDocument::read(node, false).err()),
        ("two-dimensional transfer function", TableDocument::read(node).err()),
        ("look", LookDocument::read(node).err()),
        ("materials", MaterialsDocument::read(node).err()),
    ];
    for (name, error) in found {
        assert!(error.is_none_or(|error| error.to_string().starts_with(name)));
    }
});
