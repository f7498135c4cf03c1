//! Transfer function: sample value -> colour and opacity per `opacity_unit`.
//!
//! Two piecewise-linear curves, held constant beyond their ends. Opacities are for a slab one `opacity_unit` thick, so
//! the picture depends on neither the view, the number of sheets nor the level of detail. Two nodes at the same value
//! make a step, which belongs to the upper side.

use crate::error::{Error, Result};
use crate::transfer_function_2d::TransferFunction2D;

/// A node of the opacity curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpacityNode {
    /// Sample value.
    pub value: f64,
    /// Opacity per `opacity_unit`, `0..=1`; 1 is opaque at any thickness. A ray passes the value of a single node of 1
    /// between lower ones over no length: it meets the integral of `−ln(1 − opacity)`, which is finite there.
    pub opacity: f64,
}

/// A node of the colour curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorNode {
    /// Sample value.
    pub value: f64,
    /// Red, green, blue, `0..=1`, used as given.
    pub rgb: [f64; 3],
}

/// A node of the gradient opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientNode {
    /// Magnitude of the gradient, sample units per world unit.
    pub magnitude: f64,
    /// Factor of the extinction, `0..=1`.
    pub factor: f64,
}

/// A transfer function: validated curves.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    opacity: Vec<OpacityNode>,
    color: Vec<ColorNode>,
    opacity_unit: Option<f64>,
    gradient: Vec<GradientNode>,
    joint: Option<TransferFunction2D>,
}

impl TransferFunction {
    /// Checks the curves. `opacity_unit`: world units; `None` takes the volume's default, the geometric mean of its
    /// spacings.
    pub fn new(opacity: Vec<OpacityNode>, color: Vec<ColorNode>, opacity_unit: Option<f64>) -> Result<Self> {
        check_values("opacity", opacity.iter().map(|n| n.value))?;
        check_values("color", color.iter().map(|n| n.value))?;
        let unit_interval = 0.0..=1.0;
        for (index, node) in opacity.iter().enumerate() {
            if !unit_interval.contains(&node.opacity) {
                let what = format!("transfer function: the opacity of node {index} (value {})", node.value);
                return Err(Error::out_of_range(what, node.opacity, "between 0 and 1", "scale the opacities to 0..1"));
            }
        }
        for (index, node) in color.iter().enumerate() {
            if node.rgb.iter().any(|c| !unit_interval.contains(c)) {
                let what = format!("transfer function: the colour of node {index} (value {})", node.value);
                let mend = "scale red, green and blue to 0..1 (divide 8-bit colours by 255)";
                return Err(Error::out_of_range(what, format!("{:?}", node.rgb), "between 0 and 1", mend));
            }
        }
        if let Some(unit) = opacity_unit
            && !(unit.is_finite() && unit > 0.0)
        {
            let mend = "pass a length in world units, or nothing for the volume's mean spacing";
            return Err(Error::out_of_range("transfer function: opacity_unit", unit, "a positive number", mend));
        }
        Ok(Self { opacity, color, opacity_unit, gradient: Vec::new(), joint: None })
    }

    /// Adds a factor of the extinction by the magnitude of the gradient; no nodes: 1 everywhere.
    pub fn with_gradient_opacity(self, gradient: Vec<GradientNode>) -> Result<Self> {
        if !gradient.is_empty() {
            check_values("gradient opacity", gradient.iter().map(|n| n.magnitude))?;
        }
        for (index, node) in gradient.iter().enumerate() {
            if node.magnitude < 0.0 {
                let what = format!("transfer function: the magnitude of gradient opacity node {index}");
                let mend = "a magnitude has no sign; begin with 0";
                return Err(Error::out_of_range(what, node.magnitude, "at least 0", mend));
            }
            if !(0.0..=1.0).contains(&node.factor) {
                let what = format!("transfer function: the factor of gradient opacity node {index}");
                return Err(Error::out_of_range(what, node.factor, "between 0 and 1", "scale the factors to 0..1"));
            }
        }
        Ok(Self { gradient, ..self })
    }

    /// A function of value and gradient magnitude. Its curves over the value alone are the largest opacity of any
    /// magnitude, an upper bound, and the colour of the lowest magnitude.
    pub fn two_dimensional(joint: TransferFunction2D, opacity_unit: Option<f64>) -> Result<Self> {
        let rows = || (0..joint.magnitudes().len()).map(|row| joint.row(row));
        let nodes = joint.values().iter().enumerate();
        let opacity = nodes.clone().map(|(i, &value)| {
            let opacity = rows().map(|row| row[i][3]).fold(0.0, f64::max);
            OpacityNode { value, opacity }
        });
        let color = nodes.map(|(i, &value)| {
            let [r, g, b, _] = joint.row(0)[i];
            ColorNode { value, rgb: [r, g, b] }
        });
        let bounds = Self::new(opacity.collect(), color.collect(), opacity_unit)?;
        Ok(Self { joint: Some(joint), ..bounds })
    }

    /// Table of colour and opacity by value and gradient magnitude, if the function has two dimensions.
    pub fn function_2d(&self) -> Option<&TransferFunction2D> {
        self.joint.as_ref()
    }

    /// Whether the gradient matters for opacity or colour.
    pub fn has_gradient(&self) -> bool {
        self.joint.is_some() || !self.gradient.is_empty()
    }

    /// Optical depth per `opacity_unit` at a value and gradient magnitude, sample units per world unit; infinite for
    /// opacity 1, but 0 where the gradient's factor is 0.
    pub fn optical_depth(&self, value: f64, magnitude: f64) -> f64 {
        let opacity = self.joint.as_ref().map_or_else(|| self.opacity(value), |joint| joint.rgba(value, magnitude)[3]);
        let factor = self.gradient_factor(magnitude);
        if factor == 0.0 { 0.0 } else { -(-opacity).ln_1p() * factor }
    }

    /// Red, green, blue at a value and gradient magnitude.
    pub fn color_at(&self, value: f64, magnitude: f64) -> [f64; 3] {
        let Some(joint) = &self.joint else { return self.color(value) };
        let [r, g, b, _] = joint.rgba(value, magnitude);
        [r, g, b]
    }

    /// Opacity nodes in order of value.
    pub fn opacity_nodes(&self) -> &[OpacityNode] {
        &self.opacity
    }

    /// Colour nodes in order of value.
    pub fn color_nodes(&self) -> &[ColorNode] {
        &self.color
    }

    /// Nodes of the gradient opacity in order of magnitude; empty where there is none.
    pub fn gradient_nodes(&self) -> &[GradientNode] {
        &self.gradient
    }

    /// Thickness of the slab that opacities are given for, world units.
    pub fn opacity_unit(&self) -> Option<f64> {
        self.opacity_unit
    }

    /// Opacity of a slab one `opacity_unit` thick.
    pub fn opacity(&self, value: f64) -> f64 {
        interpolate(&self.opacity, value, |n| n.value, |n| [n.opacity])[0]
    }

    /// Factor of the extinction at a gradient magnitude, sample units per world unit.
    pub fn gradient_factor(&self, magnitude: f64) -> f64 {
        if self.gradient.is_empty() {
            return 1.0;
        }
        interpolate(&self.gradient, magnitude, |n| n.magnitude, |n| [n.factor])[0]
    }

    /// Red, green, blue at a value.
    pub fn color(&self, value: f64) -> [f64; 3] {
        interpolate(&self.color, value, |n| n.value, |n| n.rgb)
    }

    /// A function from value to red, green, blue and opacity, fast for sequences of values that are near each other.
    pub fn rgba_in_turn(&self) -> impl FnMut(f64) -> [f64; 4] {
        let (mut color, mut opacity) = (0, 0);
        move |value| {
            color = n_up_to(&self.color, value, |n| n.value, color);
            opacity = n_up_to(&self.opacity, value, |n| n.value, opacity);
            let [r, g, b] = between(&self.color, color, value, |n| n.value, |n| n.rgb);
            let [opacity] = between(&self.opacity, opacity, value, |n| n.value, |n| [n.opacity]);
            [r, g, b, opacity]
        }
    }
}

fn check_values(curve: &'static str, values: impl Iterator<Item = f64>) -> Result<()> {
    let mut before: Option<f64> = None;
    for (index, value) in values.enumerate() {
        if !value.is_finite() {
            let what = format!("transfer function: the value of {curve} node {index}");
            return Err(Error::out_of_range(what, value, "finite", "give every node a finite sample value"));
        }
        if let Some(before) = before
            && value < before
        {
            return Err(Error::UnsortedCurve { curve, index, value, before_index: index - 1, before });
        }
        before = Some(value);
    }
    before.map(|_| ()).ok_or(Error::EmptyCurve { curve })
}

fn interpolate<N, const C: usize>(
    nodes: &[N],
    value: f64,
    position: impl Fn(&N) -> f64,
    channels: impl Fn(&N) -> [f64; C],
) -> [f64; C] {
    let upper = nodes.partition_point(|n| position(n) <= value);
    between(nodes, upper, value, position, channels)
}

/// Number of nodes that are no higher than a value, searched from the guess `n`.
fn n_up_to<N>(nodes: &[N], value: f64, position: impl Fn(&N) -> f64, mut n: usize) -> usize {
    while nodes.get(n).is_some_and(|node| position(node) <= value) {
        n += 1;
    }
    while n > 0 && position(&nodes[n - 1]) > value {
        n -= 1;
    }
    n
}

/// Value of the curve, linear between nodes. `upper`: number of nodes that are no higher than the value.
fn between<N, const C: usize>(
    nodes: &[N],
    upper: usize,
    value: f64,
    position: impl Fn(&N) -> f64,
    channels: impl Fn(&N) -> [f64; C],
) -> [f64; C] {
    if upper == 0 {
        return channels(&nodes[0]);
    }
    let a = &nodes[upper - 1];
    let Some(b) = nodes.get(upper) else { return channels(a) };
    let t = (value - position(a)) / (position(b) - position(a));
    let (ca, cb) = (channels(a), channels(b));
    std::array::from_fn(|c| ca[c] + (cb[c] - ca[c]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opacity_curve(nodes: &[(f64, f64)]) -> Result<TransferFunction> {
        let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
        TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None)
    }

    #[test]
    fn curves_are_linear_between_nodes_and_constant_beyond() {
        let tf = opacity_curve(&[(10.0, 0.2), (20.0, 0.4), (20.0, 0.8), (30.0, 1.0)]).unwrap();
        for (value, expected) in [(0.0, 0.2), (15.0, 0.3), (20.0, 0.8), (25.0, 0.9), (99.0, 1.0)] {
            assert!((tf.opacity(value) - expected).abs() < 1e-12, "{value}");
        }
        assert!((tf.opacity(20.0 - 1e-9) - 0.4).abs() < 1e-8, "a step belongs to its upper side");
    }

    #[test]
    fn one_after_another_reads_the_same_as_one_by_one() {
        let opacity = [(10.0, 0.2), (20.0, 0.4), (20.0, 0.8), (30.0, 1.0)];
        let color = [(5.0, 0.3), (19.0, 0.9), (40.0, 0.1)];
        let tf = TransferFunction::new(
            opacity.map(|(value, opacity)| OpacityNode { value, opacity }).to_vec(),
            color.map(|(value, c)| ColorNode { value, rgb: [c, 1.0 - c, 0.5] }).to_vec(),
            None,
        )
        .unwrap();
        let mut in_turn = tf.rgba_in_turn();
        let rising = (0..100).map(|i| f64::from(i) * 0.5);
        let to_and_fro = (0..100).map(|i| f64::from(i * 37 % 100) * 0.5);
        for value in rising.chain(to_and_fro) {
            let [r, g, b] = tf.color(value);
            assert_eq!(in_turn(value), [r, g, b, tf.opacity(value)], "{value}");
        }
    }

    #[test]
    fn gradient_factors_are_checked() {
        let tf = opacity_curve(&[(0.0, 0.0), (1.0, 1.0)]).unwrap();
        assert_eq!(tf.gradient_factor(7.0), 1.0);
        let with = |nodes: &[(f64, f64)]| {
            let node = |&(magnitude, factor): &(f64, f64)| GradientNode { magnitude, factor };
            tf.clone().with_gradient_opacity(nodes.iter().map(node).collect())
        };
        assert!((with(&[(2.0, 0.0), (4.0, 1.0)]).unwrap().gradient_factor(3.5) - 0.75).abs() < 1e-12);
        for bad in [[(0.0, 1.5), (1.0, 1.0)], [(-1.0, 0.0), (1.0, 1.0)], [(0.0, f64::NAN), (1.0, 1.0)]] {
            assert!(matches!(with(&bad), Err(Error::OutOfRange { .. })), "{bad:?}");
        }
        assert!(matches!(with(&[(1.0, 0.0), (0.0, 1.0)]), Err(Error::UnsortedCurve { .. })));
    }

    #[test]
    fn curves_of_two_dimensions_are_bounded_by_those_of_one() {
        let rgba = vec![[1.0, 0.0, 0.0, 0.1], [0.0, 1.0, 0.0, 0.6], [0.0, 0.0, 1.0, 0.5], [1.0, 1.0, 1.0, 0.2]];
        let joint = TransferFunction2D::new(vec![0.0, 10.0], vec![0.0, 2.0], rgba).unwrap();
        let tf = TransferFunction::two_dimensional(joint, None).unwrap();
        assert!(tf.has_gradient());
        assert!((tf.optical_depth(0.0, 2.0) + 0.5_f64.ln()).abs() < 1e-12);
        assert_eq!(tf.color_at(0.0, 1.0), [0.5, 0.0, 0.5]);
        for i in 0..=40 {
            for j in 0..=40 {
                let (value, magnitude) = (f64::from(i) * 0.25, f64::from(j) * 0.05);
                assert!(tf.optical_depth(value, magnitude) <= -(-tf.opacity(value)).ln_1p() + 1e-12);
            }
        }
    }

    #[test]
    fn bad_curves_are_refused() {
        assert!(matches!(opacity_curve(&[]), Err(Error::EmptyCurve { .. })));
        assert!(matches!(opacity_curve(&[(1.0, 0.0), (0.0, 1.0)]), Err(Error::UnsortedCurve { index: 1, .. })));
        for bad in [1.5, -0.1, f64::NAN] {
            assert!(matches!(opacity_curve(&[(0.0, bad)]), Err(Error::OutOfRange { .. })), "{bad}");
        }
        assert!(matches!(opacity_curve(&[(f64::NAN, 0.0)]), Err(Error::OutOfRange { .. })));
    }
}
