//! Even light on cut faces: where a ray enters matter through a crop, a clip plane, missing samples or the wall of the
//! volume, the face is no surface of the object, and gradients there are those of its texture and noise.
//!
//! A ray has an *entry* once it has met matter of at least [`MIN_DEPTH`] within [`NEAR`] of a cut. The share of even light
//! ([`crate::optics::shade::Shader::evened`]) at the way `d` behind the entry, in slices, is `(10 − d) / 4`, within 0 and
//! 1: the matter that a face shows lies that deep, since few looks are opaque within a voxel. A ray that comes through
//! air has no entry, and the surfaces that it meets are lit as everywhere.

use wavesplat_compute::simd::{Lanes, Wide};

use crate::optics::shade::Shader;
use crate::ray::accumulator::Chunks;
use crate::ray::state::TileState;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::MISSING;

/// Way behind the entry, in slices, from which light is not even.
pub const REACH: f32 = 10.0;

/// Share of even light per slice that is left of [`REACH`].
pub const PER_SLICE: f32 = 0.25;

/// Least optical depth per slice of matter that a cut makes a face of. Haze has less: a body's flesh in front of bones.
pub const MIN_DEPTH: f32 = 0.03;

/// Largest way from a cut to matter that the cut makes a face of, in slices.
pub const NEAR: f32 = 0.25;

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
        let [begins, _] = rays.interval(w, chunks);
        let is_dense = w.lt(w.mul(w.splat(MIN_DEPTH), matter.extent), matter.depth);
        let enters = w.and(w.le(matter.begin, w.add(begins, w.splat(NEAR))), is_dense);
        let mut entry = w.select(enters, begins, w.load_from(&self.entries, places));
        if let Some(missing) = matter.missing {
            entry = w.select(w.and(w.le(w.splat(MISSING), missing), is_dense), matter.at, entry);
        }
        w.store_to(entry, &mut self.entries, places);
        let share = w.mul(w.sub(w.add(entry, w.splat(REACH)), matter.at), w.splat(PER_SLICE));
        Some(w.min(w.max(share, w.splat(0.0)), w.splat(1.0)))
    }

    /// The entries, for the next piece of the tile.
    pub fn into_entries(self) -> Vec<Lanes> {
        self.entries
    }
}

/// The larger of the missing shares on the front and the back sheet.
#[inline(always)]
pub fn most_missing<W: Wide>(w: W, missing: Option<[W::F; 2]>) -> Option<W::F> {
    match missing {
        Some([front, back]) => Some(w.max(front, back)),
        None => None,
    }
}
