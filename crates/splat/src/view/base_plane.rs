//! Base planes (shear-warp): texels of every sheet laid out so that texel (i, j) of each lies on one viewing ray.
//!
//! A ray belongs to the index axis `w` it runs most along ([`Family`]). For parallel rays there is one such axis and
//! the base coordinates `(p, q)` are the index position where the ray crosses the slice `w = 0`; sheet `w` is that grid
//! shifted by the shear `w · (du/dw, dv/dw)`. For perspective the rays form up to six families (three axes, two signs)
//! and `(p, q)` are the slopes `(du/dw, dv/dw)`, at most 1.1 in magnitude; sheet `w` is that grid scaled by `w − eye.w`
//! about the eye. Either way a sheet's texels stay axis-aligned and uniform, so the kernel stays separable.
//!
//! Source: the shear-warp factorisation (Lacroute & Levoy 1994), here with the sheets reconstructed, not resampled.

use glam::{DMat3, DVec2, DVec3};
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Camera, Error, Projection, Result};

use crate::view::family::{Family, IndexRays};
use crate::view::pixel_spacing::{PixelSpacing, pixel_spacings};
use crate::view::ray_model::{RayModel, snapped};

/// A grid of rays of one family.
#[derive(Clone, Debug)]
pub struct BasePlane {
    /// Axis and sign.
    pub family: Family,
    model: RayModel,
    /// `(p, q)` of texel (0, 0)'s centre.
    pub origin: DVec2,
    /// `(p, q)` per texel.
    pub step: DVec2,
    /// Texels along u and v.
    pub size: [usize; 2],
    /// Pixel position of base coordinates `(p, q, 1)`, times a number that is positive ahead of the eye.
    pixel_from_base: DMat3,
    /// Size of the picture.
    size_px: DVec2,
    /// Texels by which walls are moved outwards for rays that miss the region, so that the filter finds texels there.
    pub beyond: f64,
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
        match self.model {
            RayModel::Parallel { slope } => TexelRay { at_zero: [p, q], slope },
            RayModel::Perspective { eye } => {
                TexelRay { at_zero: [eye[0] - p * eye[2], eye[1] - q * eye[2]], slope: [p, q] }
            }
        }
    }

    /// Sheet positions at `w`: index coordinate of texel 0 and change per texel, along u and v.
    pub fn sheet(&self, w: f64) -> [(f64, f64); 2] {
        let (origin, step) = (self.origin.to_array(), self.step.to_array());
        std::array::from_fn(|k| match self.model {
            RayModel::Parallel { slope } => (origin[k] + slope[k] * w, step[k]),
            RayModel::Perspective { eye } => (eye[k] + origin[k] * (w - eye[2]), step[k] * (w - eye[2])),
        })
    }

    /// A rectangle of the base plane from texel `first` on, which may lie outside it.
    #[must_use]
    pub fn window(&self, first: [i64; 2], size: [usize; 2]) -> Self {
        let origin = self.origin + self.step * DVec2::from_array(first.map(|i| i as f64));
        Self { origin, size, ..self.clone() }
    }

    /// The base plane thinned to every `k`th texel along u and along v, from the `first`th on.
    #[must_use]
    pub fn every(&self, k: usize, first: usize) -> Self {
        let origin = self.origin + self.step * first as f64;
        let size = self.size.map(|n| n.saturating_sub(first).div_ceil(k));
        Self { origin, step: self.step * k as f64, size, beyond: self.beyond / k as f64, ..self.clone() }
    }

    /// The eye's w, where the rays begin; `None` for parallel rays.
    pub fn eye_w(&self) -> Option<f64> {
        match self.model {
            RayModel::Parallel { .. } => None,
            RayModel::Perspective { eye } => Some(eye[2]),
        }
    }

    /// Eye in index coordinates along u, v, w; `None` for parallel rays.
    pub fn eye(&self) -> Option<[f64; 3]> {
        match self.model {
            RayModel::Parallel { .. } => None,
            RayModel::Perspective { eye } => Some(eye),
        }
    }

    /// Pixel position of texel position `(i, j, 1)`, times a number that is positive ahead of the eye.
    pub fn pixel_from_texel(&self) -> DMat3 {
        let base_from_texel = DMat3::from_cols(
            DVec3::new(self.step.x, 0.0, 0.0),
            DVec3::new(0.0, self.step.y, 0.0),
            self.origin.extend(1.0),
        );
        self.pixel_from_base * base_from_texel
    }

    /// Whether the eye lies between two slices.
    pub fn eye_is_within(&self, [near, far]: [f64; 2]) -> bool {
        self.eye_w().is_some_and(|w| near <= w && w <= far)
    }

    /// Signed distance of the eye from a wall, `normal · eye + offset`, in index coordinates; 0 for parallel rays.
    pub fn eye_distance(&self, normal: DVec3, offset: f64) -> f64 {
        let RayModel::Perspective { eye } = self.model else { return 0.0 };
        let [u, v, w] = self.family.uvw(normal);
        u * eye[0] + v * eye[1] + w * eye[2] + offset
    }

    /// Whether the picture may need any of the texels `from..=to`. A base plane is the bounding box of the texels that
    /// it needs: where the picture, or the family's part of it, is oblique to u and v, its corners are not needed.
    pub fn is_needed(&self, from: [usize; 2], to: [usize; 2]) -> bool {
        let [from, to] = [from, to].map(|[i, j]| DVec2::new(i as f64, j as f64));
        let [lo, hi] = [from - MARGIN_TEXELS, to + MARGIN_TEXELS].map(|texel| self.origin + self.step * texel);
        if self.eye_w().is_some() && !self.family.has_slopes(lo, hi) {
            return false;
        }
        // Ahead of the eye, a projective map takes a rectangle to the convex hull of its mapped corners.
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in [lo, DVec2::new(hi.x, lo.y), DVec2::new(lo.x, hi.y), hi] {
            let at = self.pixel_from_base * corner.extend(1.0);
            if at.z.is_nan() || at.z <= 0.0 {
                return true;
            }
            let pixel = at.truncate() / at.z;
            (min, max) = (min.min(pixel), max.max(pixel));
        }
        max.cmpge(DVec2::ZERO).all() && min.cmple(self.size_px).all()
    }

    /// Texel positions, along u and along v, of `LANES` neighbouring pixel positions of a row; for rays from an eye.
    #[inline(always)]
    pub fn texels_from_pixels(&self, rays: &IndexRays, [x_px, y_px]: [f64; 2]) -> [[f64; LANES]; 2] {
        let first = self.family.uvw(rays.direction(x_px, y_px));
        let per_pixel = self.family.uvw(rays.direction[1]);
        let (origin, per_step) = (self.origin.to_array(), self.step.recip().to_array());
        let mut texels = [[0.0; LANES]; 2];
        for k in 0..LANES {
            let per_w = 1.0 / (first[2] + per_pixel[2] * k as f64);
            for axis in 0..2 {
                let slope = (first[axis] + per_pixel[axis] * k as f64) * per_w;
                texels[axis][k] = (slope - origin[axis]) * per_step[axis];
            }
        }
        texels
    }

    /// Texels per pixel in the middle of the base plane, along the axis of the picture that has fewer; 1 where
    /// undefined.
    pub fn texels_per_pixel(&self, rays: &IndexRays) -> f64 {
        let middle = self.pixel_from_base * (self.origin + 0.5 * self.step * self.size_as_vector()).extend(1.0);
        let [x, y] = (middle.truncate() / middle.z).to_array();
        let [per_x, per_y] = self.model.base_per_pixel(&self.family, rays, x, y).map(|change| change / self.step);
        let least = per_x.length().min(per_y.length());
        if least.is_finite() { least } else { 1.0 }
    }

    fn size_as_vector(&self) -> DVec2 {
        DVec2::new(self.size[0] as f64, self.size[1] as f64)
    }

    /// Texel position of a pixel position, whichever family its ray belongs to.
    pub fn texel_from_pixel(&self, rays: &IndexRays, x_px: f64, y_px: f64) -> DVec2 {
        let base = self.model.base_from_pixel(&self.family, rays, x_px, y_px);
        (base - self.origin) / self.step
    }
}

/// Texels beyond the outermost pixel centre, for the warp's filter.
const MARGIN_TEXELS: f64 = 4.0;

/// Texels beyond a wall that the warp's cubic filter reads together with those inside.
const BEYOND: f64 = 2.0;

/// Smallest distance of texels that is rounded to the lattice, in samples: rounding would distort finer ones.
const MIN_STEP_ON_LATTICE: f64 = 1e-3;

/// Largest number of texels of a base plane: 16 bytes each, 4 GiB in all.
pub(crate) const MAX_TEXELS: f64 = (1 << 28) as f64;

/// The base planes that a picture needs, at `oversampling` texels per pixel along each axis. `shown`: corners of a box
/// around what is drawn, in index coordinates; rays that miss it get no texels.
pub fn base_planes(
    camera: &Camera,
    rays: &IndexRays,
    [width_px, height_px]: [usize; 2],
    oversampling: f64,
    shown: [DVec3; 2],
) -> Result<Vec<BasePlane>> {
    let orthographic = matches!(camera.projection(), Projection::Orthographic { .. });
    let mut planes = Vec::new();
    for spacing in pixel_spacings(rays, [width_px, height_px], orthographic) {
        let (pixel, [lo, hi]) = (spacing.pixel_distance(), spacing.range);
        let PixelSpacing { family, model, .. } = spacing;
        // A grazing family can have pixels much denser at one end; it gets no more texels than the picture has.
        let floor = (hi - lo) / (4.0 * oversampling * (width_px + height_px) as f64);
        let step = (pixel / oversampling).max(floor).max(DVec2::splat(1e-12));
        let on_lattice = orthographic && step.min_element() > MIN_STEP_ON_LATTICE;
        let step = if on_lattice { snapped(step) } else { step };
        let margin = MARGIN_TEXELS * step + pixel;
        let (mut lo, mut hi) = (lo - margin, hi + margin);
        if let Some([box_lo, box_hi]) = model.projected_bounds(&family, shown) {
            lo = lo.max(box_lo - MARGIN_TEXELS * step);
            hi = hi.min(box_hi + MARGIN_TEXELS * step);
        }
        if lo.x >= hi.x || lo.y >= hi.y {
            continue;
        }
        // A texel on the first pixel's centre makes the warp an identity where the axes agree.
        let anchor = model.base_from_pixel(&family, rays, 0.5, 0.5);
        let anchor = if anchor.is_finite() { anchor } else { DVec2::ZERO };
        let anchor = if on_lattice { snapped(anchor) } else { anchor };
        let origin = anchor + ((lo - anchor) / step).floor() * step;
        let size = ((hi - origin) / step).ceil() + 1.0;
        // False for NaN as well, as in views from so far away that f64 cannot resolve positions.
        let fits = size.min_element() >= 1.0 && size.x * size.y <= MAX_TEXELS;
        if !fits {
            return Err(Error::TooLarge {
                what: "the base plane of this view",
                needed_mib: (size.x * size.y * 16.0 / f64::from(1 << 20)) as u64,
                limit_mib: (MAX_TEXELS * 16.0 / f64::from(1 << 20)) as u64,
                mend: "ask for a smaller picture or less oversampling",
            });
        }
        let size = [size.x as usize, size.y as usize];
        let pixel_from_base = model.pixel_from_base(&family, rays);
        let size_px = DVec2::new(width_px as f64, height_px as f64);
        planes.push(BasePlane { family, model, origin, step, size, pixel_from_base, size_px, beyond: BEYOND });
    }
    Ok(planes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::ray_model::LATTICE;
    use glam::{DAffine3, DMat3};

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
    fn planes_without_a_size_are_refused() {
        let (focal, size) = (DVec3::new(10.0, 9.0, 8.0), [64, 48]);
        // Extreme scales: the box vanishes between two neighbouring f64 numbers, or is out of all proportion to a
        // texel.
        for parallel_scale in [1e-300, 1e-160, 1e300] {
            let projection = Projection::Orthographic { parallel_scale };
            let camera = Camera::new(focal + DVec3::Y * 50.0, focal, DVec3::Z, projection).unwrap();
            let rays = IndexRays::new(&camera, DAffine3::IDENTITY, size[0], size[1]);
            let planes = base_planes(&camera, &rays, size, 1.0, [DVec3::ZERO, DVec3::splat(20.0)]);
            for plane in planes.iter().flatten() {
                assert!(plane.size[0] > 0 && plane.size[1] > 0, "{parallel_scale}");
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
    fn texels_of_parallel_rays_are_as_dense_as_asked() {
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

    /// Check that texels that the filter reads are needed, that some others are not, and the ratio of texels to pixels.
    fn check_needs(projection: Projection, position: DVec3, roll: DVec3, [least, most]: [f64; 2]) {
        let focal = DVec3::splat(20.0);
        let camera = Camera::new(position, focal, roll, projection).unwrap();
        let size = [300, 200];
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, size[0], size[1]);
        let planes = base_planes(&camera, &rays, size, 1.0, [DVec3::splat(-200.0), DVec3::splat(240.0)]).unwrap();
        let cells = |plane: &BasePlane| plane.size.map(|n| n.div_ceil(LANES));
        let is_needed = |plane: &BasePlane, cell: [usize; 2]| {
            let from = cell.map(|c| c * LANES);
            plane.is_needed(from, from.map(|c| c + LANES - 1))
        };
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = [x as f64 + 0.5, y as f64 + 0.5];
                let family = Family::of(rays.direction(at[0], at[1]));
                let plane = planes.iter().find(|plane| plane.family == family).unwrap();
                let texel = plane.texel_from_pixel(&rays, at[0], at[1]);
                if plane.eye_w().is_some() {
                    let [u, v] = plane.texels_from_pixels(&rays, at);
                    assert!((DVec2::new(u[0], v[0]) - texel).length() < 1e-9);
                    let last = plane.texel_from_pixel(&rays, at[0] + 15.0, at[1]);
                    assert!(!last.is_finite() || (DVec2::new(u[15], v[15]) - last).length() < 1e-7 * last.length());
                }
                for corner in [[-1.0, -1.0], [2.0, -1.0], [-1.0, 2.0], [2.0, 2.0]] {
                    let read = texel.floor() + DVec2::from_array(corner);
                    let (i, j) = (read.x as usize, read.y as usize);
                    assert!(i < plane.size[0] && j < plane.size[1], "{read} of {:?}", plane.size);
                    assert!(is_needed(plane, [i / LANES, j / LANES]), "{read}");
                }
            }
        }
        let n_cells: usize = planes.iter().map(|plane| cells(plane).into_iter().product::<usize>()).sum();
        let all = |plane: &BasePlane| {
            let [n_u, n_v] = cells(plane);
            (0..n_u * n_v).filter(|cell| is_needed(plane, [cell % n_u, cell / n_u])).count()
        };
        let n_needed: usize = planes.iter().map(all).sum();
        let texels_per_pixel = (n_needed * LANES * LANES) as f64 / (size[0] * size[1]) as f64;
        assert!((least..most).contains(&texels_per_pixel), "{texels_per_pixel}, {n_needed} of {n_cells} cells");
        assert!(n_needed < n_cells, "{n_needed} of {n_cells} cells");
    }

    #[test]
    fn what_the_filter_reads_is_needed_and_not_much_more() {
        let wide = |view_angle_rad: f64| Projection::Perspective { view_angle_rad };
        let diagonal = DVec3::splat(20.0) + DVec3::new(600.0, 590.0, 580.0);
        check_needs(Projection::Orthographic { parallel_scale: 30.0 }, diagonal, DVec3::Z, [0.8, 1.5]);
        check_needs(wide(0.5), diagonal, DVec3::Z, [0.8, 1.5]);
        check_needs(wide(0.5), diagonal, DVec3::new(1.0, 0.3, 0.2), [0.8, 1.5]);
        check_needs(wide(0.5), DVec3::new(620.0, 20.0, 21.0), DVec3::new(0.0, 1.0, 1.0), [0.8, 1.5]);
        // From inside, all around: towards the picture's corners pixels lie eight times closer than in the middle.
        check_needs(wide(2.2), DVec3::new(25.0, 24.0, 23.0), DVec3::Z, [0.8, 4.0]);
    }

    #[test]
    fn in_perspective_texels_lie_as_pixels_do_on_the_whole() {
        let (focal, projection) = (DVec3::splat(50.0), Projection::Perspective { view_angle_rad: 0.5 });
        let camera = Camera::new(focal + 230.0 * DVec3::new(1.0, 0.9, 0.8), focal, DVec3::Z, projection).unwrap();
        let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 200, 200);
        let lay_out = |shown: [f64; 2]| base_planes(&camera, &rays, [200, 200], 1.0, shown.map(DVec3::splat)).unwrap();
        let planes = lay_out([-200.0, 300.0]);
        let mut distances = vec![(DVec2::ZERO, 0, DVec2::INFINITY); planes.len()];
        for y in 0..200 {
            for x in 0..200 {
                let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let family = Family::of(rays.direction(x, y));
                let k = planes.iter().position(|plane| plane.family == family).unwrap();
                let at = |x: f64, y: f64| planes[k].texel_from_pixel(&rays, x, y);
                let (dx, dy) = (at(x + 0.5, y) - at(x - 0.5, y), at(x, y + 0.5) - at(x, y - 0.5));
                let distance = DVec2::new(dx.x.hypot(dy.x), dx.y.hypot(dy.y));
                distances[k].0 += distance;
                distances[k].1 += 1;
                distances[k].2 = distances[k].2.min(distance);
            }
        }
        for (sum, n, finest) in distances {
            let mean = sum / f64::from(n);
            assert!(n > 5000 && (mean - 1.0).abs().max_element() < 0.02, "{n} pixels, {mean} texels apart");
            assert!(finest.min_element() > 0.69 && finest.max_element() < 1.0, "{finest}");
        }
        // Texels stay where they are as the volume is cut.
        for (whole, cut) in planes.iter().zip(&lay_out([20.0, 70.0])) {
            let offset = (cut.origin - whole.origin) / whole.step;
            assert!(cut.step == whole.step && (offset - offset.round()).length() < 1e-6, "{offset}");
        }
    }
}
