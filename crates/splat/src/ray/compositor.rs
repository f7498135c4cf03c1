//! What a composite operator is: how the sheets of a tile become one value per ray, slab by slab, front to back.
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
    /// Those of further layers.
    pub more: &'a mut [LayerSheets<'b>],
    /// The fields on the sheet in front and on that behind, and where they lie.
    pub fields: [&'a mut FieldSheets; 2],
    /// For reconstructing chunks of fields.
    pub field_geometries: &'a [SheetGeometry<'b>],
    /// Samples that the sheets of fields are made of.
    pub field_panels: &'a FieldSlices,
}

/// Densities of a chunk on both sheets.
pub struct Ends {
    /// On the sheet in front.
    pub front: [f32; LANES],
    /// On the sheet behind.
    pub back: [f32; LANES],
    /// Missing shares on both, of volumes with missing samples.
    pub missing: Option<[[f32; LANES]; 2]>,
}

impl Ends {
    /// Of a slab in which densities are ready.
    #[inline(always)]
    pub fn new<S: Simd>(s: S, chunk: Chunk, slab: &mut Slab) -> Self {
        let (mut front, mut back) = ([0.0; LANES], [0.0; LANES]);
        s.store(slab.first.front.density(s, [chunk; 2]), &mut front);
        s.store(slab.first.back.density(s, [chunk; 2]), &mut back);
        // A closure would not be inlined, and call every vector instruction.
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
    /// Position of opacity ½, NaN where it is not reached; only of operators that have a surface, where it is wanted.
    pub s_half: Option<[f32; LANES]>,
}

impl Texels {
    /// Colours, and where opacity is ½.
    pub fn new(rgba: &[Lanes; 4], s_half: Option<&Lanes>) -> Self {
        let [r, g, b, a] = rgba;
        Self { rgba: std::array::from_fn(|i| [r.0[i], g.0[i], b.0[i], a.0[i]]), s_half: s_half.map(|s| s.0) }
    }
}

/// An operator at work on one tile.
pub trait Compositor {
    /// Whether the sheet behind is looked at too, even if another slab follows.
    fn looks_behind(&self) -> bool {
        true
    }
    /// Whether no ray of the chunk can change any more.
    fn is_done(&self, chunk: Chunk) -> bool;
    /// Adds the space between two sheets, front to back, to a chunk. Densities are ready on those sheets that are looked
    /// at. Spaces in which nothing is visible may be left out. `#[inline(always)]`.
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab);
    /// The same for those chunks of a block that are neither done nor missed.
    #[inline(always)]
    fn add<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        self.add_one_by_one(s, block, rays, slab);
    }
    /// Chunk by chunk.
    #[inline(always)]
    fn add_one_by_one<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        for chunk in block.chunks() {
            if !rays.none(chunk) && !self.is_done(chunk) {
                self.add_chunk(s, chunk, rays, slab);
            }
        }
    }
    /// The result of a chunk.
    fn finish(&self, chunk: Chunk) -> Texels;
    /// What another piece of the same tile goes on from.
    fn into_state(self) -> TileState;
}
