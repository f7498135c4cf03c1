//! The reversible 5/3 transform: integers in, integers out, exact.
//!
//! `d[i] = x[2i+1] − ⌊(x[2i] + x[2i+2]) / 2⌋`, `s[i] = x[2i] + ⌊(d[i−1] + d[i] + 2) / 4⌋`, mirrored at the ends as in
//! [`crate::lifting`]. Sums wrap around, which synthesis undoes: every i32 comes back, though coefficients only mean
//! something where nothing wrapped (samples below 2^27 in three dimensions).
//!
//! Source: Le Gall & Tabatabai 1988; ISO/IEC 15444-1 (JPEG 2000) annex F, the 5-3 reversible filter.

use wavesplat_compute::simd;

use crate::family::Family;
use crate::lifting::mirror;
use crate::lines::{self, Corner, Direction, LANES, Row};
use crate::plan::Plan;

/// Samples -> coefficients, all levels of a plan of [`Family::Cdf53`], whose layout they have. Along each axis the
/// coefficients are those of [`crate::analyse`] to about one unit.
///
/// # Panics
/// Where the plan is of another family, or of another size than the data.
pub fn analyse_integers(plan: &Plan, data: &mut [i32]) {
    check(plan, data);
    for level in 0..plan.n_levels() {
        run_level(plan, level, data, Direction::Analysis);
    }
}

/// Coefficients -> samples: undoes [`analyse_integers`] exactly.
///
/// # Panics
/// Where the plan is of another family, or of another size than the data.
pub fn synthesise_integers(plan: &Plan, data: &mut [i32]) {
    check(plan, data);
    for level in (0..plan.n_levels()).rev() {
        run_level(plan, level, data, Direction::Synthesis);
    }
}

fn check(plan: &Plan, data: &[i32]) {
    assert_eq!(plan.family(), Family::Cdf53, "the reversible transform is that of cdf53");
    assert_eq!(data.len(), plan.n_samples(), "data and plan differ in size");
}

fn run_level(plan: &Plan, level: usize, data: &mut [i32], direction: Direction) {
    let [nx, ny, _] = plan.size();
    let corner = Corner { pitch: [nx, ny], size: plan.low_size(level) };
    let orders = [0, 1, 2].map(|axis| plan.step(level, axis).order());
    lines::transform(
        data,
        corner,
        orders,
        direction,
        simd::Level::best(),
        #[inline(always)]
        |_, lines| {
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

/// Changes the rows of one parity by the sum of their neighbours.
#[inline(always)]
fn lift(rows: &mut [Row<i32>], parity: usize, change: impl Fn(i32, i32) -> i32) {
    let n = rows.len();
    for i in (parity..n).step_by(2) {
        let (a, b) = (rows[mirror(i as isize - 1, n)], rows[mirror(i as isize + 1, n)]);
        for lane in 0..LANES {
            rows[i][lane] = change(rows[i][lane], a[lane].wrapping_add(b[lane]));
        }
    }
}
