//! Looks, transfer functions and materials as documents: what is read, and words for what is wrong.

use serde_json::{Value, json};
use wavesplat_document::{
    CurvesDocument, FieldError, LookDocument, MaterialsDocument, TableDocument, check_material, check_settings, lights,
    patched,
};

fn curves() -> Value {
    json!({"version": 1, "opacity_unit": null, "opacity": [[150, 0], [400, 0.5]], "color": [[150, 1, 1, 0]]})
}

fn table() -> Value {
    json!({"values": [0, 1], "magnitudes": [2], "rgba": [[[1, 0, 0, 0], [1, 1, 1, 0.5]]], "rows": "field"})
}

fn look() -> Value {
    json!({"version": 1, "name": "bone", "transfer_function": curves(), "shading": {"lights": [{"direction": [0, 0, 1]}]}})
}

#[test]
fn documents_are_read() {
    let read = CurvesDocument::read(&&curves(), false).unwrap();
    assert_eq!((read.values.as_str(), read.opacity), ("samples", vec![[150.0, 0.0], [400.0, 0.5]]));
    assert_eq!(read.color, [[150.0, 1.0, 1.0, 0.0]]);
    let read = TableDocument::read(&&table()).unwrap();
    assert_eq!(read.rgba, [[1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 0.5]]);
    assert!(read.is_of_fields);
    let document = look();
    let read = LookDocument::read(&&document).unwrap();
    assert_eq!(read.texts[0].as_deref(), Some("bone"));
    assert!(CurvesDocument::read(&read.transfer_function, true).is_ok());
    let lights = lights(&read.shading.unwrap()).unwrap();
    assert_eq!(lights.len(), 1);
    assert_eq!(check_settings(&lights[0], true), Ok(()));
    let document = json!({"version": 1, "materials": [{"name": "a", "probability": [], "color": "red", "opacity": 1}]});
    let read = MaterialsDocument::read(&&document).unwrap();
    assert_eq!(check_material(&read.materials[0], 0), Ok(()));
}

type Case = (fn() -> Value, fn(&Value) -> Result<(), FieldError>, &'static str, Value, &'static str);

#[test]
fn errors_name_the_field() {
    let of_curves: fn(&Value) -> _ = |document| CurvesDocument::read(&document, false).map(|_| ());
    let of_table: fn(&Value) -> _ = |document| TableDocument::read(&document).map(|_| ());
    let of_look: fn(&Value) -> _ = |document| LookDocument::read(&document).map(|_| ());
    let of_light: fn(&Value) -> _ = |document| check_settings(&document, true);
    let of_material: fn(&Value) -> _ = |document| check_material(&document, 2);
    let cases: [Case; 12] = [
        (
            curves,
            of_curves,
            "/opacity",
            json!({}),
            "transfer function: field 'opacity' is not a list; write nodes, [[value, ...], ...]",
        ),
        (
            curves,
            of_curves,
            "/opacity/1",
            json!([1]),
            "transfer function: opacity node 1 is [1]; give 2 numbers (value, alpha)",
        ),
        (
            curves,
            of_curves,
            "/color/0/0",
            json!(null),
            "transfer function: color node 0 is [null,1,1,0]; give 4 numbers (value, red, green, blue)",
        ),
        (
            curves,
            of_curves,
            "/opacity_unit",
            json!("1"),
            "transfer function: field 'opacity_unit' is \"1\"; it must be a number or null",
        ),
        (
            table,
            of_table,
            "/magnitudes",
            json!(3),
            "two-dimensional transfer function: magnitudes is 3; give numbers in order",
        ),
        (
            table,
            of_table,
            "/rgba",
            json!([1, 2]),
            "two-dimensional transfer function: rgba has shape (2,); with 1 magnitudes and 2 values it must be (1, 2, 4)",
        ),
        (
            table,
            of_table,
            "/rgba/0/0",
            json!([1]),
            "two-dimensional transfer function: rgba is no array of numbers; give shape (magnitudes, values, 4)",
        ),
        (look, of_look, "/part", json!(1), "look: field 'part' is 1; it must be a text or null"),
        (look, of_look, "/transfer_function", json!([]), "look: field 'transfer_function' is []; it must be an object"),
        (
            look,
            of_look,
            "/look",
            json!(1),
            "look: unknown field 'look'; the fields are background, composite, description, kind, name, part, shading, transfer_function, version, view",
        ),
        (
            || json!({"direction": [0, 0, 1]}),
            of_light,
            "/angle",
            json!(1),
            "look: light has no 'angle'; it has color, direction, frame",
        ),
        (
            || json!({"name": "a"}),
            of_material,
            "/color",
            json!("red"),
            "materials: field 'materials', number 2: field 'probability' is missing; see Materials.to_json for the form",
        ),
    ];
    for (document, read, path, value, message) in cases {
        let kind = if document().pointer(path).is_some() { "replace" } else { "add" };
        let changed = patched(&document(), &json!([{"op": kind, "path": path, "value": value}])).unwrap();
        assert_eq!(read(&changed).unwrap_err().to_string(), message);
    }
    assert_eq!(
        lights(&&json!(3)).unwrap_err().to_string(),
        "look: field 'shading' is 3; it must be an object, its lights a list"
    );
}
