//! A picture of a wanted PSNR.
//!
//! A picture is drawn with what does for most and tells its own error (`probe.rs`). Where that is too large, the parts
//! that have most of it, those of much contrast, are drawn once more: as many, and as finely, as experience promises
//! enough for the least work. What changes in them tells how large the error was, and so what is left.
//!
//! What a picture has told is handed on ([`Measured`]): the next one of the same is drawn once, with the cheapest settings
//! that this promises enough of, and measures nothing.
//!
//! PSNR is that of the colours over black against the converged picture with many rays a pixel, peak 1.

use std::ops::ControlFlow;
use std::sync::Arc;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Error, Picture, RenderOptions, Result};

use crate::quality::error_model::{ErrorModel, mean_square_of};
use crate::quality::parts::{Parts, replace};
use crate::quality::probe;
use crate::quality::refine::Refinement;
use crate::render::frame::{draw, drawn, finished, warped};
use crate::render::layer::Layer;
use crate::render::progress::ProgressCallback;
use crate::render::report::Report;
use crate::render::scene::{Scene, with_scene};

pub use crate::quality::error_model::{Measured, Settings};
pub use crate::quality::probe::Errors;
pub use crate::render::scene::Framing;

/// What is wanted of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Between 20 and 80 dB.
    pub psnr_db: f64,
    /// What a picture of the same volume and transfer function told of its error, if that is to do.
    pub like: Option<Measured>,
}

/// How a picture was drawn and what it reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The whole picture first, then parts of it.
    pub passes: Vec<Pass>,
    /// Expected PSNR, dB: less than what was asked for where the finest settings do not reach it.
    pub psnr_db: f64,
    /// What the picture told of its error, or the one like which it was drawn; `None` where nothing is seen.
    pub measured: Option<Measured>,
}

/// What was drawn at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
    /// The share of what is seen that was drawn, `0..=1`.
    pub share: f64,
}

/// Passes at most.
const MOST_PASSES: usize = 4;

/// What is chosen by an error that was measured is to be better than it must be by this much (1 dB), so that it need
/// not be drawn again.
const SPARE: f64 = 0.79;

/// Draws a volume with the cheapest settings known to reach a PSNR. The options' own settings are not used.
pub fn render_to_psnr(
    layer: &Layer,
    camera: &Camera,
    options: &RenderOptions,
    wanted: &Wanted,
    monitor: &dyn ProgressCallback,
) -> Result<(Picture, Report, Estimate)> {
    let Wanted { psnr_db, like } = *wanted;
    if !(20.0..=80.0).contains(&psnr_db) {
        let mend = "pass 40 for a good picture, 50 for one that cannot be told from the converged one";
        return Err(Error::out_of_range("psnr", psnr_db, "between 20 and 80 dB", mend));
    }
    let wanted = mean_square_of(psnr_db);
    let options_with = |settings: &Settings| {
        let Settings { sheets_per_slice, oversampling } = *settings;
        RenderOptions { sheets_per_slice, oversampling, ..options.clone() }
    };
    let with_scene_of = |settings: &Settings, draw: &dyn Fn(&Scene) -> Result<(Picture, Report)>| {
        with_scene(Level::best(), layer, camera, &options_with(settings), draw)
    };
    let ended = |picture: Picture, report: Report, estimate: Estimate| match monitor.progress(1.0) {
        ControlFlow::Continue(()) => Ok((finished(camera, options, picture), report, estimate)),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    };
    parallel::with_threads(options.n_threads, || {
        let usual = ErrorModel::usual(layer.slices, layer.transfer_function, camera, options);
        if let Some((like, experience)) = like.and_then(|like| Some((like, usual.like(&like)?))) {
            let settings = experience.cheapest(wanted);
            let (picture, report) = with_scene_of(&settings, &|scene| drawn(scene, None, monitor))?;
            let psnr_db = psnr_of(experience.error(&settings));
            let estimate = Estimate { passes: vec![Pass::new(settings, 1.0)], psnr_db, measured: Some(like) };
            return ended(picture, report, estimate);
        }
        let first = usual.first(wanted, options);
        let drawing = Share { of: monitor, from: 0.0, to: 0.4 };
        let probing = Share { of: monitor, from: 0.4, to: 0.5 };
        let draw_first = |scene: &Scene| {
            let (base_pictures, report) = draw(scene, None, &drawing)?;
            let picture = warped(scene, &base_pictures, options.with_depth);
            let errors = probe::errors(scene, &base_pictures, &picture, &probing)?;
            Ok((picture, report, errors))
        };
        let (mut picture, mut report, errors) =
            with_scene(Level::best(), layer, camera, &options_with(&first), draw_first)?;
        let Some(errors) = errors else {
            // With the least of settings nothing would be seen, either.
            let passes = vec![Pass::new(ErrorModel::least(), 1.0)];
            return ended(picture, report, Estimate { passes, psnr_db: psnr_of(0.0), measured: None });
        };
        let experience = usual.after(errors, first);
        let error = experience.error(&first);
        let measured = Some(experience.measured(1.0));
        let mut estimate = Estimate { passes: vec![Pass::new(first, 1.0)], psnr_db: psnr_of(error), measured };
        if error <= wanted {
            return ended(picture, report, estimate);
        }
        let mut refinement = Refinement::new(experience, first, &picture);
        while refinement.error() > wanted && estimate.passes.len() < MOST_PASSES {
            let Some(next) = refinement.cheapest(wanted, SPARE) else { break };
            let from = 1.0 - 0.5_f32.powi(estimate.passes.len() as i32);
            let drawing = Share { of: monitor, from, to: 0.5 * (1.0 + from) };
            let parts = Arc::new(Parts::new([options.width_px, options.height_px], next.is_wanted.clone()));
            let (finer, work) = with_scene_of(&next.settings, &|scene| drawn(scene, Some(&parts), &drawing))?;
            let changes = replace(&mut picture, &finer, &parts);
            report = report.and(work);
            estimate.passes.push(Pass::new(next.settings, refinement.share(&next)));
            refinement.drawn(&next, &changes);
            estimate.psnr_db = psnr_of(refinement.error());
        }
        estimate.measured = Some(experience.measured(refinement.truer()));
        ended(picture, report, estimate)
    })
}

fn psnr_of(mean_square: f64) -> f64 {
    -10.0 * mean_square.max(1e-12).log10()
}

impl Estimate {
    /// The most sheets per slice distance that anything was drawn with, and the most texels per pixel.
    pub fn finest(&self) -> [f64; 2] {
        let most = |of: fn(&Pass) -> f64| self.passes.iter().map(of).fold(0.0, f64::max);
        [most(|pass| pass.sheets_per_slice), most(|pass| pass.oversampling)]
    }
}

impl Pass {
    fn new(settings: Settings, share: f64) -> Self {
        let Settings { sheets_per_slice, oversampling } = settings;
        Self { sheets_per_slice, oversampling, share }
    }
}

/// A part of the work that a monitor is told of.
struct Share<'a> {
    of: &'a dyn ProgressCallback,
    from: f32,
    to: f32,
}

impl ProgressCallback for Share<'_> {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.of.progress(self.from + (self.to - self.from) * fraction)
    }
}
