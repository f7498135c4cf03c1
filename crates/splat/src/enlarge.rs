//! Pixels that lie close together in a base plane: only some of them are read, the others put between these.
//!
//! Of a coarse level of details a texel covers many pixels, and its cubic is smooth: reads five eighths of a texel apart,
//! with a cubic between them that is sharper, are as near to what the texels are samples of as reads at every pixel (the
//! test below). Only half way between two reads pixels are on the cubic; between these they are on straight lines, which
//! cost little.

use std::cmp::Ordering;
use std::ops::Range;

use wavesplat_compute::simd::{LANES, Simd};

use crate::reads::Reads;
use crate::resample::{QUAD, Quads, cubic, held, peaks};
use crate::warp::Rectangle;

/// Reads are no further apart than so many texels.
const READS_APART: f64 = 0.62;

/// Slope of the cubic between reads; that of the reads has -0.5.
const SLOPE: f32 = -0.7;

/// The same where there are pixels on the lines: these are less sharp.
const SLOPE_OF_LINES: f32 = -0.95;

/// Pixels from a read to the next.
const STEPS: [usize; 5] = [2, 3, 4, 6, 8];

/// Reads that the cubic takes before the first pixel and after the last.
const BESIDE: usize = 3;

/// Reads of a row that pixels follow, at most: whole vectors, and with what is beside them hardly less than sixteen at a
/// time.
const SPANS: usize = 3 * LANES - QUAD;

/// Vectors of a row of reads.
const N_QUADS: usize = (SPANS + BESIDE).div_ceil(QUAD);

/// Sixteen reads are read at a time: so many times a row.
const N_RUNS: usize = (SPANS + BESIDE).div_ceil(LANES);

/// Which pixels are read where neighbours lie so many texels apart at most.
pub fn few_reads(texels_per_pixel: f64) -> Reads {
    let most = READS_APART / texels_per_pixel;
    // None where that is no number.
    STEPS.into_iter().rfind(|step| *step as f64 <= most).map_or(Reads::Grid(1), Reads::OneOf)
}

/// Columns of pixels that one row of reads serves.
pub fn n_columns(pixels_per_read: usize) -> usize {
    SPANS * pixels_per_read
}

/// Where the reads of a run of `n` pixels begin and end, in pixels of as many reads; the first pixel is the `first`th.
pub fn reads_around(pixels_per_read: usize, first: usize, n: usize) -> [f64; 2] {
    let begin = first as f64 / pixels_per_read as f64 - 0.5;
    [begin, begin + (n_reads(pixels_per_read, n) - 1) as f64]
}

/// Reads for a run of `n` pixels.
fn n_reads(pixels_per_read: usize, n: usize) -> usize {
    (n - 1) / pixels_per_read + 1 + BESIDE
}

/// Reads of a row, four a vector.
type Row = [[f32; LANES]; N_QUADS];

/// Draws pixels, at most [`n_columns`] of a row. `read` reads some of a row by its number, of which the first and how many,
/// at most sixteen, are asked for; the first one of all is read before the first pixel, row 0 one read above the first row
/// of pixels. `None`: nothing can be seen there.
#[inline(always)]
pub fn draw<S: Simd>(
    s: S,
    pixels_per_read: usize,
    rectangle: Rectangle<'_>,
    peak: f32,
    read: impl Fn(usize, Range<usize>) -> Option<Quads<S>>,
) {
    match pixels_per_read {
        2 => draw_by::<2, S>(s, rectangle, peak, read),
        3 => draw_by::<3, S>(s, rectangle, peak, read),
        4 => draw_by::<4, S>(s, rectangle, peak, read),
        6 => draw_by::<6, S>(s, rectangle, peak, read),
        _ => draw_by::<8, S>(s, rectangle, peak, read),
    }
}

#[inline(always)]
fn draw_by<const N: usize, S: Simd>(
    s: S,
    rectangle: Rectangle<'_>,
    peak: f32,
    read: impl Fn(usize, Range<usize>) -> Option<Quads<S>>,
) {
    let Rectangle { columns, pixels, width_px, .. } = rectangle;
    let n_reads = n_reads(N, columns.len());
    let between = Between::<S>::new::<N>(s, peak);
    // The four rows of reads around a row of pixels, each in its place by number, and where something is seen in them.
    let mut reads: [Row; 4] = [[[0.0; LANES]; N_QUADS]; 4];
    let mut is_seen = [[false; N_RUNS]; 4];
    let mut n_read = 0;
    // The rows of pixels that follow a row of reads, at the columns of reads.
    let mut rows: [Row; N] = [[[0.0; LANES]; N_QUADS]; N];
    for (first, pixels) in pixels.chunks_mut(N * width_px).enumerate() {
        while n_read < first + 4 {
            for run in 0..n_reads.div_ceil(LANES) {
                let quads = read(n_read, run * LANES..n_reads.min((run + 1) * LANES));
                is_seen[n_read % 4][run] = quads.is_some();
                let quads = quads.unwrap_or([s.splat(0.0); LANES / QUAD]);
                for (to, from) in reads[n_read % 4][run * LANES / QUAD..].iter_mut().zip(quads) {
                    s.store(from, to);
                }
            }
            n_read += 1;
        }
        let around = [0, 1, 2, 3].map(|i| &reads[(first + i) % 4]);
        for q in 0..n_reads.div_ceil(QUAD) {
            let quads: [S::F; N] = between.of(s, around.map(|row| &row[q]));
            for i in 0..N {
                s.store(quads[i], &mut rows[i][q]);
            }
        }
        // The picture is only written to where something is seen.
        let is_drawn: [bool; N_RUNS] =
            std::array::from_fn(|run| is_seen.iter().any(|seen| seen[run..].iter().take(2).any(|seen| *seen)));
        for (row, pixels) in rows.iter().zip(pixels.chunks_exact_mut(width_px)) {
            let reads = row.as_flattened();
            let pixels = &mut pixels[columns.clone()];
            for (k, pixels) in pixels.chunks_mut(N * QUAD).enumerate() {
                if !is_drawn[k * QUAD / LANES] {
                    continue;
                }
                let from = |read: usize| reads[4 * (k * QUAD + read)..].first_chunk().unwrap_or(&[0.0; LANES]);
                put(s, between.of::<N>(s, [from(0), from(1), from(2), from(3)]), from(2), pixels);
            }
        }
    }
}

/// Writes as many pixels of four reads as there is room for. `quads[i]`: the `i`th pixel of each; `next`: the first of
/// those that follow each.
#[inline(always)]
fn put<const N: usize, S: Simd>(s: S, quads: [S::F; N], next: &[f32; LANES], pixels: &mut [[f32; 4]]) {
    let mut some = [[[0.0; 4]; N]; QUAD];
    let whole = pixels.as_chunks_mut().0.first_chunk_mut();
    let is_whole = whole.is_some();
    let drawn: &mut [[[f32; 4]; N]; QUAD] = whole.unwrap_or(&mut some);
    if N == 2 {
        let halves = s.interleave_quads(quads[0], quads[1]);
        for (half, to) in halves.into_iter().zip(drawn.as_flattened_mut().as_flattened_mut().as_chunks_mut().0) {
            s.store(half, to);
        }
    } else if N == 3 {
        let rows = s.transpose_quads([quads[0], quads[1], quads[2], s.load(next)]);
        // Vectors overlap; of the last one what follows is left out.
        for (read, row) in rows.into_iter().enumerate() {
            store(s, row, &mut drawn.as_flattened_mut()[N * read..]);
        }
    } else {
        // A vector from the first pixel on, another one up to the last.
        let firsts = s.transpose_quads([quads[0], quads[1], quads[2], quads[3 % N]]);
        for (row, to) in firsts.into_iter().zip(&mut *drawn) {
            store(s, row, to);
        }
        if N > QUAD {
            let lasts = s.transpose_quads([quads[N - 4], quads[N - 3], quads[N - 2], quads[N - 1]]);
            for (row, to) in lasts.into_iter().zip(&mut *drawn) {
                store(s, row, &mut to[N - QUAD..]);
            }
        }
    }
    if !is_whole {
        pixels.copy_from_slice(&some.as_flattened()[..pixels.len()]);
    }
}

/// Writes as many of four pixels as there is room for.
#[inline(always)]
fn store<S: Simd>(s: S, quads: S::F, pixels: &mut [[f32; 4]]) {
    if let Some(to) = pixels.as_flattened_mut().first_chunk_mut() {
        s.store(quads, to);
    } else {
        let mut numbers = [0.0; LANES];
        s.store(quads, &mut numbers);
        pixels.copy_from_slice(&numbers.as_chunks().0[..pixels.len()]);
    }
}

/// What is put between reads.
struct Between<S: Simd> {
    /// Weights of the reads around the middle between two: of those that are further away, and of the two.
    middle: [S::F; 2],
    /// Of [`peaks`].
    peak: S::F,
}

impl<S: Simd> Between<S> {
    #[inline(always)]
    fn new<const N: usize>(s: S, peak: f32) -> Self {
        let [far, near, ..] = cubic(s, if N == 2 { SLOPE } else { SLOPE_OF_LINES }, s.splat(0.5));
        Self { middle: [far, near], peak: peaks(s, peak) }
    }

    /// The pixels that follow the second of four reads, at every `N`th part of the way to the third, of four reads each:
    /// by the cubic half way, on lines to there and from there on.
    #[inline(always)]
    fn of<const N: usize>(&self, s: S, around: [&[f32; LANES]; 4]) -> [S::F; N] {
        let [a, b, c, d] = [s.load(around[0]), s.load(around[1]), s.load(around[2]), s.load(around[3])];
        let [far, near] = self.middle;
        let middle = s.add_mul(s.mul(far, s.add(a, d)), near, s.add(b, c));
        let middle = held(s, middle, [s.min(b, c), s.max(b, c)], self.peak);
        let (to_middle, from_middle) = (s.sub(middle, b), s.sub(c, middle));
        let mut quads = [b; N];
        for i in 1..N {
            quads[i] = match (2 * i).cmp(&N) {
                Ordering::Less => s.add_mul(b, s.splat((2 * i) as f32 / N as f32), to_middle),
                Ordering::Equal => middle,
                Ordering::Greater => s.add_mul(middle, s.splat((2 * i - N) as f32 / N as f32), from_middle),
            };
        }
        quads
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec2, DVec3};
    use wavesplat_compute::simd::Level;
    use wavesplat_core::{Camera, Projection};

    use super::*;
    use crate::base_picture::BasePicture;
    use crate::base_plane::{BasePlane, base_planes};
    use crate::family::{Family, IndexRays};
    use crate::resample::Resampler;
    use crate::warp::{colors, texels_per_pixel};

    const PEAK: f32 = 0.9;

    /// Spots a few texels wide on nothing, alike in base planes of several families: what is at a texel position.
    fn spots(plane: &BasePlane, at: DVec2, texel: f64) -> [f32; 4] {
        let base = plane.origin + plane.step * at;
        let mut place = [0.0; 3];
        for (axis, x) in plane.family.axes.into_iter().zip([base.x, base.y, 1.0]) {
            place[axis] = if plane.family.ascending { x } else { -x };
        }
        let place = DVec3::from_array(place);
        let place = if plane.eye_w().is_some() { place.normalize() } else { place } / texel;
        let wave = |x: f64, y: f64, z: f64| (place.dot(DVec3::new(x, y, z))).sin();
        let alpha = wave(0.9, 0.2, 0.4) * wave(0.1, 0.8, -0.5) + 0.5 * wave(-0.3, 0.4, 0.9);
        let alpha = alpha.clamp(0.0, 1.0) as f32;
        [0.2 * alpha, 0.5 * alpha, PEAK * alpha, alpha]
    }

    fn draw_spots(picture: &mut BasePicture, texel: f64) {
        let plane = picture.plane.clone();
        let [n_u, n_v] = plane.size;
        for j in 0..n_v {
            for i in (0..n_u).step_by(LANES) {
                let texels = std::array::from_fn(|k| spots(&plane, DVec2::new((i + k) as f64, j as f64), texel));
                picture.put(i, j, &texels, None);
            }
        }
    }

    /// What is put between reads is nearly what reads show, as near to the spots, and the same with all vectors.
    fn check(projection: Projection, position: DVec3, pixels_per_read: usize, size_px: [usize; 2]) {
        // As far apart as reads get, and nearer to each other.
        for (apart, most_rms, most) in [(READS_APART, 0.01, 0.1), (0.5, 0.006, 0.08)] {
            check_apart(projection, position, pixels_per_read, size_px, apart, [most_rms, most]);
        }
    }

    fn check_apart(
        projection: Projection,
        position: DVec3,
        pixels_per_read: usize,
        size_px: [usize; 2],
        apart: f64,
        [most_rms, most_error]: [f64; 2],
    ) {
        let camera = Camera::new(position, DVec3::splat(20.0), DVec3::new(0.2, 1.0, 0.1), projection).unwrap();
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, size_px[0], size_px[1]);
        let oversampling = apart / pixels_per_read as f64;
        let shown = [DVec3::splat(-100.0), DVec3::splat(140.0)];
        let planes = base_planes(&camera, &rays, size_px, oversampling, shown).unwrap();
        let mut pictures: Vec<_> = planes.into_iter().map(|plane| BasePicture::new(plane, false)).collect();
        let texel = pictures[0].plane.step.max_element();
        for picture in &mut pictures {
            draw_spots(picture, texel);
        }
        if apart == READS_APART && matches!(projection, Projection::Orthographic { .. }) {
            assert_eq!(few_reads(texels_per_pixel(&pictures, &rays, size_px)), Reads::OneOf(pixels_per_read));
        }
        let resamplers: Vec<_> = pictures.iter().map(Resampler::new).collect();
        let draw = |level, reads| colors(level, &resamplers, &rays, size_px, reads, PEAK, None);
        let all = draw(Level::best(), Reads::Grid(1));
        let some = draw(Level::best(), Reads::OneOf(pixels_per_read));
        let n_seen = all.iter().filter(|rgba| rgba[3] > 0.0).count();
        assert!(n_seen > all.len() / 4, "{n_seen} of {}", all.len());
        let square = |a: &[f32; 4], b: &[f32; 4]| (0..4).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
        let (mut between, mut of_all, mut of_some, mut most) = (0.0, 0.0, 0.0, 0.0_f32);
        for (k, (all, some)) in all.iter().zip(&some).enumerate() {
            let [x, y] = [k % size_px[0], k / size_px[0]].map(|px| px as f64 + 0.5);
            let family = Family::of(rays.direction(x, y));
            let Some(picture) = pictures.iter().find(|picture| picture.plane.family == family) else { continue };
            let spots = spots(&picture.plane, picture.plane.texel_from_pixel(&rays, x, y), texel);
            between += square(all, some);
            of_all += square(all, &spots);
            of_some += square(some, &spots);
            for c in 0..4 {
                assert!((0.0..=1.0).contains(&some[c]) && some[c] <= some[3], "{some:?}");
                most = most.max((all[c] - some[c]).abs());
            }
        }
        let [between, of_all, of_some] = [between, of_all, of_some].map(|sum| (sum / (4 * n_seen) as f64).sqrt());
        let message = format!("{projection:?} {pixels_per_read}: {between}, {most}; {of_all}, {of_some}");
        assert!(between > 0.0 && between < most_rms && f64::from(most) < most_error, "{message}");
        assert!(of_some < of_all && of_all < 0.04, "{message}");
        for level in Level::all() {
            assert!(draw(level, Reads::OneOf(pixels_per_read)) == some, "{level:?}");
        }
    }

    #[test]
    fn pixels_between_reads_are_nearly_as_if_read() {
        // Of odd sizes: the last columns and rows are fewer than others.
        for pixels_per_read in STEPS {
            let orthographic = Projection::Orthographic { parallel_scale: 30.0 };
            check(orthographic, DVec3::new(50.0, 30.0, 82.0), pixels_per_read, [301, 203]);
            let perspective = Projection::Perspective { view_angle_rad: 0.6 };
            check(perspective, DVec3::new(90.0, 12.0, 10.0), pixels_per_read, [203, 150]);
            // Towards a corner of the cube of directions: three families.
            check(perspective, DVec3::new(90.0, 91.0, 92.0), pixels_per_read, [203, 150]);
            // A picture of one pixel.
            assert_eq!(n_reads(pixels_per_read, 1), 4);
        }
    }

    #[test]
    fn pixels_are_read_one_by_one_where_texels_are_small() {
        for (texels_per_pixel, n) in
            [(1.0, 1), (0.32, 1), (0.3, 2), (0.21, 2), (0.2, 3), (0.15, 4), (0.11, 4), (0.1, 6), (0.07, 8), (1e-9, 8)]
        {
            assert_eq!(few_reads(texels_per_pixel), if n == 1 { Reads::Grid(1) } else { Reads::OneOf(n) });
        }
        assert_eq!(few_reads(f64::NAN), Reads::Grid(1));
        // No base plane: nothing is read.
        assert_eq!(few_reads(0.0), Reads::OneOf(8));
    }
}
