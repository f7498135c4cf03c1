//! Numbers in words, as reasons of kinds and looks have them.

/// A number with a few digits that count, as C's `%.*g` has it: 0.0031, 12, 1e-07.
pub fn in_digits(value: f64, n_digits: usize) -> String {
    let text = format!("{value:.*e}", n_digits.max(1) - 1);
    let Some((digits, power)) = text.split_once('e') else { return text.to_lowercase() };
    let power: i32 = power.parse().unwrap_or(0);
    let without_zeros = |text: &str| {
        let kept = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
        kept.to_owned()
    };
    if power < -4 || power >= n_digits as i32 {
        let sign = if power < 0 { '-' } else { '+' };
        return format!("{}e{sign}{:02}", without_zeros(digits), power.abs());
    }
    without_zeros(&format!("{value:.*}", (n_digits as i32 - 1 - power).max(0) as usize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_digits_that_count() {
        let shown = [0.0, 1024.0, 0.0031, 0.0625, 1e-7, 123_456.0, 1_234_567.0, -2.5].map(|value| in_digits(value, 6));
        assert_eq!(shown, ["0", "1024", "0.0031", "0.0625", "1e-07", "123456", "1.23457e+06", "-2.5"]);
        assert_eq!([99.96, 0.0996, 1.225].map(|value| in_digits(value, 3)), ["100", "0.0996", "1.23"]);
        assert_eq!([f64::NAN, f64::NEG_INFINITY].map(|value| in_digits(value, 3)), ["nan", "-inf"]);
    }
}
