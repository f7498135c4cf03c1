//! Errors of documents, which name the field.

use std::fmt::Write as _;

use thiserror::Error;

/// A document that cannot be read: the field, what was found there, and what is right.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{document}: {}{wanted}", self.place())]
pub struct FieldError {
    /// The document, such as "camera".
    pub document: String,
    /// Name of the field; empty where the fault is not in one field.
    pub path: String,
    /// The value or the fault found there.
    pub found: Found,
    /// Advice: the right values.
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
    /// Fields that do not go together.
    Conflict,
}

impl FieldError {
    fn place(&self) -> String {
        let path = quoted(&self.path);
        match &self.found {
            Found::Missing => format!("field {path} is missing; "),
            Found::Unknown => format!("unknown field {path}; "),
            Found::Value(value) => format!("field {path} is {value}; "),
            Found::Conflict => String::new(),
        }
    }
}

/// A name in quotes, with control characters and the quote itself escaped.
fn quoted(name: &str) -> String {
    let quote = if name.contains('\'') && !name.contains('"') { '"' } else { '\'' };
    let mut text = String::from(quote);
    for letter in name.chars() {
        match letter {
            '\n' => text += "\\n",
            '\r' => text += "\\r",
            '\t' => text += "\\t",
            '\\' => text += "\\\\",
            _ if letter == quote => text.extend(['\\', quote]),
            // The soft hyphen and the space that does not break are not seen either.
            '\0'..=' ' | '\x7f'..='\u{a0}' | '\u{ad}' if letter != ' ' => {
                let _ = write!(text, "\\x{:02x}", u32::from(letter));
            }
            _ => text.push(letter),
        }
    }
    text.push(quote);
    text
}
