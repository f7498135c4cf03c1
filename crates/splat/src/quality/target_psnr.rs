//! Pictures of a target PSNR: pilot tiles show the errors of some rungs of a ladder; the cheapest that does is drawn.
//!
//! The tiles (`pilot.rs`) are drawn with a rung (`ladder.rs`) and with a finer one, and compared. The
//! measured error decides which rung to try next, until one reaches the target and the one below does not.
//!
//! The measured errors are returned ([`Measured`]). The next picture of the same volume and transfer function uses
//! them: for the same framing as they are, for others with a spread that grows with the turn and the zoom
//! (`framing.rs`), and without pilot tiles.
//!
//! PSNR compares the colours over black with the converged picture with many rays a pixel, peak 1; projections, which
//! end abruptly where the volume does, are compared with one ray a pixel.

use std::ops::ControlFlow;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, Error, Picture, RenderOptions, Result};

use crate::optics::slab_variation::needs_preintegration;
use crate::picture::base_picture::BasePicture;
use crate::quality::ladder::{Expected, FINER, Known, N_RUNGS};
use crate::quality::pilot::{MeanSquare, PilotTiles, TileColors};
use crate::quality::sampled::SampledFrame;
use crate::render::frame::{finish, slices_of};
use crate::render::layer::Layer;
use crate::render::plan::Plan;
use crate::render::progress::{ProgressCallback, ProgressPart};
use crate::render::report::Report;
use crate::source::slices::Slices;
use crate::view::base_plane::MAX_TEXELS;

pub use crate::quality::framing::Framing;
pub use crate::quality::ladder::{Ladder, Measured, RungError, Sampling};

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

/// Largest spread with which errors of another picture are used, dB.
const MAX_SPREAD_DB: f64 = 5.0;

/// Share of the progress that the overview and the pilot tiles take, and that each drawing of the tiles takes.
const PILOT_PROGRESS: f32 = 0.4;
const DRAWING_PROGRESS: f32 = 0.04;

/// Function that draws the base planes of a plan, as [`draw_base_planes`] does.
///
/// [`draw_base_planes`]: crate::render::frame::draw_base_planes
pub type DrawBasePlanes<'a> =
    dyn Fn(&Plan, &[&Slices], &dyn ProgressCallback) -> Result<(Vec<BasePicture>, Report)> + Sync + 'a;

/// Draws layers with the cheapest rung of a ladder known to reach a PSNR. The options' own sampling is not used.
/// `draw`: draws the base planes once the sampling is known.
pub fn render_to_psnr(
    layers: &[Layer],
    camera: &Camera,
    options: &RenderOptions,
    (ladder, wanted): (&Ladder, &PsnrTarget),
    draw: &DrawBasePlanes,
    callback: &dyn ProgressCallback,
) -> Result<(Picture, Report, Estimate)> {
    let PsnrTarget { psnr_db: wanted_db, like } = *wanted;
    if !(20.0..=80.0).contains(&wanted_db) {
        let mend = "pass 40 for a good picture, 50 for one that cannot be distinguished from the converged one";
        return Err(Error::out_of_range("psnr", wanted_db, "between 20 and 80 dB", mend));
    }
    parallel::with_threads(options.n_threads, || {
        let is_smooth = is_smooth(layers, options);
        let framing = Framing::new(layers[0].slices.grid(), camera, options);
        let n_fitting = n_fitting(ladder, options);
        let of = |measured: &Measured| Known::new(measured, &framing, n_fitting).chosen_with_expectation(wanted_db);
        let like = like.filter(|like| like.serves(&framing, is_smooth));
        let is_same = like.is_some_and(|like| like.framing.is_same(&framing));
        let does = like.is_some_and(|like| is_same || of(&like).1.spread_db <= MAX_SPREAD_DB);
        let mut measured = like.filter(|_| does).unwrap_or(Measured::nothing(framing, is_smooth));
        let mut pilot = Pilot { layers, camera, options, ladder, n_fitting, callback, frame: None, reached: 0.0 };
        let is_seen = (does && !is_same) || pilot.measure(&mut measured, wanted_db)?;
        let (rung, expected) = of(&measured);
        let plan = pilot.plan(&with_sampling(options, ladder[rung]))?;
        let drawing = ProgressPart { of: callback, from: pilot.reached, to: 1.0 };
        let (base_pictures, report) = draw(&plan, &slices_of(layers), &drawing)?;
        let picture = finish(&plan, &base_pictures);
        let is_empty = !is_seen && base_pictures.iter().all(BasePicture::is_empty);
        let Expected { psnr_db, spread_db } =
            if is_empty { Expected { psnr_db: EMPTY_DB, spread_db: 0.0 } } else { expected };
        let is_any = measured.errors.iter().any(Option::is_some);
        let estimate = Estimate { sampling: ladder[rung], psnr_db, spread_db, measured: is_any.then_some(measured) };
        match callback.progress(1.0) {
            ControlFlow::Continue(()) => Ok((picture, report, estimate)),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    })
}

/// Expected PSNR of a picture that shows nothing.
const EMPTY_DB: f64 = 120.0;

/// Number of samplings of a ladder whose base planes are not too large: those that lie aslant to the picture have more
/// texels than it has pixels.
fn n_fitting(ladder: &Ladder, options: &RenderOptions) -> usize {
    let n_texels = |oversampling: f64| 3.0 * (options.width_px * options.height_px) as f64 * oversampling.powi(2);
    ladder.iter().take_while(|rung| n_texels(rung.oversampling) <= MAX_TEXELS).count().max(1)
}

fn with_sampling(options: &RenderOptions, sampling: Sampling) -> RenderOptions {
    let Sampling { sheets_per_slice, oversampling } = sampling;
    RenderOptions { sheets_per_slice, oversampling, ..options.clone() }
}

/// Whether colours along the rays change smoothly from sheet to sheet.
fn is_smooth(layers: &[Layer], options: &RenderOptions) -> bool {
    let has_steps = |layer: &Layer| {
        let tf = layer.transfer_function;
        tf.has_gradient() || needs_preintegration(layer.slices.grid(), tf)
    };
    options.composite == Composite::Over && !layers.iter().any(has_steps)
}

/// Measurement of the rungs' errors in a picture.
struct Pilot<'a> {
    layers: &'a [Layer<'a>],
    camera: &'a Camera,
    options: &'a RenderOptions,
    ladder: &'a Ladder,
    n_fitting: usize,
    callback: &'a dyn ProgressCallback,
    /// The picture with the first rung, once anything is measured.
    frame: Option<SampledFrame<'a>>,
    /// Progress that was reached.
    reached: f32,
}

impl Pilot<'_> {
    /// Measures the errors of rungs until enough is known to choose one. Returns whether anything is seen.
    fn measure(&mut self, measured: &mut Measured, wanted_db: f64) -> Result<bool> {
        let (framing, n_fitting) = (measured.framing, self.n_fitting);
        let next = |measured: &Measured| Known::new(measured, &framing, n_fitting).to_measure(wanted_db);
        if next(measured).is_none() {
            return Ok(true);
        }
        let options = RenderOptions { with_depth: false, ..self.options.clone() };
        let frame = SampledFrame::new(self.layers, self.camera, &options, self.ladder[0])?;
        let frame = self.frame.insert(frame);
        self.reached = DRAWING_PROGRESS;
        let overview = ProgressPart { of: self.callback, from: 0.0, to: self.reached };
        let Some((tiles, of_first)) = PilotTiles::choose(frame, &overview)? else { return Ok(false) };
        let mut drawn: [Option<TileColors>; N_RUNGS + 1] = [const { None }; N_RUNGS + 1];
        drawn[0] = Some(of_first);
        while let Some(rung) = next(measured) {
            let finer = FINER[rung];
            for rung in [rung, finer] {
                if drawn[rung].is_none() {
                    let from = self.reached;
                    self.reached = (from + DRAWING_PROGRESS).min(PILOT_PROGRESS);
                    let progress = ProgressPart { of: self.callback, from, to: self.reached };
                    let of_rung = frame.with_options(with_sampling(&options, self.ladder[rung]))?;
                    drawn[rung] = Some(tiles.draw(&of_rung, &progress)?);
                }
            }
            let [Some(own), Some(finer)] = [&drawn[rung], &drawn[finer]] else { unreachable!("both were drawn") };
            let MeanSquare { mean, deviation } = tiles.difference(own, finer);
            let is_projection = options.composite.is_projection();
            let error = RungError::of_comparison(mean, deviation, measured.is_smooth, is_projection);
            measured.errors[rung] = Some(error);
        }
        Ok(true)
    }

    /// Plans the picture; light and labels are kept from the measurement.
    fn plan(&self, options: &RenderOptions) -> Result<Plan> {
        match &self.frame {
            Some(frame) => frame.plan.resampled(self.layers, options),
            None => Plan::new(Level::best(), self.layers, self.camera, options),
        }
    }
}
