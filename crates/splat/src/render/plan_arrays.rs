//! Plan of a base plane as plain arrays, for backends that do not share the CPU's code.
//!
//! The CPU computes the same numbers tile by tile as it goes ([`crate::render::tile`]).

use wavesplat_compute::simd::LANES;
use wavesplat_core::Kernel;

use crate::kernel::footprint::{Axis, AxisFootprints};
use crate::kernel::slice_taps::SliceTap;
use crate::render::plan::{FamilyPlan, Plan};
use crate::render::tile::{TileJob, n_tiles};
use crate::sheet::tile_layout::{BlockMask, Chunk, N_STRIPS, TILE_U, TILE_V, blocks_with};
use crate::sheet::tile_rays::{DirectionForms, Rays};
use crate::source::geometry::SheetGeometry;
use crate::source::slices::Slices;

/// Footprints of a tile on a sheet.
pub struct TileFootprints {
    /// Footprints of the texel columns along u and of the rows along v, with the difference footprints of gradients.
    pub axes: [AxisFootprints; 2],
    /// Slices whose weighted sum is the sheet, with their weights.
    pub slices: Vec<SliceTap>,
    /// Slices and weights for the derivative through the sheet.
    pub slice_differences: Vec<SliceTap>,
    /// Slices and weights for the derivatives along the sheet, for smoothed gradients; empty where gradients are of the
    /// kernel's own values.
    pub slice_smooth: Vec<SliceTap>,
}

impl FamilyPlan {
    /// Positions of the sheets along w, in slices: the first on the first slice, the last on the last.
    pub fn sheet_positions(&self) -> Vec<f64> {
        (0..=self.spacing.n_slabs).map(|sheet| self.spacing.w(sheet)).collect()
    }

    /// Footprints of a tile on the sheet at `w`, in a layer's samples.
    pub fn footprints(&self, plan: &Plan, layer: usize, kernel: Kernel, tile: [usize; 2], w: f64) -> TileFootprints {
        let (size, map) = (plan.layers[layer].grid.size(), plan.layers[layer].map);
        let axis = |a: usize| Axis { kernel, n_samples: size[a], gradient: self.layers[layer].gradient };
        let axes = self.plane.family.axes;
        let [u, v, across] = axes.map(axis);
        let own = |a: usize, (x, dx): (f64, f64)| (map[a].0 + map[a].1 * x, map[a].1 * dx);
        let [along_u, along_v] = self.plane.sheet(w);
        let [(u0, du), (v0, dv)] = [own(axes[0], along_u), own(axes[1], along_v)];
        let (w, _) = own(axes[2], (w, 1.0));
        let mut axes = [AxisFootprints::default(), AxisFootprints::default()];
        let [along_u, along_v] = &mut axes;
        let all = |n: usize| (1 << n) - 1;
        along_u.build(&u, [u0 + du * (tile[0] * TILE_U) as f64, du], N_STRIPS, all(N_STRIPS));
        along_v.build(&v, [v0 + dv * (tile[1] * TILE_V) as f64, dv], TILE_V / LANES, all(TILE_V / LANES));
        axes.iter_mut().for_each(AxisFootprints::make_difference);
        let (slices, differences) = (across.slice_taps(w), across.slice_difference_taps(w));
        let slice_smooth = across.slice_smooth_taps(w).map_or(Vec::new(), |taps| taps.to_vec());
        TileFootprints { axes, slices: slices.to_vec(), slice_differences: differences.to_vec(), slice_smooth }
    }

    /// Interval of each ray of a tile in which it draws a layer, block by block: first and last position along the ray
    /// (slice coordinate w, with the sign that makes it grow away from the eye); first >= last where it draws nothing.
    pub fn ray_intervals(&self, plan: &Plan, layer: usize, tile: [usize; 2]) -> Vec<[f32; 2]> {
        let geometry = self.ray_geometry(plan, &plan.layers[layer]);
        let (rays, _) = Rays::new(&geometry, plan.simd, [tile[0] * TILE_U, tile[1] * TILE_V]);
        intervals_of(&rays)
    }
}

/// Arrays of a base plane and its samples, computed tile by tile.
pub struct BasePlaneArrays<'a> {
    plan: &'a Plan,
    job: TileJob<'a>,
}

/// Blocks, ray intervals and slabs of a tile that are drawn.
pub struct TileArrays {
    /// Blocks that the picture needs, and in which a ray may see something.
    pub blocks: BlockMask,
    /// Interval of s that each ray draws, block by block and in a block row by row: of all layers together, then, if
    /// there are several, of each layer; first >= last where it draws nothing.
    pub intervals: Vec<Vec<[f32; 2]>>,
    /// Per layer: the active slabs, by their number in the order of the rays, and the blocks in which they are active.
    pub slabs: Vec<Vec<(usize, BlockMask)>>,
}

impl<'a> BasePlaneArrays<'a> {
    /// Arrays of base plane `family` of a plan. `slices`: per layer.
    pub fn new(plan: &'a Plan, family: usize, slices: &[&'a Slices<'a>]) -> Self {
        Self { plan, job: TileJob::new(plan, &plan.families[family], slices) }
    }

    /// Number of tiles along u and v.
    pub fn n_tiles(&self) -> [usize; 2] {
        n_tiles(&self.job.family.plane)
    }

    /// Geometry of a layer: where its samples lie on the sheets.
    pub fn layer(&self, layer: usize) -> &SheetGeometry<'a> {
        &self.job.layers[layer].geometry
    }

    /// Geometry of a field: where its samples lie on the sheets.
    pub fn field(&self, field: usize) -> &SheetGeometry<'a> {
        &self.job.fields[field]
    }

    /// Directions of the rays; their lengths are to be divided by the layer's opacity unit.
    pub fn direction_forms(&self, layer: usize) -> DirectionForms {
        self.job.layers[layer].rays.direction_forms()
    }

    /// Computes the arrays of a tile.
    pub fn tile(&self, tile: [usize; 2]) -> TileArrays {
        let job = &self.job;
        let spacing = &job.family.spacing;
        let first = [tile[0] * TILE_U, tile[1] * TILE_V];
        let nothing = TileArrays { blocks: 0, intervals: Vec::new(), slabs: Vec::new() };
        let needed = job.needed_blocks(first);
        if needed == 0 {
            return nothing;
        }
        let is_mixed = job.layers.len() > 1;
        let (rays, span) = Rays::new(&job.rays, self.plan.simd, first);
        let alive = needed & blocks_with(|chunk| !rays.draws_nothing(chunk));
        let (mut intervals, mut slabs, mut blocks) = (vec![intervals_of(&rays)], Vec::new(), 0);
        for layer in &job.layers {
            let (mut range, mut own_alive) = (spacing.range(span), alive);
            if is_mixed {
                let (own, span) = Rays::new(&layer.rays, self.plan.simd, first);
                range = spacing.range(span);
                own_alive &= blocks_with(|chunk| !own.draws_nothing(chunk));
                intervals.push(intervals_of(&own));
            }
            let bricks = layer.active_layers(first);
            let own = if bricks.contains(&true) {
                layer.active_slabs(spacing, first, range, &(0..usize::MAX), &bricks, own_alive)
            } else {
                Vec::new()
            };
            blocks |= own.iter().fold(0, |all, slab| all | slab.blocks);
            slabs.push(own.iter().map(|slab| (slab.place, slab.blocks)).collect());
        }
        if blocks == 0 { nothing } else { TileArrays { blocks, intervals, slabs } }
    }
}

fn intervals_of(rays: &Rays) -> Vec<[f32; 2]> {
    let mut intervals = Vec::with_capacity(TILE_U * TILE_V);
    for strip in 0..N_STRIPS {
        for row in 0..TILE_V {
            let [from, to] = rays.lanes(Chunk { strip, row });
            intervals.extend(from.0.iter().zip(&to.0).map(|(from, to)| [*from, *to]));
        }
    }
    intervals
}
