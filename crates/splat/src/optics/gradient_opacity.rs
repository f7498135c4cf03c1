//! Gradient opacity, and transfer functions of two dimensions: effects of the gradient magnitude beside shading, or of
//! a second field.
//!
//! Gradient opacity is a factor of the optical depth by the magnitude of the gradient, so that boundaries stand out and
//! homogeneous regions recede (Levoy, *Display of surfaces from volume data*, 1988; the curve is as in VTK's volume
//! properties and 3D Slicer). The factor scales the extinction, not the opacity of a slab, so that the picture does
//! not depend on the number of sheets: opacity `α` per unit becomes `1 − (1 − α)^f`,
//! which for faint functions is `f · α`.
//!
//! A function of two dimensions ([`wavesplat_core::TransferFunction2D`]) is tabulated over densities and magnitudes, or
//! densities of two fields, evenly along both, and looked up bilinearly.

use glam::DMat3;
use wavesplat_compute::simd::{ROUND, Wide};
use wavesplat_core::{TransferFunction, TransferFunction2D};

use crate::optics::classify::{Entry, OPAQUE_DEPTH};
use crate::optics::shade::Metric;
use crate::sheet::field_sheets::FieldPoint;
use crate::view::family::Family;

/// Entries of the table of factors.
const N_ENTRIES: usize = 4096;

/// Entries along an axis of the table of two dimensions: at least, at most, and in the narrowest segment.
const MIN_SIDE: usize = 128;
const MAX_SIDE: usize = 512;
const ENTRIES_PER_SEGMENT: f64 = 16.0;

/// Squared gradient below which the magnitude counts as 0.
const LEAST: f32 = 1e-36;

/// Tables over the magnitude of the world gradient of densities.
#[derive(Clone)]
pub struct GradientOpacity {
    metric: Metric,
    kind: Kind,
    /// Number of the field whose values are the second dimension; `None`: gradient magnitudes.
    second_field: Option<usize>,
}

#[derive(Clone)]
enum Kind {
    /// Factors of the optical depth.
    Factor { table: Vec<Entry>, per_magnitude: f32 },
    /// Colour and optical depth by density and magnitude.
    Both(Table),
}

/// Tables over the gradient magnitude as plain arrays, for other backends.
#[derive(Clone, Copy, Debug)]
pub enum GradientTables<'a> {
    /// Factors of the optical depth, the first number of each entry; the last entry stands twice.
    Factor {
        /// Entries, from magnitude 0 on.
        table: &'a [Entry],
        /// Entries per magnitude.
        per_magnitude: f32,
    },
    /// Red, green, blue and optical depth by density and magnitude.
    Both {
        /// Rows of densities, one row per magnitude; the last entry stands twice.
        entries: &'a [Entry],
        /// Number of entries, first value and step: of densities, and of magnitudes.
        along: [(usize, f64, f64); 2],
    },
}

impl GradientOpacity {
    /// Coefficients of the squared world gradient ([`Metric::numbers`]), and the tables.
    pub fn arrays(&self) -> ([f32; 6], GradientTables<'_>) {
        let tables = match &self.kind {
            Kind::Factor { table, per_magnitude } => GradientTables::Factor { table, per_magnitude: *per_magnitude },
            Kind::Both(Table { entries, along }) => {
                GradientTables::Both { entries, along: along.map(|side| (side.n, side.first, side.step)) }
            }
        };
        (self.metric.numbers(), tables)
    }

    /// Tabulates `tf`; `None` where neither gradients nor a second field have an effect on opacity.
    /// `density_from_sample`: offset and scale of the grid. `second`: number of the field that a function of two fields
    /// refers to, and its offset and scale.
    pub fn new(
        tf: &TransferFunction,
        world_from_index: DMat3,
        family: &Family,
        density_from_sample: (f64, f64),
        second: Option<(usize, (f64, f64))>,
    ) -> Option<Self> {
        let (_, density_scale) = density_from_sample;
        let second = second.filter(|_| tf.function_2d().is_some_and(TransferFunction2D::is_of_fields));
        let kind = if let Some(joint) = tf.function_2d() {
            let of_second = second.map_or((0.0, density_scale), |(_, map)| map);
            Kind::Both(Table::new(joint, density_from_sample, of_second))
        } else {
            // Constant beyond the last node; a curve of one node at 0 is constant everywhere.
            let last = tf.gradient_nodes().last()?.magnitude;
            let step = last.max(f64::MIN_POSITIVE) / (N_ENTRIES - 1) as f64;
            let entry = |i: usize| [tf.gradient_factor(i as f64 * step) as f32, 0.0, 0.0, 0.0];
            // One entry more, so that the last cell has an upper end at its very end.
            let table = (0..N_ENTRIES).chain([N_ENTRIES - 1]).map(entry).collect();
            let per_magnitude = if last > 0.0 { (1.0 / (step * density_scale)) as f32 } else { 0.0 };
            Kind::Factor { table, per_magnitude }
        };
        Some(Self { metric: Metric::new(world_from_index, family), kind, second_field: second.map(|(field, _)| field) })
    }

    /// Whether density and magnitude, or a second field, decide colour and opacity together, so that tables by density
    /// are only bounds.
    pub fn decides_color(&self) -> bool {
        matches!(self.kind, Kind::Both(_))
    }

    /// Colour and optical depth of densities with index gradients along u, v, w, at a point of the fields.
    /// `of_density`: without these.
    #[inline(always)]
    pub fn classify<W: Wide>(
        &self,
        w: W,
        density: W::F,
        gradient: [W::F; 3],
        point: &FieldPoint<W>,
        of_density: [W::F; 4],
    ) -> [W::F; 4] {
        let [r, g, b, depth] = of_density;
        match (&self.kind, self.second_field) {
            (Kind::Factor { .. }, _) => [r, g, b, w.mul(depth, self.factor(w, gradient))],
            (Kind::Both(table), None) => table.look_up(w, density, self.magnitude(w, gradient)),
            (Kind::Both(table), Some(field)) => table.look_up(w, density, point.value(w, field)),
        }
    }

    /// The factor for index gradients along u, v, w.
    #[inline(always)]
    pub fn factor<W: Wide>(&self, w: W, gradient: [W::F; 3]) -> W::F {
        let Kind::Factor { table, per_magnitude } = &self.kind else { return w.splat(1.0) };
        let [factor, _, _, _] = w.look_up(table, w.mul(self.magnitude(w, gradient), w.splat(*per_magnitude)));
        factor
    }

    #[inline(always)]
    fn magnitude<W: Wide>(&self, w: W, gradient: [W::F; 3]) -> W::F {
        let squared = w.max(self.metric.squared(w, gradient), w.splat(LEAST));
        w.mul(squared, w.rsqrt(squared))
    }
}

/// Colour and optical depth, evenly over densities and magnitudes; rows of densities.
#[derive(Clone)]
struct Table {
    entries: Vec<Entry>,
    along: [Side; 2],
}

/// One axis of the table.
#[derive(Clone, Copy)]
struct Side {
    n: usize,
    first: f64,
    step: f64,
}

impl Side {
    /// Even entries from the first node to the last.
    fn new(nodes: &[f64]) -> Self {
        let (mut first, last) = (nodes[0], nodes[nodes.len() - 1]);
        if nodes.get(1) == Some(&first) {
            // A step belongs to its upper side: the table begins before it, on the lower side.
            first -= (last - first) / MIN_SIDE as f64;
        }
        let extent = last - first;
        let narrowest = nodes.windows(2).map(|pair| pair[1] - pair[0]).filter(|d| *d > 0.0).fold(extent, f64::min);
        let wanted = if extent > 0.0 { (ENTRIES_PER_SEGMENT * extent / narrowest).ceil() } else { 0.0 };
        let n = (wanted.min(MAX_SIDE as f64) as usize).max(MIN_SIDE);
        Self { n, first, step: extent / (n - 1) as f64 }
    }

    fn node(&self, i: usize) -> f64 {
        self.first + i as f64 * self.step
    }
}

impl Table {
    /// `map`: offset and scale from values to densities. `of_second`: offset and scale of the second dimension.
    fn new(joint: &TransferFunction2D, map: (f64, f64), of_second: (f64, f64)) -> Self {
        let [values, magnitudes] = [Side::new(joint.values()), Side::new(joint.magnitudes())];
        let entry = |i: usize| {
            let [r, g, b, opacity] = joint.rgba(values.node(i % values.n), magnitudes.node(i / values.n));
            [r as f32, g as f32, b as f32, (-(-opacity).ln_1p()).min(OPAQUE_DEPTH) as f32]
        };
        // The last entry twice: a look-up reads an entry and the next one.
        let last = values.n * magnitudes.n - 1;
        let entries = (0..=last).chain([last]).map(entry).collect();
        let scaled = |side: Side, (offset, scale): (f64, f64)| Side {
            first: (side.first - offset) * scale,
            step: side.step * scale,
            ..side
        };
        Self { entries, along: [scaled(values, map), scaled(magnitudes, of_second)] }
    }

    /// The cell that holds a position along an axis, and the fraction of the way through it.
    #[inline(always)]
    fn cell<W: Wide>(w: W, side: Side, position: W::F) -> [W::F; 2] {
        // Added and taken off again, ROUND leaves the nearest whole number.
        let per_step = if side.step == 0.0 { 0.0 } else { 1.0 / side.step as f32 };
        let x = w.mul(w.sub(position, w.splat(side.first as f32)), w.splat(per_step));
        let x = w.min(w.max(x, w.splat(0.0)), w.splat((side.n - 1) as f32));
        let nearest = w.sub(w.add(x, w.splat(ROUND)), w.splat(ROUND));
        let below = w.select(w.lt(x, nearest), w.sub(nearest, w.splat(1.0)), nearest);
        let below = w.min(below, w.splat((side.n - 2) as f32));
        [below, w.sub(x, below)]
    }

    /// Bilinear look-up of four entries at whole places. Fractions are kept apart: a place in a table of up to 2^18
    /// entries leaves an f32 only 6 bits for them.
    #[inline(always)]
    fn look_up<W: Wide>(&self, w: W, density: W::F, magnitude: W::F) -> [W::F; 4] {
        let [along_row, t] = Self::cell(w, self.along[0], density);
        let [row, s] = Self::cell(w, self.along[1], magnitude);
        let n = w.splat(self.along[0].n as f32);
        let one = w.splat(1.0);
        let place = w.add(along_row, w.mul(row, n));
        let above = w.add(place, n);
        let (a, b) = (w.look_up(&self.entries, place), w.look_up(&self.entries, w.add(place, one)));
        let (c, d) = (w.look_up(&self.entries, above), w.look_up(&self.entries, w.add(above, one)));
        let mut mixed = a;
        for k in 0..4 {
            let low = w.add_mul(a[k], t, w.sub(b[k], a[k]));
            let high = w.add_mul(c[k], t, w.sub(d[k], c[k]));
            mixed[k] = w.add_mul(low, s, w.sub(high, low));
        }
        mixed
    }
}
