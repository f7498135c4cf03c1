//! Which parts of the volume can be seen: least and largest density of every brick of 4 x 4 x 4 cells.
//!
//! The bounds are built once per volume and kernel, at memory speed, and take 1/16 of a byte per sample. For a
//! transfer function they become one bit per brick, and "is anything visible below this part of this sheet" is a
//! question of a few words. Bounds hold for all positions inside a brick: they cover the samples that the kernel
//! reaches from there, widened where the kernel overshoots. They are kept in 4096 levels of the volume's range, rounded
//! outwards.

use wavesplat_compute::parallel;
use wavesplat_core::Kernel;

use crate::kernel::{n_taps, overshoot, reach};

/// Cells of a brick along each axis.
pub const BRICK: usize = 4;

/// Levels of the density range.
const N_LEVELS: usize = 4096;

/// Least and largest density of every brick, `[z][y][x]`.
#[derive(Clone, Debug)]
pub struct Bricks {
    n: [usize; 3],
    range: [f32; 2],
    bounds: Vec<[u16; 2]>,
}

/// Where a kernel reads samples: of a grid of `size`, the row of `nx` samples that begins at an index, as densities.
pub trait Rows: Sync {
    /// Writes the lesser (larger) of `lo` (`hi`) and the row's densities.
    fn widen(&self, start: usize, lo: &mut [f32], hi: &mut [f32]);
}

impl Bricks {
    /// Reads every row about 1.6 times. `range` bounds the densities.
    pub fn new(rows: &impl Rows, [nx, ny, nz]: [usize; 3], kernel: Kernel, range: [f32; 2]) -> Self {
        let n = [nx, ny, nz].map(|n| (n - 1).div_ceil(BRICK));
        // Samples that positions inside a brick reach: from `reach` before its first to as many after its last.
        let before = reach(kernel);
        let after = n_taps(kernel) - 1 - before;
        let samples = |brick: usize, n: usize| {
            let first = brick * BRICK;
            first.saturating_sub(before)..(first + BRICK + after).min(n)
        };
        let widened = overshoot(kernel);
        let extent = range[1] - range[0];
        let per_density = if extent > 0.0 { (N_LEVELS - 1) as f32 / extent } else { 0.0 };
        let layers = parallel::map(n[2], |bz| {
            let mut layer = Vec::with_capacity(n[0] * n[1]);
            let (mut lo, mut hi) = (vec![0.0_f32; nx], vec![0.0_f32; nx]);
            for by in 0..n[1] {
                lo.fill(f32::INFINITY);
                hi.fill(f32::NEG_INFINITY);
                for z in samples(bz, nz) {
                    for y in samples(by, ny) {
                        rows.widen(nx * (y + ny * z), &mut lo, &mut hi);
                    }
                }
                for bx in 0..n[0] {
                    let reached = samples(bx, nx);
                    let lo = lo[reached.clone()].iter().fold(f32::INFINITY, |a, b| a.min(*b));
                    let hi = hi[reached].iter().fold(f32::NEG_INFINITY, |a, b| a.max(*b));
                    let over = widened * (hi - lo);
                    let level = |d: f32| ((d - range[0]) * per_density).clamp(0.0, (N_LEVELS - 1) as f32);
                    layer.push([level(lo - over).floor() as u16, level(hi + over).ceil() as u16]);
                }
            }
            layer
        });
        Self { n, range, bounds: layers.concat() }
    }

    /// Density of a level.
    fn density(&self, level: usize) -> f32 {
        self.range[0] + level as f32 / (N_LEVELS - 1) as f32 * (self.range[1] - self.range[0])
    }

    /// The bricks whose range of densities passes a test, laid out for sheets along `axes` (u, v, w). The test must
    /// hold for a range when it holds for a part of it.
    pub fn occupied(&self, axes: [usize; 3], test: impl Fn([f32; 2]) -> bool) -> Occupied {
        // `passing[l]`: how many steps from level to level below l pass. The outer levels stand for all beyond them.
        let mut passing = vec![0_u16; N_LEVELS + 1];
        for level in 0..N_LEVELS {
            let from = if level == 0 { f32::NEG_INFINITY } else { self.density(level - 1) };
            let to = if level + 1 == N_LEVELS { f32::INFINITY } else { self.density(level + 1) };
            // A level more on either side: the bounds were rounded.
            passing[level + 1] = passing[level] + u16::from(test([from, to]));
        }
        let n = axes.map(|a| self.n[a]);
        let n_words = n[0].div_ceil(64);
        let mut occupied = Occupied { n, n_words, bits: vec![0; n_words * n[1] * n[2]] };
        let [nx, ny, _] = self.n;
        let place = [0, 1, 2].map(|a| axes.iter().position(|axis| *axis == a).unwrap_or(a));
        for (i, [lo, hi]) in self.bounds.iter().enumerate() {
            if passing[usize::from(*hi) + 1] > passing[usize::from(*lo)] {
                let brick = [i % nx, i / nx % ny, i / (nx * ny)];
                let mut uvw = [0; 3];
                for a in 0..3 {
                    uvw[place[a]] = brick[a];
                }
                occupied.bits[(uvw[2] * n[1] + uvw[1]) * n_words + uvw[0] / 64] |= 1 << (uvw[0] % 64);
            }
        }
        occupied
    }
}

/// One bit per brick, in runs along u.
#[derive(Clone, Debug)]
pub struct Occupied {
    n: [usize; 3],
    n_words: usize,
    bits: Vec<u64>,
}

impl Occupied {
    /// First and last brick that positions of an axis (0: u, 1: v), in samples, touch; `None` outside the volume.
    #[inline(always)]
    pub fn touched(&self, axis: usize, [lo, hi]: [f64; 2]) -> Option<[usize; 2]> {
        let n = self.n[axis];
        // Comparisons that are false for NaN count as outside.
        let touches = hi >= 0.0 && lo <= (n * BRICK) as f64;
        touches.then(|| [(lo.max(0.0) as usize / BRICK).min(n - 1), (hi as usize / BRICK).min(n - 1)])
    }

    /// Whether any of the bricks `u[0]..=u[1]`, `v[0]..=v[1]` is occupied in the layers `w[0]..=w[1]`.
    #[inline(always)]
    pub fn any(&self, u: [usize; 2], v: [usize; 2], w: [usize; 2]) -> bool {
        let (first, last) = (u[0] / 64, u[1] / 64);
        for layer in w[0]..=w[1].min(self.n[2] - 1) {
            for row in v[0]..=v[1] {
                let words = &self.bits[(layer * self.n[1] + row) * self.n_words..][..self.n_words];
                for k in first..=last {
                    let before = if k == first { u[0] % 64 } else { 0 };
                    let after = if k == last { 63 - u[1] % 64 } else { 0 };
                    if words[k] << after >> after >> before != 0 {
                        return true;
                    }
                }
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{fold, taps};
    use crate::slices::Slices;
    use wavesplat_testkit::Phantom;

    /// Densities reconstructed anywhere in a brick lie within its bounds, so that leaving it out changes nothing.
    #[test]
    fn bounds_hold_everywhere_in_a_brick() {
        let size = [11, 9, 14];
        let noise = |p: glam::DVec3| ((p.x * 12.9 + p.y * 78.2 + p.z * 37.7).sin() * 4375.8).fract() * 100.0;
        let phantom = Phantom::sample(size, glam::DAffine3::IDENTITY, noise);
        let volume = phantom.volume();
        for (name, kernel) in Kernel::NAMES {
            let slices = Slices::new(&volume, kernel);
            let bricks = slices.bricks();
            for i in 0..4000 {
                let share = |k: i32| (f64::from(i * 7919 % 4001) * 0.618 * f64::from(k)).fract();
                let position: [f64; 3] = std::array::from_fn(|a| share(a as i32 + 1) * (size[a] - 1) as f64);
                let tapped = position.map(|x| taps(kernel, x));
                let mut density = 0.0;
                for t in 0..64 {
                    let which = [t % 4, t / 4 % 4, t / 16];
                    let weight: f64 = (0..3).map(|a| tapped[a].1[which[a]]).product();
                    if weight != 0.0 {
                        let index = std::array::from_fn(|a| fold(kernel, tapped[a].0 + which[a] as i64, size[a]));
                        density += weight * slices.at(index);
                    }
                }
                let brick: [usize; 3] = std::array::from_fn(|a| (position[a] as usize).min(size[a] - 2) / BRICK);
                let bounds = bricks.bounds[brick[0] + bricks.n[0] * (brick[1] + bricks.n[1] * brick[2])];
                let [lo, hi] = bounds.map(|level| f64::from(bricks.density(usize::from(level))));
                // Spline coefficients of the ends are folded into the brick's own samples; f32 rounds.
                assert!(lo - 1e-5 <= density && density <= hi + 1e-5, "{name} {position:?}: {density} in {lo}..{hi}");
            }
        }
    }

    #[test]
    fn an_occupied_brick_is_found_from_all_sides() {
        let phantom = Phantom::sample([300, 20, 9], glam::DAffine3::IDENTITY, |p| {
            if p == glam::DVec3::new(270.0, 13.0, 5.0) { 1.0 } else { 0.0 }
        });
        let slices = Slices::new(&phantom.volume(), Kernel::Linear);
        for (axes, place) in [([0, 1, 2], [270.0, 13.0, 5.0]), ([1, 2, 0], [13.0, 5.0, 270.0])] {
            let occupied = slices.bricks().occupied(axes, |[_, hi]| hi > 0.5);
            let at = |shift: f64| {
                let around = |x: f64| [x + shift - 1.5, x + shift + 1.5];
                let layer = (place[2] / BRICK as f64) as usize;
                let (u, v) = (occupied.touched(0, around(place[0])), occupied.touched(1, around(place[1])));
                matches!((u, v), (Some(u), Some(v)) if occupied.any(u, v, [layer; 2]))
            };
            assert!(at(0.0) && !at(-7.0) && !at(100.0), "{axes:?}");
            assert!(!occupied.any([0, 0], [0, 0], [0, 0]));
        }
    }
}
