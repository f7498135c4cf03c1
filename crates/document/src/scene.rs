//! Scenes as documents: the fields of each part. `scene.schema.json` of the Python package describes their values.

use crate::error::{FieldError, Found};
use crate::fields::{VERSION, check_object, wrong, wrong_at};
use crate::node::ValueNode;

const WHAT: &str = "scene";
/// Fields of a viewer's state, which has all of them.
const STATE: [&str; 11] = [
    "wavesplat",
    "version",
    "layers",
    "labels",
    "shading",
    "clip",
    "background",
    "geometry",
    "camera",
    "render",
    "view",
];

/// A part of a scene's document, with its fields; the first `n_needed` must be there.
struct ScenePart {
    name: &'static str,
    n_needed: usize,
    fields: &'static [&'static str],
}

const fn part(name: &'static str, n_needed: usize, fields: &'static [&'static str]) -> ScenePart {
    ScenePart { name, n_needed, fields }
}

#[rustfmt::skip]
const PARTS: [ScenePart; 24] = [
    part("scene", 2, &[
        "version", "layers", "wavesplat", "labels", "shading", "clip", "background", "keep_table", "geometry", "camera",
        "render", "figure", "view",
    ]),
    part("layer", 1, &["volume", "name", "look", "visible", "opacity", "time", "color_from"]),
    part("color_field", 1, &["volume", "name", "look"]),
    part("mapped_look", 1, &["map", "window"]),
    part("labels", 1, &["volume", "labels", "smooth"]),
    part("plane", 2, &["point", "normal"]),
    part("keep", 2, &["lower", "upper", "space"]),
    part("cut_out", 2, &["lower", "upper", "space"]),
    part("shape_file", 1, &["path", "kind", "values", "unit", "world_unit"]),
    part("surface", 0, &[
        "file", "vertices", "faces", "color", "values", "cmap", "clim", "quantity", "value_unit", "opacity", "normals",
        "lit", "clipped", "visible", "name",
    ]),
    part("lines", 0, &[
        "file", "paths", "color", "values", "cmap", "clim", "quantity", "value_unit", "radius", "width", "opacity", "lit",
        "clipped", "visible", "name",
    ]),
    part("points", 0, &[
        "file", "positions", "color", "values", "cmap", "clim", "quantity", "value_unit", "radius", "size", "labels",
        "opacity", "lit", "clipped", "visible", "name",
    ]),
    part("slice_plane", 0, &[
        "file", "volume", "plane", "position", "index", "window", "clim", "cmap", "opacity", "clipped", "visible", "name",
    ]),
    part("frame", 0, &["file", "box", "ticks", "units", "grid", "color", "width", "opacity", "visible", "name"]),
    part("render", 0, &["size", "quality", "psnr", "kernel", "composite", "depth", "stereo", "panorama"]),
    part("quality", 0, &["sheets_per_slice", "oversampling", "quality"]),
    part("stereo", 0, &["layout", "eye_distance", "convergence"]),
    part("first-hit", 0, &["iso_value"]),
    part("local-maximum", 0, &["threshold"]),
    part("depth-shaded-maximum", 0, &["strength"]),
    part("depth-colored-maximum", 0, &["cmap", "axis"]),
    part("attenuated-maximum", 0, &["attenuation"]),
    part("x-ray", 0, &["clear", "attenuation"]),
    part("figure", 0, &[
        "scale_bar", "orientation", "colorbar", "legend", "title", "unit", "values", "dpi", "font_size", "color", "font",
        "scale_bar_at", "orientation_at", "colorbar_at", "legend_at",
    ]),
];

/// Kinds of which an object of one field is: the field names one.
const KINDS: [(&str, &str, &[&str]); 4] = [
    ("clip", "", &["keep", "plane", "cut_out"]),
    ("shape", "", &["surface", "lines", "points", "slice_plane", "frame"]),
    ("step", "", &["smoothed", "largest_body", "moved", "wavelets", "level", "bands", "to_volume", "times"]),
    (
        "operator",
        "a name, or ",
        &["first-hit", "local-maximum", "depth-shaded-maximum", "depth-colored-maximum", "attenuated-maximum", "x-ray"],
    ),
];

/// The fields of a part, such as "layer" or "render", and the number of those at the beginning that must be there.
#[must_use]
pub fn fields_of_part(name: &str) -> Option<(&'static [&'static str], usize)> {
    PARTS.iter().find(|part| part.name == name).map(|part| (part.fields, part.n_needed))
}

/// Refuses a part that is no object, lacks a field, or has one too many. `place`: of the part, for the message.
///
/// # Errors
/// If it is such a part; the message names the field.
pub fn check_part(node: &impl ValueNode, place: &str, name: &str) -> Result<(), FieldError> {
    let (known, n_needed) = fields_of_part(name).unwrap_or_default();
    if !node.is_object() {
        return check_object(node, place, known);
    }
    if let Some(missing) = known[..n_needed].iter().find(|field| node.field(field).is_none()) {
        return Err(missing_field(place, missing));
    }
    check_object(node, place, known)
}

/// The list in a field, which need not be there.
///
/// # Errors
/// If it is no list.
pub fn list_in<N: ValueNode>(node: &N, name: &str) -> Result<Vec<N>, FieldError> {
    let Some(found) = node.field(name) else { return Ok(Vec::new()) };
    let items = found.items().filter(|_| found.is_list());
    items.ok_or_else(|| wrong(WHAT, name, found.described(), "it must be a list"))
}

/// The name of the only field of a clip, a shape, a step or an operator, and the object in it.
///
/// # Errors
/// If it is no object of one field, or the field names no such kind.
pub fn only_field<N: ValueNode>(node: &N, place: &str, of: &str) -> Result<(String, N), FieldError> {
    let (_, instead, kinds) = KINDS.into_iter().find(|(name, ..)| *name == of).unwrap_or_default();
    let names = if node.is_object() { node.names() } else { Vec::new() };
    if let [name] = &*names
        && kinds.contains(&name.as_str())
        && let Some(inside) = node.field(name)
    {
        return Ok((name.clone(), inside));
    }
    Err(wrong_at(place, Some(node), &format!("it must be {instead}an object of one field: {}", kinds.join(", "))))
}

/// Refuses a document that is no state of the viewer by its fields, its kind or its version.
///
/// # Errors
/// If it is such a document; the message names the field.
pub fn check_state<N: ValueNode>(node: &N) -> Result<(), FieldError> {
    if !node.is_object() {
        return Err(wrong_at(WHAT, Some(node), "it must be an object"));
    }
    check_object(node, WHAT, &STATE)?;
    if let Some(missing) = STATE.iter().find(|field| node.field(field).is_none()) {
        return Err(missing_field(WHAT, missing));
    }
    let refused = |name: &str, is_right: fn(&N) -> bool, wanted: &str| match node.field(name) {
        Some(field) if !is_right(&field) => Err(wrong(WHAT, name, field.described(), wanted)),
        _ => Ok(()),
    };
    refused("wavesplat", |kind| kind.text().as_deref() == Some(WHAT), "it must be 'scene'")?;
    let reads = format!("this release reads version {VERSION}");
    refused("version", |version| version.number() == Some(1.0), &reads)
}

fn missing_field(place: &str, name: &str) -> FieldError {
    FieldError { document: place.to_owned(), path: name.to_owned(), found: Found::Missing, wanted: String::new() }
}
