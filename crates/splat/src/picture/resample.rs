//! Bicubic resampling of a base plane between its texels.
//!
//! The filter is the Catmull-Rom cubic (Keys 1981), which keeps the details that the base plane resolves, clamped to
//! the texels around the position so that edges do not ring, and to the brightest colour that its opacity can have.
//! Where nothing was drawn, nothing is read: a summed-area table (Crow 1984) counts the cells that were drawn in.

use std::ops::Range;

use glam::DVec2;
use wavesplat_compute::simd::{LANES, Lanes, Math, ROUND, Rows, Simd};

use crate::picture::base_picture::{BasePicture, CELL, MARGIN};

/// Largest distance of a position from its base, and of a base from the base plane, in texels; anything further is
/// outside.
pub const FAR: f32 = (1 << 22) as f32;

/// Pixels whose four channels fill the lanes.
pub const QUAD: usize = 4;

/// Sixteen pixels, four per vector.
pub type Quads<S> = [<S as Math>::F; LANES / QUAD];

/// Lane of the opacity of each lane's pixel.
const OPACITY: Lanes<u32> = Lanes([3, 3, 3, 3, 7, 7, 7, 7, 11, 11, 11, 11, 15, 15, 15, 15]);

/// Indicator of the lanes that hold an opacity.
const IS_OPACITY: [f32; LANES] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Number of each lane's pixel among sixteen, for each quad of pixels.
const PIXEL: [Lanes<u32>; LANES / QUAD] = [
    Lanes([0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]),
    Lanes([4, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6, 7, 7, 7, 7]),
    Lanes([8, 8, 8, 8, 9, 9, 9, 9, 10, 10, 10, 10, 11, 11, 11, 11]),
    Lanes([12, 12, 12, 12, 13, 13, 13, 13, 14, 14, 14, 14, 15, 15, 15, 15]),
];

/// Slope of the cubic of Catmull and Rom.
const CATMULL_ROM: f32 = -0.5;

/// Reader of a finished base plane.
pub struct Resampler<'a> {
    /// The base plane.
    pub picture: &'a BasePicture,
    /// Summed-area table: number of drawn cells before a column and a row of cells; one column and one row more than
    /// there are cells.
    n_drawn: Vec<u32>,
    n_cells: [usize; 2],
}

impl<'a> Resampler<'a> {
    /// A reader of a finished base plane.
    pub fn new(picture: &'a BasePicture) -> Self {
        let (cells, n_u) = picture.drawn_cells();
        let mut n_drawn = vec![0; n_u + 1];
        for row in cells.chunks_exact(n_u) {
            let above = n_drawn.len() - (n_u + 1);
            let mut n_in_row = 0;
            n_drawn.push(0);
            for (u, is_drawn) in row.iter().enumerate() {
                n_in_row += u32::from(*is_drawn);
                n_drawn.push(n_drawn[above + u + 1] + n_in_row);
            }
        }
        Self { picture, n_drawn, n_cells: [n_u, cells.len() / n_u] }
    }

    /// Colours at sixteen texel positions, four per vector; `None` where nothing can be seen. `peak`: largest
    /// unassociated colour. `base`: whole texels that the positions count from. `lanes`: the lanes that are wanted,
    /// whose positions are monotonic; other lanes are undefined, or empty where their positions are far away. `look`:
    /// whether to check first that anything has been drawn there.
    #[inline(always)]
    pub fn read<S: Simd>(
        &self,
        s: S,
        base: [i32; 2],
        positions: [S::F; 2],
        lanes: Range<usize>,
        look: bool,
        peak: f32,
    ) -> Option<Quads<S>> {
        let mut first_read = [Lanes([0; LANES]); 2];
        let mut shares = [s.splat(0.0); 2];
        for axis in 0..2 {
            // Positions beyond the base plane, and NaN, read the margin.
            let [lo, hi] = [-1.5, self.picture.plane.size[axis] as f32 + 0.5].map(|end| end - base[axis] as f32);
            let x = s.max(s.min(positions[axis], s.splat(hi)), s.splat(lo));
            // A whole position may count as the end (t = 1) of the texel before, where the cubic gives the same value.
            let shifted = s.add(s.sub(x, s.splat(0.5)), s.splat(ROUND));
            shares[axis] = s.sub(x, s.sub(shifted, s.splat(ROUND)));
            // After the addition of ROUND the low bits of the float hold the whole number.
            let mut texels = Lanes([0.0_f32; LANES]);
            s.store(shifted, &mut texels.0);
            let to_first_read = base[axis] - ROUND.to_bits() as i32 + MARGIN as i32 - 1;
            for k in 0..LANES {
                first_read[axis].0[k] = to_first_read.wrapping_add(texels.0[k].to_bits() as i32) as u32;
            }
        }
        let [Lanes(i), Lanes(j)] = &first_read;
        if look {
            let (first, last) = (lanes.start, lanes.end - 1);
            let ends = [[i[first], i[last]], [j[first], j[last]]].map(|[a, b]| [a.min(b), a.max(b)]);
            if self.cells(ends).is_empty() {
                return None;
            }
        }
        let (texels, pitch) = self.picture.with_margin();
        let rows = Rows::new(texels.as_flattened(), 4 * pitch);
        let mut places = Lanes([0; LANES]);
        for k in 0..LANES {
            places.0[k] = j[k].wrapping_mul(pitch as u32).wrapping_add(i[k]);
        }
        let mut weights = [[Lanes([0.0; LANES]); 4]; 2];
        for axis in 0..2 {
            let [w0, w1, w2, w3] = cubic(s, CATMULL_ROM, shares[axis]);
            s.store(w0, &mut weights[axis][0].0);
            s.store(w1, &mut weights[axis][1].0);
            s.store(w2, &mut weights[axis][2].0);
            s.store(w3, &mut weights[axis][3].0);
        }
        let mut quads = [s.splat(0.0); LANES / QUAD];
        if lanes.end <= QUAD {
            quads[0] = read_quad(s, &rows, 0, &places, &weights, peak);
            return Some(quads);
        }
        for quad in 0..LANES / QUAD {
            quads[quad] = read_quad(s, &rows, quad, &places, &weights, peak);
        }
        Some(quads)
    }

    /// Drawn cells that the filter may read at positions between two texel positions.
    pub fn drawn_between(&self, lo: DVec2, hi: DVec2) -> Drawn {
        let size = self.picture.plane.size;
        let first_read = |x: f64, axis: usize| (x.clamp(-2.0, size[axis] as f64) + (MARGIN - 1) as f64) as u32;
        self.cells([[first_read(lo.x, 0), first_read(hi.x, 0)], [first_read(lo.y, 1), first_read(hi.y, 1)]])
    }

    /// Drawn cells that the filter reads, by the ranges of the first texels that it reads.
    #[inline(always)]
    fn cells(&self, [[first_i, last_i], [first_j, last_j]]: [[u32; 2]; 2]) -> Drawn {
        let [n_u, n_v] = self.n_cells;
        let cell = |first_read: u32, n_texels: usize, n_cells: usize| {
            ((first_read as usize).saturating_sub(MARGIN - 1) / n_texels).min(n_cells - 1)
        };
        let (u, end_u) = (cell(first_i, CELL[0], n_u), cell(last_i, CELL[0], n_u) + 1);
        let (v, end_v) = (cell(first_j, CELL[1], n_v), cell(last_j, CELL[1], n_v) + 1);
        let n_before = |u: usize, v: usize| self.n_drawn[v * (n_u + 1) + u];
        let n_here = n_before(end_u, end_v).wrapping_add(n_before(u, v));
        let n_drawn = n_here.wrapping_sub(n_before(u, end_v).wrapping_add(n_before(end_u, v)));
        Drawn { n_drawn, n_cells: ((end_u - u) * (end_v - v)) as u32 }
    }
}

/// Number of cells in a rectangle of a base plane, and of those that have been drawn in.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    n_drawn: u32,
    n_cells: u32,
}

impl Drawn {
    /// Whether no cell has been drawn in.
    pub fn is_empty(self) -> bool {
        self.n_drawn == 0
    }

    /// Whether all cells have been drawn in.
    pub fn is_full(self) -> bool {
        self.n_drawn == self.n_cells
    }
}

/// Colours at four of sixteen positions. `places`: offsets of the first texel that each position reads.
#[inline(always)]
fn read_quad<S: Simd>(
    s: S,
    rows: &Rows,
    quad: usize,
    places: &Lanes<u32>,
    [weights_u, weights_v]: &[[Lanes; 4]; 2],
    peak: f32,
) -> S::F {
    let (mut columns, mut least, mut most) = ([s.splat(0.0); 4], [s.splat(0.0); 4], [s.splat(0.0); 4]);
    for k in 0..QUAD {
        let at = quad * QUAD + k;
        // Four texels of a row are sixteen channels: the filter runs down the columns first, then across.
        let [first, second, third, fourth] = s.load_rows(rows, 4 * places.0[at] as usize);
        let (w1, w2) = (s.splat(weights_v[1].0[at]), s.splat(weights_v[2].0[at]));
        let (w0, w3) = (s.splat(weights_v[0].0[at]), s.splat(weights_v[3].0[at]));
        columns[k] = s.add(s.add_mul(s.mul(w0, first), w1, second), s.add_mul(s.mul(w2, third), w3, fourth));
        least[k] = s.min(second, third);
        most[k] = s.max(second, third);
    }
    let [a, b, c, d] = s.transpose_quads(columns);
    let pixel = &PIXEL[quad];
    let (w1, w2) = (s.take(&weights_u[1].0, pixel), s.take(&weights_u[2].0, pixel));
    let (w0, w3) = (s.take(&weights_u[0].0, pixel), s.take(&weights_u[3].0, pixel));
    let sum = s.add(s.add_mul(s.mul(w0, a), w1, b), s.add_mul(s.mul(w2, c), w3, d));
    // Extremes of the two texels in the middle: of two reads in one vector, then of four.
    let least = s.deinterleave_quads(s.middle_quads(least[0], least[1]), s.middle_quads(least[2], least[3]));
    let most = s.deinterleave_quads(s.middle_quads(most[0], most[1]), s.middle_quads(most[2], most[3]));
    held(s, sum, [s.min(least[0], least[1]), s.max(most[0], most[1])], peaks(s, peak))
}

/// Four pixels clamped to the texels around them, no colour brighter than its opacity allows. `peak`: from [`peaks`].
#[inline(always)]
fn held<S: Simd>(s: S, quad: S::F, [least, most]: [S::F; 2], peak: S::F) -> S::F {
    let color = s.min(s.max(quad, least), most);
    let mut numbers = Lanes([0.0; LANES]);
    s.store(color, &mut numbers.0);
    s.min(color, s.mul(peak, s.take(&numbers.0, &OPACITY)))
}

/// Largest ratio to its pixel's opacity of each channel of four pixels. `peak`: the ratio of a colour.
#[inline(always)]
fn peaks<S: Simd>(s: S, peak: f32) -> S::F {
    let is_opacity = s.lt(s.splat(0.5), s.load(&IS_OPACITY));
    s.select(is_opacity, s.splat(1.0), s.splat(peak))
}

/// Weights of four neighbouring values at the fraction `t` from the second to the third, by the cubic of the given
/// slope parameter (a of Keys 1981).
#[inline(always)]
fn cubic<S: Simd>(s: S, slope: f32, t: S::F) -> [S::F; 4] {
    let (one, a) = (s.splat(1.0), s.splat(slope));
    let w0 = s.mul(s.add(s.mul(s.add(s.mul(a, t), s.splat(-2.0 * slope)), t), a), t);
    let w1 = s.add(s.mul(s.mul(s.sub(s.mul(s.splat(slope + 2.0), t), s.splat(slope + 3.0)), t), t), one);
    let w3 = s.mul(s.mul(s.sub(a, s.mul(a, t)), t), t);
    [w0, w1, s.sub(s.sub(s.sub(one, w0), w1), w3), w3]
}

/// Weights of the Catmull-Rom cubic at one position, by the same operations in the same order.
#[inline(always)]
pub fn cubic_weights(t: f32) -> [f32; 4] {
    let a = CATMULL_ROM;
    let w0 = ((a * t + -2.0 * a) * t + a) * t;
    let w1 = ((a + 2.0) * t - (a + 3.0)) * t * t + 1.0;
    let w3 = (a - a * t) * t * t;
    // The third weight is what the others leave of 1, so that rounding does not change an even picture.
    [w0, w1, 1.0 - w0 - w1 - w3, w3]
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};
    use wavesplat_compute::simd::{Level, Plain, VectorKernel};
    use wavesplat_core::{Camera, Projection};

    use super::*;
    use crate::view::base_plane::{BasePlane, base_planes};
    use crate::view::family::IndexRays;

    fn base_plane(size: [usize; 2]) -> BasePlane {
        let projection = Projection::Orthographic { parallel_scale: 9.0 };
        let camera = Camera::new(DVec3::new(4.0, 5.0, 40.0), DVec3::splat(4.0), DVec3::Y, projection).unwrap();
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 9, 9);
        let mut planes = base_planes(&camera, &rays, [9, 9], 1.0, [DVec3::ZERO, DVec3::splat(9.0)]).unwrap();
        planes[0].size = size;
        planes.remove(0)
    }

    fn random(i: usize) -> f64 {
        ((i as f64 * 12.9898).sin() * 43758.5453).rem_euclid(1.0)
    }

    fn full_picture(size: [usize; 2]) -> BasePicture {
        let mut picture = BasePicture::new(base_plane(size), false);
        for j in 0..size[1] {
            for i in (0..size[0]).step_by(LANES) {
                let texel = |k: usize| std::array::from_fn(|c| random(1000 * j + 10 * (i + k) + c) as f32);
                picture.put(i, j, &std::array::from_fn(texel), None);
            }
        }
        picture
    }

    #[test]
    fn every_other_texel_lies_where_it_lay() {
        let picture = full_picture([37, 21]);
        for (k, first, size) in [(2, 0, [19, 11]), (2, 1, [18, 10]), (4, 0, [10, 6]), (4, 3, [9, 5])] {
            let coarser = picture.every(k, first);
            assert_eq!(coarser.plane.size, size);
            for j in 0..size[1] {
                for i in 0..size[0] {
                    assert_eq!(coarser.row(j)[i], picture.row(first + k * j)[first + k * i]);
                    let at = |plane: &BasePlane, i: usize, j: usize| {
                        plane.origin + plane.step * DVec2::new(i as f64, j as f64)
                    };
                    let apart = at(&coarser.plane, i, j) - at(&picture.plane, first + k * i, first + k * j);
                    assert!(apart.length() < 1e-12, "{k} {first}: {i} {j}");
                }
            }
        }
    }

    /// Reads of a picture at positions from a base.
    struct Read<'a>(&'a BasePicture, [i32; 2], [[f32; LANES]; 2], f32);

    impl VectorKernel for Read<'_> {
        type Output = ([[f32; 4]; LANES], bool);

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Output {
            let Self(picture, base, [u, v], peak) = self;
            let mut pixels = [[0.0; 4]; LANES];
            let quads = Resampler::new(picture).read(s, base, [s.load(&u), s.load(&v)], 0..LANES, true, peak);
            if let Some(quads) = quads {
                for (pixels, quad) in pixels.as_flattened_mut().as_chunks_mut().0.iter_mut().zip(quads) {
                    s.store(quad, pixels);
                }
            }
            (pixels, quads.is_some())
        }
    }

    /// The cubic between texels, empty beyond the base plane, clamped to the nearest four.
    fn plain(texels: &[[f32; 4]], [n_u, n_v]: [usize; 2], [u, v]: [f64; 2], peak: f64) -> [f64; 4] {
        let at = |i: i64, j: i64, c: usize| {
            let inside = i >= 0 && j >= 0 && i < n_u as i64 && j < n_v as i64;
            if inside { f64::from(texels[j as usize * n_u + i as usize][c]) } else { 0.0 }
        };
        let weight = |t: f64| {
            let t = t.abs();
            if t < 1.0 {
                1.5 * t.powi(3) - 2.5 * t * t + 1.0
            } else if t < 2.0 {
                -0.5 * t.powi(3) + 2.5 * t * t - 4.0 * t + 2.0
            } else {
                0.0
            }
        };
        let (i, j) = (u.floor() as i64, v.floor() as i64);
        let mut rgba = [0.0; 4];
        for (c, out) in rgba.iter_mut().enumerate() {
            for dj in -1..3 {
                for di in -1..3 {
                    *out += weight(u - (i + di) as f64) * weight(v - (j + dj) as f64) * at(i + di, j + dj, c);
                }
            }
            let near = [at(i, j, c), at(i + 1, j, c), at(i, j + 1, c), at(i + 1, j + 1, c)];
            *out = out.clamp(near.into_iter().fold(f64::MAX, f64::min), near.into_iter().fold(f64::MIN, f64::max));
        }
        let brightest = [peak, peak, peak, 1.0].map(|peak| peak * rgba[3]);
        [0, 1, 2, 3].map(|c| rgba[c].min(brightest[c]))
    }

    #[test]
    fn it_is_read_as_the_cubic_says_and_empty_beyond() {
        let size = [37, 21];
        let picture = full_picture(size);
        let texels = picture.texels();
        assert_eq!(texels.len(), size[0] * size[1]);
        for run in 0..300 {
            // Runs in all directions, some of them partly or wholly beyond.
            let start = [0, 1].map(|a| random(7 * run + a) * (size[a] as f64 + 8.0) - 4.0);
            let step = [0, 1].map(|a| random(7 * run + 2 + a) * 2.0 - 1.0);
            let base = start.map(|x| x.floor() as i32);
            let at = |a: usize, k: usize| start[a] - f64::from(base[a]) + step[a] * k as f64;
            let positions = [0, 1].map(|a| std::array::from_fn(|k| at(a, k) as f32));
            let peak = 0.7;
            for level in Level::all() {
                let (pixels, is_seen) = level.dispatch(Read(&picture, base, positions, peak));
                for (k, pixel) in pixels.iter().enumerate() {
                    let position = [0, 1].map(|a| f64::from(base[a]) + f64::from(positions[a][k]));
                    let want = plain(&texels, size, position, f64::from(peak));
                    for c in 0..4 {
                        let (got, want) = (f64::from(pixel[c]), want[c]);
                        assert!((got - want).abs() < 1e-6, "{level:?} {position:?}: {got} for {want}");
                        assert!(is_seen || want == 0.0);
                    }
                }
            }
        }
    }

    /// Scattered chunks: everything that is skipped is empty, and something is skipped.
    #[test]
    fn only_what_is_empty_is_left_out() {
        let size = [150, 90];
        let mut picture = BasePicture::new(base_plane(size), false);
        for (i, j) in [(32, 0), (144, 40), (0, 89), (80, 48)] {
            picture.put(i, j, &[[0.5, 0.25, 0.125, 1.0]; LANES], None);
        }
        let texels = picture.texels();
        let (mut n_left_out, mut n_seen) = (0, 0);
        for v in -4..size[1] as i32 + 4 {
            for u in (-20..size[0] as i32 + 4).step_by(LANES) {
                let positions = [std::array::from_fn(|k| 0.3 + k as f32), [0.6; LANES]];
                let (pixels, is_seen) = Level::best().dispatch(Read(&picture, [u, v], positions, 1.0));
                for (k, pixel) in pixels.iter().enumerate() {
                    let at = [f64::from(u) + f64::from(positions[0][k]), f64::from(v) + f64::from(positions[1][k])];
                    let want = plain(&texels, size, at, 1.0);
                    assert!(
                        (0..4).all(|c| (f64::from(pixel[c]) - want[c]).abs() < 1e-6),
                        "{at:?}: {pixel:?} for {want:?}"
                    );
                    n_seen += usize::from(want[3] > 0.0);
                }
                let first = DVec2::new(f64::from(u) + 0.3, f64::from(v) + 0.6);
                let last = first + DVec2::new((LANES - 1) as f64, 0.0);
                assert_eq!(!Resampler::new(&picture).drawn_between(first, last).is_empty(), is_seen, "{first}");
                n_left_out += usize::from(!is_seen);
            }
        }
        assert!(n_left_out > 500 && n_seen > 100, "{n_left_out} left out, {n_seen} pixels seen");
    }

    #[test]
    fn far_away_there_is_nothing() {
        let picture = full_picture([37, 21]);
        let far = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, FAR, -FAR, f32::MAX];
        let places = far.map(|x| (0, x)).into_iter().chain([1 << 22, -(1 << 22)].map(|base| (base, 3.0)));
        for ((base, x), level) in places.flat_map(|place| Level::all().into_iter().map(move |level| (place, level))) {
            for [u, v] in [[x, 5.0], [5.0, x], [x, x]] {
                let base = [if u == 5.0 { 0 } else { base }, if v == 5.0 { 0 } else { base }];
                let positions = [[u; LANES], [v; LANES]];
                let (pixels, _) = level.dispatch(Read(&picture, base, positions, 1.0));
                assert!(pixels == [[0.0; 4]; LANES], "{level:?} {base:?} {u} {v}");
            }
        }
    }

    #[test]
    fn weights_of_one_position_are_those_of_sixteen_to_the_bit() {
        for k in 0..1000 {
            let t = k as f32 / 999.0;
            assert_eq!(cubic_weights(t), cubic(Plain, CATMULL_ROM, [t; LANES]).map(|weights| weights[0]), "{t}");
        }
    }
}
