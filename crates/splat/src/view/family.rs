//! Slice families: viewing rays in index space, and which of the volume's axes serves them.
//!
//! A ray belongs to the axis `w` that it runs most along: across its slices rays are steep, and a sheet parallel to
//! them is seen from the front. Rays from an eye form up to six families.

use glam::{DAffine3, DVec2, DVec3};
use wavesplat_core::Camera;

/// Viewing rays in index space: origin and direction are affine in the pixel position.
#[derive(Clone, Copy, Debug)]
pub struct IndexRays {
    origin: [DVec3; 3],
    /// Direction at the corner of the picture, and its change per pixel along x and along y; not normalised.
    pub(crate) direction: [DVec3; 3],
}

impl IndexRays {
    /// Rays of a camera over a picture of this size.
    pub fn new(camera: &Camera, index_from_world: DAffine3, width_px: usize, height_px: usize) -> Self {
        let corner = |x: f64, y: f64| {
            let ray = camera.ray(x, y, width_px, height_px);
            (index_from_world.transform_point3(ray.origin), index_from_world.transform_vector3(ray.direction))
        };
        let (o, d) = corner(0.0, 0.0);
        let ((ox, dx), (oy, dy)) = (corner(1.0, 0.0), corner(0.0, 1.0));
        Self { origin: [o, ox - o, oy - o], direction: [d, dx - d, dy - d] }
    }

    /// The rays of the part of the picture whose upper left corner is at a pixel position.
    #[must_use]
    pub fn part(self, [x_px, y_px]: [usize; 2]) -> Self {
        let (x_px, y_px) = (x_px as f64, y_px as f64);
        let Self { origin: [_, ox, oy], direction: [_, dx, dy] } = self;
        Self { origin: [self.origin(x_px, y_px), ox, oy], direction: [self.direction(x_px, y_px), dx, dy] }
    }

    /// Every `n`th ray along x and along y, from the first on.
    #[must_use]
    pub fn every(self, n: usize) -> Self {
        let per_pixel = n as f64;
        // The middle of the first pixel stays where it is.
        let corner = 0.5 - 0.5 * per_pixel;
        let Self { origin: [_, ox, oy], direction: [_, dx, dy] } = self;
        Self {
            origin: [self.origin(corner, corner), ox * per_pixel, oy * per_pixel],
            direction: [self.direction(corner, corner), dx * per_pixel, dy * per_pixel],
        }
    }

    /// Distance of neighbouring pixels' rays, in samples, at the place where the ray of a pixel position is nearest to
    /// `point`.
    pub fn distance_at(&self, point: DVec3, [x_px, y_px]: [f64; 2]) -> f64 {
        let (origin, direction) = (self.origin(x_px, y_px), self.direction(x_px, y_px));
        let t = (point - origin).dot(direction) / direction.length_squared();
        let at = |x: f64, y: f64| self.origin(x, y) + self.direction(x, y) * t;
        let [dx, dy] = [at(x_px + 1.0, y_px), at(x_px, y_px + 1.0)].map(|next| (next - at(x_px, y_px)).length());
        (dx * dy).sqrt()
    }

    /// Index-space origin of the ray through a pixel position.
    pub fn origin(&self, x_px: f64, y_px: f64) -> DVec3 {
        self.origin[0] + self.origin[1] * x_px + self.origin[2] * y_px
    }

    /// Index-space direction of the ray through a pixel position, not normalised.
    pub fn direction(&self, x_px: f64, y_px: f64) -> DVec3 {
        self.direction[0] + self.direction[1] * x_px + self.direction[2] * y_px
    }

    /// The family of all rays between the pixel positions `corners`; `None` where there may be several.
    pub fn family_of_all(&self, corners: &[[f64; 2]]) -> Option<Family> {
        let mut directions = corners.iter().map(|[x_px, y_px]| self.direction(*x_px, *y_px));
        let family = Family::of(directions.clone().next()?);
        directions.all(|d| Family::of(d) == family && family.is_convex_at(d)).then_some(family)
    }

    /// The family of a pixel position's ray, and the number of consecutive positions along x, up to `n`, that share it.
    #[inline(always)]
    pub fn families_along_x(&self, [x_px, y_px]: [f64; 2], n: usize) -> (Family, usize) {
        let at = |k: usize| self.direction(x_px + k as f64, y_px);
        let first = at(0);
        let family = Family::of(first);
        let last = at(n - 1);
        if Family::of(last) == family && family.is_convex_at(first) && family.is_convex_at(last) {
            return (family, n);
        }
        (family, 1 + (1..n).take_while(|k| Family::of(at(*k)) == family).count())
    }
}

/// Largest slope of a ray in its family: rays that run along two axes nearly alike take the one whose slices are
/// contiguous.
pub const MAX_SLOPE: f64 = 1.1;

/// A slice family, one of six: the index axis that rays run along, and the direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// Index axes called u, v, w.
    pub axes: [usize; 3],
    /// Whether rays run towards growing w.
    pub ascending: bool,
}

impl Family {
    /// The family of a ray by its index-space direction: the axis that it runs most along, or one that it runs nearly
    /// as much along and whose slices lie better in memory.
    pub fn of(direction: DVec3) -> Self {
        let d = direction.to_array();
        let a = direction.abs();
        let much = a.max_element() / MAX_SLOPE;
        let w = if a.z >= much { 2 } else { usize::from(a.y >= much) };
        let axes = [[1, 2, 0], [0, 2, 1], [0, 1, 2]][w];
        Self { axes, ascending: d[w] > 0.0 }
    }

    /// Whether a ray of the family is in a convex part of it: all rays between two rays of that part are of the family.
    /// Only the family of y is not convex itself, since its bound on |z| is by the larger of |x| and |y|.
    #[inline(always)]
    fn is_convex_at(&self, direction: DVec3) -> bool {
        let a = direction.abs();
        self.axes[2] != 1 || a.z * MAX_SLOPE < a.y
    }

    /// Whether any ray of the family has slopes `(du/dw, dv/dw)` within bounds.
    pub fn has_slopes(&self, lo: DVec2, hi: DVec2) -> bool {
        // Only magnitudes count.
        let most = lo.abs().max(hi.abs());
        let least = DVec2::select(lo.cmple(DVec2::ZERO) & hi.cmpge(DVec2::ZERO), DVec2::ZERO, lo.abs().min(hi.abs()));
        match self.axes[2] {
            2 => least.max_element() <= MAX_SLOPE,
            // Family of y: |z| is less than the largest component / MAX_SLOPE, and that component is x or y.
            1 => least.x <= MAX_SLOPE && least.y < most.x.clamp(1.0, MAX_SLOPE) / MAX_SLOPE,
            _ => least.max_element() < 1.0 / MAX_SLOPE,
        }
    }

    /// Components along u, v, w.
    pub fn uvw(&self, v: DVec3) -> [f64; 3] {
        self.axes.map(|a| v[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(i: usize) -> f64 {
        ((i as f64 * 12.9898).sin() * 43758.5453).rem_euclid(1.0)
    }

    /// Slopes around 1, where the families meet.
    fn slope(i: usize) -> f64 {
        (random(i) * 2.6).copysign(random(i + 1) - 0.5)
    }

    #[test]
    fn slopes_of_a_family_are_those_of_its_rays() {
        const N: usize = 24;
        let (mut n_with, mut n_without, mut n_missed) = (0, 0, 0);
        for run in 0..6000 {
            let lo = DVec2::new(slope(10 * run), slope(10 * run + 2));
            let hi = lo + DVec2::new(random(10 * run + 4), random(10 * run + 5)) * 0.3;
            for axes in [[1, 2, 0], [0, 2, 1], [0, 1, 2]] {
                for ascending in [false, true] {
                    let family = Family { axes, ascending };
                    let has = |share: DVec2| {
                        let slope = lo + (hi - lo) * share;
                        let mut ray = [0.0; 3];
                        for (axis, along) in axes.into_iter().zip([slope.x, slope.y, 1.0]) {
                            ray[axis] = if ascending { along } else { -along };
                        }
                        Family::of(DVec3::from_array(ray)) == family
                    };
                    let found = (0..=N * N).any(|k| has(DVec2::new((k % N) as f64, (k / N) as f64) / N as f64));
                    let told = family.has_slopes(lo, hi);
                    assert!(told || !found, "{family:?} {lo} {hi}");
                    n_with += usize::from(told && found);
                    n_without += usize::from(!told);
                    n_missed += usize::from(told && !found);
                }
            }
        }
        // Some slopes lie between those that were tried.
        assert!(n_with > 1000 && n_without > 1000 && n_missed < n_with / 50, "{n_with}, {n_without}, {n_missed}");
    }

    #[test]
    fn runs_of_a_family_are_told_as_pixel_by_pixel() {
        let (mut n_mixed, mut n_whole, mut n_untold) = (0, 0, 0);
        for run in 0..4000 {
            let vector = |i: usize| DVec3::from_array([0, 1, 2].map(|c| slope(40 * run + 2 * (3 * i + c))));
            // Up to a right angle within a run, from around corners of the cube of directions.
            let [first, per_x, per_y] = [vector(0), vector(1) * 0.1, vector(2) * 0.1];
            let rays = IndexRays { origin: [DVec3::ZERO; 3], direction: [first, per_x, per_y] };
            for n in [1, 2, 8, 16] {
                let families: Vec<_> = (0..n).map(|k| Family::of(rays.direction(k as f64 + 0.5, 0.5))).collect();
                let n_alike = families.iter().take_while(|f| **f == families[0]).count();
                assert_eq!(rays.families_along_x([0.5, 0.5], n), (families[0], n_alike));
                n_mixed += usize::from(n_alike < n);
            }
            let corners = [[0.0, 0.0], [16.0, 0.0], [0.0, 16.0], [16.0, 16.0]];
            let families: Vec<_> =
                (0..17 * 17).map(|k| Family::of(rays.direction(f64::from(k % 17), f64::from(k / 17)))).collect();
            match rays.family_of_all(&corners) {
                Some(family) => {
                    assert!(families.iter().all(|f| *f == family));
                    n_whole += 1;
                }
                // Few runs of one family are not recognised as such.
                None => n_untold += usize::from(families.iter().all(|f| *f == families[0])),
            }
        }
        assert!(n_mixed > 1000, "{n_mixed}");
        assert!(n_whole > 500 && n_untold < n_whole / 10, "{n_whole} {n_untold}");
    }
}
