//! Even numbers, powers, and straight lines between nodes.

/// `n` even numbers from `first` to `last`; the first alone where `n` is 1.
pub fn linspace(first: f64, last: f64, n: usize) -> Vec<f64> {
    let step = (last - first) / n.saturating_sub(1).max(1) as f64;
    (0..n).map(|k| if k > 0 && k + 1 == n { last } else { k as f64 * step + first }).collect()
}

/// The value at `x` of straight lines between nodes at growing `xs`, held beyond their ends; of two nodes at one place
/// the last one counts.
pub fn interpolated(x: f64, xs: &[f64], ys: &[f64]) -> f64 {
    let last = xs.len() - 1;
    let after = xs.partition_point(|&node| node <= x);
    if after == 0 {
        return ys[0];
    }
    let k = after - 1;
    if k == last || xs[k] == x {
        return ys[k];
    }
    let slope = (ys[k + 1] - ys[k]) / (xs[k + 1] - xs[k]);
    slope * (x - xs[k]) + ys[k]
}

/// A power; roots and squares are exact.
pub fn power(base: f64, exponent: f64) -> f64 {
    match exponent {
        1.0 => base,
        2.0 => base * base,
        0.5 => base.sqrt(),
        -1.0 => 1.0 / base,
        _ => base.powf(exponent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_held_and_steps_belong_to_the_upper_side() {
        let (xs, ys) = ([0.0, 1.0, 1.0, 3.0], [0.0, 1.0, 5.0, 7.0]);
        let found = [-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0].map(|x| interpolated(x, &xs, &ys));
        assert_eq!(found, [0.0, 0.0, 0.5, 5.0, 6.0, 7.0, 7.0]);
    }

    #[test]
    fn even_numbers_end_at_the_last_one() {
        assert_eq!(linspace(0.0, 0.3, 4)[3], 0.3);
        assert_eq!(linspace(2.0, 5.0, 1), [2.0]);
    }
}
