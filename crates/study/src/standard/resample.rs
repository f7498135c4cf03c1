//! Resampling of a picture to another size: a pixel is the mean of the texels that it covers, or, where texels are
//! larger than pixels, linear between them.

use wavesplat_compute::parallel;

/// First texel and weights of sum 1 for each of `n_to` pixels in a row of `n_from` texels.
fn weights(n_from: usize, n_to: usize) -> Vec<(usize, Vec<f32>)> {
    let ratio = n_from as f64 / n_to as f64;
    // A box as wide as a pixel, or a tent as wide as two texels.
    let covered = |at: f64, texel: f64| {
        if ratio >= 1.0 {
            ((at + 0.5 * ratio).min(texel + 1.0) - (at - 0.5 * ratio).max(texel)).max(0.0)
        } else {
            (1.0 - (texel + 0.5 - at).abs()).max(0.0)
        }
    };
    let half = 0.5 * ratio.max(2.0);
    let taps = |pixel: usize| {
        let at = (pixel as f64 + 0.5) * ratio;
        let first = (at - half).floor().max(0.0) as usize;
        let last = ((at + half).ceil() as usize).min(n_from);
        let weights: Vec<f64> = (first..last).map(|texel| covered(at, texel as f64)).collect();
        let sum: f64 = weights.iter().sum();
        (first, weights.iter().map(|w| (w / sum) as f32).collect())
    };
    (0..n_to).map(taps).collect()
}

/// Resamples a picture. `from`: its texels, row by row.
pub fn resample(from: &[[f32; 4]], [n_u, n_v]: [usize; 2], [width_px, height_px]: [usize; 2]) -> Vec<[f32; 4]> {
    let (across, down) = (weights(n_u, width_px), weights(n_v, height_px));
    let mut picture = vec![[0.0; 4]; width_px * height_px];
    parallel::for_each_chunk(&mut picture, width_px, |y, out| {
        let mut row = vec![[0.0_f32; 4]; n_u];
        let (first, weights) = &down[y];
        for (k, weight) in weights.iter().enumerate() {
            for (sum, texel) in row.iter_mut().zip(&from[(first + k) * n_u..(first + k + 1) * n_u]) {
                (0..4).for_each(|c| sum[c] += weight * texel[c]);
            }
        }
        for (pixel, (first, weights)) in out.iter_mut().zip(&across) {
            for (texel, weight) in row[*first..].iter().zip(weights) {
                (0..4).for_each(|c| pixel[c] += weight * texel[c]);
            }
        }
    });
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_means_or_linear_between_texels() {
        let row = |values: &[f32]| values.iter().map(|v| [*v; 4]).collect::<Vec<_>>();
        let resampled = |values: &[f32], n: usize| {
            resample(&row(values), [values.len(), 1], [n, 1]).iter().map(|p| p[0]).collect::<Vec<_>>()
        };
        assert_eq!(resampled(&[1.0, 3.0, 5.0, 9.0], 2), [2.0, 7.0]);
        assert_eq!(resampled(&[1.0, 3.0], 2), [1.0, 3.0]);
        assert_eq!(resampled(&[0.0, 4.0], 4), [0.0, 1.0, 3.0, 4.0]);
        let thirds = resampled(&[3.0, 6.0, 9.0], 2);
        assert!((thirds[0] - 4.0).abs() < 1e-6 && (thirds[1] - 8.0).abs() < 1e-6, "{thirds:?}");
        let columns = resample(&row(&[1.0, 3.0]), [1, 2], [1, 1]);
        assert_eq!(columns, [[2.0; 4]]);
    }
}
