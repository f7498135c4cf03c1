//! Rows of texels that shapes are drawn into, and the interface of shapes on a base plane.

use std::ops::Range;

use glam::{DVec3, Vec3};
use wavesplat_core::ShapeStyle;

use crate::shapes::cover::{Cover, Covering};
use crate::shapes::fragments::{ALONE, Crossing, Meeting};
use crate::shapes::placement::PlaneView;
use crate::shapes::samples::Mask;
use crate::view::region::Region;

/// Rows of texels that an element of a shape reaches; `None`: it cannot be seen.
pub type RowRange = Option<[u32; 2]>;

/// A shape as it lies on a base plane: a list of elements that are drawn one by one.
pub trait OnPlane: Sync {
    /// Number of elements: triangles, pieces of lines, points.
    fn n_elements(&self) -> usize;
    /// Rows that an element reaches.
    fn rows(&self, element: usize, view: &PlaneView) -> RowRange;
    /// Draws the part of an element that lies in the rows of a canvas. Must be `#[inline(always)]`, so that its loops
    /// use the vectors of the machine.
    fn draw(&self, element: usize, canvas: &mut Canvas);
}

/// Rows of texels in which meetings of rays and shapes are collected.
pub struct Canvas<'a> {
    /// The base plane.
    pub view: &'a PlaneView<'a>,
    /// Rows of the band.
    pub rows: Range<usize>,
    /// The part of space that clip planes and crop leave, for shapes that they cut.
    pub region: &'a Region,
    /// Surfaces that were met so far, but for those that cannot be seen behind others.
    pub meetings: Vec<Meeting>,
    /// Parts of each ray that opaque surfaces hide.
    covers: Vec<Cover>,
}

/// A part of a surface on the ray of a texel.
pub struct SurfacePart {
    /// Texel.
    pub texel: [usize; 2],
    /// Texel position of the middle of the covered places.
    pub at: [f32; 2],
    /// Covered places.
    pub mask: Mask,
    /// Place along the ray.
    pub s: f32,
    /// Straight colour and opacity, without light.
    pub rgba: [f32; 4],
    /// World normal of any length, on either side; `None`: it is not lit.
    pub normal: Option<Vec3>,
    /// Which part of a solid.
    pub side: Crossing,
    /// Number of the solid.
    pub solid: u32,
    /// Whether it lies behind the eye, and counts only for the other parts of the solid.
    pub is_hidden: bool,
    /// Parts of the ray that it hides where it is opaque.
    pub covering: Covering,
}

impl<'a> Canvas<'a> {
    /// Rows of a base plane without shapes.
    pub fn new(view: &'a PlaneView<'a>, rows: Range<usize>, region: &'a Region) -> Self {
        let covers = vec![Cover::default(); rows.len() * view.plane.size[0]];
        Self { view, rows, region, meetings: Vec::new(), covers }
    }

    fn texel_number(&self, [i, j]: [usize; 2]) -> usize {
        (j - self.rows.start) * self.view.plane.size[0] + i
    }

    /// Whether opaque surfaces hide all of a texel from a place on.
    #[inline(always)]
    pub fn is_hidden(&self, texel: [usize; 2], s: f32) -> bool {
        self.covers[self.texel_number(texel)].is_closed_before(s)
    }

    /// Takes note of a surface with the look of its shape.
    #[inline]
    pub fn add(&mut self, style: ShapeStyle, surface: &SurfacePart) {
        let SurfacePart { at: [x, y], mask, s, rgba: [r, g, b, a], normal, side, solid, is_hidden, .. } = *surface;
        let mut alpha = a * style.opacity;
        // Written so that NaN is refused, too.
        if !(alpha > 0.0 && s.is_finite()) {
            return;
        }
        let texel = self.texel_number(surface.texel);
        if self.covers[texel].hides(solid, mask, s) {
            return;
        }
        let is_cut_off = style.is_clipped && !self.region.contains(self.view.index_at([x, y, s]));
        if is_cut_off || is_hidden {
            // A cut-off wall is not drawn, but the ray still enters the solid here, so that walls inside of it stay
            // hidden.
            if solid == ALONE || side == Crossing::Stroke {
                return;
            }
            alpha = 0.0;
        }
        if alpha >= 1.0 {
            self.covers[texel].add(solid, mask, s, surface.covering);
        }
        let normal = normal.filter(|_| style.is_lit).unwrap_or(Vec3::ZERO);
        self.meetings.push(Meeting { texel: texel as u32, s, rgb: [r, g, b], normal, alpha, mask, side, solid });
    }

    /// Columns of texels from `lo` to `hi` that lie on the plane.
    pub fn columns(&self, [lo, hi]: [f64; 2]) -> Range<usize> {
        range_of([lo, hi], self.view.plane.size[0])
    }

    /// Rows of texels from `lo` to `hi` that lie in the band.
    pub fn own_rows(&self, [lo, hi]: [f64; 2]) -> Range<usize> {
        let rows = range_of([lo, hi], self.view.plane.size[1]);
        rows.start.max(self.rows.start)..rows.end.min(self.rows.end)
    }
}

/// Texels whose squares meet an interval, of `n`.
fn range_of([lo, hi]: [f64; 2], n: usize) -> Range<usize> {
    let first = (lo + 0.5).floor().max(0.0);
    let last = (hi + 0.5).floor().min(n as f64 - 1.0);
    if first <= last { first as usize..last as usize + 1 } else { 0..0 }
}

/// Rows of texels of an interval; `None` where it lies beyond the plane, or is no interval.
pub fn rows_of(view: &PlaneView, interval: [f64; 2]) -> RowRange {
    let rows = range_of(interval, view.plane.size[1]);
    (!rows.is_empty()).then(|| [rows.start as u32, rows.end as u32 - 1])
}

/// World positions as vectors.
pub fn vector(position: [f64; 3]) -> DVec3 {
    DVec3::from_array(position)
}
