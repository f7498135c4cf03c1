//! Visible samples of a tile, slice by slice in the order of the rays, and their densities.
//!
//! Densities are read for a dozen slices at a time: slices across x have their samples a whole row apart in memory and
//! are turned together, and volumes that are decoded give a box as quickly as a slice.

use wavesplat_compute::simd::{LANES, Level};
use wavesplat_splat::source::block_cache::DensityBox;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::source::window::Window;

use super::FamilyScene;

/// Samples of one slice that a tile shows.
#[derive(Clone, Copy, Debug)]
pub struct SampleLayer {
    /// The slice.
    pub slice: usize,
    /// Samples along u and v, all inside the volume.
    pub window: Window,
}

/// The layers of a tile that may have something visible, front to back. `hull`: ranges of u and v, in samples, that the
/// tile shows of a slice; `None` where it shows nothing.
pub fn visible_layers(family: &FamilyScene, hull: impl Fn(f64) -> Option<[[f64; 2]; 2]>) -> Vec<SampleLayer> {
    let [n_u, n_v, n_w] = family.size();
    let occupied = &family.occupied;
    let layer = |slice: usize| {
        let [u, v] = hull(slice as f64)?;
        let window = Window { u: inside(u, n_u)?, v: inside(v, n_v)? };
        let Some(occupied) = occupied else { return Some(SampleLayer { slice, window }) };
        let touched = |axis: usize, [lo, hi]: [i64; 2]| occupied.touched(axis, [lo as f64, hi as f64]);
        // The last slice belongs to the cells before it.
        let layer = occupied.layer(slice.min(n_w - 2));
        occupied.any(touched(0, window.u)?, touched(1, window.v)?, [layer; 2]).then_some(SampleLayer { slice, window })
    };
    let in_order = |k: usize| if family.family.ascending { k } else { n_w - 1 - k };
    (0..n_w).map(in_order).filter_map(layer).collect()
}

/// Samples of an axis of `n` between two positions, both rounded outwards.
fn inside([lo, hi]: [f64; 2], n: usize) -> Option<[i64; 2]> {
    let last = (n - 1) as f64;
    // Comparisons that are false for NaN count as outside.
    (lo <= hi && hi >= 0.0 && lo <= last).then(|| [lo.max(0.0).floor() as i64, hi.min(last).ceil() as i64])
}

/// Approximate size of a box of samples where slices run along rows of memory: a share of the second-level cache.
const BOX_SAMPLES: usize = 1 << 18;

/// Densities of a box of samples, slice by slice; with a border where gradients are wanted.
pub struct Densities {
    /// First and last slice that the box serves.
    served: [usize; 2],
    /// First slice of the box.
    first: usize,
    /// Samples of the box along u and v; beyond the volume, its edge is repeated.
    window: Window,
    stride: usize,
    values: Vec<f32>,
    /// Above 0 at samples that are drawn as empty; no elements where there are none.
    holes: Vec<f32>,
    part: DensityBox,
}

impl Default for Densities {
    fn default() -> Self {
        Self {
            served: [1, 0],
            first: 0,
            window: Window { u: [0, 0], v: [0, 0] },
            stride: 0,
            values: Vec::new(),
            holes: Vec::new(),
            part: DensityBox::default(),
        }
    }
}

impl Densities {
    /// Loads the layer at place `k`, unless the box has it, and reads ahead.
    pub fn cover(&mut self, family: &FamilyScene, layers: &[SampleLayer], k: usize) {
        let slice = layers[k].slice;
        if self.served[0] <= slice && slice <= self.served[1] {
            return;
        }
        let border = usize::from(family.needs_gradient());
        let n_w = family.size()[2];
        // At most the slices that are turned at once, or that the cache holds.
        let area = (layers[k].window.n_u() + 2) * (layers[k].window.n_v() + 2);
        let across = family.family.axes[0] != 0;
        let most = if across { LANES - 2 * border } else { (BOX_SAMPLES / area).clamp(1, LANES - 2 * border) };
        let run = layers[k..].iter().take_while(|layer| layer.slice.abs_diff(slice) < most);
        let mut window = layers[k].window;
        let mut last = slice;
        for layer in run {
            let hull = |[a, b]: [i64; 2], [c, d]: [i64; 2]| [a.min(c), b.max(d)];
            window = Window { u: hull(window.u, layer.window.u), v: hull(window.v, layer.window.v) };
            last = layer.slice;
        }
        self.served = [slice.min(last), slice.max(last)];
        let widened = |[lo, hi]: [i64; 2]| [lo - border as i64, hi + border as i64];
        self.window = Window { u: widened(window.u), v: widened(window.v) };
        self.first = self.served[0].saturating_sub(border);
        // Slices across x are turned `LANES` at a time.
        let last = if across { self.first + LANES - 1 } else { self.served[1] + border };
        let last = last.min(n_w - 1);
        self.stride = self.window.n_u().next_multiple_of(LANES);
        let scene = family.scene;
        self.read(scene.level, scene.slices, family.family.axes, last);
    }

    fn read(&mut self, level: Level, slices: &Slices, axes: [usize; 3], last: usize) {
        let plane = self.stride * self.window.n_v();
        let across = axes[0] != 0;
        let n_planes = if across { LANES } else { last + 1 - self.first };
        // Vectors may be read from any sample on.
        self.values.resize(plane * n_planes + LANES, 0.0);
        let (window, stride) = (self.window, self.stride);
        slices.load(axes, window, [self.first, last], &mut self.part);
        if across {
            slices.write_transposed(
                level,
                axes,
                self.first,
                window,
                &self.part,
                &mut self.values[..plane * n_planes],
                stride,
            );
        } else {
            for slice in self.first..=last {
                let taps = [(slice, 1.0)];
                let out = &mut self.values[(slice - self.first) * plane..];
                if slices.must_load() {
                    slices.combine_part(level, axes, &self.part, &taps, window, out, stride);
                } else {
                    slices.combine(level, axes, &taps, None, window, out, stride);
                }
            }
        }
        if slices.has_mask() {
            self.holes.resize(plane * n_planes + LANES, 0.0);
            for slice in self.first..=last {
                let out = &mut self.holes[(slice - self.first) * plane..];
                slices.combine_mask(level, axes, &[(slice, 1.0)], window, out, stride);
            }
        }
    }

    /// Offset of a sample; neighbours along v are [`Densities::stride`] apart, along w [`Densities::plane`].
    #[inline(always)]
    pub fn place(&self, slice: usize, u: i64, v: i64) -> usize {
        (slice - self.first) * self.plane()
            + (v - self.window.v[0]) as usize * self.stride
            + (u - self.window.u[0]) as usize
    }

    /// Values per row.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Values per slice.
    #[inline(always)]
    pub fn plane(&self) -> usize {
        self.stride * self.window.n_v()
    }

    /// Densities of [`LANES`] samples from a place on.
    #[inline(always)]
    pub fn at(&self, place: usize) -> &[f32; LANES] {
        const NONE: &[f32; LANES] = &[f32::NAN; LANES];
        // A vector of padding follows the last sample.
        self.values[place..].first_chunk().unwrap_or(NONE)
    }

    /// Bit mask of the samples from a place on that are drawn as empty.
    #[inline(always)]
    pub fn holes(&self, place: usize) -> u16 {
        let Some(holes) = self.holes.get(place..).and_then(|holes| holes.first_chunk::<LANES>()) else { return 0 };
        (0..LANES).fold(0, |bits, i| bits | (u16::from(holes[i] > 0.0) << i))
    }
}
