//! Wavelet families by name.

/// Family of a scaling function φ and a wavelet ψ, the same along all three axes. The crate's documentation compares
/// them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WaveletFamily {
    /// Piecewise constant, orthogonal; a last sample without a partner is kept as it is. By lifting.
    Haar,
    /// Le Gall 5/3: φ is the linear B-spline. By lifting.
    Cdf53,
    /// Daubechies 9/7 of JPEG 2000: smoother than 5/3, nearly orthogonal. By lifting.
    Cdf97,
    /// Cohen-Daubechies-Feauveau (4, 4): φ is the cubic B-spline. By lifting.
    Spline4,
    /// Linear B-spline, semi-orthogonal on the interval.
    Bspline2,
    /// Quadratic B-spline, semi-orthogonal on the interval.
    Bspline3,
    /// Cubic B-spline, semi-orthogonal on the interval.
    Bspline4,
}

impl WaveletFamily {
    /// All families with their public names.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("haar", Self::Haar),
        ("cdf53", Self::Cdf53),
        ("cdf97", Self::Cdf97),
        ("spline4", Self::Spline4),
        ("bspline2", Self::Bspline2),
        ("bspline3", Self::Bspline3),
        ("bspline4", Self::Bspline4),
    ];

    /// Family of a public name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(n, _)| *n == name).map(|&(_, family)| family)
    }

    /// Public name of the family.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, family)| *family == self).map_or("", |&(name, _)| name)
    }

    /// Order (degree plus one) of the B-splines of a semi-orthogonal family; `None` for the families by lifting.
    pub fn semi_orthogonal_order(self) -> Option<usize> {
        match self {
            Self::Haar | Self::Cdf53 | Self::Cdf97 | Self::Spline4 => None,
            Self::Bspline2 => Some(2),
            Self::Bspline3 => Some(3),
            Self::Bspline4 => Some(4),
        }
    }

    /// Number of low-pass coefficients after one level on `n`; `n` itself where there is nothing left to split.
    ///
    /// ⌈n/2⌉ by lifting. Splines of order m have n − m + 1 intervals between knots, of which ⌈(n − m + 1)/2⌉ stay.
    pub fn n_low(self, n: usize) -> usize {
        let beyond_intervals = self.semi_orthogonal_order().map_or(0, |order| order - 1);
        if n > beyond_intervals { (n - beyond_intervals).div_ceil(2) + beyond_intervals } else { n }
    }

    /// Number of levels after which `n` cannot be split any more.
    pub fn max_levels(self, n: usize) -> usize {
        let sizes = std::iter::successors(Some(n), |&n| Some(self.n_low(n)).filter(|&low| low < n));
        sizes.count() - 1
    }
}
