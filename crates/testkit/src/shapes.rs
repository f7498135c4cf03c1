//! Shapes for tests.

use glam::DVec3;
use wavesplat_core::{Mesh, Paint, Paths, Points, ShapeStyle, Shapes, Sizes, Thickness};

/// A sphere of `4 n²` triangles between circles of latitude, with the normals of the sphere. Those at the poles have no
/// area, half of them.
pub fn sphere_mesh(centre: DVec3, radius: f64, n: usize) -> Mesh {
    let n_around = 2 * n;
    let mut mesh = Mesh {
        vertices: Vec::new(),
        faces: Vec::new(),
        normals: Vec::new(),
        paint: Paint::Even([0.9, 0.5, 0.2]),
        style: ShapeStyle::default(),
    };
    for row in 0..=n {
        let (sin, cos) = (std::f64::consts::PI * row as f64 / n as f64).sin_cos();
        for column in 0..n_around {
            let (y, x) = (std::f64::consts::TAU * column as f64 / n_around as f64).sin_cos();
            let normal = DVec3::new(sin * x, sin * y, cos);
            mesh.vertices.push((centre + radius * normal).to_array());
            mesh.normals.push(normal.to_array().map(|c| c as f32));
        }
    }
    for row in 0..n {
        for column in 0..n_around {
            let at = |row: usize, column: usize| (row * n_around + column % n_around) as u32;
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            mesh.faces.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

/// A parallelogram of two triangles around a centre, half of whose sides are given.
pub fn sheet_mesh(centre: DVec3, half_x: DVec3, half_y: DVec3) -> Mesh {
    let corners = [-half_x - half_y, half_x - half_y, half_x + half_y, half_y - half_x];
    Mesh {
        vertices: corners.map(|corner| (centre + corner).to_array()).to_vec(),
        faces: vec![[0, 1, 2], [0, 2, 3]],
        normals: Vec::new(),
        paint: Paint::Even([0.2, 0.6, 0.9]),
        style: ShapeStyle::default(),
    }
}

/// Balls of one colour.
pub fn balls(balls: &[(DVec3, f64)]) -> Points {
    Points {
        centers: balls.iter().map(|(centre, _)| centre.to_array()).collect(),
        sizes: Sizes::Radii(balls.iter().map(|(_, radius)| *radius).collect()),
        paint: Paint::Even([0.3, 0.8, 0.3]),
        style: ShapeStyle::default(),
    }
}

/// Paths of one colour.
pub fn paths(paths: &[Vec<DVec3>], thickness: Thickness) -> Paths {
    let mut starts = vec![0];
    starts.extend(paths.iter().scan(0, |n, path| {
        *n += path.len() as u32;
        Some(*n)
    }));
    Paths {
        positions: paths.iter().flatten().map(DVec3::to_array).collect(),
        starts,
        thickness,
        paint: Paint::Even([0.8, 0.3, 0.7]),
        style: ShapeStyle::default(),
    }
}

/// Shapes that are only surfaces.
pub fn of_meshes(meshes: Vec<Mesh>) -> Shapes {
    Shapes::new(meshes, Vec::new(), Vec::new(), Vec::new()).expect("test shapes are valid")
}

/// Shapes that are only points.
pub fn of_points(points: Vec<Points>) -> Shapes {
    Shapes::new(Vec::new(), Vec::new(), points, Vec::new()).expect("test shapes are valid")
}

/// Shapes that are only lines.
pub fn of_paths(paths: Vec<Paths>) -> Shapes {
    Shapes::new(Vec::new(), paths, Vec::new(), Vec::new()).expect("test shapes are valid")
}
