//! Patches of documents: the fixtures that the page keeps to as well, and random ones.

use serde_json::{Value, json};
use wavesplat_document::{check_view, patched};

#[test]
fn patches_change_what_they_name() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/schema/patches.json");
    let Ok(text) = std::fs::read_to_string(path) else { return }; // not in the published crate
    let fixtures: Value = serde_json::from_str(&text).unwrap();
    for case in fixtures["good"].as_array().unwrap() {
        assert_eq!(patched(&case["before"], &case["operations"]).unwrap(), case["after"]);
    }
    for case in fixtures["bad"].as_array().unwrap() {
        let error = patched(&case["before"], &case["operations"]).unwrap_err().to_string();
        assert!(error.starts_with("patch: operations[0]"), "{error}");
    }
}

#[test]
fn errors_name_operation_and_path() {
    let document = json!({"a": [1, {"é\u{200b}": 2}]});
    for (operation, message) in [
        (json!(3), " is 3; it must be an object"),
        (json!({"op": "move"}), ": field 'op' is \"move\"; use add, replace or remove"),
        (json!({"op": "add", "path": "/b"}), ": field 'value' is missing"),
        (json!({"op": "remove", "path": "/b", "to": 1}), ": unknown field 'to'; the fields are op, path and value"),
        (json!({"op": "remove", "path": "b"}), ": field 'path' is \"b\"; it must be '' or begin with '/'"),
        (json!({"op": "remove", "path": ""}), ": '': the whole document cannot be removed"),
        (json!({"op": "remove", "path": "/b"}), ": '/b': there is no field 'b'"),
        (json!({"op": "remove", "path": "/a/01"}), ": '/a/01': '01' is no place in a list"),
        (json!({"op": "add", "path": "/a/3", "value": 1}), ": '/a/3': the list has 2 items, so there is none at 3"),
        (
            json!({"op": "remove", "path": "/a/1/é\u{200b}/b'"}),
            ": \"/a/1/é\\u200b/b'\": before \"b'\" stands 2, which has no fields",
        ),
    ] {
        let error = patched(&document, &json!([operation])).unwrap_err();
        assert_eq!(error.to_string(), format!("patch: operations[0]{message}"));
    }
    let error = patched(&document, &json!("add")).unwrap_err();
    assert_eq!(error.to_string(), "patch: the operations are \"add\"; give a list of objects");
}

fn view() -> Value {
    json!({
        "layout": {"name": "one-and-three", "main": "3d"},
        "slices": {"crosshair": [0, 0, 0], "window": [40, 400], "thickness": 0, "zoom": 1, "normals": {"z": [0, 0, 1]}},
        "measures": [{"kind": "area", "points": [[0, 0, 0], [10, 0, 0], [1, 2, 3]]}],
        "overlays": {"legend": false},
        "interface": {"panels": ["presets"]},
    })
}

#[test]
fn errors_of_views_name_the_field() {
    for (path, value, message) in [
        ("/layout/main", json!("w"), ".layout.main is \"w\"; use one of: 3d, z, y, x"),
        ("/slices/window", json!([40, 0]), ".slices.window is [40,0]; it must be [level, width]"),
        ("/slices/thickness", json!(-1), ".slices.thickness is -1; it must be 0 or a length"),
        ("/slices/zoom", json!(null), ".slices.zoom is null; it must be a number, 0.01 to 1000"),
        ("/slices/normals/z", json!([0, 0, -0.0]), ".slices.normals.z is zero; a normal has a direction"),
        ("/measures/0/kind", json!("angel"), ".measures[0].kind is \"angel\"; use one of: distance, angle, area"),
        ("/measures/0/kind", json!("angle"), ""),
        ("/measures/0/kind", json!("distance"), ".measures[0].points is a list; it must be a list of 2 points"),
        ("/overlays/legend", json!(1), ".overlays.legend is 1; it must be true or false"),
        ("/interface/panels/0", json!(1), ".interface.panels[0] is 1; it must be a name"),
        ("/quality", json!([]), ".quality is a list; it must be an object"),
        ("/quality", json!({"still": 1}), ".quality: unknown field 'still'; the fields are moving"),
    ] {
        let changed = patched(&view(), &json!([{"op": "add", "path": path, "value": value}])).unwrap();
        let expected = if message.is_empty() { Ok(()) } else { Err(format!("scene: view{message}")) };
        assert_eq!(check_view(&&changed).map_err(|error| error.to_string()), expected);
    }
}

/// Ten thousand random patches: none panics, a refused one names its operation, and a field that was added can be
/// taken out again.
#[test]
fn random_patches_are_done_or_refused() {
    let mut state = 1_u64;
    let mut below = move |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % n
    };
    let values =
        [json!(null), json!(-1), json!(1e30), json!("z"), json!([]), json!([0, 0, 1]), json!({"a": {}}), view()];
    let steps = ["slices", "normals", "z", "measures", "0", "points", "1", "-", "a~1b", "", "é", "layout", "name"];
    let mut document = view();
    let (mut done, mut valid) = (0, 0);
    for _ in 0..10_000 {
        let path = (0..below(5)).fold(String::new(), |path, _| path + "/" + steps[below(steps.len())]);
        let kind = ["add", "replace", "remove"][below(3)];
        let operation = json!({"op": kind, "path": path, "value": values[below(values.len())]});
        match patched(&document, &json!([operation])) {
            Err(error) => assert!(error.to_string().starts_with("patch: operations[0]: "), "{error}"),
            Ok(changed) => {
                done += 1;
                match check_view(&&changed) {
                    Ok(()) => valid += 1,
                    Err(error) => assert!(error.to_string().starts_with("scene: view"), "{error}"),
                }
                let is_new = changed.is_object() && path.matches('/').count() == 1 && document.pointer(&path).is_none();
                if kind == "add" && is_new {
                    assert_eq!(patched(&changed, &json!([{"op": "remove", "path": path}])).unwrap(), document);
                }
                document = if changed.is_object() && below(20) > 0 { changed } else { view() };
            }
        }
    }
    assert!(done > 1000 && valid > 50, "{done} {valid}");
}
