//! Paths: poses between key frames.
//!
//! The direction turns smoothly through every key. Focal point, distance and scale follow monotone cubics (Fritsch and
//! Carlson 1980), the last two as logarithms: they never overshoot a key, and rest where two keys agree.
//!
//! Between two keys the direction is a cubic curve with given angular velocities at both ends, after Kim, Kim and Shin,
//! "A general construction scheme for unit quaternion curves with simple high order derivatives" (SIGGRAPH 1995): the
//! cumulative form of a cubic Bezier curve, `q0 exp(w1 b1) exp(w2 b2) exp(w3 b3)`. Segments that share a key share its
//! velocity, so the turn is smooth.

use glam::{DMat3, DQuat, DVec3};
use wavesplat_core::{Error, Result};

use crate::lens::Lens;
use crate::pose::Pose;
use crate::rotation::Axes;

/// Cosine of half the angle between keys, below which two keys count as opposite: rounding would choose the way round.
const OPPOSITE: f64 = 1e-9;
/// Focal point, and the logarithms of distance and scale.
const N_NUMBERS: usize = 5;

/// A pose for every time between the first and the last of some key frames; closed if these two are equal.
#[derive(Clone, Debug)]
pub struct CameraPath {
    keys: Vec<Pose>,
    times: Vec<f64>,
    frames: Vec<DQuat>,
    /// Rotation from each key to the next, and angular velocities at the keys: axis times radians, in the moving frame.
    turns: Vec<DVec3>,
    velocities: Vec<[f64; 3]>,
    numbers: Vec<[f64; N_NUMBERS]>,
    slopes: Vec<[f64; N_NUMBERS]>,
}

impl CameraPath {
    /// The path through key frames, at least one, each at its time.
    ///
    /// # Errors
    ///
    /// [`Error::MixedLenses`] if some keys are orthographic and some in perspective, and [`Error::OutOfRange`] if there
    /// is not a time for each key, in order.
    pub fn new(keys: &[Pose], times: &[f64]) -> Result<Self> {
        check(keys)?;
        let are_in_order = times.iter().all(|time| time.is_finite()) && times.windows(2).all(|pair| pair[0] < pair[1]);
        if times.len() != keys.len() || !are_in_order {
            let times = format!("{times:?}");
            return Err(Error::out_of_range("times of key frames", times, "one for each, in order", "pass such times"));
        }
        let frames: Vec<DQuat> = keys.iter().map(|key| frame(&key.axes())).collect();
        let turns: Vec<DVec3> = frames.windows(2).map(|pair| rotation_vector(pair[0], pair[1])).collect();
        let numbers: Vec<[f64; N_NUMBERS]> = keys.iter().map(numbers).collect();
        let widths: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let is_closed = keys.first() == keys.last();
        let speeds: Vec<[f64; 3]> =
            turns.iter().zip(&widths).map(|(&turn, &width)| (turn / width).to_array()).collect();
        let rates: Vec<[f64; N_NUMBERS]> = numbers
            .windows(2)
            .zip(&widths)
            .map(|(pair, width)| std::array::from_fn(|n| (pair[1][n] - pair[0][n]) / width))
            .collect();
        Ok(Self {
            keys: keys.to_vec(),
            times: times.to_vec(),
            velocities: at_keys(&widths, &speeds, is_closed, mean_slope),
            slopes: at_keys(&widths, &rates, is_closed, monotone_slope),
            frames,
            turns,
            numbers,
        })
    }

    /// Poses at `n` times at equal distances, through keys at equal distances in time: the first is the first key, and
    /// the last the last one, or if the path `is_closed` the one before the first key, so that it repeats.
    ///
    /// # Errors
    ///
    /// As of [`CameraPath::new`].
    pub fn evenly(keys: &[Pose], n: usize, is_closed: bool) -> Result<Vec<Pose>> {
        let mut keys = keys.to_vec();
        if is_closed && keys.len() > 1 {
            keys.push(keys[0]);
        }
        let times: Vec<f64> = (0..keys.len()).map(|k| k as f64).collect();
        let path = Self::new(&keys, &times)?;
        let last = times.len() - 1;
        let steps = if is_closed { n } else { n.saturating_sub(1) }.max(1);
        // Multiplied before it is divided, so that the times of keys are exact.
        Ok((0..n).map(|k| path.at((last * k) as f64 / steps as f64)).collect())
    }

    /// The pose at a time, clamped to the first and the last key.
    pub fn at(&self, time: f64) -> Pose {
        let k = self.times.partition_point(|&key| key <= time).saturating_sub(1);
        if k + 1 == self.keys.len() || time <= self.times[k] {
            return self.keys[k];
        }
        let width = self.times[k + 1] - self.times[k];
        let t = (time - self.times[k]) / width;
        let [first, last] = [k, k + 1].map(|k| DVec3::from(self.velocities[k]) * width);
        let Axes { up, back, .. } = axes(between(self.frames[k], self.turns[k], [first, last], t));
        let [x, y, z, log_distance, log_scale] = std::array::from_fn(|n| {
            let (start, end) = (self.numbers[k][n], self.numbers[k + 1][n]);
            let [first, last] = [k, k + 1].map(|k| self.slopes[k][n] * width);
            start + (end - start) * t * t * (3.0 - 2.0 * t) + t * (1.0 - t) * ((1.0 - t) * first - t * last)
        });
        let focal_point = DVec3::new(x, y, z);
        Pose {
            position: focal_point + log_distance.exp() * back,
            focal_point,
            view_up: up,
            lens: self.keys[0].lens.with_scale(log_scale.exp()),
        }
    }
}

fn check(keys: &[Pose]) -> Result<()> {
    let Some(first) = keys.first() else {
        return Err(Error::out_of_range("number of key frames", 0, "1 or more", "pass at least one"));
    };
    let kind = |lens| if matches!(lens, Lens::ParallelScale(_)) { "orthographic" } else { "in perspective" };
    match keys.iter().position(|key| kind(key.lens) != kind(first.lens)) {
        Some(number) => Err(Error::MixedLenses { first: kind(first.lens), number, other: kind(keys[number].lens) }),
        None => Ok(()),
    }
}

/// Focal point, and the logarithms of distance and scale.
fn numbers(key: &Pose) -> [f64; N_NUMBERS] {
    let DVec3 { x, y, z } = key.focal_point;
    [x, y, z, key.distance().ln(), key.lens.scale().ln()]
}

/// Slopes at the keys from those of the segments between them. `inner`: of a key, from the widths and the slopes of the
/// segments before and after it; the ends of an open path have the slope of their segment.
fn at_keys<const N: usize>(
    widths: &[f64],
    rates: &[[f64; N]],
    is_closed: bool,
    inner: fn([f64; 2], [f64; 2]) -> f64,
) -> Vec<[f64; N]> {
    let n = widths.len();
    let slope = |k: usize| {
        let is_end = k == 0 || k == n;
        let [before, after] = match (is_end, is_closed) {
            (true, true) => [n - 1, 0],
            (true, false) => return rates[k.min(n - 1)],
            (false, _) => [k - 1, k],
        };
        std::array::from_fn(|c| inner([widths[before], widths[after]], [rates[before][c], rates[after][c]]))
    };
    if n == 0 { Vec::new() } else { (0..=n).map(slope).collect() }
}

/// Slope of the parabola through a key and its neighbours (Catmull-Rom, for any times).
fn mean_slope([before, after]: [f64; 2], rates: [f64; 2]) -> f64 {
    (after * rates[0] + before * rates[1]) / (before + after)
}

/// Slope with which cubics are smooth and do not overshoot: the weighted harmonic mean of the slopes beside a key
/// (Fritsch and Butland 1984), 0 where their signs differ.
fn monotone_slope([before, after]: [f64; 2], rates: [f64; 2]) -> f64 {
    if rates[0] * rates[1] > 0.0 {
        let weights = [before + 2.0 * after, 2.0 * before + after];
        (weights[0] + weights[1]) / (weights[0] / rates[0] + weights[1] / rates[1])
    } else {
        0.0
    }
}

/// The rotation that takes x, y, z to right, up and back.
fn frame(axes: &Axes) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(axes.right, axes.up, axes.back)).normalize()
}

/// The axes to which a rotation takes x, y, z.
fn axes(frame: DQuat) -> Axes {
    let DMat3 { x_axis: right, y_axis: up, z_axis: back } = DMat3::from_quat(frame.normalize());
    Axes { right, up, back }
}

/// Axis times angle, radians, of the shorter rotation from `start` to `end`, in the frame of either.
///
/// Between opposite ones both ways are equally long: the one about an axis that points up in the world is taken
/// (towards +z; of level axes towards +y, or +x), as an azimuth grows.
fn rotation_vector(start: DQuat, end: DQuat) -> DVec3 {
    let step = start.conjugate() * end;
    let axis = step.xyz();
    let length = axis.length();
    if length == 0.0 {
        return DVec3::ZERO;
    }
    let is_backward = if step.w.abs() < OPPOSITE {
        let DVec3 { x, y, z } = start * axis;
        let leading = [z, y, x].into_iter().find(|part| part.abs() > OPPOSITE * length);
        leading.is_some_and(|part| part < 0.0)
    } else {
        step.w < 0.0
    };
    let (sign, w) = if is_backward { (-1.0, -step.w) } else { (1.0, step.w) };
    axis * (sign * 2.0 * length.atan2(w) / length)
}

/// Curve from `start` (t = 0) to `start` turned by `turn` (t = 1), with angular velocities at its ends per unit of t.
///
/// All vectors are in radians in the moving frame, as `rotation_vector` gives them.
fn between(start: DQuat, turn: DVec3, velocities: [DVec3; 2], t: f64) -> DQuat {
    let [first, last] = velocities.map(|velocity| velocity / 3.0);
    let exp = DQuat::from_scaled_axis;
    let middle = rotation_vector(DQuat::IDENTITY, exp(-first) * exp(turn) * exp(-last));
    // Cumulative Bernstein polynomials of degree 3; their sum is 3 t.
    let late = t * t * t;
    let mid = late + 3.0 * t * t * (1.0 - t);
    let early = mid + 3.0 * t * (1.0 - t) * (1.0 - t);
    start * exp(early * first) * exp(mid * middle) * exp(late * last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::orbit_axes;

    /// A pose on an orbit about a point.
    fn key(azimuth: f64, elevation: f64, scale: f64) -> Pose {
        let Axes { up, back, .. } = orbit_axes(azimuth, elevation);
        let focal_point = DVec3::new(scale, -3.0, 7.0);
        let lens = Lens::ParallelScale(scale);
        Pose { position: focal_point + 50.0 * back, focal_point, view_up: up, lens }
    }

    #[test]
    fn paths_go_through_their_keys() {
        let keys = [key(0.0, 0.0, 5.0), key(70.0, 40.0, 5.0), key(150.0, -20.0, 90.0), key(90.0, 0.0, 2.0)];
        let open = CameraPath::evenly(&keys, 22, false).unwrap();
        let closed = CameraPath::evenly(&keys, 28, true).unwrap();
        for (k, key) in keys.iter().enumerate() {
            assert_eq!((open[7 * k], closed[7 * k]), (*key, *key));
        }
        assert_eq!(CameraPath::evenly(&keys[..1], 3, true).unwrap(), [keys[0]; 3]);
        let path = CameraPath::new(&keys, &[1.0, 2.0, 4.0, 4.5]).unwrap();
        assert_eq!([-9.0, 2.0, 4.0, 99.0].map(|time| path.at(time)), [keys[0], keys[1], keys[2], keys[3]]);
    }

    #[test]
    fn quarter_turns_go_on_evenly() {
        let keys = [0.0, 90.0, 180.0, 270.0].map(|azimuth| key(azimuth, 0.0, 5.0));
        for (k, pose) in CameraPath::evenly(&keys, 36, true).unwrap().iter().enumerate() {
            let right = orbit_axes(10.0 * k as f64, 0.0);
            assert!((pose.axes().back - right.back).length() < 1e-12, "{k}");
        }
        let opposite = CameraPath::evenly(&[key(200.0, 0.0, 5.0), key(20.0, 0.0, 5.0)], 3, false).unwrap();
        assert!((opposite[1].axes().back - orbit_axes(290.0, 0.0).back).length() < 1e-9, "as the azimuth grows");
    }

    #[test]
    fn velocities_agree_on_both_sides_of_a_key_and_nothing_overshoots() {
        let keys = [key(0.0, 0.0, 5.0), key(70.0, 40.0, 8.0), key(150.0, -20.0, 20.0), key(90.0, 0.0, 9.0)];
        let path = CameraPath::new(&keys, &[0.0, 1.0, 1.7, 3.0]).unwrap();
        let step = 1e-6;
        for time in [1.0, 1.7] {
            let [before, here, after] = [time - step, time, time + step].map(|time| path.at(time));
            let place = |pose: &Pose| (pose.axes().back, pose.focal_point);
            for (before, here, after) in [
                (place(&before).0, place(&here).0, place(&after).0),
                (place(&before).1, place(&here).1, place(&after).1),
            ] {
                assert!(((after - here) - (here - before)).length() / step < 1e-3);
            }
        }
        for k in 0..300 {
            let Lens::ParallelScale(scale) = path.at(f64::from(k) * 0.01).lens else { panic!() };
            assert!((5.0 - 1e-12..=20.0 + 1e-12).contains(&scale));
        }
    }

    #[test]
    fn keys_of_two_kinds_and_times_without_order_are_refused() {
        let flat = key(0.0, 0.0, 5.0);
        let deep = Pose { lens: Lens::ViewAngleDeg(30.0), ..flat };
        let message = CameraPath::evenly(&[flat, flat, deep], 5, false).unwrap_err().to_string();
        assert!(
            message.starts_with("camera 0 is orthographic and camera 2 in perspective; give key frames of one kind")
        );
        assert!(CameraPath::evenly(&[], 5, false).is_err());
        for times in [&[0.0][..], &[1.0, 1.0], &[0.0, f64::NAN]] {
            assert!(CameraPath::new(&[flat, flat], times).is_err(), "{times:?}");
        }
    }
}
