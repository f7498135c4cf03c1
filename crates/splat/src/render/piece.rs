//! Pieces of a picture: some tiles of a base plane through some consecutive sheets, from one state to the next.
//!
//! A frame, a stream of boxes, a cluster and a GPU are schedules over pieces. Cuts run along tiles and sheets, never
//! along walls through the data: there are no seams, and any cuts give the same bytes as none.

use std::ops::Range;

use wavesplat_compute::parallel;

use crate::picture::base_picture::TileTexels;
use crate::ray::compositor::Compositor;
use crate::ray::first_hit::FirstHit;
use crate::ray::local_maximum::LocalMaximum;

use crate::ray::over::Over;
use crate::ray::over_layers::{LayerOptics, OverLayers};
use crate::ray::project::Project;
use crate::ray::state::TileState;
use crate::render::plan::{FamilyPlan, Operator, Plan};
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::tile::{Piece, TileJob, Work, n_tiles};
use crate::sheet::tile_layout::{BlockMask, Chunk, N_STRIPS, TILE_U, TILE_V};
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

/// Writes the texels of a finished tile, given its state.
pub fn finish_tile(plan: &Plan, family: usize, state: TileState, texels: &mut TileTexels) {
    let family = &plan.families[family];
    with_operator(plan, family, Resume { state, finish: WriteTexels { texels, sign: family.sign() } });
}

/// Draws a piece of a tile and writes the tile's texels.
pub(super) fn draw_tile(plan: &Plan, job: &TileJob, piece: &Piece, texels: &mut TileTexels) -> Work {
    let mut work = Work::default();
    let put = WriteTexels { texels, sign: job.family.sign() };
    with_operator(plan, job.family, Run { job, piece, state: None, work: &mut work, finish: put });
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
        Operator::Over { pre_integrated, opaque } if media.len() > 1 => {
            work.call(|state| OverLayers::new(media, pre_integrated, opaque, depth, state))
        }
        Operator::Over { pre_integrated, opaque } if modifiers.any() => {
            work.call(|state| Over::<true>::new(tables, shader, modifiers, pre_integrated, opaque, depth, state))
        }
        Operator::Over { pre_integrated, opaque } => {
            work.call(|state| Over::<false>::new(tables, shader, modifiers, pre_integrated, opaque, depth, state))
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
        self.job.run(self.piece, self.state, new, self.work).map(|compositor| self.finish.end(compositor))
    }
}

/// Finishes a tile from a state that was composited before.
struct Resume<T> {
    state: TileState,
    finish: T,
}

impl<T: Finish> WithCompositor for Resume<T> {
    type Output = T::Output;

    fn call<C: Compositor>(self, new: impl FnOnce(Option<TileState>) -> C) -> Self::Output {
        self.finish.end(new(Some(self.state)))
    }
}

/// Final step of a compositor: it becomes a state, or writes texels.
trait Finish {
    type Output;
    fn end<C: Compositor>(self, compositor: C) -> Self::Output;
}

struct IntoState;

impl Finish for IntoState {
    type Output = TileState;

    fn end<C: Compositor>(self, compositor: C) -> TileState {
        compositor.into_state()
    }
}

struct WriteTexels<'a, 'b> {
    texels: &'a mut TileTexels<'b>,
    /// Ratio of positions along rays to positions along w: 1 or -1.
    sign: f32,
}

impl Finish for WriteTexels<'_, '_> {
    type Output = ();

    fn end<C: Compositor>(self, compositor: C) {
        for strip in 0..N_STRIPS {
            for row in 0..TILE_V {
                let chunk = compositor.finish(Chunk { strip, row });
                let w_half = chunk.s_half.map(|s| s.map(|s| s * self.sign));
                self.texels.put(strip * LANES, row, &chunk.rgba, w_half.as_ref());
            }
        }
    }
}
