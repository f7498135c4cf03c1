//! The table of a footprint: for a run of texels, the first sample that reaches each, and the weights from there.

use wavesplat_compute::simd::{LANES, Lanes, Places};

/// Weights of a run of positions, in groups of [`LANES`].
#[derive(Clone, Debug, Default)]
pub struct Footprint {
    /// Taps per position.
    pub n_taps: usize,
    /// Lowest first sample of each group, counted from the window's first sample.
    pub(super) base: Vec<u32>,
    /// First sample of each position, counted from its group's base.
    pub(super) places: Vec<Places>,
    /// Weights, `n_taps` vectors per group.
    pub(super) weights: Vec<Lanes>,
}

impl Footprint {
    pub(super) fn reset(&mut self, n_groups: usize, n_taps: usize) {
        self.n_taps = n_taps;
        self.base.resize(n_groups, 0);
        self.places.resize(n_groups, Places::default());
        self.weights.resize(n_groups * n_taps, Lanes::default());
    }

    /// First sample of a position.
    pub fn first(&self, i: usize) -> usize {
        (self.base[i / LANES] + self.places[i / LANES].index().0[i % LANES]) as usize
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
            places: &self.places[g],
            weights: &self.weights[g * self.n_taps..(g + 1) * self.n_taps],
        }
    }
}

/// The table of [`LANES`] neighbouring positions.
#[derive(Clone, Copy)]
pub struct Group<'a> {
    /// Lowest first sample.
    pub base: usize,
    /// First sample of each lane, counted from `base`.
    pub places: &'a Places,
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
