//! The field `view` of a viewer's state: what no picture from Python has. `web/src/state/parse.ts` is the twin.
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

use crate::error::FieldError;
use crate::fields::{check_object, check_one_of, check_point, number, wrong_at};
use crate::node::ValueNode;

const VIEWS: [&str; 4] = ["3d", "z", "y", "x"];
const PANES: [&str; 3] = ["z", "y", "x"];
const LAYOUTS: [&str; 4] = ["3d", "one-and-three", "two-by-two", "single"];
const SLABS: [&str; 3] = ["maximum", "minimum", "mean"];
const MOVING: [&str; 3] = ["smooth", "balanced", "exact"];
const THEMES: [&str; 3] = ["system", "dark", "light"];
/// Turning by a drag: about an upright axis, or freely.
const TURNINGS: [&str; 2] = ["turntable", "trackball"];
/// Colour maps of slices.
const COLORS: [&str; 5] = ["gray", "gray_r", "hot", "viridis", "coolwarm"];
/// Overlays, and whether they are shown at first.
const OVERLAYS: [(&str, bool); 7] = [
    ("scale_bar", true),
    ("letters", true),
    ("cube", true),
    ("color_bar", false),
    ("crosshair", true),
    ("crop_box", false),
    ("legend", true),
];
/// Measures with their least and largest number of points.
const MEASURES: [(&str, usize, usize); 3] = [("distance", 2, 2), ("angle", 3, 3), ("area", 3, 200)];
/// Fields of slices without a default.
const MAY_LACK: [&str; 4] = ["center", "window", "colors", "normals"];
/// Largest numbers of measures and panels, so that a state stays small.
const MAX_MEASURES: usize = 1000;
const MAX_PANELS: usize = 100;
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
        ("overlays", Some(OVERLAYS.map(|(name, shown)| (name, json!(shown))).into())),
        ("quality", Some(vec![("moving", json!("smooth"))])),
        ("interface", Some(interface)),
    ]
}

/// Checks the field `view` of a state.
///
/// # Errors
/// If something in it cannot be; the message names the field.
pub fn check_view<N: ValueNode>(view: &N) -> Result<(), FieldError> {
    let sections = default_view([0.0; 3]);
    check_object(view, WHAT, &sections.each_ref().map(|(name, _)| *name))?;
    // Slices last, as their other fields are known after them.
    for name in ["layout", "overlays", "quality", "interface", "slices"] {
        let Some(section) = view.field(name) else { continue };
        let mut known: Vec<&str> = MAY_LACK.into_iter().filter(|_| name == "slices").collect();
        let own = sections.iter().find(|(one, _)| *one == name).and_then(|(_, fields)| fields.as_ref());
        known.extend(own.into_iter().flatten().map(|(field, _)| *field));
        check_object(&section, &format!("{WHAT}.{name}"), &known)?;
    }
    let field = |section: &str, name: &str| view.field(section)?.field(name);
    let check_name = |section: &str, name: &str, known: &[&str]| match field(section, name) {
        Some(given) => check_one_of(Some(&given), known, &format!("{WHAT}.{section}.{name}")),
        None => Ok(()),
    };
    check_name("layout", "name", &LAYOUTS)?;
    check_name("layout", "main", &VIEWS)?;
    if let Some(slices) = view.field("slices") {
        check_slices(&slices)?;
    }
    for (name, _) in OVERLAYS {
        if let Some(shown) = field("overlays", name).filter(|shown| !shown.is_switch()) {
            return Err(wrong_at(&format!("{WHAT}.overlays.{name}"), Some(&shown), "it must be true or false"));
        }
    }
    check_name("quality", "moving", &MOVING)?;
    check_name("interface", "theme", &THEMES)?;
    check_name("interface", "turning", &TURNINGS)?;
    if let Some(panels) = field("interface", "panels") {
        let place = format!("{WHAT}.interface.panels");
        for (number, panel) in listed(&panels, &place, MAX_PANELS)?.iter().enumerate() {
            if panel.text().is_none() {
                return Err(wrong_at(&format!("{place}[{number}]"), Some(panel), "it must be a name"));
            }
        }
    }
    if let Some(measures) = view.field("measures") {
        let place = format!("{WHAT}.measures");
        for (number, measure) in listed(&measures, &place, MAX_MEASURES)?.iter().enumerate() {
            check_measure(measure, &format!("{place}[{number}]"))?;
        }
    }
    Ok(())
}

fn check_slices(slices: &impl ValueNode) -> Result<(), FieldError> {
    let place = |name: &str| format!("{WHAT}.slices.{name}");
    let check_number = |name: &str, least: f64, most: f64, wanted: &str| match slices.field(name) {
        Some(given) if number(&given).is_none_or(|found| !(least..=most).contains(&found)) => {
            Err(wrong_at(&place(name), Some(&given), wanted))
        }
        _ => Ok(()),
    };
    if let Some(crosshair) = slices.field("crosshair") {
        check_point(&crosshair, &place("crosshair"))?;
    }
    if let Some(slab) = slices.field("slab") {
        check_one_of(Some(&slab), &SLABS, &place("slab"))?;
    }
    check_number("thickness", 0.0, f64::INFINITY, "it must be 0 or a length")?;
    check_number("zoom", 0.01, 1000.0, "it must be a number, 0.01 to 1000")?;
    if let Some(center) = slices.field("center") {
        check_point(&center, &place("center"))?;
    }
    if let Some(colors) = slices.field("colors") {
        check_one_of(Some(&colors), &COLORS, &place("colors"))?;
    }
    if let Some(window) = slices.field("window") {
        let items = window.items().filter(|_| window.is_list()).unwrap_or_default();
        let found: Vec<f64> = items.iter().filter_map(number).collect();
        if items.len() != 2 || found.len() != 2 || found[1] <= 0.0 {
            return Err(wrong_at(&place("window"), Some(&window), "it must be [level, width]"));
        }
    }
    if let Some(normals) = slices.field("normals") {
        check_object(&normals, &place("normals"), &PANES)?;
        for name in normals.names() {
            let at = place(&format!("normals.{name}"));
            let Some(normal) = normals.field(&name) else { continue };
            if check_point(&normal, &at)? == [0.0; 3] {
                let mut error = wrong_at(&at, Some(&normal), "a normal has a direction");
                error.found = crate::error::Found::Whole("is", "zero".to_owned());
                return Err(error);
            }
        }
    }
    Ok(())
}

fn check_measure(measure: &impl ValueNode, place: &str) -> Result<(), FieldError> {
    check_object(measure, place, &["kind", "points"])?;
    let kind = measure.field("kind");
    check_one_of(kind.as_ref(), &MEASURES.map(|(name, ..)| name), &format!("{place}.kind"))?;
    let kind = kind.and_then(|kind| kind.text());
    let (least, most) =
        MEASURES.into_iter().find(|(name, ..)| kind.as_deref() == Some(name)).map_or((0, 0), |m| (m.1, m.2));
    let points = measure.field("points");
    let place = format!("{place}.points");
    let items = points.as_ref().filter(|points| points.is_list()).and_then(ValueNode::items);
    let Some(items) = items.filter(|items| (least..=most).contains(&items.len())) else {
        let n = if least == most { least.to_string() } else { format!("{least} to {most}") };
        return Err(wrong_at(&place, points.as_ref(), &format!("it must be a list of {n} points")));
    };
    for (number, point) in items.iter().enumerate() {
        check_point(point, &format!("{place}[{number}]"))?;
    }
    Ok(())
}

fn listed<N: ValueNode>(node: &N, place: &str, most: usize) -> Result<Vec<N>, FieldError> {
    let items = node.items().filter(|items| node.is_list() && items.len() <= most);
    items.ok_or_else(|| wrong_at(place, Some(node), &format!("it must be a list of at most {most}")))
}
