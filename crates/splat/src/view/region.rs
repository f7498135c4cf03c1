//! Clipping: the volume's box, crop boxes, clip planes and the eye are half spaces, which leave one interval of w of a
//! ray to be drawn. Slabs are weighted by the share of them inside it, which is clean at any sub-voxel position and
//! makes thickness exact (Beer-Lambert) where rays enter through the side of the volume.

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Crop, Error, Grid, RenderOptions, Result};

use crate::view::base_plane::{BasePlane, TexelRay};

/// The half space `normal · position + offset ≥ 0`, in index coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Inward normal, of length 1.
    pub normal: DVec3,
    /// Signed distance of the origin from the wall, positive inside, in samples.
    pub offset: f64,
}

/// Entry and exit of a ray through a region.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Ray parameters; the ray misses the region where the first is not less than the second.
    pub ends: [f64; 2],
    /// The half spaces at which the ends lie; `usize::MAX` where the ray itself begins or ends.
    pub walls: [usize; 2],
}

impl Passage {
    /// Length inside, in units of the ray's direction; not positive where the ray misses the region.
    pub fn length(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }
}

/// The part of the volume that is drawn: an intersection of half spaces, and its index-space bounds.
#[derive(Clone, Debug)]
pub struct Region {
    /// Half spaces whose intersection the region is.
    pub half_spaces: Vec<HalfSpace>,
    /// Corners of an index-aligned box around the region.
    pub bounds: [DVec3; 2],
}

/// Walls of the volume's box, which are the first half spaces of a region.
const N_BOX_WALLS: usize = 6;

impl Region {
    /// The intersection of volume box, crop and clip planes.
    pub fn new(grid: &Grid, options: &RenderOptions) -> Result<Self> {
        let [first, last] = grid.bounds();
        let world_from_index = grid.world_from_index();
        let mut region = Self { half_spaces: Vec::new(), bounds: [first, last] };
        region.add_box(DAffine3::IDENTITY, first, last);
        if let Some(crop) = options.crop {
            let (lo, hi) = crop.corners();
            let volume_bounds = match crop {
                Crop::Index { .. } => {
                    region.add_box(DAffine3::IDENTITY, lo, hi);
                    region.bounds = [first.max(lo), last.min(hi)];
                    [first, last]
                }
                Crop::World { .. } => {
                    region.add_box(world_from_index, lo, hi);
                    let crop_bounds = box_bounds(world_from_index.inverse(), lo, hi);
                    region.bounds = [first.max(crop_bounds[0]), last.min(crop_bounds[1])];
                    box_bounds(world_from_index, first, last)
                }
            };
            let inside = lo.is_finite() && hi.is_finite() && lo.cmplt(hi).all();
            let [a, b] = volume_bounds;
            if !(inside && lo.cmplt(b).all() && hi.cmpgt(a).all()) {
                let (lo, hi) = (lo.to_array(), hi.to_array());
                return Err(Error::EmptyCrop { lo, hi, volume_lo: a.to_array(), volume_hi: b.to_array() });
            }
        }
        for plane in &options.clip_planes {
            let normal = plane.normal.normalize();
            region.add_world(world_from_index, normal, -normal.dot(plane.origin));
        }
        Ok(region)
    }

    /// Adds `normal · x + offset ≥ 0`, where `x = frame_from_index · index`.
    fn add_world(&mut self, frame_from_index: DAffine3, normal: DVec3, offset: f64) {
        let offset = offset + normal.dot(frame_from_index.translation);
        let normal = frame_from_index.matrix3.transpose() * normal;
        let length = normal.length();
        self.half_spaces.push(HalfSpace { normal: normal / length, offset: offset / length });
    }

    fn add_box(&mut self, frame_from_index: DAffine3, lo: DVec3, hi: DVec3) {
        for axis in DVec3::AXES {
            self.add_world(frame_from_index, axis, -axis.dot(lo));
            self.add_world(frame_from_index, -axis, axis.dot(hi));
        }
    }

    /// Intersection with an index-space box.
    #[must_use]
    pub fn within(&self, lo: DVec3, hi: DVec3) -> Self {
        let mut region = self.clone();
        region.add_box(DAffine3::IDENTITY, lo, hi);
        region.bounds = [region.bounds[0].max(lo), region.bounds[1].min(hi)];
        region
    }

    /// The region without the walls of the volume: the space that crop and clip planes leave.
    #[must_use]
    pub fn without_box(&self) -> Self {
        Self { half_spaces: self.half_spaces[N_BOX_WALLS..].to_vec(), bounds: self.bounds }
    }

    /// Whether an index position is inside.
    pub fn contains(&self, index: DVec3) -> bool {
        self.half_spaces.iter().all(|h| h.normal.dot(index) + h.offset >= 0.0)
    }

    /// Entry and exit of the part of a ray between two ray parameters, and the walls at which they lie.
    pub fn passage(&self, origin: DVec3, direction: DVec3, part: [f64; 2]) -> Passage {
        // Directions of length about 1, so that what counts as parallel to a wall does not depend on the unit of
        // lengths.
        let scale = direction.abs().max_element();
        let direction = direction / scale;
        let mut passage = Passage { ends: part.map(|end| end * scale), walls: [usize::MAX; 2] };
        let [mut lo, mut hi] = passage.ends;
        for (wall, h) in self.half_spaces.iter().enumerate() {
            narrow(h.normal.dot(origin) + h.offset, h.normal.dot(direction), &mut lo, &mut hi);
            for (k, end) in [lo, hi].into_iter().enumerate() {
                if end != passage.ends[k] {
                    passage.ends[k] = end;
                    passage.walls[k] = wall;
                }
            }
        }
        passage.ends = passage.ends.map(|end| end / scale);
        passage
    }

    /// The region with every wall moved outwards by `texels` texels along a base plane; walls parallel to the plane
    /// stay.
    #[must_use]
    pub fn widened(&self, plane: &BasePlane, texels: f64) -> Self {
        let [axis_u, axis_v, axis_w] = plane.family.axes;
        let ahead = if plane.family.ascending { 1.0 } else { -1.0 };
        let mut region = self.clone();
        for h in &mut region.half_spaces {
            let way = texels * (h.normal[axis_u].abs() * plane.step.x + h.normal[axis_v].abs() * plane.step.y);
            match plane.eye_w() {
                None => h.offset += way,
                // Texels are further apart the further they are from the eye.
                Some(eye_w) => {
                    h.normal[axis_w] += ahead * way;
                    h.offset -= ahead * way * eye_w;
                    let length = h.normal.length();
                    (h.normal, h.offset) = (h.normal / length, h.offset / length);
                }
            }
        }
        region
    }

    /// Interval of w of one texel's ray inside the region; empty where lo ≥ hi.
    pub fn texel_interval(&self, plane: &BasePlane, ray: &TexelRay) -> [f64; 2] {
        let [mut lo, mut hi] = [f64::NEG_INFINITY, f64::INFINITY];
        if let Some(eye_w) = plane.eye_w() {
            *if plane.family.ascending { &mut lo } else { &mut hi } = eye_w;
        }
        for h in &self.half_spaces {
            let [nu, nv, nw] = plane.family.uvw(h.normal);
            let at_zero = nu * ray.at_zero[0] + nv * ray.at_zero[1] + h.offset;
            narrow(at_zero, nu * ray.slope[0] + nv * ray.slope[1] + nw, &mut lo, &mut hi);
        }
        [lo, hi]
    }

    /// Interval of w that is drawn of one texel's ray: inside the region, or inside the widened region if the ray
    /// misses it.
    pub fn drawn_interval(&self, plane: &BasePlane, ray: &TexelRay) -> [f64; 2] {
        let [lo, hi] = self.texel_interval(plane, ray);
        if lo < hi { [lo, hi] } else { self.widened(plane, plane.beyond).texel_interval(plane, ray) }
    }

    /// Intervals of w inside the region, of the rays of `LANES` texels from `(i, j)` on; empty where lo ≥ hi.
    #[inline(always)]
    pub fn texel_intervals(&self, plane: &BasePlane, i: f64, j: f64) -> [[f64; LANES]; 2] {
        let (mut lo, mut hi) = ([f64::NEG_INFINITY; LANES], [f64::INFINITY; LANES]);
        if let Some(eye_w) = plane.eye_w() {
            *if plane.family.ascending { &mut lo } else { &mut hi } = [eye_w; LANES];
        }
        // Position and slope of the rays are affine along a row of texels.
        let (ray, next) = (plane.ray(i, j), plane.ray(i + 1.0, j));
        for h in &self.half_spaces {
            let [nu, nv, nw] = plane.family.uvw(h.normal);
            let at_zero = |ray: &TexelRay| nu * ray.at_zero[0] + nv * ray.at_zero[1] + h.offset;
            let slope = |ray: &TexelRay| nu * ray.slope[0] + nv * ray.slope[1] + nw;
            let (at_zero, slope) = ([at_zero(&ray), at_zero(&next)], [slope(&ray), slope(&next)]);
            for k in 0..LANES {
                let along = |[first, next]: [f64; 2]| first + (next - first) * k as f64;
                narrow(along(at_zero), along(slope), &mut lo[k], &mut hi[k]);
            }
        }
        [lo, hi]
    }
}

/// Keeps the `t` with `at_zero + slope · t ≥ 0`.
#[inline(always)]
fn narrow(at_zero: f64, slope: f64, lo: &mut f64, hi: &mut f64) {
    // Below this slope the plane is parallel to the ray.
    const PARALLEL: f64 = 1e-12;
    // A ray along a face is inside if it is as near as this, samples: texels on the outermost samples must not fall to
    // rounding, and affines in files are rounded to f32.
    const ON_FACE: f64 = 1e-6;
    let t = -at_zero / slope;
    // Written as selections, so that loops over texels become vectors.
    let (rises, falls) = (slope > PARALLEL, slope < -PARALLEL);
    let from = if rises { t } else { f64::NEG_INFINITY };
    let outside = if rises || falls { false } else { at_zero < -ON_FACE };
    let to = if outside { f64::NEG_INFINITY } else { f64::INFINITY };
    let to = if falls { t } else { to };
    *lo = if from > *lo { from } else { *lo };
    *hi = if to < *hi { to } else { *hi };
}

/// Bounds of a box in another frame.
pub fn box_bounds(transform: DAffine3, lo: DVec3, hi: DVec3) -> [DVec3; 2] {
    let corners = (0..8).map(|c| {
        let pick = |bit: usize| if c >> bit & 1 == 0 { lo } else { hi };
        transform.transform_point3(DVec3::new(pick(0).x, pick(1).y, pick(2).z))
    });
    corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_core::{ClipPlane, Samples, Volume};

    fn region(options: &RenderOptions) -> Result<Region> {
        let samples = [0_u8; 1000];
        let affine = DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0));
        let volume = Volume::new("test", Samples::U8(&samples), [10, 10, 10], affine).unwrap();
        Region::new(volume.grid(), options)
    }

    #[test]
    fn crop_and_planes_cut_a_ray() {
        let crop = Some(Crop::World { lo: DVec3::new(3.0, -1.0, -1.0), hi: DVec3::splat(100.0) });
        let clip_planes = vec![ClipPlane { origin: DVec3::new(10.0, 0.0, 0.0), normal: DVec3::new(-2.0, 0.0, 0.0) }];
        let region = region(&RenderOptions { crop, clip_planes, ..RenderOptions::default() }).unwrap();
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let [lo, hi] = region.passage(DVec3::new(-5.0, 4.0, 4.0), DVec3::X, whole).ends;
        // World 3 and 10 are index 1.5 and 5.
        assert!((lo - 6.5).abs() < 1e-12 && (hi - 10.0).abs() < 1e-12, "{lo} {hi}");
        assert!(region.contains(DVec3::new(2.0, 4.0, 4.0)) && !region.contains(DVec3::new(1.0, 4.0, 4.0)));
        // The same ray in other units of lengths.
        for unit in [1e-15, 1e15] {
            let ends = region.passage(DVec3::new(-5.0, 4.0, 4.0), unit * DVec3::X, whole).ends;
            assert!((ends[0] * unit - lo).abs() < 1e-9 && (ends[1] * unit - hi).abs() < 1e-9, "{unit}: {ends:?}");
        }
    }

    #[test]
    fn empty_crops_are_refused() {
        for (lo, hi) in [(5.0, 4.0), (20.0, 30.0), (-3.0, -1.0), (f64::NAN, 1.0)] {
            let crop = Some(Crop::Index { lo: DVec3::splat(lo), hi: DVec3::splat(hi) });
            let result = region(&RenderOptions { crop, ..RenderOptions::default() });
            assert!(matches!(result, Err(Error::EmptyCrop { .. })), "{lo} {hi}");
        }
    }
}
