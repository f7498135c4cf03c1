//! What is known of errors and costs of settings.
//!
//! Errors fall evenly with the logarithm of the effort, along the rays with the sheets and across them with the texels.
//! By how much, and what pictures cost, is experience with soft and hard functions on a casting, a CT, an MRI and
//! ripples.

use wavesplat_core::{Camera, Composite, RenderOptions, TransferFunction};

use crate::picture::supersampling::reads_per_axis;
use crate::quality::probe::{Errors, left_by_mean};
use crate::render::scene::{Framing, is_steep};
use crate::source::slices::Slices;
use crate::view::base_plane::MAX_TEXELS;

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
}

/// Settings that are chosen from.
const SHEETS: [f64; 10] = [0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];
const OVERSAMPLINGS: [f64; 12] = [0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0];

/// Pictures differ from each other; a first one is to be better than it must be by this much (0.5 and 0.9 dB), so that it
/// need not be drawn again: where colours along a ray change smoothly, and where they do not.
const SPARE: [f64; 2] = [0.9, 0.81];

/// The same for pictures like one that was measured (0.5 and 1.5 dB): of another view.
const SPARE_LIKE: [f64; 2] = [0.9, 0.7];

/// A first picture promises nearly the least error that there is where that is not enough.
const NEARLY: f64 = 1.1;

/// Power of the distance of pixels by which the texels grow that leave as much error.
const OF_DISTANCE: f64 = 0.25;

/// Errors of another picture are believed if its pixels are farther apart or closer by this factor at most.
const MOST_FARTHER: f64 = 1.5;

/// How much of the errors of two pictures the difference between them shows.
const OF_BOTH: f64 = 0.85;

/// Where colours along a ray do not change smoothly, what is too much because of few sheets is often too little because
/// of few texels: by this share of the smaller error, with one read per pixel and with several, a picture is better than
/// by both.
const OF_SMALLER: [f64; 2] = [0.4, 0.3];

/// Fewer pixels are a small picture.
const SMALL_PX: usize = 128 * 128;

/// What a picture told of its error, for those of the same that are drawn next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Mean square errors with some settings.
    pub errors: Errors,
    /// These settings.
    pub at: Settings,
    /// How it framed the volume.
    pub framing: Framing,
    /// Whether colours along a ray changed smoothly.
    pub is_smooth: bool,
}

/// What is known of errors and costs.
#[derive(Clone, Copy, Debug)]
pub struct ErrorModel {
    /// Errors with some settings.
    errors: Errors,
    at: Settings,
    /// The factor by which twice the sheets make the error along the rays fall.
    along_decay: f64,
    is_smooth: bool,
    composite: Composite,
    framing: Framing,
    /// More would make base planes too large.
    most_oversampling: f64,
}

impl ErrorModel {
    /// Of pictures like those of `make bench BENCH="--only psnr"`: a casting, a CT, an MRI.
    pub fn usual(slices: &Slices, tf: &TransferFunction, camera: &Camera, options: &RenderOptions) -> Self {
        let composite = options.composite;
        let is_smooth = composite == Composite::Over && !tf.has_gradient() && !is_steep(slices.grid(), tf);
        let [along_db, across_db] = if is_smooth { [50.5, 47.35] } else { [48.0, 39.0] };
        let [along_decay, across_decay] = if is_smooth { [0.12, 0.25] } else { [0.16, 0.33] };
        let errors = Errors { along: mean_square_of(along_db), across: mean_square_of(across_db), across_decay };
        // The closer pixels are to each other, the less is left out between them.
        let framing = Framing::new(slices.grid(), camera, options);
        let oversampling = 0.7 * (framing.pixel_in_samples / 0.62).powf(OF_DISTANCE);
        let at = Settings { sheets_per_slice: 2.0, oversampling };
        // Base planes that lie aslant to the picture have more texels than it has pixels.
        let most_oversampling = (MAX_TEXELS / (3.0 * options.width_px as f64 * options.height_px as f64)).sqrt();
        Self { errors, at, along_decay, is_smooth, composite, framing, most_oversampling }
    }

    /// The settings of a first picture: of those that promise an error, the cheapest.
    pub fn first(&self, error: f64, options: &RenderOptions) -> Settings {
        self.cheapest_from(self.least_of_first(options), SPARE[usize::from(!self.is_smooth)] * error)
    }

    /// The settings of a picture like one that was measured.
    pub fn cheapest(&self, error: f64) -> Settings {
        self.cheapest_from(Self::least(), SPARE_LIKE[usize::from(!self.is_smooth)] * error)
    }

    /// The cheapest settings that promise an error, or else nearly the least.
    fn cheapest_from(&self, least: Settings, error: f64) -> Settings {
        // How good sheets between slices are where colours do not change smoothly depends on how they lie to the samples.
        let lies_evenly = |settings: &Settings| self.is_smooth || settings.sheets_per_slice.fract() == 0.0;
        let all = || self.settings_from(least).filter(lies_evenly);
        let best = all().map(|settings| self.error(&settings)).fold(f64::INFINITY, f64::min);
        let enough = all().filter(|settings| self.error(settings) <= error.max(NEARLY * best));
        enough.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b))).expect("there are settings")
    }

    /// The least of all settings.
    pub fn least() -> Settings {
        Settings { sheets_per_slice: SHEETS[0], oversampling: OVERSAMPLINGS[0] }
    }

    /// The least that a first picture is drawn with. Small pictures cost little, and few texels tell little of their
    /// error; nor do few sheets where colours along a ray do not change smoothly.
    fn least_of_first(&self, options: &RenderOptions) -> Settings {
        let is_small = options.width_px * options.height_px < SMALL_PX;
        Settings {
            sheets_per_slice: if self.is_smooth { SHEETS[0] } else { 1.0 },
            oversampling: if is_small { 1.0 } else { OVERSAMPLINGS[0] },
        }
    }

    /// With the errors of a picture that was drawn.
    #[must_use]
    pub fn after(&self, errors: Errors, at: Settings) -> Self {
        let [along_decay, most_decay] = if self.is_smooth { [0.13, 0.2] } else { [0.17, 0.32] };
        // What was measured is what coarser texels do, far from what they converge to.
        let most_decay = if self.composite.is_projection() { 1.0 } else { most_decay };
        let across_decay = errors.across_decay.min(most_decay);
        Self { errors: Errors { across_decay, ..errors }, at, along_decay, ..*self }
    }

    /// What was measured, for the next pictures. `truer`: the factor by which later changes tell that it is more.
    pub fn measured(&self, truer: f64) -> Measured {
        let Errors { along, across, across_decay } = self.errors;
        let errors = Errors { along: truer * along, across: truer * across, across_decay };
        Measured { errors, at: self.at, framing: self.framing, is_smooth: self.is_smooth }
    }

    /// With the errors of another picture of the same, be it from a little nearer or farther or from another side; `None`
    /// where they tell too little of this one.
    pub fn like(&self, other: &Measured) -> Option<Self> {
        let (own, others) = (&self.framing, &other.framing);
        let farther = own.pixel_in_samples / others.pixel_in_samples;
        if self.is_smooth != other.is_smooth || !(1.0 / MOST_FARTHER..=MOST_FARTHER).contains(&farther) {
            return None;
        }
        // Sheets and texels that leave as much error in what is seen, and how much more is seen.
        let at = Settings {
            sheets_per_slice: other.at.sheets_per_slice * (own.slice_in_samples / others.slice_in_samples),
            oversampling: other.at.oversampling * farther.powf(OF_DISTANCE),
        };
        let more = own.covered / others.covered;
        let Errors { along, across, across_decay } = other.errors;
        let experience = self.after(Errors { along: more * along, across: more * across, across_decay }, at);
        // Numbers that come from elsewhere may be any.
        experience.error(&at).is_finite().then_some(experience)
    }

    /// The mean square error with some settings.
    pub fn error(&self, new: &Settings) -> f64 {
        let [along, across] = self.errors_with(new);
        let is_mean = reads_per_axis(self.composite, new.oversampling) > 1;
        let is_hard = self.composite == Composite::Over && !self.is_smooth;
        along + across - if is_hard { OF_SMALLER[usize::from(is_mean)] * along.min(across) } else { 0.0 }
    }

    /// The mean square change from some settings to finer ones, but for what both have in common: both have their own
    /// errors.
    pub fn change(&self, from: &Settings, to: &Settings) -> f64 {
        let [from_errors, to_errors] = [from, to].map(|settings| self.errors_with(settings));
        let along = if to.sheets_per_slice == from.sheets_per_slice { 0.0 } else { from_errors[0] + to_errors[0] };
        let across = if to.oversampling == from.oversampling { 0.0 } else { from_errors[1] + to_errors[1] };
        OF_BOTH * (along + across)
    }

    /// The mean square errors with some settings, along and across the rays: fall evenly with the logarithm of the
    /// effort.
    fn errors_with(&self, new: &Settings) -> [f64; 2] {
        let left = |settings: &Settings| left_by_mean(self.composite, settings.oversampling, self.is_smooth);
        let along = |settings: &Settings| self.along_decay.powf(settings.sheets_per_slice.log2()) * left(settings)[0];
        let across =
            |settings: &Settings| self.errors.across_decay.powf(settings.oversampling.log2()) * left(settings)[1];
        [self.errors.along * along(new) / along(&self.at), self.errors.across * across(new) / across(&self.at)]
    }

    /// How long a picture takes, in no unit. Much of a sheet's work is for samples, not for texels; of a hard surface
    /// much is done whatever the number of sheets.
    pub fn cost(&self, settings: &Settings) -> f64 {
        let texels_per_sample = settings.oversampling / self.framing.pixel_in_samples;
        let (per_picture, per_sample) = if self.is_smooth { (0.0, 1.1) } else { (1.5, 2.2) };
        (per_picture + settings.sheets_per_slice) * (per_sample + texels_per_sample.powi(2))
    }

    /// All settings that are at least as fine as some.
    pub fn settings_from(&self, least: Settings) -> impl Iterator<Item = Settings> {
        let most_oversampling = self.most_oversampling.max(least.oversampling).max(OVERSAMPLINGS[0]);
        SHEETS.into_iter().filter(move |n| *n >= least.sheets_per_slice).flat_map(move |sheets_per_slice| {
            let oversamplings = OVERSAMPLINGS.into_iter();
            let oversamplings = oversamplings.filter(move |n| (least.oversampling..=most_oversampling).contains(n));
            oversamplings.map(move |oversampling| Settings { sheets_per_slice, oversampling })
        })
    }
}

/// Of a PSNR, peak 1.
pub fn mean_square_of(psnr_db: f64) -> f64 {
    10.0_f64.powf(-0.1 * psnr_db)
}
