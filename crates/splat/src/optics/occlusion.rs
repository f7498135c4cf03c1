//! Ambient occlusion and shadows: light swept through a coarse extinction grid of the volume.
//!
//! Gradients alone make flat pictures: a hollow is as bright as a ridge. Both kinds of light are worked out once per
//! transfer function on a coarse copy of the volume, as shares of light that get to its cells, and are fields of the
//! picture ([`crate::sheet::field_sheets`]).
//!
//! A share is swept through the coarse volume slice by slice, as light travels: the light that leaves a slice is the
//! light that got there times `exp(−τ ℓ)`, and the next slice gets it shifted by the slope of the light, just as sheets
//! are sheared for the eye. The shadow is one sweep along the first light. The openness of a place is the mean over
//! directions all around, with light that comes back over the distance `radius`, so that only what is near occludes, as
//! in Hernell, Ljung, Ynnerman, *Local ambient occlusion in direct volume rendering* (2010). A flat face sees half of
//! the directions: that counts as open.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{LANES, Level, Simd, VectorKernel};
use wavesplat_core::{Grid, Result, Samples, Volume};

use crate::optics::classify::{Classifier, one_minus_exp_neg};
use crate::optics::labels::{Labels, own_depth};
use crate::source::field::Field;
use crate::source::slices::Slices;
use crate::source::strided::light_steps;
use wavesplat_core::Kernel;

/// Directions averaged for openness.
const N_DIRECTIONS: usize = 32;

/// Parallel parts into which the directions along each axis are split.
const N_AXIS_PARTS: usize = 3;

/// Largest mean opacity of a cell, which keeps its extinction finite.
const OPAQUE_OPACITY: f64 = 0.9999;

/// Fields that hold light, each with its strength, `0..=1`.
#[derive(Clone, Copy, Debug, Default)]
pub struct LightFields {
    /// Openness of a place.
    pub openness: Option<(usize, f32)>,
    /// Share of the first light that gets to a place.
    pub shadow: Option<(usize, f32)>,
}

/// The coarse volume: how much each of its cells dims light.
pub struct ExtinctionGrid {
    /// Optical depth per world unit, `[z][y][x]`.
    extinction: Vec<f32>,
    grid: Grid,
    /// Samples of the volume per cell, along x, y, z.
    per_cell: [usize; 3],
}

impl ExtinctionGrid {
    /// Averages the extinction of a classified volume over coarse cells. `opacity_unit`: world units.
    pub fn new(slices: &Slices, classifier: &Classifier, opacity_unit: f64, labels: Option<&Labels>) -> Result<Self> {
        let grid = slices.grid();
        let size @ [nx, ny, nz] = grid.size();
        let (per_cell, skip) = light_steps(grid);
        let n = [0, 1, 2].map(|a| size[a].div_ceil(per_cell[a]));
        // Averages opacities of a sample's own length, not optical depths: an opaque wall then counts by its area
        // alone.
        let length = grid.mean_spacing();
        let per_unit = (length / opacity_unit) as f32;
        let looks: Vec<[f32; 2]> = labels
            .map_or(Vec::new(), |l| l.looks.iter().map(|look| [look.scan as f32, own_depth(look) as f32]).collect());
        let layers = parallel::map(n[2], |cz| {
            let mut sums = vec![[0.0_f32; 2]; n[0] * n[1]];
            let mut slice = Vec::new();
            let first = (cz * per_cell[2]).next_multiple_of(skip[2]);
            for z in (first..((cz + 1) * per_cell[2]).min(nz)).step_by(skip[2]) {
                slices.strided_slice(z, skip, &mut slice);
                let rows = slice.chunks_exact(nx.div_ceil(skip[0]));
                for (y, row) in (0..ny).step_by(skip[1]).zip(rows) {
                    for (x, density) in (0..nx).step_by(skip[0]).zip(row) {
                        let mut depth = classifier.look_up_one(*density)[3];
                        if let Some(labels) = labels {
                            let [scan, own] = looks[labels.codes.get((z * ny + y) * nx + x)];
                            depth = depth * scan + own;
                        }
                        let [sum, count] = &mut sums[y / per_cell[1] * n[0] + x / per_cell[0]];
                        *sum += 1.0 - (-depth * per_unit).exp();
                        *count += 1.0;
                    }
                }
            }
            let extinction = |[sum, count]: [f32; 2]| {
                let mean = f64::from(sum / count.max(1.0)).min(OPAQUE_OPACITY);
                (-(-mean).ln_1p() / length) as f32
            };
            sums.into_iter().map(extinction).collect::<Vec<_>>()
        });
        let extinction = layers.concat();
        let world_from_index = grid.world_from_index();
        let step = |a: usize| world_from_index.matrix3.col(a) * per_cell[a] as f64;
        let mut coarse = world_from_index;
        coarse.matrix3 = glam::DMat3::from_cols(step(0), step(1), step(2));
        let middle = |a: usize| (per_cell[a] as f64 - 1.0) / 2.0;
        coarse.translation = world_from_index.transform_point3(DVec3::new(middle(0), middle(1), middle(2)));
        let volume = Volume::new("light", Samples::F32(&extinction), n, coarse)?;
        let grid = volume.grid().clone();
        Ok(Self { extinction, grid, per_cell })
    }

    /// Adds the extinction of another layer, where it lies in the world: extinctions of media add.
    pub fn add(&mut self, other: &Self) {
        let other_from_own = other.grid.index_from_world() * self.grid.world_from_index();
        let [nx, ny, _] = self.grid.size();
        for (i, extinction) in self.extinction.iter_mut().enumerate() {
            let cell = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / (nx * ny)) as f64);
            *extinction += other.at(other_from_own.transform_point3(cell));
        }
    }

    /// Extinction at a position, trilinear; 0 from half a cell outside on.
    fn at(&self, position: DVec3) -> f32 {
        let size = self.grid.size();
        let last = self.grid.last_index();
        if (position + 0.5).cmplt(DVec3::ZERO).any() || (position - 0.5).cmpgt(last).any() {
            return 0.0;
        }
        let position = position.clamp(DVec3::ZERO, last);
        let first = position.to_array().map(|x| x as usize);
        let share = (position - position.floor()).to_array();
        let mut sum = 0.0;
        for corner in 0..8 {
            let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3).map(|a| if bits[a] == 1 { share[a] } else { 1.0 - share[a] }).product();
            let at = [0, 1, 2].map(|a| (first[a] + bits[a]).min(size[a] - 1));
            sum += weight as f32 * self.extinction[(at[2] * size[1] + at[1]) * size[0] + at[0]];
        }
        sum
    }

    /// Share of a light that gets to each cell; `to_light` in world space.
    pub fn shadow(&self, to_light: DVec3) -> Vec<f32> {
        let way = self.way(-to_light, None);
        let lying = CellLayout::new(self, way.axis);
        let mut share = vec![0.0; lying.extinction.len()];
        lying.add_share(&way, &mut share);
        self.cell_by_cell(|place| share[lying.place(place)])
    }

    /// Openness of each cell: 1 where nothing is near on one side at least. `radius`: world units.
    pub fn openness(&self, radius: f64) -> Vec<f32> {
        let ways: Vec<SweepDirection> = (0..N_DIRECTIONS).map(|i| self.way(direction(i), Some(radius))).collect();
        let lying = [0, 1, 2].map(|axis| CellLayout::new(self, axis));
        // Neither the directions of a part nor the order in which parts are added depends on the threads, so sums keep
        // their bits.
        let mut parts = parallel::map(3 * N_AXIS_PARTS, |part| {
            let lying = &lying[part % 3];
            let mut sum = vec![0.0; lying.extinction.len()];
            let along = ways.iter().filter(|way| way.axis == part % 3);
            along.skip(part / 3).step_by(N_AXIS_PARTS).for_each(|way| lying.add_share(way, &mut sum));
            sum
        });
        let (sums, rest) = parts.split_at_mut(3);
        for (part, more) in rest.iter().enumerate() {
            sums[part % 3].iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        let [x, y, z] = &lying;
        self.cell_by_cell(|cell| {
            let sum = sums[0][x.place(cell)] + sums[1][y.place(cell)] + sums[2][z.place(cell)];
            // Twice the mean: a flat face sees half of the directions, and counts as open.
            (sum * (2.0 / N_DIRECTIONS as f32)).min(1.0)
        })
    }

    /// Evaluates `number` for every cell, `[z][y][x]`.
    fn cell_by_cell(&self, number: impl Fn([usize; 3]) -> f32 + Sync + Send) -> Vec<f32> {
        let [nx, ny, nz] = self.grid.size();
        let mut numbers = vec![0.0; nx * ny * nz];
        parallel::for_each_chunk(&mut numbers, nx * ny, |z, layer| {
            for (y, row) in layer.chunks_exact_mut(nx).enumerate() {
                for (x, cell) in row.iter_mut().enumerate() {
                    *cell = number([x, y, z]);
                }
            }
        });
        numbers
    }

    /// Sweep of light along a world direction; with a radius, dimmed light comes back over that distance.
    fn way(&self, direction: DVec3, radius: Option<f64>) -> SweepDirection {
        let along = self.grid.index_from_world().matrix3 * direction;
        let axis = (0..3).fold(0, |best, a| if along[a].abs() > along[best].abs() { a } else { best });
        let per_slice = along[axis].abs();
        let length = direction.length() / per_slice;
        let kept = radius.map_or(1.0, |radius| (-length / radius).exp() as f32);
        SweepDirection {
            axis,
            ascending: along[axis] > 0.0,
            slope: across(axis).map(|a| along[a] / per_slice),
            length: length as f32,
            kept,
        }
    }

    /// A field from one number per cell.
    pub fn field(&self, numbers: Vec<f32>) -> Result<Field<'static>> {
        let (size, world_from_index) = (self.grid.size(), self.grid.world_from_index());
        let statistics = wavesplat_core::Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        // Numbers are densities: from 0 to 1 already.
        let grid = Grid::new("light", size, world_from_index, statistics, true)?;
        let from_index = self.per_cell.map(|n| {
            let per_index = 1.0 / n as f64;
            (0.5 * per_index - 0.5, per_index)
        });
        Ok(Field { slices: Slices::of_densities(numbers, &grid, Kernel::Linear), from_index, gradient: None })
    }
}

/// Direction of a sweep of light through the coarse volume.
struct SweepDirection {
    /// Axis that light runs most along, and whether upwards.
    axis: usize,
    ascending: bool,
    /// Cells that light moves per slice along the other two axes: at most 1 either way.
    slope: [f64; 2],
    /// World length per slice.
    length: f32,
    /// Share of a shadow that is left after a slice; 1 where no light comes back.
    kept: f32,
}

/// The two other axes.
fn across(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

/// The coarse volume in slices across one axis, in rows of whole vectors.
struct CellLayout {
    /// Cells along the rows, across them, and along the axis.
    n: [usize; 3],
    /// Numbers from row to row.
    stride: usize,
    /// Numbers from cell to cell along x, y, z.
    strides: [usize; 3],
    extinction: Vec<f32>,
}

/// Border of cells around a slice: light comes from a cell away at most, and is mixed from two cells.
const MARGIN: usize = 2;

impl CellLayout {
    fn new(dimness: &ExtinctionGrid, axis: usize) -> Self {
        let size @ [nx, ny, _] = dimness.grid.size();
        let [u, v] = across(axis);
        let n = [size[u], size[v], size[axis]];
        let stride = n[0].next_multiple_of(LANES);
        let mut strides = [1; 3];
        strides[v] = stride;
        strides[axis] = stride * n[1];
        let mut extinction = vec![0.0; stride * n[1] * n[2]];
        let from = [1, nx, nx * ny];
        parallel::for_each_chunk(&mut extinction, stride * n[1], |k, slice| {
            for (j, row) in slice.chunks_exact_mut(stride).enumerate() {
                let first = k * from[axis] + j * from[v];
                for (i, cell) in row[..n[0]].iter_mut().enumerate() {
                    *cell = dimness.extinction[first + i * from[u]];
                }
            }
        });
        Self { n, stride, strides, extinction }
    }

    /// Place of a cell in the layout.
    #[inline(always)]
    fn place(&self, [x, y, z]: [usize; 3]) -> usize {
        x * self.strides[0] + y * self.strides[1] + z * self.strides[2]
    }

    /// Adds the share of the entering light that gets to each cell, before the cell itself dims it.
    fn add_share(&self, way: &SweepDirection, sum: &mut [f32]) {
        let [_, n_v, n_w] = self.n;
        let wide = self.stride + 2 * MARGIN;
        // Light from beyond the sides is not dimmed.
        let mut leaving = vec![1.0; wide * (n_v + 2 * MARGIN)];
        let mut next = leaving.clone();
        // Slices lie across the axis that light runs most along, so it moves a cell at most per slice: all light of a
        // cell comes from four neighbouring cells of the slice before.
        // Where light comes from in the slice before, along both axes: the lower one of two cells, and the upper one's
        // weight.
        let back = way.slope.map(|slope| {
            let below = (-slope).floor();
            ((MARGIN as i64 + below as i64) as usize, (-slope - below) as f32)
        });
        let plane = self.stride * n_v;
        for k in 0..n_w {
            let first = if way.ascending { k } else { n_w - 1 - k } * plane;
            Level::best().dispatch(SliceSweep {
                extinction: &self.extinction[first..first + plane],
                sum: &mut sum[first..first + plane],
                leaving: &leaving,
                next: &mut next,
                stride: self.stride,
                back,
                way,
            });
            std::mem::swap(&mut leaving, &mut next);
        }
    }
}

/// Kernel that passes light through one slice.
struct SliceSweep<'a> {
    extinction: &'a [f32],
    sum: &'a mut [f32],
    /// Light that left the slice before, and that leaves this one, each with a border of [`MARGIN`].
    leaving: &'a [f32],
    next: &'a mut [f32],
    stride: usize,
    back: [(usize, f32); 2],
    way: &'a SweepDirection,
}

impl VectorKernel for SliceSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { extinction, sum, leaving, next, stride, back: [(du, tu), (dv, tv)], way } = self;
        let wide = stride + 2 * MARGIN;
        let one = s.splat(1.0);
        let rows = extinction.chunks_exact(stride).zip(sum.chunks_exact_mut(stride)).enumerate();
        for (j, (extinction, sum)) in rows {
            let low = &leaving[(j + dv) * wide + du..][..=stride];
            let high = &leaving[(j + dv + 1) * wide + du..][..=stride];
            let next = &mut next[(j + MARGIN) * wide + MARGIN..][..stride];
            for i in (0..stride).step_by(LANES) {
                let low = mixed(s, tu, load(s, low, i), load(s, low, i + 1));
                let high = mixed(s, tu, load(s, high, i), load(s, high, i + 1));
                let light = mixed(s, tv, low, high);
                let light = s.sub(one, s.mul(s.sub(one, light), s.splat(way.kept)));
                let dimmed = one_minus_exp_neg(s, s.mul(load(s, extinction, i), s.splat(way.length)));
                store(s, s.add(load(s, sum, i), light), sum, i);
                store(s, s.sub(light, s.mul(light, dimmed)), next, i);
            }
        }
    }
}

/// Linear interpolation from `a` to `b`.
#[inline(always)]
fn mixed<S: Simd>(s: S, t: f32, a: S::F, b: S::F) -> S::F {
    s.add_mul(s.mul(s.splat(1.0 - t), a), s.splat(t), b)
}

/// Loads numbers from a place on; zeros where there are not enough.
#[inline(always)]
fn load<S: Simd>(s: S, from: &[f32], i: usize) -> S::F {
    match from.get(i..).and_then(|from| from.first_chunk()) {
        Some(from) => s.load(from),
        None => s.splat(0.0),
    }
}

/// Stores numbers to a place, where there is room.
#[inline(always)]
fn store<S: Simd>(s: S, x: S::F, to: &mut [f32], i: usize) {
    if let Some(to) = to.get_mut(i..).and_then(|to| to.first_chunk_mut()) {
        s.store(x, to);
    }
}

/// One of [`N_DIRECTIONS`] evenly spread directions: a spiral of equal areas (Fibonacci lattice).
fn direction(i: usize) -> DVec3 {
    let z = 1.0 - (2 * i + 1) as f64 / N_DIRECTIONS as f64;
    let angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt()) * i as f64;
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * angle.cos(), across * angle.sin(), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use wavesplat_core::{ColorNode, OpacityNode, TransferFunction};

    fn dimness(samples: &[u8], size: [usize; 3], opacity: f64) -> ExtinctionGrid {
        let volume = Volume::new("test", Samples::U8(samples), size, DAffine3::IDENTITY).unwrap();
        let nodes = vec![OpacityNode { value: 0.0, opacity: 0.0 }, OpacityNode { value: 1.0, opacity }];
        let tf = TransferFunction::new(nodes, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], Some(1.0)).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let classifier = Classifier::new(&tf, volume.grid().density_from_sample(), slices.range(), 1.0);
        ExtinctionGrid::new(&slices, &classifier, 1.0, None).unwrap()
    }

    #[test]
    fn light_fades_along_its_way_by_beer_and_lambert() {
        let dimness = dimness(&[1; 12 * 10 * 8], [12, 10, 8], 0.3);
        for (axis, to_light) in [(0, DVec3::X), (1, DVec3::NEG_Y), (2, DVec3::Z)] {
            let share = dimness.shadow(to_light);
            for i in 0..share.len() {
                let index = [i % 12, i / 12 % 10, i / 120];
                let size = [12, 10, 8];
                let before = if to_light[axis] > 0.0 { size[axis] - 1 - index[axis] } else { index[axis] };
                let want = 0.7_f64.powi(before as i32);
                assert!((f64::from(share[i]) - want).abs() < 1e-4, "{axis} {index:?}: {} for {want}", share[i]);
            }
        }
    }

    #[test]
    fn a_block_casts_its_shadow_along_the_light() {
        // A plate of one opaque slice, half of the volume wide; light at 45 degrees.
        let mut samples = vec![0; 32 * 16 * 16];
        for z in 12..13 {
            for y in 0..16 {
                (0..16).for_each(|x| samples[(z * 16 + y) * 32 + x] = 1);
            }
        }
        let share = dimness(&samples, [32, 16, 16], 0.999).shadow(DVec3::new(-1.0, 0.0, 1.0));
        let at = |x: usize, z: usize| share[(z * 16 + 8) * 32 + x];
        assert!(at(14, 4) < 0.01 && at(22, 4) < 0.01 && at(25, 4) > 0.99, "{} {} {}", at(14, 4), at(22, 4), at(25, 4));
        assert!(at(14, 14) > 0.99);
    }

    #[test]
    fn hollows_are_closed_and_faces_open() {
        // Solid below z = 12 with a narrow shaft.
        let mut samples = vec![0; 24 * 24 * 24];
        for z in 0..12 {
            for y in 0..24 {
                for x in 0..24 {
                    let in_shaft = (11..13).contains(&x) && (11..13).contains(&y) && z > 2;
                    samples[(z * 24 + y) * 24 + x] = u8::from(!in_shaft);
                }
            }
        }
        let dimness = dimness(&samples, [24, 24, 24], 0.999);
        let open = dimness.openness(8.0);
        let at = |x: usize, z: usize| open[(z * 24 + 12) * 24 + x];
        assert!(at(5, 12) > 0.85, "a face: {}", at(5, 12));
        assert!(at(12, 20) > 0.95, "in the open: {}", at(12, 20));
        assert!(at(12, 4) < 0.5 * at(5, 12), "deep in the shaft: {}", at(12, 4));
    }
}
