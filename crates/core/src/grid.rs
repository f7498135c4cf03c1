//! Grid: position of samples in the world (affine), and map of their values to densities.

use glam::{DAffine3, DMat3, DVec3};

use crate::error::{Error, Result};
use crate::samples::Statistics;

/// Shape, position and range of a volume, independent of the storage of its samples. Always consistent.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    size: [usize; 3],
    world_from_index: DAffine3,
    statistics: Statistics,
    density_from_sample: (f64, f64),
    opacity_unit: f64,
    bounds: [DVec3; 2],
}

impl Grid {
    /// Checks shape and affine; `size` is `[nx, ny, nz]`, `name` appears in messages only. `is_narrow`: densities are
    /// the samples as they are.
    pub fn new(
        name: &str,
        size: [usize; 3],
        world_from_index: DAffine3,
        statistics: Statistics,
        is_narrow: bool,
    ) -> Result<Self> {
        let shape_zyx = [size[2], size[1], size[0]];
        let name = || name.to_owned();
        if size.iter().any(|&n| n < 2) {
            return Err(Error::ThinVolume { name: name(), shape_zyx });
        }
        let n_samples = size.iter().product();
        if statistics.n_nonfinite == n_samples {
            return Err(Error::NoFiniteSample { name: name(), n_samples });
        }
        if let Some(problem) = affine_problem(&world_from_index) {
            return Err(Error::DegenerateAffine { name: name(), matrix: Box::new(rows(&world_from_index)), problem });
        }
        let density_from_sample = if is_narrow { (0.0, 1.0) } else { wide_density(statistics) };
        let opacity_unit = mean_spacing(&world_from_index);
        let bounds = [DVec3::ZERO, DVec3::from_array(size.map(|n| (n - 1) as f64))];
        Ok(Self { size, world_from_index, statistics, density_from_sample, opacity_unit, bounds })
    }

    /// The grid as a coarser level of another volume: with that volume's default `opacity_unit`, world units, and drawn
    /// only within that volume's `bounds`, index positions of this grid.
    #[must_use]
    pub fn as_level_of(self, opacity_unit: f64, bounds: [DVec3; 2]) -> Self {
        let last = self.last_index();
        let bounds = [bounds[0].max(DVec3::ZERO), bounds[1].min(last)];
        Self { opacity_unit, bounds, ..self }
    }

    /// `[nx, ny, nz]`.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// World position (mm for medical data) of an index position.
    pub fn world_from_index(&self) -> DAffine3 {
        self.world_from_index
    }

    /// Index position of a world position.
    pub fn index_from_world(&self) -> DAffine3 {
        self.world_from_index.inverse()
    }

    /// Range and number of non-finite samples.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Length of one index step along each axis, world units.
    pub fn spacing(&self) -> DVec3 {
        spacing(&self.world_from_index)
    }

    /// Default `opacity_unit`, world units: the geometric mean of the spacings; a level has the finest grid's.
    pub fn default_opacity_unit(&self) -> f64 {
        self.opacity_unit
    }

    /// Geometric mean of the spacings, world units.
    pub fn mean_spacing(&self) -> f64 {
        mean_spacing(&self.world_from_index)
    }

    /// World position of the middle of the drawn box.
    pub fn middle(&self) -> DVec3 {
        self.world_from_index.transform_point3((self.bounds[0] + self.bounds[1]) / 2.0)
    }

    /// Ratio of the mean spacing to the mean spacing of the finest level; 1 for a volume itself.
    pub fn coarseness(&self) -> f64 {
        self.mean_spacing() / self.opacity_unit
    }

    /// Corners of the drawn box, index positions: the first and the last sample, unless the grid is a level.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Last index position of each axis: the samples fill `[0, last]`.
    pub fn last_index(&self) -> DVec3 {
        DVec3::new((self.size[0] - 1) as f64, (self.size[1] - 1) as f64, (self.size[2] - 1) as f64)
    }

    /// `(offset, scale)` of the density `d = (sample − offset) · scale` that the renderer works with.
    pub fn density_from_sample(&self) -> (f64, f64) {
        self.density_from_sample
    }

    /// Smallest and largest density of a finite sample.
    pub fn density_range(&self) -> [f32; 2] {
        let (offset, scale) = self.density_from_sample;
        [self.statistics.min, self.statistics.max].map(|s| ((s - offset) * scale) as f32)
    }
}

/// Ratio of magnitude to range above which samples lie far from 0; their densities are counted from the least sample.
const FAR_FROM_ZERO: f64 = 8.0;

/// Magnitudes whose sums and products f32 holds with room to spare; others are scaled.
const COMFORTABLE: std::ops::Range<f64> = 1e-9..1e9;

/// `(offset, scale)` for samples of 32 and 64 bits: `(0, 1)` wherever no other map is more precise.
///
/// A sample that f32 holds has a density that f32 holds, so that both maps are exact: the scale is a power of two, and
/// samples far from 0 are multiples of one unit, and so are their distances from the least of them.
fn wide_density(Statistics { min, max, .. }: Statistics) -> (f64, f64) {
    let (extent, magnitude) = (max - min, min.abs().max(max.abs()));
    // A range beyond f64, or none at all, is mapped by its magnitude alone.
    let is_far = extent.is_finite() && extent > 0.0 && magnitude > FAR_FROM_ZERO * extent;
    let (offset, size) = if is_far { (min, extent) } else { (0.0, magnitude) };
    let is_comfortable = size == 0.0 || COMFORTABLE.contains(&size);
    let scale = if is_comfortable { 1.0 } else { (-size.log2().floor().clamp(-1022.0, 1022.0)).exp2() };
    (offset, scale)
}

fn spacing(world_from_index: &DAffine3) -> DVec3 {
    let m = world_from_index.matrix3;
    DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length())
}

fn mean_spacing(world_from_index: &DAffine3) -> f64 {
    let s = spacing(world_from_index);
    (s.x * s.y * s.z).cbrt()
}

fn rows(affine: &DAffine3) -> [[f64; 4]; 3] {
    let (m, t) = (affine.matrix3, affine.translation);
    [
        [m.x_axis.x, m.y_axis.x, m.z_axis.x, t.x],
        [m.x_axis.y, m.y_axis.y, m.z_axis.y, t.y],
        [m.x_axis.z, m.y_axis.z, m.z_axis.z, t.z],
    ]
}

fn affine_problem(affine: &DAffine3) -> Option<&'static str> {
    if !affine.is_finite() {
        return Some("has a number that is not finite");
    }
    let m = affine.matrix3;
    let lengths = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
    if lengths.contains(&0.0) {
        return Some("has a spacing of 0");
    }
    // The determinant of the unit columns is the volume of their box: 1 when orthogonal, 0 when they lie in a plane.
    let unit = DMat3::from_cols(m.x_axis / lengths[0], m.y_axis / lengths[1], m.z_axis / lengths[2]);
    let skew = unit.determinant().abs();
    (skew.is_nan() || skew < 1e-6).then_some("puts the three axes into one plane")
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Statistics = Statistics { min: -1.0, max: 3.0, n_nonfinite: 0 };

    fn grid(size: [usize; 3], world_from_index: DAffine3) -> Result<Grid> {
        Grid::new("grid", size, world_from_index, UNIT, false)
    }

    #[test]
    fn a_volume_is_drawn_from_its_first_to_its_last_sample() {
        let grid = grid([5, 6, 7], DAffine3::from_scale(DVec3::new(1.0, 2.0, 4.0))).unwrap();
        assert_eq!(grid.bounds(), [DVec3::ZERO, DVec3::new(4.0, 5.0, 6.0)]);
        assert!((grid.default_opacity_unit() - 2.0).abs() < 1e-12 && (grid.coarseness() - 1.0).abs() < 1e-12);
        assert_eq!(grid.density_range(), [-1.0, 3.0]);
    }

    #[test]
    fn a_level_keeps_the_units_of_the_finest_and_its_bounds() {
        let finest = grid([17, 17, 17], DAffine3::from_scale(DVec3::splat(1.5))).unwrap();
        let level = grid([6, 6, 6], DAffine3::from_scale(DVec3::splat(6.0))).unwrap();
        let bounds = [DVec3::splat(0.25), DVec3::splat(4.75)];
        let level = level.as_level_of(finest.default_opacity_unit(), bounds);
        assert_eq!(level.bounds(), bounds);
        assert_eq!(level.default_opacity_unit(), finest.default_opacity_unit());
        assert!((level.coarseness() - 4.0).abs() < 1e-12);
        assert!((level.mean_spacing() - 6.0).abs() < 1e-12, "spacings are its own");
        assert_eq!((level.size(), level.statistics()), ([6; 3], UNIT));
    }

    #[test]
    fn bounds_never_leave_the_samples() {
        let level = grid([4, 4, 4], DAffine3::IDENTITY).unwrap();
        let level = level.as_level_of(1.0, [DVec3::new(-1.0, 0.5, -1e-9), DVec3::new(2.0, 9.0, 3.0 + 1e-9)]);
        assert_eq!(level.bounds(), [DVec3::new(0.0, 0.5, 0.0), DVec3::new(2.0, 3.0, 3.0)]);
    }

    #[test]
    fn grids_that_fill_no_space_are_refused() {
        assert!(matches!(grid([1, 5, 5], DAffine3::IDENTITY), Err(Error::ThinVolume { .. })));
        let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
        assert!(matches!(grid([5, 5, 5], flat), Err(Error::DegenerateAffine { .. })));
    }
}
