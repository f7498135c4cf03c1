//! JSON documents of Wavesplat: which fields they have, which values these take, and errors that name the field.
//!
//! A document is read through the trait [`ValueNode`], by which the values of another language are read where they lie:
//! [`serde_json::Value`] is one, the objects of Python are another. What is valid is decided here for all of them.
//!
//! ```
//! use wavesplat_document::{CameraDocument, LensField};
//!
//! let camera: serde_json::Value = serde_json::from_str(
//!     r#"{"version": 1, "position": [0, 500, 0], "focal_point": [0, 0, 0], "view_up": [0, 0, 1], "view_angle": 30}"#,
//! )
//! .unwrap();
//! assert_eq!(CameraDocument::read(&&camera).unwrap().lens, LensField::ViewAngle(30.0));
//!
//! let error = CameraDocument::read(&&serde_json::json!({"version": 1})).unwrap_err();
//! assert_eq!(error.to_string(), "camera: field 'position' is missing; see Camera.as_json for the form");
//! ```

mod camera;
mod check;
mod curves;
mod error;
mod fields;
mod form;
mod look;
mod node;
mod parts;
mod patch;
mod scene;
mod schema;
mod typescript;
mod view;

pub use camera::{CameraDocument, LensField};
pub use curves::{CurvesDocument, TableDocument};
pub use error::{FieldError, Found, quoted};
pub use fields::{LARGEST, VERSION, check_fields, check_list, is_number, is_point, optional_number};
pub use look::{LookDocument, MaterialsDocument, check_material, check_settings, lights};
pub use node::{ChangedNode, ValueNode};
pub use parts::COMPOSITE_SYNONYMS;
pub use patch::{MAX_STEPS, patched};
pub use scene::{check_document, check_part, check_state, fields_of_part};
pub use schema::{scene_schema, written};
pub use typescript::state_types;
pub use view::{ViewSection, check_view, default_view};
