//! Pieces of a picture: some tiles of a base plane through some consecutive sheets, from one state to the next.
//!
//! A frame, a stream of boxes, a cluster and a GPU are schedules over pieces. Cuts run along tiles and sheets, never
//! along walls through the data: there are no seams, and any cuts give the same bytes as none.

use std::ops::Range;

use wavesplat_compute::parallel;

use crate::picture::base_picture::{BasePicture, TileTexels};
use crate::ray::compositor::{Compositor, Texels};
use crate::ray::first_hit::FirstHit;
use crate::ray::local_maximum::LocalMaximum;

use crate::ray::media::{LayerOptics, OverTile};
use crate::ray::over::One;
use crate::ray::over_layers::Several;
use crate::ray::project::Project;
use crate::ray::state::TileState;
use crate::ray::surfaces::TileSurfaces;
use crate::render::plan::{FamilyPlan, Operator, Plan};
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::tile::{Piece, TileJob, Work, n_tiles};
use crate::shapes::fragments::composite_behind;
use crate::sheet::tile_layout::{BlockMask, Chunk, TILE_U, TILE_V};
use crate::source::slices::{Slices, needed_samples};
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Error, Result};

/// Draws some tiles of a base plane through some consecutive slabs, on all threads.
///
/// `family`: number of the base plane in the plan. `tiles`: their numbers along u and v. `slabs`: spaces between two
/// sheets, counted in the order in which rays meet them. `slices`: per layer, the whole volume, or a box with the
/// samples that [`samples_of`] returns. `states`: states of these tiles after all slabs before, without gaps; `None`
/// where nothing has been seen yet. Returns the states after these slabs. `callback` receives the fraction of the tiles
/// that are done, and may cancel ([`Error::Cancelled`]).
pub fn draw_piece(
    plan: &Plan,
    family: usize,
    tiles: &[[usize; 2]],
    slabs: &Range<usize>,
    slices: &[&Slices],
    states: &[Option<TileState>],
    callback: &dyn ProgressCallback,
) -> Result<(Vec<Option<TileState>>, Work)> {
    let job = TileJob::new(plan, &plan.families[family], slices);
    let progress = Progress::new(callback, tiles.len());
    let drawn = parallel::map(tiles.len(), |k| {
        if progress.is_stopped() {
            return (None, Work::default());
        }
        let piece = Piece { tile: tiles[k], blocks: BlockMask::MAX, slabs: slabs.clone() };
        let mut work = Work::default();
        let state = states.get(k).cloned().flatten();
        let run = Run { job: &job, piece: &piece, state, work: &mut work, finish: IntoState };
        let state = with_operator(plan, job.family, run);
        progress.tile_done();
        (state, work)
    });
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    let work = drawn.iter().fold(Work::default(), |all, (_, work)| all.and(*work));
    Ok((drawn.into_iter().map(|(state, _)| state).collect(), work))
}

/// Index ranges, along x, y and z, of the samples of a layer that a piece needs; `None` where there are no tiles.
/// `slices`: of all layers.
pub fn samples_of(
    plan: &Plan,
    family: usize,
    tiles: &[[usize; 2]],
    slabs: &Range<usize>,
    slices: &[&Slices],
    layer: usize,
) -> Option<[Range<usize>; 3]> {
    let family = &plan.families[family];
    let spacing = &family.spacing;
    let first = slabs.start.min(spacing.n_slabs);
    let last = slabs.end.min(spacing.n_slabs);
    let job = TileJob::new(plan, family, slices);
    let w = [first, last].map(|k| spacing.w(if family.plane.family.ascending { k } else { spacing.n_slabs - k }));
    let mut reached: Option<[Range<usize>; 3]> = None;
    for tile in tiles {
        let from = [tile[0] * TILE_U, tile[1] * TILE_V];
        let to = [from[0] + TILE_U - 1, from[1] + TILE_V - 1];
        let own = job.layers[layer].geometry.reached(from, to, w);
        reached = Some(match reached {
            None => own,
            Some(all) => [0, 1, 2].map(|a| all[a].start.min(own[a].start)..all[a].end.max(own[a].end)),
        });
    }
    reached.map(|reached| needed_samples(&reached, &plan.layers[layer].grid, slices[layer].kernel()))
}

/// Numbers along u and v of all tiles of a base plane, row by row.
pub fn tiles_of(plan: &Plan, family: usize) -> Vec<[usize; 2]> {
    let [n_u, n_v] = n_tiles(&plan.families[family].plane);
    (0..n_u * n_v).map(|k| [k % n_u, k / n_u]).collect()
}

/// Writes the texels of a finished tile, given its state; `None` where nothing of the volumes has been seen.
pub fn finish_tile(plan: &Plan, family: usize, tile: [usize; 2], state: Option<TileState>, texels: &mut TileTexels) {
    let family = &plan.families[family];
    let finish = WriteTexels { texels, sign: family.sign() };
    let Some(mut state) = state else { return finish_unseen(plan, family, tile, finish) };
    let surfaces = family.surfaces(first_of(tile), std::mem::take(&mut state.passed));
    with_operator(plan, family, Resume { state, surfaces, finish });
}

/// Writes the surfaces of a tile in which nothing of the volumes is seen.
fn finish_unseen(plan: &Plan, family: &FamilyPlan, tile: [usize; 2], finish: WriteTexels) {
    // Projections hold no colours: surfaces are drawn beside them.
    if plan.operator.projection().is_none()
        && let Some(surfaces) = family.surfaces(first_of(tile), Vec::new())
    {
        finish.put_surfaces(&surfaces);
    }
}

/// First texel of a tile.
fn first_of(tile: [usize; 2]) -> [usize; 2] {
    [tile[0] * TILE_U, tile[1] * TILE_V]
}

/// A base picture before anything of the volumes is drawn: the surfaces of shapes alone, where the operator composites
/// them. Finished tiles are put into it.
pub fn unseen_picture(plan: &Plan, family: usize) -> BasePicture {
    let family = &plan.families[family];
    if plan.operator.projection().is_some() {
        return BasePicture::new(family.plane.clone(), plan.with_depth);
    }
    draw_surfaces(family, plan.with_depth)
}

/// The surfaces of shapes on a base plane, without matter.
pub(super) fn draw_surfaces(family: &FamilyPlan, with_depth: bool) -> BasePicture {
    let mut picture = BasePicture::new(family.plane.clone(), with_depth);
    if family.fragments.is_none() {
        return picture;
    }
    let [n_tiles_u, _] = n_tiles(&family.plane);
    picture.fill_tiles([TILE_U, TILE_V], |k, texels| {
        if let Some(surfaces) = family.surfaces(first_of([k % n_tiles_u, k / n_tiles_u]), Vec::new()) {
            WriteTexels { texels, sign: family.sign() }.put_surfaces(&surfaces);
        }
    });
    picture
}

/// Draws a piece of a tile and writes the tile's texels.
pub(super) fn draw_tile(plan: &Plan, job: &TileJob, piece: &Piece, texels: &mut TileTexels) -> Work {
    let mut work = Work::default();
    let put = WriteTexels { texels: &mut *texels, sign: job.family.sign() };
    if with_operator(plan, job.family, Run { job, piece, state: None, work: &mut work, finish: put }).is_none() {
        finish_unseen(plan, job.family, piece.tile, WriteTexels { texels, sign: job.family.sign() });
    }
    work
}

/// Calls `work` with the constructor of the compositor for a plan's operator.
fn with_operator<U: WithCompositor>(plan: &Plan, family: &FamilyPlan, work: U) -> U::Output {
    let media = plan.layers.iter().zip(&family.layers).map(|(layer, of_family)| LayerOptics {
        classifier: &layer.tables,
        shader: of_family.shader.as_ref(),
        modifiers: &of_family.modifiers,
    });
    let media: Vec<LayerOptics> = media.collect();
    let LayerOptics { classifier: tables, shader, modifiers } = media[0];
    let depth = plan.with_depth;
    match plan.operator {
        Operator::Over { pre_integrated, opaque } => {
            let (shaders, ends) = (media.iter().map(|medium| medium.shader), (opaque, depth));
            if media.len() > 1 {
                work.call(|state| OverTile::new(Several(&media), shaders, pre_integrated, ends, state))
            } else if modifiers.any() {
                work.call(|state| OverTile::new(One::<true>(media[0]), shaders, pre_integrated, ends, state))
            } else {
                work.call(|state| OverTile::new(One::<false>(media[0]), shaders, pre_integrated, ends, state))
            }
        }
        Operator::FirstHit { iso } => {
            work.call(|state| FirstHit::new(iso, tables, shader, modifiers.color.as_ref(), state))
        }
        Operator::LocalMaximum { threshold } => work.call(|state| LocalMaximum::new(threshold, depth, state)),
        Operator::Project { composite, levels } => work.call(|state| Project::new(composite, levels, depth, state)),
    }
}

/// Work that is generic over the compositor: written once for all operators.
trait WithCompositor {
    type Output;
    fn call<C: Compositor>(self, new: impl FnOnce(Option<TileState>) -> C) -> Self::Output;
}

/// Composites a piece of a tile, then finishes the compositor.
struct Run<'a, 'b, T> {
    job: &'a TileJob<'b>,
    piece: &'a Piece,
    state: Option<TileState>,
    work: &'a mut Work,
    finish: T,
}

impl<T: Finish> WithCompositor for Run<'_, '_, T> {
    type Output = Option<T::Output>;

    fn call<C: Compositor>(self, new: impl FnOnce(Option<TileState>) -> C) -> Self::Output {
        let run = self.job.run(self.piece, self.state, new, self.work);
        run.map(|(compositor, surfaces)| self.finish.end(compositor, surfaces))
    }
}

/// Finishes a tile from a state that was composited before.
struct Resume<'a, T> {
    state: TileState,
    surfaces: Option<TileSurfaces<'a>>,
    finish: T,
}

impl<T: Finish> WithCompositor for Resume<'_, T> {
    type Output = T::Output;

    fn call<C: Compositor>(self, new: impl FnOnce(Option<TileState>) -> C) -> Self::Output {
        self.finish.end(new(Some(self.state)), self.surfaces)
    }
}

/// Final step of a compositor: it becomes a state, or writes texels.
trait Finish {
    type Output;
    fn end<C: Compositor>(self, compositor: C, surfaces: Option<TileSurfaces>) -> Self::Output;
}

struct IntoState;

impl Finish for IntoState {
    type Output = TileState;

    fn end<C: Compositor>(self, compositor: C, surfaces: Option<TileSurfaces>) -> TileState {
        let passed = surfaces.filter(|_| C::TAKES_SURFACES).map(TileSurfaces::into_passed).unwrap_or_default();
        TileState { passed, ..compositor.into_state() }
    }
}

struct WriteTexels<'a, 'b> {
    texels: &'a mut TileTexels<'b>,
    /// Ratio of positions along rays to positions along w: 1 or -1.
    sign: f32,
}

impl WriteTexels<'_, '_> {
    /// Writes a chunk, in front of the surfaces that its rays have not passed.
    fn put(&mut self, chunk: Chunk, mut of_rays: Texels, surfaces: Option<&TileSurfaces>) {
        if let Some(surfaces) = surfaces.filter(|surfaces| surfaces.has_rest(chunk)) {
            for lane in 0..LANES {
                let s_half = of_rays.s_half.as_mut().map(|s_half| &mut s_half[lane]);
                composite_behind(&mut of_rays.rgba[lane], surfaces.rest(chunk, lane), s_half);
            }
        }
        let w_half = of_rays.s_half.map(|s| s.map(|s| s * self.sign));
        self.texels.put(chunk.strip * LANES, chunk.row, &of_rays.rgba, w_half.as_ref());
    }

    /// Writes surfaces alone, for a tile in which nothing of the volumes is seen.
    fn put_surfaces(mut self, surfaces: &TileSurfaces) {
        for chunk in Chunk::all().filter(|chunk| surfaces.has_rest(*chunk)) {
            let nothing = Texels { rgba: [[0.0; 4]; LANES], s_half: Some([f32::NAN; LANES]) };
            self.put(chunk, nothing, Some(surfaces));
        }
    }
}

impl Finish for WriteTexels<'_, '_> {
    type Output = ();

    fn end<C: Compositor>(mut self, compositor: C, surfaces: Option<TileSurfaces>) {
        let surfaces = surfaces.filter(|_| C::TAKES_SURFACES);
        for chunk in Chunk::all() {
            self.put(chunk, compositor.finish(chunk), surfaces.as_ref());
        }
    }
}
