//! Values of documents as the types of this crate, and written again.

use glam::DVec3;
use serde_json::{Value, json};
use wavesplat_core::{
    Camera, ClipPlane, ColorNode, Composite, Crop, Error, Gradient, GradientNode, Light, LightFrame, OpacityNode,
    Projection, Shading, TransferFunction, TransferFunction2D,
};
use wavesplat_document::{
    COMPOSITE_SYNONYMS, CameraDocument, CurvesDocument, FieldError, LensField, TableDocument, VERSION,
};
use wavesplat_look::Look;

use crate::quality::Quality;
use crate::scene::{Scene, SceneLayer};

/// A document from which no scene can be made, or a scene that no document can say.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// A field is missing, unknown or wrong.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Values that are right alone, and cannot be together.
    #[error("scene: {place}: {error}")]
    Made {
        /// The part of the document.
        place: String,
        /// The fault.
        error: Box<Error>,
    },
    /// A volume that could not be had.
    #[error("scene: {place}: {error}")]
    Volume {
        /// Its place in the document.
        place: String,
        /// The fault.
        error: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A field that Python draws, and this crate does not yet.
    #[error("scene: {field}: {what}, which this crate cannot draw yet; {mend}")]
    NotDrawn {
        /// The field.
        field: String,
        /// The value that is not drawn.
        what: String,
        /// How to mend it.
        mend: &'static str,
    },
    /// A part of a scene that a document has no words for.
    #[error("the scene has {0}, which its document cannot say")]
    NotWritten(String),
}

pub(crate) type DocumentResult<T> = Result<T, DocumentError>;
pub(crate) fn not_drawn(field: impl Into<String>, what: impl Into<String>) -> DocumentError {
    let mend = "draw it with the Python package, or leave it out";
    DocumentError::NotDrawn { field: field.into(), what: what.into(), mend }
}

pub(crate) fn made(place: &str, error: Error) -> DocumentError {
    DocumentError::Made { place: place.to_owned(), error: Box::new(error) }
}

/// A transfer function with its opacities multiplied.
pub(crate) fn faded(function: &TransferFunction, opacity: f64) -> Result<TransferFunction, Error> {
    let fade = |node: &OpacityNode| OpacityNode { opacity: opacity * node.opacity, ..*node };
    let nodes = function.opacity_nodes().iter().map(fade).collect();
    TransferFunction::new(nodes, function.color_nodes().to_vec(), function.opacity_unit())?
        .with_gradient_opacity(function.gradient_nodes().to_vec())
}

pub(crate) fn curves(fields: &Value, place: &str) -> DocumentResult<TransferFunction> {
    let place = format!("{place}.transfer_function");
    let made = |error| made(&place, error);
    if fields.get("rgba").is_some() {
        let table = TableDocument::read(&fields).map_err(|error| error.inside(&format!("scene: {place}")))?;
        let read = if table.is_of_fields { TransferFunction2D::of_fields } else { TransferFunction2D::new };
        let joint = read(table.values, table.magnitudes, table.rgba).map_err(made)?;
        return TransferFunction::two_dimensional(joint, table.opacity_unit).map_err(made);
    }
    let read = CurvesDocument::read(&fields, true).map_err(|error| error.inside(&format!("scene: {place}")))?;
    if !["samples", "hounsfield"].contains(&read.values.as_str()) || read.opacity_unit_share.is_some() {
        return Err(not_drawn(place.as_str(), "values that are relative to a volume"));
    }
    let opacity = read.opacity.iter().map(|&[value, opacity]| OpacityNode { value, opacity }).collect();
    let color = read.color.iter().map(|&[value, r, g, b]| ColorNode { value, rgb: [r, g, b] }).collect();
    let gradient =
        read.gradient_opacity.iter().map(|&[magnitude, factor]| GradientNode { magnitude, factor }).collect();
    let function = TransferFunction::new(opacity, color, read.opacity_unit);
    function.and_then(|function| function.with_gradient_opacity(gradient)).map_err(made)
}

pub(crate) fn shading(fields: &Value, place: &str) -> DocumentResult<Option<Shading>> {
    if fields.is_null() {
        return Ok(None);
    }
    let usual = Shading::default();
    let number = |name: &str, other: f32| fields[name].as_f64().unwrap_or_else(|| exact(other));
    let exposure = number("exposure", 1.0);
    let single = |name: &str, other: f32| number(name, other) as f32;
    let exposed = |name: &str, other: f32| (exposure * number(name, other)) as f32;
    let smoothing = number("gradient_smoothing", 0.8);
    let gradient = if smoothing == 0.0 {
        Gradient::Difference(number("gradient_offset", 1.0))
    } else {
        Gradient::Smoothed(smoothing)
    };
    let light = |fields: &Value| Light {
        frame: if fields["frame"] == "world" { LightFrame::World } else { LightFrame::Camera },
        to_light: vector(&fields["direction"]),
        rgb: fields["color"].as_array().map_or([1.0; 3], |_| vector(&fields["color"]).as_vec3().to_array()),
    };
    let lights: Vec<Light> = fields["lights"].as_array().into_iter().flatten().map(light).collect();
    let found = Shading {
        ambient: exposed("ambient", usual.ambient),
        diffuse: exposed("diffuse", usual.diffuse),
        specular: exposed("specular", usual.specular),
        specular_power: single("specular_power", usual.specular_power),
        gradient,
        unoriented: single("unoriented", usual.unoriented),
        even_cuts: single("even_cuts", usual.even_cuts),
        shoulder: single("shoulder", usual.shoulder),
        lights: if lights.is_empty() { usual.lights } else { lights },
        ambient_occlusion: single("ambient_occlusion", usual.ambient_occlusion),
        occlusion_radius: fields["occlusion_radius"].as_f64(),
        shadow: single("shadow", usual.shadow),
    };
    found.validate().map_err(|error| made(place, error))?;
    Ok(Some(found))
}

pub(crate) fn vector(numbers: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| numbers[axis].as_f64().unwrap_or_default()))
}

/// The box that is kept, and the planes.
pub(crate) fn clips(given: &Value) -> DocumentResult<(Option<Crop>, Vec<ClipPlane>)> {
    let (mut crop, mut planes): (Option<Crop>, Vec<ClipPlane>) = (None, Vec::new());
    for (number, clip) in given.as_array().into_iter().flatten().enumerate() {
        if let Some(plane) = clip.get("plane") {
            planes.push(ClipPlane { origin: vector(&plane["point"]), normal: vector(&plane["normal"]) });
        } else if let Some(kept) = clip.get("keep") {
            let (lo, hi) = (vector(&kept["lower"]), vector(&kept["upper"]));
            let own = if kept["space"] == "index" { Crop::Index { lo, hi } } else { Crop::World { lo, hi } };
            if crop.replace(own).is_some() {
                return Err(not_drawn(format!("clip[{number}]"), "a second box that is kept"));
            }
        } else {
            return Err(not_drawn(format!("clip[{number}]"), "a box that is taken out"));
        }
    }
    Ok((crop, planes))
}

/// A colour, straight, with its opacity; `None` for null and "transparent".
pub(crate) fn color_of(given: &Value, field: &str) -> DocumentResult<Option<[f32; 4]>> {
    Ok(straight_color(given, field)?.map(|rgba| rgba.map(|channel| channel as f32)))
}

/// The same in double precision.
pub(crate) fn straight_color(given: &Value, field: &str) -> DocumentResult<Option<[f64; 4]>> {
    let named = |name: &str| {
        let rgb = match name {
            "black" => [0.0; 3],
            "white" => [1.0; 3],
            "grey" | "gray" => [0.5; 3],
            "red" => [1.0, 0.0, 0.0],
            "green" => [0.0, 1.0, 0.0],
            "blue" => [0.0, 0.0, 1.0],
            "cyan" => [0.0, 1.0, 1.0],
            "magenta" => [1.0, 0.0, 1.0],
            "yellow" => [1.0, 1.0, 0.0],
            "orange" => [1.0, 0.65, 0.0],
            _ => return None,
        };
        Some([rgb[0], rgb[1], rgb[2], 1.0])
    };
    let hexadecimal = |text: &str| {
        let digits = text.strip_prefix('#').filter(|digits| [6, 8].contains(&digits.len()))?;
        let digits = Some(digits).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))?;
        let byte = |at: usize| u8::from_str_radix(digits.get(at..at + 2).unwrap_or("ff"), 16).ok();
        Some([byte(0)?, byte(2)?, byte(4)?, byte(6)?].map(|byte| f64::from(byte) / 255.0))
    };
    let rgba = match given {
        Value::Null => return Ok(None),
        Value::String(text) if text == "transparent" => return Ok(None),
        Value::String(text) => {
            let text = text.trim().to_lowercase();
            let found = named(&text).or_else(|| hexadecimal(&text));
            found.ok_or_else(|| DocumentError::NotDrawn {
                field: field.to_owned(),
                what: format!("the colour {given}"),
                mend: "write numbers or #rrggbb, or draw it with the Python package",
            })?
        }
        numbers => [0, 1, 2, 3].map(|channel| numbers[channel].as_f64().unwrap_or(1.0)),
    };
    if rgba.iter().any(|channel| !(0.0..=1.0).contains(channel)) {
        return Err(made(field, Error::out_of_range("colour", given, "numbers 0..1", "divide 8-bit colours by 255")));
    }
    Ok(Some(rgba))
}

pub(crate) fn camera_of(fields: &Value) -> DocumentResult<Camera> {
    let read = CameraDocument::read(&fields).map_err(|error| error.inside("scene"))?;
    let projection = match read.lens {
        LensField::ParallelScale(parallel_scale) => Projection::Orthographic { parallel_scale },
        LensField::ViewAngle(degrees) => Projection::Perspective { view_angle_rad: degrees.to_radians() },
    };
    let [position, focal_point, view_up] = [read.position, read.focal_point, read.view_up].map(DVec3::from_array);
    Camera::new(position, focal_point, view_up, projection).map_err(|error| made("camera", error))
}

pub(crate) fn quality(name: Option<&str>) -> Quality {
    let all = [Quality::Draft, Quality::Normal, Quality::Fine, Quality::High];
    all.into_iter().find(|quality| Some(quality.name()) == name).unwrap_or_default()
}

/// Operators that need no number.
const OPERATORS: [(&str, Composite); 5] = [
    ("over", Composite::Over),
    ("maximum", Composite::Maximum),
    ("minimum", Composite::Minimum),
    ("mean", Composite::Mean),
    ("sum", Composite::Sum),
];

/// The operator of a name or a synonym, where it needs no number.
pub(crate) fn operator(name: &str) -> Option<Composite> {
    let name = COMPOSITE_SYNONYMS.iter().find(|(synonym, _)| *synonym == name).map_or(name, |(_, name)| name);
    OPERATORS.iter().find(|(known, _)| *known == name).map(|(_, operator)| *operator)
}

// Written.

/// The shortest number of which a float32 is the nearest.
pub(crate) fn exact(number: f32) -> f64 {
    number.to_string().parse().unwrap_or_else(|_| f64::from(number))
}

pub(crate) fn composite_fields(composite: Composite) -> DocumentResult<Value> {
    if let Composite::FirstHit { iso_value } = composite {
        return Ok(json!({"first-hit": {"iso_value": iso_value}}));
    }
    operator_name(composite).map(|name| json!(name))
}

fn operator_name(composite: Composite) -> DocumentResult<&'static str> {
    let found = OPERATORS.iter().find(|(_, operator)| *operator == composite).map(|(name, _)| *name);
    found.ok_or_else(|| DocumentError::NotWritten("an operator along the ray with settled numbers".to_owned()))
}

/// The document of a look, as `Look.to_json` of Python has it. [`Scene::from_document`] takes it as the look of a layer, and
/// gives the same picture.
///
/// ```
/// let look = wavesplat::Look::preset("ct-bone")?;
/// let document = wavesplat::look_document(&look)?;
/// assert_eq!(document["name"], "ct-bone");
/// assert_eq!(document["composite"], "over");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If documents cannot say it: a corner that is left out, an operator with numbers, a background that is no colour of
/// 8 bits.
pub fn look_document(look: &Look) -> Result<Value, DocumentError> {
    let mut fields = fields_of_look(look)?;
    fields["version"] = json!(VERSION);
    Ok(fields)
}

/// The same without a version, as scenes have it.
pub(crate) fn fields_of_look(look: &Look) -> DocumentResult<Value> {
    if look.is_cut_open {
        return Err(DocumentError::NotWritten("a corner that is left out".to_owned()));
    }
    let mut fields = look_fields(&look.transfer_function, look.shading.as_ref());
    fields["name"] = json!(look.name);
    fields["description"] = json!(look.reason);
    fields["composite"] = json!(operator_name(look.composite)?);
    fields["view"] = json!(look.view);
    fields["background"] = json!(look.background.map(color_text).transpose()?);
    Ok(fields)
}

/// A colour as #rrggbb, or #rrggbbaa.
fn color_text(color: [f32; 4]) -> DocumentResult<String> {
    let bytes = color.map(|channel| (255.0 * channel).round() as u8);
    if bytes.map(|byte| (f64::from(byte) / 255.0) as f32) != color {
        return Err(DocumentError::NotWritten("a look with a background that is no colour of 8 bits".to_owned()));
    }
    let [red, green, blue, opacity] = bytes;
    let rest = if opacity == 255 { String::new() } else { format!("{opacity:02x}") };
    Ok(format!("#{red:02x}{green:02x}{blue:02x}{rest}"))
}

pub(crate) fn look_of(layer: &SceneLayer<'_>) -> Value {
    look_fields(&layer.transfer_function, layer.shading.as_ref())
}

pub(crate) fn look_fields(function: &TransferFunction, shading: Option<&Shading>) -> Value {
    let unit = function.opacity_unit();
    let curves = if let Some(table) = function.function_2d() {
        json!({
            "values": table.values(), "magnitudes": table.magnitudes(), "opacity_unit": unit,
            "rgba": (0..table.magnitudes().len()).map(|row| table.row(row)).collect::<Vec<_>>(),
            "rows": if table.is_of_fields() { "field" } else { "gradient" },
        })
    } else {
        let opacity: Vec<_> = function.opacity_nodes().iter().map(|node| [node.value, node.opacity]).collect();
        let color = function.color_nodes().iter().map(|node| [node.value, node.rgb[0], node.rgb[1], node.rgb[2]]);
        let mut fields = json!({"opacity_unit": unit, "opacity": opacity, "color": color.collect::<Vec<_>>()});
        let gradient: Vec<_> = function.gradient_nodes().iter().map(|node| [node.magnitude, node.factor]).collect();
        if !gradient.is_empty() {
            fields["gradient_opacity"] = json!(gradient);
        }
        fields
    };
    json!({"transfer_function": curves, "shading": shading.map(light_fields)})
}

pub(crate) fn light_fields(shading: &Shading) -> Value {
    let (smoothing, offset) = match shading.gradient {
        Gradient::Smoothed(deviation) => (deviation, 1.0),
        Gradient::Difference(offset) => (0.0, offset),
    };
    let light = |light: &Light| {
        json!({
            "direction": light.to_light.to_array(), "color": light.rgb.map(exact),
            "frame": if light.frame == LightFrame::World { "world" } else { "camera" },
        })
    };
    json!({
        "ambient": exact(shading.ambient), "diffuse": exact(shading.diffuse), "specular": exact(shading.specular),
        "specular_power": exact(shading.specular_power), "gradient_smoothing": smoothing, "gradient_offset": offset,
        "unoriented": exact(shading.unoriented), "even_cuts": exact(shading.even_cuts),
        "shoulder": exact(shading.shoulder), "exposure": 1.0, "lights": shading.lights.iter().map(light).collect::<Vec<_>>(),
        "ambient_occlusion": exact(shading.ambient_occlusion), "occlusion_radius": shading.occlusion_radius,
        "shadow": exact(shading.shadow),
    })
}

pub(crate) fn clips_of(scene: &Scene<'_>) -> Value {
    let kept = scene.crop.map(|crop| {
        let (lo, hi) = crop.corners();
        let space = if matches!(crop, Crop::Index { .. }) { "index" } else { "world" };
        json!({"keep": {"lower": lo.to_array(), "upper": hi.to_array(), "space": space}})
    });
    let plane =
        |plane: &ClipPlane| json!({"plane": {"point": plane.origin.to_array(), "normal": plane.normal.to_array()}});
    kept.into_iter().chain(scene.clip_planes.iter().map(plane)).collect()
}

pub(crate) fn camera_fields(camera: &Camera) -> Value {
    let mut fields = json!({
        "version": VERSION, "position": camera.position().to_array(),
        "focal_point": (camera.position() + camera.forward()).to_array(), "view_up": camera.up().to_array(),
    });
    match camera.projection() {
        Projection::Orthographic { parallel_scale } => fields["parallel_scale"] = json!(parallel_scale),
        Projection::Perspective { view_angle_rad } => fields["view_angle"] = json!(view_angle_rad.to_degrees()),
    }
    fields
}
