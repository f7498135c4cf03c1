//! Slices and thick slabs: values on a plane through the volume, or across parallel planes (multiplanar reformation).
//!
//! A pixel is a point: the kernel reconstructs the value there from the samples around it, as `Σ weight · sample`, and
//! nothing is averaged over the pixel's area. A slab keeps the largest, the smallest or the mean value of its planes;
//! the mean is the trapezoidal rule, so its outer planes count half. Points outside the volume, or missing
//! ([`crate::source::nonfinite`]), are NaN, and a slab leaves them out.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_core::{Error, Kernel, Result};

use crate::kernel::weights::{mirror_index, n_taps, taps};
use crate::render::progress::ProgressCallback;
use crate::source::point_sampling::PointTaps;
use crate::source::slices::Slices;

/// A grid of pixels on a plane in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The centre of the first pixel.
    pub origin: DVec3,
    /// Step from a pixel to the next of its row.
    pub across: DVec3,
    /// Step from a pixel to the one below.
    pub down: DVec3,
    /// Pixels per row.
    pub width_px: usize,
    /// Number of rows.
    pub height_px: usize,
}

/// Reduction of the planes of a slab to one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// The largest value.
    Maximum,
    /// The smallest value.
    Minimum,
    /// The mean by the trapezoidal rule.
    Mean,
}

impl Reduction {
    const NAMES: [(&'static str, Self); 3] =
        [("maximum", Self::Maximum), ("minimum", Self::Minimum), ("mean", Self::Mean)];

    /// The reduction with a public name.
    pub fn from_name(name: &str) -> Result<Self> {
        let known = || Self::NAMES.map(|(name, _)| name).join(", ");
        let found = Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, reduction)| *reduction);
        found.ok_or_else(|| Error::UnknownName { what: "slab", name: name.to_owned(), known: known() })
    }
}

/// A stack of equally spaced parallel planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThickSlab {
    /// Reduction of the planes.
    pub reduction: Reduction,
    /// Number of planes, at least 1; the first is the plane itself.
    pub n_planes: usize,
    /// Step from a plane to the next, in the world.
    pub step: DVec3,
}

/// Distance within which a position counts as on a sample, in samples: affines in files are rounded to f32.
const ON_SAMPLE: f64 = 1e-6;

/// Largest number of pixels that are looked up together.
const CHUNK: usize = 256;

/// Largest extent of these pixels, in samples, so that little must be decoded for them.
const CHUNK_EXTENT: f64 = 32.0;

/// The value at every pixel, in sample units, row by row.
pub fn plane_values(
    slices: &Slices,
    plane: &Plane,
    slab: &ThickSlab,
    n_threads: Option<usize>,
    monitor: &dyn ProgressCallback,
) -> Result<Vec<f32>> {
    let stopped = AtomicBool::new(false);
    let n_done = AtomicUsize::new(0);
    let rows = parallel::with_threads(n_threads, || {
        parallel::map(plane.height_px, |y| {
            if stopped.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let row = row_values(slices, plane, slab, y);
            let fraction = (n_done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / plane.height_px as f32;
            if monitor.progress(fraction).is_break() {
                stopped.store(true, Ordering::Relaxed);
            }
            row
        })
    });
    if stopped.load(Ordering::Relaxed) { Err(Error::Cancelled) } else { Ok(rows.concat()) }
}

fn row_values(slices: &Slices, plane: &Plane, slab: &ThickSlab, y: usize) -> Vec<f32> {
    let index_from_world = slices.grid().index_from_world();
    let across = index_from_world.matrix3 * plane.across;
    // A direction that is not finite gives NaN, which the cast turns into 0.
    let chunk = ((CHUNK_EXTENT / across.abs().max_element()).clamp(1.0, CHUNK as f64) as usize).max(1);
    let mut kept = vec![Kept::default(); plane.width_px];
    let (mut points, mut places, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..slab.n_planes {
        let is_end = k == 0 || k + 1 == slab.n_planes;
        let first = plane.origin + y as f64 * plane.down + k as f64 * slab.step;
        let first = index_from_world.transform_point3(first);
        for from in (0..plane.width_px).step_by(chunk) {
            points.clear();
            places.clear();
            for x in from..(from + chunk).min(plane.width_px) {
                if let Some(point) = point_taps(slices, first + x as f64 * across) {
                    points.push(point);
                    places.push(x);
                }
            }
            values.resize(points.len(), f64::NAN);
            slices.sums(&points, &mut values);
            for (&x, &value) in places.iter().zip(&values).filter(|(_, value)| !value.is_nan()) {
                kept[x].add(slab.reduction, value, if is_end { 0.5 } else { 1.0 });
            }
        }
    }
    kept.into_iter().map(|kept| kept.value(slab.reduction)).collect()
}

/// Reduction of the planes so far.
#[derive(Clone, Copy, Default)]
struct Kept {
    value: f64,
    weight: f64,
}

impl Kept {
    fn add(&mut self, reduction: Reduction, value: f64, weight: f64) {
        self.value = match reduction {
            Reduction::Mean => self.value + weight * value,
            _ if self.weight == 0.0 => value,
            Reduction::Maximum => self.value.max(value),
            Reduction::Minimum => self.value.min(value),
        };
        self.weight += weight;
    }

    fn value(self, reduction: Reduction) -> f32 {
        let value = match reduction {
            _ if self.weight == 0.0 => f64::NAN,
            Reduction::Mean => self.value / self.weight,
            Reduction::Maximum | Reduction::Minimum => self.value,
        };
        value as f32
    }
}

/// The taps at an index position; `None` outside the volume.
fn point_taps(slices: &Slices, position: DVec3) -> Option<PointTaps> {
    let (kernel, grid) = (slices.kernel(), slices.grid());
    let [lo, hi] = grid.bounds();
    let mut point = PointTaps::default();
    for axis in 0..3 {
        let nearest = position[axis].round();
        let x = if (position[axis] - nearest).abs() < ON_SAMPLE { nearest } else { position[axis] };
        if !(x >= lo[axis] - ON_SAMPLE && x <= hi[axis] + ON_SAMPLE) {
            return None;
        }
        let n = grid.size()[axis];
        let (first, weight) = taps(kernel, x.clamp(0.0, (n - 1) as f64));
        for t in 0..n_taps(kernel) {
            point.index[axis][t] = mirror_index(kernel, first + t as i64, n);
        }
        point.weight[axis] = weight;
        if slices.has_mask() {
            let (first, weights) = taps(Kernel::Linear, x.clamp(0.0, (n - 1) as f64));
            point.cell[axis] = [0, 1].map(|t| (mirror_index(Kernel::Linear, first + t as i64, n), weights[t]));
        }
    }
    Some(point)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use glam::{DAffine3, DMat3};
    use wavesplat_core::{Samples, Volume};

    use super::*;

    struct Silent;

    impl ProgressCallback for Silent {
        fn progress(&self, _: f32) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
    }

    struct Stop;

    impl ProgressCallback for Stop {
        fn progress(&self, _: f32) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }

    const SIZE: [usize; 3] = [6, 5, 4];

    fn world_from_index() -> DAffine3 {
        let turn = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(-0.7);
        DAffine3 {
            matrix3: turn * DMat3::from_diagonal(DVec3::new(0.7, 0.8, 1.5)),
            translation: DVec3::new(3.0, -20.0, 100.0),
        }
    }

    #[test]
    fn a_plane_without_a_direction_is_drawn_empty() {
        let samples = vec![1.0_f32; SIZE.iter().product()];
        let volume = Volume::new("a", Samples::F32(&samples), SIZE, world_from_index()).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let plane = Plane { across: DVec3::splat(f64::NAN), ..oblique(5, 4) };
        let slab = ThickSlab { reduction: Reduction::Maximum, n_planes: 1, step: DVec3::ZERO };
        let values = plane_values(&slices, &plane, &slab, Some(1), &Silent).unwrap();
        assert_eq!(values.len(), 20);
    }

    /// A plane that lies obliquely in the index space, most of it inside the volume.
    fn oblique(width_px: usize, height_px: usize) -> Plane {
        let world = world_from_index();
        let vector = |x, y, z| world.matrix3 * DVec3::new(x, y, z);
        Plane {
            origin: world.transform_point3(DVec3::new(0.303, 0.207, 0.409)),
            across: vector(0.23, 0.05, 0.02),
            down: vector(-0.03, 0.21, 0.1),
            width_px,
            height_px,
        }
    }

    fn one_plane() -> ThickSlab {
        ThickSlab { reduction: Reduction::Maximum, n_planes: 1, step: DVec3::ZERO }
    }

    fn values_of(samples: &[f32], kernel: Kernel, plane: &Plane, slab: &ThickSlab) -> Vec<f32> {
        let volume = Volume::new("test", Samples::F32(samples), SIZE, world_from_index()).unwrap();
        plane_values(&Slices::new(&volume, kernel), plane, slab, None, &Silent).unwrap()
    }

    fn ramp() -> Vec<f32> {
        let at = |i: usize| [i % 6, i / 6 % 5, i / 30].map(|n| n as f32);
        (0..120).map(at).map(|[x, y, z]| 2.0 * x - 3.0 * y + 5.0 * z + 7.0).collect()
    }

    #[test]
    fn a_ramp_is_exact_on_any_plane() {
        let plane = oblique(30, 25);
        let values = values_of(&ramp(), Kernel::Linear, &plane, &one_plane());
        let index_from_world = world_from_index().inverse();
        let mut n_inside = 0;
        for (i, value) in values.iter().enumerate() {
            let world = plane.origin + (i % 30) as f64 * plane.across + (i / 30) as f64 * plane.down;
            let at = index_from_world.transform_point3(world);
            let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] <= (SIZE[axis] - 1) as f64);
            assert_eq!(inside, !value.is_nan(), "{at}");
            if inside {
                let want = 2.0 * at.x - 3.0 * at.y + 5.0 * at.z + 7.0;
                assert!((f64::from(*value) - want).abs() < 1e-5, "{value} for {want} at {at}");
                n_inside += 1;
            }
        }
        assert!(n_inside > 200 && n_inside < values.len());
    }

    #[test]
    fn interpolating_kernels_give_the_samples_at_their_centres() {
        let samples: Vec<f32> = (0..120_usize).map(|i| ((i * 37 + 11) % 101) as f32).collect();
        let world = world_from_index();
        let plane = Plane {
            origin: world.transform_point3(DVec3::new(5.0, 0.0, 2.0)),
            across: -world.matrix3.x_axis,
            down: world.matrix3.y_axis,
            width_px: 6,
            height_px: 5,
        };
        let (splines, exact) = (1e-4, 0.0);
        for (kernel, bound) in [
            (Kernel::Linear, exact),
            (Kernel::CatmullRom, exact),
            (Kernel::Bspline2, splines),
            (Kernel::Bspline3, splines),
        ] {
            let values = values_of(&samples, kernel, &plane, &one_plane());
            for (i, value) in values.iter().enumerate() {
                let want = samples[2 * 30 + i / 6 * 6 + 5 - i % 6];
                assert!((value - want).abs() <= bound, "{kernel:?} at {i}: {value} for {want}");
            }
        }
    }

    #[test]
    fn slabs_keep_what_they_say_of_their_planes() {
        let plane = oblique(9, 8);
        let step = world_from_index().matrix3 * DVec3::new(0.0, 0.1, 0.5);
        let samples: Vec<f32> = (0..120_usize).map(|i| ((i * 37 + 11) % 101) as f32).collect();
        let planes: Vec<Vec<f32>> = (0..3)
            .map(|k| Plane { origin: plane.origin + f64::from(k) * step, ..plane })
            .map(|plane| values_of(&samples, Kernel::Linear, &plane, &one_plane()))
            .collect();
        let check = |reduction, want: fn([f32; 3]) -> f32| {
            let got = values_of(&samples, Kernel::Linear, &plane, &ThickSlab { reduction, n_planes: 3, step });
            for (i, got) in got.iter().enumerate().filter(|(i, _)| planes.iter().all(|p| !p[*i].is_nan())) {
                let want = want([planes[0][i], planes[1][i], planes[2][i]]);
                assert!((got - want).abs() < 1e-4, "{reduction:?}: {got} for {want}");
            }
        };
        check(Reduction::Maximum, |v| v[0].max(v[1]).max(v[2]));
        check(Reduction::Minimum, |v| v[0].min(v[1]).min(v[2]));
        check(Reduction::Mean, |v| 0.25 * v[0] + 0.5 * v[1] + 0.25 * v[2]);
    }

    #[test]
    fn holes_are_nan_and_slabs_leave_them_out() {
        let mut samples = ramp();
        samples[2 + 6 * (2 + 5)] = f32::NAN;
        let world = world_from_index();
        let origin = world.transform_point3(DVec3::new(0.0, 2.0, 1.0));
        // Three positions a sample, none of them where just half of what is reached is missing.
        let across = world.matrix3.x_axis / 3.0;
        let plane = Plane { origin, across, down: DVec3::ZERO, width_px: 16, height_px: 1 };
        let values = values_of(&samples, Kernel::Linear, &plane, &one_plane());
        let holes: Vec<usize> = (0..16).filter(|&x| values[x].is_nan()).collect();
        assert_eq!(holes, [5, 6, 7]);
        let step = world.matrix3.z_axis;
        let slab = ThickSlab { reduction: Reduction::Minimum, n_planes: 2, step };
        let values = values_of(&samples, Kernel::Linear, &plane, &slab);
        assert!((values[6] - (4.0 - 6.0 + 10.0 + 7.0)).abs() < 1e-5, "{}", values[6]);
    }

    #[test]
    fn the_monitor_stops_it_and_names_are_checked() {
        let samples = ramp();
        let volume = Volume::new("test", Samples::F32(&samples), SIZE, world_from_index()).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let stopped = plane_values(&slices, &oblique(4, 4), &one_plane(), Some(1), &Stop);
        assert_eq!(stopped, Err(Error::Cancelled));
        let message = Reduction::from_name("median").unwrap_err().to_string();
        assert!(message.contains("median") && message.contains("maximum, minimum, mean"), "{message}");
    }
}
