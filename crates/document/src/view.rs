//! The field `view` of a viewer's state: what no picture from Python has.
//!
//! ```json
//! {"layout": {"name": "one-and-three", "main": "3d"},
//!  "slices": {"crosshair": [0, 0, 0], "window": [40, 400], "thickness": 0, "slab": "maximum", "zoom": 1,
//!             "center": [0, 0, 0], "colors": "gray", "normals": {"z": [0, 0.1, 0.995]}},
//!  "measures": [{"kind": "distance", "points": [[0, 0, 0], [10, 0, 0]]}],
//!  "overlays": {"scale_bar": true, "letters": true, "cube": true, "color_bar": false, "crosshair": true,
//!               "crop_box": false, "legend": true},
//!  "quality": {"moving": "smooth"},
//!  "interface": {"theme": "system", "panels": ["presets"], "turning": "turntable"}}
//! ```
//!
//! Whatever is left out is as [`default_view`] has it. World units; `window` is (level, width), and `colors` a colour
//! map, both left out where they are those of the kind of data; `center` is the place in the middle of all panes, left
//! out where it is the middle of the volume's box.

use serde_json::{Value, json};

use crate::check::{FieldPlace, check_fields_of};
use crate::error::FieldError;
use crate::node::ValueNode;
use crate::parts::OVERLAYS;

/// Overlays that are not shown at first.
const HIDDEN: [&str; 2] = ["color_bar", "crop_box"];
const WHAT: &str = "scene: view";

/// A section of the field, such as `slices`: its name and its fields in order; none for `measures`, a list.
pub type ViewSection = (&'static str, Option<Vec<(&'static str, Value)>>);

/// The sections as they are at first, in order.
#[must_use]
pub fn default_view(crosshair: [f64; 3]) -> [ViewSection; 6] {
    let slices = vec![
        ("crosshair", json!(crosshair)),
        ("thickness", json!(0.0)),
        ("slab", json!("maximum")),
        ("zoom", json!(1.0)),
    ];
    let interface = vec![("theme", json!("system")), ("panels", json!(["presets"])), ("turning", json!("turntable"))];
    [
        ("layout", Some(vec![("name", json!("3d")), ("main", json!("3d"))])),
        ("slices", Some(slices)),
        ("measures", None),
        ("overlays", Some(OVERLAYS.map(|name| (name, json!(!HIDDEN.contains(&name)))).into())),
        ("quality", Some(vec![("moving", json!("smooth"))])),
        ("interface", Some(interface)),
    ]
}

/// Checks the field `view` of a state.
///
/// # Errors
/// If something in it cannot be; the message names the field.
pub fn check_view<N: ValueNode>(view: &N) -> Result<(), FieldError> {
    let at = FieldPlace { inside: WHAT, name: String::new(), is_dotted: true, is_deep: true };
    check_fields_of(view, "view", &at)
}
