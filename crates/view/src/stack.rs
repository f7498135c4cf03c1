//! The view that suits a volume, by its number of samples, their distances and its box.

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::Grid;

use crate::fit::grid_corners;
use crate::named::known_angles;

/// Largest number of slices, and least number of samples along their sides, of volumes of a few slices.
const FEW: usize = 4;
const WIDE: usize = 16;
/// Largest ratio of the thinnest side to the second one of a thin stack, which is seen along its thin side.
const THIN: f64 = 0.3;
/// Least ratio of the distances of samples, across slices and within them, of a stack that is seen along it. (Confocal
/// stacks: 4; electron microscopy of sections: 10.)
const COARSE: f64 = 3.0;
/// Largest ratio of the thinnest side to the second one of a flat box, whose broad face is turned to the eye.
const FLAT: f64 = 0.6;
/// Azimuth of a box that is flat along x, and elevation of one that is flat along z, degrees.
const TURNED: f64 = 120.0;
const RAISED: f64 = 45.0;

/// Samples, spacings and box of a volume.
#[derive(Clone, Copy, Debug)]
pub struct Stack {
    /// Samples along the index axes x, y, z.
    pub size: [usize; 3],
    /// Where samples lie in the world.
    pub world_from_index: DAffine3,
    /// Distances of samples along the index axes, world units.
    pub spacing: DVec3,
    /// Sides of the box around all samples along the axes of the world.
    pub sides: DVec3,
}

impl Stack {
    /// The stack of a grid.
    pub fn of(grid: &Grid) -> Self {
        let corners = grid_corners(grid);
        let (low, high) = corners.iter().fold((corners[0], corners[0]), |(low, high), &p| (low.min(p), high.max(p)));
        Self {
            size: grid.size(),
            world_from_index: grid.world_from_index(),
            spacing: grid.spacing(),
            sides: high - low,
        }
    }

    /// Whether the volume is a thin stack.
    pub fn is_thin(&self) -> bool {
        self.sides.min_element() < THIN * second(self.sides)
    }

    /// Whether the index axes lie along the world's, and the world's origin is at the first sample or in the middle.
    pub fn is_placed_by_default(&self) -> bool {
        let DAffine3 { matrix3, translation } = self.world_from_index;
        let steps = DVec3::new(matrix3.x_axis.x, matrix3.y_axis.y, matrix3.z_axis.z);
        let origin = -translation / steps; // in samples
        let middle = (DVec3::from(self.size.map(|n| n as f64)) - 1.0) / 2.0;
        // Formats differ in where the middle of an even number of samples is.
        let near = 1e-6;
        matrix3 == DMat3::from_diagonal(steps)
            && (origin.abs().max_element() < near || (origin - middle).abs().max_element() <= 1.0 + near)
    }

    /// The world's axis (0 is x) along which the volume has a few slices; `None` where it has more, or is small.
    pub fn axis_of_few_slices(&self) -> Option<usize> {
        let [x, y, z] = self.size.map(|n| n as f64);
        // Of equally few ones the slowest axis.
        let across = 2 - first(DVec3::new(z, y, x), |a, b| a < b);
        let are_few = self.size[across] <= FEW && second(DVec3::new(x, y, z)) >= WIDE as f64;
        are_few.then(|| self.axis_of_world(across))
    }

    /// The world's axis (0 is x) along which samples are far apart, so that other planes are blurred; else `None`.
    pub fn axis_of_distant_slices(&self) -> Option<usize> {
        let are_distant = self.spacing.max_element() >= COARSE * second(self.spacing);
        are_distant.then(|| self.axis_of_world(first(self.spacing, |a, b| a > b)))
    }

    /// Azimuth and elevation, degrees: a patient from the front, thin and coarse stacks face on, else oblique.
    ///
    /// `is_upright`: whether the axes of the world grow to the right and up in pictures, as of maps and of what was
    /// calculated; `is_of_patient`: whether the volume shows a patient. Both are asked only where they decide.
    ///
    /// # Errors
    ///
    /// The errors of the two questions.
    pub fn natural_view<E>(
        &self,
        is_anatomical: bool,
        is_upright: impl FnOnce() -> Result<bool, E>,
        is_of_patient: impl FnOnce() -> Result<bool, E>,
    ) -> Result<(f64, f64), E> {
        let thinnest = first(self.sides, |a, b| a < b);
        let distant = || if is_anatomical { None } else { self.axis_of_distant_slices() };
        let face = self.axis_of_few_slices().or_else(distant).or_else(|| self.is_thin().then_some(thinnest));
        if let Some(axis) = face {
            if is_upright()? {
                // As plots and maps are: the axes of the world to the right and up.
                return Ok(known_angles(["right", "back", "top"][axis], false));
            }
            // Thin stacks as slices of them are looked at.
            return Ok(known_angles(["yz", "xz", "xy"][axis], is_anatomical));
        }
        if is_of_patient()? {
            return Ok(known_angles("anterior", true));
        }
        let (azimuth, elevation) = known_angles("isometric", false);
        if self.sides[thinnest] >= FLAT * second(self.sides) {
            return Ok((azimuth, elevation));
        }
        // Flat boxes turn their broad face to the eye.
        Ok([(TURNED, elevation), (azimuth, elevation), (azimuth, RAISED)][thinnest])
    }

    /// The world's axis (0 is x) that is nearest to an index axis.
    fn axis_of_world(&self, index_axis: usize) -> usize {
        first(self.world_from_index.matrix3.col(index_axis).abs(), |a, b| a > b)
    }
}

/// The first axis whose number comes before all others.
fn first(numbers: DVec3, is_before: fn(f64, f64) -> bool) -> usize {
    (1..3).fold(0, |best, axis| if is_before(numbers[axis], numbers[best]) { axis } else { best })
}

/// The second of three numbers by size.
fn second(DVec3 { x, y, z }: DVec3) -> f64 {
    x.min(y).max(x.max(y).min(z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::named::view_angles;

    /// Stack of samples at distances along the axes of the world.
    fn stack(size: [usize; 3], spacing: [f64; 3]) -> Stack {
        let spacing = DVec3::from(spacing);
        let sides = DVec3::from(size.map(|n| n as f64 - 1.0)) * spacing;
        Stack { size, world_from_index: DAffine3::from_scale(spacing), spacing, sides }
    }

    fn view(stack: &Stack, is_anatomical: bool, is_upright: bool, is_of_patient: bool) -> (f64, f64) {
        stack.natural_view::<()>(is_anatomical, || Ok(is_upright), || Ok(is_of_patient)).unwrap()
    }

    #[test]
    fn stacks_are_seen_face_on_patients_from_the_front_and_others_obliquely() {
        let cube = stack([64; 3], [1.0; 3]);
        assert_eq!(view(&cube, false, false, false), (150.0, 30.0));
        assert_eq!(view(&cube, true, false, true), (0.0, 0.0));
        let slices = stack([64, 64, 3], [1.0; 3]);
        assert_eq!(slices.axis_of_few_slices(), Some(2));
        assert_eq!(view(&slices, false, false, false), view_angles("xy", false).unwrap());
        assert_eq!(view(&slices, false, true, false), view_angles("top", false).unwrap());
        let confocal = stack([64, 64, 40], [1.0, 1.0, 4.0]);
        assert_eq!(confocal.axis_of_distant_slices(), Some(2));
        assert_eq!(view(&confocal, false, false, false), view_angles("xy", false).unwrap());
        assert_eq!(view(&confocal, true, false, true), (0.0, 0.0), "coarse scans of patients are not");
        let thin = stack([10, 64, 64], [1.0; 3]);
        assert!(thin.is_thin() && !cube.is_thin());
        assert_eq!(view(&thin, false, false, false), view_angles("yz", false).unwrap());
        assert_eq!(view(&stack([30, 64, 64], [1.0; 3]), false, false, false), (120.0, 30.0));
        assert_eq!(view(&stack([64, 64, 30], [1.0; 3]), false, false, false), (150.0, 45.0));
    }
}
