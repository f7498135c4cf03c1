//! Strokes and discs on a base plane: lines and points of a constant size in pixels. They are flat, and not lit.

use wavesplat_core::{Paint, Paths, Points, ShapeStyle};

use crate::shapes::canvas::{Canvas, OnPlane, RowRange, SurfacePart, rows_of, vector};
use crate::shapes::cover::Covering;
use crate::shapes::fragments::{ALONE, Crossing};
use crate::shapes::paint::color_at;
use crate::shapes::placement::{NEAR, Placed, PlaneView};
use crate::shapes::samples::{Mask, N, OFFSETS, mask_of, mean_offset};
use crate::shapes::solids::{columns_in_row, pieces_of};
use crate::shapes::triangles::is_ahead;

/// Lines of a width in pixels on a base plane.
pub struct StrokesOnPlane<'a> {
    paths: &'a Paths,
    half_px: f64,
    /// Numbers of both positions of each piece, and of its path.
    pieces: Vec<[u32; 3]>,
    placed: Vec<Placed>,
    covering: Covering,
}

impl<'a> StrokesOnPlane<'a> {
    /// Places the positions. `first_solid`: number of the first path.
    pub fn new(paths: &'a Paths, width_px: f64, first_solid: u32, view: &PlaneView) -> Self {
        let placed = view.place_all(&paths.positions);
        let pieces = pieces_of(paths, first_solid, |k| placed[k as usize].s);
        let covering = match paths.paint {
            Paint::Even(_) => Covering::BehindAndThere,
            _ if paths.paint.is_opaque() => Covering::Behind,
            _ => Covering::Nothing,
        };
        Self { paths, half_px: 0.5 * width_px, pieces, placed, covering }
    }

    /// Both ends of a piece, cut at the near plane, and their shares of the way; `None` where none is ahead of it.
    fn ends(&self, element: usize, view: &PlaneView) -> Option<([Placed; 2], [f32; 2])> {
        let [a, b, _] = self.pieces[element];
        let ends = [a, b].map(|k| self.placed[k as usize]);
        match ends.map(is_ahead) {
            [true, true] => Some((ends, [0.0, 1.0])),
            [false, false] => None,
            [is_first, _] => {
                let uvw = [a, b].map(|k| view.uvw(vector(self.paths.positions[k as usize])));
                let depth = uvw.map(|uvw| view.ahead(uvw) - NEAR * (1.0 + 1e-3));
                let share = depth[0] / (depth[0] - depth[1]);
                let cut = view.place([0, 1, 2].map(|c| uvw[0][c] + share * (uvw[1][c] - uvw[0][c])));
                let share = share as f32;
                Some(if is_first { ([ends[0], cut], [0.0, share]) } else { ([cut, ends[1]], [share, 1.0]) })
            }
        }
    }
}

impl OnPlane for StrokesOnPlane<'_> {
    fn n_elements(&self) -> usize {
        self.pieces.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        let (ends, _) = self.ends(element, view)?;
        rows_of_stroke(ends, self.half_px, view)
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let Some((ends, shares)) = self.ends(element, canvas.view) else { return };
        let [a, b, solid] = self.pieces[element];
        let style = ShapeStyle { is_lit: false, ..self.paths.style };
        draw_stroke(ends, self.half_px, canvas, |canvas, StrokeHit { texel, at, mask, s, along }| {
            let along = shares[0] + along * (shares[1] - shares[0]);
            let Some(rgba) = color_at(&self.paths.paint, [a, b], [1.0 - along, along]) else { return };
            canvas.add(
                style,
                &SurfacePart {
                    texel,
                    at,
                    mask,
                    s,
                    rgba,
                    normal: None,
                    side: Crossing::Stroke,
                    solid,
                    is_hidden: false,
                    covering: self.covering,
                },
            );
        });
    }
}

/// Points of a size in pixels on a base plane.
pub struct DiscsOnPlane<'a> {
    points: &'a Points,
    diameters_px: &'a [f64],
    placed: Vec<Placed>,
}

impl<'a> DiscsOnPlane<'a> {
    /// Places the points.
    pub fn new(points: &'a Points, diameters_px: &'a [f64], view: &PlaneView) -> Self {
        Self { points, diameters_px, placed: view.place_all(&points.centers) }
    }
}

impl OnPlane for DiscsOnPlane<'_> {
    fn n_elements(&self) -> usize {
        self.placed.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        let center = self.placed[element];
        if !is_ahead(center) {
            return None;
        }
        rows_of_stroke([center; 2], 0.5 * self.diameters_px[element], view)
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let Some(rgba) = color_at(&self.points.paint, [element as u32], [1.0]) else { return };
        let style = ShapeStyle { is_lit: false, ..self.points.style };
        let half_px = 0.5 * self.diameters_px[element];
        draw_stroke([self.placed[element]; 2], half_px, canvas, |canvas, StrokeHit { texel, at, mask, s, .. }| {
            canvas.add(
                style,
                &SurfacePart {
                    texel,
                    at,
                    mask,
                    s,
                    rgba,
                    normal: None,
                    side: Crossing::Sheet,
                    solid: ALONE,
                    is_hidden: false,
                    covering: Covering::Behind,
                },
            );
        });
    }
}

/// Half the size of a stroke on the base plane, in texels: the larger of both ends'.
fn reach_of(ends: [Placed; 2], half_px: f64, view: &PlaneView) -> [f64; 2] {
    let [a, b] = ends.map(|end| view.reach_of_disc([end.x, end.y].map(f64::from), half_px));
    [a[0].max(b[0]), a[1].max(b[1])]
}

fn rows_of_stroke(ends: [Placed; 2], half_px: f64, view: &PlaneView) -> RowRange {
    let reach = reach_of(ends, half_px, view);
    let of = |k: usize, [a, b]: [f32; 2]| [f64::from(a.min(b)) - reach[k], f64::from(a.max(b)) + reach[k]];
    let [x, y] = [of(0, ends.map(|end| end.x)), of(1, ends.map(|end| end.y))];
    if x[1] < -0.5 || x[0] > view.plane.size[0] as f64 - 0.5 {
        return None;
    }
    rows_of(view, y)
}

/// The part of a stroke in a texel.
struct StrokeHit {
    texel: [usize; 2],
    at: [f32; 2],
    mask: Mask,
    s: f32,
    /// Share of the way from the first end to the second.
    along: f32,
}

/// Square of the distance of a pixel position from the line along `way` from the origin. `per_square`: inverse square of
/// its length, 0 for a point.
#[inline(always)]
fn distance_off(pixel: [f32; 2], way: [f32; 2], per_square: f32) -> f32 {
    let along = ((pixel[0] * way[0] + pixel[1] * way[1]) * per_square).clamp(0.0, 1.0);
    let off = [pixel[0] - along * way[0], pixel[1] - along * way[1]];
    off[0] * off[0] + off[1] * off[1]
}

/// Calls `with` for every texel of a canvas of which a stroke covers a place: where the pixel position is no further than
/// `half_px` from the straight line between the pixel positions of the ends.
#[inline(always)]
fn draw_stroke(ends: [Placed; 2], half_px: f64, canvas: &mut Canvas, mut with: impl FnMut(&mut Canvas, StrokeHit)) {
    let view = canvas.view;
    let reach = reach_of(ends, half_px, view);
    let places = ends.map(|end| [end.x, end.y].map(f64::from));
    let [first, second] = places.map(|at| view.pixel(at));
    let way = [(second[0] - first[0]) as f32, (second[1] - first[1]) as f32];
    let square = way[0] * way[0] + way[1] * way[1];
    let per_square = if square > 0.0 { 1.0 / square } else { 0.0 };
    let limit = (half_px * half_px) as f32;
    let nearest = ends[0].s.min(ends[1].s);
    let rows = canvas.own_rows([places[0][1].min(places[1][1]) - reach[1], places[0][1].max(places[1][1]) + reach[1]]);
    for j in rows {
        for i in canvas.columns(columns_in_row(places, reach, j as f64)) {
            if canvas.is_hidden([i, j], nearest) {
                continue;
            }
            let [x, y, scale] = view.pixels_around([i as f64, j as f64], first);
            // How far the middle of the texel is off, and how much further its corners may be.
            let per = 1.0 / scale[0];
            let corner = 0.5 * per.abs() * (x[1].abs() + x[2].abs() + y[1].abs() + y[2].abs());
            let furthest = half_px as f32 + corner;
            if distance_off([x[0] * per, y[0] * per], way, per_square) > furthest * furthest {
                continue;
            }
            // Of parallel rays it is the same at all places.
            let is_even = scale[1] == 0.0 && scale[2] == 0.0;
            let mut covered = [false; N];
            for k in 0..N {
                let (u, v) = (OFFSETS[0][k], OFFSETS[1][k]);
                let per = if is_even { per } else { 1.0 / (scale[0] + scale[1] * u + scale[2] * v) };
                let pixel = [(x[0] + x[1] * u + x[2] * v) * per, (y[0] + y[1] * u + y[2] * v) * per];
                covered[k] = distance_off(pixel, way, per_square) <= limit;
            }
            let mask = mask_of(covered);
            if mask == 0 {
                continue;
            }
            let [u, v] = mean_offset(mask);
            let per = 1.0 / (scale[0] + scale[1] * u + scale[2] * v);
            let pixel = [(x[0] + x[1] * u + x[2] * v) * per, (y[0] + y[1] * u + y[2] * v) * per];
            let share = ((pixel[0] * way[0] + pixel[1] * way[1]) * per_square).clamp(0.0, 1.0);
            // A share of the way in the picture is another one in the world, where the ends are not equally far.
            let [a, b] = [(1.0 - share) / ends[0].ahead, share / ends[1].ahead];
            let along = b / (a + b);
            // At an end it equals the end's `s` to the bit, as in the next piece.
            let s = (1.0 - along) * ends[0].s + along * ends[1].s;
            with(canvas, StrokeHit { texel: [i, j], at: [i as f32 + u, j as f32 + v], mask, s, along });
        }
    }
}
