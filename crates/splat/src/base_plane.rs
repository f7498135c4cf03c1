//! Base planes: texels of every sheet laid out so that texel (i, j) of each lies on one viewing ray.
//!
//! A ray belongs to the index axis `w` it runs most along. For parallel rays there is one such axis and the base
//! coordinates `(p, q)` are the index position where the ray crosses the slice `w = 0`; sheet `w` is that grid shifted
//! by the shear `w · (du/dw, dv/dw)`. For perspective the rays form up to six families (three axes, two signs) and
//! `(p, q)` are the slopes `(du/dw, dv/dw)`, at most 1.1 in magnitude; sheet `w` is that grid scaled by `w − eye.w`
//! about the eye. Either way a sheet's texels stay axis-aligned and uniform, so the kernel stays separable.
//!
//! Source: the shear-warp factorisation (Lacroute & Levoy 1994), here with the sheets reconstructed, not resampled.

use glam::{DAffine3, DVec2, DVec3};
use wavesplat_core::{Camera, Error, Projection, Result};

/// Viewing rays in index space: origin and direction are affine in the pixel position.
#[derive(Clone, Copy, Debug)]
pub struct IndexRays {
    origin: [DVec3; 3],
    direction: [DVec3; 3],
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

    /// Index-space origin of the ray through a pixel position.
    pub fn origin(&self, x_px: f64, y_px: f64) -> DVec3 {
        self.origin[0] + self.origin[1] * x_px + self.origin[2] * y_px
    }

    /// Index-space direction of the ray through a pixel position, not normalised.
    pub fn direction(&self, x_px: f64, y_px: f64) -> DVec3 {
        self.direction[0] + self.direction[1] * x_px + self.direction[2] * y_px
    }
}

/// Largest slope of a ray in its family: rays that run along two axes nearly alike take the one whose slices are
/// contiguous.
const MUCH: f64 = 1.1;

/// Which axis rays run along, and which way: one of six.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// Index axes called u, v, w.
    pub axes: [usize; 3],
    /// Whether rays run towards growing w.
    pub ascending: bool,
}

impl Family {
    /// The family of a ray by its index-space direction: the axis that it runs most along, or one that it runs nearly as
    /// much along and whose slices lie better in memory.
    pub fn of(direction: DVec3) -> Self {
        let d = direction.to_array();
        let a = direction.abs();
        let much = a.max_element() / MUCH;
        let w = if a.z >= much { 2 } else { usize::from(a.y >= much) };
        let axes = [[1, 2, 0], [0, 2, 1], [0, 1, 2]][w];
        Self { axes, ascending: d[w] > 0.0 }
    }

    /// Components along u, v, w.
    pub fn uvw(&self, v: DVec3) -> [f64; 3] {
        self.axes.map(|a| v[a])
    }
}

/// Where the rays of a family come from.
#[derive(Clone, Copy, Debug)]
enum Spread {
    /// All rays have these slopes; `(p, q)` is the position at w = 0.
    Parallel { slope: [f64; 2] },
    /// All rays pass the eye (u, v, w); `(p, q)` are their slopes.
    FromEye { eye: [f64; 3] },
}

/// A grid of rays of one family.
#[derive(Clone, Debug)]
pub struct BasePlane {
    /// Axis and sign.
    pub family: Family,
    spread: Spread,
    /// `(p, q)` of texel (0, 0)'s centre.
    pub origin: DVec2,
    /// `(p, q)` per texel.
    pub step: DVec2,
    /// Texels along u and v.
    pub size: [usize; 2],
}

/// A ray as lines over w: `u = u0 + du · w`, `v = v0 + dv · w`.
#[derive(Clone, Copy, Debug)]
pub struct TexelRay {
    /// Position at w = 0.
    pub at_zero: [f64; 2],
    /// Change per slice.
    pub slope: [f64; 2],
}

impl BasePlane {
    /// Ray through texel position `(i, j)`.
    pub fn ray(&self, i: f64, j: f64) -> TexelRay {
        let (p, q) = (self.origin.x + self.step.x * i, self.origin.y + self.step.y * j);
        match self.spread {
            Spread::Parallel { slope } => TexelRay { at_zero: [p, q], slope },
            Spread::FromEye { eye } => TexelRay { at_zero: [eye[0] - p * eye[2], eye[1] - q * eye[2]], slope: [p, q] },
        }
    }

    /// Sheet positions at `w`: index coordinate of texel 0 and change per texel, along u and v.
    pub fn sheet(&self, w: f64) -> [(f64, f64); 2] {
        let (origin, step) = (self.origin.to_array(), self.step.to_array());
        std::array::from_fn(|k| match self.spread {
            Spread::Parallel { slope } => (origin[k] + slope[k] * w, step[k]),
            Spread::FromEye { eye } => (eye[k] + origin[k] * (w - eye[2]), step[k] * (w - eye[2])),
        })
    }

    /// The eye's w, where the rays begin; `None` for parallel rays.
    pub fn eye_w(&self) -> Option<f64> {
        match self.spread {
            Spread::Parallel { .. } => None,
            Spread::FromEye { eye } => Some(eye[2]),
        }
    }

    /// Texel position of a pixel position, whichever family its ray belongs to.
    pub fn texel_from_pixel(&self, rays: &IndexRays, x_px: f64, y_px: f64) -> DVec2 {
        let base = base_from_pixel(&self.family, &self.spread, rays, x_px, y_px);
        (base - self.origin) / self.step
    }
}

fn base_from_pixel(family: &Family, spread: &Spread, rays: &IndexRays, x_px: f64, y_px: f64) -> DVec2 {
    match spread {
        Spread::Parallel { slope } => {
            let [u, v, w] = family.uvw(rays.origin(x_px, y_px));
            DVec2::new(u - slope[0] * w, v - slope[1] * w)
        }
        Spread::FromEye { .. } => {
            let [u, v, w] = family.uvw(rays.direction(x_px, y_px));
            DVec2::new(u / w, v / w)
        }
    }
}

/// The part of a family that the picture needs: range of `(p, q)` and its finest pixel distance.
struct Need {
    family: Family,
    lo: DVec2,
    hi: DVec2,
    pixel: DVec2,
}

/// Texels beyond the outermost pixel centre, for the warp's filter.
const MARGIN_TEXELS: f64 = 4.0;

/// Positions of parallel rays are multiples of this, in samples: texels that lie on samples, but for the rounding of
/// camera and affine, then lie on them exactly, and show them to the bit. Over a picture of 16384 pixels a ray is off by
/// 5e-7 samples at most.
const LATTICE: f64 = 1.0 / (1_u64 << 34) as f64;

/// Texels closer than this, in samples, would feel the lattice.
const LEAST_STEP_ON_LATTICE: f64 = 1e-3;

/// Most texels of a base plane: 16 bytes each, 4 GiB in all.
const MAX_TEXELS: f64 = (1 << 28) as f64;

/// The base planes that a picture needs, at `oversampling` texels per pixel along each axis. `box_lo` and `box_hi`
/// bound what is drawn, in index coordinates; rays that miss it get no texels.
pub fn base_planes(
    camera: &Camera,
    rays: &IndexRays,
    [width_px, height_px]: [usize; 2],
    oversampling: f64,
    [box_lo, box_hi]: [DVec3; 2],
) -> Result<Vec<BasePlane>> {
    let orthographic = matches!(camera.projection(), Projection::Orthographic { .. });
    let mut needs: Vec<Need> = Vec::new();
    // Parallel rays: the map is affine, so the corners of the picture are enough.
    let (xs, ys) = if orthographic {
        (vec![0.0, width_px as f64], vec![0.0, height_px as f64])
    } else {
        let centres = |n: usize| (0..n).map(|i| i as f64 + 0.5).collect();
        (centres(width_px), centres(height_px))
    };
    for &y in &ys {
        for &x in &xs {
            let family = Family::of(rays.direction(x, y));
            let spread = spread(&family, rays, orthographic);
            let base = base_from_pixel(&family, &spread, rays, x, y);
            let pixel = pixel_distance(&family, &spread, rays, x, y);
            match needs.iter_mut().find(|n| n.family == family) {
                None => needs.push(Need { family, lo: base, hi: base, pixel }),
                Some(need) => {
                    need.lo = need.lo.min(base);
                    need.hi = need.hi.max(base);
                    need.pixel = need.pixel.min(pixel);
                }
            }
        }
    }
    let mut planes = Vec::new();
    for Need { family, lo, hi, pixel } in needs {
        let spread = spread(&family, rays, orthographic);
        // A grazing family can have pixels much denser at one end; it gets no more texels than the picture has.
        let floor = (hi - lo) / (4.0 * oversampling * (width_px + height_px) as f64);
        let step = (pixel / oversampling).max(floor).max(DVec2::splat(1e-12));
        let on_lattice = orthographic && step.min_element() > LEAST_STEP_ON_LATTICE;
        let step = if on_lattice { snapped(step) } else { step };
        let margin = MARGIN_TEXELS * step + pixel;
        let (mut lo, mut hi) = (lo - margin, hi + margin);
        if let Some((box_lo, box_hi)) = shadow(&family, &spread, box_lo, box_hi) {
            lo = lo.max(box_lo - MARGIN_TEXELS * step);
            hi = hi.min(box_hi + MARGIN_TEXELS * step);
        }
        if lo.x >= hi.x || lo.y >= hi.y {
            continue;
        }
        // A texel on the first pixel's centre makes the warp an identity where the axes agree.
        let anchor = base_from_pixel(&family, &spread, rays, 0.5, 0.5);
        let anchor = if anchor.is_finite() { anchor } else { DVec2::ZERO };
        let anchor = if on_lattice { snapped(anchor) } else { anchor };
        let origin = anchor + ((lo - anchor) / step).floor() * step;
        let size = ((hi - origin) / step).ceil() + 1.0;
        if size.x * size.y > MAX_TEXELS {
            return Err(Error::TooLarge {
                what: "the base plane of this view",
                needed_mib: (size.x * size.y * 16.0 / f64::from(1 << 20)) as u64,
                limit_mib: (MAX_TEXELS * 16.0 / f64::from(1 << 20)) as u64,
                mend: "ask for a smaller picture or less oversampling",
            });
        }
        planes.push(BasePlane { family, spread, origin, step, size: [size.x as usize, size.y as usize] });
    }
    Ok(planes)
}

/// The nearest position on the lattice.
fn snapped(position: DVec2) -> DVec2 {
    (position / LATTICE).round() * LATTICE
}

fn spread(family: &Family, rays: &IndexRays, orthographic: bool) -> Spread {
    if orthographic {
        let [du, dv, dw] = family.uvw(rays.direction(0.0, 0.0));
        Spread::Parallel { slope: snapped(DVec2::new(du / dw, dv / dw)).to_array() }
    } else {
        Spread::FromEye { eye: family.uvw(rays.origin(0.0, 0.0)) }
    }
}

/// Largest change of p and of q per pixel, in any direction of the picture.
fn pixel_distance(family: &Family, spread: &Spread, rays: &IndexRays, x: f64, y: f64) -> DVec2 {
    let at = |dx: f64, dy: f64| base_from_pixel(family, spread, rays, x + dx, y + dy);
    // Central differences are exact for the affine map and good to second order for the homography.
    let (dx, dy) = (at(0.25, 0.0) - at(-0.25, 0.0), at(0.0, 0.25) - at(0.0, -0.25));
    DVec2::new(dx.x.hypot(dy.x), dx.y.hypot(dy.y)) * 2.0
}

/// Bounds of the box in base coordinates; `None` where the eye is not clear of it.
fn shadow(family: &Family, spread: &Spread, lo: DVec3, hi: DVec3) -> Option<(DVec2, DVec2)> {
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in 0..8 {
        let pick = |bit: usize| if corner >> bit & 1 == 0 { lo } else { hi };
        let corner = DVec3::new(pick(0).x, pick(1).y, pick(2).z);
        let [u, v, w] = family.uvw(corner);
        let base = match spread {
            Spread::Parallel { slope } => DVec2::new(u - slope[0] * w, v - slope[1] * w),
            Spread::FromEye { eye } => {
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
    Some((min, max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    fn check(projection: Projection, position: DVec3, box_hi: DVec3, n_families: usize) {
        let focal = DVec3::new(10.0, 9.0, 8.0);
        let camera = Camera::new(position, focal, DVec3::Z, projection).unwrap();
        let size = [64, 48];
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, size[0], size[1]);
        let planes = base_planes(&camera, &rays, size, 1.0, [DVec3::ZERO, box_hi]).unwrap();
        assert_eq!(planes.len(), n_families);
        for plane in &planes {
            for (x, y) in [(0.5, 0.5), (20.5, 40.5), (63.5, 47.5)] {
                let direction = rays.direction(x, y);
                if Family::of(direction) != plane.family {
                    continue;
                }
                // The texel's ray is the pixel's ray, at two sheets.
                let texel = plane.texel_from_pixel(&rays, x, y);
                let [ou, ov, ow] = plane.family.uvw(rays.origin(x, y));
                let [du, dv, dw] = plane.family.uvw(direction);
                let ray = plane.ray(texel.x, texel.y);
                // The eye is up to 100 slices away, over which the lattice of the slopes of parallel rays counts.
                let near = if plane.eye_w().is_none() { 100.0 * LATTICE } else { 1e-9 };
                for w in [-3.0, 17.0] {
                    let t = (w - ow) / dw;
                    let [(u0, su), (v0, sv)] = plane.sheet(w);
                    assert!((u0 + su * texel.x - (ou + t * du)).abs() < near);
                    assert!((v0 + sv * texel.y - (ov + t * dv)).abs() < near);
                    assert!((ray.at_zero[0] + ray.slope[0] * w - (ou + t * du)).abs() < near);
                    assert!((ray.at_zero[1] + ray.slope[1] * w - (ov + t * dv)).abs() < near);
                }
            }
        }
    }

    #[test]
    fn a_texel_lies_on_the_ray_of_its_pixel() {
        let far = DVec3::splat(20.0);
        check(Projection::Orthographic { parallel_scale: 12.0 }, DVec3::new(50.0, 30.0, 22.0), far, 1);
        check(Projection::Perspective { view_angle_rad: 0.5 }, DVec3::new(90.0, 12.0, 10.0), far, 1);
        // Inside the volume, looking towards a corner of the cube of directions.
        check(Projection::Perspective { view_angle_rad: 2.0 }, DVec3::new(11.0, 10.0, 9.0), far, 3);
    }

    #[test]
    fn texels_on_samples_lie_on_them_exactly() {
        // Rotated by a quarter turn, with spacings and places that have no exact binary form.
        let world_from_index = DAffine3 {
            matrix3: DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2) * DMat3::from_diagonal(DVec3::splat(0.7)),
            translation: DVec3::new(-123.4, 56.7, 1e4 + 0.1),
        };
        let focal = world_from_index.transform_point3(DVec3::new(10.0, 9.0, 8.0));
        let projection = Projection::Orthographic { parallel_scale: 0.7 * 9.5 };
        for (from, up) in [(DVec3::X, DVec3::Y), (-DVec3::Y, DVec3::Z), (DVec3::Z, -DVec3::X)] {
            let camera = Camera::new(focal + 300.0 * from, focal, up, projection).unwrap();
            let rays = IndexRays::new(&camera, world_from_index.inverse(), 19, 19);
            for oversampling in [1.0, 2.0] {
                let far = DVec3::splat(20.0);
                let planes = base_planes(&camera, &rays, [19, 19], oversampling, [DVec3::ZERO, far]).unwrap();
                for w in [0.0, 7.0, 20.0] {
                    for (origin, step) in planes[0].sheet(w) {
                        let first = origin * oversampling;
                        assert!(first == first.round() && step == 1.0 / oversampling, "{from}: {origin} {step}");
                    }
                }
            }
        }
    }

    #[test]
    fn texels_are_at_least_as_dense_as_asked() {
        let camera = Camera::new(
            DVec3::new(50.0, 30.0, 22.0),
            DVec3::ZERO,
            DVec3::Z,
            Projection::Orthographic { parallel_scale: 12.0 },
        );
        let camera = camera.unwrap();
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 100, 80);
        for oversampling in [0.5, 1.0, 2.0] {
            let planes =
                base_planes(&camera, &rays, [100, 80], oversampling, [DVec3::ZERO, DVec3::splat(9.0)]).unwrap();
            let at = |x, y| planes[0].texel_from_pixel(&rays, x, y);
            let (dx, dy) = (at(51.0, 40.0) - at(50.0, 40.0), at(50.0, 41.0) - at(50.0, 40.0));
            assert!((dx.x.hypot(dy.x) - oversampling).abs() < 1e-9);
            assert!((dx.y.hypot(dy.y) - oversampling).abs() < 1e-9);
        }
    }
}
