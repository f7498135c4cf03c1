//! JSON Patch (RFC 6902), the part that the viewer needs: add, replace, remove. `web/src/state/patch.ts` is the twin.

use crate::error::{FieldError, Found, quoted};
use crate::fields::wrong_at;
use crate::node::{ChangedNode, ValueNode};

/// Largest number of steps of a path: the deepest field of a state has seven.
pub const MAX_STEPS: usize = 16;
/// Most digits of a place in a list.
const MAX_DIGITS: usize = 9;

#[derive(Clone, Copy, PartialEq, Eq)]
enum PatchKind {
    Add,
    Replace,
    Remove,
}

/// The document with all operations done, in their order. It shares with the document before what they do not touch.
///
/// # Errors
/// If an operation is invalid, or its path leads nowhere; the message names both.
pub fn patched<N: ChangedNode>(document: &N, operations: &N) -> Result<N, FieldError> {
    let Some(operations) = operations.items() else {
        let found = Found::Whole("are", operations.described());
        let wanted = "give a list of objects".to_owned();
        return Err(FieldError { document: "patch: the operations".to_owned(), path: String::new(), found, wanted });
    };
    let mut document = document.clone();
    for (number, operation) in operations.iter().enumerate() {
        document = patched_once(&document, operation, &format!("patch: operations[{number}]"))?;
    }
    Ok(document)
}

fn patched_once<N: ChangedNode>(document: &N, operation: &N, place: &str) -> Result<N, FieldError> {
    let error = |path: &str, found, wanted: &str| FieldError {
        document: place.to_owned(),
        path: path.to_owned(),
        found,
        wanted: wanted.to_owned(),
    };
    let described = |node: Option<&N>| node.map_or_else(|| N::NULL.to_owned(), ValueNode::described);
    if !operation.is_object() {
        return Err(wrong_at(place, Some(operation), "it must be an object"));
    }
    let [kind, path, value] = ["op", "path", "value"].map(|name| operation.field(name));
    let kind = match kind.as_ref().and_then(ValueNode::text).as_deref() {
        Some("add") => PatchKind::Add,
        Some("replace") => PatchKind::Replace,
        Some("remove") => PatchKind::Remove,
        _ => return Err(error("op", Found::Value(described(kind.as_ref())), "use add, replace or remove")),
    };
    if let Some(name) = operation.names().into_iter().filter(|name| !["op", "path", "value"].contains(&&**name)).min() {
        return Err(error(&name, Found::Unknown, "the fields are op, path and value"));
    }
    if kind != PatchKind::Remove && value.is_none() {
        return Err(error("value", Found::Missing, ""));
    }
    let shown = described(path.as_ref());
    operation.check_values(&format!("{place}: {shown}"))?;
    let Some(path) = path.as_ref().and_then(ValueNode::text).filter(|path| path.is_empty() || path.starts_with('/'))
    else {
        return Err(error("path", Found::Value(shown), "it must be '' or begin with '/'"));
    };
    let steps: Vec<String> = path.split('/').skip(1).map(|step| step.replace("~1", "/").replace("~0", "~")).collect();
    if steps.len() > MAX_STEPS {
        let wanted = format!("field 'path' has {} steps; {MAX_STEPS} is the most", steps.len());
        return Err(error("", Found::Fault, &wanted));
    }
    let change = Change { kind, value: value.as_ref(), place: format!("{place}: {}", quoted(&path)) };
    change.done(document, &steps)
}

/// One operation, on its way through the document. `place`: of the operation, with its path, for messages.
struct Change<'a, N> {
    kind: PatchKind,
    value: Option<&'a N>,
    place: String,
}

impl<N: ChangedNode> Change<'_, N> {
    fn refused(&self, wanted: String) -> FieldError {
        FieldError { document: self.place.clone(), path: String::new(), found: Found::Fault, wanted }
    }

    fn done(&self, inside: &N, steps: &[String]) -> Result<N, FieldError> {
        let Some((step, rest)) = steps.split_first() else {
            return match (self.kind, self.value) {
                (PatchKind::Add | PatchKind::Replace, Some(value)) => Ok(value.clone()),
                _ => Err(self.refused("the whole document cannot be removed".to_owned())),
            };
        };
        if inside.is_object() {
            let before = inside.field(step);
            return match before {
                Some(before) if !rest.is_empty() => Ok(inside.with_field(step, Some(self.done(&before, rest)?))),
                None if !rest.is_empty() || self.kind != PatchKind::Add => {
                    Err(self.refused(format!("there is no field {}", quoted(step))))
                }
                _ if self.kind == PatchKind::Remove => Ok(inside.with_field(step, None)),
                _ => Ok(inside.with_field(step, self.value.cloned())),
            };
        }
        let Some(items) = inside.items() else {
            let found = inside.described();
            return Err(self.refused(format!("before {} stands {found}, which has no fields", quoted(step))));
        };
        self.done_in_list(items, step, rest).map(|items| inside.listed(items))
    }

    fn done_in_list(&self, mut items: Vec<N>, step: &str, rest: &[String]) -> Result<Vec<N>, FieldError> {
        if step == "-" && self.kind == PatchKind::Add && rest.is_empty() {
            items.extend(self.value.cloned());
            return Ok(items);
        }
        // As the standard has it: no sign, no zeros in front.
        let is_place = !step.is_empty()
            && step.bytes().all(|digit| digit.is_ascii_digit())
            && (step.len() == 1 || !step.starts_with('0'))
            && step.len() <= MAX_DIGITS;
        let Some(place) = step.parse::<usize>().ok().filter(|_| is_place) else {
            return Err(self.refused(format!("{} is no place in a list", quoted(step))));
        };
        let n = items.len();
        if place > n || (place == n && (!rest.is_empty() || self.kind != PatchKind::Add)) {
            return Err(self.refused(format!("the list has {n} items, so there is none at {place}")));
        }
        match (self.kind, self.value) {
            _ if !rest.is_empty() => items[place] = self.done(&items[place], rest)?,
            (PatchKind::Add, Some(value)) => items.insert(place, value.clone()),
            (PatchKind::Replace, Some(value)) => items[place] = value.clone(),
            _ => {
                items.remove(place);
            }
        }
        Ok(items)
    }
}
