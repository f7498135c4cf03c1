//! Filter bank step: one level of a transform along one axis.

use super::lifting::{self, LiftingScheme};
use super::lines::{LineBundle, LineRow};
use super::real::Real;
use super::semi_orthogonal::SplineSplit;
use super::solve::BandedSolver;
use super::spline::SparseColumn;
use super::taps::{Tap, TapRows, accumulate};
use crate::family::WaveletFamily;

/// One level of a transform of `n` numbers along one axis: `n_low` low-pass coefficients, then `n − n_low` details.
#[derive(Clone, Debug)]
pub struct LevelStep {
    /// Samples, or low-pass coefficients of the level before.
    pub n: usize,
    /// Low-pass coefficients of the next level.
    pub n_low: usize,
    synthesis: TapRows,
    order: Vec<usize>,
    method: StepMethod,
}

#[derive(Clone, Debug)]
enum StepMethod {
    /// Nothing left to split.
    Copy,
    Lifting(&'static LiftingScheme),
    /// A banded solve; coefficients are sorted by the middle of their functions' supports, which keeps the system
    /// banded.
    Solve {
        analysis: BandedSolver,
        synthesis: TapRows,
    },
}

impl LevelStep {
    pub(crate) fn copy(n: usize) -> Self {
        let mut synthesis = TapRows::default();
        (0..n).for_each(|index| synthesis.push([Tap { index, weight: 1.0 }]));
        Self { n, n_low: n, synthesis, order: (0..n).collect(), method: StepMethod::Copy }
    }

    pub(crate) fn lifting(family: WaveletFamily, lifting: &'static LiftingScheme, n: usize) -> Self {
        let synthesis = lifting.synthesis_taps(n);
        Self { n, n_low: family.n_low(n), synthesis, order: lifting::order(n), method: StepMethod::Lifting(lifting) }
    }

    pub(crate) fn semi_orthogonal(split: &SplineSplit) -> Self {
        let columns: Vec<&SparseColumn> = split.scaling.iter().chain(&split.wavelets).collect();
        let n = columns.len();
        let mut by_middle: Vec<usize> = (0..n).collect();
        by_middle.sort_by_key(|&c| columns[c].first + columns[c].end());
        let mut order = vec![0; n];
        for (place, &c) in by_middle.iter().enumerate() {
            order[c] = place;
        }
        let interleaved: Vec<SparseColumn> = by_middle.iter().map(|&c| columns[c].clone()).collect();
        #[expect(clippy::expect_used, reason = "scaling functions and wavelets are a basis")]
        let analysis = BandedSolver::new(&interleaved).expect("scaling functions and wavelets are a basis");
        let method = StepMethod::Solve { analysis, synthesis: rows(&interleaved) };
        let by_band: Vec<SparseColumn> = columns.into_iter().cloned().collect();
        Self { n, n_low: split.scaling.len(), synthesis: rows(&by_band), order, method }
    }

    /// Sample `i` as a weighted sum of the coefficients of this level, low-pass ones first:
    /// `x[i] = Σ weight · c[index]`.
    ///
    /// # Panics
    /// Where `i` is not below `n`.
    pub fn taps(&self, i: usize) -> &[Tap] {
        self.synthesis.row(i)
    }

    /// Basis function of every coefficient as samples: the columns of synthesis.
    pub(crate) fn functions(&self) -> Vec<Vec<Tap>> {
        self.synthesis.columns(self.n)
    }

    /// Row of each coefficient in a bundle; `None` where there is nothing to do.
    pub(crate) fn order(&self) -> Option<&[usize]> {
        if matches!(self.method, StepMethod::Copy) { None } else { Some(&self.order) }
    }

    #[inline(always)]
    pub(crate) fn analyse<T: Real>(&self, lines: &mut LineBundle<T>) {
        match &self.method {
            StepMethod::Copy => {}
            StepMethod::Lifting(lifting) => lifting.analyse(&mut lines.rows),
            StepMethod::Solve { analysis, .. } => analysis.solve(lines),
        }
    }

    #[inline(always)]
    pub(crate) fn synthesise<T: Real>(&self, lines: &mut LineBundle<T>) {
        match &self.method {
            StepMethod::Copy => {}
            StepMethod::Lifting(lifting) => lifting.synthesise(&mut lines.rows),
            StepMethod::Solve { synthesis, .. } => {
                let zero: LineRow<T> = [T::default(); _];
                for i in 0..lines.rows.len() {
                    lines.spare[i] = accumulate(zero, 1.0, synthesis.row(i), &lines.rows);
                }
                std::mem::swap(&mut lines.rows, &mut lines.spare);
            }
        }
    }
}

fn rows(columns: &[SparseColumn]) -> TapRows {
    let mut rows = vec![Vec::new(); columns.len()];
    for (index, column) in columns.iter().enumerate() {
        for (i, &weight) in (column.first..).zip(&column.values) {
            if weight != 0.0 {
                rows[i].push(Tap { index, weight });
            }
        }
    }
    let mut taps = TapRows::default();
    for row in rows {
        taps.push(row);
    }
    taps
}
