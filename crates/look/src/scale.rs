//! Scales of the values of curves: samples, or places in a volume's own range of values.

use crate::numbers::{interpolated, linspace};

/// Nodes of a curve that is even in the logarithm; the straight line between two is off by less than half a level of 255.
const N_LOG: usize = 65;

/// Scale of the values of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The values themselves.
    Samples,
    /// The values themselves, in Hounsfield units.
    Hounsfield,
    /// 0 and 1 are the values that count as smallest and largest, the 0.1 and 99.9 percentiles.
    Fraction,
    /// 0 is the threshold that parts the object from its background, 1 the value that a two-hundredth of it exceeds.
    Object,
    /// -1 and 1 are as far from 0 as the largest thousandth of the magnitudes.
    Signed,
    /// 0 and 1 are black and white of a maximum projection.
    Maximum,
    /// As `Fraction`, evenly in the logarithm, over the positive values.
    Log,
}

impl Scale {
    /// All scales with their public names.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("samples", Self::Samples),
        ("hounsfield", Self::Hounsfield),
        ("fraction", Self::Fraction),
        ("object", Self::Object),
        ("signed", Self::Signed),
        ("maximum", Self::Maximum),
        ("log", Self::Log),
    ];

    /// Its public name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, scale)| *scale == self).map_or("", |(name, _)| name)
    }

    /// Whether values on it are samples, so that no volume is needed.
    pub fn is_absolute(self) -> bool {
        matches!(self, Self::Samples | Self::Hounsfield)
    }

    /// Nodes whose first number is a place on this scale, with the sample value instead. `low`, `high`: the values at
    /// places 0 and 1.
    pub fn placed<const N: usize>(self, nodes: &[[f64; N]], low: f64, high: f64) -> Vec<[f64; N]> {
        if self.is_absolute() || nodes.is_empty() {
            return nodes.to_vec();
        }
        if self != Self::Log {
            return nodes.iter().map(|node| with_first(node, low + node[0] * (high - low))).collect();
        }
        let column = |c: usize| nodes.iter().map(|node| node[c]).collect::<Vec<_>>();
        let marks = column(0);
        let mut places = linspace(marks[0], marks[marks.len() - 1], N_LOG);
        places.extend(&marks);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let columns: Vec<Vec<f64>> = (0..N).map(column).collect();
        let node = |&place: &f64| {
            let between: [f64; N] = std::array::from_fn(|c| interpolated(place, &marks, &columns[c]));
            with_first(&between, low * (high / low).powf(place))
        };
        places.iter().map(node).collect()
    }

    /// Nodes whose first number is a difference on this scale, such as a gradient, with the difference of sample values.
    pub fn widened<const N: usize>(self, nodes: &[[f64; N]], low: f64, high: f64) -> Vec<[f64; N]> {
        if self.is_absolute() {
            return nodes.to_vec();
        }
        nodes.iter().map(|node| with_first(node, node[0] * (high - low))).collect()
    }
}

fn with_first<const N: usize>(node: &[f64; N], first: f64) -> [f64; N] {
    std::array::from_fn(|c| if c == 0 { first } else { node[c] })
}

/// The values of a volume that a preset is fitted to, and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The value at place 0 of the preset's scale.
    pub low: f64,
    /// The value at place 1.
    pub high: f64,
    /// Longest side of the volume's box, world units.
    pub longest_side: f64,
}
