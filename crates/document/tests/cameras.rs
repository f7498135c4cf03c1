//! Cameras as documents: what is read, and words for what is wrong.

use serde_json::{Value, json};
use wavesplat_document::{CameraDocument, LensField, optional_number};

fn camera(change: &Value) -> Value {
    let mut camera = json!({"version": 1, "position": [0, 500, 0.5], "focal_point": [0, 0, 0], "view_up": [0, 0, 1]});
    for (name, value) in change.as_object().unwrap() {
        camera[name] = value.clone();
    }
    camera
}

#[test]
fn a_camera_is_read() {
    let read = CameraDocument::read(&&camera(&json!({"parallel_scale": 120, "view_angle": null}))).unwrap();
    assert_eq!(read.position, [0.0, 500.0, 0.5]);
    assert_eq!(read.lens, LensField::ParallelScale(120.0));
}

#[test]
fn errors_name_the_field() {
    for (change, message) in [
        (json!({"version": 1.0}), "field 'version' is 1.0; this release reads version 1"),
        (json!({"position": [1, 2]}), "field 'position' is a list; it must be three numbers, [x, y, z]"),
        (json!({"view_up": [0, 0, 1.1e30]}), "field 'view_up' is a list; it must be three numbers, [x, y, z]"),
        (json!({"focal_point": null}), "field 'focal_point' is null; it must be three numbers, [x, y, z]"),
        (json!({"view_angle": true}), "field 'view_angle' is true; it must be a number or null"),
        (json!({"view_angle": null}), "give one of the fields 'parallel_scale' and 'view_angle'"),
        (
            json!({"view_angle": 30, "z'\n": 1, "z ü": 0}),
            "unknown field 'z ü'; the fields are focal_point, parallel_scale, position, version, view_angle, view_up",
        ),
        (
            json!({"z'\n": 1}),
            "unknown field \"z'\\n\"; the fields are focal_point, parallel_scale, position, version, view_angle, view_up",
        ),
    ] {
        let error = CameraDocument::read(&&camera(&change)).unwrap_err();
        assert_eq!(error.to_string(), format!("camera: {message}"));
    }
}

#[test]
fn what_is_no_object_lacks_all_fields() {
    for value in [json!(null), json!([1]), json!("version")] {
        let error = CameraDocument::read(&&value).unwrap_err();
        assert_eq!(error.to_string(), "camera: field 'version' is missing; see Camera.as_json for the form");
        assert_eq!(optional_number(&&value, "camera", "version"), Ok(None));
    }
}
