//! Shaders: the parts that a picture needs, and their text.
//!
//! A permutation is the text of `shaders/`, assembled: constants first, then the parts; the parts that read samples
//! come once per source. Every part names the Rust that it is the twin of.

use std::fmt::Write;

use wavesplat_core::Kernel;
use wavesplat_splat::optics::preintegrate::LEVEL;
use wavesplat_splat::ray::cut_faces;
use wavesplat_splat::ray::local_maximum::ROUNDING;
use wavesplat_splat::source::nonfinite::{MIN_KNOWN, MISSING};

use crate::layout::FIRST_TEXTURE;

/// Operator that composites or projects the sheets along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GpuOperator {
    /// Emission and absorption.
    Over {
        /// Whether slabs are pre-integrated.
        pre_integrated: bool,
    },
    /// First crossing of a density.
    FirstHit,
    /// A projection.
    Project(GpuProjection),
}

/// Projection along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GpuProjection {
    /// Greatest density.
    Maximum,
    /// Least density.
    Minimum,
    /// Greatest density, dimmed by depth.
    DepthShaded,
    /// Greatest density, dimmed by the matter in front.
    Attenuated,
    /// Integral of the density's excess over a level.
    XRay,
    /// First local maximum of the density.
    LocalMaximum,
    /// Integral of the density, or its mean.
    Integral,
}

/// Role of the gradient in a transfer function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ByGradient {
    /// Not used.
    Nothing,
    /// Gradient opacity: a factor of the optical depth.
    Factor,
    /// Colour and optical depth by density and gradient.
    Both,
}

/// Storage format of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// One byte per sample; 128 is added to signed samples.
    Byte {
        /// Whether samples are signed.
        is_signed: bool,
    },
    /// Low and high byte; 32768 is added to signed samples.
    Pair {
        /// Whether samples are signed.
        is_signed: bool,
    },
    /// f32 densities, or spline coefficients.
    Float,
    /// Four f32 fields on the same grid, side by side.
    Four,
}

/// Estimator of gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GradientTaps {
    /// No gradient is needed.
    Nothing,
    /// Central differences of reconstructed values.
    Difference,
    /// Derivatives of widened B-splines.
    Smoothed {
        /// Taps along an axis.
        n: usize,
        /// Samples from the first tap to the sample at the position.
        before: usize,
    },
}

/// Kind of a volume or field that is reconstructed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SourceKind {
    /// Reconstruction kernel.
    pub kernel: Kernel,
    /// Storage format of the samples.
    pub format: Format,
    /// Estimator of the gradient.
    pub gradient: GradientTaps,
    /// Whether there are missing samples, which are drawn as empty.
    pub has_holes: bool,
}

/// Kind of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LayerKind {
    /// Whether the layer is shaded.
    pub is_shaded: bool,
    /// Whether its cut faces have even light.
    pub evens_cuts: bool,
    /// Role of the gradient in the transfer function.
    pub by_gradient: ByGradient,
}

/// Fields of a scene, by their index among the sources of fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FieldKinds {
    /// Ambient occlusion.
    pub openness: Option<usize>,
    /// Shadow of the first light.
    pub shadow: Option<usize>,
    /// Share of the scan's optical depth that labels leave.
    pub scan: Option<usize>,
    /// Tint by labels.
    pub tint: Option<usize>,
    /// The label medium.
    pub medium: Option<usize>,
    /// Whether the label medium is shaded.
    pub label_medium_is_shaded: bool,
}

impl FieldKinds {
    fn any(&self) -> bool {
        [self.openness, self.shadow, self.scan, self.tint, self.medium].iter().any(Option::is_some)
    }
}

/// Kind of a picture as far as its shader depends on it: key of the pipeline cache.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Permutation {
    /// Operator along the rays.
    pub operator: GpuOperator,
    /// Kind of each layer.
    pub layers: Vec<LayerKind>,
    /// Kind of each source: volumes, then fields.
    pub sources: Vec<SourceKind>,
    /// Fields of the scene.
    pub fields: FieldKinds,
    /// Whether four samples are fetched at once, where the device does it right.
    pub gather: bool,
    /// Whether the position of opacity 1/2, of the surface or of the extreme is recorded.
    pub with_depth: bool,
    /// Whether fetches and texels are counted.
    pub counted: bool,
}

const KERNELS: [(&str, Kernel); 5] = [
    ("LINEAR", Kernel::Linear),
    ("CATMULL_ROM", Kernel::CatmullRom),
    ("BSPLINE2", Kernel::Bspline2),
    ("BSPLINE3", Kernel::Bspline3),
    ("GAUSSIAN", Kernel::Gaussian),
];

const PROJECTIONS: [(&str, GpuProjection); 7] = [
    ("MAXIMUM", GpuProjection::Maximum),
    ("MINIMUM", GpuProjection::Minimum),
    ("DEPTH_SHADED", GpuProjection::DepthShaded),
    ("ATTENUATED", GpuProjection::Attenuated),
    ("X_RAY", GpuProjection::XRay),
    ("LOCAL_MAXIMUM", GpuProjection::LocalMaximum),
    ("INTEGRAL", GpuProjection::Integral),
];

impl Permutation {
    /// Number of vec4s of a ray's state.
    pub fn n_state(&self) -> usize {
        1 + usize::from(self.with_depth || self.counted || self.evens_cuts())
    }

    /// Whether cut faces have even light, so that rays have an entry.
    fn evens_cuts(&self) -> bool {
        matches!(self.operator, GpuOperator::Over { .. }) && self.layers.iter().any(|layer| layer.evens_cuts)
    }

    /// Binding of the samples of a source.
    pub fn samples_binding(source: usize) -> u32 {
        FIRST_TEXTURE + source as u32
    }

    /// Binding of the holes of a source.
    pub fn holes_binding(&self, source: usize) -> u32 {
        FIRST_TEXTURE + (self.sources.len() + source) as u32
    }

    /// Text of the shader.
    pub fn text(&self) -> String {
        self.functions() + include_str!("shaders/march.wgsl")
    }

    fn functions(&self) -> String {
        let mut text = self.constants();
        text.push_str(include_str!("shaders/frame.wgsl"));
        text.push_str(include_str!("shaders/axes.wgsl"));
        text.push_str(include_str!("shaders/kernel.wgsl"));
        text.push_str(include_str!("shaders/known.wgsl"));
        for (k, source) in self.sources.iter().enumerate() {
            text.push_str(&source_constants(k, source));
            let mut parts = include_str!("shaders/samples.wgsl").to_owned();
            if source.has_holes {
                parts.push_str(include_str!("shaders/holes.wgsl"));
            } else {
                parts.push_str("fn missing_SOURCE(place: Place) -> f32 { return 0.0f; }\n");
            }
            parts.push_str(include_str!("shaders/reconstruct.wgsl"));
            if source.format == Format::Four {
                parts.push_str(include_str!("shaders/four.wgsl"));
            }
            let parts = parts
                .replace("MASK_BINDING_SOURCE", &self.holes_binding(k).to_string())
                .replace("BINDING_SOURCE", &Self::samples_binding(k).to_string());
            text.push_str(
                &parts
                    .replace("sources[SOURCE]", &format!("sources[{k}]"))
                    .replace("SOURCE < N", &format!("{k}u < N"))
                    .replace("SOURCE", &k.to_string()),
            );
        }
        for part in [
            include_str!("shaders/slabs.wgsl"),
            include_str!("shaders/rays.wgsl"),
            include_str!("shaders/classify.wgsl"),
            include_str!("shaders/preintegrate.wgsl"),
            include_str!("shaders/shade.wgsl"),
            include_str!("shaders/cut_faces.wgsl"),
            include_str!("shaders/gradient_opacity.wgsl"),
            include_str!("shaders/accumulate.wgsl"),
        ] {
            text.push_str(part);
        }
        match self.operator {
            GpuOperator::Over { .. } => {
                text.push_str(include_str!("shaders/light.wgsl"));
                text.push_str(&self.fields_text());
                if self.layers.len() > 1 {
                    text.push_str(&self.layers_text());
                } else {
                    text.push_str(include_str!("shaders/over.wgsl"));
                }
            }
            GpuOperator::FirstHit => text.push_str(include_str!("shaders/first_hit.wgsl")),
            GpuOperator::Project(_) => text.push_str(include_str!("shaders/project.wgsl")),
        }
        text
    }

    /// All functions of the shader with an entry point of the caller's, `stage`.
    pub fn stage_text(&self, entry: &str) -> String {
        self.functions() + entry
    }

    fn constants(&self) -> String {
        let mut text = String::new();
        let mut add = |name: &str, kind: &str, value: &dyn std::fmt::Display| {
            let _ = writeln!(text, "const {name}: {kind} = {value};");
        };
        add("N_LAYERS", "u32", &format!("{}u", self.layers.len()));
        add("N_SOURCES", "u32", &format!("{}u", self.sources.len()));
        add("N_STATE", "u32", &format!("{}u", self.n_state()));
        add("GATHER", "bool", &self.gather);
        add("COUNTED", "bool", &self.counted);
        for (k, (name, _)) in KERNELS.iter().enumerate() {
            add(&format!("KERNEL_{name}"), "u32", &format!("{k}u"));
        }
        for (k, name) in ["FORMAT_BYTE", "FORMAT_PAIR", "FORMAT_FLOAT"].iter().enumerate() {
            add(name, "u32", &format!("{k}u"));
        }
        for (k, name) in ["GRADIENT_NONE", "GRADIENT_DIFFERENCE", "GRADIENT_SMOOTHED"].iter().enumerate() {
            add(name, "u32", &format!("{k}u"));
        }
        for (k, name) in ["BY_NOTHING", "BY_FACTOR", "BY_BOTH"].iter().enumerate() {
            add(name, "u32", &format!("{k}u"));
        }
        for (k, (name, _)) in PROJECTIONS.iter().enumerate() {
            add(name, "u32", &format!("{k}u"));
        }
        add("LEVEL", "f32", &format!("{LEVEL:?}f"));
        add("MISSING", "f32", &format!("{MISSING:?}f"));
        add("MIN_KNOWN", "f32", &format!("{MIN_KNOWN:?}f"));
        add("EVENS_CUTS", "bool", &self.evens_cuts());
        add("EVEN_REACH", "f32", &format!("{:?}f", cut_faces::REACH));
        add("EVEN_PER_SLICE", "f32", &format!("{:?}f", cut_faces::PER_SLICE));
        add("CUT_DEPTH", "f32", &format!("{:?}f", cut_faces::DEPTH));
        add("NEAR_CUT", "f32", &format!("{:?}f", cut_faces::NEAR));
        add("NO_ENTRY", "f32", &format!("{:?}f", cut_faces::NO_ENTRY));
        add("ROUNDING", "f32", &format!("{ROUNDING:?}f"));
        for (k, layer) in self.layers.iter().enumerate() {
            add(&format!("IS_SHADED_{k}"), "bool", &layer.is_shaded);
            add(&format!("BY_GRADIENT_{k}"), "u32", &format!("{}u", layer.by_gradient as u32));
            // Occlusion and shadow dim the first layer, and of the others only those that are shaded.
            let has_light = k == 0 || layer.is_shaded;
            add(&format!("HAS_LIGHT_{k}"), "bool", &has_light);
            let is_lit = has_light && (self.fields.openness.is_some() || self.fields.shadow.is_some());
            add(&format!("HAS_FIELDS_{k}"), "bool", &(is_lit || (k == 0 && self.fields.any())));
        }
        let is_pre_integrated = matches!(self.operator, GpuOperator::Over { pre_integrated: true });
        add("PRE_INTEGRATED", "bool", &is_pre_integrated);
        let mut first_value = "0.0f";
        if let GpuOperator::Project(projection) = self.operator {
            let number = PROJECTIONS.iter().position(|(_, own)| *own == projection).unwrap_or_default();
            add("PROJECTION", "u32", &format!("{number}u"));
            first_value = match projection {
                GpuProjection::Maximum
                | GpuProjection::DepthShaded
                | GpuProjection::Attenuated
                | GpuProjection::LocalMaximum => "-3.0e38f",
                GpuProjection::Minimum => "3.0e38f",
                GpuProjection::XRay | GpuProjection::Integral => "0.0f",
            };
        }
        add("FIRST_VALUE", "f32", &first_value);
        let fields = &self.fields;
        add("HAS_FIELDS", "bool", &fields.any());
        add("HAS_SCAN", "bool", &fields.scan.is_some());
        add("HAS_TINT", "bool", &fields.tint.is_some());
        add("HAS_LABEL_MEDIUM", "bool", &fields.medium.is_some());
        add("LABEL_MEDIUM_SHADED", "bool", &fields.label_medium_is_shaded);
        text
    }

    /// WGSL of `fields_at`, the fields at a texel of a sheet, and of `label_medium_gradient`, the label medium's
    /// gradient.
    fn fields_text(&self) -> String {
        let first = self.layers.len();
        let mut text = String::from(
            "fn fields_at(texel: vec2<u32>, sheet: u32) -> FieldValues {\n    var fields: FieldValues;\n    \
             fields.openness = 1.0f;\n    fields.shadow = 1.0f;\n    fields.scan = 1.0f;\n",
        );
        let fields = &self.fields;
        for (name, field) in [("openness", fields.openness), ("shadow", fields.shadow), ("scan", fields.scan)] {
            if let Some(field) = field {
                let k = first + field;
                let _ = writeln!(text, "    fields.{name} = value_{k}(place_{k}(texel, sheet), vec3<f32>(0.0f));");
            }
        }
        for (name, field) in [("tint", fields.tint), ("medium", fields.medium)] {
            if let Some(field) = field {
                let k = first + field;
                let _ = writeln!(text, "    let place_of_{name} = place_{k}(texel, sheet);");
                let _ = writeln!(text, "    fields.{name} = four_{k}(place_of_{name});");
            }
        }
        text.push_str("    return fields;\n}\n");
        let gradient = match fields.medium.filter(|_| fields.label_medium_is_shaded) {
            Some(field) => format!("gradient_{k}(place_{k}(texel, sheet))", k = first + field),
            None => "vec3<f32>(0.0f)".to_owned(),
        };
        let _ = writeln!(
            text,
            "fn label_medium_gradient(texel: vec2<u32>, sheet: u32) -> vec3<f32> {{ return {gradient}; }}"
        );
        text
    }

    /// WGSL of several layers: `layer.wgsl` once per layer, then `over_layers.wgsl`, which calls it.
    fn layers_text(&self) -> String {
        let mut text = String::new();
        let [mut sheets, mut slabs] = [String::new(), String::new()];
        for k in 0..self.layers.len() {
            text.push_str(
                &include_str!("shaders/layer.wgsl")
                    .replace("IS_FIRST_LAYER", "IS_FIRST")
                    .replace("LAYER", &k.to_string())
                    .replace("IS_FIRST", if k == 0 { "true" } else { "false" }),
            );
            let _ = writeln!(sheets, "    any = add_sheet_{k}(ray, block, sheet, ends, begin, end, &sum) || any;");
            let _ = writeln!(slabs, "    add_slab_{k}(ray, block, slab, &mixture);");
        }
        let all = include_str!("shaders/over_layers.wgsl");
        // WGSL takes declarations in any order: the layers use functions of the shared part behind them.
        let shared = all.replace("    ADD_SHEETS\n", &sheets).replace("    ADD_SLABS\n", &slabs);
        text + &shared
    }
}

/// Constants of the `k`th source.
fn source_constants(k: usize, source: &SourceKind) -> String {
    let mut text = String::new();
    let mut add = |name: &str, kind: &str, value: &dyn std::fmt::Display| {
        let _ = writeln!(text, "const {name}_{k}: {kind} = {value};");
    };
    let kernel = KERNELS.iter().position(|(_, own)| *own == source.kernel).unwrap_or_default();
    add("KERNEL", "u32", &format!("{kernel}u"));
    let (format, bias) = match source.format {
        Format::Byte { is_signed } => (0, if is_signed { "128.0f" } else { "0.0f" }),
        Format::Pair { is_signed } => (1, if is_signed { "32768.0f" } else { "0.0f" }),
        Format::Float | Format::Four => (2, "0.0f"),
    };
    add("FORMAT", "u32", &format!("{format}u"));
    add("HAS_HOLES", "bool", &source.has_holes);
    add("BIAS", "f32", &bias);
    let (gradient, n, before) = match source.gradient {
        GradientTaps::Nothing => (0, 0, 0),
        GradientTaps::Difference => (1, 0, 0),
        GradientTaps::Smoothed { n, before } => (2, n, before),
    };
    add("GRADIENT", "u32", &format!("{gradient}u"));
    add("N_SMOOTHED", "i32", &n);
    add("BEFORE", "i32", &before);
    text
}
