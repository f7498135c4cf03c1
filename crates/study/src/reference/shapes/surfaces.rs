//! Triangles and cards: where a ray passes through them.

use glam::{DMat3, DVec2, DVec3};
use wavesplat_core::{Card, Mesh};

use super::box_tree::BoxTree;
use super::paint::color;
use super::shape_ray::{Met, ShapeRay};

/// The triangles of a mesh.
pub(super) struct Triangles<'a> {
    mesh: &'a Mesh,
    tree: BoxTree,
}

impl<'a> Triangles<'a> {
    /// The triangles of a mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        let bounds = |face: &[u32; 3]| {
            let [a, b, c] = corners(mesh, face);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        Self { mesh, tree: BoxTree::new(&mesh.faces.iter().map(bounds).collect::<Vec<_>>()) }
    }

    /// Calls `add` for every triangle that a ray passes through.
    pub fn meet(&self, ray: &ShapeRay, add: &mut impl FnMut(Met)) {
        self.tree.for_each_met(ray.origin, ray.direction, |k| {
            let face = &self.mesh.faces[k];
            let corners = corners(self.mesh, face);
            let Some(weights) = weights(ray, corners) else { return };
            let vertices = [0, 1, 2].map(|i| (face[i] as usize, weights[i]));
            let Some(rgba) = color(&self.mesh.paint, &vertices) else { return };
            let position: DVec3 = (0..3).map(|i| weights[i] * (corners[i] - ray.origin)).sum();
            let t = position.dot(ray.direction) / ray.direction.length_squared();
            add(Met { t, normal: self.normal(&vertices, corners), rgba });
        });
    }

    /// The normal where the vertices of a face have these weights; the face's own where the vertices have none.
    fn normal(&self, vertices: &[(usize, f64); 3], [a, b, c]: [DVec3; 3]) -> Option<DVec3> {
        let of_vertex = |v: usize| DVec3::from_array(self.mesh.normals[v].map(f64::from)).normalize_or_zero();
        let smooth = (!self.mesh.normals.is_empty())
            .then(|| vertices.iter().map(|(v, weight)| *weight * of_vertex(*v)).sum::<DVec3>());
        smooth.and_then(DVec3::try_normalize).or_else(|| (b - a).cross(c - a).try_normalize())
    }
}

/// Corners of a face.
fn corners(mesh: &Mesh, face: &[u32; 3]) -> [DVec3; 3] {
    face.map(|v| DVec3::from_array(mesh.vertices[v as usize]))
}

/// Weights of the corners where a ray passes through a triangle: the areas opposite to them, seen along the ray.
///
/// A ray through an edge that two triangles share passes through one of them, or, where the surface turns away from it
/// there, through both or none: it is taken as if it ran beside by a distance ε to the right and ε² upwards, which
/// decides alike for both, since the area of an edge's triangle changes nothing but its sign with the order of its ends
/// (after Woop, Benthin & Wald, *Watertight Ray/Triangle Intersection*, 2013).
fn weights(ray: &ShapeRay, corners: [DVec3; 3]) -> Option<[f64; 3]> {
    let (right, up) = ray.direction.normalize().any_orthonormal_pair();
    let [a, b, c] = corners.map(|corner| corner - ray.origin).map(|v| DVec2::new(v.dot(right), v.dot(up)));
    let edges = [[b, c], [c, a], [a, b]];
    let is_left = |[from, to]: [DVec2; 2]| {
        let area = from.perp_dot(to);
        if area == 0.0 { from.y > to.y || (from.y == to.y && from.x < to.x) } else { area > 0.0 }
    };
    let sides = edges.map(is_left);
    let areas = edges.map(|[from, to]| from.perp_dot(to));
    let sum: f64 = areas.iter().sum();
    (sides[0] == sides[1] && sides[1] == sides[2] && sum != 0.0).then(|| areas.map(|area| area / sum))
}

/// Where a ray passes through a card.
pub(super) fn meet_card(card: &Card, ray: &ShapeRay) -> Option<Met> {
    let [corner, along_x, along_y] = [card.corner, card.along_x, card.along_y].map(DVec3::from_array);
    let matrix = DMat3::from_cols(along_x, along_y, -ray.direction);
    if matrix.determinant() == 0.0 {
        return None;
    }
    let [x, y, t] = (matrix.inverse() * (ray.origin - corner)).to_array();
    let is_on = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
    is_on.then(|| Met { t, normal: None, rgba: pixel(card, [x, y]) })
}

/// The colour of a card at a share of its width and height: bilinear between the centres of pixels. Colours mix by
/// their opacity, since the colour of a clear pixel means nothing.
fn pixel(card: &Card, at: [f64; 2]) -> [f64; 4] {
    let taps = [0, 1].map(|axis| {
        let last = card.size[axis] - 1;
        let place = (at[axis] * card.size[axis] as f64 - 0.5).clamp(0.0, last as f64);
        let first = place.floor() as usize;
        [(first, 1.0 - place.fract()), ((first + 1).min(last), place.fract())]
    });
    let mut rgba = [0.0; 4];
    for (row, weight_y) in taps[1] {
        for (column, weight_x) in taps[0] {
            let color = card.rgba[row * card.size[0] + column];
            let alpha = weight_x * weight_y * f64::from(color[3]);
            (0..3).for_each(|c| rgba[c] += alpha * f64::from(color[c]));
            rgba[3] += alpha;
        }
    }
    let [r, g, b, alpha] = rgba;
    if alpha > 0.0 { [r / alpha, g / alpha, b / alpha, alpha] } else { [0.0; 4] }
}

#[cfg(test)]
mod tests {
    use wavesplat_core::{Paint, ShapeStyle};

    use super::super::tests::{random_point, ray};
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-9
    }

    #[test]
    fn weights_are_those_of_the_corners() {
        for k in 0..200 {
            let corners = [0, 1, 2].map(|c| 5.0 * random_point(5 * k + c));
            let random = random_point(5 * k + 3).abs();
            let [x, y] =
                if random.x + random.y < 1.0 { [random.x, random.y] } else { [1.0 - random.x, 1.0 - random.y] };
            let target = corners[0] + x * (corners[1] - corners[0]) + y * (corners[2] - corners[0]);
            let origin = 9.0 * random_point(5 * k + 4);
            let got = DVec3::from_array(weights(&ray(origin, target - origin), corners).unwrap());
            assert!(close(got, DVec3::new(1.0 - x - y, x, y)), "{got}");
            let beside = corners[0] - 0.1 * (target - corners[0]);
            assert_eq!(weights(&ray(origin, beside - origin), corners), None);
        }
    }

    fn octahedron(paint: Paint, normals: Vec<[f32; 3]>) -> Mesh {
        let vertices = vec![
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let faces = (0..8).map(|k| [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2)]).collect();
        Mesh { vertices, faces, normals, paint, style: ShapeStyle::default() }
    }

    /// Through faces, edges and corners alike, a ray enters and leaves a closed surface as often.
    #[test]
    fn closed_surfaces_are_tight() {
        let mesh = octahedron(Paint::Even([1.0; 3]), Vec::new());
        let triangles = Triangles::new(&mesh);
        let mut n_edges = 0;
        for x in -5..=5 {
            for y in -5..=5 {
                let (x, y) = (0.25 * f64::from(x), 0.25 * f64::from(y));
                for axis in 0..3 {
                    let mut origin = [0.0; 3];
                    (origin[(axis + 1) % 3], origin[(axis + 2) % 3]) = (x, y);
                    let ray = ray(DVec3::from_array(origin) - 4.0 * DVec3::AXES[axis], DVec3::AXES[axis]);
                    let mut hits = Vec::new();
                    triangles.meet(&ray, &mut |met| hits.push(met.t));
                    hits.sort_by(f64::total_cmp);
                    let inside = 1.0 - x.abs() - y.abs();
                    n_edges += usize::from(x == 0.0 || y == 0.0 || inside == 0.0);
                    if inside > 0.0 {
                        assert_eq!(hits, [4.0 - inside, 4.0 + inside], "{x} {y}");
                    } else {
                        // At its rim the surface is met twice at a point, or not at all.
                        let is_rim = inside == 0.0 && hits == [4.0, 4.0];
                        assert!(hits.is_empty() || is_rim, "{x} {y}: {hits:?}");
                    }
                }
            }
        }
        assert!(n_edges > 50);
    }

    #[test]
    fn normals_and_colours_are_interpolated_in_space() {
        let rgba = (0..6).map(|k| [0.0, 0.2 * k as f32, 0.0, 1.0]).collect();
        let plain = octahedron(Paint::Even([1.0; 3]), Vec::new());
        let normals = plain.vertices.iter().map(|v| v.map(|x| x as f32)).collect();
        let mesh = octahedron(Paint::Each(rgba), normals);
        let met = |mesh: &Mesh, origin: DVec3, target: DVec3| {
            let mut hits = Vec::new();
            Triangles::new(mesh).meet(&ray(origin, target - origin), &mut |met| hits.push(met));
            hits.into_iter().min_by(|a, b| a.t.total_cmp(&b.t)).unwrap()
        };
        // From an eye near the face, so that weights in the picture would be others.
        let target = DVec3::new(0.25, 0.125, 0.625);
        let got = met(&mesh, DVec3::new(0.3, 0.1, 0.9), target);
        assert!((got.t - 1.0).abs() < 1e-12);
        assert!(close(got.normal.unwrap(), target.normalize()));
        assert!((got.rgba[1] - (0.125 * 0.4 + 0.625 * 0.8)).abs() < 1e-6, "{:?}", got.rgba);
        let flat = Mesh { normals: Vec::new(), ..mesh };
        let normal = met(&flat, DVec3::new(0.3, 0.1, 0.9), target).normal.unwrap();
        assert!(close(normal * normal.x.signum(), DVec3::ONE.normalize()));
    }

    #[test]
    fn cards_show_their_pixels() {
        let card = Card {
            corner: [1.0, 1.0, 1.0],
            along_x: [4.0, 0.0, 0.0],
            along_y: [1.0, 2.0, 0.0],
            size: [2, 1],
            rgba: vec![[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.5]],
            style: ShapeStyle::default(),
        };
        let at = |x: f64, y: f64| {
            let target = DVec3::new(1.0 + 4.0 * x + y, 1.0 + 2.0 * y, 1.0);
            let origin = DVec3::new(7.0, -3.0, 9.0);
            meet_card(&card, &ray(origin, target - origin)).map(|met| {
                assert!((met.t - 1.0).abs() < 1e-12 && met.normal.is_none());
                met.rgba.map(|c| (1e6 * c).round() / 1e6)
            })
        };
        assert_eq!([at(0.01, 0.01), at(0.25, 0.99)], [Some([1.0, 0.0, 0.0, 1.0]); 2]);
        assert_eq!(at(0.5, 0.3), Some([0.666_667, 0.0, 0.333_333, 0.75]));
        assert_eq!([at(-0.01, 0.5), at(1.01, 0.5), at(0.5, -0.01), at(0.5, 1.01)], [None; 4]);
    }
}
