//! A picture of a wanted PSNR.
//!
//! A picture is drawn with what does for most, tells its own error (`probe.rs`), and is drawn once more where that is
//! too large, with the cheapest settings of which experience promises enough from there.
//!
//! PSNR is that of the colours over black against the converged picture with many rays a pixel, peak 1.

use std::ops::ControlFlow;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, Error, Picture, RenderOptions, Result, TransferFunction};

use crate::base_plane::MAX_TEXELS;
use crate::labels::Labels;
use crate::probe::{self, Errors, OF_MEAN, along_of_mean};
use crate::render::{Monitor, Report, draw, finished, reads_per_axis, warped};
use crate::scene::{Scene, is_steep, pixel_in_samples, with_scene};
use crate::slices::Slices;

/// Settings and what they reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
    /// Expected PSNR, dB: less than what was asked for where the finest settings do not reach it.
    pub psnr_db: f64,
}

/// The least oversampling with which a pixel is the mean of several reads; and the factor by which twice of that makes
/// the error across the rays fall, since there are more of them.
const ONE_READ: f64 = 1.5;
const MORE_READS: f64 = 0.2;

/// Settings that are chosen from.
const SHEETS: [f64; 9] = [0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];
const OVERSAMPLINGS: [f64; 10] = [0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0, 4.0];

/// Fewer pixels are a small picture.
const SMALL_PX: usize = 128 * 128;

/// Pictures that are drawn at most.
const MOST_PICTURES: i32 = 4;

/// What is chosen by an error that was measured is to be better than it must be by this much, so that it need not be
/// drawn again.
const SPARE_DB: f64 = 0.5;

/// Draws a volume with the cheapest settings known to reach a PSNR, between 20 and 80 dB. The options' own settings are
/// not used.
pub fn render_to_psnr(
    slices: &Slices,
    labels: Option<&Labels>,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    psnr_db: f64,
    monitor: &dyn Monitor,
) -> Result<(Picture, Report, Estimate)> {
    if !(20.0..=80.0).contains(&psnr_db) {
        let mend = "pass 40 for a good picture, 50 for one that cannot be told from the converged one";
        return Err(Error::out_of_range("psnr", psnr_db, "between 20 and 80 dB", mend));
    }
    parallel::with_threads(options.n_threads, || {
        let mut experience = Experience::usual(slices, tf, camera, options);
        let mut settings = experience.cheapest(psnr_db, experience.least(options));
        let mut n_drawn = 0;
        loop {
            let Estimate { sheets_per_slice, oversampling, .. } = settings;
            let options = RenderOptions { sheets_per_slice, oversampling, ..options.clone() };
            // As if one more picture followed each, and no other.
            let left = 0.5_f32.powi(n_drawn);
            let drawing = Share { of: monitor, from: 1.0 - left, to: 1.0 - 0.6 * left };
            let probing = Share { of: monitor, from: 1.0 - 0.6 * left, to: 1.0 - 0.5 * left };
            let draw = |scene: &Scene| {
                let (base_pictures, report) = draw(scene, &drawing)?;
                let picture = warped(scene, &base_pictures, options.with_depth);
                let errors = probe::errors(scene, &base_pictures, &picture, &probing)?;
                Ok((picture, report, errors))
            };
            let (picture, report, errors) = with_scene(Level::best(), (slices, labels), tf, camera, &options, draw)?;
            n_drawn += 1;
            settings.psnr_db = psnr_of(errors.map_or(0.0, Errors::sum));
            let next = if n_drawn == MOST_PICTURES || settings.psnr_db >= psnr_db {
                settings
            } else {
                experience = experience.after(errors.unwrap_or_default(), settings);
                experience.cheapest(psnr_db, [sheets_per_slice, oversampling])
            };
            if next.has_settings_of(&settings) {
                if errors.is_none() {
                    // Nothing would be seen with the least of them, either.
                    [settings.sheets_per_slice, settings.oversampling] = [SHEETS[0], OVERSAMPLINGS[0]];
                }
                return match monitor.progress(1.0) {
                    ControlFlow::Continue(()) => Ok((finished(camera, &options, picture), report, settings)),
                    ControlFlow::Break(()) => Err(Error::Cancelled),
                };
            }
            settings = next;
        }
    })
}

fn psnr_of(mean_square: f64) -> f64 {
    -10.0 * mean_square.max(1e-12).log10()
}

impl Estimate {
    fn has_settings_of(&self, other: &Self) -> bool {
        self.sheets_per_slice == other.sheets_per_slice && self.oversampling == other.oversampling
    }
}

/// What is known of errors and costs.
#[derive(Clone, Copy, Debug)]
struct Experience {
    /// Errors with some settings.
    errors: Errors,
    at: Estimate,
    /// The factor by which twice the sheets make the error along the rays fall.
    along_decay: f64,
    is_smooth: bool,
    composite: Composite,
    /// Distance of pixels.
    pixel_in_samples: f64,
    /// More would make base planes too large.
    most_oversampling: f64,
}

impl Experience {
    /// Of pictures like those of `make bench BENCH="--only psnr"`: a casting, a CT, an MRI.
    fn usual(slices: &Slices, tf: &TransferFunction, camera: &Camera, options: &RenderOptions) -> Self {
        let composite = options.composite;
        let is_smooth = composite == Composite::Over && !tf.has_gradient() && !is_steep(slices.grid(), tf);
        let [along_db, across_db] = if is_smooth { [50.5, 47.35] } else { [48.0, 39.0] };
        let [along_decay, across_decay] = if is_smooth { [0.12, 0.25] } else { [0.2, 0.33] };
        let errors = Errors { along: mean_square_of(along_db), across: mean_square_of(across_db), across_decay };
        // The closer pixels are to each other, the less is left out between them.
        let pixel_in_samples = pixel_in_samples(slices.grid(), camera, options);
        let oversampling = 0.7 * (pixel_in_samples / 0.62).powf(0.25);
        let at = Estimate { sheets_per_slice: 2.0, oversampling, psnr_db: psnr_of(errors.sum()) };
        // Base planes that lie aslant to the picture have more texels than it has pixels.
        let most_oversampling = (MAX_TEXELS / (3.0 * options.width_px as f64 * options.height_px as f64)).sqrt();
        Self { errors, at, along_decay, is_smooth, composite, pixel_in_samples, most_oversampling }
    }

    /// The least that a first picture is drawn with. Small pictures cost little, and few texels tell little of their
    /// error; nor do few sheets where colours along a ray do not change smoothly.
    fn least(&self, options: &RenderOptions) -> [f64; 2] {
        let is_small = options.width_px * options.height_px < SMALL_PX;
        [if self.is_smooth { SHEETS[0] } else { 1.0 }, if is_small { 1.0 } else { OVERSAMPLINGS[0] }]
    }

    /// With the errors of a picture that was drawn.
    fn after(&self, errors: Errors, at: Estimate) -> Self {
        Self { errors, at, along_decay: if self.is_smooth { 0.16 } else { 0.2 }, ..*self }
    }

    /// The error with other settings: falls evenly with the logarithm of the effort.
    fn error(&self, new: &Estimate) -> f64 {
        let along = |estimate: &Estimate| {
            let with_one_read = self.along_decay.powf(estimate.sheets_per_slice.log2());
            with_one_read * along_of_mean(reads_per_axis(self.composite, estimate.oversampling), self.is_smooth)
        };
        let across = |estimate: &Estimate| {
            let oversampling = estimate.oversampling;
            let with_one_read = |oversampling: f64| self.errors.across_decay.powf(oversampling.log2());
            let is_mean = reads_per_axis(self.composite, oversampling) > 1;
            let more_reads = || OF_MEAN * MORE_READS.powf((oversampling / ONE_READ).log2());
            if is_mean { with_one_read(ONE_READ) * more_reads() } else { with_one_read(oversampling) }
        };
        self.errors.along * along(new) / along(&self.at) + self.errors.across * across(new) / across(&self.at)
    }

    /// How long a picture takes, in no unit. Much of a sheet's work is for samples, not for texels; of a hard surface
    /// much is done whatever the number of sheets.
    fn cost(&self, settings: &Estimate) -> f64 {
        let texels_per_sample = settings.oversampling / self.pixel_in_samples;
        let (per_picture, per_sample) = if self.is_smooth { (0.0, 1.1) } else { (1.5, 2.2) };
        (per_picture + settings.sheets_per_slice) * (per_sample + texels_per_sample.powi(2))
    }

    /// The cheapest settings that promise a PSNR; those that promise nearly the most, if none does.
    fn cheapest(&self, psnr_db: f64, [least_sheets, least_oversampling]: [f64; 2]) -> Estimate {
        let most_oversampling = self.most_oversampling.max(least_oversampling).max(OVERSAMPLINGS[0]);
        let mut all = Vec::new();
        for sheets_per_slice in SHEETS.into_iter().filter(|n| *n >= least_sheets) {
            for oversampling in
                OVERSAMPLINGS.into_iter().filter(|n| (least_oversampling..=most_oversampling).contains(n))
            {
                let mut new = Estimate { sheets_per_slice, oversampling, psnr_db: 0.0 };
                new.psnr_db = psnr_of(self.error(&new));
                all.push(new);
            }
        }
        let best_db = all.iter().map(|estimate| estimate.psnr_db).fold(f64::NEG_INFINITY, f64::max);
        let wanted_db = (psnr_db + SPARE_DB).min(best_db - SPARE_DB);
        let enough = all.into_iter().filter(|estimate| estimate.psnr_db >= wanted_db);
        enough.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b))).expect("there are settings")
    }
}

fn mean_square_of(psnr_db: f64) -> f64 {
    10.0_f64.powf(-0.1 * psnr_db)
}

/// A part of the work that a monitor is told of.
struct Share<'a> {
    of: &'a dyn Monitor,
    from: f32,
    to: f32,
}

impl Monitor for Share<'_> {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.of.progress(self.from + (self.to - self.from) * fraction)
    }
}
