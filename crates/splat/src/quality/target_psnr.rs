//! Pictures of a target PSNR: pilot tiles show how the error depends on the sampling; one is chosen, and drawn once.
//!
//! The tiles (`probe.rs`) are drawn with a sampling that mostly suffices. Where the resulting error model
//! (`error_model.rs`) chooses one far from it, they are drawn there once more.
//!
//! The measured errors are returned ([`Measured`]): with them, the next picture of the same volume and transfer
//! function is drawn without pilot tiles.
//!
//! PSNR compares the colours over black with the converged picture with many rays a pixel, peak 1; projections, which
//! end abruptly where the volume does, are compared with one ray a pixel.

use std::ops::ControlFlow;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Error, Picture, RenderOptions, Result};

use crate::picture::base_picture::BasePicture;
use crate::quality::error_model::{ErrorModel, mean_square_of};
use crate::quality::probe::{self, Overview};
use crate::quality::sampled::SampledFrame;
use crate::render::frame::{finish, slices_of};
use crate::render::layer::Layer;
use crate::render::plan::Plan;
use crate::render::progress::{ProgressCallback, ProgressPart};
use crate::render::report::Report;
use crate::source::slices::Slices;

pub use crate::quality::error_model::{Errors, Measured, Sampling};
pub use crate::quality::framing::Framing;

/// Target of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsnrTarget {
    /// PSNR to reach, between 20 and 80 dB.
    pub psnr_db: f64,
    /// Measured errors of a picture of the same volume and transfer function, to use instead of pilot tiles.
    pub like: Option<Measured>,
}

/// Sampling with which a picture was drawn, and the PSNR that it reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Sampling of the picture.
    pub sampling: Sampling,
    /// Expected PSNR, dB: less than what was asked for where the finest sampling does not reach it.
    pub psnr_db: f64,
    /// Standard deviation of the PSNR, dB.
    pub spread_db: f64,
    /// Measured errors of the picture, or those passed as `like`; `None` where nothing is seen.
    pub measured: Option<Measured>,
}

/// Maximum number of times that pilot tiles are drawn.
const MAX_PILOTS: usize = 3;

/// Share of the progress that the overview and the pilot tiles take.
const PILOT_PROGRESS: f32 = 0.3;

/// Function that draws the base planes of a plan, as [`draw_base_planes`] does.
///
/// [`draw_base_planes`]: crate::render::frame::draw_base_planes
pub type DrawBasePlanes<'a> =
    dyn Fn(&Plan, &[&Slices], &dyn ProgressCallback) -> Result<(Vec<BasePicture>, Report)> + Sync + 'a;

/// Draws layers with the cheapest sampling known to reach a PSNR. The options' own sampling is not used. `draw`: draws
/// the base planes once the sampling is known.
pub fn render_to_psnr(
    layers: &[Layer],
    camera: &Camera,
    options: &RenderOptions,
    wanted: &PsnrTarget,
    draw: &DrawBasePlanes,
    callback: &dyn ProgressCallback,
) -> Result<(Picture, Report, Estimate)> {
    let PsnrTarget { psnr_db, like } = *wanted;
    if !(20.0..=80.0).contains(&psnr_db) {
        let mend = "pass 40 for a good picture, 50 for one that cannot be told from the converged one";
        return Err(Error::out_of_range("psnr", psnr_db, "between 20 and 80 dB", mend));
    }
    let wanted = mean_square_of(psnr_db);
    parallel::with_threads(options.n_threads, || {
        let prior = ErrorModel::prior(layers, camera, options);
        let like = like.and_then(|like| Some((prior.like(&like)?, like)));
        let (model, like, from) = if let Some((model, like)) = like {
            (Some(model), Some(like), 0.0)
        } else {
            (pilot(&prior, layers, camera, options, wanted, callback)?, None, PILOT_PROGRESS)
        };
        let known = model.unwrap_or(prior);
        let is_measured = model.is_some() && like.is_none();
        let sampling = if is_measured { known.cheapest_measured(wanted) } else { known.cheapest(wanted) };
        let measured = like.or(model.map(|model| model.measured()));
        let with_sampling = options_with(options, sampling);
        let drawing = ProgressPart { of: callback, from, to: 1.0 };
        let plan = Plan::new(Level::best(), layers, camera, &with_sampling)?;
        let (base_pictures, report) = draw(&plan, &slices_of(layers), &drawing)?;
        let picture = finish(&plan, &base_pictures);
        let is_empty = model.is_none() && base_pictures.iter().all(BasePicture::is_empty);
        let error = if is_empty { 0.0 } else { known.error(&sampling) };
        let spread_db = if is_empty { 0.0 } else { known.spread_db(&sampling) };
        let estimate = Estimate { sampling, psnr_db: psnr_of(error), spread_db, measured };
        match callback.progress(1.0) {
            ControlFlow::Continue(()) => Ok((picture, report, estimate)),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    })
}

/// Measures the error model of a picture with pilot tiles; `None` where nothing is seen.
fn pilot(
    prior: &ErrorModel,
    layers: &[Layer],
    camera: &Camera,
    options: &RenderOptions,
    wanted: f64,
    callback: &dyn ProgressCallback,
) -> Result<Option<ErrorModel>> {
    let first = prior.to_measure(&prior.cheapest(wanted));
    let options = options_with(options, first);
    let plan = Plan::new(Level::best(), layers, camera, &options)?;
    let frame = SampledFrame { layers, options, plan };
    let to = |part: usize| PILOT_PROGRESS * part as f32 / (MAX_PILOTS + 1) as f32;
    let Some(overview) = Overview::draw(&frame, &ProgressPart { of: callback, from: 0.0, to: to(1) })? else {
        return Ok(None);
    };
    let mut model = None;
    let mut at = first;
    for part in 1..=MAX_PILOTS {
        let progress = ProgressPart { of: callback, from: to(part), to: to(part + 1) };
        let Some(errors) = probe::errors(&frame, &overview, at, &progress)? else { break };
        let measured = prior.with(errors, at);
        model = Some(measured);
        let chosen = measured.cheapest(wanted);
        let next = prior.to_measure(&chosen);
        if measured.covers(&chosen) || next == at {
            break;
        }
        at = next;
    }
    Ok(model)
}

fn options_with(options: &RenderOptions, sampling: Sampling) -> RenderOptions {
    let Sampling { sheets_per_slice, oversampling } = sampling;
    RenderOptions { sheets_per_slice, oversampling, ..options.clone() }
}

fn psnr_of(mean_square: f64) -> f64 {
    -10.0 * mean_square.max(1e-12).log10()
}
