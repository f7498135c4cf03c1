//! Filter taps: the rows of sparse matrices.

use super::lines::{LANES, LineRow};
use super::real::Real;

/// One term of a weighted sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Index of the number that is weighted.
    pub index: usize,
    /// Factor of the number.
    pub weight: f64,
}

/// Sparse matrix by rows.
#[derive(Clone, Debug, Default)]
pub struct TapRows {
    ends: Vec<usize>,
    taps: Vec<Tap>,
}

impl TapRows {
    pub fn push(&mut self, row: impl IntoIterator<Item = Tap>) {
        self.taps.extend(row);
        self.ends.push(self.taps.len());
    }

    #[inline(always)]
    pub fn row(&self, i: usize) -> &[Tap] {
        let first = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.taps[first..self.ends[i]]
    }

    pub fn n_rows(&self) -> usize {
        self.ends.len()
    }

    /// Columns of the matrix: for each, its entries by row.
    pub fn columns(&self, n_columns: usize) -> Vec<Vec<Tap>> {
        let mut columns = vec![Vec::new(); n_columns];
        for i in 0..self.n_rows() {
            for tap in self.row(i) {
                columns[tap.index].push(Tap { index: i, weight: tap.weight });
            }
        }
        columns
    }
}

/// `start + weight_sign · Σ weight · row`, summed in the order of the taps.
#[inline(always)]
pub fn accumulate<T: Real>(start: LineRow<T>, weight_sign: f64, taps: &[Tap], rows: &[LineRow<T>]) -> LineRow<T> {
    let mut sum = start;
    for tap in taps {
        let weight = T::from_f64(weight_sign * tap.weight);
        let row = &rows[tap.index];
        for lane in 0..LANES {
            sum[lane] = sum[lane] + weight * row[lane];
        }
    }
    sum
}
