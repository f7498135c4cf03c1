//! Colour maps that looks use, by name, and curves of a map over a range of values.
//!
//! A value's place is (value - low) / (high - low), or the same of the logarithms, to the power of gamma; colour and
//! opacity depend on the place. Maps have 256 nodes, as matplotlib's tables have, so colours agree with these.

use wavesplat_core::{ColorNode, OpacityNode};

use crate::colors::Rgb;
use crate::map_tables::{COOLWARM, INFERNO, MAGMA, PLASMA, TURBO, VIRIDIS};
use crate::numbers::{interpolated, linspace, power};

/// Entries of matplotlib's tables.
pub const N_NODES: usize = 256;
/// Steepness of the sigmoid: from a tenth to nine tenths in 37 % of the range.
const STEEPNESS: f64 = 12.0;

/// A colour map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorMap {
    /// Its name.
    pub name: &'static str,
    /// Whether it has a middle that its colours part from, as for values of two signs.
    pub is_diverging: bool,
    stops: Stops,
    is_reversed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stops {
    /// Even ones, in parts of a whole.
    Table(&'static [[u32; 3]], f64),
    /// Places, 0..1, and colours.
    Placed(&'static [(f64, Rgb)]),
}

const fn sequential(name: &'static str, stops: Stops) -> ColorMap {
    ColorMap { name, is_diverging: false, stops, is_reversed: false }
}

const MILLIONTHS: f64 = 1e6;
/// The maps that looks and their measures use, and three that are usual beside them; all are matplotlib's of that name.
static MAPS: [ColorMap; 11] = [
    sequential("viridis", Stops::Table(&VIRIDIS, MILLIONTHS)),
    sequential("inferno", Stops::Table(&INFERNO, MILLIONTHS)),
    sequential("magma", Stops::Table(&MAGMA, MILLIONTHS)),
    sequential("plasma", Stops::Table(&PLASMA, MILLIONTHS)),
    sequential("turbo", Stops::Table(&TURBO, MILLIONTHS)),
    sequential("gray", Stops::Placed(&[(0.0, [0.0; 3]), (1.0, [1.0; 3])])),
    sequential(
        "hot",
        Stops::Placed(&[
            (0.0, [0.0416, 0.0, 0.0]),
            (0.365_079, [1.0, 0.0, 0.0]),
            (0.746_032, [1.0, 1.0, 0.0]),
            (1.0, [1.0, 1.0, 1.0]),
        ]),
    ),
    sequential("cool", Stops::Placed(&[(0.0, [0.0, 1.0, 1.0]), (1.0, [1.0, 0.0, 1.0])])),
    sequential("winter", Stops::Placed(&[(0.0, [0.0, 0.0, 1.0]), (1.0, [0.0, 1.0, 0.5])])),
    sequential("summer", Stops::Placed(&[(0.0, [0.0, 0.5, 0.4]), (1.0, [1.0, 1.0, 0.4])])),
    ColorMap { is_diverging: true, ..sequential("coolwarm", Stops::Table(&COOLWARM, 1e9)) },
];

impl ColorMap {
    /// The map of a name; `_r` at its end reverses it, and case and blanks around it do not matter.
    ///
    /// `None` of names that are not among [`ColorMap::names`].
    pub fn named(name: &str) -> Option<Self> {
        let plain = name.trim().to_lowercase();
        let base = plain.strip_suffix("_r").or_else(|| plain.strip_suffix("-r")).or_else(|| plain.strip_suffix(" r"));
        let found = MAPS.iter().find(|map| map.name == base.unwrap_or(&plain))?;
        Some(Self { is_reversed: base.is_some(), ..*found })
    }

    /// Names of all maps.
    pub fn names() -> impl Iterator<Item = &'static str> {
        MAPS.iter().map(|map| map.name)
    }

    /// Its colours at [`N_NODES`] even places from 0 to 1.
    pub fn colors(&self) -> Vec<Rgb> {
        let stops = self.placed();
        let end = (N_NODES - 1) as f64;
        let positions: Vec<f64> = stops.iter().map(|(place, _)| place * end).collect();
        let places = linspace(0.0, 1.0, N_NODES);
        let inner = places[1..N_NODES - 1].iter().map(|place| {
            let at = end * place;
            let k = positions.partition_point(|&position| position < at);
            let way = (at - positions[k - 1]) / (positions[k] - positions[k - 1]);
            let (before, after) = (stops[k - 1].1, stops[k].1);
            std::array::from_fn(|c| (way * (after[c] - before[c]) + before[c]).clamp(0.0, 1.0))
        });
        std::iter::once(stops[0].1).chain(inner).chain([stops[stops.len() - 1].1]).collect()
    }

    fn placed(&self) -> Vec<(f64, Rgb)> {
        let mut stops: Vec<(f64, Rgb)> = match self.stops {
            Stops::Placed(stops) => stops.to_vec(),
            Stops::Table(table, whole) => {
                let colors = table.iter().map(|color| color.map(|part| f64::from(part) / whole));
                linspace(0.0, 1.0, table.len()).into_iter().zip(colors).collect()
            }
        };
        if self.is_reversed {
            stops.reverse();
            for (place, _) in &mut stops {
                *place = 1.0 - *place;
            }
        }
        stops
    }
}

/// The places of the nodes of a map, 0..1.
pub fn even_places() -> Vec<f64> {
    (0..N_NODES).map(|k| k as f64 / (N_NODES - 1) as f64).collect()
}

/// Colours of one of our maps from a place on, `n` at even places.
pub(crate) fn shades(name: &str, start: f64, n: usize) -> Vec<Rgb> {
    let colors = ColorMap::named(name).expect("one of our maps").colors();
    let places = even_places();
    let channels: [Vec<f64>; 3] = std::array::from_fn(|c| colors.iter().map(|rgb| rgb[c]).collect());
    let color = |wanted: f64| std::array::from_fn(|c| interpolated(wanted, &places, &channels[c]));
    linspace(start, 1.0, n).into_iter().map(color).collect()
}

/// The range of values that a map is spread over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapRange {
    /// The value of the first colour; positive where `is_log`.
    pub low: f64,
    /// The value of the last colour.
    pub high: f64,
    /// Whether places are even in the logarithm.
    pub is_log: bool,
    /// Power of the places; 1 changes nothing, less brightens.
    pub gamma: f64,
}

impl MapRange {
    /// The value at a place, 0..1.
    pub fn value_at(&self, place: f64) -> f64 {
        let part = power(place, 1.0 / self.gamma);
        if self.is_log {
            self.low * (self.high / self.low).powf(part)
        } else {
            self.low + part * (self.high - self.low)
        }
    }

    /// Nodes of colours at places, 0..1.
    pub fn color_nodes(&self, places: &[f64], colors: &[Rgb]) -> Vec<ColorNode> {
        places.iter().zip(colors).map(|(&place, &rgb)| ColorNode { value: self.value_at(place), rgb }).collect()
    }
}

/// Opacity by place, 0..1.
#[derive(Clone, Debug, PartialEq)]
pub enum Rise {
    /// The place.
    Linear,
    /// Slow at both ends.
    Sigmoid,
    /// The square root of the place.
    Sqrt,
    /// One opacity everywhere.
    Constant(f64),
    /// Opacities at even places from 0 to 1, at least one.
    Numbers(Vec<f64>),
}

impl Rise {
    /// Curves that have a name.
    pub const NAMED: [(&str, Self); 3] = [("linear", Self::Linear), ("sigmoid", Self::Sigmoid), ("sqrt", Self::Sqrt)];

    /// The curve over a range of values.
    pub fn over(&self, value_at: impl Fn(f64) -> f64) -> Vec<OpacityNode> {
        let places = if matches!(self, Self::Constant(_)) { vec![0.0] } else { even_places() };
        let alphas: Vec<f64> = match self {
            Self::Linear => places.clone(),
            Self::Sigmoid => places.iter().map(|&place| sigmoid(place)).collect(),
            Self::Sqrt => places.iter().map(|place| place.sqrt()).collect(),
            Self::Constant(alpha) => vec![*alpha],
            Self::Numbers(numbers) => {
                let even = linspace(0.0, 1.0, numbers.len());
                places.iter().map(|&place| interpolated(place, &even, numbers)).collect()
            }
        };
        places.iter().zip(alphas).map(|(&place, opacity)| OpacityNode { value: value_at(place), opacity }).collect()
    }
}

fn sigmoid(place: f64) -> f64 {
    let at = |place: f64| 1.0 / (1.0 + (-STEEPNESS * (place - 0.5)).exp());
    let [low, high] = [0.5, -0.5].map(|side: f64| 1.0 / (1.0 + (STEEPNESS * side).exp()));
    (at(place) - low) / (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_the_colours_of_matplotlib() {
        let at = |name: &str, k: usize| ColorMap::named(name).unwrap().colors()[k];
        assert_eq!(at("viridis", 0), [0.267_004, 0.004_874, 0.329_415]);
        assert_eq!(at(" Inferno", 255), [0.988_362, 0.998_364, 0.644_924]);
        assert_eq!(at("hot", 0), [0.0416, 0.0, 0.0]);
        assert_eq!([at("gray", 51), at("gray_r", 51)].map(|rgb| (rgb[0] * 5.0).round()), [1.0, 4.0]);
        assert_eq!(ColorMap::named("cmocean:ice"), None);
        for name in ColorMap::names() {
            let (map, back) = (ColorMap::named(name).unwrap(), ColorMap::named(&format!("{name}_r")).unwrap());
            for (a, b) in map.colors().iter().zip(back.colors().iter().rev()) {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 && (0.0..=1.0).contains(a)), "{name}");
            }
        }
    }

    #[test]
    fn places_of_a_logarithm_are_decades() {
        let range = MapRange { low: 1.0, high: 1e4, is_log: true, gamma: 1.0 };
        let found = [0.0, 0.25, 0.5, 1.0].map(|place| range.value_at(place));
        assert!(found.iter().zip([1.0, 10.0, 100.0, 1e4]).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{found:?}");
        let brighter = MapRange { is_log: false, gamma: 0.5, ..range };
        assert_eq!(brighter.value_at(0.5), 1.0 + 0.25 * 9999.0);
    }

    #[test]
    fn opacities_rise_from_0_to_1() {
        for (name, rise) in Rise::NAMED {
            let nodes = rise.over(|place| place);
            assert_eq!([nodes[0].opacity, nodes[255].opacity], [0.0, 1.0], "{name}");
            assert!(nodes.windows(2).all(|pair| pair[0].opacity < pair[1].opacity), "{name}");
        }
        let middle = Rise::Numbers(vec![0.0, 0.1, 0.5]).over(|place| place)[51];
        assert!((middle.opacity - 0.04).abs() < 1e-12);
        assert_eq!(Rise::Constant(0.3).over(|place| place), [OpacityNode { value: 0.0, opacity: 0.3 }]);
    }
}
