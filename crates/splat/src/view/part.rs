//! Part of a frame that one process draws: an index-aligned box, for processes that hold a part of the samples each.
//!
//! The parts of a frame tile its space. A position on a face that two parts share belongs to the part above it, and
//! both parts compute where a ray meets that face with the same operations, so that no part of a ray is drawn twice or
//! left out. Faces on the frame's border are infinitely far out: rays that are drawn beside the volume
//! ([`crate::view::silhouette`]) belong to a part, too.

use glam::DVec3;
use wavesplat_compute::simd::LANES;

use crate::view::base_plane::BasePlane;

/// An index-aligned box from `lo` on to before `hi`; infinite where it has no face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Lower corner.
    pub lo: DVec3,
    /// Upper corner.
    pub hi: DVec3,
}

impl Part {
    /// Narrows intervals of w of the rays of `LANES` texels from `(i, j)` on to the part.
    #[inline(always)]
    pub fn narrow(&self, plane: &BasePlane, i: f64, j: f64, [lo, hi]: &mut [[f64; LANES]; 2]) {
        let (from, to) = (plane.family.uvw(self.lo), plane.family.uvw(self.hi));
        // Position and slope of the rays are affine along a row of texels.
        let (ray, next) = (plane.ray(i, j), plane.ray(i + 1.0, j));
        for k in 0..LANES {
            (lo[k], hi[k]) = (lo[k].max(from[2]), hi[k].min(to[2]));
            for axis in 0..2 {
                let along = |first: f64, next: f64| first + (next - first) * k as f64;
                let at_zero = along(ray.at_zero[axis], next.at_zero[axis]);
                let slope = along(ray.slope[axis], next.slope[axis]);
                let [near, far] = passage([from[axis], to[axis]], at_zero, slope);
                (lo[k], hi[k]) = (lo[k].max(near), hi[k].min(far));
            }
        }
    }
}

/// The `t` with `from ≤ at_zero + slope · t < to`.
#[inline(always)]
fn passage([from, to]: [f64; 2], at_zero: f64, slope: f64) -> [f64; 2] {
    // Below this slope the faces are parallel to the ray.
    const PARALLEL: f64 = 1e-12;
    if slope.abs() <= PARALLEL {
        let is_inside = from <= at_zero && at_zero < to;
        return if is_inside { [f64::NEG_INFINITY, f64::INFINITY] } else { [f64::INFINITY, f64::NEG_INFINITY] };
    }
    let ends = [from, to].map(|face| (face - at_zero) / slope);
    if slope > 0.0 { ends } else { [ends[1], ends[0]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_parts_share_a_ray_without_gap_or_overlap() {
        for (at_zero, slope) in [(0.3, 0.7), (-2.0, 1e-9), (9.0, -0.1), (4.0, -3.0)] {
            let [a, cut] = passage([f64::NEG_INFINITY, 4.0], at_zero, slope);
            let [also_cut, b] = passage([4.0, f64::INFINITY], at_zero, slope);
            let (first, second) = if slope > 0.0 { (cut, also_cut) } else { (b, a) };
            assert_eq!(first, second, "{at_zero} {slope}");
        }
    }

    #[test]
    fn a_ray_along_a_shared_face_belongs_to_the_part_above_it() {
        let is_drawn = |[a, b]: [f64; 2]| a < b;
        for at in [3.999, 4.0, 4.001] {
            assert_eq!(is_drawn(passage([4.0, 8.0], at, 0.0)), at >= 4.0, "{at}");
            assert_eq!(is_drawn(passage([0.0, 4.0], at, 0.0)), at < 4.0, "{at}");
        }
    }
}
