//! Trilinear interpolation and central differences in a decoded box of samples.

use wavesplat_compute::parallel;
use wavesplat_core::Decoder;

/// Offset of the central differences that estimate the gradient, in samples of the level.
pub(crate) const GRADIENT_OFFSET: f64 = 1.0;

/// Slices that one task decodes.
const SLICES_PER_TASK: usize = 32;

/// Decoded samples of a box of a volume.
pub(crate) struct SampleBox {
    /// Size of the whole volume.
    pub size: [usize; 3],
    /// First sample and size of the box.
    lo: [usize; 3],
    n: [usize; 3],
    values: Vec<f32>,
}

impl SampleBox {
    /// Decodes the box from `lo` to before `hi`.
    pub fn new(decoder: &dyn Decoder, lo: [usize; 3], hi: [usize; 3]) -> Self {
        let n = [0, 1, 2].map(|a| hi[a] - lo[a]);
        let mut values = vec![0.0; n.iter().product()];
        let layer = n[0] * n[1] * SLICES_PER_TASK;
        parallel::for_each_chunk(&mut values, layer, |k, values| {
            let first = [lo[0], lo[1], lo[2] + k * SLICES_PER_TASK];
            decoder.decode(first, [hi[0], hi[1], (first[2] + SLICES_PER_TASK).min(hi[2])], values);
        });
        Self { size: decoder.size(), lo, n, values }
    }

    /// Decodes the box around rays along an axis that stay between two index positions.
    pub fn around(decoder: &dyn Decoder, axis: usize, first: [f64; 3], end: [f64; 3]) -> Self {
        let (mut lo, mut hi) = ([0; 3], decoder.size());
        for a in [(axis + 1) % 3, (axis + 2) % 3] {
            // The box includes the samples that gradient differences reach.
            lo[a] = ((first[a] - GRADIENT_OFFSET).max(0.0) as usize).min(hi[a] - 1);
            hi[a] = ((end[a] + GRADIENT_OFFSET).max(0.0) as usize + 2).min(hi[a]);
        }
        Self::new(decoder, lo, hi)
    }

    /// Trilinear interpolation at an index position, clamped to the box.
    fn at(&self, position: [f64; 3]) -> f32 {
        let mut first = 0;
        let (mut strides, mut weights) = ([1, self.n[0], self.n[0] * self.n[1]], [0.0; 3]);
        for a in 0..3 {
            let x = (position[a] - self.lo[a] as f64).clamp(0.0, (self.n[a] - 1) as f64);
            let below = (x as usize).min(self.n[a].saturating_sub(2));
            first += below * strides[a];
            weights[a] = (x - below as f64) as f32;
            // A box of one sample has no neighbour: its weight is 0, so any valid index will do.
            strides[a] *= usize::from(self.n[a] > 1);
        }
        let [tx, ty, tz] = weights;
        let between = |i: usize, stride: usize, t: f32| self.values[i] + (self.values[i + stride] - self.values[i]) * t;
        let row = |i: usize| between(i, strides[0], tx);
        let plane = |i: usize| row(i) + (row(i + strides[1]) - row(i)) * ty;
        plane(first) + (plane(first + strides[2]) - plane(first)) * tz
    }

    /// Value at a position, and values at both ends of the central difference along each axis.
    pub fn with_neighbours(&self, position: [f64; 3]) -> (f32, [[f32; 2]; 3]) {
        self.inner_neighbours(position).unwrap_or_else(|| {
            let end = |a: usize, offset: f64| {
                let mut end = position;
                end[a] = (end[a] + offset).clamp(0.0, (self.size[a] - 1) as f64);
                self.at(end)
            };
            (self.at(position), [0, 1, 2].map(|a| [-GRADIENT_OFFSET, GRADIENT_OFFSET].map(|offset| end(a, offset))))
        })
    }

    /// [`SampleBox::with_neighbours`] where all of it is inside: a whole sample further on the interpolation weights
    /// are the same, so they are computed once.
    #[inline]
    fn inner_neighbours(&self, position: [f64; 3]) -> Option<(f32, [[f32; 2]; 3])> {
        const { assert!(GRADIENT_OFFSET == 1.0, "weights are the same a whole sample further on") };
        let strides = [1, self.n[0], self.n[0] * self.n[1]];
        let (mut first, mut weights) = (0, [0.0; 3]);
        for a in 0..3 {
            let x = position[a] - self.lo[a] as f64;
            if x < 1.0 || x + 2.0 >= (self.n[a] - 1) as f64 {
                return None;
            }
            first += x as usize * strides[a];
            weights[a] = (x - x.floor()) as f32;
        }
        let [tx, ty, tz] = weights;
        let at = |i: usize| {
            let row = |i: usize| self.values[i] + (self.values[i + 1] - self.values[i]) * tx;
            let plane = |i: usize| row(i) + (row(i + strides[1]) - row(i)) * ty;
            plane(i) + (plane(i + strides[2]) - plane(i)) * tz
        };
        Some((at(first), strides.map(|stride| [at(first - stride), at(first + stride)])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_found_at_once_where_they_are_inside() {
        let (size, lo, n) = ([20, 30, 40], [5, 0, 12], [9, 30, 11]);
        let random = |i: usize| ((i as f64 * 12.9898).sin() * 43_758.545).rem_euclid(1.0);
        let values = (0..n.iter().product()).map(|i| random(i) as f32).collect();
        let samples = SampleBox { size, lo, n, values };
        let mut n_inner = 0;
        for i in 0..2000 {
            let position = [0, 1, 2].map(|a| lo[a] as f64 + random(3 * i + a) * (n[a] - 1) as f64);
            let Some((value, ends)) = samples.inner_neighbours(position) else { continue };
            n_inner += 1;
            assert!((value - samples.at(position)).abs() < 1e-6);
            for a in 0..3 {
                for (k, offset) in [-GRADIENT_OFFSET, GRADIENT_OFFSET].into_iter().enumerate() {
                    let mut end = position;
                    end[a] += offset;
                    assert!((ends[a][k] - samples.at(end)).abs() < 1e-6, "{position:?} {a} {offset}");
                }
            }
        }
        assert!(n_inner > 500);
    }
}
