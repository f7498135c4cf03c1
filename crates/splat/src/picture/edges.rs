//! Pixels through which a wall passes: of the volume's box, a crop box, a clip plane, or a layer's box.
//!
//! Such a pixel is the mean of reads on a grid, like many rays. Where the ray of each read enters and leaves the drawn
//! region is known exactly: the read is empty where its ray misses the region, and else the mean of the texels around
//! it, each rescaled from the length of its own ray to the length of the read's. This works because the mean extinction
//! along a ray continues smoothly across a wall, where its length does not. Texels just beyond a wall are drawn for
//! this ([`crate::view::silhouette`]).
//!
//! All other pixels stay as the warp has drawn them, but for those beyond the walls, which are cleared.

use glam::DVec2;
use wavesplat_compute::simd::{LANES, Level, Simd, VectorKernel};

use crate::picture::edge_texels::{Strip, Strips, Taps};
use crate::picture::resample::{Resampler, cubic_weights};
use crate::view::base_plane::BasePlane;
use crate::view::family::{Family, IndexRays};
use crate::view::region::Passage;
use crate::view::scattered::scattered_position;
use crate::view::silhouette::{Coverage, PixelGrid, PlaneSilhouette, RayHits, Silhouette};

/// Dependence of a texel on the length L of its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaling {
    /// Opacity of an extinction τ, `1 − exp(−τ L)`.
    Opacity,
    /// Proportional to L.
    Sum,
    /// Independent of L.
    None,
}

/// Input of the edge pass.
#[derive(Clone, Copy)]
pub struct Edges<'a> {
    /// The silhouette of the drawn regions.
    pub silhouette: &'a Silhouette,
    /// Dependence of texels on the lengths of rays.
    pub scaling: Scaling,
    /// Whether texels are values of a projection: a pixel whose middle ray is inside shows that ray's value, to the
    /// bit.
    pub is_projection: bool,
}

/// Reads of a pixel with an edge per axis, one in each cell of a grid; the same at every quality, so that a pixel's
/// share of a wall does not depend on it.
const READS_PER_AXIS: usize = 4;

/// Reads of a pixel with an edge.
const N_READS: usize = READS_PER_AXIS * READS_PER_AXIS;

/// Side of the squares in which edges are looked for, in pixels.
pub(crate) const SQUARE_PX: usize = 8;

/// The edge pass over a warped picture.
pub struct EdgePass<'a> {
    edges: Edges<'a>,
    resamplers: &'a [Resampler<'a>],
    /// The silhouette on each base plane.
    planes: Vec<PlaneSilhouette<'a>>,
    rays: &'a IndexRays,
    peak: f32,
    level: Level,
    is_parallel: bool,
    /// Positions of the reads in a pixel, from 0 to 1.
    reads: [[f64; 2]; N_READS],
    /// Largest size of a texel, in pixels.
    texel_size_px: f64,
    /// Width of the border around a pixel in which texels may end at other walls than the pixel does, in pixels.
    border_px: f64,
}

impl<'a> EdgePass<'a> {
    /// The pass over base planes; `None` where there are none.
    pub fn new(
        edges: Edges<'a>,
        resamplers: &'a [Resampler<'a>],
        rays: &'a IndexRays,
        peak: f32,
        level: Level,
    ) -> Option<Self> {
        let first = &resamplers.first()?.picture.plane;
        let planes: Vec<_> = resamplers.iter().map(|r| edges.silhouette.on(&r.picture.plane)).collect();
        let texel_size_px = resamplers.iter().map(|r| texel_px(&r.picture.plane, rays)).fold(0.0, f64::max);
        let narrow = resamplers.iter().any(|r| edges.silhouette.has_narrow_walls(&r.picture.plane));
        let border_px = if narrow || edges.silhouette.is_mixed() { texel_size_px } else { 0.0 };
        let is_parallel = first.eye_w().is_none();
        let reads = std::array::from_fn(|k| scattered_position(k, READS_PER_AXIS));
        Some(Self { edges, resamplers, planes, rays, peak, level, is_parallel, reads, texel_size_px, border_px })
    }

    /// Draws the pixels of a rectangle that have edges. `first`: its first column and row; `pixels`: the picture from
    /// that pixel on, with `pitch` pixels per row.
    pub fn draw(&self, first: [usize; 2], size: [usize; 2], pixels: &mut [[f32; 4]], pitch: usize) {
        let mut passages = Vec::new();
        match self.coverage(first, size, &mut passages) {
            Coverage::Inside => return,
            Coverage::Outside => return clear(first, first, size, pixels, pitch),
            Coverage::Edge => {}
        }
        let mut strips = Strips::default();
        for y in (0..size[1]).step_by(SQUARE_PX) {
            for x in (0..size[0]).step_by(SQUARE_PX) {
                let square = [SQUARE_PX.min(size[0] - x), SQUARE_PX.min(size[1] - y)];
                let at = [first[0] + x, first[1] + y];
                let rows = || (y..y + square[1]).map(|row| row * pitch + x);
                if rows().all(|row| pixels[row..row + square[0]].iter().all(|pixel| pixel[3] == 0.0))
                    && self.is_empty(at, square)
                {
                    continue;
                }
                match self.coverage(at, square, &mut passages) {
                    Coverage::Inside => {}
                    Coverage::Outside => clear(first, at, square, pixels, pitch),
                    Coverage::Edge => self.draw_square(first, at, square, pixels, pitch, &mut passages, &mut strips),
                }
            }
        }
    }

    /// Whether nothing has been drawn in any texel that is read anywhere in a rectangle of pixels.
    fn is_empty(&self, first: [usize; 2], size: [usize; 2]) -> bool {
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]]
            .map(|corner| [0, 1].map(|axis| (first[axis] + corner[axis] * size[axis]) as f64));
        self.resamplers.iter().all(|resampler| {
            let picture = resampler.picture;
            let texels = corners.map(|[x, y]| picture.plane.texel_from_pixel(self.rays, x, y));
            let lo = texels[1..].iter().fold(texels[0], |lo, texel| lo.min(*texel));
            let hi = texels[1..].iter().fold(texels[0], |hi, texel| hi.max(*texel));
            if resampler.drawn_between(lo, hi).is_empty() {
                return true;
            }
            // The cubic reads a texel further down and two further up.
            let [n_u, n_v] = picture.plane.size;
            let range = |lo: f64, hi: f64, n: usize| {
                let end = (hi + 3.0).clamp(0.0, n as f64) as usize;
                ((lo - 1.0).clamp(0.0, n as f64) as usize).min(end)..end
            };
            let (columns, mut rows) = (range(lo.x, hi.x, n_u), range(lo.y, hi.y, n_v));
            rows.all(|j| picture.row(j)[columns.clone()].iter().all(|texel| texel[3] == 0.0))
        })
    }

    /// Coverage of a rectangle of pixels by the silhouette.
    fn coverage(&self, first: [usize; 2], size: [usize; 2], passages: &mut Vec<Vec<Passage>>) -> Coverage {
        let corner = first.map(|px| px as f64 - self.border_px);
        let sides = size.map(|px| px as f64 + 2.0 * self.border_px);
        self.edges.silhouette.passages(self.rays, self.is_parallel, &PixelGrid::corners(corner, sides), passages);
        let of = |corners: &Vec<Passage>| {
            Coverage::of_region(std::array::from_fn(|k| &corners[k]), sides[0].min(sides[1]), self.texel_size_px)
        };
        passages.iter().map(of).reduce(Coverage::and).unwrap_or(Coverage::Outside)
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
        // Without a border, neighbouring pixels share corners, whose passages are computed once.
        let is_shared = self.border_px == 0.0;
        if is_shared {
            let grid = PixelGrid { first: first.map(|px| px as f64), distance: [1.0; 2], n: size.map(|n| n + 1) };
            self.edges.silhouette.passages(self.rays, self.is_parallel, &grid, passages);
        }
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = [first[0] + x, first[1] + y];
                let pixel = &mut pixels[(at[1] - origin[1]) * pitch + at[0] - origin[0]];
                // A pixel that the warp left empty may have an edge: its middle may lie beyond a wall, but not all of
                // it.
                if pixel[3] == 0.0 && self.is_empty(at, [1, 1]) {
                    continue;
                }
                let coverage = if is_shared {
                    let corner = y * (size[0] + 1) + x;
                    let corners = [corner, corner + 1, corner + size[0] + 1, corner + size[0] + 2];
                    let of = |of: &Vec<Passage>| Coverage::of_region(corners.map(|k| &of[k]), 1.0, self.texel_size_px);
                    passages.iter().map(of).reduce(Coverage::and).unwrap_or(Coverage::Outside)
                } else {
                    self.coverage(at, [1, 1], passages)
                };
                match coverage {
                    Coverage::Inside => {}
                    Coverage::Outside => *pixel = [0.0; 4],
                    Coverage::Edge => {
                        let before = *pixel;
                        *pixel = self.level.dispatch(DrawPixel { pass: self, at, before, strips });
                    }
                }
            }
        }
    }

    /// Colour of a pixel with an edge. `before`: the colour that the warp gave it.
    #[inline(always)]
    fn pixel<S: Simd>(&self, s: S, [x, y]: [usize; 2], before: [f32; 4], strips: &mut Strips) -> [f32; 4] {
        let mut hits = Hits::default();
        for k in 0..N_READS {
            let [dx, dy] = self.reads[k];
            hits.extend(self.hit([x as f64 + dx, y as f64 + dy]));
        }
        let share = hits.n as f32 / N_READS as f32;
        if hits.n == 0 {
            return [0.0; 4];
        }
        if self.edges.is_projection
            && let Some(middle) = self.hit([x as f64 + 0.5, y as f64 + 0.5])
        {
            let rgba = if self.edges.scaling == Scaling::None { before } else { self.read(s, &middle, strips) };
            return rgba.map(|c| c * share);
        }
        // Where all rays run equally far in the same regions, colours change slowly, and the one in the middle of the
        // reads is their mean.
        if self.is_uniform(&hits, strips) {
            let rgba = if hits.n == N_READS { before } else { self.read(s, &hits.middle(), strips) };
            return rgba.map(|c| c * share);
        }
        let mut sum = [0.0; 4];
        for hit in hits.iter() {
            let rgba = self.read(s, hit, strips);
            for c in 0..4 {
                sum[c] += rgba[c];
            }
        }
        sum.map(|c| c * (1.0 / N_READS as f32))
    }

    /// Whether all rays that hit, and the texels that they read, run equally far in the same regions.
    #[inline(always)]
    fn is_uniform(&self, hits: &Hits, strips: &mut Strips) -> bool {
        let Some(first) = hits.iter().next() else { return true };
        let (mut lo, mut hi) = (first.at, first.at);
        for hit in hits.iter() {
            if hit.plane != first.plane || !hit.met.is_like(&first.met) {
                return false;
            }
            (lo, hi) = (lo.min(hit.at), hi.max(hit.at));
        }
        let [i, j] = [0, 1].map(|axis| (lo[axis].floor() as i64 - 1, hi[axis].floor() as i64 + 2));
        let lanes = LANES as i64;
        (j.0..=j.1).all(|j| {
            (i.0.div_euclid(lanes)..=i.1.div_euclid(lanes)).all(|strip| {
                let level = self.strip(first.plane, [strip, j], strips).level;
                level.is_some_and(|level| level.is_like(&first.met))
            })
        })
    }

    /// The read at a position of the picture; `None` where its ray misses everything.
    #[inline(always)]
    fn hit(&self, [x_px, y_px]: [f64; 2]) -> Option<Read> {
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

    /// The strip of texels of a base plane at a place, from the cache or made.
    #[inline(always)]
    fn strip<'s>(&self, plane: usize, place: [i64; 2], strips: &'s mut Strips) -> &'s Strip {
        let picture = self.resamplers[plane].picture;
        strips.get(plane, place, || Strip::new(&self.planes[plane], picture, self.edges.scaling, place))
    }

    /// The mean of the texels around a position, each rescaled to the length of the read's ray.
    #[inline(always)]
    fn read<S: Simd>(&self, s: S, read: &Read, strips: &mut Strips) -> [f32; 4] {
        let floor = read.at.floor();
        let t = (read.at - floor).to_array().map(|t| t as f32);
        let first = [floor.x as i64 - 1, floor.y as i64 - 1];
        let (along_u, along_v) = (cubic_weights(t[0]), cubic_weights(t[1]));
        let mut taps = Taps::default();
        for row in 0..4 {
            let j = first[1] + row as i64;
            // Four texels of a row lie in one strip, or in two.
            let mut column = 0;
            while column < 4 {
                let i = first[0] + column as i64;
                let (place, lane) = ([i.div_euclid(LANES as i64), j], i.rem_euclid(LANES as i64) as usize);
                let strip = self.strip(read.plane, place, strips);
                let n_here = (4 - column).min(LANES - lane);
                for (column, lane) in (column..column + n_here).zip(lane..) {
                    taps.weight[4 * row + column] = along_u[column] * along_v[row];
                    taps.set(4 * row + column, strip, lane, &read.met, self.edges.scaling);
                }
                column += n_here;
            }
        }
        taps.mean(s, self.edges.scaling, t, self.peak)
    }
}

/// Vector kernel that draws a pixel with an edge.
struct DrawPixel<'a, 'b> {
    pass: &'a EdgePass<'a>,
    at: [usize; 2],
    /// The colour that the warp gave it.
    before: [f32; 4],
    strips: &'b mut Strips,
}

impl VectorKernel for DrawPixel<'_, '_> {
    type Output = [f32; 4];

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> [f32; 4] {
        self.pass.pixel(s, self.at, self.before, self.strips)
    }
}

/// A read of a base plane.
#[derive(Clone, Copy, Default)]
struct Read {
    /// Index of the base plane.
    plane: usize,
    /// Texel position.
    at: DVec2,
    /// Regions that its ray meets, and the length in them.
    met: RayHits,
}

/// The reads of a pixel whose rays hit anything.
#[derive(Default)]
struct Hits {
    reads: [Read; N_READS],
    n: usize,
}

impl Hits {
    #[inline(always)]
    fn extend(&mut self, read: Option<Read>) {
        if let Some(read) = read {
            self.reads[self.n] = read;
            self.n += 1;
        }
    }

    fn iter(&self) -> impl Iterator<Item = &Read> {
        self.reads[..self.n].iter()
    }

    /// The read at the mean position; all reads meet the same regions.
    fn middle(&self) -> Read {
        let sum: DVec2 = self.iter().map(|read| read.at).sum();
        Read { at: sum / self.n as f64, ..self.reads[0] }
    }
}

/// Size of a texel in the middle of a base plane, in pixels; at most 10.
fn texel_px(plane: &BasePlane, rays: &IndexRays) -> f64 {
    let per_px = plane.texels_per_pixel(rays);
    1.0 / per_px.max(0.1)
}

/// Clears a rectangle of pixels beyond the walls.
fn clear(origin: [usize; 2], first: [usize; 2], size: [usize; 2], pixels: &mut [[f32; 4]], pitch: usize) {
    let [x, y] = [first[0] - origin[0], first[1] - origin[1]];
    for row in y..y + size[1] {
        pixels[row * pitch + x..][..size[0]].fill([0.0; 4]);
    }
}
