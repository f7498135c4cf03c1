//! Where world positions lie on a base plane, and the rays of its texels in the world.
//!
//! A position has texel coordinates `(x, y)` and a place `s` along the ray of that texel: the slice coordinate with the
//! sign that makes it grow away from the eye.

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_compute::parallel;

use crate::view::base_plane::BasePlane;

/// Slices in front of the eye within which nothing is drawn.
pub const NEAR: f64 = 1e-3;

/// Largest slope of rays that a base plane in perspective serves, and some more for its margins.
const STEEPEST: f64 = 1.25;

/// A base plane and the world around it.
pub struct PlaneView<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    world_from_index: DAffine3,
    index_from_world: DAffine3,
    /// World steps along u, v and w.
    columns: [DVec3; 3],
    /// 1 where w grows away from the eye, else -1.
    sign: f64,
    /// Eye in index coordinates along u, v, w; `None` for parallel rays.
    eye: Option<[f64; 3]>,
    /// World way along the ray per slice, away from the eye: at texel (0, 0), and its change per texel along u and v.
    way: [DVec3; 3],
    /// Pixel position of texel position `(x, y, 1)`, times a number that is positive ahead of the eye.
    pixel_from_texel: DMat3,
    /// Half the size, in texels, of a disc of a pixel, which is the same everywhere for parallel rays.
    disc: Option<[f64; 2]>,
    /// The same of a ball of radius 1.
    ball: Option<[f64; 2]>,
}

/// A position on a base plane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Placed {
    /// Texel coordinates; 0 where `ahead` is not positive.
    pub x: f32,
    /// See `x`.
    pub y: f32,
    /// Place along the ray.
    pub s: f32,
    /// Slices ahead of the eye; 1 for parallel rays. Along a straight line, `1 / ahead` is linear in `x` and `y`.
    pub ahead: f32,
}

/// Half the size of something on a base plane, in texels along u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneReach {
    /// Nothing of it can be seen.
    Nowhere,
    /// Within this distance of its middle.
    Within([f64; 2]),
    /// Anywhere: it is around the eye.
    Everywhere,
}

impl<'a> PlaneView<'a> {
    /// A base plane of the index space of a grid.
    pub fn new(plane: &'a BasePlane, world_from_index: DAffine3) -> Self {
        let columns = plane.family.axes.map(|a| world_from_index.matrix3.col(a));
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        let slope = |i: f64, j: f64| plane.ray(i, j).slope;
        let first = slope(0.0, 0.0);
        let [along_u, along_v] = [slope(1.0, 0.0)[0] - first[0], slope(0.0, 1.0)[1] - first[1]];
        let way =
            [columns[0] * first[0] + columns[1] * first[1] + columns[2], columns[0] * along_u, columns[1] * along_v];
        let eye = plane.eye();
        let mut view = Self {
            plane,
            world_from_index,
            index_from_world: world_from_index.inverse(),
            columns,
            sign,
            eye,
            way: way.map(|way| way * sign),
            pixel_from_texel: plane.pixel_from_texel(),
            disc: None,
            ball: None,
        };
        if eye.is_none() {
            view.ball = Some(view.reach_of_unit_ball());
            view.disc = Some(view.reach_of_disc([0.0; 2], 1.0));
        }
        view
    }

    /// Slices that a unit of the world reaches over, at most.
    pub fn slices_per_unit(&self) -> f64 {
        self.index_from_world.matrix3.transpose().col(self.plane.family.axes[2]).length()
    }

    /// Index coordinates along u, v, w of a world position.
    pub fn uvw(&self, world: DVec3) -> [f64; 3] {
        self.plane.family.uvw(self.index_from_world.transform_point3(world))
    }

    /// Slices by which index coordinates are ahead of the eye; 1 for parallel rays.
    pub fn ahead(&self, [_, _, w]: [f64; 3]) -> f64 {
        self.eye.map_or(1.0, |eye| (w - eye[2]) * self.sign)
    }

    /// Place of index coordinates along u, v, w.
    pub fn place(&self, uvw @ [u, v, w]: [f64; 3]) -> Placed {
        let ahead = self.ahead(uvw);
        if ahead <= NEAR {
            return Placed { ahead: ahead as f32, ..Placed::default() };
        }
        let [(u0, du), (v0, dv)] = self.plane.sheet(w);
        let [x, y] = [(u - u0) / du, (v - v0) / dv];
        Placed { x: x as f32, y: y as f32, s: (w * self.sign) as f32, ahead: ahead as f32 }
    }

    /// Places of world positions.
    pub fn place_all(&self, positions: &[[f64; 3]]) -> Vec<Placed> {
        const SOME: usize = 4096;
        let mut placed = vec![Placed::default(); positions.len()];
        parallel::for_each_chunk(&mut placed, SOME, |k, some| {
            for (placed, position) in some.iter_mut().zip(&positions[k * SOME..]) {
                *placed = self.place(self.uvw(DVec3::from_array(*position)));
            }
        });
        placed
    }

    /// Index position of a place.
    pub fn index_at(&self, [x, y, s]: [f32; 3]) -> DVec3 {
        let w = f64::from(s) * self.sign;
        let [(u0, du), (v0, dv)] = self.plane.sheet(w);
        let [axis_u, axis_v, axis_w] = self.plane.family.axes;
        let mut index = DVec3::ZERO;
        index[axis_u] = u0 + du * f64::from(x);
        index[axis_v] = v0 + dv * f64::from(y);
        index[axis_w] = w;
        index
    }

    /// World way per slice along the ray of a texel position, away from the eye.
    #[inline(always)]
    pub fn way(&self, x: f64, y: f64) -> DVec3 {
        self.way[0] + self.way[1] * x + self.way[2] * y
    }

    /// Change of [`PlaneView::way`] per texel along u and along v.
    pub fn way_per_texel(&self) -> [DVec3; 2] {
        [self.way[1], self.way[2]]
    }

    /// World vector from a point to where the ray of a texel passes its slice: at texel (0, 0), and the change per texel
    /// along u and v. `uvw`: index coordinates of the point.
    pub fn from_point(&self, [u, v, w]: [f64; 3]) -> [DVec3; 3] {
        let [(u0, du), (v0, dv)] = self.plane.sheet(w);
        let [along_u, along_v, _] = self.columns;
        [along_u * (u0 - u) + along_v * (v0 - v), along_u * du, along_v * dv]
    }

    /// World position of index coordinates along u, v, w.
    pub fn world(&self, uvw: [f64; 3]) -> DVec3 {
        let mut index = DVec3::ZERO;
        for (axis, x) in self.plane.family.axes.into_iter().zip(uvw) {
            index[axis] = x;
        }
        self.world_from_index.transform_point3(index)
    }

    /// Place along the rays where they begin; `None` for parallel rays.
    pub fn eye_s(&self) -> Option<f64> {
        self.eye.map(|eye| eye[2] * self.sign)
    }

    /// How far a ball around index coordinates reaches on the plane.
    pub fn reach_of_ball(&self, uvw @ [u, v, w]: [f64; 3], radius: f64) -> PlaneReach {
        if let Some(ball) = self.ball {
            return PlaneReach::Within(ball.map(|half| half * radius));
        }
        // Half the size of the box around the ball, in samples along u, v, w.
        let inverse = self.index_from_world.matrix3.transpose();
        let half = self.plane.family.axes.map(|a| radius * inverse.col(a).length());
        let eye = self.eye.unwrap_or_default();
        let [nearest, furthest] = [-1.0, 1.0].map(|side| self.ahead(uvw) + side * half[2]);
        if furthest <= NEAR {
            return PlaneReach::Nowhere;
        }
        if nearest <= NEAR {
            let is_aside = |k: usize| (uvw[k] - eye[k]).abs() - half[k] > STEEPEST * furthest;
            return if is_aside(0) || is_aside(1) { PlaneReach::Nowhere } else { PlaneReach::Everywhere };
        }
        let middle = self.place(uvw);
        let mut reach = [0.0_f64; 2];
        for corner in 0..8 {
            let side = |bit: usize, half: f64| if corner >> bit & 1 == 0 { -half } else { half };
            let at = self.place([u + side(0, half[0]), v + side(1, half[1]), w + side(2, half[2])]);
            reach[0] = reach[0].max(f64::from(at.x - middle.x).abs());
            reach[1] = reach[1].max(f64::from(at.y - middle.y).abs());
        }
        PlaneReach::Within(reach)
    }

    /// Half the size of a ball of radius 1, in texels, for parallel rays.
    fn reach_of_unit_ball(&self) -> [f64; 2] {
        // The ray at an offset (x, y) passes the centre at the length of `m (x, y)`, so the ball is an ellipse.
        let [_, per_u, per_v] = self.from_point([0.0; 3]);
        let way = self.way[0].normalize();
        let [m, n] = [per_u, per_v].map(|per| per - way * per.dot(way));
        let [uu, uv, vv] = [m.dot(m), m.dot(n), n.dot(n)];
        let determinant = (uu * vv - uv * uv).max(f64::MIN_POSITIVE);
        [vv / determinant, uu / determinant].map(f64::sqrt)
    }

    /// Map from texel offsets to pixel offsets from a pixel position, near a texel position: numerators along x and y,
    /// and the denominator, each at that texel position and its change per texel along u and v.
    pub fn pixels_around(&self, [x, y]: [f64; 2], pixel: [f64; 2]) -> [[f32; 3]; 3] {
        let rows = self.pixel_from_texel.transpose();
        let last = rows.z_axis;
        let form = |row: DVec3| [row.dot(DVec3::new(x, y, 1.0)) as f32, row.x as f32, row.y as f32];
        [form(rows.x_axis - last * pixel[0]), form(rows.y_axis - last * pixel[1]), form(last)]
    }

    /// Pixel position of a texel position.
    pub fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let at = self.pixel_from_texel * DVec3::new(x, y, 1.0);
        [at.x / at.z, at.y / at.z]
    }

    /// Half the size, in texels, of a disc of a radius in pixels around a texel position.
    pub fn reach_of_disc(&self, [x, y]: [f64; 2], radius_px: f64) -> [f64; 2] {
        if let Some(disc) = self.disc {
            return disc.map(|half| half * radius_px);
        }
        let at = self.pixel([x, y]);
        let [along_u, along_v] = [self.pixel([x + 0.5, y]), self.pixel([x, y + 0.5])]
            .map(|next| [2.0 * (next[0] - at[0]), 2.0 * (next[1] - at[1])]);
        let determinant = (along_u[0] * along_v[1] - along_u[1] * along_v[0]).abs().max(1e-12);
        [along_v, along_u].map(|[a, b]| radius_px * (a * a + b * b).sqrt() / determinant)
    }
}
