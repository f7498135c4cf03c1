//! Scenes as documents: checks of all their parts, which the tables of `parts.rs` describe.

use crate::check::{FieldPlace, check_fields_of, check_names_of};
use crate::error::FieldError;
use crate::node::ValueNode;
use crate::parts::part;

const WHAT: &str = "scene";

/// Names of the fields of a part, such as "layer" or "render", and of those that must be there.
#[must_use]
pub fn fields_of_part(name: &str) -> [Vec<&'static str>; 2] {
    let part = part(name);
    [part.fields.iter().map(|field| field.name).collect(), part.needed().map(|field| field.name).collect()]
}

/// Refuses a part that is no object, lacks a field, has one too many, or one of a wrong value. `place`: of the part, for
/// the message. What a camera, a look and light are made of is for them to say.
///
/// # Errors
/// If it is such a part; the message names the field.
pub fn check_part(node: &impl ValueNode, place: &str, name: &str) -> Result<(), FieldError> {
    check_fields_of(node, name, &FieldPlace { inside: place, name: String::new(), is_dotted: false, is_deep: false })
}

/// Refuses a document that is no state of the viewer by a field. `is_checked`: whether a field is known to be right.
///
/// # Errors
/// If it is such a document; the message names the field.
pub fn check_state<N: ValueNode>(node: &N, is_checked: impl Fn(&str, &N) -> bool) -> Result<(), FieldError> {
    check_names_of(node, "state", WHAT)?;
    part("state").fields.iter().try_for_each(|field| match node.field(field.name) {
        Some(value) if !is_checked(field.name, &value) => field
            .form
            .check(&value, &FieldPlace { inside: WHAT, name: field.name.to_owned(), is_dotted: false, is_deep: false }),
        _ => Ok(()),
    })
}

/// Refuses a scene's document or, of another name, a part of one such as "state", by any value in it: by those of
/// cameras, looks and light too. What only the things can say that are made of it, such as whether the nodes of a curve
/// are in order, is left to them.
///
/// # Errors
/// If it is such a document; the message names the field.
pub fn check_document(node: &impl ValueNode, name: &str) -> Result<(), FieldError> {
    check_fields_of(node, name, &FieldPlace { inside: WHAT, name: String::new(), is_dotted: false, is_deep: true })
}
