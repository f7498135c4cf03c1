//! Lifting scheme: biorthogonal wavelets. Each step adds to the samples of one parity a weighted sum of neighbours of
//! the other parity, so subtracting the same sum undoes it.
//!
//! Even positions become low-pass coefficients, odd ones details. Beyond the ends the signal is mirrored about its
//! first and its last sample (whole-point symmetry), which the symmetric steps keep at every stage: any size, nothing
//! cut off.
//!
//! | family | steps, at the target `x[i]` |
//! | --- | --- |
//! | haar | odd `−1 · x[i−1]`, even `+1/2 · x[i+1]`; a last sample without a partner is a low-pass coefficient as it is |
//! | cdf53 | odd `−1/2 (x[i−1] + x[i+1])`, even `+1/4 (..)` |
//! | cdf97 | odd α, even β, odd γ, even δ; low `· 1/K`, detail `· K` |
//! | spline4 | even `−1/4`, odd `−1`, even `+29/128` and `−5/128 (x[i−3] + x[i+3])`; low `· 2`, detail `· 1/2` |
//!
//! Normalisation: low-pass coefficients of a constant are that constant (gain 1 at frequency 0), details have gain 2 at
//! the highest frequency for cdf53, cdf97 and spline4, and are the plain difference for haar.
//!
//! | family | analysis low-pass | analysis high-pass | source |
//! | --- | --- | --- | --- |
//! | haar | `[1, 1] / 2` | `[−1, 1]` | |
//! | cdf53 | `[−1, 2, 6, 2, −1] / 8` | `[−1, 2, −1] / 2` | Le Gall & Tabatabai 1988; ISO/IEC 15444-1 annex F |
//! | cdf97 | 9 taps | 7 taps | Antonini et al. 1992; ISO/IEC 15444-1 annex F |
//! | spline4 | 11 taps | `[1, −4, 6, −4, 1] / 8` | Cohen, Daubechies, Feauveau 1992, (4, 4) |
//!
//! Factorisations: Daubechies & Sweldens, "Factoring wavelet transforms into lifting steps", 1998.

use std::collections::BTreeMap;

use super::lines::{LANES, LineRow};
use super::real::Real;
use super::taps::{Tap, TapRows};
use crate::family::WaveletFamily;

/// Adds `weight · (x[i + offsets[0]] + x[i + offsets[1]])` to every `x[i]` of one parity.
#[derive(Clone, Copy, Debug)]
struct LiftingStep {
    parity: usize,
    offsets: [isize; 2],
    weight: f64,
}

const fn even(reach: isize, weight: f64) -> LiftingStep {
    LiftingStep { parity: 0, offsets: [-reach, reach], weight }
}

const fn odd(reach: isize, weight: f64) -> LiftingStep {
    LiftingStep { parity: 1, offsets: [-reach, reach], weight }
}

/// The lifting steps of a family, and the factors of its low-pass coefficients and its details at the end.
#[derive(Debug)]
pub(crate) struct LiftingScheme {
    lifts: &'static [LiftingStep],
    gain: Option<[f64; 2]>,
    /// Whether the signal is mirrored at its ends; else a target without a neighbour is left unchanged.
    mirrored: bool,
}

static HAAR: LiftingScheme = LiftingScheme {
    lifts: &[
        // The only neighbour is given twice, with half the weight.
        LiftingStep { parity: 1, offsets: [-1, -1], weight: -0.5 },
        LiftingStep { parity: 0, offsets: [1, 1], weight: 0.25 },
    ],
    gain: None,
    mirrored: false,
};

static CDF53: LiftingScheme = LiftingScheme { lifts: &[odd(1, -0.5), even(1, 0.25)], gain: None, mirrored: true };

/// ISO/IEC 15444-1 annex F, table F.4.
static CDF97: LiftingScheme = LiftingScheme {
    lifts: &[
        odd(1, -1.586_134_342_059_924),
        even(1, -0.052_980_118_572_961),
        odd(1, 0.882_911_075_530_934),
        even(1, 0.443_506_852_043_971),
    ],
    gain: Some([1.0 / 1.230_174_104_914_001, 1.230_174_104_914_001]),
    mirrored: true,
};

static SPLINE4: LiftingScheme = LiftingScheme {
    lifts: &[even(1, -0.25), odd(1, -1.0), even(1, 29.0 / 128.0), even(3, -5.0 / 128.0)],
    gain: Some([2.0, 0.5]),
    mirrored: true,
};

impl LiftingScheme {
    /// Lifting scheme of a family; `None` for the semi-orthogonal ones.
    pub(crate) fn of(family: WaveletFamily) -> Option<&'static Self> {
        match family {
            WaveletFamily::Haar => Some(&HAAR),
            WaveletFamily::Cdf53 => Some(&CDF53),
            WaveletFamily::Cdf97 => Some(&CDF97),
            WaveletFamily::Spline4 => Some(&SPLINE4),
            WaveletFamily::Bspline2 | WaveletFamily::Bspline3 | WaveletFamily::Bspline4 => None,
        }
    }

    /// Samples -> coefficients, in place, details at odd rows.
    #[inline(always)]
    pub(crate) fn analyse<T: Real>(&self, rows: &mut [LineRow<T>]) {
        for lift in self.lifts {
            self.lift(rows, lift, lift.weight);
        }
        if let Some(gain) = self.gain {
            scale(rows, gain);
        }
    }

    /// Coefficients -> samples.
    #[inline(always)]
    pub(crate) fn synthesise<T: Real>(&self, rows: &mut [LineRow<T>]) {
        if let Some(gain) = self.gain {
            scale(rows, gain.map(f64::recip));
        }
        for lift in self.lifts.iter().rev() {
            self.lift(rows, lift, -lift.weight);
        }
    }

    #[inline(always)]
    fn lift<T: Real>(&self, rows: &mut [LineRow<T>], lift: &LiftingStep, weight: f64) {
        let weight = T::from_f64(weight);
        for i in (lift.parity..rows.len()).step_by(2) {
            let Some([a, b]) = self.neighbours(lift, i, rows.len()) else { continue };
            let (a, b) = (rows[a], rows[b]);
            let row = &mut rows[i];
            for lane in 0..LANES {
                row[lane] = row[lane] + weight * (a[lane] + b[lane]);
            }
        }
    }

    #[inline(always)]
    fn neighbours(&self, lift: &LiftingStep, i: usize, n: usize) -> Option<[usize; 2]> {
        if !self.mirrored && i.checked_add_signed(lift.offsets[0]).is_none_or(|neighbour| neighbour >= n) {
            return None;
        }
        Some(lift.offsets.map(|offset| mirror(i as isize + offset, n)))
    }

    /// One level of synthesis as a matrix: sample `i` as a weighted sum of coefficients, low-pass ones first.
    pub(crate) fn synthesis_taps(&self, n: usize) -> TapRows {
        let n_low = n.div_ceil(2);
        let mut taps = TapRows::default();
        for i in 0..n {
            let mut row = BTreeMap::new();
            self.unfold(i, n, 1.0, self.lifts, &mut row);
            taps.push(row.into_iter().map(|(i, weight)| {
                let gain = self.gain.map_or(1.0, |gain| gain[i % 2]);
                Tap { index: if i % 2 == 0 { i / 2 } else { n_low + i / 2 }, weight: weight / gain }
            }));
        }
        taps
    }

    /// Follows sample `i` back through the lifting steps, the first of which synthesis undoes last, and adds the weight
    /// of every coefficient to `row`.
    fn unfold(&self, i: usize, n: usize, factor: f64, lifts: &[LiftingStep], row: &mut BTreeMap<usize, f64>) {
        let Some((lift, later)) = lifts.split_first() else {
            *row.entry(i).or_insert(0.0) += factor;
            return;
        };
        self.unfold(i, n, factor, later, row);
        if i % 2 == lift.parity
            && let Some(neighbours) = self.neighbours(lift, i, n)
        {
            for neighbour in neighbours {
                self.unfold(neighbour, n, -factor * lift.weight, later, row);
            }
        }
    }
}

/// Index of the sample that stands at position `i`, which may be beyond the ends of a line of `n ≥ 2`.
#[inline(always)]
pub(crate) fn mirror(i: isize, n: usize) -> usize {
    if (0..n as isize).contains(&i) {
        return i as usize;
    }
    let last = n - 1;
    let folded = i.rem_euclid(2 * last as isize) as usize;
    if folded > last { 2 * last - folded } else { folded }
}

#[inline(always)]
fn scale<T: Real>(rows: &mut [LineRow<T>], gain: [f64; 2]) {
    let gain = gain.map(T::from_f64);
    for (i, row) in rows.iter_mut().enumerate() {
        for lane in 0..LANES {
            row[lane] = row[lane] * gain[i % 2];
        }
    }
}

/// Row of each coefficient in a bundle, low-pass coefficients first.
pub(crate) fn order(n: usize) -> Vec<usize> {
    (0..n).step_by(2).chain((1..n).step_by(2)).collect()
}
