//! Positions of the sheets of a slice family: evenly spaced, the first on the first slice and the last on the last.

use std::ops::Range;

/// Spacing of a family's sheets: `n_slabs + 1` sheets from the first slice to the last, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetSpacing {
    /// Number of slabs between the sheets.
    pub n_slabs: usize,
    /// Slice distances between sheets.
    pub step: f64,
    /// Position of the last slice.
    last: f64,
}

impl SheetSpacing {
    /// Spacing with about `sheets_per_slice` sheets per slice distance, with one on the first and one on the last
    /// slice.
    pub fn new(n_slices: usize, sheets_per_slice: f64) -> Self {
        let last = (n_slices - 1) as f64;
        let n_slabs = (last * sheets_per_slice).round().max(1.0);
        Self { n_slabs: n_slabs as usize, step: last / n_slabs, last }
    }

    /// Position of a sheet, exact for sheets that lie on a slice.
    pub fn w(&self, sheet_idx: usize) -> f64 {
        // The product of whole numbers is exact, and a whole quotient comes out whole; `sheet_idx · step` would round
        // twice.
        sheet_idx as f64 * self.last / self.n_slabs as f64
    }

    /// Range of sheets from the last one before an interval of w to the first one after it.
    pub fn range(&self, [lo, hi]: [f64; 2]) -> Range<usize> {
        if lo >= hi {
            return 0..0;
        }
        let n = self.n_slabs as f64;
        let first = (lo / self.step).floor().clamp(0.0, n - 1.0);
        let last = (hi / self.step).ceil().clamp(first + 1.0, n);
        first as usize..last as usize + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_lie_on_the_first_and_the_last_slice() {
        for (n, per_slice) in [(2, 1.0), (2, 0.1), (111, 2.0), (84, 0.5), (7, 1.3)] {
            let spacing = SheetSpacing::new(n, per_slice);
            assert_eq!(spacing.w(0), 0.0);
            assert_eq!(spacing.w(spacing.n_slabs), (n - 1) as f64);
        }
        for slice in 0..500 {
            assert_eq!(SheetSpacing::new(500, 3.0).w(3 * slice), slice as f64);
        }
    }

    #[test]
    fn the_sheets_enclose_the_interval() {
        let spacing = SheetSpacing::new(11, 2.0);
        assert_eq!(spacing.range([0.0, 10.0]), 0..21);
        assert_eq!(spacing.range([0.3, 0.4]), 0..2);
        assert_eq!(spacing.range([0.2, 0.8]), 0..3);
        assert_eq!(spacing.range([0.5, 1.0]), 1..3);
        assert_eq!(spacing.range([10.0 - 1e-9, 10.0]), 19..21);
        assert_eq!(spacing.range([3.0, 3.0]), 0..0);
    }
}
