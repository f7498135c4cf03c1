//! Balls and tubes on a base plane: rays meet them where quadratic equations say.
//!
//! With the vector `o` from a centre to a point of the ray and the way `d` of the ray per slice, a ray meets a ball of
//! radius `r` at `t = −o·d / d² ∓ √((r² − p²) / d²)` slices from there, where `p` is the part of `o` across the ray. A
//! tube is made of pieces, each a cylinder with half balls at its ends; the same holds for a cylinder with the parts of
//! `o` and `d` across its axis. The parts across are worked out first, since squares of long vectors would lose the
//! small radius. Where pieces of a path overlap, the rays enter and leave their union
//! ([`crate::shapes::fragments`]).

use glam::{DVec3, Vec3};
use wavesplat_core::{Paths, Points};

use crate::shapes::fragments::{ALONE, Side};
use crate::shapes::paint::color_at;
use crate::shapes::placement::{NEAR, Placed, PlaneView, Reach};
use crate::shapes::raster::{Canvas, OnPlane, Rows, Surface, rows_of, vector};
use crate::shapes::samples::{N, OFFSETS, mask_of, mean_offset};

/// Balls on a base plane.
pub struct Balls<'a> {
    points: &'a Points,
    radii: &'a [f64],
}

impl<'a> Balls<'a> {
    /// Balls around points.
    pub fn new(points: &'a Points, radii: &'a [f64]) -> Self {
        Self { points, radii }
    }
}

impl OnPlane for Balls<'_> {
    fn n_elements(&self) -> usize {
        self.points.centers.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> Rows {
        let uvw = view.uvw(vector(self.points.centers[element]));
        rows_of_ends(view, &[End::new(view, uvw, self.radii[element])])
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let center = self.points.centers[element];
        let piece = Piece { ends: [vector(center); 2], radius: self.radii[element] };
        let Some(rgba) = color_at(&self.points.paint, [element as u32], [1.0]) else { return };
        let is_opaque = rgba[3] * self.points.style.opacity >= 1.0;
        draw_piece(&piece, is_opaque, canvas, |canvas, hit| {
            let Met { texel, at, mask, s, normal, side, .. } = hit;
            let surface = Surface { texel, at, mask, s, rgba, normal: Some(normal), side, solid: ALONE };
            canvas.add(self.points.style, &surface);
        });
    }
}

/// Tubes on a base plane.
pub struct Tubes<'a> {
    paths: &'a Paths,
    radius: f64,
    /// Numbers of both positions of each piece, and of its solid.
    pieces: Vec<[u32; 3]>,
}

impl<'a> Tubes<'a> {
    /// Tubes around paths. `first_solid`: number of the first path's solid.
    pub fn new(paths: &'a Paths, radius: f64, first_solid: u32) -> Self {
        Self { paths, radius, pieces: pieces_of(paths, first_solid) }
    }
}

/// Pieces of paths: numbers of both positions, and of the path's solid. A path of one position has one piece, from there
/// to there.
pub fn pieces_of(paths: &Paths, first_solid: u32) -> Vec<[u32; 3]> {
    let mut pieces = Vec::with_capacity(paths.positions.len());
    for (path, ends) in paths.starts.windows(2).enumerate() {
        let solid = first_solid + path as u32;
        match ends[1] - ends[0] {
            0 => {}
            1 => pieces.push([ends[0], ends[0], solid]),
            _ => pieces.extend((ends[0]..ends[1] - 1).map(|k| [k, k + 1, solid])),
        }
    }
    pieces
}

impl Tubes<'_> {
    fn piece(&self, element: usize) -> Piece {
        let [a, b, _] = self.pieces[element];
        Piece { ends: [a, b].map(|k| vector(self.paths.positions[k as usize])), radius: self.radius }
    }
}

impl OnPlane for Tubes<'_> {
    fn n_elements(&self) -> usize {
        self.pieces.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> Rows {
        let Piece { ends, radius } = self.piece(element);
        rows_of_ends(view, &ends.map(|end| End::new(view, view.uvw(end), radius)))
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let [a, b, solid] = self.pieces[element];
        let style = self.paths.style;
        // Which of the pieces of a path a ray leaves last is not known here.
        draw_piece(&self.piece(element), false, canvas, |canvas, hit| {
            let Met { texel, at, mask, s, normal, side, along } = hit;
            let Some(rgba) = color_at(&self.paths.paint, [a, b], [1.0 - along, along]) else { return };
            canvas.add(style, &Surface { texel, at, mask, s, rgba, normal: Some(normal), side, solid });
        });
    }
}

/// A cylinder with half balls at its ends; a ball where both ends are one.
struct Piece {
    ends: [DVec3; 2],
    radius: f64,
}

/// An end of a piece on a base plane.
struct End {
    placed: Placed,
    reach: Reach,
}

impl End {
    fn new(view: &PlaneView, uvw: [f64; 3], radius: f64) -> Self {
        Self { placed: view.place(uvw), reach: view.reach_of_ball(uvw, radius) }
    }
}

/// Where a ray meets a piece, on the covered places of a texel.
struct Met {
    texel: [usize; 2],
    at: [f32; 2],
    mask: u16,
    s: f32,
    normal: Vec3,
    side: Side,
    /// Share of the way from the first end to the second.
    along: f32,
}

fn rows_of_ends(view: &PlaneView, ends: &[End]) -> Rows {
    if ends.iter().all(|end| end.reach == Reach::Nowhere) {
        return None;
    }
    let [mut x, mut y] = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for end in ends {
        let Reach::Within(reach) = end.reach else { return rows_of(view, [0.0, view.plane.size[1] as f64]) };
        let [at_x, at_y] = [end.placed.x, end.placed.y].map(f64::from);
        x = [x[0].min(at_x - reach[0]), x[1].max(at_x + reach[0])];
        y = [y[0].min(at_y - reach[1]), y[1].max(at_y + reach[1])];
    }
    if x[1] < -0.5 || x[0] > view.plane.size[0] as f64 - 0.5 {
        return None;
    }
    rows_of(view, y)
}

/// Columns that a chain of two discs reaches in a row. `ends`: texel positions; `reach`: half the discs' sizes.
pub fn columns_in_row(ends: [[f64; 2]; 2], reach: [f64; 2], row: f64) -> [f64; 2] {
    let [a, b] = if ends[0][1] <= ends[1][1] { ends } else { [ends[1], ends[0]] };
    let height = b[1] - a[1];
    // The part of the way whose discs reach the row.
    let shares = [row - 0.5 - reach[1], row + 0.5 + reach[1]]
        .map(|y| if height > 1e-9 { ((y - a[1]) / height).clamp(0.0, 1.0) } else { f64::NAN });
    let [from, to] = if shares[0].is_nan() { [0.0, 1.0] } else { shares };
    let [x, y] = [from, to].map(|share| a[0] + share * (b[0] - a[0]));
    [x.min(y) - reach[0], x.max(y) + reach[0]]
}

/// Calls `with` where rays enter a piece and where they leave it; where it `is_opaque`, leaving counts only if the eye is
/// inside.
#[inline(always)]
fn draw_piece(piece: &Piece, is_opaque: bool, canvas: &mut Canvas, mut with: impl FnMut(&mut Canvas, Met)) {
    let view = canvas.view;
    let uvw = piece.ends.map(|end| view.uvw(end));
    let ends = uvw.map(|uvw| End::new(view, uvw, piece.radius));
    let [n_u, n_v] = view.plane.size;
    let reach = match [ends[0].reach, ends[1].reach] {
        [Reach::Within(a), Reach::Within(b)] => Some([a[0].max(b[0]), a[1].max(b[1])]),
        _ => None,
    };
    let places = [0, 1].map(|k| [ends[k].placed.x, ends[k].placed.y].map(f64::from));
    let rows = match reach {
        Some(reach) => {
            let [a, b] = [places[0][1], places[1][1]];
            canvas.own_rows([a.min(b) - reach[1], a.max(b) + reach[1]])
        }
        None => canvas.own_rows([0.0, n_v as f64]),
    };
    let rays = PieceRays::new(piece, uvw[0], view);
    for j in rows {
        let columns = match reach {
            Some(reach) => canvas.columns(columns_in_row(places, reach, j as f64)),
            None => 0..n_u,
        };
        for i in columns {
            let [enter, leave] = rays.masks([i, j], view);
            let leave = if is_opaque { leave & !enter } else { leave };
            for (mask, side) in [(enter, Side::Enter), (leave, Side::Leave)] {
                if mask == 0 {
                    continue;
                }
                let offset = mean_offset(mask);
                let (ray, way) = rays.ray([i, j], offset, view);
                let Some(ends) = rays.meet(ray, way) else { continue };
                let t = if side == Side::Enter { ends[0] } else { ends[1] };
                let from_first = ray + way * t;
                let along = (from_first.dot(rays.axis) * rays.per_axis).clamp(0.0, 1.0);
                let at = [i as f32 + offset[0], j as f32 + offset[1]];
                let normal = from_first - rays.axis * along;
                with(canvas, Met { texel: [i, j], at, mask, s: rays.s + t, normal, side, along });
            }
        }
    }
}

/// The rays of a base plane as seen from the first end of a piece.
struct PieceRays {
    /// Vector from that end to where the ray of texel (0, 0) passes its slice, and the change per texel.
    from_end: [DVec3; 3],
    per_texel: [Vec3; 2],
    way_per_texel: [Vec3; 2],
    /// Place of that end along the rays.
    s: f32,
    /// From the first end to the second; and its inverse square, 0 for a ball.
    axis: Vec3,
    per_axis: f32,
    radius_squared: f32,
    /// Place along the rays, less `s`, in front of which nothing is met.
    nearest: f32,
}

impl PieceRays {
    fn new(piece: &Piece, uvw: [f64; 3], view: &PlaneView) -> Self {
        let from_end = view.from_point(uvw);
        let axis = (piece.ends[1] - piece.ends[0]).as_vec3();
        let square = axis.length_squared();
        let s = uvw[2] * if view.plane.family.ascending { 1.0 } else { -1.0 };
        Self {
            from_end,
            per_texel: [from_end[1], from_end[2]].map(|v| v.as_vec3()),
            way_per_texel: view.way_per_texel().map(|v| v.as_vec3()),
            s: s as f32,
            axis,
            per_axis: if square > 0.0 { 1.0 / square } else { 0.0 },
            radius_squared: (piece.radius * piece.radius) as f32,
            nearest: view.eye_s().map_or(f32::NEG_INFINITY, |eye| (eye + NEAR - s) as f32),
        }
    }

    /// Vector from the first end to a point of a ray, and the ray's way per slice. `offset`: from the middle of the texel.
    #[inline(always)]
    fn ray(&self, [i, j]: [usize; 2], offset: [f32; 2], view: &PlaneView) -> (Vec3, Vec3) {
        let (x, y) = (i as f64, j as f64);
        let middle = (self.from_end[0] + self.from_end[1] * x + self.from_end[2] * y).as_vec3();
        let way = view.way(x, y).as_vec3();
        (
            middle + self.per_texel[0] * offset[0] + self.per_texel[1] * offset[1],
            way + self.way_per_texel[0] * offset[0] + self.way_per_texel[1] * offset[1],
        )
    }

    /// Places of a texel whose rays enter the piece, and that leave it, ahead of the eye.
    #[inline(always)]
    fn masks(&self, texel: [usize; 2], view: &PlaneView) -> [u16; 2] {
        let (middle, way) = self.ray(texel, [0.0; 2], view);
        let [mut enters, mut leaves] = [[false; N]; 2];
        for k in 0..N {
            let (x, y) = (OFFSETS[0][k], OFFSETS[1][k]);
            let ray = middle + self.per_texel[0] * x + self.per_texel[1] * y;
            let way = way + self.way_per_texel[0] * x + self.way_per_texel[1] * y;
            if let Some([enter, leave]) = self.meet(ray, way) {
                enters[k] = enter > self.nearest;
                leaves[k] = leave > self.nearest;
            }
        }
        [mask_of(enters), mask_of(leaves)]
    }

    /// Slices from the first end to where a ray enters the piece, and to where it leaves it.
    #[inline(always)]
    fn meet(&self, ray: Vec3, way: Vec3) -> Option<[f32; 2]> {
        if self.per_axis == 0.0 {
            return self.meet_ball(ray, way);
        }
        let [m, n] = [ray, way].map(|v| v.dot(self.axis) * self.per_axis);
        let (across, way_across) = (ray - self.axis * m, way - self.axis * n);
        let square = way_across.length_squared();
        // A ray along the axis meets the ends only.
        let is_along = square <= 1e-10 * way.length_squared();
        let (middle, half) = if is_along {
            if across.length_squared() > self.radius_squared {
                return None;
            }
            (0.0, f32::INFINITY)
        } else {
            let middle = -across.dot(way_across) / square;
            let left = self.radius_squared - (across + way_across * middle).length_squared();
            if left < 0.0 {
                return None;
            }
            (middle, (left / square).sqrt())
        };
        let mut ends = [0.0; 2];
        for (end, side) in ends.iter_mut().zip([-1.0, 1.0]) {
            *end = middle + side * half;
            // Where the ray meets the cylinder beyond its ends, the balls there count.
            let along = if is_along { side * n * f32::INFINITY } else { m + *end * n };
            if !(0.0..=1.0).contains(&along) {
                let ball = if along < 0.0 { ray } else { ray - self.axis };
                let of_ball = self.meet_ball(ball, way)?;
                *end = if side < 0.0 { of_ball[0] } else { of_ball[1] };
            }
        }
        Some(ends)
    }

    /// The same for a ball around the point that `ray` begins at.
    #[inline(always)]
    fn meet_ball(&self, ray: Vec3, way: Vec3) -> Option<[f32; 2]> {
        let square = way.length_squared();
        let middle = -ray.dot(way) / square;
        let left = self.radius_squared - (ray + way * middle).length_squared();
        if left < 0.0 {
            return None;
        }
        let half = (left / square).sqrt();
        Some([middle - half, middle + half])
    }
}
