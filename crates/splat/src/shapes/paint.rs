//! Colours of shapes at places between their vertices.

use wavesplat_core::{Card, Paint};

/// Straight RGBA of a paint at a mean of places with weights that add up to 1; `None` where a value is not a number.
#[inline(always)]
pub fn color_at<const N: usize>(paint: &Paint, places: [u32; N], weights: [f32; N]) -> Option<[f32; 4]> {
    match paint {
        Paint::Even([r, g, b]) => Some([*r, *g, *b, 1.0]),
        Paint::Each(colors) => {
            let mut mean = [0.0; 4];
            for (place, weight) in places.into_iter().zip(weights) {
                let color = colors[place as usize];
                for c in 0..4 {
                    mean[c] += weight * color[c];
                }
            }
            Some(mean)
        }
        Paint::Mapped { values, limits: [lo, hi], table } => {
            let mut value = 0.0;
            for (place, weight) in places.into_iter().zip(weights) {
                value += weight * values[place as usize];
            }
            let share = (value - lo) / (hi - lo);
            if share.is_nan() { None } else { Some(look_up(table, share)) }
        }
    }
}

/// Entry of a table at a share of the way from its first to its last entry.
#[inline(always)]
fn look_up(table: &[[f32; 4]], share: f32) -> [f32; 4] {
    let at = share.clamp(0.0, 1.0) * (table.len() - 1) as f32;
    let first = (at as usize).min(table.len() - 1);
    let next = (first + 1).min(table.len() - 1);
    mixed(table[first], table[next], at - first as f32)
}

fn mixed(a: [f32; 4], b: [f32; 4], share: f32) -> [f32; 4] {
    [0, 1, 2, 3].map(|c| a[c] + share * (b[c] - a[c]))
}

/// Straight RGBA of a card at shares of its columns and rows: linear between the middles of pixels.
pub fn texture_at(card: &Card, shares: [f32; 2]) -> [f32; 4] {
    let [x, y] = [0, 1].map(|k| {
        let last = (card.size[k] - 1) as f32;
        let at = (shares[k] * card.size[k] as f32 - 0.5).clamp(0.0, last);
        let first = at as usize;
        (first, (first + 1).min(card.size[k] - 1), at - first as f32)
    });
    let row = |j: usize| {
        let pixel = |i: usize| {
            let [r, g, b, a] = card.rgba[j * card.size[0] + i];
            [r * a, g * a, b * a, a]
        };
        mixed(pixel(x.0), pixel(x.1), x.2)
    };
    // Colours mix by their opacity: what a clear pixel would show is of no meaning.
    let [r, g, b, a] = mixed(row(y.0), row(y.1), y.2);
    if a > 0.0 { [r / a, g / a, b / a, a] } else { [0.0; 4] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_before_they_are_coloured() {
        let table = vec![[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], [1.0; 4]];
        let paint = Paint::Mapped { values: vec![0.0, 10.0, f32::NAN, 100.0], limits: [0.0, 10.0], table };
        assert_eq!(color_at(&paint, [0, 1], [0.5, 0.5]), Some([1.0, 0.0, 0.0, 1.0]));
        assert_eq!(color_at(&paint, [0, 1], [0.75, 0.25]), Some([0.5, 0.0, 0.0, 1.0]));
        assert_eq!(color_at(&paint, [3], [1.0]), Some([1.0; 4]));
        assert_eq!(color_at(&paint, [0, 2], [0.5, 0.5]), None);
    }
}
