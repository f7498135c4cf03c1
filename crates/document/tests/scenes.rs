//! Scenes as documents: words for what is wrong in their parts.

use serde_json::{Value, json};
use wavesplat_document::{check_part, check_state, fields_of_part, list_in, only_field};

#[test]
fn errors_name_the_field() {
    let layer = |value| check_part(&&value, "scene: layers[1]", "layer").map_err(|error| error.to_string());
    assert_eq!(layer(json!({"volume": {}, "opacity": 1})), Ok(()));
    assert_eq!(layer(json!([])), Err("scene: layers[1] is a list; it must be an object".to_owned()));
    assert_eq!(layer(json!({"name": "a"})), Err("scene: layers[1]: field 'volume' is missing".to_owned()));
    let fields = "color_from, look, name, opacity, time, visible, volume";
    let unknown = format!("scene: layers[1]: unknown field 'a'; the fields are {fields}");
    assert_eq!(layer(json!({"volume": {}, "a": 1})), Err(unknown));
    assert_eq!(fields_of_part("layer").unwrap().0.len(), 7);

    let error = list_in(&&json!({"clip": {}}), "clip").unwrap_err();
    assert_eq!(error.to_string(), "scene: field 'clip' is an object; it must be a list");
    assert_eq!(list_in(&&json!({}), "clip"), Ok(Vec::new()));
}

#[test]
fn kinds_are_named_by_the_only_field() {
    let clip = json!({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}});
    let (kind, plane) = only_field(&&clip, "scene: clip[0]", "clip").unwrap();
    assert_eq!((kind.as_str(), check_part(&plane, "plane", &kind)), ("plane", Ok(())));
    for (value, found) in
        [(json!({"plane": {}, "keep": {}}), "an object"), (json!({"ball": 1}), "an object"), (json!(3), "3")]
    {
        let error = only_field(&&value, "scene: clip[0]", "clip").unwrap_err();
        let wanted = "it must be an object of one field: keep, plane, cut_out";
        assert_eq!(error.to_string(), format!("scene: clip[0] is {found}; {wanted}"));
    }
}

fn message(state: &Value) -> String {
    check_state(&state).unwrap_err().to_string()
}

#[test]
fn states_have_all_fields() {
    let mut state = json!({"wavesplat": "scene", "version": 1});
    assert_eq!(message(&state), "scene: field 'layers' is missing");
    for name in ["layers", "labels", "shading", "clip", "background", "geometry", "camera", "render", "view"] {
        state[name] = json!(null);
    }
    assert_eq!(check_state(&&state), Ok(()));
    state["version"] = json!(2);
    assert_eq!(message(&state), "scene: field 'version' is 2; this release reads version 1");
}
