//! Error model: what is known of the errors and costs of samplings.
//!
//! [`Errors`] are those along the rays with two numbers of sheets and those across them with three numbers of texels, as
//! `probe.rs` measures them. Between these the logarithm of the error is linear in that of the number; beyond them it is
//! extrapolated, which tells where to measure next. Before anything is measured, and where nothing is seen, there is the
//! prior, on which no promise depends.

use wavesplat_core::{Camera, Composite, RenderOptions};

use crate::optics::steepness::needs_preintegration;
use crate::picture::supersampling::reads_per_axis;
use crate::quality::framing::Framing;
use crate::render::layer::Layer;
use crate::view::base_plane::MAX_TEXELS;

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
}

/// Samplings that are chosen from. A texel on every pixel is not among them: an edge of the volume that lies along the
/// texels is then as jagged as with many more texels that are read once.
const SHEETS: [f64; 11] = [0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0];
const OVERSAMPLINGS: [f64; 10] = [0.5, 0.6, 0.8, 1.2, 4.0 / 3.0, 1.5, 2.0, 8.0 / 3.0, 3.0, 4.0];

/// Those that are measured, with half of the sheets, and with two thirds and half of the texels. Where colours along a ray
/// do not change smoothly, how good sheets between slices are depends on how they lie to the samples, and whether slabs
/// are pre-integrated on how thick they are: only these sheets and half of them are chosen.
const MEASURED_SHEETS: [f64; 5] = [2.0, 4.0, 6.0, 8.0, 12.0];
const MEASURED_OVERSAMPLINGS: [f64; 4] = [1.2, 2.0, 3.0, 4.0];

/// Where no sampling reaches what is wanted, the cheapest is taken with nearly the least error.
const ACCEPT_RATIO: f64 = 1.1;

/// Mean square errors of a picture with a sampling and with coarser ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Along the rays, with half the sheets and with all; each of pixels that are one read, and that are the mean of as
    /// many as the texels ask for.
    pub along: [[f64; 2]; 2],
    /// Across the rays, with half the texels along each axis, two thirds, and all.
    pub across: [f64; 3],
    /// Relative standard deviation of all these.
    pub deviation: f64,
}

/// Beyond what was measured, errors fall with twice the sheets or texels to this share at least and at most.
const DECAYS: [f64; 2] = [0.06, 0.7];

impl Errors {
    /// By differences from what stands for the converged picture: three times the sheets, and twice the texels. That has
    /// errors of its own, be they of one kind with those that are measured or another. Across the rays errors are not
    /// believed to fall faster than those of straight edges under a regular grid of reads, with the cube of its number.
    pub(crate) fn measured(along: [[f64; 2]; 2], across: [f64; 3], deviation: f64) -> Self {
        let decay = |before: f64, after: f64| (after / before.max(f64::MIN_POSITIVE)).min(0.35);
        let [half, all] = along.map(|[single, mean]| single + mean);
        let along_left = decay(half, all).powf(0.5 * 3.0_f64.log2());
        let across_left = decay(across[0], across[2]);
        // Where an edge of the volume lies along the texels, the finer ones may be as wrong by chance.
        let at_least = |texels: f64| across[0] * texels.powi(-3);
        let across = [across[0], across[1].max(at_least(4.0 / 3.0)), across[2].max(at_least(2.0))];
        let [half, all] = along;
        Self {
            along: [half.map(|e| e / (1.0 - 0.5 * along_left)), all.map(|e| e / (1.0 - along_left))],
            across: [across[0], across[1] / (1.0 - 0.5 * across_left), across[2] / (1.0 - across_left)],
            deviation,
        }
    }
}

/// Linear in logarithms through points, the number against the error. Before them as by the first two; beyond them as by
/// the outermost, since the last two can be closer by chance.
fn interpolated(points: &[(f64, f64)], number: f64) -> f64 {
    let (first, last) = (points[0], points[points.len() - 1]);
    let is_before = |pair: &[(f64, f64)]| number <= pair[1].0;
    let [from, to] = points.windows(2).find(|pair| is_before(pair)).map_or([first, last], |pair| [pair[0], pair[1]]);
    let (before, after) = (from.1.max(MIN_ERROR), to.1.max(MIN_ERROR));
    let (from, to) = (from.0, to.0);
    let share = (number / from).ln() / (to / from).ln();
    let decay = (after / before).powf(1.0 / (to / from).log2()).clamp(DECAYS[0], DECAYS[1]);
    if share < 0.0 {
        before * decay.powf((number / from).log2())
    } else if share > 1.0 {
        after * decay.powf((number / to).log2())
    } else {
        before * (after / before).powf(share)
    }
}

/// No error is less.
const MIN_ERROR: f64 = 1e-14;

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

/// What is so little beyond what was measured, in octaves, need not be measured: 0.5 texels a pixel instead of 0.6.
const CLOSE_OCTAVES: f64 = 0.3;

/// Of smooth functions, so many times the sheets are measured that are chosen: more or fewer may do.
const SHEET_MARGIN: f64 = 1.4;

/// Power of the distance of pixels by which the texels grow that leave as much error.
const DISTANCE_EXPONENT: f64 = 0.25;

/// Errors of another picture are believed if its pixels are farther apart or closer by this factor at most.
const MAX_FARTHER: f64 = 1.5;

impl ErrorModel {
    /// Of pictures like those of `make bench BENCH="--only psnr"`: a casting, a CT, an MRI.
    pub fn prior(layers: &[Layer], camera: &Camera, options: &RenderOptions) -> Self {
        let composite = options.composite;
        let has_steps = |layer: &Layer| {
            let tf = layer.transfer_function;
            tf.has_gradient() || needs_preintegration(layer.slices.grid(), tf)
        };
        let is_smooth = composite == Composite::Over && !layers.iter().any(has_steps);
        let [along_db, across_db] = if is_smooth { [50.5, 47.35] } else { [48.0, 39.0] };
        let [along_decay, across_decay] = if is_smooth { [0.12, 0.2] } else { [0.16, 0.3] };
        let [along, across] = [along_db, across_db].map(mean_square_of);
        let across = [0.5_f64, 2.0 / 3.0, 1.0].map(|of| across * f64::powf(across_decay, of.log2()));
        let errors = Errors { along: [[along / along_decay; 2], [along; 2]], across, deviation: 0.0 };
        // The closer pixels are to each other, the less is left out between them.
        let framing = Framing::new(layers[0].slices.grid(), camera, options);
        let oversampling = 0.7 * (framing.pixel_in_samples / 0.62).powf(DISTANCE_EXPONENT);
        let at = Sampling { sheets_per_slice: 2.0, oversampling };
        // Base planes that lie aslant to the picture have more texels than it has pixels.
        let most_oversampling = (MAX_TEXELS / (3.0 * options.width_px as f64 * options.height_px as f64)).sqrt();
        Self { errors, at, other_spread_db: PRIOR_SPREAD_DB, is_smooth, composite, framing, most_oversampling }
    }

    /// With errors that were measured on this picture.
    #[must_use]
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
        if self.is_smooth != other.is_smooth || !(1.0 / MAX_FARTHER..=MAX_FARTHER).contains(&farther) {
            return None;
        }
        // Sheets and texels that leave as much error in what is seen, and how much more is seen.
        let at = Sampling {
            sheets_per_slice: other.at.sheets_per_slice * (own.slice_in_samples / others.slice_in_samples),
            oversampling: other.at.oversampling * farther.powf(DISTANCE_EXPONENT),
        };
        let more = own.covered / others.covered;
        let Errors { along, across, .. } = other.errors;
        let along = along.map(|errors| errors.map(|e| more * e));
        let errors = Errors { along, across: across.map(|e| more * e), ..other.errors };
        let model = Self { errors, at, other_spread_db: LIKE_SPREAD_DB, ..*self };
        // Numbers that come from elsewhere may be any.
        let all = errors.along.as_flattened().iter().chain(&errors.across);
        let is_sound = all.chain([&errors.deviation]).all(|e| e.is_finite() && *e >= 0.0)
            && model.error(&at).is_finite()
            && model.spread_db(&at).is_finite();
        is_sound.then_some(model)
    }

    /// The sampling to measure at, of which a chosen one is, or is close to, one of the coarser ones.
    pub fn to_measure(&self, chosen: &Sampling) -> Sampling {
        let first = |all: &[f64], least: f64| all.iter().copied().find(|n| *n >= least).unwrap_or(all[all.len() - 1]);
        let most = self.most_oversampling.max(MEASURED_OVERSAMPLINGS[0]);
        let sheets = chosen.sheets_per_slice;
        Sampling {
            // Half of the sheets are to lie as evenly.
            sheets_per_slice: if self.is_smooth {
                (SHEET_MARGIN * sheets).min(12.0)
            } else {
                first(&MEASURED_SHEETS, sheets)
            },
            oversampling: first(&MEASURED_OVERSAMPLINGS, chosen.oversampling).min(most),
        }
    }

    /// Whether a sampling is among those that were measured, or close to them.
    pub fn covers(&self, sampling: &Sampling) -> bool {
        self.octaves_beyond(sampling).iter().all(|octaves| *octaves <= CLOSE_OCTAVES)
    }

    /// The cheapest sampling that promises an error, or else nearly the least.
    pub fn cheapest(&self, error: f64) -> Sampling {
        self.cheapest_of(error, |_| true)
    }

    /// The same of those that were measured.
    pub fn cheapest_measured(&self, error: f64) -> Sampling {
        self.cheapest_of(error, |sampling| self.covers(sampling))
    }

    fn cheapest_of(&self, error: f64, is_possible: impl Fn(&Sampling) -> bool) -> Sampling {
        let lies_evenly = |sheets: f64| MEASURED_SHEETS.iter().any(|n| sheets == *n || 2.0 * sheets == *n);
        let is_candidate =
            |sampling: &Sampling| (self.is_smooth || lies_evenly(sampling.sheets_per_slice)) && is_possible(sampling);
        let all = || self.samplings().filter(is_candidate);
        let likely_most =
            |sampling: &Sampling| self.error(sampling) * 10.0_f64.powf(0.1 * DEVIATIONS * self.spread_db(sampling));
        let best = all().map(|sampling| likely_most(&sampling)).fold(f64::INFINITY, f64::min);
        let enough = all().filter(|sampling| likely_most(sampling) <= error.max(ACCEPT_RATIO * best));
        enough.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b))).unwrap_or(self.at)
    }

    /// The mean square error with a sampling: along and across the rays.
    pub fn error(&self, new: &Sampling) -> f64 {
        let reads = usize::from(reads_per_axis(self.composite, new.oversampling) > 1);
        let Errors { along, across, .. } = self.errors;
        let Sampling { sheets_per_slice, oversampling } = self.at;
        let sheets = [0.5, 1.0].map(|of| of * sheets_per_slice);
        let texels = [0.5, 2.0 / 3.0, 1.0].map(|of| of * oversampling);
        let along = interpolated(&[(sheets[0], along[0][reads]), (sheets[1], along[1][reads])], new.sheets_per_slice);
        let points = [0, 1, 2].map(|k| (texels[k], across[k]));
        along + interpolated(&points, new.oversampling)
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
    fn octaves_beyond(&self, new: &Sampling) -> [f64; 2] {
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
