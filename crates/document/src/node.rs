//! Values of a document, whatever language holds them.

use serde_json::Value;

/// Letters of a value in a message, at most; a longer one is named by its type.
const MAX_LETTERS: usize = 60;

/// A value of a document: null, a switch, a number, a text, a list, or an object with fields.
pub trait ValueNode: Sized {
    /// The value of a field of an object.
    fn field(&self, name: &str) -> Option<Self>;
    /// The names of an object's fields, in any order.
    fn names(&self) -> Vec<String>;
    /// Whether it is a list. A tuple of Python is none, though it has items.
    fn is_list(&self) -> bool;
    /// The values of a list or a tuple.
    fn items(&self) -> Option<Vec<Self>>;
    /// A number as the nearest float; none for anything else, switches included.
    fn number(&self) -> Option<f64>;
    /// A number that is written without a point.
    fn whole(&self) -> Option<i64>;
    /// Whether it is null.
    fn is_null(&self) -> bool;
    /// Text of the value for a message.
    fn written(&self) -> String;
    /// The same, or the type of the value where that is long.
    fn described(&self) -> String;
}

impl ValueNode for &Value {
    fn field(&self, name: &str) -> Option<Self> {
        self.get(name)
    }

    fn names(&self) -> Vec<String> {
        self.as_object().into_iter().flat_map(serde_json::Map::keys).cloned().collect()
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
