//! Interface of composite operators: from the sheets of a tile to one value per ray, slab by slab, front to back.
//!
//! Positions are `s`, the slice coordinate w with the sign that makes it grow along the ray.

use crate::sheet::field_sheets::{FieldSheets, FieldSlices};
use crate::sheet::layer_sheets::LayerSheets;
use crate::sheet::tile_layout::{Block, Chunk};
use crate::sheet::tile_rays::Rays;
use crate::source::geometry::SheetGeometry;
use wavesplat_compute::simd::{LANES, Lanes, Simd};

use crate::ray::state::TileState;

/// The space between two consecutive sheets of a tile.
pub struct Slab<'a, 'b> {
    /// Positions of the front and the back sheet.
    pub s: [f32; 2],
    /// The sheets of the first layer, mostly the only one.
    pub first: &'a mut LayerSheets<'b>,
    /// The sheets of further layers.
    pub more: &'a mut [LayerSheets<'b>],
    /// The fields' sheets at the positions of the front and the back sheet.
    pub fields: [&'a mut FieldSheets; 2],
    /// Geometry of each field, for reconstructing its chunks.
    pub field_geometries: &'a [SheetGeometry<'b>],
    /// Samples that the fields' sheets are made of.
    pub field_panels: &'a FieldSlices,
}

impl Slab<'_, '_> {
    /// Interval of s for which the sheets stand where slabs are not pre-integrated: half a slab on both sides of the front
    /// sheet, and the rest where the back sheet `is_last`.
    #[inline(always)]
    pub fn covered_by_sheets(&self, is_last: bool) -> [f32; 2] {
        let [front, back] = self.s;
        let half = 0.5 * (back - front);
        [front - half, if is_last { back } else { front + half }]
    }

    /// Whether the slab is the last one of some layer in a block: its back sheet is the front of no other slab.
    #[inline(always)]
    pub fn is_last(&self, block: Block) -> bool {
        self.first.is_last(block) || self.more.iter().any(|own| own.is_last(block))
    }

    /// Clips the layers' own rays of a chunk to what lies between two places each ([`Rays::cut`]).
    #[inline(always)]
    pub fn cut(&mut self, chunk: Chunk, places: [&Lanes; 2]) -> Vec<([Lanes; 2], [f32; 2])> {
        let layers = std::iter::once(&mut *self.first).chain(self.more.iter_mut());
        layers.filter_map(|layer| layer.rays.as_mut()).map(|rays| rays.cut(chunk, places)).collect()
    }

    /// Undoes [`Slab::cut`].
    #[inline(always)]
    pub fn restore(&mut self, chunk: Chunk, kept: Vec<([Lanes; 2], [f32; 2])>) {
        let layers = std::iter::once(&mut *self.first).chain(self.more.iter_mut());
        for (rays, kept) in layers.filter_map(|layer| layer.rays.as_mut()).zip(kept) {
            rays.restore(chunk, kept);
        }
    }
}

/// Densities of a chunk on both sheets.
pub struct Ends {
    /// Densities on the front sheet.
    pub front: [f32; LANES],
    /// Densities on the back sheet.
    pub back: [f32; LANES],
    /// Missing shares on both sheets; `None` for volumes without missing samples.
    pub missing: Option<[[f32; LANES]; 2]>,
}

impl Ends {
    /// Reads a chunk on both sheets of a slab, whose densities must be ready.
    #[inline(always)]
    pub fn new<S: Simd>(s: S, chunk: Chunk, slab: &mut Slab) -> Self {
        let (mut front, mut back) = ([0.0; LANES], [0.0; LANES]);
        s.store(slab.first.front.density(s, [chunk; 2]), &mut front);
        s.store(slab.first.back.density(s, [chunk; 2]), &mut back);
        // No closure: it would not be inlined, and every vector instruction would become a call.
        let mut missing = None;
        if slab.first.geometry.slices.has_mask() {
            let mut shares = [[0.0; LANES]; 2];
            s.store(slab.first.front.missing(s, [chunk; 2]), &mut shares[0]);
            s.store(slab.first.back.missing(s, [chunk; 2]), &mut shares[1]);
            missing = Some(shares);
        }
        Self { front, back, missing }
    }
}

/// The result of a chunk of rays.
#[derive(Clone, Copy, Debug)]
pub struct Texels {
    /// Associated RGBA; projections: density, length of the path, 0, coverage.
    pub rgba: [[f32; 4]; LANES],
    /// Position of opacity ½; NaN where it is not reached. Only from operators that find a surface, where it is wanted.
    pub s_half: Option<[f32; LANES]>,
}

impl Texels {
    /// Texels from lanes of red, green, blue and opacity, and of positions of opacity ½.
    pub fn new(rgba: &[Lanes; 4], s_half: Option<&Lanes>) -> Self {
        let [r, g, b, a] = rgba;
        Self { rgba: std::array::from_fn(|i| [r.0[i], g.0[i], b.0[i], a.0[i]]), s_half: s_half.map(|s| s.0) }
    }
}

/// One surface for each ray of a chunk, or none.
pub struct ChunkSurfaces {
    /// Colours, not associated.
    pub rgb: [[f32; LANES]; 3],
    /// Opacities; 0 for rays that meet none.
    pub alpha: [f32; LANES],
    /// Places along the rays.
    pub s: [f32; LANES],
}

/// An operator at work on one tile.
pub trait Compositor {
    /// Whether a slab reads its back sheet too, even if another slab follows.
    fn reads_back_sheet(&self) -> bool {
        true
    }
    /// Whether surfaces of shapes are composited with matter; else rays only end at those that are opaque.
    const TAKES_SURFACES: bool = false;
    /// Interval of s whose matter a slab adds to a block.
    #[inline(always)]
    fn covered(&self, _: Block, slab: &Slab) -> [f32; 2] {
        slab.s
    }
    /// Composites surfaces behind all that was added before.
    #[inline(always)]
    fn add_surfaces<S: Simd>(&mut self, _: S, _: Chunk, _: &Rays, _: &ChunkSurfaces) {}
    /// Whether no ray of the chunk can change any more.
    fn is_done(&self, chunk: Chunk) -> bool;
    /// Adds the slab between two sheets to a chunk. Slabs come front to back, with densities ready on the sheets that
    /// are read; slabs in which nothing is visible may be left out. Must be `#[inline(always)]`.
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab);
    /// Adds a slab to those chunks of a block that are neither done nor missed.
    #[inline(always)]
    fn add<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        self.add_one_by_one(s, block, rays, slab);
    }
    /// Adds a slab to a block chunk by chunk: the default of [`Compositor::add`].
    #[inline(always)]
    fn add_one_by_one<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        for chunk in block.chunks() {
            if !rays.draws_nothing(chunk) && !self.is_done(chunk) {
                self.add_chunk(s, chunk, rays, slab);
            }
        }
    }
    /// The result of a chunk.
    fn finish(&self, chunk: Chunk) -> Texels;
    /// The state that the next piece of the tile continues from.
    fn into_state(self) -> TileState;
}
