//! Even light on cut faces: where a ray enters matter through a crop, a clip plane, missing samples or the wall of the
//! volume, the face is no surface of the object, and gradients there come from its texture and noise.
//!
//! The *entry* of a ray is the cut that it begins at, if matter lies right behind it. The share of even light
//! ([`crate::optics::shade::Shader::evened`]) at the way `d` behind it, in slices, is `(10 − d) / 4`, within 0 and 1: the
//! matter that a face shows lies that deep, since few looks are opaque within a voxel. A ray that comes through air has
//! no entry, and the surfaces that it meets are lit as everywhere.
//!
//! Nothing here is a yes or no, which would make pictures depend on where sheets lie: haze, matter further from the cut,
//! and a small missing share are entries of less strength `g`, and count as entries `10 (1 − g)` slices in front, whose
//! even light ends earlier. The strength is the product of `2 τ − ½` for matter of an optical depth of `τ` times
//! [`DEPTH`] per slice, of `2 − d` for matter `d` times [`NEAR`] behind the cut, and, at missing samples, of `4 m − 1`
//! for a missing share `m`; each within 0 and 1.
//!
//! Where a part of space is drawn, rays that enter the region in another part have their entries from a survey of the
//! whole ([`crate::render::part_plan`]).

use wavesplat_compute::simd::{Lanes, Wide};

use crate::optics::shade::Shader;
use crate::ray::accumulator::Chunks;
use crate::ray::state::TileState;
use crate::sheet::tile_rays::Rays;

/// Way behind the entry, in slices, from which light is not even.
pub const REACH: f32 = 10.0;

/// Even light lost per slice where it fades, over the last slices of [`REACH`].
pub const PER_SLICE: f32 = 0.25;

/// Scale of optical depth per slice: matter has full strength from three quarters of this on, none up to a quarter.
/// Haze, such as a body's flesh in front of bones, has less.
pub const DEPTH: f32 = 0.04;

/// Way from a cut up to which matter has full strength, in slices; none from twice it on.
pub const NEAR: f32 = 0.75;

/// Entry of a ray that has none.
pub const NO_ENTRY: f32 = -1e30;

/// Entries of the rays of a tile, in s.
pub struct CutFaces {
    /// Chunk by chunk; empty where no light is even.
    entries: Vec<Lanes>,
}

/// Matter of a fragment, by ray.
pub struct Matter<W: Wide> {
    /// Where its visible part begins along s.
    pub begin: W::F,
    /// How far its drawn part extends along s.
    pub extent: W::F,
    /// Optical depth of that part if no sample were missing.
    pub depth: W::F,
    /// Place along s that its light comes from.
    pub at: W::F,
    /// Largest missing share of that part, of volumes with missing samples.
    pub missing: Option<W::F>,
}

impl CutFaces {
    /// Continues from the entries of a state, which it takes out. `shaders`: of all layers.
    pub fn new<'a>(shaders: impl IntoIterator<Item = Option<&'a Shader>>, state: Option<&mut TileState>) -> Self {
        if !shaders.into_iter().any(|shader| shader.is_some_and(Shader::evens_cuts)) {
            return Self { entries: Vec::new() };
        }
        let entries = state.map(|state| std::mem::take(&mut state.entries)).filter(|entries| !entries.is_empty());
        Self { entries: entries.unwrap_or_else(|| TileState::per_chunk(Lanes::splat(NO_ENTRY))) }
    }

    /// Share of even light of the matter in a slab that begins at `from`; `None` where no ray has any.
    #[inline(always)]
    pub fn even_share<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        from: f32,
        matter: &Matter<W>,
    ) -> Option<W::F> {
        let last = rays.last_entry(chunks[0]).max(rays.last_entry(chunks[1]));
        if self.entries.is_empty() || (matter.missing.is_none() && from >= last + REACH) {
            return None;
        }
        let places = [chunks[0].index(), chunks[1].index()];
        let begins = rays.begins(w, chunks);
        // Where nothing is drawn, depth and extent are 0.
        let usual = w.max(w.mul(w.splat(DEPTH), matter.extent), w.splat(f32::MIN_POSITIVE));
        let dense = within_unit(w, w.sub(w.mul(w.splat(2.0), w.div(matter.depth, usual)), w.splat(0.5)));
        let behind = w.mul(w.sub(matter.begin, begins), w.splat(1.0 / NEAR));
        let near = within_unit(w, w.sub(w.splat(2.0), behind));
        let mut own = entry_of(w, begins, w.mul(dense, near));
        if let Some(outer) = rays.outer_entries(w, chunks) {
            own = w.select(w.lt(outer, w.splat(2.0 * NO_ENTRY)), own, outer);
        }
        // The furthest entry counts. A weak one counts as further in front, so a maximum chooses among them without a
        // threshold that the place of a sheet could cross.
        let mut entry = w.max(w.load_from(&self.entries, places), own);
        if let Some(missing) = matter.missing {
            let hole = within_unit(w, w.sub(w.mul(w.splat(4.0), missing), w.splat(1.0)));
            entry = w.max(entry, entry_of(w, matter.at, w.mul(dense, hole)));
        }
        w.store_to(entry, &mut self.entries, places);
        let share = w.mul(w.sub(w.add(entry, w.splat(REACH)), matter.at), w.splat(PER_SLICE));
        Some(within_unit(w, share))
    }

    /// The entries, for the next piece of the tile.
    pub fn into_entries(self) -> Vec<Lanes> {
        self.entries
    }
}

/// Entry at a place with a strength: one of less strength counts as one in front. A function, since closures are not
/// inlined into the vectors' own code.
#[inline(always)]
fn entry_of<W: Wide>(w: W, at: W::F, strength: W::F) -> W::F {
    let in_front = w.mul(w.sub(strength, w.splat(1.0)), w.splat(REACH));
    w.select(w.lt(w.splat(0.0), strength), w.add(at, in_front), w.splat(NO_ENTRY))
}

/// Entry of one ray at a cut, given the optical depth per slice of the matter at a way behind it, in slices.
pub fn entry_at_cut(cut: f32, behind: f32, depth_per_slice: f32) -> f32 {
    let dense = (2.0 * depth_per_slice / DEPTH - 0.5).clamp(0.0, 1.0);
    let strength = dense * (2.0 - behind / NEAR).clamp(0.0, 1.0);
    if strength > 0.0 { cut + (strength - 1.0) * REACH } else { NO_ENTRY }
}

/// Place along s, given the share of the way between two sheets.
#[inline(always)]
pub fn place_between<W: Wide>(w: W, [front, back]: [f32; 2], share: W::F) -> W::F {
    w.add_mul(w.splat(front), share, w.splat(back - front))
}

/// The larger of the missing shares on the front and the back sheet.
#[inline(always)]
pub fn most_missing<W: Wide>(w: W, missing: Option<[W::F; 2]>) -> Option<W::F> {
    let [front, back] = missing?;
    Some(w.max(front, back))
}

/// A number, or the nearer of 0 and 1.
#[inline(always)]
fn within_unit<W: Wide>(w: W, x: W::F) -> W::F {
    w.min(w.max(x, w.splat(0.0)), w.splat(1.0))
}
