//! Error model: predicts the errors and the costs of samplings.
//!
//! [`Errors`] holds errors along the rays with two numbers of sheets, and errors across them with three numbers of
//! texels, as `probe.rs` measures them. Between these, the logarithm of the error is linear in that of the number;
//! beyond them it is extrapolated, which shows where to measure next. Before anything is measured, and where nothing is
//! seen, there is the prior, on which no promise depends.

use wavesplat_core::{Camera, Composite, RenderOptions};

use crate::optics::slab_variation::needs_preintegration;
use crate::picture::supersampling::reads_per_axis;
use crate::quality::framing::Framing;
use crate::render::layer::Layer;
use crate::view::base_plane::MAX_TEXELS;

/// Sampling of a picture: how finely it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
}

/// Samplings to choose from. One texel per pixel is not among them: an edge of the volume that lies along the texels is
/// then as jagged as with many more texels that are read once.
const SHEETS: [f64; 11] = [0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0];
const OVERSAMPLINGS: [f64; 10] = [0.5, 0.6, 0.8, 1.2, 4.0 / 3.0, 1.5, 2.0, 8.0 / 3.0, 3.0, 4.0];

/// Samplings to measure, along with half of the sheets, and two thirds and half of the texels. Where colours along a
/// ray do not change smoothly, the error of sheets between slices depends on how they lie to the samples, and whether
/// slabs are pre-integrated depends on their thickness: only these numbers of sheets and half of them are chosen there.
const MEASURED_SHEETS: [f64; 5] = [2.0, 4.0, 6.0, 8.0, 12.0];
const MEASURED_OVERSAMPLINGS: [f64; 4] = [1.2, 2.0, 3.0, 4.0];

/// Factor on the least error: where no sampling reaches the target, the cheapest one within it is taken.
const ACCEPT_RATIO: f64 = 1.1;

/// Mean square errors of a picture with a sampling and with coarser ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Errors along the rays, with half the sheets and with all; each for pixels of a single read, and for pixels that
    /// are the mean of as many reads as the texels ask for.
    pub along: [[f64; 2]; 2],
    /// Errors across the rays, with half the texels along each axis, two thirds, and all.
    pub across: [f64; 3],
    /// Relative standard deviation of all these.
    pub deviation: f64,
}

/// Least and largest factor by which errors change when sheets or texels double, beyond what was measured.
const DECAYS: [f64; 2] = [0.06, 0.7];

impl Errors {
    /// Errors from differences to a stand-in for the converged picture: three times the sheets, and twice the texels.
    /// The stand-in has errors of its own, which may or may not be of the same kind as the measured ones. Across the
    /// rays, errors are not believed to fall faster than those of straight edges under a regular grid of reads: with
    /// the cube of its number.
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

/// Error at a number of sheets or texels: linear in logarithms between points of number and error. Before the points it
/// follows the first two; beyond them it follows the outermost two, since the last two can be closer by chance.
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

/// Least error: no prediction starts from less, so ratios stay finite.
const MIN_ERROR: f64 = 1e-14;

/// Measured errors of a picture, for the next pictures of the same volume and transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Errors with the sampling `at` and with coarser ones.
    pub errors: Errors,
    /// Sampling at which the errors were measured.
    pub at: Sampling,
    /// How the picture framed the volume.
    pub framing: Framing,
    /// Whether colours along a ray changed smoothly.
    pub is_smooth: bool,
}

/// Model of the errors and the costs of samplings, for one picture.
#[derive(Clone, Copy, Debug)]
pub struct ErrorModel {
    errors: Errors,
    at: Sampling,
    /// Standard deviation besides that of the measured errors, dB.
    other_spread_db: f64,
    is_smooth: bool,
    composite: Composite,
    framing: Framing,
    /// Largest oversampling: more would make base planes too large.
    most_oversampling: f64,
}

/// Standard deviations, dB: of the prior, of a model from another picture, of a measured model, and per octave beyond
/// what was measured.
const PRIOR_SPREAD_DB: f64 = 5.0;
const LIKE_SPREAD_DB: f64 = 2.0;
const MODEL_SPREAD_DB: f64 = 0.5;
const SPREAD_PER_OCTAVE_DB: f64 = 1.5;

/// Safety margin of a choice: standard deviations by which the expected error is below the target.
const DEVIATIONS: f64 = 1.0;

/// Octaves beyond what was measured that need no new measurement: 0.5 texels a pixel instead of 0.6.
const CLOSE_OCTAVES: f64 = 0.3;

/// Ratio of the sheets that are measured to those that are chosen, for smooth functions: more or fewer may do.
const SHEET_MARGIN: f64 = 1.4;

/// Exponent of growth at equal error: texels grow with this power of the distance of pixels.
const DISTANCE_EXPONENT: f64 = 0.25;

/// Largest factor by which the distance of pixels may differ for the errors of another picture to be used.
const MAX_FARTHER: f64 = 1.5;

impl ErrorModel {
    /// Prior model, from pictures like those of `make bench BENCH="--only psnr"`: a casting, a CT, an MRI.
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

    /// The same model with errors that were measured on this picture.
    #[must_use]
    pub fn with(&self, errors: Errors, at: Sampling) -> Self {
        Self { errors, at, other_spread_db: MODEL_SPREAD_DB, ..*self }
    }

    /// Measured errors, for the next pictures.
    pub fn measured(&self) -> Measured {
        Measured { errors: self.errors, at: self.at, framing: self.framing, is_smooth: self.is_smooth }
    }

    /// Model from the errors of another picture of the same volume, from a little nearer or farther or from another
    /// side; `None` where they say too little about this one.
    pub fn like(&self, other: &Measured) -> Option<Self> {
        let (own, others) = (&self.framing, &other.framing);
        let farther = own.pixel_in_samples / others.pixel_in_samples;
        if self.is_smooth != other.is_smooth || !(1.0 / MAX_FARTHER..=MAX_FARTHER).contains(&farther) {
            return None;
        }
        // Sampling that leaves the same error in the visible part, and the ratio of the sizes of the visible parts.
        let at = Sampling {
            sheets_per_slice: other.at.sheets_per_slice * (own.slice_in_samples / others.slice_in_samples),
            oversampling: other.at.oversampling * farther.powf(DISTANCE_EXPONENT),
        };
        let more = own.covered / others.covered;
        let Errors { along, across, .. } = other.errors;
        let along = along.map(|errors| errors.map(|e| more * e));
        let errors = Errors { along, across: across.map(|e| more * e), ..other.errors };
        let model = Self { errors, at, other_spread_db: LIKE_SPREAD_DB, ..*self };
        // These numbers come from the caller and may be anything.
        let all = errors.along.as_flattened().iter().chain(&errors.across);
        let is_sound = all.chain([&errors.deviation]).all(|e| e.is_finite() && *e >= 0.0)
            && model.error(&at).is_finite()
            && model.spread_db(&at).is_finite();
        is_sound.then_some(model)
    }

    /// Sampling to measure at: `chosen` is then close to it, or to a coarser one that is measured along with it.
    pub fn to_measure(&self, chosen: &Sampling) -> Sampling {
        let first = |all: &[f64], least: f64| all.iter().copied().find(|n| *n >= least).unwrap_or(all[all.len() - 1]);
        let most = self.most_oversampling.max(MEASURED_OVERSAMPLINGS[0]);
        let sheets = chosen.sheets_per_slice;
        Sampling {
            // Half of the sheets must lie as evenly to the slices.
            sheets_per_slice: if self.is_smooth {
                (SHEET_MARGIN * sheets).min(12.0)
            } else {
                first(&MEASURED_SHEETS, sheets)
            },
            oversampling: first(&MEASURED_OVERSAMPLINGS, chosen.oversampling).min(most),
        }
    }

    /// Whether a sampling is among the measured ones, or close to them.
    pub fn covers(&self, sampling: &Sampling) -> bool {
        self.octaves_beyond(sampling).iter().all(|octaves| *octaves <= CLOSE_OCTAVES)
    }

    /// Cheapest sampling that promises an error; if none does, the cheapest one with nearly the least error.
    pub fn cheapest(&self, error: f64) -> Sampling {
        self.cheapest_of(error, |_| true)
    }

    /// Cheapest sampling like [`ErrorModel::cheapest`], among those that were measured.
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

    /// Mean square error with a sampling: the sum of that along the rays and that across them.
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

    /// Standard deviation of the error with a sampling, dB.
    pub fn spread_db(&self, new: &Sampling) -> f64 {
        let [sheets, texels] = self.octaves_beyond(new);
        let measured = 10.0 / std::f64::consts::LN_10 * self.errors.deviation;
        [measured, self.other_spread_db, SPREAD_PER_OCTAVE_DB * sheets, SPREAD_PER_OCTAVE_DB * texels]
            .iter()
            .map(|db| db * db)
            .sum::<f64>()
            .sqrt()
    }

    /// Octaves by which the sheets and the texels are beyond what was measured.
    fn octaves_beyond(&self, new: &Sampling) -> [f64; 2] {
        let beyond = |ratio: f64| (ratio.log2()).max(-1.0 - ratio.log2()).max(0.0);
        [beyond(new.sheets_per_slice / self.at.sheets_per_slice), beyond(new.oversampling / self.at.oversampling)]
    }

    /// Relative time that a picture takes. Much of a sheet's work is per sample, not per texel; for a hard surface,
    /// much does not depend on the number of sheets.
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

/// Mean square error of a PSNR, peak 1.
pub fn mean_square_of(psnr_db: f64) -> f64 {
    10.0_f64.powf(-0.1 * psnr_db)
}
