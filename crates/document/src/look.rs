//! Looks as documents, and the light in them; materials.
//!
//! ```json
//! {"version": 1, "name": "ct-bone", "transfer_function": {"opacity": [[150, 0], [400, 0.8]], "color": [[0, 1, 1, 1]]},
//!  "shading": {"diffuse": 0.9, "lights": [{"direction": [-1, 1, 2]}]}, "composite": "over"}
//! ```

use crate::error::{FieldError, Found, quoted};
use crate::fields::{check_fields, check_list, optional_number, wrong};
use crate::node::ValueNode;
use crate::parts::COMPOSITES;

const LOOK: &str = "look";
const TEXTS: [&str; 7] = ["name", "description", "kind", "view", "composite", "background", "part"];
const LIGHT: [&str; 3] = ["color", "direction", "frame"];
const SHADING: [&str; 14] = [
    "ambient",
    "ambient_occlusion",
    "diffuse",
    "even_cuts",
    "exposure",
    "gradient_offset",
    "gradient_smoothing",
    "lights",
    "occlusion_radius",
    "shadow",
    "shoulder",
    "specular",
    "specular_power",
    "unoriented",
];

/// A look as its document describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct LookDocument<N> {
    /// Name, description, kind, view, composite, background and part, as far as they are given.
    pub texts: [Option<String>; 7],
    /// Object of the transfer function: curves, or a table if it has `rgba`.
    pub transfer_function: N,
    /// Light: none if it is not given, null for colours as they are.
    pub shading: Option<N>,
}

impl<N: ValueNode> LookDocument<N> {
    /// Reads the fields of a look's object, but not those of its transfer function and its light.
    ///
    /// # Errors
    /// If a field is missing, unknown or wrong; the error names the field.
    pub fn read(node: &N) -> Result<Self, FieldError> {
        Self::read_part(node, false)
    }

    /// Reads the same of a look that is part of a scene, and needs no version there.
    pub(crate) fn read_part(node: &N, in_scene: bool) -> Result<Self, FieldError> {
        let known = [&["version", "transfer_function", "shading"], &TEXTS[..]].concat();
        check_fields(node, LOOK, &known[usize::from(in_scene)..2], &known, "Look.to_json")?;
        let mut texts = [const { None }; 7];
        for (text, name) in texts.iter_mut().zip(TEXTS) {
            let Some(given) = node.field(name).filter(|given| !given.is_null()) else { continue };
            let found = given.text();
            *text = Some(found.ok_or_else(|| wrong(LOOK, name, given.written(), "it must be a text or null"))?);
        }
        if let Some(composite) = texts[4].as_deref().filter(|name| !name.is_empty() && !COMPOSITES.contains(name)) {
            let wanted = format!("use one of: {}", COMPOSITES.join(", "));
            return Err(wrong(LOOK, "composite", quoted(composite), &wanted));
        }
        let curves = node.field("transfer_function").filter(ValueNode::is_object);
        let transfer_function = curves.ok_or_else(|| {
            let found = node.field("transfer_function").map_or_else(String::new, |found| found.written());
            wrong(LOOK, "transfer_function", found, "it must be an object")
        })?;
        Ok(Self { texts, transfer_function, shading: node.field("shading") })
    }
}

/// The lights of the object of a look's light.
///
/// # Errors
/// If it is no object, or its lights no list.
pub fn lights<N: ValueNode>(shading: &N) -> Result<Vec<N>, FieldError> {
    let lights = shading.field("lights");
    match &lights {
        _ if !shading.is_object() => None,
        None => Some(Vec::new()),
        Some(lights) => lights.items().filter(|_| lights.is_list()),
    }
    .ok_or_else(|| wrong(LOOK, "shading", shading.written(), "it must be an object, its lights a list"))
}

/// Refuses an object of light with settings that are not known. `is_light`: of one light, not of all shading.
///
/// # Errors
/// If it is no object, or has such a setting.
pub fn check_settings(node: &impl ValueNode, is_light: bool) -> Result<(), FieldError> {
    let (kind, known) = if is_light { ("light", &LIGHT[..]) } else { ("shading", &SHADING[..]) };
    let fault = |wanted| FieldError { document: LOOK.to_owned(), path: String::new(), found: Found::Fault, wanted };
    if !node.is_object() {
        return Err(fault(format!("{} is no {kind}; write an object", node.written())));
    }
    match node.names().into_iter().filter(|name| !known.contains(&name.as_str())).min() {
        Some(name) => Err(fault(format!("{kind} has no {}; it has {}", quoted(&name), known.join(", ")))),
        None => Ok(()),
    }
}

/// Materials as their document describes them.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialsDocument<N> {
    /// Objects of the materials, which [`check_material`] checks.
    pub materials: Vec<N>,
    /// Thickness that the opacities belong to, world units.
    pub opacity_unit: Option<f64>,
}

impl<N: ValueNode> MaterialsDocument<N> {
    /// Reads the fields of the object of materials.
    ///
    /// # Errors
    /// If a field is missing, unknown or wrong; the error names the field.
    pub fn read(node: &N) -> Result<Self, FieldError> {
        let known = ["version", "materials", "name", "description", "sources", "opacity_unit"];
        check_fields(node, "materials", &known[..2], &known, "Materials.to_json")?;
        check_list(node, "materials", "materials", "[{...}, ...]")?;
        let opacity_unit = optional_number(node, "materials", "opacity_unit")?;
        let materials = node.field("materials").and_then(|materials| materials.items()).unwrap_or_default();
        Ok(Self { materials, opacity_unit })
    }
}

/// Refuses the object of a material with a field missing or too many. `number`: its place in the list.
///
/// # Errors
/// If it is no object or has such a field; the error names both.
pub fn check_material(node: &impl ValueNode, number: usize) -> Result<(), FieldError> {
    let known = ["name", "probability", "color", "opacity", "density"];
    let document = format!("materials: field 'materials', number {number}");
    if !node.is_object() {
        let wanted = format!("{} is not an object; write {{...}} with {}", node.written(), known[..4].join(", "));
        return Err(FieldError { document, path: String::new(), found: Found::Fault, wanted });
    }
    check_fields(node, &document, &known[..4], &known, "Materials.to_json")
}
