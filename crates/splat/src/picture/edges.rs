//! Pixels through which a wall passes: of the volume's box, a crop box, a clip plane, or a layer's box.
//!
//! Such a pixel is the mean of reads on a grid, as many rays would give, and each read counts by where its own ray enters
//! and leaves what is drawn, which is known exactly: it is nothing where the ray misses it, and else the texels around it,
//! each brought from the length of its ray to that of the read's. The mean extinction along a ray goes on smoothly where
//! its length does not. Texels just beyond a wall are there for this ([`crate::view::silhouette`]).
//!
//! All other pixels stay as the warp has drawn them, and what lies beyond the walls is taken away.

use glam::DVec2;
use wavesplat_compute::simd::{LANES, Level, Plain};

use crate::optics::classify::one_minus_exp_neg;
use crate::picture::base_picture::BasePicture;
use crate::picture::resample::{Resampler, cubic_weights};
use crate::view::base_plane::BasePlane;
use crate::view::family::{Family, IndexRays};
use crate::view::region::Passage;
use crate::view::silhouette::{Met, Part, PixelGrid, PlaneSilhouette, Silhouette};

/// How a texel depends on the length of its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// `1 − exp(−τ L)`.
    Opacity,
    /// Proportional to it.
    Sum,
    /// Not at all.
    None,
}

/// What the warp is told of edges.
#[derive(Clone, Copy)]
pub struct Edges<'a> {
    /// What rays meet.
    pub silhouette: &'a Silhouette,
    /// How texels depend on the lengths of rays.
    pub scaling: Scaling,
    /// Whether texels are values of a projection: a pixel whose middle ray is inside shows that ray's, to the bit.
    pub is_projection: bool,
}

/// Reads of a pixel with an edge along x and along y, on a regular grid: as many as rays of the reference, at every quality,
/// so that a pixel that a wall covers in part has the same share of it in all of them.
const READS_PER_AXIS: usize = 4;

/// Pixels per side of the squares in which edges are looked for.
const SQUARE_PX: usize = 8;

/// Of a ray much shorter than that of a read, the colour of the read is not known.
const SHORT: f64 = 0.1;

/// A sliver of a ray, in slices, of which nothing is known.
const SLIVER: f64 = 0.02;

/// Lengths that differ by less, relatively, count as the same: about what float32 tells apart.
const SAME: f64 = 1e-6;

/// The pass over a warped picture.
pub struct EdgePass<'a> {
    edges: Edges<'a>,
    resamplers: &'a [Resampler<'a>],
    /// As each base plane sees them.
    planes: Vec<PlaneSilhouette<'a>>,
    rays: &'a IndexRays,
    peak: f32,
    level: Level,
    is_parallel: bool,
    /// Pixels to the side of one within which it is looked for edges.
    reach_px: f64,
    /// Pixels to the side of one in which texels are not as they go on within it.
    aside_px: f64,
}

impl<'a> EdgePass<'a> {
    /// `None` where nothing was drawn.
    pub fn new(
        edges: Edges<'a>,
        resamplers: &'a [Resampler<'a>],
        rays: &'a IndexRays,
        peak: f32,
        level: Level,
    ) -> Option<Self> {
        let first = &resamplers.first()?.picture.plane;
        let planes: Vec<_> = resamplers.iter().map(|r| edges.silhouette.on(&r.picture.plane)).collect();
        let reach_px = resamplers.iter().map(|r| texel_px(&r.picture.plane, rays)).fold(0.0, f64::max);
        let narrow = resamplers.iter().any(|r| edges.silhouette.has_narrow_walls(&r.picture.plane));
        let aside_px = if narrow || edges.silhouette.is_mixed() { reach_px } else { 0.0 };
        let is_parallel = first.eye_w().is_none();
        Some(Self { edges, resamplers, planes, rays, peak, level, is_parallel, reach_px, aside_px })
    }

    /// Draws the pixels of a rectangle that have edges. `first`: its first column and row; `pixels`: from that pixel on,
    /// `pitch` from row to row.
    pub fn draw(&self, first: [usize; 2], size: [usize; 2], pixels: &mut [[f32; 4]], pitch: usize) {
        let mut passages = Vec::new();
        match self.part(first, size, &mut passages) {
            Part::Even => return,
            Part::Outside => return clear(first, first, size, pixels, pitch),
            Part::Edge => {}
        }
        let mut strips = Strips::default();
        for y in (0..size[1]).step_by(SQUARE_PX) {
            for x in (0..size[0]).step_by(SQUARE_PX) {
                let square = [SQUARE_PX.min(size[0] - x), SQUARE_PX.min(size[1] - y)];
                let rows = || (y..y + square[1]).map(|row| row * pitch + x);
                if rows().all(|row| pixels[row..row + square[0]].iter().all(|pixel| pixel[3] == 0.0)) {
                    continue;
                }
                let at = [first[0] + x, first[1] + y];
                match self.part(at, square, &mut passages) {
                    Part::Even => {}
                    Part::Outside => clear(first, at, square, pixels, pitch),
                    Part::Edge => self.draw_square(first, at, square, pixels, pitch, &mut passages, &mut strips),
                }
            }
        }
    }

    /// What a rectangle of pixels shows.
    fn part(&self, first: [usize; 2], size: [usize; 2], passages: &mut Vec<Vec<Passage>>) -> Part {
        let corner = first.map(|px| px as f64 - self.aside_px);
        let sides = size.map(|px| px as f64 + 2.0 * self.aside_px);
        self.edges.silhouette.passages(self.rays, self.is_parallel, &PixelGrid::corners(corner, sides), passages);
        let of = |corners: &Vec<Passage>| {
            Part::of_region(std::array::from_fn(|k| &corners[k]), sides[0].min(sides[1]), self.reach_px)
        };
        passages.iter().map(of).reduce(Part::and).unwrap_or(Part::Outside)
    }

    #[expect(clippy::too_many_arguments, reason = "a square of a rectangle of pixels, and room to work in")]
    fn draw_square(
        &self,
        origin: [usize; 2],
        first: [usize; 2],
        size: [usize; 2],
        pixels: &mut [[f32; 4]],
        pitch: usize,
        passages: &mut Vec<Vec<Passage>>,
        strips: &mut Strips,
    ) {
        // Corners are those of neighbours as well, but where pixels are looked at with what is beside them.
        let is_shared = self.aside_px == 0.0;
        if is_shared {
            let grid = PixelGrid { first: first.map(|px| px as f64), distance: [1.0; 2], n: size.map(|n| n + 1) };
            self.edges.silhouette.passages(self.rays, self.is_parallel, &grid, passages);
        }
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = [first[0] + x, first[1] + y];
                let pixel = &mut pixels[(at[1] - origin[1]) * pitch + at[0] - origin[0]];
                if pixel[3] == 0.0 {
                    continue;
                }
                let part = if is_shared {
                    let corner = y * (size[0] + 1) + x;
                    let corners = [corner, corner + 1, corner + size[0] + 1, corner + size[0] + 2];
                    let of = |of: &Vec<Passage>| Part::of_region(corners.map(|k| &of[k]), 1.0, self.reach_px);
                    passages.iter().map(of).reduce(Part::and).unwrap_or(Part::Outside)
                } else {
                    self.part(at, [1, 1], passages)
                };
                match part {
                    Part::Even => {}
                    Part::Outside => *pixel = [0.0; 4],
                    Part::Edge => {
                        let before = *pixel;
                        *pixel = self.level.run(
                            #[inline(always)]
                            || self.pixel(at, before, strips),
                        );
                    }
                }
            }
        }
    }

    /// A pixel. `before`: as the warp has drawn it.
    #[inline(always)]
    fn pixel(&self, [x, y]: [usize; 2], before: [f32; 4], strips: &mut Strips) -> [f32; 4] {
        let [x, y] = [x as f64, y as f64];
        let n = READS_PER_AXIS * READS_PER_AXIS;
        let (mut sum, mut n_met) = ([0.0; 4], 0);
        let middle = if self.edges.is_projection { self.met([x + 0.5, y + 0.5]) } else { None };
        for k in 0..n {
            let within = |k: usize| (k as f64 + 0.5) / READS_PER_AXIS as f64;
            let Some(read) = self.met([x + within(k % READS_PER_AXIS), y + within(k / READS_PER_AXIS)]) else {
                continue;
            };
            n_met += 1;
            if middle.is_none() {
                let rgba = self.read(&read, strips).0;
                (0..4).for_each(|c| sum[c] += rgba[c]);
            }
        }
        if let Some(middle) = middle {
            let (rgba, is_as_before) =
                if self.edges.scaling == Scaling::None { (before, true) } else { self.read(&middle, strips) };
            let share = n_met as f32 / n as f32;
            return if is_as_before { before } else { rgba }.map(|c| c * share);
        }
        sum.map(|c| c / n as f32)
    }

    /// Where a position of the picture is read, if its ray meets anything.
    #[inline(always)]
    fn met(&self, [x_px, y_px]: [f64; 2]) -> Option<Read> {
        let plane = if self.is_parallel {
            0
        } else {
            let family = Family::of(self.rays.direction(x_px, y_px));
            self.planes.iter().position(|plane| plane.plane.family == family)?
        };
        let at = self.planes[plane].plane.texel_from_pixel(self.rays, x_px, y_px);
        let met = self.planes[plane].met(at.to_array());
        (met.regions != 0).then_some(Read { plane, at, met })
    }

    /// The texels around a position, each as if its ray were as long as the read's; and whether that is the plain cubic.
    #[inline(always)]
    fn read(&self, read: &Read, strips: &mut Strips) -> ([f32; 4], bool) {
        let floor = read.at.floor();
        let t = (read.at - floor).to_array().map(|t| t as f32);
        let first = [floor.x as i64 - 1, floor.y as i64 - 1];
        let (along_u, along_v) = (cubic_weights(t[0]), cubic_weights(t[1]));
        let picture = self.resamplers[read.plane].picture;
        let mut taps = Taps::default();
        for row in 0..4 {
            let j = first[1] + row as i64;
            // Four texels of a row lie in one strip, or in two.
            let mut column = 0;
            while column < 4 {
                let i = first[0] + column as i64;
                let (place, lane) = ([i.div_euclid(LANES as i64), j], i.rem_euclid(LANES as i64) as usize);
                let strip = strips.get(read.plane, place, || {
                    Strip::new(&self.planes[read.plane], picture, self.edges.scaling, place)
                });
                let n_here = (4 - column).min(LANES - lane);
                for (column, lane) in (column..column + n_here).zip(lane..) {
                    let k = 4 * row + column;
                    taps.rgba[k] = strip.rgba[lane];
                    taps.weight[k] = along_u[column] * along_v[row];
                    taps.set(k, strip, lane, &read.met, self.edges.scaling);
                }
                column += n_here;
            }
        }
        let is_plain = taps.is_plain;
        (taps.mean(self.edges.scaling, t, self.peak), is_plain)
    }
}

/// Where a picture is read.
struct Read {
    /// Which base plane.
    plane: usize,
    /// Texel position.
    at: DVec2,
    /// What its ray meets.
    met: Met,
}

/// The sixteen texels around a position.
struct Taps {
    rgba: [[f32; 4]; LANES],
    weight: [f32; LANES],
    /// Whether the ray of a texel tells something of the read's.
    is_used: [bool; LANES],
    /// Whether it meets the same regions.
    is_alike: [bool; LANES],
    /// Of opacity, the optical depth along a ray as long as the read's; of sums, the factor.
    depth: [f32; LANES],
    /// Whether its length is the read's.
    is_same: [bool; LANES],
    /// Whether it may have stopped on the way.
    is_opaque: [bool; LANES],
    is_plain: bool,
}

impl Default for Taps {
    fn default() -> Self {
        Self {
            rgba: [[0.0; 4]; LANES],
            weight: [0.0; LANES],
            is_used: [false; LANES],
            is_alike: [false; LANES],
            depth: [0.0; LANES],
            is_same: [true; LANES],
            is_opaque: [false; LANES],
            is_plain: true,
        }
    }
}

/// The four of sixteen texels that are nearest.
const MIDDLE: [usize; 4] = [5, 6, 9, 10];

/// Weights that sum to less are not those of a mean.
const LEAST_WEIGHT: f32 = 0.4;

impl Taps {
    #[inline(always)]
    fn set(&mut self, k: usize, strip: &Strip, lane: usize, met: &Met, scaling: Scaling) {
        let length = strip.length[lane];
        self.is_alike[k] = strip.met[lane] == met.regions;
        let is_long = scaling == Scaling::None || (length > SLIVER && length >= SHORT * met.length);
        self.is_used[k] = self.is_alike[k] && is_long;
        self.is_same[k] = scaling == Scaling::None || (length - met.length).abs() <= SAME * met.length;
        self.depth[k] = match scaling {
            Scaling::Opacity => strip.depth[lane] * met.length as f32,
            Scaling::Sum => (met.length / length) as f32,
            Scaling::None => 1.0,
        };
        self.is_opaque[k] = strip.is_opaque[lane];
        self.is_plain &= self.is_used[k] && self.is_same[k];
    }

    /// The weighted mean, between the nearest, no colour brighter than its opacity lets it be.
    #[inline(always)]
    fn mean(mut self, scaling: Scaling, t: [f32; 2], peak: f32) -> [f32; 4] {
        if !self.is_used.contains(&true) {
            self.is_used = self.is_alike;
        }
        self.scale(scaling);
        let used = |k: &usize| self.is_used[*k];
        let total: f32 = (0..LANES).filter(used).map(|k| self.weight[k]).sum();
        let mut mean = [0.0; 4];
        if total >= LEAST_WEIGHT {
            let (mut least, mut most) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
            let has_middle = MIDDLE.iter().any(used);
            for k in (0..LANES).filter(used) {
                for c in 0..4 {
                    mean[c] += self.weight[k] / total * self.rgba[k][c];
                    if !has_middle || MIDDLE.contains(&k) {
                        least[c] = least[c].min(self.rgba[k][c]);
                        most[c] = most[c].max(self.rgba[k][c]);
                    }
                }
            }
            (0..4).for_each(|c| mean[c] = mean[c].max(least[c]).min(most[c]));
        } else {
            // The nearest of them alone.
            let distance = |k: &usize| {
                let [u, v] = [k % 4, k / 4].map(|place| place as f32 - 1.0);
                (u - t[0]).powi(2) + (v - t[1]).powi(2)
            };
            let nearest = (0..LANES).filter(used).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            mean = nearest.map_or([0.0; 4], |k| self.rgba[k]);
        }
        mean[3] = mean[3].min(1.0);
        for c in 0..3 {
            mean[c] = mean[c].min(peak * mean[3]);
        }
        mean
    }

    /// Of a ray that has stopped, the matter is as dense as the densest beside it that is known; as dense as can be where
    /// nothing is known.
    #[inline(always)]
    fn estimate_opaque(&mut self) {
        if !self.is_opaque.contains(&true) {
            return;
        }
        let mut densest = 0.0;
        for k in 0..LANES {
            if self.is_used[k] && !self.is_opaque[k] && self.rgba[k][3] > TELLING {
                densest = self.depth[k].max(densest);
            }
        }
        for k in 0..LANES {
            if self.is_opaque[k] {
                self.depth[k] = if densest > 0.0 { self.depth[k].max(densest) } else { MOST_DEPTH };
            }
        }
    }

    /// Brings the texels to the length of the read's ray.
    #[inline(always)]
    fn scale(&mut self, scaling: Scaling) {
        match scaling {
            Scaling::None => {}
            Scaling::Sum => {
                for k in (0..LANES).filter(|k| !self.is_same[*k]) {
                    (0..2).for_each(|c| self.rgba[k][c] *= self.depth[k]);
                }
            }
            Scaling::Opacity if self.is_same == [true; LANES] => {}
            Scaling::Opacity => {
                self.estimate_opaque();
                let opacity = one_minus_exp_neg(Plain, self.depth);
                for k in 0..LANES {
                    if !self.is_same[k] && self.rgba[k][3] > 0.0 {
                        let factor = opacity[k] / self.rgba[k][3];
                        self.rgba[k] = self.rgba[k].map(|c| c * factor);
                    }
                }
            }
        }
    }
}

/// Sixteen texels of a row, and what their rays have drawn.
struct Strip {
    rgba: [[f32; 4]; LANES],
    met: [u8; LANES],
    length: [f64; LANES],
    /// Optical depth per slice.
    depth: [f32; LANES],
    /// Whether there may be more than that.
    is_opaque: [bool; LANES],
}

/// Opacity of rays that may have stopped on the way.
const OPAQUE: f32 = 1.0 - 2e-4;

/// Opacity of a ray that tells how dense the matter is.
const TELLING: f32 = 0.3;

/// An optical depth that is opaque, whatever it is multiplied with.
const MOST_DEPTH: f32 = 1e6;

impl Strip {
    /// `place`: of the strip along u, and the row.
    fn new(plane: &PlaneSilhouette, picture: &BasePicture, scaling: Scaling, [strip, j]: [i64; 2]) -> Self {
        let i = strip * LANES as i64;
        let (mut met, length) = plane.drawn(i as f64, j as f64);
        let (mut rgba, mut depth, mut is_opaque) = ([[0.0; 4]; LANES], [0.0; LANES], [false; LANES]);
        let [n_u, n_v] = picture.plane.size;
        let row = usize::try_from(j).ok().filter(|j| *j < n_v).map(|j| picture.row(j));
        for lane in 0..LANES {
            let texel = usize::try_from(i + lane as i64).ok().filter(|i| *i < n_u);
            match row.zip(texel) {
                Some((row, i)) => rgba[lane] = row[i],
                None => met[lane] = 0,
            }
            if scaling == Scaling::Opacity && rgba[lane][3] > 0.0 && met[lane] != 0 {
                let opacity = rgba[lane][3];
                is_opaque[lane] = opacity >= OPAQUE;
                depth[lane] = (optical_depth(opacity.min(OPAQUE)) / length[lane].max(f64::MIN_POSITIVE)) as f32;
            }
        }
        Self { rgba, met, length, depth, is_opaque }
    }
}

/// `−ln(1 − opacity)`, by the series of the inverse hyperbolic tangent: with sums and products alone, so that every
/// processor gives the same bits.
fn optical_depth(opacity: f32) -> f64 {
    let rest = 1.0 - f64::from(opacity.max(0.0));
    // rest = m · 2^e with m from √½ to √2, ln m = 2 artanh((m − 1) / (m + 1)).
    let bits = rest.to_bits();
    let (mut exponent, mut m) = ((bits >> 52) as i32 - 1023, f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52));
    if m > std::f64::consts::SQRT_2 {
        (exponent, m) = (exponent + 1, 0.5 * m);
    }
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = (0..8).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) + square * sum);
    -(2.0 * s * series + f64::from(exponent) * std::f64::consts::LN_2)
}

/// Strips that were made last, by their place.
#[derive(Default)]
struct Strips(Vec<Option<([i64; 3], Strip)>>);

/// Places of strips along u and v, powers of two.
const N_PLACES: [i64; 2] = [4, 16];

impl Strips {
    /// That of a base plane at a place, made where it is not there.
    #[inline(always)]
    fn get(&mut self, plane: usize, [strip, j]: [i64; 2], make: impl FnOnce() -> Strip) -> &Strip {
        let n = (N_PLACES[0] * N_PLACES[1]) as usize;
        if self.0.is_empty() {
            self.0.resize_with(n, || None);
        }
        let place = (j.rem_euclid(N_PLACES[1]) * N_PLACES[0] + strip.rem_euclid(N_PLACES[0])) as usize;
        let key = [plane as i64, strip, j];
        let entry = &mut self.0[place];
        if entry.as_ref().is_none_or(|(of, _)| *of != key) {
            *entry = None;
        }
        &entry.get_or_insert_with(|| (key, make())).1
    }
}

/// Pixels per texel, at most, in the middle of the pixels that a base plane serves.
fn texel_px(plane: &BasePlane, rays: &IndexRays) -> f64 {
    let per_px = plane.texels_per_pixel(rays);
    1.0 / per_px.max(0.1)
}

/// Takes away what lies beyond the walls.
fn clear(origin: [usize; 2], first: [usize; 2], size: [usize; 2], pixels: &mut [[f32; 4]], pitch: usize) {
    let [x, y] = [first[0] - origin[0], first[1] - origin[1]];
    for row in y..y + size[1] {
        pixels[row * pitch + x..][..size[0]].fill([0.0; 4]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_optical_depth_is_that_of_the_opacity() {
        for opacity in [0.0, 1e-6, 1e-3, 0.1, 0.29, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9995, OPAQUE] {
            let (got, want) = (optical_depth(opacity), -(-f64::from(opacity)).ln_1p());
            assert!((got - want).abs() <= 1e-9 * want + 1e-15, "{opacity}: {got} for {want}");
        }
    }
}
