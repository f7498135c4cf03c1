//! Errors of documents, which name the field.

use std::fmt::{self, Write as _};

use thiserror::Error;

/// A document that cannot be read: the field, the value or the fault found there, and advice.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct FieldError {
    /// The document, such as "camera", or a part of it, such as "scene: view.slices".
    pub document: String,
    /// Name of the field; empty where the fault is not in one field.
    pub path: String,
    /// The value or the fault found there.
    pub found: Found,
    /// Advice: the right values. It may be empty.
    pub wanted: String,
}

/// The value or the fault found in a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// The field is not there.
    Missing,
    /// The field is there, and no document of this kind has it.
    Unknown,
    /// A wrong value, as words that follow "is".
    Value(String),
    /// A wrong value of the document itself, or of the part that its name says, as words that follow "is" or "are".
    Whole(&'static str, String),
    /// A fault that is not in one field, which the advice says.
    Fault,
}

impl FieldError {
    /// The error as one of a part of another document.
    #[must_use]
    pub fn inside(mut self, document: &str) -> Self {
        self.document = format!("{document}: {}", self.document);
        self
    }
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { document, wanted, .. } = self;
        let path = quoted(&self.path);
        match &self.found {
            Found::Missing => write!(f, "{document}: field {path} is missing")?,
            Found::Unknown => write!(f, "{document}: unknown field {path}")?,
            Found::Value(value) => write!(f, "{document}: field {path} is {value}")?,
            Found::Whole(verb, value) => write!(f, "{document} {verb} {value}")?,
            Found::Fault => return write!(f, "{document}: {wanted}"),
        }
        if wanted.is_empty() { Ok(()) } else { write!(f, "; {wanted}") }
    }
}

/// A text in quotes, with the quote itself, and all that is not seen, escaped.
#[must_use]
pub fn quoted(text: &str) -> String {
    let quote = if text.contains('\'') && !text.contains('"') { '"' } else { '\'' };
    let mut found = String::from(quote);
    for letter in text.chars() {
        match letter {
            '\n' => found += "\\n",
            '\r' => found += "\\r",
            '\t' => found += "\\t",
            '\\' => found += "\\\\",
            _ if letter == quote => found.extend(['\\', quote]),
            _ if is_seen(letter) => found.push(letter),
            _ => {
                let code = u32::from(letter);
                let _ = match code {
                    0..=0xff => write!(found, "\\x{code:02x}"),
                    0x100..=0xffff => write!(found, "\\u{code:04x}"),
                    _ => write!(found, "\\U{code:08x}"),
                };
            }
        }
    }
    found.push(quote);
    found
}

/// Whether a letter has a place on paper: no control, no space but the plain one, nothing unassigned.
fn is_seen(letter: char) -> bool {
    // After another letter, accents are not escaped.
    let pair = String::from_iter(['a', letter]);
    letter == '"' || letter == '\'' || pair.escape_debug().eq(pair.chars())
}
