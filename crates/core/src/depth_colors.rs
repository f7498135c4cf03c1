//! Depth colours: hues of a projection by the place of its extreme.

use glam::DVec3;

use crate::composite::Composite;
use crate::error::{Error, Result};

/// Colours by depth: a pixel has the hue of the place of its extreme, and the brightness and opacity of its value.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthColors {
    /// Colours at equal distances, from the nearest to the farthest point of what is drawn; along `axis`, from its lower
    /// end to its upper end.
    pub colors: Vec<[f32; 3]>,
    /// World direction along which places are measured; `None` is the view.
    pub axis: Option<DVec3>,
}

impl DepthColors {
    /// Checks the colours and the axis, and that an operator has places.
    pub fn validate(&self, composite: Composite) -> Result<()> {
        if !composite.has_places() {
            let mend = "draw a maximum or a minimum, whose extremes have a place";
            return Err(Error::out_of_range(
                "composite of depth colours",
                format!("{composite:?}"),
                "an extreme",
                mend,
            ));
        }
        let is_color = |rgb: &[f32; 3]| rgb.iter().all(|c| (0.0..=1.0).contains(c));
        if self.colors.len() < 2 || !self.colors.iter().all(is_color) {
            let value = format!("{} colours", self.colors.len());
            let mend = "pass at least two, with red, green and blue between 0 and 1";
            return Err(Error::out_of_range("depth colours", value, "a list of colours", mend));
        }
        if self.axis.is_some_and(|axis| axis.try_normalize().is_none()) {
            let value = format!("{:?}", self.axis.unwrap_or_default().to_array());
            return Err(Error::out_of_range("axis of depth colours", value, "a direction", "pass a vector (x, y, z)"));
        }
        Ok(())
    }

    /// The colour at a share of the way, linear between the nearest two.
    pub fn at(&self, share: f64) -> [f32; 3] {
        let place = share.clamp(0.0, 1.0) * (self.colors.len() - 1) as f64;
        let first = (place as usize).min(self.colors.len() - 2);
        let t = (place - first as f64) as f32;
        let [a, b] = [self.colors[first], self.colors[first + 1]];
        std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_linear_between_nodes_and_constant_beyond() {
        let colors = vec![[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        let depth_colors = DepthColors { colors, axis: None };
        let pairs = [
            (-1.0, [0.0, 0.0, 1.0]),
            (0.25, [0.0, 0.5, 0.5]),
            (0.5, [0.0, 1.0, 0.0]),
            (1.0, [1.0, 0.0, 0.0]),
            (7.0, [1.0, 0.0, 0.0]),
        ];
        for (share, want) in pairs {
            assert_eq!(depth_colors.at(share), want, "{share}");
        }
    }

    #[test]
    fn colours_axes_and_operators_that_cannot_work_are_named() {
        let two = vec![[0.0; 3], [1.0; 3]];
        let check = |colors: &[[f32; 3]], axis, composite, word: &str| {
            let message = DepthColors { colors: colors.to_vec(), axis }.validate(composite).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        };
        check(&two, None, Composite::Mean, "extreme");
        check(&two[..1], None, Composite::Maximum, "at least two");
        check(&[[0.0; 3], [2.0; 3]], None, Composite::Maximum, "between 0 and 1");
        check(&two, Some(DVec3::ZERO), Composite::Minimum, "axis");
        assert!(DepthColors { colors: two, axis: Some(DVec3::Z) }.validate(Composite::Maximum).is_ok());
    }
}
