//! Checks of fields that all documents share.

use crate::error::{FieldError, Found};
use crate::node::ValueNode;

/// The version of the documents of this release.
pub const VERSION: i64 = 1;

/// The largest number of a document: samples may be 1e14 units apart, and 1e12 times that from the origin. Its square is
/// still far from the largest float64. `web/src/state/checks.ts` has the same.
pub const LARGEST: f64 = 1e30;

pub(crate) fn wrong(document: &str, name: &str, found: impl Into<String>, wanted: &str) -> FieldError {
    let found = Found::Value(found.into());
    FieldError { document: document.to_owned(), path: name.to_owned(), found, wanted: wanted.to_owned() }
}

/// Refuses an object that lacks a field, is of another version, or has a field too many.
///
/// `document`: such as "camera", which begins the message; `hint`: where its form is described.
pub fn check_fields<T: AsRef<str>>(
    node: &impl ValueNode,
    document: &str,
    needed: &[T],
    known: &[T],
    hint: &str,
) -> Result<(), FieldError> {
    let error =
        |path: &str, found, wanted| FieldError { document: document.to_owned(), path: path.to_owned(), found, wanted };
    if let Some(name) = needed.iter().map(AsRef::as_ref).find(|name| node.field(name).is_none()) {
        return Err(error(name, Found::Missing, format!("see {hint} for the form")));
    }
    if let Some(version) = node.field("version").filter(|version| version.whole() != Some(VERSION)) {
        return Err(wrong(document, "version", version.written(), &format!("this release reads version {VERSION}")));
    }
    check_known(node, document, known)
}

/// Refuses an object with a field that is not known.
fn check_known<T: AsRef<str>>(node: &impl ValueNode, document: &str, known: &[T]) -> Result<(), FieldError> {
    let is_known = |name: &str| known.iter().any(|one| one.as_ref() == name);
    let Some(name) = node.names().into_iter().filter(|name| !is_known(name)).min() else { return Ok(()) };
    let mut known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    known.sort_unstable();
    let wanted = format!("the fields are {}", known.join(", "));
    Err(FieldError { document: document.to_owned(), path: name, found: Found::Unknown, wanted })
}

/// Refuses what is no object, or has a field that is not known. `place`: of the value, such as "scene: view.slices".
pub(crate) fn check_object(node: &impl ValueNode, place: &str, known: &[&str]) -> Result<(), FieldError> {
    if !node.is_object() {
        return Err(wrong_at(place, Some(node), "it must be an object"));
    }
    check_known(node, place, known)
}

/// The error of a wrong value at a place; without a value it is not there, which is as if it were null.
pub(crate) fn wrong_at<N: ValueNode>(place: &str, node: Option<&N>, wanted: &str) -> FieldError {
    let found = Found::Whole("is", node.map_or_else(|| N::NULL.to_owned(), ValueNode::described));
    FieldError { document: place.to_owned(), path: String::new(), found, wanted: wanted.to_owned() }
}

/// Refuses what is none of some names.
pub(crate) fn check_one_of<N: ValueNode>(node: Option<&N>, known: &[&str], place: &str) -> Result<(), FieldError> {
    match node.and_then(ValueNode::text) {
        Some(text) if known.contains(&text.as_str()) => Ok(()),
        _ => Err(wrong_at(place, node, &format!("use one of: {}", known.join(", ")))),
    }
}

/// Refuses what is no list of three numbers.
pub(crate) fn check_point(node: &impl ValueNode, place: &str) -> Result<[f64; 3], FieldError> {
    point(node).ok_or_else(|| wrong_at(place, Some(node), "it must be three numbers, [x, y, z]"))
}

/// Refuses a field that is no list; it need not be there. `form`: how the list is written.
pub fn check_list(node: &impl ValueNode, document: &str, name: &str, form: &str) -> Result<(), FieldError> {
    match node.field(name) {
        Some(field) if !field.is_list() => Err(wrong(document, name, "not a list", &format!("write {form}"))),
        _ => Ok(()),
    }
}

/// The number in a field; none if it is null or not there.
pub fn optional_number(node: &impl ValueNode, document: &str, name: &str) -> Result<Option<f64>, FieldError> {
    match node.field(name).filter(|field| !field.is_null()) {
        None => Ok(None),
        Some(field) => match number(&field) {
            None => Err(wrong(document, name, field.written(), "it must be a number or null")),
            found => Ok(found),
        },
    }
}

/// Whether a value is a number of absolute value up to [`LARGEST`].
pub fn is_number(node: &impl ValueNode) -> bool {
    number(node).is_some()
}

/// Whether a value is a list of three such numbers.
pub fn is_point(node: &impl ValueNode) -> bool {
    point(node).is_some()
}

pub(crate) fn number(node: &impl ValueNode) -> Option<f64> {
    node.number().filter(|number| number.abs() <= LARGEST)
}

pub(crate) fn point(node: &impl ValueNode) -> Option<[f64; 3]> {
    let items = node.items().filter(|items| items.len() == 3)?;
    let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
    numbers?.try_into().ok()
}
