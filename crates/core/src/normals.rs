//! Normals of triangles that share vertices.

use glam::DVec3;

use crate::error::{Error, Result};

/// For each vertex the sum of the vectors of the faces around it, which are normal to them and twice as long as their
/// areas: the mean of their normals by area.
///
/// # Errors
///
/// [`Error::OutOfRange`] if a face has a vertex that does not exist.
pub fn normals_of_faces(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Vec<[f64; 3]>> {
    let mut sums = vec![DVec3::ZERO; vertices.len()];
    for (k, face) in faces.iter().enumerate() {
        if face.iter().any(|v| *v as usize >= vertices.len()) {
            let mend = "number vertices from 0; check that vertices and faces belong together";
            let value = format!("{face:?} of {} vertices", vertices.len());
            return Err(Error::out_of_range(format!("face {k}"), value, "three vertices", mend));
        }
        let [a, b, c] = face.map(|v| DVec3::from_array(vertices[v as usize]));
        let vector = (b - a).cross(c - a);
        for v in face {
            sums[*v as usize] += vector;
        }
    }
    Ok(sums.into_iter().map(|sum| sum.to_array()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_count_by_their_area() {
        let vertices = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 5.0], [7.0; 3]];
        let normals = normals_of_faces(&vertices, &[[0, 1, 2], [0, 3, 1]]).unwrap();
        assert_eq!(normals[0], [0.0, 10.0, 6.0]);
        assert_eq!(normals[2], [0.0, 0.0, 6.0]);
        assert_eq!((normals[1], normals[4]), (normals[0], [0.0; 3]));
    }

    #[test]
    fn a_vertex_that_does_not_exist_is_named() {
        let fault = normals_of_faces(&[[0.0; 3]; 2], &[[0, 1, 2]]).unwrap_err().to_string();
        assert!(fault.starts_with("face 0 is [0, 1, 2] of 2 vertices"), "{fault}");
    }
}
