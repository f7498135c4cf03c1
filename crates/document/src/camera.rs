//! Cameras as documents.

use crate::error::{FieldError, Found};
use crate::fields::{check_fields, optional_number, point, wrong};
use crate::node::ValueNode;

const DOCUMENT: &str = "camera";
const NEEDED: [&str; 4] = ["version", "position", "focal_point", "view_up"];
const KNOWN: [&str; 6] = ["version", "position", "focal_point", "view_up", "parallel_scale", "view_angle"];

/// A camera as its document describes it. Whether something is seen from there is for the camera to say that is made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDocument {
    /// The eye, world units.
    pub position: [f64; 3],
    /// The point in the middle of the picture.
    pub focal_point: [f64; 3],
    /// Direction that points up in the picture.
    pub view_up: [f64; 3],
    /// Orthographic or in perspective.
    pub lens: LensField,
}

/// How a camera projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LensField {
    /// Orthographic: half the height of the view, world units.
    ParallelScale(f64),
    /// In perspective: the angle of view from bottom to top, degrees.
    ViewAngle(f64),
}

impl CameraDocument {
    /// Reads the fields of a camera's object.
    ///
    /// # Errors
    /// If a field is missing, unknown or wrong, or there is not one of the lenses; the error names the field.
    pub fn read(node: &impl ValueNode) -> Result<Self, FieldError> {
        check_fields(node, DOCUMENT, &NEEDED, &KNOWN, "Camera.as_json")?;
        let triple = |name| {
            let wanted = "it must be three numbers, [x, y, z]";
            // A field that is needed is there.
            let field = node.field(name).ok_or_else(|| wrong(DOCUMENT, name, "missing", wanted))?;
            point(&field).ok_or_else(|| wrong(DOCUMENT, name, field.described(), wanted))
        };
        let [position, focal_point, view_up] = [triple("position")?, triple("focal_point")?, triple("view_up")?];
        let scale = optional_number(node, DOCUMENT, "parallel_scale")?;
        let angle = optional_number(node, DOCUMENT, "view_angle")?;
        let lens = match (scale, angle) {
            (Some(scale), None) => LensField::ParallelScale(scale),
            (None, Some(angle)) => LensField::ViewAngle(angle),
            _ => {
                return Err(FieldError {
                    document: DOCUMENT.to_owned(),
                    path: String::new(),
                    found: Found::Fault,
                    wanted: "give one of the fields 'parallel_scale' and 'view_angle'".to_owned(),
                });
            }
        };
        Ok(Self { position, focal_point, view_up, lens })
    }
}
