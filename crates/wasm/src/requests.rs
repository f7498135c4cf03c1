//! Fields of questions.

use serde_json::Value;

/// The text of a question as JSON.
pub fn parsed(text: &[u8]) -> Result<Value, String> {
    serde_json::from_slice(text).map_err(|error| format!("not JSON: {error}"))
}

/// A number in a field; `default` where there is none.
pub fn number(asked: &Value, name: &str, default: f64) -> Result<f64, String> {
    match asked.get(name) {
        None => Ok(default),
        Some(given) => given.as_f64().ok_or_else(|| format!("field '{name}' is {given}; give a number")),
    }
}

/// `N` numbers of a list.
pub fn numbers<const N: usize>(given: &Value, name: &str) -> Result<[f64; N], String> {
    let wrong = || format!("field '{name}' is {given}; give {N} numbers");
    let found: Option<Vec<f64>> = given.as_array().and_then(|items| items.iter().map(Value::as_f64).collect());
    found.and_then(|found| found.try_into().ok()).ok_or_else(wrong)
}

/// `N` whole numbers of a list, from 0 on.
pub fn counts<const N: usize>(given: &Value, name: &str) -> Result<[usize; N], String> {
    let wrong = || format!("field '{name}' is {given}; give {N} whole numbers");
    let count = |item: &Value| item.as_u64().and_then(|n| usize::try_from(n).ok());
    let found: Option<Vec<usize>> = given.as_array().and_then(|items| items.iter().map(count).collect());
    found.and_then(|found| found.try_into().ok()).ok_or_else(wrong)
}

/// A text in a field; `default` where there is none.
pub fn text<'a>(asked: &'a Value, name: &str, default: &'a str) -> Result<&'a str, String> {
    match asked.get(name) {
        None => Ok(default),
        Some(given) => given.as_str().ok_or_else(|| format!("field '{name}' is {given}; give a text")),
    }
}
