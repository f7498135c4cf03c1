//! Random patches of states, valid and invalid, with what the crate says of each: the page must say the same.

use serde_json::{Value, json};
use wavesplat_document::{check_document, patched};

/// Values that are put into places of a state.
fn values() -> Vec<Value> {
    let texts =
        ["", "a", "over", "first-hit", "mip", "draft", "cubic", "red", "3d", "z", "angle", "world", "gray", "dark"];
    let mut values: Vec<Value> = texts.map(Value::from).into();
    values.extend([
        json!(null),
        json!(true),
        json!(false),
        json!(0),
        json!(-1),
        json!(1),
        json!(2),
        json!(0.5),
        json!(1.5),
        json!(180),
        json!(1e31),
        json!(-2.5),
        json!(5000),
        json!([]),
        json!([1]),
        json!([40, 0]),
        json!([40, 400]),
        json!([0, 0, 0]),
        json!([1, 2, 3]),
        json!([0.1, 0.2, 0.3, 0.4]),
        json!([[0, 0], [1, 1]]),
        json!([[0, 0, 0], [1, 2, 3]]),
        json!([[0, 1, 1, 1]]),
        json!([[0, 2]]),
        json!({}),
        json!({"a": 1}),
        json!({"map": "hot"}),
        json!({"1": {"color": "red"}}),
        json!({"one": {"color": "red"}}),
        json!({"first-hit": {"iso_value": 3}}),
        json!({"x-ray": {"attenuation": 0}}),
        json!({"x-ray": {}, "first-hit": {}}),
        json!({"keep": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}),
        json!({"plane": {"point": [0, 0, 0], "normal": [0, 0, 0]}}),
        json!({"sheets_per_slice": 2}),
        json!({"rgba": []}),
        json!({"kind": "distance", "points": [[0, 0, 0], [1, 1, 1]]}),
        json!({"direction": [0, 0, 1]}),
        json!("look"),
    ]);
    values
}

const NAMES: [&str; 20] = [
    "a",
    "name",
    "version",
    "opacity",
    "visible",
    "look",
    "shading",
    "lights",
    "color",
    "id",
    "kind",
    "space",
    "normals",
    "window",
    "parallel_scale",
    "view_angle",
    "gradient_opacity",
    "size",
    "1",
    "-2",
];

/// A state with something in every field.
fn rich(state: &Value) -> Value {
    let mut state = state.clone();
    state["labels"] = json!({"volume": {"path": null, "id": 2}, "smooth": true, "labels": {"1": {"color": "red", "opacity": 0.5,
        "name": "one", "scan": 1, "tint": 0}, "2": {"color": [1, 0, 0]}}});
    state["clip"] = json!([{"keep": {"lower": [0, 0, 0], "upper": [1, 2, 3], "space": "index"}},
        {"plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}}, {"cut_out": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}]);
    state["geometry"] = json!([{"kind": "points", "name": "cells", "count": 3, "visible": true, "id": 3}]);
    state["layers"][0]["look"]["shading"] = json!({"ambient": 0.2, "lights": [{"direction": [0, 0, 1], "color": [1, 1, 1],
        "frame": "camera"}], "occlusion_radius": null, "specular_power": 16, "shadow": 0.5});
    state["layers"][0]["look"]["transfer_function"]["gradient_opacity"] = json!([[0, 0], [20, 1]]);
    state["layers"][0]["look"]["part"] = json!("body");
    state["render"]["composite"] = json!({"depth-colored-maximum": {"cmap": "turbo", "axis": null}});
    state["render"]["quality"] = json!({"sheets_per_slice": 2, "oversampling": null, "quality": "fine"});
    state["view"]["measures"] = json!([{"kind": "angle", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}]);
    state["view"]["slices"]["window"] = json!([40, 400]);
    state["view"]["slices"]["normals"] = json!({"z": [0, 0, 1]});
    state["view"]["slices"]["center"] = json!([1, 2, 3]);
    state["background"] = json!([0, 0.5, 1]);
    state
}

/// Numbers as the page sends them: without a point where they are whole.
fn as_sent(value: &Value) -> Value {
    match value {
        Value::Object(fields) => fields.iter().map(|(name, one)| (name.clone(), as_sent(one))).collect(),
        Value::Array(items) => items.iter().map(as_sent).collect(),
        Value::Number(number) => {
            let whole = number.as_f64().filter(|number| number.fract() == 0.0 && number.abs() < 1e9);
            whole.map_or_else(|| value.clone(), |whole| json!(whole as i64))
        }
        _ => value.clone(),
    }
}

/// The places of a document, as steps; the document itself is none.
fn places(value: &Value, path: &str, found: &mut Vec<String>) {
    let inside: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields.iter().map(|(name, one)| (name.clone(), one)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(number, one)| (number.to_string(), one)).collect(),
        _ => return,
    };
    for (name, one) in inside {
        let place = format!("{path}/{}", name.replace('~', "~0").replace('/', "~1"));
        places(one, &place, found);
        found.push(place);
    }
}

/// Random numbers, the same each time.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from((self.0 >> 33) % n as u64).unwrap_or(0)
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}

/// Cases, one JSON object each: the operations, and the fault that is found after them; null where there is none.
pub fn cases(state: &Value, n: usize) -> Vec<Value> {
    let mut chance = Chance(61);
    let values = values();
    let rich = as_sent(&rich(state));
    let mut found = Vec::new();
    places(&rich, "", &mut found);
    let case = |_| {
        let mut operations = Vec::new();
        for _ in 0..=chance.below(2) * chance.below(2) {
            let place = chance.one(&found).clone();
            operations.push(match chance.below(8) {
                0 => json!({"op": "remove", "path": place}),
                1 => json!({"op": "add", "path": format!("{place}/{}", chance.one(&NAMES)), "value": chance.one(&values)}),
                2 => json!({"op": "add", "path": format!("{place}/-"), "value": chance.one(&values)}),
                3 => {
                    let from = rich.pointer(chance.one(&found).as_str()).cloned().unwrap_or_default();
                    json!({"op": "replace", "path": place, "value": from})
                }
                4 => json!({"op": *chance.one(&["replace", "remove"]), "path": format!("{place}/{}", chance.below(4)), "value": 1}),
                5 => json!({"op": "replace", "path": place, "value": chance.one(&values)}),
                _ => {
                    // A value of the same kind, which mostly is right.
                    let before = rich.pointer(&place).cloned().unwrap_or_default();
                    let alike = |other: &&Value| std::mem::discriminant(*other) == std::mem::discriminant(&before);
                    let others: Vec<Value> = values.iter().filter(alike).cloned().collect();
                    let value = match &before {
                        Value::Number(_) => json!(chance.below(5) as f64 / 4.0),
                        Value::String(_) if chance.below(2) == 0 => before,
                        _ if others.is_empty() => before,
                        _ => chance.one(&others).clone(),
                    };
                    json!({"op": "replace", "path": place, "value": as_sent(&value)})
                }
            });
        }
        let operations = Value::Array(operations);
        let checked = patched(&rich, &operations).and_then(|changed| check_document(&changed, "state"));
        json!({"operations": operations, "fault": checked.err().map(|error| error.to_string())})
    };
    let mut found: Vec<Value> = (0..n).map(case).collect();
    found.insert(0, json!({"operations": [], "state": rich, "fault": null}));
    found
}
