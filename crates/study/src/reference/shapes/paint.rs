//! Colours of shapes between their vertices.

use wavesplat_core::Paint;

/// Straight RGBA where vertices have these weights, which sum to 1; `None` where the value is not a number.
pub(super) fn color(paint: &Paint, vertices: &[(usize, f64)]) -> Option<[f64; 4]> {
    match paint {
        Paint::Even([r, g, b]) => Some([*r, *g, *b, 1.0].map(f64::from)),
        Paint::Each(rgba) => {
            Some([0, 1, 2, 3].map(|c| vertices.iter().map(|(v, weight)| weight * f64::from(rgba[*v][c])).sum()))
        }
        Paint::Mapped { values, limits, table } => {
            let value: f64 = vertices.iter().map(|(v, weight)| weight * f64::from(values[*v])).sum();
            (!value.is_nan()).then(|| looked_up(value, *limits, table))
        }
    }
}

/// Whether vertices have colours: values that are not numbers have none, and nothing between them and others has.
pub(super) fn has_colors(paint: &Paint, vertices: &[usize]) -> bool {
    match paint {
        Paint::Even(_) | Paint::Each(_) => true,
        Paint::Mapped { values, .. } => vertices.iter().all(|v| !values[*v].is_nan()),
    }
}

/// The entry of a table for a value, linear between two entries.
fn looked_up(value: f64, limits: [f32; 2], table: &[[f32; 4]]) -> [f64; 4] {
    let [lo, hi] = limits.map(f64::from);
    let last = table.len() - 1;
    let place = ((value - lo) / (hi - lo) * last as f64).clamp(0.0, last as f64);
    let below = place.floor() as usize;
    let share = place - below as f64;
    let [a, b] = [table[below], table[(below + 1).min(last)]].map(|rgba| rgba.map(f64::from));
    [0, 1, 2, 3].map(|c| a[c] + (b[c] - a[c]) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_before_the_table() {
        let table = vec![[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0]];
        let mapped = Paint::Mapped { values: vec![10.0, 30.0, f32::NAN, 1e9], limits: [10.0, 30.0], table };
        let at = |vertices: &[(usize, f64)]| color(&mapped, vertices);
        // Half way between the ends of the table is its middle entry, not the mean of the ends.
        assert_eq!(at(&[(0, 0.5), (1, 0.5)]), Some([1.0, 0.0, 0.0, 0.5]));
        assert_eq!(at(&[(0, 0.75), (1, 0.25)]), Some([0.5, 0.0, 0.0, 0.75]));
        assert_eq!([at(&[(1, 1.0)]), at(&[(3, 1.0)])], [Some([0.0, 0.0, 1.0, 0.0]); 2]);
        assert_eq!([at(&[(2, 1.0)]), at(&[(0, 0.5), (2, 0.5)]), at(&[(0, 1.0), (2, 0.0)])], [None; 3]);
        assert!(has_colors(&mapped, &[0, 1]) && !has_colors(&mapped, &[0, 2]));
        let each = Paint::Each(vec![[0.0, 0.0, 1.0, 1.0], [1.0, 0.5, 0.0, 0.0]]);
        assert_eq!(color(&each, &[(0, 0.25), (1, 0.75)]), Some([0.75, 0.375, 0.25, 0.25]));
    }
}
