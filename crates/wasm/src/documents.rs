//! Documents: whether they are valid, and patches of them.

use serde_json::Value;
use wavesplat::document::{
    CameraDocument, CurvesDocument, FieldError, LookDocument, MaterialsDocument, TableDocument, ValueNode,
    check_document, check_material, check_settings, check_view, lights, patched,
};

use crate::requests;

/// Kinds of documents, with their names in messages and the fields that they are known by.
const OBJECTS: [(&str, &str, &str); 5] = [
    ("camera", "camera", "position, focal_point and view_up"),
    ("look", "look", "transfer_function"),
    ("transfer function", "transfer function", "opacity and color"),
    ("transfer function 2d", "two-dimensional transfer function", "values, magnitudes and rgba"),
    ("materials", "materials", "materials"),
];

/// The value of a document's text, if it is valid. `kind`: "camera", "look", "transfer function", "transfer function 2d",
/// "materials", "scene", "state" of the viewer, or "view", a field of it.
///
/// # Errors
///
/// A message that names the field.
pub fn checked(kind: &str, text: &str) -> Result<Value, String> {
    let document = requests::parsed(text.as_bytes())?;
    let node = &document;
    if let Some((_, name, fields)) = OBJECTS.iter().find(|(one, ..)| *one == kind && !document.is_object()) {
        return Err(format!("{name}: the JSON text is not an object; it must be {{...}} with {fields}"));
    }
    if kind == "scene" && document["wavesplat"] != "scene" {
        return Err("scene: this is no scene; it must be an object with \"wavesplat\": \"scene\"".to_owned());
    }
    let found = match kind {
        "camera" => CameraDocument::read(&node).map(|_| ()),
        "look" => check_look(&node),
        "transfer function" => CurvesDocument::read(&node, false).map(|_| ()),
        "transfer function 2d" => TableDocument::read(&node).map(|_| ()),
        "materials" => MaterialsDocument::read(&node).and_then(|read| {
            read.materials.iter().enumerate().try_for_each(|(number, material)| check_material(material, number))
        }),
        "scene" | "state" => check_document(&node, kind),
        "view" => check_view(&node),
        _ => return Err(format!("there is no document '{kind}'")),
    };
    found.map_err(|error| error.to_string())?;
    Ok(document)
}

/// Checks a look with its curves or its table, and its light.
fn check_look(node: &impl ValueNode) -> Result<(), FieldError> {
    let look = LookDocument::read(node)?;
    if look.transfer_function.field("rgba").is_some() {
        TableDocument::read(&look.transfer_function)?;
    } else {
        CurvesDocument::read(&look.transfer_function, true)?;
    }
    let Some(shading) = look.shading.filter(|shading| !shading.is_null()) else { return Ok(()) };
    for light in lights(&shading)? {
        check_settings(&light, true)?;
    }
    check_settings(&shading, false)
}

/// The document with all operations done.
///
/// # Errors
///
/// A message that names the operation and its path.
pub fn changed(document: &Value, operations: &Value) -> Result<Value, String> {
    patched(document, operations).map_err(|error| error.to_string())
}
