//! Occupancy, for empty-space skipping: one bit per min-max brick, set if a transfer function shows it.
//!
//! The bits are laid out for a slice family.

/// Occupancy grid: one bit per brick, in rows along u.
#[derive(Clone, Debug)]
pub struct OccupancyGrid {
    /// Binary logarithm of the cells of a brick along each axis: every sheet of every tile needs it, and a shift is
    /// cheap.
    pub(super) log_side: u32,
    pub(super) n: [usize; 3],
    pub(super) n_words: usize,
    pub(super) bits: Vec<u64>,
}

impl OccupancyGrid {
    /// Union of two occupancies; `None` where they are not of the same bricks.
    pub fn or(&self, other: &Self) -> Option<Self> {
        if (self.log_side, self.n) != (other.log_side, other.n) {
            return None;
        }
        let bits = self.bits.iter().zip(&other.bits).map(|(a, b)| a | b).collect();
        Some(Self { bits, ..*self })
    }

    /// Layer of bricks in which a cell lies.
    #[inline(always)]
    pub fn layer(&self, cell: usize) -> usize {
        cell >> self.log_side
    }

    /// Number of bricks along u, v, w; 64-bit words per row of bricks along u; and the words, `[w][v][u / 64]`, lowest
    /// bit first.
    pub fn arrays(&self) -> ([usize; 3], usize, &[u64]) {
        (self.n, self.n_words, &self.bits)
    }

    /// Cells of a brick along each axis.
    pub fn side(&self) -> usize {
        1 << self.log_side
    }

    /// First and last brick that an interval of sample positions touches, along an axis (0: u, 1: v); `None` outside
    /// the volume.
    #[inline(always)]
    pub fn touched(&self, axis: usize, [lo, hi]: [f64; 2]) -> Option<[usize; 2]> {
        let n = self.n[axis];
        // Comparisons with NaN are false, so it counts as outside.
        let touches = hi >= 0.0 && lo <= (n << self.log_side) as f64;
        touches.then(|| [self.layer(lo.max(0.0) as usize).min(n - 1), self.layer(hi as usize).min(n - 1)])
    }

    /// Runs of bricks along u, for [`OccupancyGrid::any_of`]; `None`: outside the volume, where there is no brick.
    #[inline(always)]
    pub fn runs<const N: usize>(&self, u: [Option<[usize; 2]>; N]) -> Runs<N> {
        let first = u.iter().flatten().map(|[from, _]| from / 64).min().unwrap_or(0);
        let mut runs = Runs { first, masks: [[0; 2]; N], long: None };
        for (mask, run) in runs.masks.iter_mut().zip(u) {
            let Some([from, to]) = run.map(|run| run.map(|brick| brick - 64 * first)) else { continue };
            if to >= 128 {
                runs.long = Some(u);
                return runs;
            }
            let bits = u128::MAX >> (127 - (to - from)) << from;
            *mask = [bits as u64, (bits >> 64) as u64];
        }
        runs
    }

    /// Per run: is any of its bricks occupied in the rows `v[0]..=v[1]` of the layers `w[0]..=w[1]`?
    #[inline(always)]
    pub fn any_of<const N: usize>(&self, runs: &Runs<N>, v: [usize; 2], w: [usize; 2]) -> [bool; N] {
        if let Some(u) = runs.long {
            return u.map(|u| u.is_some_and(|u| self.any(u, v, w)));
        }
        // The words that the runs share are read once, combined over rows and layers, and masked for each run.
        let (mut near, mut far) = (0, 0);
        let second = (runs.first + 1).min(self.n_words - 1);
        for layer in w[0]..=w[1].min(self.n[2] - 1) {
            for row in v[0]..=v[1] {
                let words = &self.bits[(layer * self.n[1] + row) * self.n_words..][..self.n_words];
                near |= words[runs.first];
                far |= words[second];
            }
        }
        runs.masks.map(|mask| near & mask[0] | far & mask[1] != 0)
    }

    /// Whether any of the bricks `u[0]..=u[1]`, `v[0]..=v[1]` is occupied in the layers `w[0]..=w[1]`.
    #[inline(always)]
    pub fn any(&self, u: [usize; 2], v: [usize; 2], w: [usize; 2]) -> bool {
        let (first, last) = (u[0] / 64, u[1] / 64);
        for layer in w[0]..=w[1].min(self.n[2] - 1) {
            for row in v[0]..=v[1] {
                let words = &self.bits[(layer * self.n[1] + row) * self.n_words..][..self.n_words];
                for k in first..=last {
                    let before = if k == first { u[0] % 64 } else { 0 };
                    let after = if k == last { 63 - u[1] % 64 } else { 0 };
                    // The shifts drop the bricks of the word after the run and before it.
                    if words[k] << after >> after >> before != 0 {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Runs of bricks along u, as masks of two words.
pub struct Runs<const N: usize> {
    /// Index of the first word in which any run lies.
    first: usize,
    /// Per run: its bricks in that word and in the next, as bits.
    masks: [[u64; 2]; N],
    /// The runs themselves, if they lie in more than two words.
    pub(super) long: Option<[Option<[usize; 2]>; N]>,
}
