//! Part of a frame that one process draws ([`crate::view::part`]), and what it must know of the others' matter.
//!
//! Light on cut faces ([`crate::ray::cut_faces`]) depends on the matter that a ray meets where it enters the volume,
//! which may be in another process's part. That matter is
//! found in the samples that the survey of the whole volume keeps for light.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::simd::LANES;

use crate::optics::visibility_cache::TabulatedFunction;
use crate::ray::cut_faces::{NEAR, NO_ENTRY, entry_at_cut};
use crate::sheet::tile_rays::Rays;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use crate::view::part::Part;

/// Ways behind a cut, in slices, at which matter is looked for.
const BEHIND: [f32; 4] = [NEAR / 3.0, 2.0 * NEAR / 3.0, NEAR, 4.0 * NEAR / 3.0];

/// A part, and the matter of the whole volume.
pub struct PartPlan {
    /// The part of space that is drawn.
    pub part: Part,
    slices: Slices<'static>,
    tables: Arc<TabulatedFunction>,
}

impl PartPlan {
    /// Plan of a part. `slices`: of a survey of the whole volume; `tables`: of its transfer function.
    pub fn new(part: Part, slices: Slices<'static>, tables: Arc<TabulatedFunction>) -> Self {
        Self { part, slices, tables }
    }

    /// Sets what rays have met in another part, for rays that entered the volume there. `first`: first texel of the
    /// tile.
    pub fn tell_entries(&self, rays: &mut Rays, plane: &BasePlane, first: [usize; 2]) {
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        rays.set_outer_entries(|chunk, lane, entered, thickness| {
            let ray = plane.ray((first[0] + chunk.strip * LANES + lane) as f64, (first[1] + chunk.row) as f64);
            let depth_behind = |behind: f32| {
                let w = sign * f64::from(entered + behind);
                let uvw = [ray.at_zero[0] + ray.slope[0] * w, ray.at_zero[1] + ray.slope[1] * w, w];
                let mut index = DVec3::ZERO;
                plane.family.axes.into_iter().zip(uvw).for_each(|(axis, at)| index[axis] = at);
                let density = self.slices.strided_density(index);
                density.map_or(0.0, |density| self.tables.look_up_one(density)[3] * thickness)
            };
            let entries = BEHIND.map(|behind| entry_at_cut(entered, behind, depth_behind(behind)));
            entries.into_iter().fold(NO_ENTRY, f32::max)
        });
    }
}
