//! The silhouette of what is drawn: which rays meet it, how far they run in it, and where in the picture that changes.
//!
//! A ray that misses everything by a few texels is drawn as if the walls stood further out. So the picture continues
//! smoothly beyond a wall, the filter that reads texels meets no jump there, and the wall is applied at exact places as
//! the picture is made ([`crate::picture::edges`]).

use glam::DVec3;
use wavesplat_compute::simd::LANES;

use crate::view::base_plane::{BasePlane, TexelRay};
use crate::view::family::IndexRays;
use crate::view::region::{Passage, Region};

/// The distinct regions that are drawn: one, or several where the boxes of layers differ.
#[derive(Clone, Debug)]
pub struct Silhouette {
    regions: Vec<Region>,
}

/// Regions that a ray meets, and the length of the ray in them, along w.
#[derive(Clone, Copy, Debug, Default)]
pub struct RayHits {
    /// Bit k: the ray meets region k.
    pub regions: u8,
    /// Length inside, in slices; of several regions the sum.
    pub length: f64,
}

/// Coverage of a rectangle of the picture by the silhouette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Every ray meets the same regions, and neighbouring rays run about equally far in them.
    Inside,
    /// No ray meets anything.
    Outside,
    /// Rays may differ.
    Edge,
}

impl Silhouette {
    /// The silhouette of the regions of all layers; equal ones are merged.
    pub fn new<'a>(regions: impl Iterator<Item = &'a Region>) -> Self {
        let mut different: Vec<Region> = Vec::new();
        for region in regions {
            if !different.iter().any(|other| other.half_spaces == region.half_spaces) {
                different.push(region.clone());
            }
        }
        Self { regions: different }
    }

    /// Whether layers end at different walls.
    pub fn is_mixed(&self) -> bool {
        self.regions.len() > 1
    }

    /// Mask of the rays of `LANES` texels from `(i, j)` on that miss everything. `own`: their intervals in a region,
    /// which is the only one as a rule.
    #[inline(always)]
    pub fn missed(&self, plane: &BasePlane, own: &[[f64; LANES]; 2], i: f64, j: f64) -> [bool; LANES] {
        let misses = |[lo, hi]: &[[f64; LANES]; 2]| -> [bool; LANES] {
            // An end that is not a number is a miss as well.
            let meets: [bool; LANES] = std::array::from_fn(|k| lo[k] < hi[k]);
            meets.map(|meets| !meets)
        };
        if !self.is_mixed() {
            return misses(own);
        }
        let mut missed = [true; LANES];
        for region in &self.regions {
            let of_region = misses(&region.texel_intervals(plane, i, j));
            for k in 0..LANES {
                missed[k] &= of_region[k];
            }
        }
        missed
    }

    /// The regions that the ray through a texel position meets, and the length in them.
    pub fn met(&self, plane: &BasePlane, ray: &TexelRay) -> RayHits {
        let mut met = RayHits::default();
        for (k, region) in self.regions.iter().enumerate() {
            met.add(k, region.texel_interval(plane, ray));
        }
        met
    }

    /// Whether the ray of a pixel position meets anything.
    pub fn is_met(&self, rays: &IndexRays, is_parallel: bool, [x_px, y_px]: [f64; 2]) -> bool {
        let (origin, direction) = (rays.origin(x_px, y_px), rays.direction(x_px, y_px));
        self.regions.iter().any(|region| region.passage(origin, direction, whole(is_parallel)).length() > 0.0)
    }

    /// Passages of a grid of rays, row by row; one list for each region.
    pub fn passages(&self, rays: &IndexRays, is_parallel: bool, grid: &PixelGrid, into: &mut Vec<Vec<Passage>>) {
        into.resize_with(self.regions.len(), Vec::new);
        for (region, passages) in self.regions.iter().zip(into) {
            passages.clear();
            for [x_px, y_px] in grid.places() {
                let (origin, direction): (DVec3, DVec3) = (rays.origin(x_px, y_px), rays.direction(x_px, y_px));
                passages.push(region.passage(origin, direction, whole(is_parallel)));
            }
        }
    }

    /// Whether a wall is nearly parallel to rays of a base plane, so that it is seen as a strip no wider than the
    /// filter.
    pub fn has_narrow_walls(&self, plane: &BasePlane) -> bool {
        /// Widths of a strip, in texels, below which it is invisible and above which the filter resolves it.
        const NARROW: [f64; 2] = [0.02, 4.0];
        let [axis_u, axis_v, axis_w] = plane.family.axes;
        self.regions.iter().any(|region| {
            let [near, far] = region.bounds.map(|corner| corner[axis_w]);
            region.half_spaces.iter().any(|h| {
                let per_texel = h.normal[axis_u].abs() * plane.step.x + h.normal[axis_v].abs() * plane.step.y;
                let width = match plane.eye_w() {
                    None => {
                        let [su, sv] = plane.ray(0.0, 0.0).slope;
                        let slope = h.normal[axis_u] * su + h.normal[axis_v] * sv + h.normal[axis_w];
                        slope * (far - near)
                    }
                    Some(_) if plane.eye_is_within([near, far]) => return true,
                    Some(eye_w) => {
                        plane.eye_distance(h.normal, h.offset) * (1.0 / (near - eye_w) - 1.0 / (far - eye_w))
                    }
                };
                let texels = width.abs() / per_texel;
                NARROW[0] < texels && texels < NARROW[1]
            })
        })
    }

    /// The silhouette on the texels of a base plane.
    pub fn on<'a>(&'a self, plane: &'a BasePlane) -> PlaneSilhouette<'a> {
        let widened = self.regions.iter().map(|region| region.widened(plane, plane.beyond)).collect();
        PlaneSilhouette { silhouette: self, plane, widened }
    }
}

/// Range of ray parameters of a picture's ray: from the eye on, or unbounded for parallel rays.
fn whole(is_parallel: bool) -> [f64; 2] {
    [if is_parallel { f64::NEG_INFINITY } else { 0.0 }, f64::INFINITY]
}

/// A regular grid of pixel positions.
pub struct PixelGrid {
    /// The first position.
    pub first: [f64; 2],
    /// Distance of neighbouring positions along x and y, in pixels.
    pub distance: [f64; 2],
    /// Number of positions along x and y.
    pub n: [usize; 2],
}

impl PixelGrid {
    /// The corners of a rectangle.
    pub fn corners([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Self { first: [x, y], distance: [width, height], n: [2, 2] }
    }

    fn places(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let at = |axis: usize, k: usize| self.first[axis] + self.distance[axis] * k as f64;
        (0..self.n[1]).flat_map(move |j| (0..self.n[0]).map(move |i| [at(0, i), at(1, j)]))
    }
}

/// Relative tolerance within which lengths count as equal: about the resolution of float32.
pub const LENGTH_TOLERANCE: f64 = 1e-6;

impl RayHits {
    /// Whether another ray meets the same regions for the same length.
    #[inline(always)]
    pub fn is_like(&self, other: &Self) -> bool {
        self.regions == other.regions && (self.length - other.length).abs() <= LENGTH_TOLERANCE * self.length
    }

    fn add(&mut self, region: usize, [lo, hi]: [f64; 2]) {
        if lo < hi {
            self.regions |= 1 << region;
            self.length += hi - lo;
        }
    }
}

impl Coverage {
    /// Coverage of a rectangle by one region, from the passages of the rays of its corners. `size_px`: its shorter
    /// side. `texel_px`: size of a texel, in pixels.
    ///
    /// Where rays enter and leave through the same walls at all corners, they do so everywhere between: linear
    /// functions of the position (of 1/t for rays from an eye) decide which wall is the last to be entered and the
    /// first to be left.
    pub fn of_region(corners: [&Passage; 4], size_px: f64, texel_px: f64) -> Self {
        let lengths = corners.map(Passage::length);
        let n_met = lengths.iter().filter(|length| **length > 0.0).count();
        if n_met == 0 {
            let same = corners.iter().all(|corner| corner.walls == corners[0].walls);
            return if same { Self::Outside } else { Self::Edge };
        }
        if n_met < corners.len() {
            return Self::Edge;
        }
        let least = lengths.into_iter().fold(f64::INFINITY, f64::min);
        let most = lengths.into_iter().fold(0.0, f64::max);
        // No ray's length falls to 0 within the two texels that the filter reads on each side.
        if least >= 2.0 * texel_px * (most - least) / size_px { Self::Inside } else { Self::Edge }
    }

    /// Coverage by several regions together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Edge, _) | (_, Self::Edge) => Self::Edge,
            (Self::Outside, Self::Outside) => Self::Outside,
            _ => Self::Inside,
        }
    }
}

/// A silhouette on the texels of a base plane.
pub struct PlaneSilhouette<'a> {
    silhouette: &'a Silhouette,
    /// The base plane.
    pub plane: &'a BasePlane,
    /// The regions with walls moved outwards, for texels that miss everything.
    widened: Vec<Region>,
}

impl PlaneSilhouette<'_> {
    /// The regions and lengths that `LANES` texels from `(i, j)` on were rendered with. Rays that miss everything
    /// have the widened regions.
    #[inline(always)]
    pub fn rendered(&self, i: f64, j: f64) -> ([u8; LANES], [f64; LANES]) {
        let (mut met, mut length) = self.intervals(&self.silhouette.regions, i, j);
        if met.contains(&0) {
            let (met_beyond, length_beyond) = self.intervals(&self.widened, i, j);
            for k in 0..LANES {
                if met[k] == 0 {
                    (met[k], length[k]) = (met_beyond[k], length_beyond[k]);
                }
            }
        }
        (met, length)
    }

    #[inline(always)]
    fn intervals(&self, regions: &[Region], i: f64, j: f64) -> ([u8; LANES], [f64; LANES]) {
        let (mut met, mut length) = ([0; LANES], [0.0; LANES]);
        for (bit, region) in regions.iter().enumerate() {
            let [lo, hi] = region.texel_intervals(self.plane, i, j);
            for k in 0..LANES {
                let is_met = lo[k] < hi[k];
                met[k] |= u8::from(is_met) << bit;
                length[k] += if is_met { hi[k] - lo[k] } else { 0.0 };
            }
        }
        (met, length)
    }

    /// The regions that the ray through a texel position meets, and the length in them.
    pub fn met(&self, [u, v]: [f64; 2]) -> RayHits {
        self.silhouette.met(self.plane, &self.plane.ray(u, v))
    }
}
