//! Two-dimensional transfer functions: colour and opacity by sample value and gradient magnitude, or by the values of
//! two fields.
//!
//! A value alone cannot distinguish the boundary of two materials from a third material of that value; with the
//! magnitude of the gradient it often can (Levoy, *Display of surfaces from volume data*, 1988; Kindlmann & Durkin
//! 1998). The table is bilinear between its nodes and constant beyond them, like a two-dimensional transfer function of
//! VTK; two nodes at the same place make a step.

use crate::error::{Error, Result};

/// A two-dimensional transfer function: validated nodes, `values` by `magnitudes`.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction2D {
    values: Vec<f64>,
    magnitudes: Vec<f64>,
    rgba: Vec<[f64; 4]>,
    is_of_fields: bool,
}

impl TransferFunction2D {
    /// Checks the nodes. `values`: sample units, `magnitudes`: sample units per world unit, both in order; `rgba`: red,
    /// green, blue and opacity per `opacity_unit`, `0..=1`, one row of values per magnitude.
    pub fn new(values: Vec<f64>, magnitudes: Vec<f64>, rgba: Vec<[f64; 4]>) -> Result<Self> {
        check_axis("magnitudes", &magnitudes, 0.0)?;
        Self::checked(values, magnitudes, rgba, false)
    }

    /// Checks the nodes of a function of two fields. `values`: in the units of the samples, `others`: in the units of
    /// the other field, both in order; `rgba` as for [`TransferFunction2D::new`], one row of values per value of the
    /// other field.
    pub fn of_fields(values: Vec<f64>, others: Vec<f64>, rgba: Vec<[f64; 4]>) -> Result<Self> {
        check_axis("magnitudes", &others, f64::NEG_INFINITY)?;
        Self::checked(values, others, rgba, true)
    }

    fn checked(values: Vec<f64>, magnitudes: Vec<f64>, rgba: Vec<[f64; 4]>, is_of_fields: bool) -> Result<Self> {
        check_axis("values", &values, f64::NEG_INFINITY)?;
        if rgba.len() != values.len() * magnitudes.len() {
            let (n_magnitudes, n_values) = (magnitudes.len(), values.len());
            let what = format!(
                "two-dimensional transfer function: {n_magnitudes} magnitudes x {n_values} values: the colours"
            );
            let mend = "give a row of colours, one per value, for every magnitude";
            return Err(Error::out_of_range(what, rgba.len(), "as many as the product", mend));
        }
        if let Some(i) = rgba.iter().position(|c| c.iter().any(|c| !(0.0..=1.0).contains(c))) {
            let (value, magnitude) = (values[i % values.len()], magnitudes[i / values.len()]);
            let what =
                format!("two-dimensional transfer function: the colour of value {value} and magnitude {magnitude}");
            let mend = "scale red, green, blue and opacity to 0..1";
            return Err(Error::out_of_range(what, format!("{:?}", rgba[i]), "between 0 and 1", mend));
        }
        Ok(Self { values, magnitudes, rgba, is_of_fields })
    }

    /// Nodes along the values.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Whether the rows are values of another field, in place of gradient magnitudes.
    pub fn is_of_fields(&self) -> bool {
        self.is_of_fields
    }

    /// Nodes along the magnitudes, or along the values of the other field.
    pub fn magnitudes(&self) -> &[f64] {
        &self.magnitudes
    }

    /// Red, green, blue and opacity of the nodes of one magnitude.
    pub fn row(&self, magnitude_idx: usize) -> &[[f64; 4]] {
        &self.rgba[magnitude_idx * self.values.len()..][..self.values.len()]
    }

    /// Red, green, blue and opacity at a value and gradient magnitude.
    pub fn rgba(&self, value: f64, magnitude: f64) -> [f64; 4] {
        let ([i0, i1], t) = between(&self.values, value);
        let ([j0, j1], s) = between(&self.magnitudes, magnitude);
        let (lower, upper) = (self.row(j0), self.row(j1));
        std::array::from_fn(|c| {
            let along = |row: &[[f64; 4]]| row[i0][c] + (row[i1][c] - row[i0][c]) * t;
            along(lower) + (along(upper) - along(lower)) * s
        })
    }
}

/// Indices of the nodes around a position, and the weight of the upper one.
fn between(nodes: &[f64], position: f64) -> ([usize; 2], f64) {
    let upper = nodes.partition_point(|n| *n <= position);
    let lower = upper.saturating_sub(1);
    if upper == 0 || upper == nodes.len() {
        return ([lower; 2], 0.0);
    }
    ([lower, upper], (position - nodes[lower]) / (nodes[upper] - nodes[lower]))
}

fn check_axis(axis: &'static str, nodes: &[f64], least: f64) -> Result<()> {
    let what = || format!("two-dimensional transfer function: {axis}");
    if nodes.is_empty() {
        return Err(Error::out_of_range(what(), 0, "at least one node", "give the nodes in order"));
    }
    if let Some(node) = nodes.iter().find(|n| !(n.is_finite() && **n >= least)) {
        let wanted = if least == 0.0 { "finite and at least 0" } else { "finite" };
        return Err(Error::out_of_range(what(), node, wanted, "a magnitude has no sign; a node is a number"));
    }
    if let Some(pair) = nodes.windows(2).find(|pair| pair[1] < pair[0]) {
        return Err(Error::out_of_range(what(), pair[1], "at least the node before it", "give the nodes in order"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(opacity: f64) -> [f64; 4] {
        [opacity, 0.5, 0.25, opacity]
    }

    #[test]
    fn bilinear_between_nodes_and_constant_beyond() {
        let rgba = [0.0, 0.2, 0.4, 0.8].map(gray).to_vec();
        let joint = TransferFunction2D::new(vec![10.0, 20.0], vec![0.0, 4.0], rgba).unwrap();
        for (value, magnitude, opacity) in [
            (10.0, 0.0, 0.0),
            (15.0, 0.0, 0.1),
            (15.0, 2.0, 0.35),
            (99.0, 4.0, 0.8),
            (0.0, 9.0, 0.4),
            (20.0, 1.0, 0.35),
        ] {
            let got = joint.rgba(value, magnitude);
            assert!((got[3] - opacity).abs() < 1e-12 && got[1] == 0.5, "{value} {magnitude}: {got:?}");
        }
    }

    #[test]
    fn steps_belong_to_their_upper_side() {
        let joint = TransferFunction2D::new(vec![1.0, 1.0], vec![0.0], [0.0, 1.0].map(gray).to_vec()).unwrap();
        assert_eq!([0.9, 1.0, 1.1].map(|v| joint.rgba(v, 3.0)[3]), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn bad_tables_are_refused() {
        let check = |values: &[f64], magnitudes: &[f64], rgba: &[f64]| {
            TransferFunction2D::new(values.to_vec(), magnitudes.to_vec(), rgba.iter().map(|o| gray(*o)).collect())
        };
        assert!(check(&[0.0, 1.0], &[0.0], &[0.0, 1.0]).is_ok());
        assert!(check(&[], &[0.0], &[]).is_err());
        assert!(check(&[1.0, 0.0], &[0.0], &[0.0, 1.0]).is_err());
        assert!(check(&[0.0, f64::NAN], &[0.0], &[0.0, 1.0]).is_err());
        assert!(check(&[0.0, 1.0], &[-1.0], &[0.0, 1.0]).is_err());
        assert!(check(&[0.0, 1.0], &[0.0], &[0.0, 1.5]).is_err());
        assert!(check(&[0.0, 1.0], &[0.0], &[0.0]).is_err());
    }

    #[test]
    fn values_of_another_field_may_be_negative() {
        let rgba = || [0.0, 0.2, 0.4, 0.8].map(gray).to_vec();
        let joint = TransferFunction2D::of_fields(vec![0.0, 1.0], vec![-2.0, 2.0], rgba()).unwrap();
        assert!(joint.is_of_fields() && (joint.rgba(1.0, 0.0)[3] - 0.5).abs() < 1e-12);
        assert!(TransferFunction2D::of_fields(vec![0.0, 1.0], vec![2.0, -2.0], rgba()).is_err());
    }
}
