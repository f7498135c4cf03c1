//! Our presets, kind by kind, in the order of their names.

use wavesplat_core::Composite;

use super::preset::{NO_LIGHT, OpacityUnit, Preset};
use crate::scale::Scale;

/// Settings of light that occludes a little, so that depth is seen, and of light for fields.
const SOLID: Option<&[(&str, f64)]> = Some(&[("ambient_occlusion", 0.3)]);
const SOFT: Option<&[(&str, f64)]> = Some(&[("ambient", 0.55), ("diffuse", 0.7), ("specular", 0.15)]);

#[rustfmt::skip]
pub(super) static PRESETS: [Preset; 25] = [
    Preset {
        name: "ct-angio",
        kind: "ct",
        description: "Vessels with contrast medium and ivory bone, opaque.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(130.0, 0.0), (160.0, 0.2), (210.0, 0.7), (400.0, 0.85), (1500.0, 0.9)],
        color: &[
            (130.0, [0.91, 0.39, 0.31]), (220.0, [0.96, 0.51, 0.39]), (320.0, [0.98, 0.67, 0.52]),
            (420.0, [0.96, 0.86, 0.71]), (700.0, [0.97, 0.91, 0.81]), (1500.0, [1.0, 0.98, 0.94]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-bone",
        kind: "ct",
        description: "Skeleton.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(110.0, 0.0), (180.0, 0.08), (280.0, 0.4), (600.0, 0.8), (1500.0, 0.9)],
        color: &[
            (110.0, [0.76, 0.46, 0.31]), (190.0, [0.87, 0.66, 0.48]), (320.0, [0.95, 0.85, 0.71]),
            (900.0, [0.98, 0.95, 0.87]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-heart",
        kind: "ct",
        description: "Heart and great vessels with contrast medium.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(90.0, 0.0), (130.0, 0.03), (180.0, 0.25), (260.0, 0.6), (400.0, 0.8), (700.0, 0.9)],
        color: &[
            (90.0, [0.88, 0.46, 0.36]), (150.0, [0.92, 0.5, 0.39]), (220.0, [0.95, 0.56, 0.43]),
            (320.0, [0.98, 0.72, 0.56]), (450.0, [0.96, 0.84, 0.68]), (900.0, [0.98, 0.96, 0.9]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-lung",
        kind: "ct",
        description: "Lungs with their vessels and airways; the body around them is left out.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(-960.0, 0.0), (-900.0, 0.006), (-820.0, 0.02), (-700.0, 0.08), (-560.0, 0.25), (-420.0, 0.2), (-300.0, 0.0)],
        color: &[
            (-930.0, [0.45, 0.62, 0.9]), (-780.0, [0.56, 0.72, 0.92]), (-660.0, [0.86, 0.7, 0.66]),
            (-500.0, [0.9, 0.46, 0.36]), (-300.0, [0.86, 0.34, 0.26]),
        ],
        gradient_opacity: &[(0.0, 1.0), (180.0, 1.0), (400.0, 0.1)],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-muscle",
        kind: "ct",
        description: "Muscles and organs; skin and fat are left out.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(-30.0, 0.0), (0.0, 0.15), (30.0, 0.6), (80.0, 0.8), (300.0, 0.9)],
        color: &[
            (-30.0, [0.89, 0.49, 0.37]), (40.0, [0.89, 0.47, 0.36]), (90.0, [0.92, 0.53, 0.4]),
            (150.0, [0.95, 0.68, 0.52]), (240.0, [0.96, 0.83, 0.67]), (800.0, [0.98, 0.95, 0.88]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-skin",
        kind: "ct",
        description: "Surface of the body.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(-550.0, 0.0), (-350.0, 0.2), (-150.0, 0.7), (50.0, 0.9), (200.0, 0.95)],
        color: &[
            (-500.0, [0.76, 0.49, 0.37]), (-300.0, [0.78, 0.52, 0.39]), (-100.0, [0.8, 0.54, 0.41]),
            (50.0, [0.78, 0.46, 0.34]), (300.0, [0.95, 0.86, 0.72]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-soft-tissue",
        kind: "ct",
        description: "Translucent skin and muscle over bone.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[
            (-600.0, 0.0), (-420.0, 0.06), (-250.0, 0.025), (-120.0, 0.006), (-30.0, 0.008), (30.0, 0.05),
            (110.0, 0.06), (150.0, 0.12), (240.0, 0.5), (500.0, 0.8), (1200.0, 0.9),
        ],
        color: &[
            (-600.0, [0.92, 0.73, 0.61]), (-150.0, [0.94, 0.75, 0.61]), (-40.0, [0.95, 0.63, 0.48]),
            (30.0, [0.89, 0.38, 0.29]), (110.0, [0.9, 0.42, 0.32]), (180.0, [0.95, 0.79, 0.62]),
            (300.0, [0.97, 0.9, 0.78]), (800.0, [0.98, 0.96, 0.9]),
        ],
        gradient_opacity: &[(5.0, 0.12), (40.0, 0.6), (110.0, 1.0)],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "ct-vessels",
        kind: "ct",
        description: "Vessels with contrast medium through translucent bone.",
        scale: Scale::Hounsfield,
        opacity_unit: OpacityUnit::World(1.0),
        opacity: &[(130.0, 0.0), (170.0, 0.06), (240.0, 0.4), (380.0, 0.5), (480.0, 0.12), (900.0, 0.16), (1500.0, 0.3)],
        color: &[
            (130.0, [0.95, 0.45, 0.37]), (240.0, [0.97, 0.54, 0.44]), (380.0, [0.99, 0.69, 0.55]),
            (480.0, [0.96, 0.88, 0.76]), (1200.0, [0.99, 0.96, 0.91]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "mr-angio",
        kind: "mr",
        description: "Vessels, MR or rotational angiography, opaque.",
        scale: Scale::Fraction,
        opacity: &[(0.34, 0.0), (0.45, 0.15), (0.58, 0.65), (0.8, 0.9)],
        color: &[
            (0.34, [0.83, 0.21, 0.14]), (0.48, [0.93, 0.34, 0.23]), (0.62, [0.97, 0.54, 0.38]),
            (0.8, [0.98, 0.8, 0.62]), (1.0, [1.0, 0.95, 0.85]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "mr-brain",
        kind: "mr",
        description: "Brain alone, T1-weighted, by a simple extraction from the head: not for measuring.",
        scale: Scale::Fraction,
        opacity: &[(0.22, 0.0), (0.32, 0.1), (0.42, 0.6), (0.6, 0.9)],
        color: &[
            (0.22, [0.74, 0.46, 0.4]), (0.35, [0.83, 0.58, 0.5]), (0.5, [0.89, 0.67, 0.59]),
            (0.75, [0.91, 0.76, 0.68]), (1.0, [0.97, 0.92, 0.87]),
        ],
        shading: SOLID,
        is_of_brain: true,
        ..NO_LIGHT
    },
    Preset {
        name: "mr-head",
        kind: "mr",
        description: "Head, T1-weighted: skin, translucent; of the brain it shows hardly more than a shimmer, which mr-brain shows.",
        scale: Scale::Fraction,
        opacity: &[(0.08, 0.0), (0.16, 0.03), (0.3, 0.1), (0.42, 0.25), (0.6, 0.55), (1.0, 0.8)],
        color: &[
            (0.08, [0.69, 0.43, 0.32]), (0.22, [0.86, 0.57, 0.43]), (0.4, [0.91, 0.69, 0.54]),
            (0.65, [0.96, 0.83, 0.7]), (1.0, [0.98, 0.95, 0.88]),
        ],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "mr-vessels",
        kind: "mr",
        description: "The brightest vessels, MR angiography, translucent where they are faint.",
        scale: Scale::Fraction,
        opacity: &[(0.42, 0.0), (0.56, 0.06), (0.7, 0.45), (1.0, 0.9)],
        color: &[(0.42, [0.91, 0.23, 0.15]), (0.56, [0.96, 0.37, 0.25]), (0.72, [0.97, 0.61, 0.44]), (1.0, [1.0, 0.93, 0.81])],
        shading: SOLID,
        ..NO_LIGHT
    },
    Preset {
        name: "pet",
        kind: "pet",
        description: "Uptake as radiology reads it: maximum projection, much is black on white.",
        scale: Scale::Maximum,
        opacity: &[(0.0, 1.0)],
        color: &[
            (0.0, [1.0, 1.0, 1.0]), (0.08, [0.86, 0.86, 0.86]), (0.25, [0.56, 0.56, 0.56]), (0.5, [0.26, 0.26, 0.26]),
            (0.8, [0.06, 0.06, 0.06]), (1.0, [0.0, 0.0, 0.0]),
        ],
        composite: Composite::Maximum,
        is_on_white: true,
        ..NO_LIGHT
    },
    Preset {
        name: "pet-hot-iron",
        kind: "pet",
        description: "Uptake in hot iron: maximum projection on black.",
        scale: Scale::Maximum,
        opacity: &[(0.0, 1.0)],
        color: &[
            (0.0, [0.0, 0.0, 0.0]), (0.05, [0.4, 0.05, 0.01]), (0.18, [0.8, 0.22, 0.02]), (0.36, [1.0, 0.5, 0.08]),
            (0.7, [1.0, 0.82, 0.36]), (1.0, [1.0, 1.0, 1.0]),
        ],
        composite: Composite::Maximum,
        ..NO_LIGHT
    },
    Preset {
        name: "confocal",
        kind: "microscopy",
        description: "Confocal and light-sheet stacks as lit bodies: nuclei, embryos, cleared tissue.",
        scale: Scale::Object,
        opacity: &[(-0.05, 0.0), (0.08, 0.04), (0.3, 0.35), (0.7, 0.8)],
        color: &[
            (-0.05, [0.1, 0.46, 0.56]), (0.15, [0.15, 0.66, 0.68]), (0.45, [0.42, 0.8, 0.64]),
            (0.75, [0.84, 0.9, 0.7]), (1.0, [0.97, 0.97, 0.9]),
        ],
        shading: Some(&[("specular", 0.15), ("ambient_occlusion", 0.3)]),
        ..NO_LIGHT
    },
    Preset {
        name: "em",
        kind: "microscopy",
        description: "Electron microscopy on white: dark stain, such as membranes, stays; what is pale is clear.",
        scale: Scale::Fraction,
        opacity: &[(0.0, 0.9), (0.3, 0.6), (0.45, 0.1), (0.65, 0.0)],
        color: &[(0.0, [0.02, 0.02, 0.04]), (0.35, [0.3, 0.3, 0.33]), (0.65, [0.85, 0.85, 0.87])],
        is_on_white: true,
        ..NO_LIGHT
    },
    Preset {
        name: "fluorescence-cyan",
        kind: "microscopy",
        description: "Fluorescence in cyan: it emits and is not lit, so what is bright shines through.",
        scale: Scale::Object,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-0.12, 0.0), (0.0, 0.008), (0.2, 0.06), (0.5, 0.22), (1.0, 0.7)],
        color: &[(-0.12, [0.105, 0.63, 0.7]), (0.25, [0.15, 0.9, 1.0]), (1.0, [0.9, 1.0, 1.0])],
        ..NO_LIGHT
    },
    Preset {
        name: "fluorescence-green",
        kind: "microscopy",
        description: "Fluorescence in green: it emits and is not lit, so what is bright shines through.",
        scale: Scale::Object,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-0.12, 0.0), (0.0, 0.008), (0.2, 0.06), (0.5, 0.22), (1.0, 0.7)],
        color: &[(-0.12, [0.14, 0.7, 0.224]), (0.25, [0.2, 1.0, 0.32]), (1.0, [0.9, 1.0, 0.9])],
        ..NO_LIGHT
    },
    Preset {
        name: "fluorescence-grey",
        kind: "microscopy",
        description: "Fluorescence in grey: it emits and is not lit, so what is bright shines through.",
        scale: Scale::Object,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-0.12, 0.0), (0.0, 0.008), (0.2, 0.06), (0.5, 0.22), (1.0, 0.7)],
        color: &[(-0.12, [0.595, 0.595, 0.595]), (0.25, [0.85, 0.85, 0.85]), (1.0, [1.0, 1.0, 1.0])],
        ..NO_LIGHT
    },
    Preset {
        name: "fluorescence-magenta",
        kind: "microscopy",
        description: "Fluorescence in magenta: it emits and is not lit, so what is bright shines through.",
        scale: Scale::Object,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-0.12, 0.0), (0.0, 0.008), (0.2, 0.06), (0.5, 0.22), (1.0, 0.7)],
        color: &[(-0.12, [0.7, 0.224, 0.7]), (0.25, [1.0, 0.32, 1.0]), (1.0, [1.0, 0.92, 1.0])],
        ..NO_LIGHT
    },
    Preset {
        name: "fluorescence-red",
        kind: "microscopy",
        description: "Fluorescence in red: it emits and is not lit, so what is bright shines through.",
        scale: Scale::Object,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-0.12, 0.0), (0.0, 0.008), (0.2, 0.06), (0.5, 0.22), (1.0, 0.7)],
        color: &[(-0.12, [0.7, 0.238, 0.182]), (0.25, [1.0, 0.34, 0.26]), (1.0, [1.0, 0.92, 0.88])],
        ..NO_LIGHT
    },
    Preset {
        name: "heat",
        kind: "simulation",
        description: "Temperature, density, speed: from red over orange to white.",
        scale: Scale::Fraction,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(0.04, 0.0), (0.15, 0.03), (0.4, 0.2), (1.0, 0.8)],
        color: &[
            (0.0, [0.8, 0.12, 0.16]), (0.12, [0.95, 0.3, 0.14]), (0.32, [1.0, 0.56, 0.18]), (0.6, [1.0, 0.84, 0.4]),
            (1.0, [1.0, 1.0, 0.88]),
        ],
        shading: SOFT,
        ..NO_LIGHT
    },
    Preset {
        name: "log",
        kind: "simulation",
        description: "Values over decades, even in the logarithm: from violet to yellow.",
        scale: Scale::Log,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(0.35, 0.0), (0.5, 0.02), (0.75, 0.2), (1.0, 0.8)],
        color: &[
            (0.0, [0.42, 0.14, 0.7]), (0.4, [0.66, 0.26, 0.76]), (0.58, [0.95, 0.36, 0.6]), (0.78, [1.0, 0.66, 0.4]),
            (1.0, [1.0, 1.0, 0.72]),
        ],
        shading: SOFT,
        ..NO_LIGHT
    },
    Preset {
        name: "signed",
        kind: "simulation",
        description: "Values of two signs: blue below 0, red above, clear near it.",
        scale: Scale::Signed,
        opacity_unit: OpacityUnit::Share(0.02),
        opacity: &[(-1.0, 0.5), (-0.7, 0.12), (-0.35, 0.01), (-0.15, 0.0), (0.15, 0.0), (0.35, 0.01), (0.7, 0.12), (1.0, 0.5)],
        color: &[
            (-1.0, [0.2, 0.48, 1.0]), (-0.3, [0.46, 0.67, 0.95]), (0.0, [0.7, 0.7, 0.7]), (0.3, [0.95, 0.63, 0.46]),
            (1.0, [1.0, 0.34, 0.2]),
        ],
        shading: SOFT,
        ..NO_LIGHT
    },
    Preset {
        name: "grey",
        kind: "any",
        description: "Grey ramp over the volume's values: maximum projection, or another one.",
        scale: Scale::Maximum,
        opacity: &[(0.0, 0.0), (0.05, 1.0)],
        color: &[(0.0, [0.0, 0.0, 0.0]), (1.0, [1.0, 1.0, 1.0])],
        composite: Composite::Maximum,
        ..NO_LIGHT
    },
];
