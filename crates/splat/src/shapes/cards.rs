//! Cards on a base plane: two triangles with shares of the picture's columns and rows at their corners.

use wavesplat_core::{Card, ShapeStyle};

use crate::shapes::canvas::{Canvas, OnPlane, RowRange, SurfacePart, vector};
use crate::shapes::cover::Covering;
use crate::shapes::fragments::{ALONE, Crossing};
use crate::shapes::paint::texture_at;
use crate::shapes::placement::{Placed, PlaneView};
use crate::shapes::triangles::{TriangleHit, cover, cut_by_near_plane, is_ahead, rows_of_triangle};

/// A card on a base plane.
pub struct CardOnPlane<'a> {
    card: &'a Card,
    /// Index coordinates along u, v, w, and places, of the corners.
    corners: [([f64; 3], Placed); 4],
}

/// Shares of columns and rows at the corners of a card.
const SHARES: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Corners of the two triangles.
const TRIANGLES: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

impl<'a> CardOnPlane<'a> {
    /// Places the corners.
    pub fn new(card: &'a Card, view: &PlaneView) -> Self {
        let [corner, along_x, along_y] = [card.corner, card.along_x, card.along_y].map(vector);
        let corners = SHARES.map(|[x, y]| {
            let uvw = view.uvw(corner + along_x * f64::from(x) + along_y * f64::from(y));
            (uvw, view.place(uvw))
        });
        Self { card, corners }
    }

    #[inline(always)]
    fn draw_triangle(&self, corners: [Placed; 3], shares: [[f32; 2]; 3], canvas: &mut Canvas) {
        let style = ShapeStyle { is_lit: false, ..self.card.style };
        cover(corners, canvas, |canvas, TriangleHit { texel, at, mask, s, weights }| {
            let share = [0, 1].map(|k| (0..3).map(|corner| weights[corner] * shares[corner][k]).sum());
            let rgba = texture_at(self.card, share);
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

impl OnPlane for CardOnPlane<'_> {
    fn n_elements(&self) -> usize {
        TRIANGLES.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        rows_of_triangle(TRIANGLES[element].map(|k| self.corners[k].1), view)
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let corners = TRIANGLES[element].map(|k| self.corners[k]);
        let shares = TRIANGLES[element].map(|k| SHARES[k]);
        if corners.iter().all(|(_, placed)| is_ahead(*placed)) {
            return self.draw_triangle(corners.map(|(_, placed)| placed), shares, canvas);
        }
        for (corners, weights) in cut_by_near_plane(corners.map(|(uvw, _)| uvw), canvas.view) {
            let shares = weights.map(|of| [0, 1].map(|k| (0..3).map(|corner| of[corner] * shares[corner][k]).sum()));
            self.draw_triangle(corners, shares, canvas);
        }
    }
}
