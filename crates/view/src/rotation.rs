//! Axes of cameras, and rotations that are exact at quarter turns.

use glam::{DMat3, DVec3};

/// Right, up, and back (towards the eye) of a camera, unit vectors in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Towards the right of the picture.
    pub right: DVec3,
    /// Towards the top of the picture.
    pub up: DVec3,
    /// From the picture towards the eye.
    pub back: DVec3,
}

impl Axes {
    /// Right, up and back coordinates of a vector of the world.
    pub fn coordinates(&self, v: DVec3) -> DVec3 {
        DVec3::new(dot(v, self.right), dot(v, self.up), dot(v, self.back))
    }

    /// The axes turned by a rotation.
    pub(crate) fn rotated(&self, matrix: &DMat3) -> Self {
        let rows = matrix.transpose();
        let turned = |v| DVec3::new(dot(v, rows.x_axis), dot(v, rows.y_axis), dot(v, rows.z_axis));
        Self { right: turned(self.right), up: turned(self.up), back: turned(self.back) }
    }

    /// The vector of the world with these right, up and back coordinates.
    pub fn vector(&self, coordinates: DVec3) -> DVec3 {
        let rows = DMat3::from_cols(self.right, self.up, self.back).transpose();
        DVec3::new(dot(coordinates, rows.x_axis), dot(coordinates, rows.y_axis), dot(coordinates, rows.z_axis))
    }
}

/// Dot product with fused multiplications, in the order x, y, z.
pub(crate) fn dot(a: DVec3, b: DVec3) -> f64 {
    a.z.mul_add(b.z, a.y.mul_add(b.y, a.x * b.x))
}

/// As `dot`, in the order y, x, z, in which linear algebra libraries multiply a matrix and one vector.
pub(crate) fn dot_of_row(a: DVec3, b: DVec3) -> f64 {
    a.z.mul_add(b.z, a.x.mul_add(b.x, a.y * b.y))
}

/// The unit vector in a direction.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    v / dot(v, v).sqrt()
}

/// A matrix times a vector.
pub(crate) fn turned(matrix: &DMat3, v: DVec3) -> DVec3 {
    let rows = matrix.transpose();
    DVec3::new(dot_of_row(rows.x_axis, v), dot_of_row(rows.y_axis, v), dot_of_row(rows.z_axis, v))
}

/// Sine and cosine of an angle in degrees; exact at quarter turns, so that named views look straight along an axis.
pub fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    let mut rest = angle_deg % 90.0;
    let mut quarters = ((angle_deg - rest) / 90.0).round();
    if rest < 0.0 {
        rest += 90.0;
        quarters -= 1.0;
    }
    let rest = (rest + 0.0).to_radians(); // -0 is 0
    let (s, c) = (rest.sin(), rest.cos());
    match quarters.rem_euclid(4.0) as u8 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Axes of a camera on the orbit. Azimuth 0 and elevation 0, degrees, look from +y towards -y with +z up; the azimuth
/// grows towards -x, the elevation lifts the eye towards +z, and the up direction turns along.
pub fn orbit_axes(azimuth_deg: f64, elevation_deg: f64) -> Axes {
    let (sin_a, cos_a) = sin_cos_deg(azimuth_deg);
    let (sin_e, cos_e) = sin_cos_deg(elevation_deg);
    let back = DVec3::new(-sin_a * cos_e, cos_a * cos_e, sin_e);
    // The derivative of `back` by the elevation.
    let up = DVec3::new(sin_a * sin_e, -cos_a * sin_e, cos_e);
    // Adding 0 turns -0 into 0, which prints better.
    Axes { right: up.cross(back) + 0.0, up: up + 0.0, back: back + 0.0 }
}

/// Rotation about an axis of any length but 0, degrees, anticlockwise seen from its tip (Rodrigues); exact at quarter
/// turns about an axis of the world.
pub fn about(axis: DVec3, angle_deg: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(angle_deg);
    let u = unit(axis);
    let entry = |row: usize, column: usize| {
        let cross = match (row, column) {
            (0, 1) => -u.z,
            (1, 0) => u.z,
            (0, 2) => u.y,
            (2, 0) => -u.y,
            (1, 2) => -u.x,
            (2, 1) => u.x,
            _ => 0.0,
        };
        let same = if row == column { 1.0 } else { 0.0 };
        c * same + s * cross + (1.0 - c) * (u[row] * u[column]) + 0.0
    };
    let column = |k| DVec3::new(entry(0, k), entry(1, k), entry(2, k));
    DMat3::from_cols(column(0), column(1), column(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for k in -9_i32..9 {
            assert_eq!(sin_cos_deg(f64::from(k) * 90.0), expected[k.rem_euclid(4) as usize], "{k} quarters");
        }
        assert_eq!(about(DVec3::Z * 3.0, 90.0) * DVec3::X, DVec3::Y);
        assert_eq!(about(DVec3::X, -90.0) * DVec3::Z, DVec3::Y);
    }

    #[test]
    fn other_angles_are_those_of_the_unit_circle() {
        for k in -1000..1000 {
            let angle = f64::from(k) * 1.37;
            let (s, c) = sin_cos_deg(angle);
            let (sine, cosine) = angle.to_radians().sin_cos();
            assert!((s - sine).abs() < 1e-13 && (c - cosine).abs() < 1e-13, "{angle}");
        }
    }

    #[test]
    fn axes_are_right_handed_unit_vectors_everywhere() {
        for k in 0..60 {
            let axes = orbit_axes(f64::from(k) * 37.0, f64::from(k) * 23.0);
            assert!((axes.right.cross(axes.up) - axes.back).length() < 1e-15);
            assert!((axes.up.dot(axes.back)).abs() < 1e-15 && (axes.up.length() - 1.0).abs() < 1e-15);
            let v = DVec3::new(1.0, -2.0, f64::from(k));
            assert!((axes.vector(axes.coordinates(v)) - v).length() < 1e-13);
        }
    }

    #[test]
    fn a_rotation_keeps_its_axis_and_lengths_and_turns_by_its_angle() {
        let axis = DVec3::new(1.0, -2.0, 0.5);
        let matrix = about(axis, 77.0);
        assert!((matrix * axis - axis).length() < 1e-15);
        let beside = axis.cross(DVec3::X);
        let end = matrix * beside;
        assert!((end.length() - beside.length()).abs() < 1e-15);
        assert!((beside.angle_between(end).to_degrees() - 77.0).abs() < 1e-12);
        assert!(beside.cross(end).dot(axis) > 0.0);
    }
}
