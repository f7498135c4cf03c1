//! Transfer functions as documents: curves of the value, or a table of the value and the gradient.
//!
//! ```json
//! {"version": 1, "opacity_unit": 1.0, "opacity": [[150, 0], [400, 0.8]],
//!  "color": [[150, 0.8, 0.5, 0.3], [400, 1, 1, 0.9]], "gradient_opacity": [[0, 0], [20, 1]]}
//! ```

use crate::error::{FieldError, Found};
use crate::fields::{check_fields, check_list, optional_number, wrong, wrong_at};
use crate::node::{MAX_LETTERS, ValueNode};
use crate::parts::SCALES;

const CURVES: &str = "transfer function";
const TABLE: &str = "two-dimensional transfer function";
/// Most axes of an array, as NumPy has them.
const MAX_AXES: usize = 64;
/// A transfer function of the value, as its document describes it. Whether nodes are in order and opacities within 0..1 is
/// for the transfer function to say that is made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesDocument {
    /// Scale of the values of all nodes, such as "samples" or "fraction".
    pub values: String,
    /// Nodes (value, alpha).
    pub opacity: Vec<[f64; 2]>,
    /// Nodes (value, red, green, blue).
    pub color: Vec<[f64; 4]>,
    /// Nodes (magnitude, factor).
    pub gradient_opacity: Vec<[f64; 2]>,
    /// Thickness that the opacities belong to, world units.
    pub opacity_unit: Option<f64>,
    /// The same as a share of the longest side of the volume's box.
    pub opacity_unit_share: Option<f64>,
}

impl CurvesDocument {
    /// Reads the fields of a transfer function's object. `in_look`: it is a part of a look, and has no version.
    ///
    /// # Errors
    /// If a field is missing, unknown or wrong; the error names the field.
    pub fn read(node: &impl ValueNode, in_look: bool) -> Result<Self, FieldError> {
        let needed = ["version", "opacity", "color"];
        let known = ["name", "description", "values", "opacity_unit", "opacity_unit_share", "gradient_opacity"];
        let known = [&needed[..], &known[..]].concat();
        check_fields(node, CURVES, &needed[usize::from(in_look)..], &known, "TransferFunction.to_json")?;
        for name in ["opacity", "color", "gradient_opacity"] {
            check_list(node, CURVES, name, "nodes, [[value, ...], ...]")?;
        }
        let scale = node.field("values");
        let values = scale.as_ref().map_or_else(|| Some(SCALES[0].to_owned()), ValueNode::text);
        let Some(values) = values.filter(|name| SCALES.contains(&name.as_str())) else {
            let wanted = format!("it is one of: {}", SCALES.map(|name| format!("\"{name}\"")).join(", "));
            return Err(wrong(CURVES, "values", scale.map_or_else(String::new, |scale| scale.written()), &wanted));
        };
        Ok(Self {
            values,
            opacity_unit: optional_number(node, CURVES, "opacity_unit")?,
            opacity_unit_share: optional_number(node, CURVES, "opacity_unit_share")?,
            opacity: nodes(node, "opacity", "value, alpha")?,
            color: nodes(node, "color", "value, red, green, blue")?,
            gradient_opacity: nodes(node, "gradient_opacity", "magnitude, factor")?,
        })
    }
}

/// A transfer function of two dimensions, as its document describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct TableDocument {
    /// Sample values of the columns.
    pub values: Vec<f64>,
    /// Magnitudes of the gradient, or values of a second field, of the rows.
    pub magnitudes: Vec<f64>,
    /// Red, green, blue and opacity of each column of each row.
    pub rgba: Vec<[f64; 4]>,
    /// Thickness that the opacities belong to, world units.
    pub opacity_unit: Option<f64>,
    /// Whether the rows are values of a second field.
    pub is_of_fields: bool,
}

impl TableDocument {
    /// Reads the fields of a table's object.
    ///
    /// # Errors
    /// If a field is missing, unknown or wrong; the error names the field.
    pub fn read(node: &impl ValueNode) -> Result<Self, FieldError> {
        let known = ["values", "magnitudes", "rgba", "version", "name", "description", "opacity_unit", "rows"];
        check_fields(node, TABLE, &known[..3], &known, "TransferFunction2D.to_json")?;
        let unit = node.field("opacity_unit").filter(|unit| !unit.is_null());
        if let Some(unit) = unit.as_ref().filter(|unit| unit.number().is_none()) {
            return Err(wrong(TABLE, "opacity_unit", unit.described(), "it must be a number or null"));
        }
        let rows = node.field("rows");
        let is_of_fields = match rows.as_ref().map(ValueNode::text) {
            None => false,
            Some(Some(name)) if name == "gradient" || name == "field" => name == "field",
            _ => return Err(wrong_at(&format!("{TABLE}: rows"), rows.as_ref(), "give 'gradient' or 'field'")),
        };
        let axis = |name: &str| {
            let field = node.field(name);
            let numbers = field.as_ref().and_then(numbers);
            numbers.ok_or_else(|| wrong_numbers(&format!("{TABLE}: {name}"), field.as_ref(), "give numbers in order"))
        };
        let [values, magnitudes] = [axis("values")?, axis("magnitudes")?];
        let fault = |wanted: String| FieldError {
            document: TABLE.to_owned(),
            path: String::new(),
            found: Found::Fault,
            wanted,
        };
        let mut flat = Vec::new();
        let shape = node.field("rgba").and_then(|table| shape(&table, 0, &mut flat));
        let Some(shape) = shape else {
            return Err(fault("rgba is no array of numbers; give shape (magnitudes, values, 4)".to_owned()));
        };
        let (m, v) = (magnitudes.len(), values.len());
        if shape != [m, v, 4] {
            let [first, rest @ ..] = &*shape.iter().map(usize::to_string).collect::<Vec<_>>() else {
                return Err(fault(format!(
                    "rgba has shape (); with {m} magnitudes and {v} values it must be ({m}, {v}, 4)"
                )));
            };
            let shape = if rest.is_empty() { format!("({first},)") } else { format!("({first}, {})", rest.join(", ")) };
            return Err(fault(format!(
                "rgba has shape {shape}; with {m} magnitudes and {v} values it must be ({m}, {v}, 4)"
            )));
        }
        let rgba = flat.as_chunks::<4>().0.to_vec();
        Ok(Self { values, magnitudes, rgba, opacity_unit: unit.and_then(|unit| unit.number()), is_of_fields })
    }
}

/// The numbers of a list, which may be infinite or NaN.
fn numbers(node: &impl ValueNode) -> Option<Vec<f64>> {
    node.items()?.iter().map(ValueNode::number).collect()
}

/// The shape of a nested list of numbers, which are appended to `flat`; none if it is ragged.
fn shape(node: &impl ValueNode, depth: usize, flat: &mut Vec<f64>) -> Option<Vec<usize>> {
    // Null is a number that is not known, as in arrays of Python.
    if let Some(number) = node.number().or(node.is_null().then_some(f64::NAN)) {
        flat.push(number);
        return Some(Vec::new());
    }
    let items = node.items().filter(|_| depth < MAX_AXES)?;
    let mut inner: Option<Vec<usize>> = None;
    for item in &items {
        let found = shape(item, depth + 1, flat)?;
        if inner.as_ref().is_some_and(|inner| *inner != found) {
            return None;
        }
        inner = Some(found);
    }
    Some([vec![items.len()], inner.unwrap_or_default()].concat())
}

/// Nodes of a curve; `names`: of their numbers.
fn nodes<const N: usize>(node: &impl ValueNode, curve: &str, names: &str) -> Result<Vec<[f64; N]>, FieldError> {
    let items = node.field(curve).and_then(|curve| curve.items()).unwrap_or_default();
    let read = |(number, item)| {
        let found = numbers(item).and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        found.ok_or_else(|| {
            wrong_numbers(
                &format!("{CURVES}: {curve} node {number}"),
                Some(item),
                &format!("give {N} numbers ({names})"),
            )
        })
    };
    items.iter().enumerate().map(read).collect()
}

/// The error of wrong numbers, which are written out where they are few.
fn wrong_numbers<N: ValueNode>(place: &str, node: Option<&N>, wanted: &str) -> FieldError {
    let mut error = wrong_at(place, node, wanted);
    let text = node.filter(|node| node.is_list()).map(ValueNode::written);
    if let Some(text) = text.filter(|text| text.chars().count() <= MAX_LETTERS) {
        error.found = Found::Whole("is", text);
    }
    error
}
