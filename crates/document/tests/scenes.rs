//! Scenes as documents: words for what is wrong in their parts.

use serde_json::{Value, json};
use wavesplat_document::{check_part, check_state, fields_of_part};

/// The fault of a value of a part, in words.
fn told(part: &str, value: &Value) -> String {
    check_part(&value, "scene: here", part).map_or_else(|error| error.to_string(), |()| "right".to_owned())
}

#[test]
fn errors_name_the_field() {
    let layer = |value| told("layer", &value);
    assert_eq!(layer(json!({"volume": {"path": "a"}, "opacity": 1})), "right");
    assert_eq!(layer(json!([])), "scene: here is a list; it must be an object");
    assert_eq!(layer(json!({"name": "a"})), "scene: here: field 'volume' is missing");
    let fields = "color_from, look, name, opacity, time, visible, volume";
    assert_eq!(
        layer(json!({"volume": {}, "a": 1})),
        format!("scene: here: unknown field 'a'; the fields are {fields}")
    );
    assert_eq!(fields_of_part("layer")[0].len(), 7);
    assert_eq!(layer(json!({"volume": {"n": 1}})), "scene: here.volume: field 'path' is missing");
    let step = json!({"path": "a", "then": [{"smoothed": {}}, {"level": 3}]});
    assert_eq!(layer(json!({"volume": step})), "scene: here.volume.then[1].level is 3; it must be an object");
    let words = "scene: here: field 'opacity' is 1.5; it must be a number, 0 to 1";
    assert_eq!(layer(json!({"volume": {"path": "a"}, "opacity": 1.5})), words);
    let look = json!({"volume": {"path": "a"}, "look": {"map": "hot", "window": [1, 2, 3]}});
    assert_eq!(layer(look), "scene: here.look: field 'window' is [1,2,3]; it must be [low, high]");
}

#[test]
fn kinds_are_named_by_the_only_field() {
    let clips = |clips: Value| json!({"wavesplat": "scene", "version": 1, "layers": [{"volume": {"path": "a"}}], "clip": clips});
    let told = |clip: Value| {
        let scene = clips(json!([clip]));
        check_part(&&scene, "scene", "scene").map_or_else(|error| error.to_string(), |()| "right".to_owned())
    };
    assert_eq!(told(json!({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}})), "right");
    for (value, found) in
        [(json!({"plane": {}, "keep": {}}), "an object"), (json!({"ball": 1}), "an object"), (json!(3), "3")]
    {
        let wanted = "it must be an object of one field: keep, plane, cut_out";
        assert_eq!(told(value), format!("scene: clip[0] is {found}; {wanted}"));
    }
    let point = told(json!({"plane": {"point": [0, 0], "normal": [0, 0, 1]}}));
    assert_eq!(point, "scene: clip[0].plane: field 'point' is [0,0]; it must be three numbers, [x, y, z]");
    let normal = told(json!({"plane": {"point": [0, 0, 0], "normal": [0, 0, 0]}}));
    assert_eq!(normal, "scene: clip[0].plane: field 'normal' is zero; a normal has a direction");
}

#[test]
fn operators_are_names_or_objects() {
    let render = |composite: Value| told("render", &json!({"composite": composite}));
    for right in
        [json!("maximum"), json!("mip"), json!(null), json!({"first-hit": {"iso_value": 3}}), json!({"x-ray": {}})]
    {
        assert_eq!(render(right.clone()), "right", "{right}");
    }
    let missing = "scene: here.composite.first-hit: field 'iso_value' is missing";
    assert_eq!(render(json!({"first-hit": {}})), missing);
    assert!(
        render(json!("first-hit")).starts_with("scene: here: field 'composite' is \"first-hit\"; use one of: over, ")
    );
}

fn message(state: &Value) -> String {
    check_state(&state, |_, _| false).unwrap_err().to_string()
}

#[test]
fn states_have_all_fields() {
    let mut state = json!({"wavesplat": "scene", "version": 1});
    assert_eq!(message(&state), "scene: field 'layers' is missing");
    for name in ["layers", "labels", "shading", "clip", "background", "geometry", "camera", "render", "view"] {
        state[name] = json!(null);
    }
    assert_eq!(message(&state), "scene: field 'layers' is null; it must be a list of 1 to 8");
    assert_eq!(check_state(&&state, |name, _| name != "version"), Ok(()));
    state["version"] = json!(2);
    assert_eq!(message(&state), "scene: field 'version' is 2; this release reads version 1");
}
