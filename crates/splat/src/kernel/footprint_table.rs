//! The table of a footprint: for a run of texels, the first sample that reaches each, and the weights from there.

use wavesplat_compute::simd::{LANES, Lanes};

/// Weights of a run of positions, in groups of [`LANES`].
#[derive(Clone, Debug, Default)]
pub struct Footprint {
    /// Taps per position.
    pub n_taps: usize,
    /// Lowest first sample of each group, counted from the window's first sample.
    pub(super) base: Vec<u32>,
    /// First sample of each position, counted from its group's base.
    pub(super) index: Vec<Lanes<u32>>,
    /// Number of vectors that each group's `index` spans.
    pub(super) spans: Vec<Span>,
    /// 1 where `index` is at least [`LANES`], for groups that span two vectors.
    pub(super) far: Vec<Lanes>,
    /// Weights, `n_taps` vectors per group.
    pub(super) weights: Vec<Lanes>,
}

impl Footprint {
    pub(super) fn reset(&mut self, n_groups: usize, n_taps: usize) {
        self.n_taps = n_taps;
        self.base.resize(n_groups, 0);
        self.index.resize(n_groups, Lanes::default());
        self.spans.resize(n_groups, Span::default());
        self.far.resize(n_groups, Lanes::default());
        self.weights.resize(n_groups * n_taps, Lanes::default());
    }

    /// Sets the first samples of a group, counted from its base.
    #[inline(always)]
    pub(super) fn set_index(&mut self, g: usize, index: Lanes<u32>) {
        self.index[g] = index;
        self.spans[g] = Span::of(&index);
        if self.spans[g] == Span::Two {
            for i in 0..LANES {
                self.far[g].0[i] = if index.0[i] < LANES as u32 { 0.0 } else { 1.0 };
            }
        }
    }

    /// First sample of a position.
    pub fn first(&self, i: usize) -> usize {
        (self.base[i / LANES] + self.index[i / LANES].0[i % LANES]) as usize
    }

    /// Weight of tap `t` of a position.
    #[inline(always)]
    pub fn weight(&self, i: usize, t: usize) -> f32 {
        self.weights[i / LANES * self.n_taps + t].0[i % LANES]
    }

    /// The table of a group of positions.
    #[inline(always)]
    pub fn group(&self, g: usize) -> Group<'_> {
        Group {
            base: self.base[g] as usize,
            index: &self.index[g],
            span: self.spans[g],
            far: &self.far[g],
            weights: &self.weights[g * self.n_taps..(g + 1) * self.n_taps],
        }
    }
}

/// Number of vectors of samples that hold the first samples of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Span {
    /// All indices are below [`LANES`].
    One,
    /// All indices are below twice [`LANES`].
    Two,
    /// Some index is at least twice [`LANES`].
    #[default]
    Many,
}

impl Span {
    fn of(index: &Lanes<u32>) -> Self {
        // Positions are monotonic, so that the largest index is at one end.
        let last = index.0[0].max(index.0[LANES - 1]) as usize;
        if last < LANES {
            Self::One
        } else if last < 2 * LANES {
            Self::Two
        } else {
            Self::Many
        }
    }
}

/// The table of [`LANES`] neighbouring positions.
#[derive(Clone, Copy)]
pub struct Group<'a> {
    /// Lowest first sample.
    pub base: usize,
    /// First sample of each lane, counted from `base`.
    pub index: &'a Lanes<u32>,
    /// Number of vectors that `index` spans.
    pub span: Span,
    /// 1 where `index` is at least [`LANES`], for groups that span two vectors.
    pub far: &'a Lanes,
    /// Weights, tap by tap.
    pub weights: &'a [Lanes],
}

/// Positions of a mask's set bits, from the lowest on.
#[inline(always)]
pub fn bits(mask: impl Into<u32>) -> impl Iterator<Item = usize> + Clone {
    let mut mask = mask.into();
    std::iter::from_fn(move || {
        let next = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        next
    })
}
