//! Fragments of shapes on the rays of a base plane, front to back, texel by texel.
//!
//! Opacities of fragments: let `T_k` be the transmittance of all fragments in front at place `k` of the texel. A
//! fragment of opacity `α` on the places `M` takes `g = α Σ_{k ∈ M} T_k / N` of the light that would pass the shapes,
//! of which `G = Σ_k T_k / N` is left in front of it; so the ray's opacity there is `g / G`. Matter between fragments
//! is the same at all places, so it is composited between them as between surfaces that cover the whole texel.

use std::cmp::Ordering;

use glam::Vec3;

use crate::shapes::samples::{self, Mask};

/// A surface that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFragment {
    /// Place along the ray.
    pub s: f32,
    /// Colour, lit, not associated.
    pub rgb: [f32; 3],
    /// Opacity; with 1 the ray ends.
    pub alpha: f32,
}

/// Fragments of all rays of a base plane.
#[derive(Clone, Debug, Default)]
pub struct Fragments {
    /// Texels along u and v.
    size: [usize; 2],
    /// Number of the first fragment of each texel, row by row, then the number of all.
    starts: Vec<u32>,
    all: Vec<ShapeFragment>,
    /// Rays whose deepest fragments were joined, because they had more than [`MAX_FRAGMENTS`].
    n_joined: usize,
}

/// Largest number of fragments of a ray; deeper ones are joined into the last.
pub const MAX_FRAGMENTS: usize = 32;

/// Distance, in slices, below which fragments are joined: no matter between them could be seen.
const SAME_PLACE: f32 = 1.0 / 64.0;

/// Transmittance of the shapes from which on nothing behind can be seen.
const CLOSED: f32 = 1e-6;

/// Part of a solid that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Crossing {
    /// A surface without inside.
    Sheet,
    /// The ray enters the solid.
    Enter,
    /// The ray leaves the solid.
    Leave,
    /// A flat stroke, of which one layer counts.
    Stroke,
}

/// Number of solids of which nothing else is part.
pub const ALONE: u32 = u32::MAX;

/// A place where a shape was met, before the matter in front is known.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Number of the texel within the band, row by row.
    pub texel: u32,
    /// Place along the ray.
    pub s: f32,
    /// Colour without light, not associated.
    pub rgb: [f32; 3],
    /// Normal in the world; zero where no light shines on it.
    pub normal: Vec3,
    /// Opacity of the surface; 0 where it counts only for the other parts of the solid.
    pub alpha: f32,
    /// Covered places of the texel.
    pub mask: Mask,
    /// Which part of a solid.
    pub side: Crossing,
    /// Number of the solid, which may consist of overlapping pieces; [`ALONE`] for others.
    pub solid: u32,
}

impl Meeting {
    /// Whether light shines on it.
    pub fn is_lit(&self) -> bool {
        self.normal != Vec3::ZERO
    }

    /// Orders meetings front to back, and meetings at one place by their looks, so that the order of shapes means
    /// nothing.
    fn order(&self, other: &Self) -> Ordering {
        self.s.total_cmp(&other.s).then_with(|| self.looks().cmp(&other.looks()))
    }

    fn looks(&self) -> (Crossing, [u32; 7], Mask) {
        let [r, g, b] = self.rgb.map(f32::to_bits);
        let [x, y, z] = self.normal.to_array().map(f32::to_bits);
        (self.side, [r, g, b, self.alpha.to_bits(), x, y, z], self.mask)
    }
}

/// Fragments of some rows of texels.
pub struct FragmentBand {
    /// Number of fragments of each texel.
    pub counts: Vec<u32>,
    /// Fragments, texel after texel, front to back.
    pub all: Vec<ShapeFragment>,
    /// Rays whose deepest fragments were joined.
    pub n_joined: usize,
}

impl Fragments {
    /// Puts bands of rows together. `size`: texels along u and v.
    pub fn new(size: [usize; 2], bands: Vec<FragmentBand>) -> Self {
        let mut starts = Vec::with_capacity(size[0] * size[1] + 1);
        let mut all = Vec::with_capacity(bands.iter().map(|band| band.all.len()).sum());
        let (mut n, mut n_joined) = (0, 0);
        starts.push(0);
        for band in bands {
            for count in band.counts {
                n += count;
                starts.push(n);
            }
            all.extend(band.all);
            n_joined += band.n_joined;
        }
        Self { size, starts, all, n_joined }
    }

    /// Fragments of the ray of a texel, front to back; none beyond the base plane.
    #[inline(always)]
    pub fn of(&self, i: usize, j: usize) -> &[ShapeFragment] {
        if i >= self.size[0] || j >= self.size[1] {
            return &[];
        }
        let texel = j * self.size[0] + i;
        &self.all[self.starts[texel] as usize..self.starts[texel + 1] as usize]
    }

    /// Fragments of a rectangle of texels from `first` on, which may lie outside the base plane.
    #[must_use]
    pub fn window(&self, first: [i64; 2], size: [usize; 2]) -> Self {
        let (mut starts, mut all) = (vec![0], Vec::new());
        for j in 0..size[1] {
            for i in 0..size[0] {
                let texel = [first[0] + i as i64, first[1] + j as i64].map(usize::try_from);
                if let [Ok(i), Ok(j)] = texel {
                    all.extend_from_slice(self.of(i, j));
                }
                starts.push(all.len() as u32);
            }
        }
        Self { size, starts, all, n_joined: self.n_joined }
    }

    /// Whether any of `n` texels of a row, from `(i, j)` on, has a fragment.
    pub fn any_in_row(&self, i: usize, j: usize, n: usize) -> bool {
        if i >= self.size[0] || j >= self.size[1] {
            return false;
        }
        let first = j * self.size[0] + i;
        let last = first + n.min(self.size[0] - i);
        self.starts[first] < self.starts[last]
    }

    /// Number of fragments.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether no ray meets a shape.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Rays whose deepest fragments were joined, because they had more than [`MAX_FRAGMENTS`].
    pub fn n_joined(&self) -> usize {
        self.n_joined
    }
}

/// Sorts meetings texel by texel, front to back, and works out the opacities of the rays. `n_texels`: of the band.
/// `lit`: the colour of a texel's meeting in the light.
pub fn resolve(meetings: &[Meeting], n_texels: usize, lit: impl Fn(&Meeting) -> [f32; 3]) -> FragmentBand {
    let mut starts = vec![0_u32; n_texels + 1];
    for meeting in meetings {
        starts[meeting.texel as usize + 1] += 1;
    }
    for texel in 0..n_texels {
        starts[texel + 1] += starts[texel];
    }
    let mut next = starts.clone();
    let mut order = vec![0_u32; meetings.len()];
    for (k, meeting) in meetings.iter().enumerate() {
        let place = &mut next[meeting.texel as usize];
        order[*place as usize] = k as u32;
        *place += 1;
    }
    let mut band = FragmentBand { counts: vec![0; n_texels], all: Vec::new(), n_joined: 0 };
    let (mut here, mut ray) = (Vec::new(), Vec::new());
    for texel in 0..n_texels {
        let own = &order[starts[texel] as usize..starts[texel + 1] as usize];
        if own.is_empty() {
            continue;
        }
        here.clear();
        here.extend(own.iter().map(|k| meetings[*k as usize]));
        if here.len() > 1 {
            here.sort_unstable_by(Meeting::order);
        }
        let first = band.all.len();
        band.n_joined += usize::from(add_ray(&here, &mut ray));
        band.all.extend(ray.drain(..).map(|seen| ShapeFragment { s: seen.s, rgb: lit(&seen), alpha: seen.alpha }));
        band.counts[texel] = (band.all.len() - first) as u32;
    }
    band
}

/// Appends what is seen on a ray that meets shapes in this order, with its opacities on the ray; returns whether some
/// meetings were joined for their number.
fn add_ray(meetings: &[Meeting], all: &mut Vec<Meeting>) -> bool {
    let first = all.len();
    let mut open = Open::default();
    let mut left = 1.0_f32;
    let mut solids = Solids::default();
    // Light in front of the last fragment, and how much of it the fragment takes.
    let (mut before, mut taken) = (1.0, 0.0);
    let mut is_joined = false;
    for meeting in meetings {
        let mask = solids.visible(meeting);
        if mask == 0 {
            continue;
        }
        let passing = open.sum(mask) / samples::N as f32;
        let share = meeting.alpha * passing;
        if share <= 0.0 {
            continue;
        }
        open.dim(mask, meeting.alpha);
        let n = all.len() - first;
        let is_near = |last: &Meeting| meeting.s - last.s <= SAME_PLACE && last.is_lit() == meeting.is_lit();
        let joins = n > 0 && (is_near(&all[all.len() - 1]) || n == MAX_FRAGMENTS);
        if joins {
            is_joined |= n == MAX_FRAGMENTS;
            let last = all.last_mut().expect("a fragment");
            let sum = taken + share;
            let part = share / sum;
            for c in 0..3 {
                last.rgb[c] += part * (meeting.rgb[c] - last.rgb[c]);
            }
            last.normal += (meeting.normal - last.normal) * part;
            // The place stays the first meeting's: later meetings are compared with it.
            taken = sum;
            // Fragments at one place act as one with their joint opacity, relative to the light in front of the first.
            last.alpha = (taken / before).min(1.0);
        } else {
            (before, taken) = (left, share);
            all.push(Meeting { alpha: (share / left).min(1.0), ..*meeting });
        }
        left = open.sum(Mask::MAX) / samples::N as f32;
        if left <= CLOSED {
            all.last_mut().expect("a fragment").alpha = 1.0;
            break;
        }
    }
    is_joined
}

/// Transmittance, at a texel's places, of what was met so far.
enum Open {
    /// 1 at these places, 0 at the others: all that was met is opaque.
    Places(Mask),
    /// Transmittance of each place.
    Each([f32; samples::N]),
}

impl Default for Open {
    fn default() -> Self {
        Self::Places(Mask::MAX)
    }
}

impl Open {
    /// Sum over the places of a mask, in their order.
    #[inline(always)]
    fn sum(&self, mask: Mask) -> f32 {
        match self {
            Self::Places(open) => (open & mask).count_ones() as f32,
            Self::Each(open) => {
                let mut sum = 0.0;
                for (k, open) in open.iter().enumerate() {
                    sum += if mask >> k & 1 == 1 { *open } else { 0.0 };
                }
                sum
            }
        }
    }

    /// Puts a surface of an opacity over the places of a mask.
    #[inline(always)]
    fn dim(&mut self, mask: Mask, alpha: f32) {
        match self {
            Self::Places(open) if alpha >= 1.0 => *open &= !mask,
            Self::Places(open) => {
                let each = std::array::from_fn(|k| f32::from(u8::from(*open >> k & 1 == 1)));
                *self = Self::Each(each);
                self.dim(mask, alpha);
            }
            Self::Each(open) => {
                for (k, open) in open.iter_mut().enumerate() {
                    *open *= if mask >> k & 1 == 1 { 1.0 - alpha } else { 1.0 };
                }
            }
        }
    }
}

/// Depth of a ray's places in solids that consist of overlapping pieces.
#[derive(Default)]
struct Solids {
    /// Number of each solid, and how many of its pieces each place is in.
    depths: Vec<(u32, [u16; samples::N])>,
}

impl Solids {
    /// Places at which a meeting is on the outside of its solid. Also counts the meeting as a wall of the solid.
    fn visible(&mut self, meeting: &Meeting) -> Mask {
        if meeting.solid == ALONE || meeting.side == Crossing::Sheet {
            return meeting.mask;
        }
        let known = self.depths.iter().position(|(solid, _)| *solid == meeting.solid);
        let known = known.unwrap_or_else(|| {
            self.depths.push((meeting.solid, [0; samples::N]));
            self.depths.len() - 1
        });
        let mut visible = 0;
        for (k, depth) in self.depths[known].1.iter_mut().enumerate() {
            if meeting.mask >> k & 1 == 0 {
                continue;
            }
            let (before, after) = match meeting.side {
                Crossing::Leave => (*depth, depth.saturating_sub(1)),
                _ => (*depth, depth.saturating_add(1)),
            };
            *depth = after;
            let is_outside = if meeting.side == Crossing::Leave { after == 0 } else { before == 0 };
            visible |= Mask::from(is_outside) << k;
        }
        visible
    }
}

/// Composites fragments behind a texel of associated RGBA, front to back. `s_half`: place of opacity ½, NaN where it is
/// not reached yet.
pub fn composite_behind(rgba: &mut [f32; 4], fragments: &[ShapeFragment], mut s_half: Option<&mut f32>) {
    for fragment in fragments {
        let before = rgba[3];
        let weight = (1.0 - before) * fragment.alpha;
        for c in 0..3 {
            rgba[c] += weight * fragment.rgb[c];
        }
        rgba[3] += weight;
        if let Some(s_half) = s_half.as_deref_mut()
            && before < 0.5
            && rgba[3] >= 0.5
        {
            *s_half = fragment.s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(s: f32, alpha: f32, mask: Mask) -> Meeting {
        Meeting {
            texel: 0,
            s,
            rgb: [1.0, 0.5, 0.25],
            normal: Vec3::ZERO,
            alpha,
            mask,
            side: Crossing::Sheet,
            solid: ALONE,
        }
    }

    fn ray(meetings: &[Meeting]) -> Vec<ShapeFragment> {
        resolve(meetings, 1, |seen| seen.rgb).all
    }

    #[test]
    fn halves_that_share_an_edge_are_opaque_together() {
        let of_two = ray(&[sheet(1.0, 1.0, 0x00FF), sheet(1.5, 1.0, 0xFF00)]);
        assert_eq!(of_two.iter().map(|f| f.alpha).collect::<Vec<_>>(), [0.5, 1.0]);
        // At one place they are joined.
        let joined = ray(&[sheet(1.0, 1.0, 0x00FF), sheet(1.0, 1.0, 0xFF00)]);
        assert!(joined.len() == 1 && joined[0].alpha == 1.0);
        // Nothing is seen behind.
        assert_eq!(ray(&[sheet(1.0, 1.0, 0xFFFF), sheet(2.0, 1.0, 0xFFFF)]).len(), 1);
    }

    #[test]
    fn a_surface_behind_half_of_one_is_seen_beside_it() {
        let of_two = ray(&[sheet(1.0, 1.0, 0x00FF), sheet(2.0, 1.0, 0x0FFF)]);
        // Half the light is left, and half of that meets the second.
        assert!(of_two.len() == 2 && of_two[0].alpha == 0.5 && of_two[1].alpha == 0.5);
        let clear = ray(&[sheet(1.0, 0.5, 0xFFFF), sheet(2.0, 0.25, 0xFFFF)]);
        assert!(clear[0].alpha == 0.5 && clear[1].alpha == 0.25);
    }

    #[test]
    fn order_of_meetings_means_nothing() {
        let some =
            [sheet(-3.0, 0.3, 0x0F0F), sheet(2.0, 0.4, 0xFFFF), sheet(2.0, 0.9, 0x1111), sheet(0.5, 0.2, 0x0003)];
        let straight = ray(&some);
        for k in 0..some.len() {
            let mut turned = some;
            turned.rotate_left(k);
            assert_eq!(ray(&turned), straight);
            turned.reverse();
            assert_eq!(ray(&turned), straight);
        }
        assert!(straight[0].s == -3.0);
    }

    #[test]
    fn pieces_of_a_solid_have_no_walls_inside() {
        let part = |s, side| Meeting { side, solid: 7, ..sheet(s, 0.5, Mask::MAX) };
        // Two overlapping pieces: only the first entry and the last exit count.
        let union = ray(&[
            part(1.0, Crossing::Enter),
            part(2.0, Crossing::Enter),
            part(3.0, Crossing::Leave),
            part(4.0, Crossing::Leave),
        ]);
        assert_eq!(union.iter().map(|f| f.s).collect::<Vec<_>>(), [1.0, 4.0]);
        let strokes = ray(&[part(1.0, Crossing::Stroke), part(2.0, Crossing::Stroke)]);
        assert_eq!(strokes.len(), 1);
    }

    #[test]
    fn rays_through_many_fragments_keep_all_their_opacity() {
        let many: Vec<Meeting> = (0..100).map(|k| sheet(k as f32, 0.02, Mask::MAX)).collect();
        let band = resolve(&many, 1, |seen| seen.rgb);
        assert!(band.all.len() == MAX_FRAGMENTS && band.n_joined == 1);
        let left: f64 = band.all.iter().map(|f| 1.0 - f64::from(f.alpha)).product();
        assert!((left - 0.98_f64.powi(100)).abs() < 1e-5, "{left}");
        let mut rgba = [0.0; 4];
        let mut s_half = f32::NAN;
        composite_behind(&mut rgba, &band.all, Some(&mut s_half));
        assert!((f64::from(rgba[3]) - 1.0 + left).abs() < 1e-5 && s_half == 31.0);
    }
}
