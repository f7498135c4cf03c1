//! Missing samples: NaN and infinity are filled from their neighbours, and their share of every point is left out.
//!
//! The *missing share* m of a point is the weight that the linear kernel gives to missing samples there, whatever the
//! kernel of the densities. Matter is drawn with its extinction times the *known share* 1 − m, so that a lone missing
//! sample takes away one cell of matter: the linear kernel integrates to 1. A point that is at least a sample away from
//! every known sample has m = 1 and is empty. The share is continuous, and linear between sheets, so any number of
//! sheets, and any step of a ray caster, gives the same hole. The densities' own kernel would not do: reaches differ
//! from kernel to kernel, and weights of either sign, or the tails of a prefilter, mean nothing as shares. Operators
//! that need a yes or no (projections, first hits, slices) take a point for missing where m is at least [`MISSING`].
//!
//! The densities of such points come from the fill: each missing sample takes the nearest known density along one of
//! the axes. So densities beside a hole continue evenly into it, and wide kernels, gradients and the prefilter of
//! B-splines see no edge there, which would ring. The fill is a function of a bounded neighbourhood ([`REACH`]), which
//! extends further than any kernel and gradient, and a box of a volume gives the bits of the whole.

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Wide;

/// Missing share from which a point counts as missing.
pub const MISSING: f32 = 0.5;

/// Least known share; smaller ones count as 0. A rounding error of 1 − m times the extinction of opacity 1 would be
/// opaque.
pub const MIN_KNOWN: f32 = 1e-3;

/// Known share: 1 − m, or 0 below [`MIN_KNOWN`].
#[inline(always)]
pub fn known_share<W: Wide>(w: W, missing: W::F) -> W::F {
    let known = w.sub(w.splat(1.0), missing);
    w.select(w.lt(known, w.splat(MIN_KNOWN)), w.splat(0.0), known)
}

/// Known share at a place between two sheets, from the missing shares on both; 1 where no sample is missing.
///
/// `at`: the place, from 0 on the front sheet to 1 on the back sheet. The share is linear between sheets, so its mean
/// over a part of the way is its value in the middle of the part.
#[inline(always)]
pub fn known_between<W: Wide>(w: W, missing: Option<[W::F; 2]>, at: W::F) -> W::F {
    match missing {
        Some([front, back]) => known_share(w, w.add_mul(front, at, w.sub(back, front))),
        None => w.splat(1.0),
    }
}

/// Part of the way between two sheets on which points are known, from the missing shares on both: its start and end,
/// from 0 in front to 1 behind. The share is linear in between; the start is not below the end where no point is known.
#[inline(always)]
pub fn known_part(front: f32, back: f32) -> [f32; 2] {
    let crossing = (MISSING - front) / (back - front);
    match (front < MISSING, back < MISSING) {
        (true, true) => [0.0, 1.0],
        (true, false) => [0.0, crossing],
        (false, true) => [crossing, 1.0],
        (false, false) => [1.0, 0.0],
    }
}

/// Largest distance along an axis, in samples, from which a missing sample is filled.
const STEP: usize = 8;

/// Distance along each axis, in samples, that the fill of a sample depends on: its source may have been filled itself.
pub const REACH: usize = 2 * STEP;

/// Origin of a sample's density: 0 if it is known, else one more than the distance to the sample it was taken from.
type Origin = u8;

const KNOWN: Origin = 0;
const UNFILLED: Origin = u8::MAX;

/// Replaces samples that are not finite by the nearest finite density along x, y or z within `STEP`; of equally near
/// ones, x goes before y and y before z. If there is none within `STEP`: by the nearest density that was filled in this
/// way in the column, then in the line through the slices; else by `otherwise`.
pub fn fill_holes(grid: &mut [f32], [nx, ny, nz]: [usize; 3], otherwise: f32) {
    let mut origins: Vec<Origin> =
        grid.iter().map(|density| if density.is_finite() { KNOWN } else { UNFILLED }).collect();
    let is_known = |origin| origin == KNOWN;
    let is_filled = |origin| origin < UNFILLED;
    let in_slices = |grid: &mut [f32], origins: &mut [Origin], work: &(dyn Fn(&mut [f32], &mut [Origin]) + Sync)| {
        let mut slices: Vec<_> = grid.chunks_mut(nx * ny).zip(origins.chunks_mut(nx * ny)).collect();
        parallel::for_each_chunk(&mut slices, 1, |_, slices| slices.iter_mut().for_each(|(g, o)| work(g, o)));
    };
    in_slices(grid, &mut origins, &|grid, origins| {
        (0..ny).for_each(|y| fill_line(grid, origins, (y * nx, 1, nx), is_known));
        (0..nx).for_each(|x| fill_line(grid, origins, (x, nx, ny), is_known));
    });
    (0..nx * ny).for_each(|i| fill_line(grid, &mut origins, (i, nx * ny, nz), is_known));
    in_slices(grid, &mut origins, &|grid, origins| {
        (0..nx).for_each(|x| fill_line(grid, origins, (x, nx, ny), is_filled));
    });
    (0..nx * ny).for_each(|i| fill_line(grid, &mut origins, (i, nx * ny, nz), is_filled));
    for (density, origin) in grid.iter_mut().zip(origins) {
        *density = if origin == UNFILLED { otherwise } else { *density };
    }
}

/// Fills samples of a line from their nearest source, unless they are sources or have a nearer origin. The line: its
/// first sample, the distance between samples, and how many there are.
fn fill_line(
    grid: &mut [f32],
    origins: &mut [Origin],
    (start, stride, n): (usize, usize, usize),
    is_source: impl Fn(Origin) -> bool,
) {
    let place = |k: usize| start + k * stride;
    let mut before: Option<usize> = None;
    let mut i = 0;
    while i < n {
        if is_source(origins[place(i)]) {
            before = Some(i);
            i += 1;
            continue;
        }
        let after = (i..n).find(|&k| is_source(origins[place(k)]));
        let end = after.unwrap_or(n);
        for k in i..end {
            let source = match (before, after) {
                (Some(b), Some(a)) => Some(if k - b <= a - k { b } else { a }),
                (b, a) => b.or(a),
            };
            let Some(source) = source.filter(|source| source.abs_diff(k) <= STEP) else { continue };
            let origin = 1 + source.abs_diff(k) as Origin;
            if origin < origins[place(k)] {
                (grid[place(k)], origins[place(k)]) = (grid[place(source)], origin);
            }
        }
        i = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_parts_end_where_half_is_missing() {
        assert_eq!(known_part(0.0, 0.25), [0.0, 1.0]);
        assert_eq!(known_part(0.0, 1.0), [0.0, 0.5]);
        assert_eq!(known_part(1.0, 0.25), [2.0 / 3.0, 1.0]);
        let [from, to] = known_part(0.5, 1.0);
        assert!(from >= to, "{from} {to}");
    }

    #[test]
    fn holes_take_their_nearest_neighbour() {
        let nan = f32::NAN;
        let mut grid = vec![1.0, nan, nan, 4.0, nan, nan, nan, nan, 5.0, 6.0, 7.0, f32::INFINITY];
        fill_holes(&mut grid, [4, 1, 3], 9.0);
        assert_eq!(grid, [1.0, 1.0, 4.0, 4.0, 1.0, 6.0, 7.0, 4.0, 5.0, 6.0, 7.0, 7.0]);
    }

    #[test]
    fn far_from_everything_there_is_no_neighbour() {
        let mut line = vec![f32::NAN; 60];
        line[0] = 2.0;
        fill_holes(&mut line, [60, 1, 1], 0.5);
        assert!(line[..=STEP].iter().all(|d| *d == 2.0) && line[STEP + 1..].iter().all(|d| *d == 0.5));
    }

    #[test]
    fn a_box_with_its_margin_is_filled_as_the_whole() {
        let size = [40, 38, 36];
        let mut whole: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
        for (i, density) in whole.iter_mut().enumerate() {
            // A plane of holes wider than a step, and many lone ones.
            if (i / 40) % 38 > 9 && (i / 40) % 38 < 30 || i % 3 == 0 {
                *density = f32::NAN;
            }
        }
        let samples = whole.clone();
        fill_holes(&mut whole, size, -1.0);
        let at = |[x, y, z]: [usize; 3]| x + size[0] * (y + size[1] * z);
        let wanted = [18..21, 17..20, 16..19];
        let held = [0, 1, 2].map(|a| wanted[a].start - REACH..(wanted[a].end + REACH).min(size[a]));
        let mut part = Vec::new();
        for z in held[2].clone() {
            for y in held[1].clone() {
                part.extend(held[0].clone().map(|x| samples[at([x, y, z])]));
            }
        }
        fill_holes(&mut part, [0, 1, 2].map(|a| held[a].len()), -1.0);
        for z in wanted[2].clone() {
            for y in wanted[1].clone() {
                for x in wanted[0].clone() {
                    let [i, j, k] = [x - held[0].start, y - held[1].start, z - held[2].start];
                    let got = part[i + held[0].len() * (j + held[1].len() * k)];
                    assert_eq!(got, whole[at([x, y, z])], "{x} {y} {z}");
                }
            }
        }
    }
}
