//! Windows of CT by name, from the table of radiopaedia.org/articles/windowing-ct.
//!
//! The middle of the range is taken where that table gives one; the window of angiography is of everyday use.

/// Names of windows, and their level and width, Hounsfield units: black is level - width / 2, white level + width / 2.
pub const CT_WINDOWS: [(&str, [f64; 2]); 12] = [
    ("abdomen", [50.0, 400.0]),
    ("angio", [300.0, 600.0]),
    ("bone", [400.0, 1800.0]),
    ("brain", [40.0, 80.0]),
    ("liver", [30.0, 150.0]),
    ("lung", [-600.0, 1500.0]),
    ("mediastinum", [50.0, 350.0]),
    ("soft-tissue", [40.0, 375.0]),
    ("spine", [50.0, 250.0]),
    ("stroke", [40.0, 40.0]),
    ("subdural", [75.0, 215.0]),
    ("temporal-bone", [600.0, 2800.0]),
];
