//! Ladder: a fixed list of samplings in order of cost, and what is known of their errors in a picture.
//!
//! All named qualities are rungs of the ladder, so a picture of a wanted PSNR never costs more than a named quality that
//! reaches it. The error of a rung is measured with that very rung (`pilot.rs`). Rungs that were not measured get the
//! errors of measured ones and the difference that is usual between these rungs, with a larger spread; no picture
//! depends on that alone where it can be measured.

use wavesplat_core::LADDER;

use crate::quality::framing::Framing;

/// Sampling of a picture: how finely it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
}

impl Sampling {
    /// No sheets and no texels.
    pub const NONE: Self = Self { sheets_per_slice: 0.0, oversampling: 0.0 };

    /// The same with a whole number of texels per pixel, where there is at least one. The centres of pixels then lie on
    /// texels, or midway between equally many, so that a projection along an axis has the values of the samples: with
    /// 1.2 texels a pixel, a sum of white noise is up to 27 % off.
    #[must_use]
    pub fn with_whole_texels(self) -> Self {
        Self {
            oversampling: if self.oversampling > 1.0 { self.oversampling.ceil() } else { self.oversampling },
            ..self
        }
    }

    /// The larger number of sheets, and the larger number of texels.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            sheets_per_slice: self.sheets_per_slice.max(other.sheets_per_slice),
            oversampling: self.oversampling.max(other.oversampling),
        }
    }
}

/// Number of rungs to choose from. One more, the finest, is only compared with.
pub const N_RUNGS: usize = LADDER.len() - 1;

/// Samplings of a scene, one for each rung of [`LADDER`].
pub type Ladder = [Sampling; LADDER.len()];

/// The rungs with which rungs are compared: the cheapest ones whose own errors hardly count. Two rungs above often have
/// the same texels, which then hide the errors that come from these.
pub(crate) const FINER: [usize; N_RUNGS] = [3, 3, 5, 7, 7, 7, 9, 9, 10, 11, 12, 12];

/// Decibels by which a comparison with a finer rung exceeds the error, since that rung has errors of its own, of smooth
/// functions and of others. Medians over 7 volumes of 4 views each (castings, CT, MRI, angiography, microscopy, a
/// simulation), against 16 sheets a slice and 5 x 5 texels a pixel. Projections of ripples have none.
const EXCESS_DB: [f64; 2] = [0.2, 0.8];

/// PSNR of the rungs in dB, for smooth functions and others: medians of the same pictures.
const USUAL_DB: [[f64; N_RUNGS]; 2] = [
    [33.4, 34.5, 38.2, 44.2, 45.6, 47.7, 47.8, 52.2, 55.8, 56.9, 64.6, 66.1],
    [22.8, 23.2, 25.7, 29.3, 29.5, 30.7, 30.8, 33.2, 35.7, 36.1, 40.6, 41.2],
];

/// Standard deviations, dB: of the usual PSNR where nothing was measured, per rung from a measured one, and of
/// comparisons with finer rungs (between the pictures of [`EXCESS_DB`], and as much on 12 other volumes).
const USUAL_SPREAD_DB: f64 = 6.0;
const SPREAD_PER_RUNG_DB: f64 = 0.5;
const COMPARISON_SPREAD_DB: f64 = 0.6;

/// Decibels that a rung may be worse than the best one and still be as good, where none reaches the wanted PSNR.
const AS_GOOD_DB: f64 = 0.5;

/// A rung that is expected to fall short by no more than this is measured before it is left out.
const DOUBT_DB: f64 = 0.7;

/// Measured error of a rung.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RungError {
    /// Mean square error of the picture's colours over black, peak 1.
    pub mean_square: f64,
    /// Relative standard deviation of the mean square error.
    pub deviation: f64,
}

impl RungError {
    /// Error from a comparison with the finer rung. `is_projection`: whether the picture is one.
    pub(crate) fn of_comparison(mean_square: f64, deviation: f64, is_smooth: bool, is_projection: bool) -> Self {
        let excess = if is_projection { 0.0 } else { EXCESS_DB[usize::from(!is_smooth)] };
        Self { mean_square: mean_square * mean_square_of(excess), deviation }
    }
}

/// Measured errors of a picture, for the next pictures of the same volume and transfer function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Errors of the rungs; `None` where a rung was not measured.
    pub errors: [Option<RungError>; N_RUNGS],
    /// How the picture framed the volume.
    pub framing: Framing,
    /// Whether colours along a ray changed smoothly.
    pub is_smooth: bool,
}

impl Measured {
    /// Nothing measured yet.
    pub(crate) fn nothing(framing: Framing, is_smooth: bool) -> Self {
        Self { errors: [None; N_RUNGS], framing, is_smooth }
    }

    /// Whether the errors can be used for a picture of another framing; these numbers come from the caller and may be
    /// anything.
    pub(crate) fn serves(&self, framing: &Framing, is_smooth: bool) -> bool {
        let is_sound = |e: &RungError| {
            [e.mean_square, e.deviation].iter().all(|number| number.is_finite() && (0.0..1e6).contains(number))
        };
        let mut measured = self.errors.iter().flatten().peekable();
        let is_any = measured.peek().is_some();
        is_any && measured.all(is_sound) && self.is_smooth == is_smooth && self.framing.serves(framing)
    }
}

/// PSNR of a rung with its standard deviation, dB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Expected {
    pub psnr_db: f64,
    pub spread_db: f64,
}

/// Knowledge of the rungs' errors in a picture.
pub(crate) struct Known<'a> {
    measured: &'a Measured,
    /// Change of the PSNR from the measured picture to this one, dB.
    change_db: f64,
    /// Standard deviation of that change, dB.
    change_spread_db: f64,
    /// Number of samplings of the ladder whose base planes are not too large.
    n_fitting: usize,
}

impl<'a> Known<'a> {
    /// Errors of a picture with some framing, from errors measured in that or in another picture.
    pub fn new(measured: &'a Measured, framing: &Framing, n_fitting: usize) -> Self {
        let (change_db, change_spread_db) = framing.change_from(&measured.framing);
        Self { measured, change_db, change_spread_db, n_fitting }
    }

    /// Expected PSNR of a rung.
    pub fn expected(&self, rung: usize) -> Expected {
        let measured = |k: usize| self.measured.errors[k].map(|e| (k, e));
        let below = (0..=rung).rev().find_map(measured);
        let above = (rung..N_RUNGS).find_map(measured);
        let usual = &USUAL_DB[usize::from(!self.measured.is_smooth)];
        let from = |(k, e): (usize, RungError)| Expected {
            psnr_db: psnr_of(e.mean_square) + usual[rung] - usual[k],
            spread_db: norm(&[
                10.0 / std::f64::consts::LN_10 * e.deviation,
                COMPARISON_SPREAD_DB,
                SPREAD_PER_RUNG_DB * k.abs_diff(rung) as f64,
            ]),
        };
        let of_measured = match (below, above) {
            (Some(below), Some(above)) if below.0 < above.0 => {
                let share = (rung - below.0) as f64 / (above.0 - below.0) as f64;
                let (a, b) = (from(below), from(above));
                let psnr_db = a.psnr_db + share * (b.psnr_db - a.psnr_db);
                Expected { psnr_db, spread_db: a.spread_db.min(b.spread_db) }
            }
            (Some(one), _) | (None, Some(one)) => from(one),
            (None, None) => Expected { psnr_db: usual[rung], spread_db: USUAL_SPREAD_DB },
        };
        Expected {
            psnr_db: of_measured.psnr_db + self.change_db,
            spread_db: norm(&[of_measured.spread_db, self.change_spread_db]),
        }
    }

    /// The cheapest rung that promises a PSNR with its spread; if none does, the cheapest one that is about as good as
    /// the best.
    pub fn chosen(&self, wanted_db: f64) -> usize {
        self.cheapest(wanted_db, |rung| {
            let Expected { psnr_db, spread_db } = self.expected(rung);
            psnr_db - spread_db
        })
    }

    /// The rung of [`Known::chosen`], and what is expected of it.
    pub fn chosen_with_expectation(&self, wanted_db: f64) -> (usize, Expected) {
        let rung = self.chosen(wanted_db);
        (rung, self.expected(rung))
    }

    /// The next rung to measure; `None` where enough is known to choose.
    pub fn to_measure(&self, wanted_db: f64) -> Option<usize> {
        let is_measured = |rung: usize| self.measured.errors[rung].is_some();
        let can_be_measured = |rung: usize| FINER[rung] < self.n_fitting;
        // The cheapest rung shows which picture this is, and costs next to nothing.
        if !(0..self.n_rungs()).any(is_measured) {
            return can_be_measured(0).then_some(0);
        }
        // A rung that is not measured yet will have about the spread of the others then, since the tiles are the same.
        let of_measured =
            (0..self.n_rungs()).filter(|rung| is_measured(*rung)).map(|rung| self.expected(rung).spread_db);
        let usual_spread = of_measured.fold(f64::INFINITY, f64::min);
        let likely = self.cheapest(wanted_db, |rung| {
            let Expected { psnr_db, spread_db } = self.expected(rung);
            psnr_db - spread_db.min(usual_spread)
        });
        if !is_measured(likely) {
            return can_be_measured(likely).then_some(likely);
        }
        let below = likely.checked_sub(1)?;
        let may_do = self.expected(below).psnr_db - usual_spread + DOUBT_DB > wanted_db;
        (!is_measured(below) && may_do && can_be_measured(below)).then_some(below)
    }

    /// Number of rungs to choose from.
    fn n_rungs(&self) -> usize {
        self.n_fitting.min(N_RUNGS)
    }

    fn cheapest(&self, wanted_db: f64, promised: impl Fn(usize) -> f64) -> usize {
        let best = (0..self.n_rungs()).map(&promised).fold(f64::NEG_INFINITY, f64::max);
        let enough = wanted_db.min(best - AS_GOOD_DB);
        (0..self.n_rungs()).find(|rung| promised(*rung) >= enough).unwrap_or(self.n_rungs() - 1)
    }
}

fn norm(numbers: &[f64]) -> f64 {
    numbers.iter().map(|number| number * number).sum::<f64>().sqrt()
}

/// PSNR of a mean square error, peak 1.
pub(crate) fn psnr_of(mean_square: f64) -> f64 {
    -10.0 * mean_square.max(1e-12).log10()
}

/// Mean square error of a PSNR, peak 1.
pub(crate) fn mean_square_of(psnr_db: f64) -> f64 {
    10.0_f64.powf(-0.1 * psnr_db)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn framing() -> Framing {
        Framing { pixel_in_samples: 1.0, covered: 0.5, direction: DVec3::Z.to_array(), aside: [0.0; 3], cut: 0 }
    }

    fn with(errors: &[(usize, f64)]) -> Measured {
        let mut measured = Measured::nothing(framing(), true);
        for (rung, psnr_db) in errors {
            measured.errors[*rung] = Some(RungError { mean_square: mean_square_of(*psnr_db), deviation: 0.02 });
        }
        measured
    }

    #[test]
    fn rungs_are_compared_with_finer_ones_and_cost_more_than_those_below() {
        for (rung, finer) in FINER.into_iter().enumerate() {
            let [(sheets, oversampling), (finer_sheets, finer_oversampling)] = [LADDER[rung], LADDER[finer]];
            assert!(finer_sheets > sheets || finer_oversampling > 1.4 * oversampling, "{rung}");
            assert!(finer_oversampling >= 1.2 * oversampling, "{rung}");
        }
        for pair in LADDER.windows(2) {
            assert!(pair[0].0 <= pair[1].0 && pair[0].1 <= pair[1].1, "{pair:?}");
            assert!(pair[0].0 * pair[0].1.powi(2) < pair[1].0 * pair[1].1.powi(2), "{pair:?}");
        }
    }

    #[test]
    fn more_wanted_never_chooses_a_cheaper_rung() {
        // Errors that do not fall from rung to rung, as cut faces that lie along texels have.
        for errors in [&[][..], &[(0, 30.0)], &[(2, 40.0), (3, 39.0)], &[(0, 30.0), (3, 47.0), (4, 44.0), (7, 52.0)]] {
            let measured = with(errors);
            let known = Known::new(&measured, &framing(), LADDER.len());
            let chosen: Vec<usize> = (20..80).map(|wanted_db| known.chosen(f64::from(wanted_db))).collect();
            assert!(chosen.is_sorted(), "{errors:?}: {chosen:?}");
        }
    }

    #[test]
    fn base_planes_that_are_too_large_are_neither_chosen_nor_compared_with() {
        for n_fitting in 1..=LADDER.len() {
            let mut measured = with(&[]);
            while let Some(rung) = Known::new(&measured, &framing(), n_fitting).to_measure(60.0) {
                assert!(rung < n_fitting && FINER[rung] < n_fitting, "{rung} of {n_fitting}");
                let mean_square = mean_square_of(USUAL_DB[0][rung]);
                measured.errors[rung] = Some(RungError { mean_square, deviation: 0.05 });
            }
            assert!(Known::new(&measured, &framing(), n_fitting).chosen(60.0) < n_fitting.min(N_RUNGS));
        }
    }

    #[test]
    fn what_is_chosen_has_been_measured_and_the_rung_below_falls_short() {
        for truth in [[0.0; N_RUNGS].map(|_| 3.0), std::array::from_fn(|k| if k % 2 == 0 { -2.5 } else { 1.0 })] {
            for wanted_db in 25..60 {
                let wanted_db = f64::from(wanted_db);
                let mut measured = with(&[]);
                let mut n_measured = 0;
                while let Some(rung) = Known::new(&measured, &framing(), LADDER.len()).to_measure(wanted_db) {
                    assert!(measured.errors[rung].is_none());
                    let mean_square = mean_square_of(USUAL_DB[0][rung] + truth[rung]);
                    measured.errors[rung] = Some(RungError { mean_square, deviation: 0.05 });
                    n_measured += 1;
                }
                assert!(n_measured <= 6, "{n_measured}");
                let known = Known::new(&measured, &framing(), LADDER.len());
                let chosen = known.chosen(wanted_db);
                assert!(measured.errors[chosen].is_some(), "{wanted_db}");
                assert!(known.expected(chosen).psnr_db >= wanted_db, "{wanted_db}");
                assert!(chosen == 0 || known.expected(chosen - 1).psnr_db < wanted_db + 1.0, "{wanted_db}");
            }
        }
    }
}
