//! Parts of a texel's ray that opaque surfaces hide, as shapes are drawn in any order.
//!
//! Where many surfaces lie behind each other, most of them cannot be seen. Two rules leave them out early, and change
//! nothing: behind surfaces that cover all places of a texel nothing is seen ([`Cover::is_closed_before`]), and nothing
//! at places that are covered in front ([`Cover::hides`]).

use crate::shapes::samples::Mask;

/// Parts of a ray that a piece of a surface hides where it is opaque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covering {
    /// Nothing for sure: it may lie inside of its solid, where it is not seen.
    Nothing,
    /// All that lies behind it.
    Behind,
    /// All that lies behind it, and parts of the same solid at its place: the solid has one colour and no light.
    BehindAndThere,
}

/// Parts of a ray that the surfaces that were drawn so far hide.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// Place along the ray behind which nothing is seen.
    closed: f32,
    /// Places of the texel that are covered, and the place along the ray in front of which all that covers them lies.
    mask: Mask,
    far: f32,
    /// The same of the solid that was drawn last, where its parts hide each other at one place, too.
    solid: u32,
    own_mask: Mask,
    own_far: f32,
}

impl Default for Cover {
    fn default() -> Self {
        let nowhere = f32::NEG_INFINITY;
        Self { closed: f32::INFINITY, mask: 0, far: nowhere, solid: 0, own_mask: 0, own_far: nowhere }
    }
}

impl Cover {
    /// Whether nothing is seen from a place on.
    #[inline(always)]
    pub fn is_closed_before(&self, s: f32) -> bool {
        s > self.closed
    }

    /// Whether nothing is seen of a part of a solid at some places of the texel.
    #[inline(always)]
    pub fn hides(&self, solid: u32, mask: Mask, s: f32) -> bool {
        let is_behind = s > self.closed || mask & !self.mask == 0 && s > self.far;
        is_behind || solid == self.solid && mask & !self.own_mask == 0 && s >= self.own_far
    }

    /// Takes note of an opaque part of a solid.
    #[inline(always)]
    pub fn add(&mut self, solid: u32, mask: Mask, s: f32, covering: Covering) {
        if covering == Covering::Nothing {
            return;
        }
        (self.mask, self.far) = (self.mask | mask, self.far.max(s));
        if covering == Covering::BehindAndThere {
            let (before, far) =
                if solid == self.solid { (self.own_mask, self.own_far) } else { (0, f32::NEG_INFINITY) };
            (self.solid, self.own_mask, self.own_far) = (solid, before | mask, far.max(s));
        }
        if self.mask == Mask::MAX {
            self.closed = self.closed.min(self.far);
            // What is nearer may hide more.
            (self.mask, self.far) = (0, f32::NEG_INFINITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::fragments::ALONE;

    #[test]
    fn parts_that_cover_all_places_together_hide_what_is_behind_the_last() {
        let mut cover = Cover::default();
        cover.add(ALONE, 0x00FF, 5.0, Covering::Behind);
        assert!(!cover.is_closed_before(100.0));
        assert!(cover.hides(ALONE, 0x000F, 5.5) && !cover.hides(ALONE, 0x01FF, 5.5));
        // In front of it, and at its place.
        assert!(!cover.hides(ALONE, 0x000F, 4.0) && !cover.hides(ALONE, 0x000F, 5.0));
        cover.add(ALONE, 0xFF00, 3.0, Covering::Behind);
        assert!(cover.is_closed_before(5.1) && !cover.is_closed_before(5.0));
        cover.add(ALONE, Mask::MAX, 4.0, Covering::Behind);
        assert!(cover.hides(7, 1, 4.5) && !cover.hides(7, 1, 4.0));
    }

    #[test]
    fn even_strokes_hide_what_lies_at_their_place() {
        let mut cover = Cover::default();
        cover.add(4, 0x00FF, 2.0, Covering::BehindAndThere);
        assert!(cover.hides(4, 0x0003, 2.0) && !cover.hides(4, 0x0100, 2.0));
        // Others only behind it.
        assert!(!cover.hides(5, 0x0003, 2.0) && cover.hides(5, 0x0003, 2.1));
        cover.add(5, 0x0001, 1.0, Covering::BehindAndThere);
        assert!(!cover.hides(4, 0x0003, 2.0));
    }

    #[test]
    fn what_may_be_inside_of_a_solid_hides_nothing() {
        let mut cover = Cover::default();
        cover.add(4, Mask::MAX, 2.0, Covering::Nothing);
        assert!(!cover.is_closed_before(3.0) && !cover.hides(4, 1, 3.0));
    }
}
