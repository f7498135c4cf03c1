//! The slice source: samples (or spline coefficients) of any region of the volume as densities in f32.
//!
//! Narrow samples stay in their own type and are converted in the innermost loop. Two cases need a float copy: the
//! B-spline kernels (their coefficients are not the samples), and float data with NaN or infinity. There the holes
//! are filled from their neighbours, so that the surroundings keep an honest gradient, and a mask says where they
//! are: what a masked sample reaches is drawn as empty.

use wavesplat_core::{Kernel, Sample, Samples, Statistics, Volume, with_samples};

use crate::kernel::fold;
use crate::simd::Level;
use crate::{parallel, prefilter};

/// Densities of a volume, ready for one kernel.
pub struct Slices<'a> {
    kernel: Kernel,
    data: Data<'a>,
    size: [usize; 3],
    mask: Option<Vec<bool>>,
    range: [f32; 2],
}

enum Data<'a> {
    /// Samples in their own type and the density map `(offset, scale)`.
    Native(Samples<'a>, (f64, f64)),
    /// Densities or spline coefficients.
    Float(Vec<f32>),
}

/// One tap along the sheet axis: folded slice index and weight.
pub type SliceTap = (usize, f32);

/// A rectangle of sample positions in a slice, `u` and `v` inclusive, before folding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First and last index along u.
    pub u: [i64; 2],
    /// First and last index along v.
    pub v: [i64; 2],
}

impl Window {
    /// Samples per row.
    pub fn n_u(&self) -> usize {
        (self.u[1] - self.u[0] + 1) as usize
    }

    /// Rows.
    pub fn n_v(&self) -> usize {
        (self.v[1] - self.v[0] + 1) as usize
    }
}

impl<'a> Slices<'a> {
    /// Prepares a volume for a kernel: nothing for narrow samples and a kernel without prefilter.
    pub fn new(volume: &Volume<'a>, kernel: Kernel) -> Self {
        let map = volume.density_from_sample();
        let size = volume.size();
        let Statistics { min, max, n_nonfinite } = volume.statistics();
        let range = [min, max].map(|s| ((s - map.0) * map.1) as f32);
        let pole = prefilter::pole(kernel);
        if pole.is_none() && n_nonfinite == 0 {
            return Self { kernel, data: Data::Native(*volume.samples(), map), size, mask: None, range };
        }
        let mut grid = densities(volume.samples(), map);
        let mask = (n_nonfinite > 0).then(|| grid.iter().map(|d| !d.is_finite()).collect());
        if mask.is_some() {
            fill_holes(&mut grid, size);
        }
        if let Some(z) = pole {
            prefilter::prefilter_volume(&mut grid, size, z);
        }
        Self { kernel, data: Data::Float(grid), size, mask, range }
    }

    /// The same without a borrow, where a float copy was made: what is worth keeping between pictures.
    pub fn into_owned(self) -> Option<Slices<'static>> {
        let Data::Float(grid) = self.data else { return None };
        Some(Slices {
            kernel: self.kernel,
            data: Data::Float(grid),
            size: self.size,
            mask: self.mask,
            range: self.range,
        })
    }

    /// The kernel that the densities are for.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Smallest and largest finite density.
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// Whether there are samples that are drawn as empty.
    pub fn has_mask(&self) -> bool {
        self.mask.is_some()
    }

    /// Bytes held beside the caller's samples.
    pub fn n_bytes(&self) -> usize {
        let float = if let Data::Float(grid) = &self.data { 4 * grid.len() } else { 0 };
        float + self.mask.as_ref().map_or(0, Vec::len)
    }

    /// Density (or coefficient) at an index position, in f64: the slow door for the reference.
    pub fn at(&self, index: [usize; 3]) -> f64 {
        let i = index[0] + self.size[0] * (index[1] + self.size[1] * index[2]);
        match &self.data {
            Data::Native(samples, (offset, scale)) => (samples.get(i) - offset) * scale,
            Data::Float(grid) => f64::from(grid[i]),
        }
    }

    /// Whether the sample at an index position is drawn as empty.
    pub fn is_hole(&self, index: [usize; 3]) -> bool {
        let i = index[0] + self.size[0] * (index[1] + self.size[1] * index[2]);
        self.mask.as_ref().is_some_and(|m| m[i])
    }

    /// `out[v][u] = Σ weight · density` over the slices of `taps`; `axes` are the index axes called u, v, w.
    pub fn combine(&self, level: Level, axes: [usize; 3], taps: &[SliceTap], window: Window, out: &mut Vec<f32>) {
        out.clear();
        out.resize(window.n_u() * window.n_v(), 0.0);
        let region = Region::new(self.kernel, self.size, axes, window);
        match &self.data {
            Data::Float(grid) => level.run(
                #[inline(always)]
                || region.accumulate(grid, taps, out, |d| d),
            ),
            Data::Native(samples, (offset, scale)) => {
                let (offset, scale) = (*offset, *scale);
                if samples.is_narrow() {
                    with_samples!(samples, s => level.run(#[inline(always)] || region.accumulate(s, taps, out, Sample::to_f32)));
                } else {
                    with_samples!(samples, s => level.run(#[inline(always)] || region.accumulate(s, taps, out, |s| ((s.to_f64() - offset) * scale) as f32)));
                }
            }
        }
    }

    /// As [`Slices::combine`] for the mask: above 0 where a hole is reached.
    pub fn combine_mask(&self, level: Level, axes: [usize; 3], taps: &[SliceTap], window: Window, out: &mut Vec<f32>) {
        out.clear();
        out.resize(window.n_u() * window.n_v(), 0.0);
        if let Some(mask) = &self.mask {
            let region = Region::new(self.kernel, self.size, axes, window);
            level.run(
                #[inline(always)]
                || region.accumulate(mask, taps, out, |hole| if hole { 1.0 } else { 0.0 }),
            );
        }
    }
}

/// A window of a strided grid with its border folded back.
struct Region {
    kernel: Kernel,
    stride: [usize; 3],
    n: [usize; 3],
    window: Window,
}

impl Region {
    fn new(kernel: Kernel, size: [usize; 3], axes: [usize; 3], window: Window) -> Self {
        let all = [1, size[0], size[0] * size[1]];
        Self { kernel, stride: axes.map(|a| all[a]), n: axes.map(|a| size[a]), window }
    }

    #[inline(always)]
    fn accumulate<T: Copy>(&self, grid: &[T], taps: &[SliceTap], out: &mut [f32], density: impl Fn(T) -> f32) {
        let Window { u: [u_lo, u_hi], v: [v_lo, _] } = self.window;
        let [su, sv, sw] = self.stride;
        let last = self.n[0] as i64 - 1;
        // Columns that need no folding.
        let inner_lo = u_lo.clamp(0, last);
        let inner_hi = u_hi.clamp(0, last);
        let n_left = (inner_lo - u_lo) as usize;
        let n_inner = (inner_hi - inner_lo + 1) as usize;
        for (r, row) in out.chunks_exact_mut(self.window.n_u()).enumerate() {
            let v = fold(self.kernel, v_lo + r as i64, self.n[1]);
            for &(slice, weight) in taps {
                let start = slice * sw + v * sv;
                let at = |i: i64| weight * density(grid[start + fold(self.kernel, i, self.n[0]) * su]);
                for (c, o) in row[..n_left].iter_mut().enumerate() {
                    *o += at(u_lo + c as i64);
                }
                for (c, o) in row[n_left + n_inner..].iter_mut().enumerate() {
                    *o += at(inner_hi + 1 + c as i64);
                }
                let inner = &mut row[n_left..n_left + n_inner];
                let from = start + inner_lo as usize * su;
                if su == 1 {
                    for (o, s) in inner.iter_mut().zip(&grid[from..from + n_inner]) {
                        *o += weight * density(*s);
                    }
                } else {
                    for (o, s) in inner.iter_mut().zip(grid[from..].iter().step_by(su)) {
                        *o += weight * density(*s);
                    }
                }
            }
        }
    }
}

fn densities(samples: &Samples, (offset, scale): (f64, f64)) -> Vec<f32> {
    with_samples!(samples, s => s.iter().map(|s| ((s.to_f64() - offset) * scale) as f32).collect())
}

/// Replaces what is not finite by the nearest finite density of its row; then, for rows without any, of its column;
/// then of its line through the slices.
fn fill_holes(grid: &mut [f32], [nx, ny, nz]: [usize; 3]) {
    parallel::for_each_chunk(grid, nx * ny, |_, slice| {
        for y in 0..ny {
            fill_line(slice, y * nx, 1, nx);
        }
        for x in 0..nx {
            fill_line(slice, x, nx, ny);
        }
    });
    for i in 0..nx * ny {
        fill_line(grid, i, nx * ny, nz);
    }
}

fn fill_line(grid: &mut [f32], start: usize, stride: usize, n: usize) {
    let mut before: Option<usize> = None;
    let mut i = 0;
    while i < n {
        if grid[start + i * stride].is_finite() {
            before = Some(i);
            i += 1;
            continue;
        }
        let after = (i..n).find(|&k| grid[start + k * stride].is_finite());
        let end = after.unwrap_or(n);
        for k in i..end {
            let source = match (before, after) {
                (Some(b), Some(a)) => Some(if k - b <= a - k { b } else { a }),
                (b, a) => b.or(a),
            };
            if let Some(source) = source {
                grid[start + k * stride] = grid[start + source * stride];
            }
        }
        i = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;

    #[test]
    fn holes_take_their_nearest_neighbour() {
        let nan = f32::NAN;
        let mut grid = vec![1.0, nan, nan, 4.0, nan, nan, nan, nan, 5.0, 6.0, 7.0, f32::INFINITY];
        fill_holes(&mut grid, [4, 1, 3]);
        assert_eq!(grid, [1.0, 1.0, 4.0, 4.0, 1.0, 1.0, 4.0, 4.0, 5.0, 6.0, 7.0, 7.0]);
    }

    #[test]
    fn any_axis_and_any_type_give_the_same_window() {
        let size = [5, 4, 3];
        let values: Vec<u8> = (0..60).map(|i| (i * 7 % 60) as u8).collect();
        let wide: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let narrow = Volume::new("narrow", Samples::U8(&values), size, DAffine3::IDENTITY).unwrap();
        let float = Volume::new("float", Samples::F64(&wide), size, DAffine3::IDENTITY).unwrap();
        let (offset, scale) = float.density_from_sample();
        let (narrow, float) = (Slices::new(&narrow, Kernel::Linear), Slices::new(&float, Kernel::Linear));
        for axes in [[0, 1, 2], [0, 2, 1], [1, 2, 0]] {
            let window = Window { u: [-2, size[axes[0]] as i64 + 1], v: [-1, size[axes[1]] as i64] };
            let taps = [(0, 0.25), (2, 0.75)];
            let (mut a, mut b) = (Vec::new(), Vec::new());
            narrow.combine(Level::best(), axes, &taps, window, &mut a);
            float.combine(Level::best(), axes, &taps, window, &mut b);
            for (i, (a, b)) in a.iter().zip(&b).enumerate() {
                let (u, v) = (window.u[0] + (i % window.n_u()) as i64, window.v[0] + (i / window.n_u()) as i64);
                let mut index = [0; 3];
                index[axes[0]] = u.clamp(0, size[axes[0]] as i64 - 1) as usize;
                index[axes[1]] = v.clamp(0, size[axes[1]] as i64 - 1) as usize;
                let want: f64 = taps
                    .iter()
                    .map(|&(w, weight)| {
                        index[axes[2]] = w;
                        f64::from(weight) * narrow.at(index)
                    })
                    .sum();
                assert!((f64::from(*a) - want).abs() < 1e-5, "{axes:?} {u} {v}");
                assert!((f64::from(*b) / scale + offset - want).abs() < 1e-4, "{axes:?} {u} {v}");
            }
        }
    }
}
