//! Parallel and perspective rays of a slice family, and their base coordinates `(p, q)`.
//!
//! Parallel rays: `(p, q)` is the index position where the ray crosses the slice `w = 0`; in perspective it is the
//! slopes `(du/dw, dv/dw)`, at most 1.1 in magnitude.

use glam::{DMat3, DVec2, DVec3};

use crate::view::family::{Family, IndexRays};

/// The rays of a family: parallel, or from the eye.
#[derive(Clone, Copy, Debug)]
pub enum RayModel {
    /// All rays have these slopes; `(p, q)` is the position at w = 0.
    Parallel {
        /// Change of u and of v per slice.
        slope: [f64; 2],
    },
    /// All rays pass the eye (u, v, w); `(p, q)` are their slopes.
    Perspective {
        /// Index coordinates along u, v, w.
        eye: [f64; 3],
    },
}

impl RayModel {
    /// The rays of a slice family.
    pub fn new(family: &Family, rays: &IndexRays, is_parallel: bool) -> Self {
        if is_parallel {
            let [du, dv, dw] = family.uvw(rays.direction(0.0, 0.0));
            Self::Parallel { slope: snapped(DVec2::new(du / dw, dv / dw)).to_array() }
        } else {
            Self::Perspective { eye: family.uvw(rays.origin(0.0, 0.0)) }
        }
    }

    /// Base coordinates `(p, q)` of a pixel position.
    pub fn base_from_pixel(&self, family: &Family, rays: &IndexRays, x_px: f64, y_px: f64) -> DVec2 {
        match self {
            Self::Parallel { slope } => {
                let [u, v, w] = family.uvw(rays.origin(x_px, y_px));
                DVec2::new(u - slope[0] * w, v - slope[1] * w)
            }
            Self::Perspective { .. } => {
                let [u, v, w] = family.uvw(rays.direction(x_px, y_px));
                DVec2::new(u / w, v / w)
            }
        }
    }

    /// Change of the base coordinates per pixel, along x and along y.
    pub fn base_per_pixel(&self, family: &Family, rays: &IndexRays, x_px: f64, y_px: f64) -> [DVec2; 2] {
        match self {
            Self::Parallel { .. } => {
                let base = |x: f64, y: f64| self.base_from_pixel(family, rays, x, y);
                [base(x_px + 0.25, y_px) - base(x_px - 0.25, y_px), base(x_px, y_px + 0.25) - base(x_px, y_px - 0.25)]
                    .map(|change| change * 2.0)
            }
            // (u / w)' = (u' − (u / w) w') / w
            Self::Perspective { .. } => {
                let per_w = 1.0 / rays.direction(x_px, y_px)[family.axes[2]];
                let base = self.base_from_pixel(family, rays, x_px, y_px);
                [rays.direction[1], rays.direction[2]].map(|per_pixel| {
                    let [u, v, w] = family.uvw(per_pixel);
                    (DVec2::new(u, v) - base * w) * per_w
                })
            }
        }
    }

    /// Inverse of [`RayModel::base_from_pixel`]: pixel position of `(p, q, 1)`, times a number that is positive ahead
    /// of the eye.
    pub fn pixel_from_base(&self, family: &Family, rays: &IndexRays) -> DMat3 {
        match self {
            Self::Parallel { .. } => {
                let at = |x: f64, y: f64| self.base_from_pixel(family, rays, x, y);
                let first = at(0.0, 0.0);
                let (per_x, per_y) = (at(1.0, 0.0) - first, at(0.0, 1.0) - first);
                DMat3::from_cols(per_x.extend(0.0), per_y.extend(0.0), first.extend(1.0)).inverse()
            }
            Self::Perspective { .. } => {
                let [first, per_x, per_y] = rays.direction.map(|d| DVec3::from_array(family.uvw(d)));
                let ahead = if family.ascending { 1.0 } else { -1.0 };
                DMat3::from_cols(per_x, per_y, first).inverse() * ahead
            }
        }
    }

    /// Bounds of a box in base coordinates; `None` where the box is not wholly ahead of the eye.
    pub fn projected_bounds(&self, family: &Family, [lo, hi]: [DVec3; 2]) -> Option<[DVec2; 2]> {
        // Ahead of the eye, a projection takes a box to the convex hull of its projected corners, so these bound it.
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in 0..8 {
            let pick = |bit: usize| if corner >> bit & 1 == 0 { lo } else { hi };
            let corner = DVec3::new(pick(0).x, pick(1).y, pick(2).z);
            let [u, v, w] = family.uvw(corner);
            let base = match self {
                Self::Parallel { slope } => DVec2::new(u - slope[0] * w, v - slope[1] * w),
                Self::Perspective { eye } => {
                    let ahead = (w - eye[2]) * if family.ascending { 1.0 } else { -1.0 };
                    if ahead < 1e-6 {
                        return None;
                    }
                    DVec2::new((u - eye[0]) / (w - eye[2]), (v - eye[1]) / (w - eye[2]))
                }
            };
            min = min.min(base);
            max = max.max(base);
        }
        Some([min, max])
    }
}

/// Lattice constant of the positions of parallel rays, in samples: texels that lie on samples, but for the rounding of
/// camera and affine, then lie on them exactly, and show them to the bit. Over a picture of 16384 pixels a ray is off
/// by 5e-7 samples at most.
pub const LATTICE: f64 = 1.0 / (1_u64 << 34) as f64;

/// The nearest position on the lattice.
pub fn snapped(position: DVec2) -> DVec2 {
    (position / LATTICE).round() * LATTICE
}
