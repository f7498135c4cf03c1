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
    let is_known = |name: &str| known.iter().any(|one| one.as_ref() == name);
    if let Some(name) = node.names().into_iter().filter(|name| !is_known(name)).min() {
        let mut known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
        known.sort_unstable();
        return Err(error(&name, Found::Unknown, format!("the fields are {}", known.join(", "))));
    }
    Ok(())
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

fn number(node: &impl ValueNode) -> Option<f64> {
    node.number().filter(|number| number.abs() <= LARGEST)
}

pub(crate) fn point(node: &impl ValueNode) -> Option<[f64; 3]> {
    let items = node.items().filter(|items| items.len() == 3)?;
    let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
    numbers?.try_into().ok()
}
