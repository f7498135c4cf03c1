//! One tile of a base plane: consecutive sheets, front to back, without leaving the cache.
//!
//! Bricks in which nothing is visible are skipped (`empty_space.rs`), and so are blocks whose rays are all opaque
//! (early ray termination). The rest is reconstructed chunk by chunk as the compositor asks for it.

use std::ops::Range;

use wavesplat_compute::simd::{LANES, Level, Simd, VectorKernel};
use wavesplat_core::Gradient;

use crate::kernel::footprint_table::bits;
use crate::ray::compositor::{Compositor, Slab};
use crate::ray::state::TileState;
use crate::ray::surfaces::TileSurfaces;
use crate::render::empty_space::ActiveSlab;
use crate::render::part_plan::PartPlan;
use crate::render::plan::{ColorPlan, FamilyLayer, FamilyPlan, Plan};
use crate::sheet::field_sheets::{FieldSheets, FieldSlices};
use crate::sheet::layer_sheets::LayerSheets;
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_layout::{BLOCK_V, Block, BlockMask, N_BLOCKS_V, TILE_U, TILE_V, blocks_with};
use crate::sheet::tile_rays::{RayGeometry, Rays};
use crate::source::geometry::SheetGeometry;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;

/// Blocks of a tile, and the slabs through which they are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Number of the tile along u and along v.
    pub tile: [usize; 2],
    /// Blocks of the tile.
    pub blocks: BlockMask,
    /// Spaces between two sheets, counted in the order in which rays meet them.
    pub slabs: Range<usize>,
}

impl Piece {
    /// All blocks and slabs of a tile.
    pub fn whole(tile: [usize; 2]) -> Self {
        Self { tile, blocks: BlockMask::MAX, slabs: 0..usize::MAX }
    }

    /// One whole piece per tile of a base plane, row by row.
    pub fn all(plane: &BasePlane) -> Vec<Self> {
        let [n_u, n_v] = n_tiles(plane);
        (0..n_u * n_v).map(|k| Self::whole([k % n_u, k / n_u])).collect()
    }
}

/// Number of tiles of a base plane along u and v.
pub fn n_tiles(plane: &BasePlane) -> [usize; 2] {
    [plane.size[0].div_ceil(TILE_U), plane.size[1].div_ceil(TILE_V)]
}

/// Counts of the work that a piece took, for the report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Texels of the blocks that were composited, summed over all sheets.
    pub n_texels: u64,
    /// Slabs of tiles that were skipped because nothing in them is visible.
    pub n_skipped: u64,
}

impl Work {
    /// Adds the counts of another piece.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { n_texels: self.n_texels + other.n_texels, n_skipped: self.n_skipped + other.n_skipped }
    }
}

/// Data that all tiles of a base plane share: its plan and the samples it is drawn from.
pub(super) struct TileJob<'a> {
    pub family: &'a FamilyPlan,
    pub layers: Vec<LayerJob<'a>>,
    /// Geometry of the rays through all layers together.
    pub rays: RayGeometry<'a>,
    level: Level,
    /// The part of space that is drawn; `None`: all.
    part: Option<&'a PartPlan>,
    /// Geometry of the fields: where their samples lie on the sheets.
    pub fields: Vec<SheetGeometry<'a>>,
    /// Number of the fields of light and labels, which come before those that colour layers.
    pub n_plain_fields: usize,
}

/// A layer on a base plane: its samples, plan and rays.
pub(super) struct LayerJob<'a> {
    pub geometry: SheetGeometry<'a>,
    pub family: &'a FamilyLayer,
    pub rays: RayGeometry<'a>,
}

impl<'a> TileJob<'a> {
    /// Job of a base plane. `slices`: per layer, the volume, or a box of it that holds all samples that the pieces
    /// need; then the fields that colour layers, in the order of these.
    pub fn new(plan: &'a Plan, family: &'a FamilyPlan, slices: &[&'a Slices<'a>]) -> Self {
        let plane = &family.plane;
        let map = &plan.layers[0].map;
        let layers: Vec<LayerJob> = plan
            .layers
            .iter()
            .zip(&family.layers)
            .zip(slices)
            .map(|((layer, of_family), slices)| LayerJob {
                geometry: SheetGeometry::new(plan.simd, plane, slices, of_family.gradient).placed(&layer.map),
                family: of_family,
                rays: family.ray_geometry(plan, layer),
            })
            .collect();
        let widened = plan.region.widened(plane, plane.beyond);
        let rays = RayGeometry { region: &plan.region, widened, ..family.ray_geometry(plan, &plan.layers[0]) };
        let of_field = |field| SheetGeometry::of_field(plan.simd, plane, field, map);
        let colored = plan.layers.iter().zip(&family.layers);
        let colors = colored.filter_map(|(layer, of_family)| Some((layer.color.as_ref()?, of_family.gradient)));
        // With the layer's gradient, which is not made: footprints then begin at the same samples as the layer's, and sums
        // of equal samples have the same order.
        let of_color = |((color, gradient), slices): ((&ColorPlan, Option<Gradient>), &&'a Slices<'a>)| {
            SheetGeometry::new(plan.simd, plane, slices, gradient).placed(&color.map)
        };
        let of_colors = colors.zip(&slices[plan.layers.len()..]).map(of_color);
        let fields = plan.fields.fields.iter().map(of_field).chain(of_colors).collect();
        let n_plain_fields = plan.fields.fields.len();
        Self { family, layers, rays, level: plan.simd, part: plan.part.as_ref(), fields, n_plain_fields }
    }

    /// Chunks of rays of a tile, given by its first texel, that may see something, as bits ([`Chunk::index`]).
    pub fn chunks_that_see(&self, first: [usize; 2]) -> u128 {
        let needed = self.needed_blocks(first);
        if needed == 0 || !self.layers.iter().any(|layer| layer.active_layers(first).contains(&true)) {
            return 0;
        }
        let (rays, _) = Rays::new(&self.rays, self.level, first);
        let mut seen = 0;
        for block in bits(needed) {
            for chunk in Block::new(block).chunks().filter(|chunk| !rays.draws_nothing(*chunk)) {
                seen |= 1 << chunk.index();
            }
        }
        seen
    }

    /// Composites a piece of a tile, starting from a state; `None` where nothing has been seen, neither in this piece
    /// nor before it.
    pub fn run<C: Compositor>(
        &self,
        piece: &Piece,
        state: Option<TileState>,
        compositor: impl FnOnce(Option<TileState>) -> C,
        work: &mut Work,
    ) -> Option<(C, Option<TileSurfaces<'a>>)> {
        let spacing = &self.family.spacing;
        let first = [piece.tile[0] * TILE_U, piece.tile[1] * TILE_V];
        let mut state = state;
        let passed = state.as_mut().map(|state| std::mem::take(&mut state.passed)).unwrap_or_default();
        let mut surfaces = self.family.surfaces(first, passed);
        let n_slabs = piece.slabs.end.min(spacing.n_slabs).saturating_sub(piece.slabs.start);
        let needed = self.needed_blocks(first) & piece.blocks;
        let bricks: Vec<Vec<bool>> =
            if needed == 0 { Vec::new() } else { self.layers.iter().map(|layer| layer.active_layers(first)).collect() };
        if n_slabs == 0 || !bricks.iter().any(|layers| layers.contains(&true)) {
            work.n_skipped += n_slabs as u64;
            return state.map(|state| (compositor(Some(state)), surfaces));
        }
        let (mut rays, span) = Rays::new(&self.rays, self.level, first);
        if let Some(part) = self.part {
            part.tell_entries(&mut rays, &self.family.plane, first);
        }
        if let Some(surfaces) = &surfaces {
            surfaces.end_rays(&mut rays);
        }
        let mut alive = needed & blocks_with(|chunk| !rays.draws_nothing(chunk));
        if let Some(state) = state.as_ref().filter(|state| !state.done.is_empty()) {
            alive &= blocks_with(|chunk| !rays.draws_nothing(chunk) && !state.done[chunk.index()]);
        }
        // One slab more, to know whether the last sheet here is the front of another slab.
        let wanted = piece.slabs.start..piece.slabs.end.saturating_add(1);
        let is_mixed = self.layers.len() > 1;
        let (mut runs, mut sheets) = (Vec::new(), Vec::new());
        for (layer, bricks) in self.layers.iter().zip(&bricks) {
            let (mut own_rays, mut range, mut own_alive) = (None, spacing.range(span), alive);
            if is_mixed && bricks.contains(&true) {
                let (mut rays, span) = Rays::new(&layer.rays, self.level, first);
                if let Some(surfaces) = &surfaces {
                    surfaces.end_rays(&mut rays);
                }
                range = spacing.range(span);
                own_alive &= blocks_with(|chunk| !rays.draws_nothing(chunk));
                own_rays = Some(rays);
            }
            let mut slabs = if bricks.contains(&true) {
                layer.active_slabs(spacing, first, range, &wanted, bricks, own_alive)
            } else {
                Vec::new()
            };
            let behind = slabs.pop_if(|slab| slab.place >= piece.slabs.end);
            runs.push(LayerRun { slabs, behind, next: 0, in_front: None });
            sheets.push(LayerSheets::new(&layer.geometry, own_rays));
        }
        let places = places(&runs);
        work.n_skipped += (n_slabs - places.len()) as u64;
        if places.is_empty() {
            return state.map(|state| (compositor(Some(state)), surfaces));
        }
        let mut compositor = compositor(state);
        let on_rays = (&mut rays, surfaces.as_mut().filter(|_| C::TAKES_SURFACES));
        self.run_slabs(first, &places, (&mut runs, &mut sheets), alive, on_rays, &mut compositor, work);
        Some((compositor, surfaces))
    }

    /// Composites active slabs, front to back.
    #[expect(clippy::too_many_arguments, reason = "a tile, its slabs and rays, and where they go")]
    fn run_slabs<'s, C: Compositor>(
        &'s self,
        first: [usize; 2],
        places: &[ActiveSlab],
        (runs, sheets): (&mut [LayerRun], &mut [LayerSheets<'s>]),
        mut alive: BlockMask,
        (rays, mut surfaces): (&mut Rays, Option<&mut TileSurfaces>),
        compositor: &mut C,
        work: &mut Work,
    ) {
        let spacing = &self.family.spacing;
        let sign = self.family.sign();
        // All sheets that are drawn, and so all samples that are read, lie between these positions.
        let ends = [places[0].sheets[0], places[places.len() - 1].sheets[1]].map(|sheet| spacing.w(sheet));
        let (mut front_fields, mut back_fields) = (FieldSheets::default(), FieldSheets::default());
        let mut in_front = None;
        let mut field_panels = FieldSlices::new(self.fields.len());
        for (k, slab) in places.iter().enumerate() {
            let blocks = slab.blocks & alive;
            for (run, sheets) in runs.iter_mut().zip(sheets.iter_mut()) {
                run.prepare(sheets, spacing, slab, first, alive, compositor.reads_back_sheet());
            }
            if blocks == 0 {
                runs.iter_mut().zip(sheets.iter_mut()).for_each(|(run, sheets)| run.advance(sheets, slab));
                continue;
            }
            let w = slab.sheets.map(|sheet| spacing.w(sheet));
            if !self.fields.is_empty() {
                let texels = texels_ahead(spacing, places, k, alive, first);
                field_panels.cover(&self.fields, w, ends, texels);
                if in_front != Some(slab.sheets[0]) {
                    front_fields.place(self.fields.len(), w[0], first, blocks);
                }
                let next = places.get(k + 1).filter(|next| next.sheets[0] == slab.sheets[1]);
                let next = next.map_or(0, |next| next.blocks & alive);
                back_fields.place(self.fields.len(), w[1], first, blocks | next);
            }
            let [of_first, more @ ..] = &mut *sheets else { return };
            for block in bits(blocks) {
                let done = self.level.dispatch(CompositeBlock {
                    compositor: &mut *compositor,
                    rays: &mut *rays,
                    surfaces: surfaces.as_deref_mut(),
                    slab: Slab {
                        s: w.map(|w| sign * w as f32),
                        first: of_first,
                        more,
                        fields: [&mut front_fields, &mut back_fields],
                        field_geometries: &self.fields,
                        field_panels: &field_panels,
                    },
                    block: Block::new(block),
                });
                work.n_texels += (LANES * BLOCK_V) as u64;
                if done {
                    alive &= !Block::new(block).mask();
                }
            }
            for (run, sheets) in runs.iter_mut().zip(sheets.iter_mut()) {
                run.advance(sheets, slab);
            }
            std::mem::swap(&mut front_fields, &mut back_fields);
            in_front = Some(slab.sheets[1]);
        }
    }
}

/// State of a layer of a tile on the way through its active slabs.
struct LayerRun {
    /// Active slabs of the layer, front to back.
    slabs: Vec<ActiveSlab>,
    /// Slab that directly follows the piece, if it is active too.
    behind: Option<ActiveSlab>,
    /// Index in `slabs` of the next slab.
    next: usize,
    /// Number of the sheet that the front buffer holds, if any.
    in_front: Option<usize>,
}

impl LayerRun {
    /// Prepares the layer's sheets on both sides of a slab, if the layer is active in it.
    fn prepare(
        &mut self,
        sheets: &mut LayerSheets,
        spacing: &SheetSpacing,
        slab: &ActiveSlab,
        first: [usize; 2],
        alive: BlockMask,
        reads_back_sheet: bool,
    ) {
        let Self { slabs, behind, next, in_front } = self;
        let k = *next;
        let own = slabs.get(k).filter(|own| own.place == slab.place);
        let blocks = own.map_or(0, |own| own.blocks & alive);
        sheets.blocks = blocks;
        sheets.last = 0;
        if blocks == 0 {
            return;
        }
        let w = slab.sheets.map(|sheet| spacing.w(sheet));
        let ends = [slabs[0].sheets[0], slabs[slabs.len() - 1].sheets[1]].map(|sheet| spacing.w(sheet));
        sheets.transposed.cover(sheets.geometry, w, ends, texels_ahead(spacing, slabs, k, alive, first));
        if *in_front != Some(slab.sheets[0]) {
            sheets.front.combine(sheets.geometry, &sheets.transposed, w[0], first, blocks);
        }
        // The sheet behind this slab is in front of the next one, which may belong to another piece.
        let follows = |next: &ActiveSlab| next.sheets[0] == slab.sheets[1];
        let of = |next: Option<ActiveSlab>| next.filter(follows).map_or(0, |next| next.blocks & alive);
        let next_here = of(slabs.get(k + 1).copied());
        let next = if k + 1 == slabs.len() { of(*behind) } else { next_here };
        sheets.back.combine(sheets.geometry, &sheets.transposed, w[1], first, blocks | next_here);
        sheets.front.prepare(sheets.geometry, blocks);
        sheets.back.prepare(sheets.geometry, if reads_back_sheet { blocks } else { blocks & !next });
        sheets.last = blocks & !next;
    }

    /// Moves on from a slab: its back sheet becomes the front sheet.
    fn advance(&mut self, sheets: &mut LayerSheets, slab: &ActiveSlab) {
        if sheets.blocks != 0 {
            std::mem::swap(&mut sheets.front, &mut sheets.back);
            self.in_front = Some(slab.sheets[1]);
        }
        if self.slabs.get(self.next).is_some_and(|own| own.place == slab.place) {
            self.next += 1;
        }
    }
}

/// Slabs that are active in any layer, front to back, each with the union of the layers' blocks.
fn places(runs: &[LayerRun]) -> Vec<ActiveSlab> {
    if let [only] = runs {
        return only.slabs.clone();
    }
    let mut places: Vec<ActiveSlab> = runs.iter().flat_map(|run| run.slabs.iter().copied()).collect();
    places.sort_unstable_by_key(|slab| slab.place);
    places.dedup_by(|slab, before| {
        let is_same = slab.place == before.place;
        if is_same {
            before.blocks |= slab.blocks;
        }
        is_same
    });
    places
}

/// Function that returns the bounding box of the texels that slab `k`, and the slabs that the window still covers,
/// need.
fn texels_ahead<'a>(
    spacing: &'a SheetSpacing,
    slabs: &'a [ActiveSlab],
    k: usize,
    alive: BlockMask,
    first: [usize; 2],
) -> impl Fn(&dyn Fn(f64) -> bool) -> [[usize; 2]; 2] + 'a {
    move |serves| {
        texels_served(&slabs[k..], k.checked_sub(1).map(|k| slabs[k]), alive, first, |slab| {
            slab.sheets.iter().all(|s| serves(spacing.w(*s)))
        })
    }
}

/// First and last texel that the served slabs, and the one after them, need: the last sheet is prepared for that one
/// too. `before`: the slab in front, whose sheet may still be in use.
fn texels_served(
    slabs: &[ActiveSlab],
    before: Option<ActiveSlab>,
    alive: BlockMask,
    first: [usize; 2],
    is_served: impl Fn(&ActiveSlab) -> bool,
) -> [[usize; 2]; 2] {
    let n_served = slabs.iter().take_while(|slab| is_served(slab)).count();
    let ahead = slabs.iter().take(n_served + 1);
    let before = before.map_or(0, |before| before.blocks);
    let blocks = before | ahead.fold(0, |all, slab| all | slab.blocks) & alive;
    let strips = bits(blocks).map(|b| b / N_BLOCKS_V);
    let rows = bits(blocks).map(|b| b % N_BLOCKS_V);
    let from = [strips.clone().min(), rows.clone().min()].map(Option::unwrap_or_default);
    let to = [strips.max(), rows.max()].map(Option::unwrap_or_default);
    [
        [first[0] + from[0] * LANES, first[1] + from[1] * BLOCK_V],
        [first[0] + (to[0] + 1) * LANES - 1, first[1] + (to[1] + 1) * BLOCK_V - 1],
    ]
}

/// Composites a slab onto the rays of a block; returns whether all of them are done.
struct CompositeBlock<'a, 'b, 'f, C> {
    compositor: &'a mut C,
    rays: &'a mut Rays,
    /// Surfaces of shapes, where there are any.
    surfaces: Option<&'a mut TileSurfaces<'f>>,
    slab: Slab<'a, 'b>,
    block: Block,
}

impl<C: Compositor> VectorKernel for CompositeBlock<'_, '_, '_, C> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(mut self, s: S) -> bool {
        let covered = self.compositor.covered(self.block, &self.slab);
        match self.surfaces {
            Some(surfaces) if surfaces.has_before(self.block, covered[1]) => {
                surfaces.add_slab(s, self.block, self.compositor, self.rays, &mut self.slab);
            }
            _ => self.compositor.add(s, self.block, self.rays, &mut self.slab),
        }
        self.block.chunks().all(|chunk| {
            self.rays.draws_nothing(chunk) || self.compositor.is_done(chunk) || self.rays.have_ended(chunk, covered[1])
        })
    }
}
