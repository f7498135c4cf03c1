//! Composite operators: how the sheets of a tile become one value per ray.
//!
//! *over*, front to back with associated colour (Porter & Duff 1984): `C += (1 − A) c α`, `A += (1 − A) α`.
//! Projections keep one density per ray. *First hit* looks for the first crossing of an iso-value between two
//! consecutive sheets and shades there, so that few sheets give a smooth surface.

use wavesplat_core::Composite;

use crate::classify::{Classifier, one_minus_exp_neg};
use crate::shade::Shader;
use crate::sheet::{Row, SheetRow, TILE_U, TILE_V};

/// What a row of a tile knows about its rays; filled once per tile.
#[derive(Clone)]
pub struct RayRow {
    /// Interval of w that is drawn.
    pub interval: [Row; 2],
    /// Thickness of one slice distance along the ray, in `opacity_unit`s.
    pub thickness: Row,
    /// Unit world vectors towards the eye.
    pub to_eye: [Row; 3],
}

/// A sheet's place along w.
#[derive(Clone, Copy, Debug)]
pub struct Slab {
    /// The sheet.
    pub w: f32,
    /// Its slab: from half way to the sheet before to half way to the one after.
    pub interval: [f32; 2],
    /// Distance to the sheet before (nearer the eye), signed; for crossings.
    pub step: f32,
}

impl Slab {
    /// Share of a slice distance that each ray spends in the slab.
    #[inline(always)]
    fn extent(&self, rays: &RayRow, hole: &Row) -> Row {
        let mut extent = [0.0; TILE_U];
        for i in 0..TILE_U {
            let lo = self.interval[0].max(rays.interval[0][i]);
            let hi = self.interval[1].min(rays.interval[1][i]);
            let inside = (hi - lo).max(0.0);
            extent[i] = if hole[i] > 0.0 { 0.0 } else { inside };
        }
        extent
    }
}

/// One ray's result: associated RGBA (or density and coverage for projections), and where half the opacity is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Associated RGBA; projections: density, length of the path, 0, coverage.
    pub rgba: [f32; 4],
    /// w of opacity ½, NaN where it is not reached.
    pub w_half: f32,
}

/// An operator at work on one tile.
pub trait Compositor {
    /// Whether sheets with densities in this range change anything.
    fn wants(&self, range: [f32; 2]) -> bool;
    /// Whether a row needs a gradient where its densities are in this range.
    fn wants_gradient(&self) -> bool;
    /// Whether the row is finished.
    fn is_done(&self, row: usize) -> bool;
    /// Adds one row of a sheet, front to back.
    fn add(&mut self, row: usize, rays: &RayRow, slab: &Slab, sheet: &SheetRow);
    /// A sheet was left out because [`Compositor::wants`] said so.
    fn skip(&mut self);
    /// The result of a row.
    fn finish(&self, row: usize, out: &mut [Texel]);
}

/// A ray stops when less than this share of light comes through: an eighth of a 16-bit grey level.
const OPAQUE_ENOUGH: f32 = 1.0 - 2e-6;

/// Emission and absorption.
pub struct Over<'a> {
    classifier: &'a Classifier,
    shader: Option<&'a Shader>,
    rgba: Box<[[Row; 4]; TILE_V]>,
    w_half: Box<[Row; TILE_V]>,
    done: [bool; TILE_V],
}

impl<'a> Over<'a> {
    /// Nothing drawn yet.
    pub fn new(classifier: &'a Classifier, shader: Option<&'a Shader>) -> Self {
        Self {
            classifier,
            shader,
            rgba: Box::new([[[0.0; TILE_U]; 4]; TILE_V]),
            w_half: Box::new([[f32::NAN; TILE_U]; TILE_V]),
            done: [false; TILE_V],
        }
    }
}

impl Compositor for Over<'_> {
    #[inline(always)]
    fn wants(&self, [lo, hi]: [f32; 2]) -> bool {
        self.classifier.any_opacity(lo, hi)
    }

    #[inline(always)]
    fn wants_gradient(&self) -> bool {
        self.shader.is_some()
    }

    #[inline(always)]
    fn is_done(&self, row: usize) -> bool {
        self.done[row]
    }

    #[inline(always)]
    fn add(&mut self, row: usize, rays: &RayRow, slab: &Slab, sheet: &SheetRow) {
        let extent = slab.extent(rays, &sheet.hole);
        let mut rgb = [[0.0; TILE_U]; 3];
        let mut alpha = [0.0; TILE_U];
        for i in 0..TILE_U {
            let [r, g, b, depth] = self.classifier.look_up(sheet.density[i]);
            rgb[0][i] = r;
            rgb[1][i] = g;
            rgb[2][i] = b;
            alpha[i] = depth;
        }
        for i in 0..TILE_U {
            alpha[i] = one_minus_exp_neg(alpha[i] * (extent[i] * rays.thickness[i]));
        }
        if let Some(shader) = self.shader {
            shader.shade(&mut rgb, &sheet.gradient, &rays.to_eye);
        }
        let [r, g, b, a] = &mut self.rgba[row];
        let w_half = &mut self.w_half[row];
        let mut least = 1.0_f32;
        for i in 0..TILE_U {
            let weight = (1.0 - a[i]) * alpha[i];
            r[i] += weight * rgb[0][i];
            g[i] += weight * rgb[1][i];
            b[i] += weight * rgb[2][i];
            let before = a[i];
            a[i] += weight;
            // Inside the slab opacity is taken to grow evenly, from its near side to its far side.
            let share = (0.5 - before) / weight;
            let crossed = (before < 0.5) & (a[i] >= 0.5);
            let near = if slab.step > 0.0 { slab.interval[0] } else { slab.interval[1] };
            let entry = if slab.step > 0.0 { near.max(rays.interval[0][i]) } else { near.min(rays.interval[1][i]) };
            w_half[i] = if crossed { entry + share * extent[i] * slab.step.signum() } else { w_half[i] };
            // Rays that never meet the volume do not keep a row alive.
            let missed = rays.interval[0][i] >= rays.interval[1][i];
            let opacity = if missed { 1.0 } else { a[i] };
            least = if opacity < least { opacity } else { least };
        }
        self.done[row] = least >= OPAQUE_ENOUGH;
    }

    fn skip(&mut self) {}

    fn finish(&self, row: usize, out: &mut [Texel]) {
        for (i, texel) in out.iter_mut().enumerate() {
            *texel = Texel { rgba: std::array::from_fn(|c| self.rgba[row][c][i]), w_half: self.w_half[row][i] };
        }
    }
}

/// Maximum, minimum, mean and sum of the densities along a ray.
pub struct Project {
    operator: Composite,
    value: Box<[Row; TILE_V]>,
    length: Box<[Row; TILE_V]>,
    /// Whether a maximum or minimum was taken on a sheet inside the interval, not only on one whose slab reaches it.
    on_sheet: Box<[[bool; TILE_U]; TILE_V]>,
}

impl Project {
    /// `operator` is one of the projections.
    pub fn new(operator: Composite) -> Self {
        Self {
            operator,
            value: Box::new([[0.0; TILE_U]; TILE_V]),
            length: Box::new([[0.0; TILE_U]; TILE_V]),
            on_sheet: Box::new([[false; TILE_U]; TILE_V]),
        }
    }
}

/// Sheets this near the ends of the interval count as inside: rounding of the interval in f32 at 4096 slices.
const ON_FACE: f32 = 5e-4;

impl Compositor for Project {
    #[inline(always)]
    fn wants(&self, _: [f32; 2]) -> bool {
        true
    }

    #[inline(always)]
    fn wants_gradient(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_done(&self, _: usize) -> bool {
        false
    }

    #[inline(always)]
    fn add(&mut self, row: usize, rays: &RayRow, slab: &Slab, sheet: &SheetRow) {
        let extent = slab.extent(rays, &sheet.hole);
        let (value, length) = (&mut self.value[row], &mut self.length[row]);
        if matches!(self.operator, Composite::Mean | Composite::Sum) {
            for i in 0..TILE_U {
                let part = extent[i] * rays.thickness[i];
                value[i] += part * sheet.density[i];
                length[i] += part;
            }
            return;
        }
        let larger_wins = self.operator == Composite::Maximum;
        for i in 0..TILE_U {
            let [lo, hi] = [rays.interval[0][i], rays.interval[1][i]];
            let inside = slab.w >= lo - ON_FACE && slab.w <= hi + ON_FACE;
            let first = length[i] == 0.0 || (inside && !self.on_sheet[row][i]);
            let better = if larger_wins { sheet.density[i] > value[i] } else { sheet.density[i] < value[i] };
            let counts = extent[i] > 0.0 && (inside || !self.on_sheet[row][i]);
            if counts && (first || better) {
                value[i] = sheet.density[i];
            }
            if counts {
                length[i] = 1.0;
                self.on_sheet[row][i] |= inside;
            }
        }
    }

    fn skip(&mut self) {}

    fn finish(&self, row: usize, out: &mut [Texel]) {
        for (i, texel) in out.iter_mut().enumerate() {
            let (value, length) = (self.value[row][i], self.length[row][i]);
            let covered = if length > 0.0 { 1.0 } else { 0.0 };
            let value = if self.operator == Composite::Mean && length > 0.0 { value / length } else { value };
            *texel = Texel { rgba: [value * covered, length * covered, 0.0, covered], w_half: f32::NAN };
        }
    }
}

/// The first surface of one density.
pub struct FirstHit<'a> {
    iso: f32,
    rgb: [f32; 3],
    shader: Option<&'a Shader>,
    before: Box<[SheetRow; TILE_V]>,
    /// Whether `before` holds the sheet before.
    has_before: [bool; TILE_V],
    texels: Box<[[Texel; TILE_U]; TILE_V]>,
}

impl<'a> FirstHit<'a> {
    /// `iso` is a density.
    pub fn new(iso: f32, classifier: &Classifier, shader: Option<&'a Shader>) -> Self {
        let [r, g, b, _] = classifier.look_up(iso);
        let empty = Texel { rgba: [0.0; 4], w_half: f32::NAN };
        Self {
            iso,
            rgb: [r, g, b],
            shader,
            before: Box::new(std::array::from_fn(|_| SheetRow::default())),
            has_before: [false; TILE_V],
            texels: Box::new([[empty; TILE_U]; TILE_V]),
        }
    }
}

impl Compositor for FirstHit<'_> {
    #[inline(always)]
    fn wants(&self, _: [f32; 2]) -> bool {
        true
    }

    #[inline(always)]
    fn wants_gradient(&self) -> bool {
        self.shader.is_some()
    }

    #[inline(always)]
    fn is_done(&self, _: usize) -> bool {
        false
    }

    #[inline(always)]
    fn add(&mut self, row: usize, rays: &RayRow, slab: &Slab, sheet: &SheetRow) {
        let before = &mut self.before[row];
        if self.has_before[row] {
            let mut gradient = [[0.0; TILE_U]; 3];
            let mut w_hit = [f32::NAN; TILE_U];
            let mut any = false;
            for i in 0..TILE_U {
                let (a, b) = (before.density[i] - self.iso, sheet.density[i] - self.iso);
                // A surface is crossed, from either side; a ray that starts inside has met a cut face, not a surface.
                let crosses = (a < 0.0) != (b < 0.0) && before.hole[i] == 0.0 && sheet.hole[i] == 0.0;
                let t = a / (a - b);
                let w = slab.w - slab.step * (1.0 - t);
                let inside = w >= rays.interval[0][i] - ON_FACE && w <= rays.interval[1][i] + ON_FACE;
                if crosses && inside && self.texels[row][i].rgba[3] == 0.0 {
                    w_hit[i] = w;
                    any = true;
                    for c in 0..3 {
                        gradient[c][i] = before.gradient[c][i] + t * (sheet.gradient[c][i] - before.gradient[c][i]);
                    }
                }
            }
            if any {
                let mut rgb = self.rgb.map(|c| [c; TILE_U]);
                if let Some(shader) = self.shader {
                    shader.shade(&mut rgb, &gradient, &rays.to_eye);
                }
                for i in 0..TILE_U {
                    if !w_hit[i].is_nan() {
                        self.texels[row][i] = Texel { rgba: [rgb[0][i], rgb[1][i], rgb[2][i], 1.0], w_half: w_hit[i] };
                    }
                }
            }
        }
        before.density = sheet.density;
        before.gradient = sheet.gradient;
        before.hole = sheet.hole;
        self.has_before[row] = true;
    }

    fn skip(&mut self) {
        self.has_before = [false; TILE_V];
    }

    fn finish(&self, row: usize, out: &mut [Texel]) {
        out.copy_from_slice(&self.texels[row][..out.len()]);
    }
}
