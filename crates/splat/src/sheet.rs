//! The sheet of one tile: densities, and their gradient, at every texel of a plane parallel to the slices.
//!
//! Separable: slices are combined along w at sample resolution, then rows along u, then columns along v, so a tricubic
//! kernel costs 4 + 4 + 4 taps per texel at most, and less where texels are denser than samples. The gradient comes
//! from difference footprints along each axis; through the sheet it needs no neighbouring sheet.

use std::ops::Range;

use crate::base_plane::BasePlane;
use crate::footprint::{Axis, AxisFootprints, Footprint};
use crate::kernel::overshoot_2d;
use crate::simd::Level;
use crate::slices::{Slices, Window};

/// Texels of a tile along u: a row is the unit of the inner loops.
pub const TILE_U: usize = 64;

/// Texels of a tile along v.
pub const TILE_V: usize = 32;

/// Numbers of one row of texels.
pub type Row = [f32; TILE_U];

/// Sheet-wide facts of one base plane.
pub struct SheetGeometry<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    /// Samples.
    pub slices: &'a Slices<'a>,
    /// Axes u, v, w with kernel and gradient offset.
    pub axes: [Axis; 3],
    /// Vectors to use.
    pub level: Level,
}

impl<'a> SheetGeometry<'a> {
    /// `gradient_offset`: half distance of differences, voxels; `None` where no gradient is wanted.
    pub fn new(plane: &'a BasePlane, slices: &'a Slices<'a>, size: [usize; 3], gradient_offset: Option<f64>) -> Self {
        let axis = |a: usize| Axis { kernel: slices.kernel(), n_samples: size[a], offset: gradient_offset };
        Self { plane, slices, axes: plane.family.axes.map(axis), level: Level::best() }
    }
}

/// Work space and result of one tile's sheet. Made once per tile, reused for all its sheets; rows are reconstructed
/// when they are first asked for.
#[derive(Default)]
pub struct Sheet {
    w: f64,
    u: AxisFootprints,
    v: AxisFootprints,
    window: Option<Window>,
    /// Combined slices at sample resolution: density, derivative through the sheet, holes.
    density: Vec<f32>,
    through: Vec<f32>,
    holes: Vec<f32>,
    /// The same upsampled along u: density, derivative along u, derivative through the sheet, holes.
    density_u: Vec<Row>,
    along_u: Vec<Row>,
    through_u: Vec<Row>,
    holes_u: Vec<Row>,
    /// Sample rows that have been upsampled: densities, derivatives.
    has_density_u: Vec<bool>,
    has_gradient_u: Vec<bool>,
    has_through: bool,
    /// Variation of the transfer function up to each combined density; see [`Sheet::row_spread`].
    variation: Vec<f32>,
    rows: Vec<SheetRow>,
}

/// One row of a sheet.
#[derive(Clone)]
pub struct SheetRow {
    /// Densities.
    pub density: Row,
    /// Smallest and largest of them.
    pub range: [f32; 2],
    /// Derivatives along u, v, w per index step.
    pub gradient: [Row; 3],
    /// Above 0 where a hole is reached.
    pub hole: Row,
    has_density: bool,
    has_gradient: bool,
}

impl SheetRow {
    /// Nothing reconstructed yet.
    pub const EMPTY: Self = Self {
        density: [0.0; TILE_U],
        range: [0.0; 2],
        gradient: [[0.0; TILE_U]; 3],
        hole: [0.0; TILE_U],
        has_density: false,
        has_gradient: false,
    };
}

impl Sheet {
    /// Combines the slices that reach the sheet at `w` for the tile whose first texel is `(i0, j0)`, and returns bounds
    /// of the densities its texels can have.
    pub fn combine(&mut self, geometry: &SheetGeometry, w: f64, [i0, j0]: [usize; 2], n_rows: usize) -> [f32; 2] {
        self.w = w;
        self.variation.clear();
        self.rows.resize(n_rows, SheetRow::EMPTY);
        for row in &mut self.rows {
            row.has_density = false;
            row.has_gradient = false;
        }
        let [(u0, du), (v0, dv)] = geometry.plane.sheet(w);
        let [axis_u, axis_v, axis_w] = &geometry.axes;
        self.u.build(axis_u, u0 + du * i0 as f64, du, TILE_U);
        self.v.build(axis_v, v0 + dv * j0 as f64, dv, n_rows);
        let window = Window { u: self.u.window, v: self.v.window };
        self.window = Some(window);
        let n_v = window.n_v();
        for rows in [&mut self.density_u, &mut self.along_u, &mut self.through_u, &mut self.holes_u] {
            rows.resize(n_v, [0.0; TILE_U]);
        }
        for flags in [&mut self.has_density_u, &mut self.has_gradient_u] {
            flags.clear();
            flags.resize(n_v, false);
        }
        self.has_through = false;
        let axes = geometry.plane.family.axes;
        let taps = axis_w.slice_taps(w);
        geometry.slices.combine(geometry.level, axes, &taps, window, &mut self.density);
        if geometry.slices.has_mask() {
            // A hole counts wherever it has a weight, of either sign.
            let taps: Vec<_> = taps.iter().map(|&(slice, weight)| (slice, weight.abs())).collect();
            geometry.slices.combine_mask(geometry.level, axes, &taps, window, &mut self.holes);
        }
        let [lo, hi] = geometry.level.run(
            #[inline(always)]
            || bounds(&self.density),
        );
        let over = overshoot_2d(geometry.slices.kernel()) * (hi - lo);
        [lo - over, hi + over]
    }

    /// Where the sheet lies.
    pub fn w(&self) -> f64 {
        self.w
    }

    /// For each texel of a row the least and the largest `variation` (a growing function of the density) among the four
    /// samples around it: what the density can do on the ray's way to the next sheet, not only where sheets lie.
    pub fn row_spread(&mut self, row: usize, variation: impl Fn(f32) -> f32) -> [Row; 2] {
        let Some(window) = self.window else { return [[0.0; TILE_U]; 2] };
        let n_u = window.n_u();
        if self.variation.len() != self.density.len() {
            self.variation.clear();
            self.variation.extend(self.density.iter().map(|d| variation(*d)));
        }
        // The samples on either side of the texel are the middle ones of its taps.
        let middle = self.v.value.n_taps / 2 - usize::from(self.v.value.n_taps > 1);
        let first = (self.v.value.first[row] as usize + middle) * n_u;
        let (upper, lower) = (&self.variation[first..first + n_u], &self.variation[first + n_u..first + 2 * n_u]);
        let mut spread = [[0.0; TILE_U]; 2];
        for i in 0..TILE_U {
            let u = self.u.value.first[i] as usize + middle;
            let corners = [upper[u], upper[u + 1], lower[u], lower[u + 1]];
            spread[0][i] = corners[0].min(corners[1]).min(corners[2].min(corners[3]));
            spread[1][i] = corners[0].max(corners[1]).max(corners[2].max(corners[3]));
        }
        spread
    }

    /// Upsamples sample rows along u, where that is not done yet.
    fn upsample_density(&mut self, geometry: &SheetGeometry, rows: Range<usize>) {
        let Some(window) = self.window else { return };
        let n_u = window.n_u();
        for r in rows.start..rows.end.min(window.n_v()) {
            if !self.has_density_u[r] {
                self.has_density_u[r] = true;
                let samples = r * n_u..(r + 1) * n_u;
                upsample(geometry.level, &self.density[samples.clone()], &self.u.value, &mut self.density_u[r]);
                if geometry.slices.has_mask() {
                    let value = &self.u.value;
                    let weights = value.weights.iter().map(|w| w.abs()).collect();
                    let magnitude = Footprint { weights, ..value.clone() };
                    upsample(geometry.level, &self.holes[samples], &magnitude, &mut self.holes_u[r]);
                }
            }
        }
    }

    /// The same for the gradient; combines the derivative through the sheet when it is first asked for.
    fn upsample_gradient(&mut self, geometry: &SheetGeometry, row: usize) {
        let Some(window) = self.window else { return };
        if !self.has_through {
            self.has_through = true;
            let taps = geometry.axes[2].slice_difference_taps(self.w);
            let axes = geometry.plane.family.axes;
            geometry.slices.combine(geometry.level, axes, &taps, window, &mut self.through);
        }
        let n_u = window.n_u();
        let (value, difference) = (&self.v.value, &self.v.difference);
        for r in value.first[row] as usize..value.first[row] as usize + value.n_taps {
            if !self.has_gradient_u[r] {
                self.has_gradient_u[r] = true;
                let samples = r * n_u..(r + 1) * n_u;
                upsample(geometry.level, &self.density[samples.clone()], &self.u.difference, &mut self.along_u[r]);
                upsample(geometry.level, &self.through[samples], &self.u.value, &mut self.through_u[r]);
            }
        }
        // The derivative along v reaches further than the density did.
        let rows = difference.first[row] as usize..difference.first[row] as usize + difference.n_taps;
        self.upsample_density(geometry, rows);
    }

    /// A row with its densities. After [`Sheet::combine`].
    pub fn row(&mut self, geometry: &SheetGeometry, row: usize) -> &SheetRow {
        if !self.rows[row].has_density {
            let first = self.v.value.first[row] as usize;
            self.upsample_density(geometry, first..first + self.v.value.n_taps);
            let out = &mut self.rows[row];
            out.has_density = true;
            geometry.level.run(
                #[inline(always)]
                || {
                    blend_rows(&self.density_u, &self.v.value, row, &mut out.density);
                    out.range = bounds(&out.density);
                },
            );
            if geometry.slices.has_mask() {
                out.hole = [0.0; TILE_U];
                for t in 0..self.v.value.n_taps {
                    let holes = &self.holes_u[self.v.value.first[row] as usize + t];
                    let weight = self.v.value.tap(t)[row].abs();
                    for i in 0..TILE_U {
                        out.hole[i] += weight * holes[i];
                    }
                }
            }
        }
        &self.rows[row]
    }

    /// A row with its densities and gradient, where the geometry has a gradient offset.
    pub fn row_with_gradient(&mut self, geometry: &SheetGeometry, row: usize) -> &SheetRow {
        self.row(geometry, row);
        if !self.rows[row].has_gradient && geometry.axes[2].offset.is_some() {
            self.upsample_gradient(geometry, row);
            let out = &mut self.rows[row];
            out.has_gradient = true;
            let [along_u, along_v, through] = &mut out.gradient;
            geometry.level.run(
                #[inline(always)]
                || {
                    blend_rows(&self.along_u, &self.v.value, row, along_u);
                    blend_rows(&self.density_u, &self.v.difference, row, along_v);
                    blend_rows(&self.through_u, &self.v.value, row, through);
                },
            );
        }
        &self.rows[row]
    }
}

#[inline(always)]
fn bounds(densities: &[f32]) -> [f32; 2] {
    let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
    for &d in densities {
        lo = if d < lo { d } else { lo };
        hi = if d > hi { d } else { hi };
    }
    [lo, hi]
}

/// A row of samples becomes a row of texels.
fn upsample(level: Level, samples: &[f32], footprint: &Footprint, out: &mut Row) {
    level.run(
        #[inline(always)]
        || {
            *out = [0.0; TILE_U];
            for t in 0..footprint.n_taps {
                let weights = footprint.tap(t);
                for i in 0..TILE_U {
                    out[i] += weights[i] * samples[footprint.first[i] as usize + t];
                }
            }
        },
    );
}

/// One texel row out of the sample rows that reach it.
#[inline(always)]
fn blend_rows(rows: &[Row], footprint: &Footprint, row: usize, out: &mut Row) {
    let first = footprint.first[row] as usize;
    *out = [0.0; TILE_U];
    for t in 0..footprint.n_taps {
        let weight = footprint.tap(t)[row];
        if weight == 0.0 {
            continue;
        }
        let samples = &rows[first + t];
        for i in 0..TILE_U {
            out[i] += weight * samples[i];
        }
    }
}
