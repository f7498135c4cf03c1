//! Empty-space skipping of the ray caster.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_splat::kernel::weights::{mirror_index, overshoot, radius};

use super::sampler::Sampler;

/// Side of the blocks that are skipped where nothing in them is visible, in cells.
const BLOCK: usize = 4;

/// Flags of the blocks of cells that can hold a visible density. Skipping the others is exact, since kernels with
/// non-negative weights stay inside the range of the samples they reach; for Catmull-Rom the range is widened by its
/// largest overshoot in 3-D.
pub(super) struct ActiveBlocks {
    active: Vec<bool>,
    n: [usize; 3],
}

impl ActiveBlocks {
    pub(super) fn new(sampler: &Sampler, size: [usize; 3]) -> Self {
        let n = size.map(|s| (s - 1).div_ceil(BLOCK).max(1));
        let reach = radius(sampler.slices.kernel()).ceil() as i64 - 1;
        let planes = parallel::map(n[2], |bz| {
            let mut plane = Vec::with_capacity(n[0] * n[1]);
            for by in 0..n[1] {
                for bx in 0..n[0] {
                    plane.push(Self::block_is_active(sampler, size, [bx, by, bz], reach));
                }
            }
            plane
        });
        Self { active: planes.concat(), n }
    }

    fn block_is_active(sampler: &Sampler, size: [usize; 3], block: [usize; 3], reach: i64) -> bool {
        let span = |axis: usize| {
            let lo = (block[axis] * BLOCK) as i64 - reach;
            let hi = ((block[axis] + 1) * BLOCK) as i64 + reach;
            (lo..=hi).map(move |i| mirror_index(sampler.slices.kernel(), i, size[axis]))
        };
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for z in span(2) {
            for y in span(1) {
                for x in span(0) {
                    let d = sampler.slices.at([x, y, z]);
                    lo = lo.min(d);
                    hi = hi.max(d);
                }
            }
        }
        let over = f64::from(overshoot(sampler.slices.kernel())) * (hi - lo);
        let (offset, scale) = sampler.density_map;
        let [lo, hi] = [lo - over, hi + over].map(|d| d / scale + offset);
        // A piecewise-linear curve is 0 over an interval if it is 0 at its ends and at the nodes inside.
        let inside = sampler.tf.opacity_nodes().iter().filter(|n| n.value >= lo && n.value <= hi);
        sampler.tf.opacity(lo) > 0.0 || sampler.tf.opacity(hi) > 0.0 || inside.into_iter().any(|n| n.opacity > 0.0)
    }

    pub(super) fn is_active(&self, position: DVec3) -> bool {
        let block = |axis: usize| ((position[axis].max(0.0) / BLOCK as f64) as usize).min(self.n[axis] - 1);
        self.active[block(0) + self.n[0] * (block(1) + self.n[1] * block(2))]
    }
}
