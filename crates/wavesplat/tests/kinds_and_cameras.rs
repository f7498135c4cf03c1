//! Kinds of data of small files, cameras around what a preset shows, and automatic looks, are those that Python finds.
//!
//! The cases are those of the crate `files`; `python/tests/shared/file_cases.py` writes them.

use serde_json::Value;
use wavesplat::glam::DVec3;
use wavesplat::look::Look;
use wavesplat::{AutoLook, Camera, Composite, PlacedCamera, Projection, Scene, cut_open, files, kind_of};

/// The small files with what Python found in them.
fn cases() -> Vec<(Value, files::FileVolume)> {
    let lines = include_str!("../../files/tests/cases.jsonl").lines().map(|line| serde_json::from_str(line).unwrap());
    let are_whole = lines.filter(|case: &Value| case.get("kind").is_some() && case["file"] != "detached.nhdr");
    are_whole
        .map(|case| {
            let text = case["bytes"].as_str().unwrap();
            let bytes: Vec<u8> =
                (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect();
            let file = files::read(case["file"].as_str().unwrap(), &bytes, |_| Err(String::new())).unwrap();
            (case, file)
        })
        .collect()
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect()
}

#[test]
fn kinds_and_cameras_are_those_of_python() {
    let mut kinds = Vec::new();
    for (case, file) in cases() {
        let name = case["file"].as_str().unwrap();
        let volume = file.volume().unwrap();
        let found = kind_of(&volume, &file.facts);
        assert_eq!([found.kind.name(), &found.reason], [&case["kind"][0], &case["kind"][1]], "{name}");
        kinds.push(found.kind.name());

        let numbers = numbers(&case["camera"]);
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

/// The number of nodes, and of each column the sum of its numbers times their places, 1 for the first node.
fn summed<const N: usize>(nodes: &[[f64; N]]) -> Vec<f64> {
    let sum = |column: usize| nodes.iter().zip(1..).map(|(node, place)| node[column] * f64::from(place)).sum();
    std::iter::once(nodes.len() as f64).chain((0..N).map(sum)).collect()
}

#[test]
fn automatic_looks_are_those_of_python() {
    let mut kinds = Vec::new();
    for (case, file) in cases() {
        let (name, wanted) = (case["file"].as_str().unwrap(), &case["look"]);
        let volume = file.volume().unwrap();
        if wanted.is_null() {
            assert!(Look::auto(&volume, &file.facts).is_err(), "{name}");
            continue;
        }
        if wanted == "labels" {
            continue; // whose numbers Python draws one by one
        }
        let look = Look::auto(&volume, &file.facts).unwrap();
        let words = [
            Value::from(if look.composite == Composite::Over { "over" } else { "maximum" }),
            look.background.map_or(Value::Null, |_| "white".into()),
            look.view.map_or(Value::Null, Value::from),
            if look.is_cut_open { "cut open".into() } else { Value::Null },
            look.reason.clone().into(),
        ];
        assert_eq!(wanted["words"], Value::from(words.to_vec()), "{name}");
        let light = look.shading.as_ref().map(|light| vec![light.specular, light.ambient_occlusion]);
        let near = |found: &[f64], wanted: &Value| {
            let wanted = numbers(wanted);
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 2e-9 * b.abs().max(1e-12);
            assert!(
                found.len() == wanted.len() && found.iter().zip(&wanted).all(is_near),
                "{name}: {found:?} {wanted:?}"
            );
        };
        match light {
            Some(light) => assert!(light.iter().zip(numbers(&wanted["light"])).all(|(a, b)| *a == b as f32), "{name}"),
            None => assert!(wanted["light"].is_null(), "{name}"),
        }
        assert_eq!(look.transfer_function.opacity_unit(), wanted["unit"].as_f64(), "{name}");
        let opacity: Vec<_> =
            look.transfer_function.opacity_nodes().iter().map(|node| [node.value, node.opacity]).collect();
        near(&summed(&opacity), &wanted["opacity"]);
        let color = look.transfer_function.color_nodes().iter();
        near(
            &summed(&color.map(|node| [node.value, node.rgb[0], node.rgb[1], node.rgb[2]]).collect::<Vec<_>>()),
            &wanted["color"],
        );

        let drawn = if look.is_cut_open { cut_open(&volume, &file.facts, look.view).unwrap() } else { file.clone() };
        let scene = Scene::with_look(drawn.volume().unwrap(), &look);
        let camera = Camera::fit_for(&scene, &file.facts, &look, 1.0).unwrap();
        let Projection::Orthographic { parallel_scale } = camera.projection() else { panic!("{name}") };
        let wanted = numbers(&wanted["camera"]);
        let away = camera.position() - DVec3::new(wanted[0], wanted[1], wanted[2]);
        assert!(away.length() < 1e-8 * camera.position().length(), "{name}: {} {wanted:?}", camera.position());
        assert!((parallel_scale / wanted[3] - 1.0).abs() < 1e-8, "{name}: {parallel_scale}");
        kinds.push(kind_of(&volume, &file.facts).kind.name());
    }
    for kind in [
        "CT",
        "MR",
        "PET",
        "fluorescence",
        "ultrasound",
        "dose",
        "p-values",
        "probability",
        "mask",
        "field",
        "signed field",
        "EM",
    ] {
        assert!(kinds.contains(&kind), "{kind}: {kinds:?}");
    }
}
