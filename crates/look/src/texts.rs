//! Names as people write them.

/// Whether a character is blank, the separators of ASCII among them.
pub fn is_blank(c: char) -> bool {
    c.is_whitespace() || ('\u{1c}'..='\u{1f}').contains(&c)
}

/// A name without differences that do not matter: case and kinds of separators.
pub fn plain(name: &str) -> String {
    let small = name.trim_matches(is_blank).to_lowercase();
    let mut found = String::with_capacity(small.len());
    for c in small.chars() {
        if !(is_blank(c) || c == '-' || c == '_') {
            found.push(c);
        } else if !found.ends_with('-') {
            found.push('-');
        }
    }
    found
}
