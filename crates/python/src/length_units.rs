//! Units of length; see `_native.pyi`.

use pyo3::prelude::*;
use wavesplat::files::length_units;

use crate::arguments::Text;

/// Units of axes x, y and z.
type UnitsXyz = (Option<String>, Option<String>, Option<String>);

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands texts over by value")]
pub fn unit_name(text: Text) -> Option<String> {
    length_units::canonical(&text.0)
}

#[pyfunction]
#[pyo3(signature = (unit))]
pub fn unit_metres(unit: Option<&str>) -> Option<f64> {
    length_units::metres(unit?)
}

#[pyfunction]
pub fn reported_unit(unit: &str) -> &str {
    length_units::reported(unit)
}

#[pyfunction]
#[pyo3(signature = (own, wanted))]
pub fn unit_factor(own: Option<&str>, wanted: Option<&str>) -> Option<f64> {
    length_units::factor(own, wanted)
}

#[pyfunction]
pub fn in_one_unit(units: UnitsXyz) -> (Option<String>, (f64, f64, f64)) {
    let (unit, factors) = length_units::in_one_unit(&units.into());
    (unit, factors.into())
}

#[pyfunction]
pub fn unit_guesses(units: UnitsXyz) -> Vec<String> {
    length_units::guesses(&units.into())
}
