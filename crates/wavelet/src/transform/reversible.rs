//! Reversible integer wavelet transform (5/3): integers in, integers out, exact.
//!
//! `d[i] = x[2i+1] − ⌊(x[2i] + x[2i+2]) / 2⌋`, `s[i] = x[2i] + ⌊(d[i−1] + d[i] + 2) / 4⌋`, mirrored at the ends as in
//! `lifting.rs`. Sums wrap around, which synthesis undoes: every i32 comes back, though coefficients only mean
//! something where nothing wrapped (samples below 2^27 in three dimensions).
//!
//! Source: Le Gall & Tabatabai 1988; ISO/IEC 15444-1 (JPEG 2000) annex F, the 5-3 reversible filter.

use wavesplat_compute::simd;

use super::lifting::mirror;
use super::lines::{self, LANES, LineRow, LowBox, TransformDirection};
use super::plan::TransformPlan;
use crate::family::WaveletFamily;

/// Samples -> coefficients in the layout of a plan of [`WaveletFamily::Cdf53`], all levels. Along each axis the
/// coefficients equal the coefficients of [`crate::analyse`] to about one unit.
///
/// # Panics
/// Where the plan is of another family, or of another size than the data.
pub fn analyse_integers(plan: &TransformPlan, data: &mut [i32]) {
    check(plan, data);
    for level in 0..plan.n_levels() {
        run_level(plan, level, data, TransformDirection::Analysis);
    }
}

/// Coefficients -> samples: undoes [`analyse_integers`] exactly.
///
/// # Panics
/// Where the plan is of another family, or of another size than the data.
pub fn synthesise_integers(plan: &TransformPlan, data: &mut [i32]) {
    check(plan, data);
    for level in (0..plan.n_levels()).rev() {
        run_level(plan, level, data, TransformDirection::Synthesis);
    }
}

fn check(plan: &TransformPlan, data: &[i32]) {
    let name = plan.family().name();
    assert_eq!(plan.family(), WaveletFamily::Cdf53, "the reversible transform is for cdf53, the plan is for {name}");
    plan.check_len(data.len());
}

fn run_level(plan: &TransformPlan, level: usize, data: &mut [i32], direction: TransformDirection) {
    let [nx, ny, _] = plan.size();
    let corner = LowBox { pitch: [nx, ny], size: plan.low_size(level) };
    let orders = [0, 1, 2].map(|axis| plan.step(level, axis).order());
    lines::transform(
        data,
        corner,
        orders,
        direction,
        simd::Level::best(),
        #[inline(always)]
        |_, lines| {
            // A step changes the rows of one parity by a function of the other rows alone. Synthesis still has these,
            // computes the same rounded sum and takes it back: no rounding is lost.
            lift(&mut lines.rows, 1, |x, sum| x.wrapping_sub(sum >> 1));
            lift(&mut lines.rows, 0, |x, sum| x.wrapping_add(sum.wrapping_add(2) >> 2));
        },
        #[inline(always)]
        |_, lines| {
            lift(&mut lines.rows, 0, |x, sum| x.wrapping_sub(sum.wrapping_add(2) >> 2));
            lift(&mut lines.rows, 1, |x, sum| x.wrapping_add(sum >> 1));
        },
    );
}

/// Updates the rows of one parity by the sum of their neighbours.
#[inline(always)]
fn lift(rows: &mut [LineRow<i32>], parity: usize, change: impl Fn(i32, i32) -> i32) {
    let n = rows.len();
    for i in (parity..n).step_by(2) {
        let (a, b) = (rows[mirror(i as isize - 1, n)], rows[mirror(i as isize + 1, n)]);
        for lane in 0..LANES {
            rows[i][lane] = change(rows[i][lane], a[lane].wrapping_add(b[lane]));
        }
    }
}
