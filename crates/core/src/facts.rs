//! Facts that a file states about a volume: of its unit, its patient, and its values.

/// Facts that a file states about a volume; each may be left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Name of the volume or of its file, of whose words some name what it holds, such as "labels".
    pub name: String,
    /// Unit of the world's axes: "mm", "um", or the name of another.
    pub unit: Option<String>,
    /// Whether the world's axes are a patient's: x to the right, y to the front, z up (RAS).
    pub is_anatomical: bool,
    /// The modality in DICOM's codes ("CT", "MR", "PT", ...), or "fluorescence" or "EM". It is never guessed from values.
    pub modality: Option<String>,
    /// Unit of the samples' values, such as "HU".
    pub value_unit: Option<String>,
    /// Name of the values, such as "temperature".
    pub quantity: Option<String>,
    /// Values that the file wants shown in black and in white.
    pub window: Option<[f64; 2]>,
    /// Whether the file wants the lowest values shown in white.
    pub is_inverted: bool,
    /// Values that the file leaves out and its format's conventions give, a sentence each.
    pub conventions: Vec<String>,
    /// Assumptions where the file says nothing, and why, a sentence each.
    pub guesses: Vec<String>,
}
