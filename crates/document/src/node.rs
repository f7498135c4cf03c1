//! Values of a document, whatever language holds them.

use serde_json::Value;

use crate::error::FieldError;

/// Letters of a value in a message, at most; a longer one is named by its type.
pub(crate) const MAX_LETTERS: usize = 60;

/// A value of a document: null, a switch, a number, a text, a list, or an object with fields.
pub trait ValueNode: Sized {
    /// The word for null in messages.
    const NULL: &'static str;
    /// The value of a field of an object.
    fn field(&self, name: &str) -> Option<Self>;
    /// The names of an object's fields, in any order.
    fn names(&self) -> Vec<String>;
    /// Whether it is an object.
    fn is_object(&self) -> bool;
    /// Whether it is a list. A tuple of Python is none, though it has items.
    fn is_list(&self) -> bool;
    /// The values of a list or a tuple.
    fn items(&self) -> Option<Vec<Self>>;
    /// A number as the nearest float; none for anything else, switches included.
    fn number(&self) -> Option<f64>;
    /// A number that is written without a point.
    fn whole(&self) -> Option<i64>;
    /// A text; none for one that cannot be written.
    fn text(&self) -> Option<String>;
    /// Whether it is true or false.
    fn is_switch(&self) -> bool;
    /// Whether it is null.
    fn is_null(&self) -> bool;
    /// Text of the value for a message.
    fn written(&self) -> String;
    /// The same, or the type of the value where that is long.
    fn described(&self) -> String;
    /// Refuses values that the language of the node has and JSON has not.
    ///
    /// # Errors
    /// If there is one; the message begins with `document` and names the field.
    fn check_values(&self, document: &str) -> Result<(), FieldError> {
        let _ = document;
        Ok(())
    }
}

/// A value that changed copies are made of. They share all that is not changed, if the language lets them.
pub trait ChangedNode: ValueNode + Clone {
    /// The object with a field set, or without it.
    #[must_use]
    fn with_field(&self, name: &str, value: Option<Self>) -> Self;
    /// A list of values.
    #[must_use]
    fn listed(&self, items: Vec<Self>) -> Self;
}

impl ValueNode for &Value {
    const NULL: &'static str = "null";

    fn field(&self, name: &str) -> Option<Self> {
        self.get(name)
    }

    fn names(&self) -> Vec<String> {
        self.as_object().into_iter().flat_map(serde_json::Map::keys).cloned().collect()
    }

    fn is_object(&self) -> bool {
        Value::is_object(self)
    }

    fn is_list(&self) -> bool {
        self.is_array()
    }

    fn items(&self) -> Option<Vec<Self>> {
        self.as_array().map(|items| items.iter().collect())
    }

    fn number(&self) -> Option<f64> {
        self.as_f64()
    }

    fn whole(&self) -> Option<i64> {
        self.as_i64()
    }

    fn text(&self) -> Option<String> {
        self.as_str().map(str::to_owned)
    }

    fn is_switch(&self) -> bool {
        self.is_boolean()
    }

    fn is_null(&self) -> bool {
        Value::is_null(self)
    }

    fn written(&self) -> String {
        self.to_string()
    }

    fn described(&self) -> String {
        let kind = match self {
            Value::Array(_) => return "a list".to_owned(),
            Value::Object(_) => return "an object".to_owned(),
            Value::String(_) => "a text",
            _ => "a number",
        };
        let text = self.to_string();
        if text.chars().count() <= MAX_LETTERS { text } else { kind.to_owned() }
    }
}

/// A value of its own, whose parts are copies.
impl ValueNode for Value {
    const NULL: &'static str = "null";

    fn field(&self, name: &str) -> Option<Self> {
        self.get(name).cloned()
    }

    fn names(&self) -> Vec<String> {
        (&self).names()
    }

    fn is_object(&self) -> bool {
        self.is_object()
    }

    fn is_list(&self) -> bool {
        self.is_array()
    }

    fn items(&self) -> Option<Vec<Self>> {
        self.as_array().cloned()
    }

    fn number(&self) -> Option<f64> {
        self.as_f64()
    }

    fn whole(&self) -> Option<i64> {
        self.as_i64()
    }

    fn text(&self) -> Option<String> {
        (&self).text()
    }

    fn is_switch(&self) -> bool {
        self.is_boolean()
    }

    fn is_null(&self) -> bool {
        self.is_null()
    }

    fn written(&self) -> String {
        self.to_string()
    }

    fn described(&self) -> String {
        (&self).described()
    }
}

impl ChangedNode for Value {
    fn with_field(&self, name: &str, value: Option<Self>) -> Self {
        let mut changed = self.as_object().cloned().unwrap_or_default();
        match value {
            Some(value) => changed.insert(name.to_owned(), value),
            None => changed.remove(name),
        };
        changed.into()
    }

    fn listed(&self, items: Vec<Self>) -> Self {
        items.into()
    }
}
