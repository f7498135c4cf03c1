//! One level along one axis.

use crate::family::Family;
use crate::lifting::{self, Lifting};
use crate::lines::{Lines, Row};
use crate::sample::Sample;
use crate::semi_orthogonal::Split;
use crate::solve::Solver;
use crate::spline::Column;
use crate::taps::{Tap, Taps, accumulate};

/// One level of `n` numbers along one axis: `n_low` low coefficients, then `n − n_low` details.
#[derive(Clone, Debug)]
pub struct Step {
    /// Numbers before.
    pub n: usize,
    /// Low coefficients after.
    pub n_low: usize,
    synthesis: Taps,
    order: Vec<usize>,
    method: Method,
}

#[derive(Clone, Debug)]
enum Method {
    /// Nothing left to split.
    Copy,
    Lifting(&'static Lifting),
    /// Coefficients interleaved by the middle of their functions, which keeps the system banded.
    Solver {
        analysis: Solver,
        synthesis: Taps,
    },
}

impl Step {
    pub(crate) fn copy(n: usize) -> Self {
        let mut synthesis = Taps::default();
        (0..n).for_each(|index| synthesis.push([Tap { index, weight: 1.0 }]));
        Self { n, n_low: n, synthesis, order: (0..n).collect(), method: Method::Copy }
    }

    pub(crate) fn lifting(family: Family, lifting: &'static Lifting, n: usize) -> Self {
        let synthesis = lifting.synthesis_taps(n);
        Self { n, n_low: family.n_low(n), synthesis, order: lifting::order(n), method: Method::Lifting(lifting) }
    }

    pub(crate) fn semi_orthogonal(split: &Split) -> Self {
        let columns: Vec<&Column> = split.scaling.iter().chain(&split.wavelets).collect();
        let n = columns.len();
        let mut by_middle: Vec<usize> = (0..n).collect();
        by_middle.sort_by_key(|&c| columns[c].first + columns[c].end());
        let mut order = vec![0; n];
        for (place, &c) in by_middle.iter().enumerate() {
            order[c] = place;
        }
        let interleaved: Vec<Column> = by_middle.iter().map(|&c| columns[c].clone()).collect();
        #[expect(clippy::expect_used, reason = "scaling functions and wavelets are a basis")]
        let analysis = Solver::new(&interleaved).expect("scaling functions and wavelets are a basis");
        let method = Method::Solver { analysis, synthesis: rows(&interleaved) };
        let by_band: Vec<Column> = columns.into_iter().cloned().collect();
        Self { n, n_low: split.scaling.len(), synthesis: rows(&by_band), order, method }
    }

    /// Sample `i` as a weighted sum of the coefficients of this level, low ones first: `x[i] = Σ weight · c[index]`.
    pub fn taps(&self, i: usize) -> &[Tap] {
        self.synthesis.row(i)
    }

    /// Every coefficient's function as samples: the columns of synthesis.
    pub(crate) fn functions(&self) -> Vec<Vec<Tap>> {
        self.synthesis.columns(self.n)
    }

    /// Rows of a bundle in which the coefficients are found; `None` where there is nothing to do.
    pub(crate) fn order(&self) -> Option<&[usize]> {
        if matches!(self.method, Method::Copy) { None } else { Some(&self.order) }
    }

    #[inline(always)]
    pub(crate) fn analyse<T: Sample>(&self, lines: &mut Lines<T>) {
        match &self.method {
            Method::Copy => {}
            Method::Lifting(lifting) => lifting.analyse(&mut lines.rows),
            Method::Solver { analysis, .. } => analysis.solve(lines),
        }
    }

    #[inline(always)]
    pub(crate) fn synthesise<T: Sample>(&self, lines: &mut Lines<T>) {
        match &self.method {
            Method::Copy => {}
            Method::Lifting(lifting) => lifting.synthesise(&mut lines.rows),
            Method::Solver { synthesis, .. } => {
                let zero: Row<T> = [T::default(); _];
                for i in 0..lines.rows.len() {
                    lines.spare[i] = accumulate(zero, 1.0, synthesis.row(i), &lines.rows);
                }
                std::mem::swap(&mut lines.rows, &mut lines.spare);
            }
        }
    }
}

fn rows(columns: &[Column]) -> Taps {
    let mut rows = vec![Vec::new(); columns.len()];
    for (index, column) in columns.iter().enumerate() {
        for (i, &weight) in (column.first..).zip(&column.values) {
            if weight != 0.0 {
                rows[i].push(Tap { index, weight });
            }
        }
    }
    let mut taps = Taps::default();
    for row in rows {
        taps.push(row);
    }
    taps
}
