//! Pixels as the mean of what is in their middle, three fifths, and at their corners, a tenth each.
//!
//! After quincunx antialiasing (NVIDIA, *HRAA: High-Resolution Antialiasing through Multisampling*, 2001), which has one
//! half and an eighth each: with three fifths smooth pictures are less blurred, and hard edges alias hardly more. A
//! corner serves four pixels, so a pixel takes two reads, of which that of the corner is linear between texels, being
//! blurred anyway. As long as texels are not much closer than pixels, this leaves hardly more error than the mean of
//! 2 x 2 reads (`render.rs` has a test of hard edges).

use wavesplat_compute::simd::{LANES, Lanes, Simd};

use crate::resample::{QUAD, Quads};
use crate::warp::{Rectangle, put};

/// Vectors of pixels of a row that are drawn together at most: few, since what one row has read is to be near when the
/// next one wants it, and not very few, since corners are one more.
const CHUNKS: usize = 4;

/// As many columns.
pub const N_COLUMNS: usize = CHUNKS * LANES;

/// Shares of the middle and of a corner.
const MIDDLE: f32 = 0.6;
const CORNER: f32 = 0.1;

/// A row of corners, shared by the pixels above and below.
struct Corners {
    /// The sum of each pixel's two.
    pairs: [[Lanes; LANES / QUAD]; CHUNKS],
    /// Whether anything is seen at some of sixteen corners; the last corner of sixteen pixels is the first of the next.
    is_seen: [bool; CHUNKS + 1],
}

impl Corners {
    const NONE: Self = Self { pairs: [[Lanes::splat(0.0); LANES / QUAD]; CHUNKS], is_seen: [false; CHUNKS + 1] };

    /// Whether anything is seen at corners of sixteen pixels.
    fn is_seen_by(&self, chunk: usize) -> bool {
        self.is_seen[chunk] || self.is_seen[chunk + 1]
    }
}

/// Draws pixels, at most [`N_COLUMNS`] of a row. `middle` and `corner` read at a position of the picture and at so many
/// in all along x, sixteen at most. `None`: nothing can be seen there.
#[inline(always)]
pub fn draw<S: Simd>(
    s: S,
    rectangle: Rectangle<'_>,
    middle: impl Fn([f64; 2], usize) -> Option<Quads<S>>,
    corner: impl Fn([f64; 2], usize) -> Option<Quads<S>>,
) {
    let Rectangle { columns, first_row, pixels, width_px } = rectangle;
    let n = columns.len();
    let mut rows = [Corners::NONE, Corners::NONE];
    let mut corners = [[0.0; 4]; (CHUNKS + 1) * LANES];
    for y in 0..=pixels.len() / width_px {
        let row = &mut rows[y % 2];
        for chunk in 0..=n / LANES {
            let first = chunk * LANES;
            let at = [(columns.start + first) as f64, (first_row + y) as f64];
            let quads = corner(at, LANES.min(n + 1 - first));
            row.is_seen[chunk] = quads.is_some();
            let quads = quads.unwrap_or([s.splat(0.0); LANES / QUAD]);
            put(s, &quads, &mut corners[first..first + LANES]);
        }
        for chunk in 0..n.div_ceil(LANES) {
            for q in 0..LANES / QUAD {
                let first = chunk * LANES + q * QUAD;
                let [left, right] = [first, first + 1].map(|k| corners[k..].as_flattened().first_chunk());
                let [left, right] = [left, right].map(|corners| corners.unwrap_or(&[0.0; LANES]));
                let pair = s.add(s.load(left), s.load(right));
                s.store(pair, &mut row.pairs[chunk][q].0);
            }
        }
        if y == 0 {
            continue;
        }
        let y = y - 1;
        let pixels = &mut pixels[y * width_px..][columns.clone()];
        for chunk in 0..n.div_ceil(LANES) {
            let first = chunk * LANES;
            let last = n.min(first + LANES);
            let at = [(columns.start + first) as f64 + 0.5, (first_row + y) as f64 + 0.5];
            let middle = middle(at, last - first);
            // The picture is only written to where something is seen.
            if middle.is_none() && !rows[0].is_seen_by(chunk) && !rows[1].is_seen_by(chunk) {
                continue;
            }
            let mut quads = middle.unwrap_or([s.splat(0.0); LANES / QUAD]);
            for q in 0..LANES / QUAD {
                let [above, below] =
                    [s.load(&rows[y % 2].pairs[chunk][q].0), s.load(&rows[(y + 1) % 2].pairs[chunk][q].0)];
                let corners = s.mul(s.splat(CORNER), s.add(above, below));
                quads[q] = s.add_mul(corners, s.splat(MIDDLE), quads[q]);
            }
            put(s, &quads, &mut pixels[first..last]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec2, DVec3};
    use wavesplat_compute::simd::Level;
    use wavesplat_core::{Camera, Projection};

    use super::*;
    use crate::base_picture::BasePicture;
    use crate::base_plane::base_planes;
    use crate::family::{Family, IndexRays};
    use crate::reads::Reads;
    use crate::resample::Resampler;
    use crate::warp::colors;

    /// Of odd sizes: the last columns and rows are fewer than others.
    const SIZE_PX: [usize; 2] = [151, 103];

    /// Islands of random colours in nothing.
    fn draw_islands(picture: &mut BasePicture) {
        let random = |i: usize| ((i as f64 * 12.9898).sin() * 43758.5453).rem_euclid(1.0) as f32;
        let [n_u, n_v] = picture.plane.size;
        for j in 0..n_v {
            for i in (0..n_u).step_by(LANES) {
                if (i / 48 + j / 24) % 3 == 0 {
                    let color =
                        |k: usize| [0, 1, 2, 3].map(|c| random(1000 * j + 10 * (i + k) + c) * [0.5, 1.0][c / 3]);
                    picture.put(i, j, &std::array::from_fn(|k| color(k).map(|c| c * color(k)[3])), None);
                }
            }
        }
    }

    /// The base plane of a position's ray, linear between texels.
    fn linear(pictures: &[BasePicture], texels: &[Vec<[f32; 4]>], rays: &IndexRays, [x, y]: [f64; 2]) -> [f64; 4] {
        let family = Family::of(rays.direction(x, y));
        let Some(k) = pictures.iter().position(|picture| picture.plane.family == family) else { return [0.0; 4] };
        let [n_u, n_v] = pictures[k].plane.size;
        let at = pictures[k].plane.texel_from_pixel(rays, x, y);
        let (first, share) = (at.floor(), at - at.floor());
        let mut sum = [0.0; 4];
        for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (i, j) = (first.x as i64 + di, first.y as i64 + dj);
            if (0..n_u as i64).contains(&i) && (0..n_v as i64).contains(&j) {
                let weight = DVec2::ONE - share - (1.0 - 2.0 * share) * DVec2::new(di as f64, dj as f64);
                let texel = texels[k][j as usize * n_u + i as usize];
                for c in 0..4 {
                    sum[c] += weight.x * weight.y * f64::from(texel[c]);
                }
            }
        }
        sum
    }

    fn check(projection: Projection, position: DVec3) {
        let camera = Camera::new(position, DVec3::splat(20.0), DVec3::new(0.2, 1.0, 0.1), projection).unwrap();
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, SIZE_PX[0], SIZE_PX[1]);
        let shown = [DVec3::splat(0.0), DVec3::splat(40.0)];
        let planes = base_planes(&camera, &rays, SIZE_PX, 1.2, shown).unwrap();
        let mut pictures: Vec<_> = planes.into_iter().map(|plane| BasePicture::new(plane, false)).collect();
        pictures.iter_mut().for_each(draw_islands);
        let texels: Vec<_> = pictures.iter().map(BasePicture::texels).collect();
        let resamplers: Vec<_> = pictures.iter().map(Resampler::new).collect();
        let draw = |level, reads| colors(level, &resamplers, &rays, SIZE_PX, reads, 1.0, None);
        let middles = draw(Level::best(), Reads::Grid(1));
        let got = draw(Level::best(), Reads::Quincunx);
        let mut n_seen = 0;
        for (k, (got, middle)) in got.iter().zip(&middles).enumerate() {
            let [x, y] = [k % SIZE_PX[0], k / SIZE_PX[0]].map(|px| px as f64);
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
                .map(|[dx, dy]| linear(&pictures, &texels, &rays, [x + dx, y + dy]));
            for c in 0..4 {
                let want = 0.6 * f64::from(middle[c]) + 0.1 * corners.iter().map(|corner| corner[c]).sum::<f64>();
                let got = f64::from(got[c]);
                assert!((got - want).abs() < 1e-5, "{projection:?} {x} {y}: {got} for {want}");
            }
            n_seen += usize::from(got[3] > 0.0);
        }
        assert!((got.len() / 10..got.len() / 2).contains(&n_seen), "{n_seen} of {}", got.len());
        for level in Level::all() {
            assert!(draw(level, Reads::Quincunx) == got, "{level:?}");
        }
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_middle_and_its_corners() {
        check(Projection::Orthographic { parallel_scale: 30.0 }, DVec3::new(50.0, 30.0, 82.0));
        let perspective = Projection::Perspective { view_angle_rad: 0.6 };
        check(perspective, DVec3::new(90.0, 12.0, 10.0));
        // Towards a corner of the cube of directions: three families.
        check(perspective, DVec3::new(90.0, 91.0, 92.0));
    }
}
