//! Composite operators: how the sheets of a tile become one value per ray.
//!
//! *over*, front to back with associated colour (Porter & Duff 1984): `C += (1 − A) c α`, `A += (1 − A) α`. Each sheet
//! stands for the slab half way to its neighbours. Where the transfer function is steep between two sheets, so that
//! the slab's opacity or colour would change by a visible amount, the space between them is cut into thinner slabs
//! with density and gradient linear from sheet to sheet: a hard surface is found, and shaded, where it is, and few
//! sheets give what many did (the quadrature form of pre-integration: Engel, Kraus, Ertl 2001).
//!
//! Projections keep one density per ray, *first hit* looks for the first crossing of an iso-value and shades there;
//! both take the density as linear between sheets.
//!
//! Positions here are `s`, the slice coordinate w with the sign that makes it grow along the ray.

use wavesplat_core::Composite;

use crate::classify::{Classifier, one_minus_exp_neg};
use crate::shade::Shader;
use crate::sheet::{Row, Sheet, SheetGeometry, SheetRow, TILE_U, TILE_V};
use crate::simd::Level;

/// What a row of a tile knows about its rays; filled once per tile.
#[derive(Clone)]
pub struct RayRow {
    /// Interval of s that is drawn; empty where equal.
    pub interval: [Row; 2],
    /// Thickness of one slice distance along the ray, in `opacity_unit`s.
    pub thickness: Row,
    /// Unit world vectors towards the eye.
    pub to_eye: [Row; 3],
}

impl RayRow {
    /// Length of the part of each ray's `[from, to]` that is drawn.
    #[inline(always)]
    fn extent(&self, from: &Row, to: &Row, hole: &Row) -> Row {
        let mut extent = [0.0; TILE_U];
        for i in 0..TILE_U {
            let inside = to[i].min(self.interval[1][i]) - from[i].max(self.interval[0][i]);
            extent[i] = if hole[i] > 0.0 { 0.0 } else { inside.max(0.0) };
        }
        extent
    }
}

/// The space between two consecutive sheets of a tile, and sheets further between them, made when asked for.
pub struct Slab<'a> {
    /// Positions of the front and the back sheet.
    pub s: [f32; 2],
    /// Bounds of the densities of both.
    pub range: [f32; 2],
    /// Whether the back sheet is the tile's last.
    pub is_last: bool,
    /// The two sheets.
    pub sheets: [&'a mut Sheet; 2],
    /// Evenly spaced sheets between them.
    pub between: &'a mut Between,
    /// For reconstructing rows.
    pub geometry: &'a SheetGeometry<'a>,
    /// First texel and rows of the tile.
    pub place: ([usize; 2], usize),
}

/// Sheets between two sheets.
#[derive(Default)]
pub struct Between {
    sheets: Vec<Sheet>,
    is_made: Vec<bool>,
}

impl Between {
    /// Forgets the sheets of the slab before; the next slab has room for `n`.
    pub fn reset(&mut self, n: usize) {
        self.sheets.resize_with(n, Sheet::default);
        self.is_made.clear();
        self.is_made.resize(n, false);
    }
}

impl Slab<'_> {
    /// Number of the back sheet; the front one is 0, those between have the numbers between.
    fn last(&self) -> usize {
        self.between.sheets.len() + 1
    }

    /// Position of a sheet.
    fn s(&self, k: usize) -> f32 {
        let t = k as f32 / self.last() as f32;
        if k == self.last() { self.s[1] } else { self.s[0] + t * (self.s[1] - self.s[0]) }
    }

    /// One of the sheets.
    fn sheet(&mut self, k: usize) -> &mut Sheet {
        let last = self.last();
        if k == 0 || k == last {
            return self.sheets[usize::from(k == last)];
        }
        let sheet = &mut self.between.sheets[k - 1];
        if !self.between.is_made[k - 1] {
            self.between.is_made[k - 1] = true;
            let (w_front, w_back) = (self.sheets[0].w(), self.sheets[1].w());
            let w = w_front + (w_back - w_front) * k as f64 / last as f64;
            sheet.combine(self.geometry, w, self.place.0, self.place.1);
        }
        sheet
    }

    /// Two of the sheets, `near < far`.
    fn two(&mut self, near: usize, far: usize) -> (&mut Sheet, &mut Sheet) {
        self.sheet(near);
        self.sheet(far);
        let last = self.last();
        let [front, back] = &mut self.sheets;
        match (near, far) {
            (0, f) if f == last => (front, back),
            (0, f) => (front, &mut self.between.sheets[f - 1]),
            (n, f) if f == last => (&mut self.between.sheets[n - 1], back),
            (n, f) => {
                let (a, b) = self.between.sheets.split_at_mut(f - 1);
                (&mut a[n - 1], &mut b[0])
            }
        }
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
    /// Whether the row is finished.
    fn is_done(&self, row: usize) -> bool;
    /// Adds one row of the space between two sheets, front to back.
    fn add(&mut self, row: usize, rays: &RayRow, slab: &mut Slab);
    /// The result of a row; `w_half` along s.
    fn finish(&self, row: usize, out: &mut [Texel]);
}

/// A ray stops when less than this share of light comes through: an eighth of a 16-bit grey level.
const OPAQUE_ENOUGH: f32 = 1.0 - 2e-6;

/// Opacity of a slab from which a cut face of the volume is drawn where it is, not at the nearest sheet.
const VISIBLE_FACE: f32 = 0.03;

/// Change of a slab's opacity or colour between two sheets that are as near as they get from which it is cut.
const DIFFERENT: f32 = 0.1;

/// Slabs with linear density and gradient between two sheets that are as near as they get.
const N_CUTS: usize = 4;

/// Emission and absorption.
pub struct Over<'a> {
    classifier: &'a Classifier,
    shader: Option<&'a Shader>,
    /// Change between two sheets from which the space between them is cut; infinite: never.
    steep: f32,
    rgba: Vec<[Row; 4]>,
    s_half: Vec<Row>,
    /// How far each ray has been composited.
    covered: Vec<Row>,
    done: [bool; TILE_V],
}

impl<'a> Over<'a> {
    /// Nothing drawn yet. `steep`: change of a slab's opacity or colour from which it is cut, `∞` for plain sheets.
    pub fn new(classifier: &'a Classifier, shader: Option<&'a Shader>, steep: f32) -> Self {
        Self {
            classifier,
            shader,
            steep,
            rgba: vec![[[0.0; TILE_U]; 4]; TILE_V],
            s_half: vec![[f32::NAN; TILE_U]; TILE_V],
            covered: vec![[f32::NEG_INFINITY; TILE_U]; TILE_V],
            done: [false; TILE_V],
        }
    }

    /// Which rays can see a steep change on their way from one sheet to the next; `None` where none can. A ray that
    /// enters the drawn part between the two comes from emptiness, which is a change as well.
    fn steep(&self, rays: &RayRow, slab: &mut Slab, row: usize) -> Option<[bool; TILE_U]> {
        let (classifier, geometry, last) = (self.classifier, slab.geometry, slab.last());
        let [s_front, s_back] = slab.s;
        let mut steep = [false; TILE_U];
        let mut enters = false;
        for i in 0..TILE_U {
            enters |= rays.interval[0][i] > s_front && rays.interval[0][i] < s_back;
        }
        let spread = classifier.variation(slab.range[1]) - classifier.variation(slab.range[0]);
        let (front, back) = slab.two(0, last);
        if spread >= self.steep {
            let ahead = front.row_spread(row, |d| classifier.variation(d));
            let behind = back.row_spread(row, |d| classifier.variation(d));
            for i in 0..TILE_U {
                let spread = ahead[1][i].max(behind[1][i]) - ahead[0][i].min(behind[0][i]);
                steep[i] = spread >= self.steep;
            }
        }
        if enters {
            let (front, back) = (front.row(geometry, row), back.row(geometry, row));
            for i in 0..TILE_U {
                let depth = classifier.look_up(front.density[i])[3].max(classifier.look_up(back.density[i])[3]);
                let opacity = one_minus_exp_neg(depth * rays.thickness[i] * (s_back - s_front));
                let enters_here = rays.interval[0][i] > s_front && rays.interval[0][i] < s_back;
                steep[i] |= enters_here && opacity >= VISIBLE_FACE;
            }
        }
        steep.contains(&true).then_some(steep)
    }

    /// Which rays meet different densities on two sheets so near each other that the density between is linear.
    fn differ(&self, front: &SheetRow, back: &SheetRow) -> [bool; TILE_U] {
        let mut differ = [false; TILE_U];
        let (lo, hi) = (front.range[0].min(back.range[0]), front.range[1].max(back.range[1]));
        if self.classifier.variation(hi) - self.classifier.variation(lo) < DIFFERENT {
            return differ;
        }
        for i in 0..TILE_U {
            let change = self.classifier.variation(front.density[i]) - self.classifier.variation(back.density[i]);
            differ[i] = change.abs() >= DIFFERENT;
        }
        differ
    }

    /// Composites each ray up to `to` as one slab with the densities and gradient of `sheet`.
    fn add_slab(&mut self, level: Level, row: usize, rays: &RayRow, to: &Row, sheet: &SheetRow) {
        level.run(
            #[inline(always)]
            || self.add_slab_kernel(row, rays, to, sheet),
        );
    }

    #[inline(always)]
    fn add_slab_kernel(&mut self, row: usize, rays: &RayRow, to: &Row, sheet: &SheetRow) {
        let from = self.covered[row];
        let extent = rays.extent(&from, to, &sheet.hole);
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
        let s_half = &mut self.s_half[row];
        let mut least = 1.0_f32;
        for i in 0..TILE_U {
            let weight = (1.0 - a[i]) * alpha[i];
            r[i] += weight * rgb[0][i];
            g[i] += weight * rgb[1][i];
            b[i] += weight * rgb[2][i];
            let before = a[i];
            a[i] += weight;
            // Inside the slab opacity is taken to grow evenly.
            let share = (0.5 - before) / weight;
            let crossed = before < 0.5 && a[i] >= 0.5;
            s_half[i] = if crossed { from[i].max(rays.interval[0][i]) + share * extent[i] } else { s_half[i] };
            // Rays that never meet the volume do not keep a row alive.
            let missed = rays.interval[0][i] >= rays.interval[1][i];
            let opacity = if missed { 1.0 } else { a[i] };
            least = if opacity < least { opacity } else { least };
        }
        self.done[row] = least >= OPAQUE_ENOUGH;
    }

    /// Composites each ray up to `to` with a sheet as it is.
    fn add_sheet(&mut self, row: usize, rays: &RayRow, slab: &mut Slab, k: usize, to: &Row) {
        let geometry = slab.geometry;
        let sheet = slab.sheet(k);
        let [lo, hi] = sheet.row(geometry, row).range;
        if self.classifier.any_opacity(lo, hi) {
            self.add_slab(geometry.level, row, rays, to, sheet.row_with_gradient(geometry, row));
        }
        let covered = &mut self.covered[row];
        for i in 0..TILE_U {
            covered[i] = covered[i].max(to[i]);
        }
    }

    /// Composites the steep rays from a sheet to the next in slabs of linear density.
    fn add_cuts(&mut self, row: usize, rays: &RayRow, slab: &mut Slab, near: usize, steep: &[bool; TILE_U]) {
        let geometry = slab.geometry;
        let [s_near, s_far] = [slab.s(near), slab.s(near + 1)];
        let (near_sheet, far_sheet) = slab.two(near, near + 1);
        let near_row = near_sheet.row_with_gradient(geometry, row);
        let far_row = far_sheet.row_with_gradient(geometry, row);
        for k in 1..=N_CUTS {
            let between = blend(near_row, far_row, (k as f32 - 0.5) / N_CUTS as f32, self.shader.is_some());
            let end = if k == N_CUTS { s_far } else { s_near + k as f32 * ((s_far - s_near) / N_CUTS as f32) };
            let mut to = self.covered[row];
            for i in 0..TILE_U {
                to[i] = if steep[i] { end } else { to[i] };
            }
            self.add_slab(geometry.level, row, rays, &to, &between);
            self.covered[row] = to;
        }
    }

    /// From sheet `near` to the next, for the rays of `among`: the near sheet stands for its half, or, where the
    /// change is steep, the space is cut.
    fn add_thin(&mut self, row: usize, rays: &RayRow, slab: &mut Slab, near: usize, among: &[bool; TILE_U]) {
        let geometry = slab.geometry;
        let [s_near, s_far] = [slab.s(near), slab.s(near + 1)];
        let (near_sheet, far_sheet) = slab.two(near, near + 1);
        let mut cut = self.differ(near_sheet.row(geometry, row), far_sheet.row(geometry, row));
        let mut to = self.covered[row];
        for i in 0..TILE_U {
            cut[i] &= among[i];
            let end = if cut[i] { s_near } else { 0.5 * (s_near + s_far) };
            to[i] = if among[i] { end } else { to[i] };
        }
        self.add_sheet(row, rays, slab, near, &to);
        if cut.contains(&true) {
            self.add_cuts(row, rays, slab, near, &cut);
        }
    }
}

impl Compositor for Over<'_> {
    fn wants(&self, [lo, hi]: [f32; 2]) -> bool {
        self.classifier.any_opacity(lo, hi)
    }

    fn is_done(&self, row: usize) -> bool {
        self.done[row]
    }

    fn add(&mut self, row: usize, rays: &RayRow, slab: &mut Slab) {
        let last = slab.last();
        let [s_front, s_back] = slab.s;
        let half_way = 0.5 * (s_front + s_back);
        // Where the slab before was left out as invisible, rays are drawn from half way to it.
        let before = s_front - (half_way - s_front);
        for covered in &mut self.covered[row] {
            *covered = covered.max(before);
        }
        let steep = if self.steep.is_finite() { self.steep(rays, slab, row) } else { None };
        let mut to = [half_way; TILE_U];
        if let Some(steep) = &steep {
            for i in 0..TILE_U {
                to[i] = if steep[i] { s_front } else { half_way };
            }
        }
        self.add_sheet(row, rays, slab, 0, &to);
        if let Some(steep) = &steep {
            for near in 0..last {
                if self.done[row] {
                    return;
                }
                self.add_thin(row, rays, slab, near, steep);
            }
        }
        // The back sheet stands for the rest of rays that were drawn in thinner slabs, and of all in the last slab.
        if steep.is_some() || slab.is_last {
            let mut to = self.covered[row];
            for i in 0..TILE_U {
                let all = slab.is_last || steep.is_some_and(|steep| steep[i]);
                to[i] = if all { s_back } else { to[i] };
            }
            self.add_sheet(row, rays, slab, last, &to);
        }
    }

    fn finish(&self, row: usize, out: &mut [Texel]) {
        for (i, texel) in out.iter_mut().enumerate() {
            *texel = Texel { rgba: std::array::from_fn(|c| self.rgba[row][c][i]), w_half: self.s_half[row][i] };
        }
    }
}

/// Density and gradient at `t` of the way from one sheet to the next.
#[inline(always)]
fn blend(front: &SheetRow, back: &SheetRow, t: f32, with_gradient: bool) -> SheetRow {
    let mut row = SheetRow::EMPTY;
    for i in 0..TILE_U {
        row.density[i] = front.density[i] + t * (back.density[i] - front.density[i]);
        row.hole[i] = front.hole[i].max(back.hole[i]);
    }
    if with_gradient {
        for c in 0..3 {
            for i in 0..TILE_U {
                row.gradient[c][i] = front.gradient[c][i] + t * (back.gradient[c][i] - front.gradient[c][i]);
            }
        }
    }
    row
}

/// Maximum, minimum, mean and sum of the densities along a ray.
pub struct Project {
    operator: Composite,
    value: Vec<Row>,
    length: Vec<Row>,
}

impl Project {
    /// `operator` is one of the projections.
    pub fn new(operator: Composite) -> Self {
        Self { operator, value: vec![[0.0; TILE_U]; TILE_V], length: vec![[0.0; TILE_U]; TILE_V] }
    }
}

impl Compositor for Project {
    fn wants(&self, _: [f32; 2]) -> bool {
        true
    }

    fn is_done(&self, _: usize) -> bool {
        false
    }

    fn add(&mut self, row: usize, rays: &RayRow, slab: &mut Slab) {
        let [front, back] = &mut slab.sheets;
        let (front, back) = (front.row(slab.geometry, row), back.row(slab.geometry, row));
        let (value, length) = (&mut self.value[row], &mut self.length[row]);
        let [s_front, s_back] = slab.s;
        let per_s = 1.0 / (s_back - s_front);
        for i in 0..TILE_U {
            // The part of the slab that is drawn, and the densities at its ends.
            let from = ((rays.interval[0][i] - s_front) * per_s).max(0.0);
            let to = ((rays.interval[1][i] - s_front) * per_s).min(1.0);
            let slope = back.density[i] - front.density[i];
            let near = front.density[i] + from * slope;
            let far = if to == 1.0 { back.density[i] } else { front.density[i] + to * slope };
            let drawn = to > from && front.hole[i] <= 0.0 && back.hole[i] <= 0.0;
            let extent = if drawn { (to - from) * (s_back - s_front) * rays.thickness[i] } else { 0.0 };
            let empty = length[i] == 0.0;
            let new = match self.operator {
                Composite::Maximum => {
                    if empty {
                        near.max(far)
                    } else {
                        value[i].max(near.max(far))
                    }
                }
                Composite::Minimum => {
                    if empty {
                        near.min(far)
                    } else {
                        value[i].min(near.min(far))
                    }
                }
                _ => value[i] + 0.5 * (near + far) * extent,
            };
            value[i] = if drawn { new } else { value[i] };
            length[i] += extent;
        }
    }

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
    texels: Vec<[Texel; TILE_U]>,
}

impl<'a> FirstHit<'a> {
    /// `iso` is a density.
    pub fn new(iso: f32, classifier: &Classifier, shader: Option<&'a Shader>) -> Self {
        let [r, g, b, _] = classifier.look_up(iso);
        let empty = Texel { rgba: [0.0; 4], w_half: f32::NAN };
        Self { iso, rgb: [r, g, b], shader, texels: vec![[empty; TILE_U]; TILE_V] }
    }
}

impl Compositor for FirstHit<'_> {
    /// A surface needs densities on both sides.
    fn wants(&self, [lo, hi]: [f32; 2]) -> bool {
        lo < self.iso && hi >= self.iso
    }

    fn is_done(&self, _: usize) -> bool {
        false
    }

    fn add(&mut self, row: usize, rays: &RayRow, slab: &mut Slab) {
        let [s_front, s_back] = slab.s;
        let mut s_hit = [f32::NAN; TILE_U];
        let mut any = false;
        let [front, back] = &mut slab.sheets;
        {
            let (front, back) = (front.row(slab.geometry, row), back.row(slab.geometry, row));
            for i in 0..TILE_U {
                let (a, b) = (front.density[i] - self.iso, back.density[i] - self.iso);
                // A surface is crossed, from either side; a ray that starts inside has met a cut face, not a surface.
                let crosses = (a < 0.0) != (b < 0.0) && front.hole[i] <= 0.0 && back.hole[i] <= 0.0;
                let s = s_front + (s_back - s_front) * (a / (a - b));
                let inside = s >= rays.interval[0][i] && s <= rays.interval[1][i];
                if crosses && inside && self.texels[row][i].rgba[3] == 0.0 {
                    s_hit[i] = s;
                    any = true;
                }
            }
        }
        if !any {
            return;
        }
        let mut rgb = self.rgb.map(|c| [c; TILE_U]);
        if let Some(shader) = self.shader {
            let front = front.row_with_gradient(slab.geometry, row);
            let back = back.row_with_gradient(slab.geometry, row);
            let mut gradient = [[0.0; TILE_U]; 3];
            for (c, gradient) in gradient.iter_mut().enumerate() {
                for i in 0..TILE_U {
                    let t = (s_hit[i] - s_front) / (s_back - s_front);
                    gradient[i] = front.gradient[c][i] + t * (back.gradient[c][i] - front.gradient[c][i]);
                }
            }
            shader.shade(&mut rgb, &gradient, &rays.to_eye);
        }
        for i in 0..TILE_U {
            if !s_hit[i].is_nan() {
                self.texels[row][i] = Texel { rgba: [rgb[0][i], rgb[1][i], rgb[2][i], 1.0], w_half: s_hit[i] };
            }
        }
    }

    fn finish(&self, row: usize, out: &mut [Texel]) {
        out.copy_from_slice(&self.texels[row][..out.len()]);
    }
}
