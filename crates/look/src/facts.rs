//! Kinds of data, and the facts of a file that they depend on.

use crate::hounsfield::{looks_like_hounsfield, stored_offset};
use crate::statistics::extremes;

/// Kinds of data of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each variant is named after its kind of data")]
pub enum DataKind {
    Ct,
    Mr,
    Pet,
    Dose,
    Ultrasound,
    Fluorescence,
    Em,
    Fa,
    Probability,
    Map,
    PValues,
    SignedField,
    Field,
    Mask,
    Labels,
    Scan,
}

impl DataKind {
    /// All kinds.
    pub const ALL: [Self; 16] = [
        Self::Ct,
        Self::Mr,
        Self::Pet,
        Self::Dose,
        Self::Ultrasound,
        Self::Fluorescence,
        Self::Em,
        Self::Fa,
        Self::Probability,
        Self::Map,
        Self::PValues,
        Self::SignedField,
        Self::Field,
        Self::Mask,
        Self::Labels,
        Self::Scan,
    ];

    /// The name in reports and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ct => "CT",
            Self::Mr => "MR",
            Self::Pet => "PET",
            Self::Dose => "dose",
            Self::Ultrasound => "ultrasound",
            Self::Fluorescence => "fluorescence",
            Self::Em => "EM",
            Self::Fa => "FA",
            Self::Probability => "probability",
            Self::Map => "map",
            Self::PValues => "p-values",
            Self::SignedField => "signed field",
            Self::Field => "field",
            Self::Mask => "mask",
            Self::Labels => "labels",
            Self::Scan => "scan",
        }
    }
}

/// DICOM's modalities of the kinds that have a look of their own. Angiography is X-ray: bright vessels, no fixed scale.
pub const MODALITIES: [(&str, DataKind); 8] = [
    ("MR", DataKind::Mr),
    ("PT", DataKind::Pet),
    ("NM", DataKind::Pet),
    ("RTDOSE", DataKind::Dose),
    ("US", DataKind::Ultrasound),
    ("IVUS", DataKind::Ultrasound),
    ("fluorescence", DataKind::Fluorescence),
    ("EM", DataKind::Em),
];

/// Types of samples: whole numbers without a sign, with one, and floating-point numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "each variant is named after its type of numbers")]
pub enum NumberType {
    #[default]
    Unsigned,
    Signed,
    Float,
}

/// Facts of a file that the kind of its data depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact of a file")]
pub struct KindFacts<'a> {
    /// Name of the volume, of whose words some name what it holds.
    pub name: &'a str,
    /// The file's modality, as DICOM names it.
    pub modality: Option<&'a str>,
    /// Unit of the values.
    pub value_unit: Option<&'a str>,
    /// Quantity of a calculated map, see [`quantities`](crate::quantities).
    pub quantity: Option<&'a str>,
    /// Whether the samples are the lengths of vectors.
    pub is_lengths: bool,
    /// Whether the file names channels of a microscope.
    pub has_channel: bool,
    /// Whether the axes are a patient's.
    pub is_anatomical: bool,
    /// Whether samples are of coefficients of wavelets, which round.
    pub is_of_wavelets: bool,
    /// Whether the place is one that nobody measured: axis-aligned, from the first sample or its middle.
    pub is_placed_by_default: bool,
    /// Whether the header names a patient's axes by its format's default alone.
    pub has_no_place: bool,
    /// Metres of the unit of length.
    pub metres: Option<f64>,
    /// Distances between samples along x, y and z, in units of length.
    pub spacing: [f64; 3],
    /// Smallest and largest finite sample.
    pub range: (f64, f64),
    /// Type of the samples.
    pub numbers: NumberType,
    /// Whether samples are floating-point numbers of 32 bits.
    pub is_single: bool,
}

impl KindFacts<'_> {
    /// A number as samples hold it.
    pub(crate) fn as_sample(&self, value: f64) -> f64 {
        if self.is_single { f64::from(value as f32) } else { value }
    }

    pub(crate) fn least_spacing(&self) -> f64 {
        extremes(&self.spacing).0
    }

    /// Whether samples are as close together as a microscope's, whatever unit the file has.
    pub(crate) fn is_fine(&self) -> bool {
        self.metres.is_some_and(|metres| self.least_spacing() * metres < FINE_METRES)
    }

    /// Whether the values look like Hounsfield units.
    pub(crate) fn is_hounsfield(&self, values: &[f64]) -> bool {
        looks_like_hounsfield(values, self.modality == Some("CT"), self.is_anatomical || self.is_of_wavelets)
    }

    /// The offset that seems to be added to the Hounsfield units of a CT, 1000 or 1024; 0 for other volumes.
    pub fn offset(&self, values: &[f64]) -> f64 {
        let may_be = self.modality == Some("CT") || (self.modality.is_none() && self.is_anatomical);
        if may_be { stored_offset(values) } else { 0.0 }
    }
}

/// A kind and its reason.
pub(crate) type Reasoned = (DataKind, String);

/// Distance of samples of a microscope at most, metres.
const FINE_METRES: f64 = 1e-4;
