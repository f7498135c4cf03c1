//! Error model: what is known of the errors and costs of samplings.
//!
//! The error along the rays falls by a power of the sheets, that across them by a power of the texels, another one where
//! pixels are one read than where they are the mean of several. [`Errors`] are measured by `probe.rs`; before that, and
//! where nothing can be measured, there is the prior, of which no promise depends.

use wavesplat_core::{Camera, Composite, RenderOptions, TransferFunction};

use crate::optics::steepness::is_steep;
use crate::picture::supersampling::reads_per_axis;
use crate::quality::framing::Framing;
use crate::source::slices::Slices;
use crate::view::base_plane::MAX_TEXELS;

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
}

/// Samplings that are chosen from.
const SHEETS: [f64; 11] = [0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0];
const OVERSAMPLINGS: [f64; 13] = [0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0];

/// Samplings that are measured: half as many texels are one read a pixel with the least; twice as many can be drawn.
const MEASURED_OVERSAMPLING: [f64; 2] = [1.2, 4.0];
const MEASURED_SHEETS: [f64; 2] = [1.4, 8.0];

/// Where no sampling reaches what is wanted, the cheapest is taken with nearly the least error.
const NEARLY: f64 = 1.1;

/// Mean square errors of a picture with one sampling, and the factors by which they fall with twice the sheets or texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Along the rays; of pixels that are one read, and the mean of several.
    pub along: [f64; 2],
    /// How they fall.
    pub along_decay: f64,
    /// Across the rays; of pixels that are one read, and the mean of several.
    pub across: [f64; 2],
    /// How these fall.
    pub across_decay: [f64; 2],
    /// Relative standard deviation of all these.
    pub deviation: f64,
}

/// Decays are not believed to be less or more than these, since few tiles tell them: errors of a smooth function fall
/// with the fourth power of the distance in theory, those of edges at least with the first, hardly at all in noise.
const DECAYS: [f64; 2] = [0.06, 0.7];

impl Errors {
    /// `along`: with half the sheets and as many as are measured; each of pixels that are one read, and the mean of
    /// several. `single`: across the rays, of one read, with a half, two thirds, and all of the texels; `mean`: of several
    /// reads, with a half and all.
    pub(crate) fn measured(along: [[f64; 2]; 2], single: [f64; 3], mean: [f64; 2], deviation: f64) -> Self {
        let decay = |[before, after]: [f64; 2]| {
            if before > 0.0 { (after / before).clamp(DECAYS[0], DECAYS[1]) } else { DECAYS[1] }
        };
        let along_decay = decay(along.map(|[single, mean]| single + mean));
        let single_decay = decay([single[0], single[1]]).powf(1.0 / (4.0_f64 / 3.0).log2()).clamp(DECAYS[0], DECAYS[1]);
        let mean_decay = decay(mean);
        Self {
            along: along[1],
            along_decay,
            across: [single[1] * single_decay.powf(1.5_f64.log2()), mean[1]],
            across_decay: [single_decay, mean_decay],
            deviation,
        }
    }
}

/// What a picture told of its error, for those of the same that are drawn next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Errors with some sampling.
    pub errors: Errors,
    /// This sampling.
    pub at: Sampling,
    /// How it framed the volume.
    pub framing: Framing,
    /// Whether colours along a ray changed smoothly.
    pub is_smooth: bool,
}

/// What is known of errors and costs.
#[derive(Clone, Copy, Debug)]
pub struct ErrorModel {
    errors: Errors,
    at: Sampling,
    /// What is uncertain beside the errors that were measured, dB.
    other_spread_db: f64,
    is_smooth: bool,
    composite: Composite,
    framing: Framing,
    /// More would make base planes too large.
    most_oversampling: f64,
}

/// Standard deviations, dB: of the prior, of a model of another picture, of one that was measured, and per octave beyond
/// what was measured.
const PRIOR_SPREAD_DB: f64 = 5.0;
const LIKE_SPREAD_DB: f64 = 2.0;
const MODEL_SPREAD_DB: f64 = 0.5;
const SPREAD_PER_OCTAVE_DB: f64 = 1.5;

/// A sampling is chosen so that the picture is better than it must be by so many standard deviations.
const DEVIATIONS: f64 = 1.0;

/// Power of the distance of pixels by which the texels grow that leave as much error.
const OF_DISTANCE: f64 = 0.25;

/// Errors of another picture are believed if its pixels are farther apart or closer by this factor at most.
const MOST_FARTHER: f64 = 1.5;

impl ErrorModel {
    /// Of pictures like those of `make bench BENCH="--only psnr"`: a casting, a CT, an MRI.
    pub fn prior(slices: &Slices, tf: &TransferFunction, camera: &Camera, options: &RenderOptions) -> Self {
        let composite = options.composite;
        let is_smooth = composite == Composite::Over && !tf.has_gradient() && !is_steep(slices.grid(), tf);
        let [along_db, across_db] = if is_smooth { [50.5, 47.35] } else { [48.0, 39.0] };
        let (along_decay, across_decay) = if is_smooth { (0.12, [0.25, 0.13]) } else { (0.16, [0.33, 0.22]) };
        let [along, across] = [along_db, across_db].map(mean_square_of);
        let errors =
            Errors { along: [along; 2], along_decay, across: [across, 0.6 * across], across_decay, deviation: 0.0 };
        // The closer pixels are to each other, the less is left out between them.
        let framing = Framing::new(slices.grid(), camera, options);
        let oversampling = 0.7 * (framing.pixel_in_samples / 0.62).powf(OF_DISTANCE);
        let at = Sampling { sheets_per_slice: 2.0, oversampling };
        // Base planes that lie aslant to the picture have more texels than it has pixels.
        let most_oversampling = (MAX_TEXELS / (3.0 * options.width_px as f64 * options.height_px as f64)).sqrt();
        Self { errors, at, other_spread_db: PRIOR_SPREAD_DB, is_smooth, composite, framing, most_oversampling }
    }

    /// With errors that were measured on this picture.
    pub fn with(&self, errors: Errors, at: Sampling) -> Self {
        Self { errors, at, other_spread_db: MODEL_SPREAD_DB, ..*self }
    }

    /// What was measured, for the next pictures.
    pub fn measured(&self) -> Measured {
        Measured { errors: self.errors, at: self.at, framing: self.framing, is_smooth: self.is_smooth }
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
        let at = Sampling {
            sheets_per_slice: other.at.sheets_per_slice * (own.slice_in_samples / others.slice_in_samples),
            oversampling: other.at.oversampling * farther.powf(OF_DISTANCE),
        };
        let more = own.covered / others.covered;
        let Errors { along, across, .. } = other.errors;
        let errors = Errors { along: along.map(|e| more * e), across: across.map(|e| more * e), ..other.errors };
        let model = Self { errors, at, other_spread_db: LIKE_SPREAD_DB, ..*self };
        // Numbers that come from elsewhere may be any.
        let is_sound = model.error(&at).is_finite() && model.spread_db(&at).is_finite();
        is_sound.then_some(model)
    }

    /// The sampling to measure at, for a picture with some sampling.
    pub fn to_measure(&self, chosen: &Sampling) -> Sampling {
        let [least, most] = MEASURED_SHEETS;
        let sheets_per_slice = chosen.sheets_per_slice.clamp(least, most);
        let [least, most] = MEASURED_OVERSAMPLING;
        let oversampling = chosen.oversampling.clamp(least, most).min(self.most_oversampling.max(least));
        // Half of the sheets are to lie as evenly.
        let sheets_per_slice = if self.is_smooth { sheets_per_slice } else { 2.0 * (0.5 * sheets_per_slice).ceil() };
        Sampling { sheets_per_slice, oversampling }
    }

    /// The cheapest sampling that promises an error, or else nearly the least.
    pub fn cheapest(&self, error: f64) -> Sampling {
        // How good sheets between slices are where colours do not change smoothly depends on how they lie to the samples.
        let lies_evenly = |sampling: &Sampling| self.is_smooth || sampling.sheets_per_slice.fract() == 0.0;
        let all = || self.samplings().filter(lies_evenly);
        let likely_most =
            |sampling: &Sampling| self.error(sampling) * 10.0_f64.powf(0.1 * DEVIATIONS * self.spread_db(sampling));
        let best = all().map(|sampling| likely_most(&sampling)).fold(f64::INFINITY, f64::min);
        let enough = all().filter(|sampling| likely_most(sampling) <= error.max(NEARLY * best));
        enough.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b))).expect("there are samplings")
    }

    /// The mean square error with a sampling: along and across the rays.
    pub fn error(&self, new: &Sampling) -> f64 {
        let several = usize::from(reads_per_axis(self.composite, new.oversampling) > 1);
        let Errors { along, along_decay, across, across_decay, .. } = self.errors;
        let along = along[several] * along_decay.powf((new.sheets_per_slice / self.at.sheets_per_slice).log2());
        let finer = (new.oversampling / self.at.oversampling).log2();
        along + across[several] * across_decay[several].powf(finer)
    }

    /// The standard deviation of the error with a sampling, dB.
    pub fn spread_db(&self, new: &Sampling) -> f64 {
        let [sheets, texels] = self.octaves_beyond(new);
        let measured = 10.0 / std::f64::consts::LN_10 * self.errors.deviation;
        [measured, self.other_spread_db, SPREAD_PER_OCTAVE_DB * sheets, SPREAD_PER_OCTAVE_DB * texels]
            .iter()
            .map(|db| db * db)
            .sum::<f64>()
            .sqrt()
    }

    /// By how many octaves the sheets and the texels are beyond what was measured.
    pub fn octaves_beyond(&self, new: &Sampling) -> [f64; 2] {
        let beyond = |ratio: f64| (ratio.log2()).max(-1.0 - ratio.log2()).max(0.0);
        [beyond(new.sheets_per_slice / self.at.sheets_per_slice), beyond(new.oversampling / self.at.oversampling)]
    }

    /// How long a picture takes, in no unit. Much of a sheet's work is for samples, not for texels; of a hard surface
    /// much is done whatever the number of sheets.
    fn cost(&self, sampling: &Sampling) -> f64 {
        let texels_per_sample = sampling.oversampling / self.framing.pixel_in_samples;
        let (per_picture, per_sample) = if self.is_smooth { (0.0, 1.1) } else { (1.5, 2.2) };
        (per_picture + sampling.sheets_per_slice) * (per_sample + texels_per_sample.powi(2))
    }

    /// All samplings whose base planes are not too large.
    fn samplings(&self) -> impl Iterator<Item = Sampling> {
        let most_oversampling = self.most_oversampling.max(OVERSAMPLINGS[0]);
        let oversamplings = move || OVERSAMPLINGS.into_iter().filter(move |n| *n <= most_oversampling);
        let with = |sheets_per_slice| move |oversampling| Sampling { sheets_per_slice, oversampling };
        SHEETS.into_iter().flat_map(move |sheets_per_slice| oversamplings().map(with(sheets_per_slice)))
    }
}

/// Of a PSNR, peak 1.
pub fn mean_square_of(psnr_db: f64) -> f64 {
    10.0_f64.powf(-0.1 * psnr_db)
}
