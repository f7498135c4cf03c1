//! The part of a volume that a look shows, by some of its samples.

use glam::DVec3;
use wavesplat_core::TransferFunction;

use crate::fit::box_corners;

/// Share of the picture's height, or width, that the object fills.
pub const FILLED: f64 = 0.92;
/// Least opacity of a visible sample, as a share of the largest one, and least opacity of a visible voxel.
const MIN_SHARE: f64 = 0.02;
const MIN_OPACITY: f64 = 2e-4;
/// Percentiles of positions beyond which samples do not count: specks of noise far from the object.
const WITHIN: [f64; 2] = [0.05, 99.95];
/// Least difference of a channel of the colour of a visible sample, in opaque projections, to the smallest value's.
const MIN_CONTRAST: f64 = 0.1;

/// Some samples of a box of a volume, row by row, x fastest.
#[derive(Clone, Copy, Debug)]
pub struct SomeSamples<'a> {
    /// Where they are, index positions.
    pub index: &'a [DVec3],
    /// Their values, finite.
    pub values: &'a [f64],
    /// Distance of the samples, in samples of the volume.
    pub step: f64,
    /// The lower and the upper corner of the box, index positions.
    pub within: [DVec3; 2],
}

impl SomeSamples<'_> {
    /// Index positions around what a look shows, or around all samples without one. `is_opaque`: of a look without
    /// differences of opacity, colours decide, as in projections of one value for each ray.
    ///
    /// Where nothing is visible, all samples count, or the whole box if it `is_whole`: not cut by planes, and without
    /// samples that are not finite.
    pub fn shown(&self, look: Option<(&TransferFunction, bool)>, is_whole: bool) -> Vec<DVec3> {
        let mut seen: Vec<DVec3> = match look {
            Some((function, is_opaque)) => {
                let is_seen = visible(function, self.values, is_opaque);
                self.index.iter().zip(is_seen).filter(|(_, is_seen)| *is_seen).map(|(&at, _)| at).collect()
            }
            None => self.index.to_vec(),
        };
        if seen.is_empty() {
            if is_whole || self.values.is_empty() {
                return box_corners_x_first(self.within);
            }
            seen = self.index.to_vec();
        }
        let ends = WITHIN.map(|percent| DVec3::from(std::array::from_fn(|axis| percentile(&seen, axis, percent))));
        let kept: Vec<DVec3> =
            seen.iter().copied().filter(|at| at.cmpge(ends[0]).all() && at.cmple(ends[1]).all()).collect();
        let outermost = ends_of_rows(if kept.is_empty() { &seen } else { &kept });
        // All corners of the cells around them: two would be a diagonal, and which one depends on how axes are stored.
        let half = DVec3::splat(0.5 * self.step);
        let [low, high] = self.within;
        let corner = |k: usize| {
            move |at: &DVec3| {
                let (lower, upper) = ((*at - half).max(low).min(high), (*at + half).max(low).min(high));
                DVec3::from(std::array::from_fn(|axis| if k >> axis & 1 == 1 { upper[axis] } else { lower[axis] }))
            }
        };
        (0..8).flat_map(|k| outermost.iter().map(corner(k))).collect()
    }
}

/// Whether a look shows values, at least one: by their opacity or, in opaque projections, by whether their colour
/// differs from the smallest value's.
fn visible(function: &TransferFunction, values: &[f64], is_opaque: bool) -> Vec<bool> {
    let opacities: Vec<f64> = values.iter().map(|&value| function.opacity(value)).collect();
    let most = opacities.iter().copied().fold(0.0, f64::max);
    let least = opacities.iter().copied().fold(f64::INFINITY, f64::min);
    if !is_opaque || most > least {
        let least = (MIN_SHARE * most).max(MIN_OPACITY);
        return opacities.iter().map(|&opacity| opacity >= least).collect();
    }
    let darkest = function.color(values.iter().copied().fold(f64::INFINITY, f64::min));
    let differs = |&value: &f64| function.color(value).iter().zip(darkest).any(|(a, b)| (a - b).abs() > MIN_CONTRAST);
    values.iter().map(differs).collect()
}

/// A percentile of positions along an axis, linear between two of them.
fn percentile(positions: &[DVec3], axis: usize, percent: f64) -> f64 {
    let mut numbers: Vec<f64> = positions.iter().map(|at| at[axis]).collect();
    let place = (numbers.len() - 1) as f64 * (percent / 100.0);
    let t = place - place.floor();
    let (_, &mut below, above) = numbers.select_nth_unstable_by(place as usize, f64::total_cmp);
    let above = above.iter().copied().min_by(f64::total_cmp).unwrap_or(below);
    if t < 0.5 { below + (above - below) * t } else { above - (above - below) * (1.0 - t) }
}

/// The first and last sample of each row along x, of samples in order: none between them is further out.
fn ends_of_rows(positions: &[DVec3]) -> Vec<DVec3> {
    let mut ends = Vec::new();
    for row in positions.chunk_by(|a, b| a.y == b.y && a.z == b.z) {
        ends.extend(row.first());
        if let [_, .., last] = row {
            ends.push(*last);
        }
    }
    ends
}

/// Corners of a box, x fastest.
fn box_corners_x_first([low, high]: [DVec3; 2]) -> Vec<DVec3> {
    let turned = |v: DVec3| DVec3::new(v.z, v.y, v.x);
    box_corners([turned(low), turned(high)]).map(turned).to_vec()
}

#[cfg(test)]
mod tests {
    use wavesplat_core::{ColorNode, OpacityNode};

    use super::*;

    fn look(opacity: &[(f64, f64)]) -> TransferFunction {
        let opacity = opacity.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
        let color = [0.0, 1.0].map(|value| ColorNode { value, rgb: [value; 3] });
        TransferFunction::new(opacity, color.to_vec(), None).unwrap()
    }

    /// Box around positions.
    fn bounds(positions: &[DVec3]) -> [DVec3; 2] {
        positions.iter().fold([positions[0]; 2], |[low, high], &at| [low.min(at), high.max(at)])
    }

    #[test]
    fn cells_around_what_is_opaque_are_shown() {
        let n = 12;
        let place = |k: usize| DVec3::new((k % n) as f64, (k / n % n) as f64, (k / (n * n)) as f64);
        let index: Vec<DVec3> = (0..n * n * n).map(place).collect();
        let within = [DVec3::ZERO, DVec3::splat(11.0)];
        let block = [DVec3::new(3.0, 4.0, 0.0), DVec3::new(8.0, 6.0, 11.0)];
        let is_inside = |at: &DVec3| at.cmpge(block[0]).all() && at.cmple(block[1]).all();
        let values: Vec<f64> = index.iter().map(|at| if is_inside(at) { 1.0 } else { 0.0 }).collect();
        let some = SomeSamples { index: &index, values: &values, step: 1.0, within };
        let expected = [DVec3::new(2.5, 3.5, 0.0), DVec3::new(8.5, 6.5, 11.0)];
        let clear = look(&[(0.0, 0.0), (1.0, 0.7)]);
        assert_eq!(bounds(&some.shown(Some((&clear, false)), true)), expected);
        // Of an opaque projection what differs from the darkest value.
        assert_eq!(bounds(&some.shown(Some((&look(&[(0.0, 1.0)]), true)), true)), expected);
        assert_eq!(bounds(&some.shown(Some((&look(&[(0.0, 1.0)]), false)), true)), within);
        let nothing = look(&[(0.0, 0.0)]);
        assert_eq!(some.shown(Some((&nothing, false)), true), box_corners_x_first(within));
        assert_eq!(bounds(&some.shown(Some((&nothing, false)), false)), within);
        assert_eq!(bounds(&some.shown(None, false)), within);
    }

    #[test]
    fn percentiles_are_linear_between_numbers() {
        let positions = [3.0, 0.0, 1.0, 2.0, 9.0].map(DVec3::splat);
        for (percent, expected) in [(0.0, 0.0), (100.0, 9.0), (50.0, 2.0), (62.5, 2.5), (90.0, 6.6)] {
            assert!((percentile(&positions, 0, percent) - expected).abs() < 1e-12);
        }
    }
}
