//! Kinds of data of small files, and cameras around what a preset shows, are those that Python finds.
//!
//! The cases are those of the crate `files`; `python/tests/shared/file_cases.py` writes them.

use serde_json::Value;
use wavesplat::glam::DVec3;
use wavesplat::look::Look;
use wavesplat::{Camera, PlacedCamera, Projection, Scene, files, kind_of};

#[test]
fn kinds_and_cameras_are_those_of_python() {
    let mut kinds = Vec::new();
    for line in include_str!("../../files/tests/cases.jsonl").lines() {
        let case: Value = serde_json::from_str(line).unwrap();
        let name = case["file"].as_str().unwrap();
        if case.get("kind").is_none() || name == "detached.nhdr" {
            continue;
        }
        let text = case["bytes"].as_str().unwrap();
        let bytes: Vec<u8> =
            (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect();
        let file = files::read(name, &bytes, |_| Err(String::new())).unwrap();
        let volume = file.volume().unwrap();
        let found = kind_of(&volume, &file.facts);
        assert_eq!([found.kind.name(), &found.reason], [&case["kind"][0], &case["kind"][1]], "{name}");
        kinds.push(found.kind.name());

        let numbers: Vec<f64> = case["camera"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
        let [position, focal_point] = [0, 3].map(|at| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]));
        let scene = Scene::with_look(volume, &Look::preset("ct-bone").unwrap());
        let camera = Camera::fit(&scene, &file.facts, 1.0).unwrap();
        let Projection::Orthographic { parallel_scale } = camera.projection() else { panic!("{name}") };
        let largest = position.abs().max_element();
        assert!((camera.position() - position).length() < 1e-12 * largest, "{name}: {}", camera.position());
        assert!((parallel_scale / numbers[9] - 1.0).abs() < 1e-12, "{name}: {parallel_scale}");
        let ahead = camera.ray(32.0, 32.0, 64, 64).direction.normalize();
        assert!((ahead - (focal_point - position).normalize()).length() < 1e-12, "{name}: {ahead}");
    }
    for kind in ["CT", "MR", "mask", "field", "signed field", "scan", "EM"] {
        assert!(kinds.contains(&kind), "{kind}");
    }
}
