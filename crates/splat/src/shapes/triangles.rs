//! Triangles on a base plane: which places of a texel they cover, and what is there.
//!
//! A place is inside if it is on the inner side of all three edges. Both triangles at an edge work out the same number
//! for a place, from the ends of the edge in one order, and take opposite signs of it: each place belongs to exactly
//! one of them, and there are no gaps.

use glam::Vec3;
use wavesplat_core::Mesh;

use crate::shapes::canvas::{Canvas, OnPlane, RowRange, SurfacePart, rows_of, vector};
use crate::shapes::cover::Covering;
use crate::shapes::fragments::{ALONE, Crossing};
use crate::shapes::paint::color_at;
use crate::shapes::placement::{NEAR, Placed, PlaneView};
use crate::shapes::samples::{Mask, N, OFFSETS, mask_of, mean_offset};

/// A mesh on a base plane.
pub struct MeshOnPlane<'a> {
    mesh: &'a Mesh,
    vertices: Vec<Placed>,
}

impl<'a> MeshOnPlane<'a> {
    /// Places the vertices.
    pub fn new(mesh: &'a Mesh, view: &PlaneView) -> Self {
        Self { mesh, vertices: view.place_all(&mesh.vertices) }
    }

    /// World normal of a face, for meshes without normals of vertices.
    fn face_normal(&self, face: [u32; 3]) -> Vec3 {
        let [a, b, c] = face.map(|v| vector(self.mesh.vertices[v as usize]));
        (b - a).cross(c - a).normalize_or_zero().as_vec3()
    }

    #[inline(always)]
    fn draw_triangle(
        &self,
        face: [u32; 3],
        (corners, weights): ([Placed; 3], Option<[[f32; 3]; 3]>),
        canvas: &mut Canvas,
    ) {
        let flat = if self.mesh.normals.is_empty() { Some(self.face_normal(face)) } else { None };
        cover(corners, canvas, |canvas, hit| {
            // Weights of the triangle's own corners, where the near plane has cut it.
            let own = match weights {
                None => hit.weights,
                Some(of_corners) => {
                    [0, 1, 2].map(|k| (0..3).map(|corner| hit.weights[corner] * of_corners[corner][k]).sum())
                }
            };
            let Some(rgba) = color_at(&self.mesh.paint, face, own) else { return };
            let normal = flat.unwrap_or_else(|| {
                let mut sum = Vec3::ZERO;
                for (vertex, weight) in face.into_iter().zip(own) {
                    sum += Vec3::from_array(self.mesh.normals[vertex as usize]).normalize_or_zero() * weight;
                }
                sum
            });
            let TriangleHit { texel, at, mask, s, .. } = hit;
            let normal = Some(normal);
            canvas.add(
                self.mesh.style,
                &SurfacePart {
                    texel,
                    at,
                    mask,
                    s,
                    rgba,
                    normal,
                    side: Crossing::Sheet,
                    solid: ALONE,
                    is_hidden: false,
                    covering: Covering::Behind,
                },
            );
        });
    }
}

impl OnPlane for MeshOnPlane<'_> {
    fn n_elements(&self) -> usize {
        self.mesh.faces.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        let corners = self.mesh.faces[element].map(|v| self.vertices[v as usize]);
        rows_of_triangle(corners, view)
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let face = self.mesh.faces[element];
        let corners = face.map(|v| self.vertices[v as usize]);
        if corners.iter().all(|corner| is_ahead(*corner)) {
            return self.draw_triangle(face, (corners, None), canvas);
        }
        let own = face.map(|v| canvas.view.uvw(vector(self.mesh.vertices[v as usize])));
        for (corners, weights) in cut_by_near_plane(own, canvas.view) {
            self.draw_triangle(face, (corners, Some(weights)), canvas);
        }
    }
}

/// Whether a corner lies ahead of the near plane.
pub fn is_ahead(corner: Placed) -> bool {
    f64::from(corner.ahead) > NEAR
}

/// Rows that a triangle reaches.
pub fn rows_of_triangle(corners: [Placed; 3], view: &PlaneView) -> RowRange {
    let n_ahead = corners.iter().filter(|corner| is_ahead(**corner)).count();
    if n_ahead == 0 {
        return None;
    }
    if n_ahead < 3 {
        return rows_of(view, [0.0, view.plane.size[1] as f64]);
    }
    let [n_u, _] = view.plane.size;
    let [xs, ys] = [corners.map(|c| c.x), corners.map(|c| c.y)].map(ends_of);
    if xs[1] < -0.5 || xs[0] > n_u as f64 - 0.5 {
        return None;
    }
    rows_of(view, ys)
}

/// Least and largest of three numbers.
fn ends_of([a, b, c]: [f32; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)].map(f64::from)
}

/// The parts of a triangle ahead of the near plane, as triangles: their corners, and the weights of the triangle's own
/// corners there. `own`: index coordinates of its corners along u, v, w.
pub fn cut_by_near_plane(own: [[f64; 3]; 3], view: &PlaneView) -> Vec<([Placed; 3], [[f32; 3]; 3])> {
    // A hair ahead of it, so that rounding leaves corners ahead.
    let near = NEAR * (1.0 + 1e-3);
    let depth = own.map(|uvw| view.ahead(uvw) - near);
    let mut kept: Vec<(Placed, [f32; 3])> = Vec::new();
    for k in 0..3 {
        let next = (k + 1) % 3;
        let unit = |k: usize| [0, 1, 2].map(|c| if c == k { 1.0_f32 } else { 0.0 });
        if depth[k] > 0.0 {
            kept.push((view.place(own[k]), unit(k)));
        }
        if (depth[k] > 0.0) != (depth[next] > 0.0) {
            let share = depth[k] / (depth[k] - depth[next]);
            let at = [0, 1, 2].map(|c| own[k][c] + share * (own[next][c] - own[k][c]));
            let weights = [0, 1, 2].map(|c| unit(k)[c] + share as f32 * (unit(next)[c] - unit(k)[c]));
            kept.push((view.place(at), weights));
        }
    }
    let fan = (2..kept.len()).map(|k| [0, k - 1, k]);
    fan.map(|corners| (corners.map(|k| kept[k].0), corners.map(|k| kept[k].1))).collect()
}

/// Part of a triangle in a texel.
pub struct TriangleHit {
    /// Texel.
    pub texel: [usize; 2],
    /// Texel position of the middle of the covered places.
    pub at: [f32; 2],
    /// Covered places.
    pub mask: Mask,
    /// Place along the ray at `at`.
    pub s: f32,
    /// Weights of the corners at `at`; they add up to 1.
    pub weights: [f32; 3],
}

/// Edge of a triangle.
#[derive(Clone, Copy)]
struct Edge {
    from: [f32; 2],
    way: [f32; 2],
    /// Whether inside is where the number is positive.
    is_positive: bool,
    /// Largest change of the number from the middle of a texel to its border.
    most: f32,
}

impl Edge {
    /// The edge between two corners, seen from the third.
    #[inline(always)]
    fn new(a: Placed, b: Placed, third: Placed) -> Self {
        let (a, b) = ([a.x, a.y], [b.x, b.y]);
        let (from, to) = if (a[0], a[1]) <= (b[0], b[1]) { (a, b) } else { (b, a) };
        let way = [to[0] - from[0], to[1] - from[1]];
        let edge = Self { from, way, is_positive: true, most: 0.5 * (way[0].abs() + way[1].abs()) };
        Self { is_positive: edge.at([third.x, third.y]) > 0.0, ..edge }
    }

    /// Twice the area of the triangle of the edge and a position, with the sign of the side.
    #[inline(always)]
    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.way[0] * (y - self.from[1]) - self.way[1] * (x - self.from[0])
    }

    /// The same, positive inside.
    #[inline(always)]
    fn inside(&self, at: [f32; 2]) -> f32 {
        if self.is_positive { self.at(at) } else { -self.at(at) }
    }

    /// Places of a texel on the inner side.
    #[inline(always)]
    fn mask(&self, [x, y]: [f32; 2]) -> Mask {
        let middle = self.inside([x, y]);
        // Some slack for rounding.
        let most = self.most * 1.001 + f32::EPSILON * middle.abs();
        if middle > most {
            return Mask::MAX;
        }
        if middle < -most {
            return 0;
        }
        let mut value = [0.0; N];
        for k in 0..N {
            value[k] = self.at([x + OFFSETS[0][k], y + OFFSETS[1][k]]);
        }
        // On the edge itself, the side where the number is positive counts as inside.
        if self.is_positive { mask_of(value.map(|v| v >= 0.0)) } else { mask_of(value.map(|v| v < 0.0)) }
    }
}

/// Calls `with` for every texel of a canvas of which a triangle covers a place. The corners lie ahead of the near
/// plane.
#[inline(always)]
pub fn cover(corners: [Placed; 3], canvas: &mut Canvas, mut with: impl FnMut(&mut Canvas, TriangleHit)) {
    let [a, b, c] = corners;
    let edges = [Edge::new(b, c, a), Edge::new(c, a, b), Edge::new(a, b, c)];
    let double_area = edges[2].inside([c.x, c.y]);
    // Written so that NaN is refused, too.
    if !(double_area > 0.0 && double_area.is_finite()) {
        return;
    }
    let per_ahead = corners.map(|corner| 1.0 / corner.ahead);
    let ends = ends_of(corners.map(|corner| corner.s)).map(|s| s as f32);
    let rows = canvas.own_rows(ends_of(corners.map(|corner| corner.y)));
    let columns = canvas.columns(ends_of(corners.map(|corner| corner.x)));
    for j in rows {
        for i in columns.clone() {
            if canvas.is_hidden([i, j], ends[0]) {
                continue;
            }
            let middle = [i as f32, j as f32];
            let mut mask = Mask::MAX;
            for edge in &edges {
                mask &= edge.mask(middle);
                if mask == 0 {
                    break;
                }
            }
            if mask == 0 {
                continue;
            }
            let offset = mean_offset(mask);
            let at = [middle[0] + offset[0], middle[1] + offset[1]];
            // Perspective-correct weights: areas, divided by the distances.
            let areas = [0, 1, 2].map(|k| edges[k].inside(at).max(0.0) * per_ahead[k]);
            let inverse = 1.0 / (areas[0] + areas[1] + areas[2]);
            let weights = areas.map(|area| area * inverse);
            let s = weights[0] * corners[0].s + weights[1] * corners[1].s + weights[2] * corners[2].s;
            with(canvas, TriangleHit { texel: [i, j], at, mask, s: s.clamp(ends[0], ends[1]), weights });
        }
    }
}
