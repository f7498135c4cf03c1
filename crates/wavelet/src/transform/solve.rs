//! Banded linear systems: LU factors with row exchanges, computed once in f64 and applied to whole bundles of lines.
//!
//! Gaussian elimination with partial pivoting keeps the rows inside the band, as LAPACK's `gbtrf` does.

use super::lines::{LineBundle, LineRow};
use super::real::Real;
use super::spline::SparseColumn;
use super::taps::{Tap, TapRows, accumulate};

/// A square matrix factored into `P A = L U`.
#[derive(Clone, Debug)]
pub struct BandedSolver {
    /// Permutation P: row `i` of the factors is row `source[i]` of the matrix.
    source: Vec<usize>,
    /// L without its diagonal of ones.
    lower: TapRows,
    /// U without its diagonal.
    upper: TapRows,
    reciprocal_pivots: Vec<f64>,
}

impl BandedSolver {
    /// Factors the matrix with the given columns. `None` where it is singular to 1e-12 of its largest entry.
    pub fn new(columns: &[SparseColumn]) -> Option<Self> {
        let n = columns.len();
        let mut rows = rows_of(columns);
        let largest = columns.iter().flat_map(|c| &c.values).fold(0.0_f64, |a, b| a.max(b.abs()));
        // Number of entries of a column below the diagonal, at most; row exchanges do not increase it.
        let reach = columns.iter().enumerate().map(|(j, c)| c.end().saturating_sub(j + 1)).max().unwrap_or(0);
        let mut source: Vec<usize> = (0..n).collect();
        let mut lower = vec![Vec::new(); n];
        for j in 0..n {
            let below = j + 1..n.min(j + 1 + reach);
            let pivot_row = (j..below.end).max_by(|&a, &b| rows[a].at(j).abs().total_cmp(&rows[b].at(j).abs()))?;
            if rows[pivot_row].at(j).abs() < 1e-12 * largest {
                return None;
            }
            rows.swap(j, pivot_row);
            source.swap(j, pivot_row);
            lower.swap(j, pivot_row);
            for i in below {
                let weight = rows[i].at(j) / rows[j].at(j);
                if weight != 0.0 {
                    subtract(&mut rows, i, weight, j);
                    lower[i].push(Tap { index: j, weight });
                }
            }
        }
        let reciprocal_pivots = (0..n).map(|j| rows[j].at(j).recip()).collect();
        let (mut lower_taps, mut upper) = (TapRows::default(), TapRows::default());
        for (i, row) in rows.iter().enumerate() {
            lower_taps.push(lower[i].iter().copied());
            let beyond = (i + 1..row.end()).map(|index| Tap { index, weight: row.at(index) });
            upper.push(beyond.filter(|tap| tap.weight != 0.0));
        }
        Some(Self { source, lower: lower_taps, upper, reciprocal_pivots })
    }

    /// Right-hand sides -> solutions, in place.
    #[inline(always)]
    pub fn solve<T: Real>(&self, lines: &mut LineBundle<T>) {
        let LineBundle { rows, spare } = lines;
        for i in 0..spare.len() {
            spare[i] = accumulate(rows[self.source[i]], -1.0, self.lower.row(i), spare);
        }
        for i in (0..rows.len()).rev() {
            let sum: LineRow<T> = accumulate(spare[i], -1.0, self.upper.row(i), rows);
            let factor = T::from_f64(self.reciprocal_pivots[i]);
            rows[i] = sum.map(
                #[inline(always)]
                |x| x * factor,
            );
        }
    }
}

fn rows_of(columns: &[SparseColumn]) -> Vec<SparseColumn> {
    let mut rows = vec![SparseColumn { first: 0, values: Vec::new() }; columns.len()];
    for (j, column) in columns.iter().enumerate() {
        for (i, &value) in (column.first..).zip(&column.values) {
            if value != 0.0 {
                let row = &mut rows[i];
                if row.values.is_empty() {
                    row.first = j;
                }
                row.values.resize(j - row.first, 0.0);
                row.values.push(value);
            }
        }
    }
    rows
}

/// Subtracts `weight` times row `j` from row `i`, from column `j` on; the entry in column `j` becomes 0 exactly.
fn subtract(rows: &mut [SparseColumn], i: usize, weight: f64, j: usize) {
    let pivot_row = rows[j].clone();
    let row = &mut rows[i];
    let length = row.values.len().max(pivot_row.end() - row.first);
    row.values.resize(length, 0.0);
    row.values[j - row.first] = 0.0;
    for k in j + 1..pivot_row.end() {
        row.values[k - row.first] -= weight * pivot_row.at(k);
    }
}
