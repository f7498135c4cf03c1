//! Shaders without a device: every permutation is valid, and can be written for Vulkan, Metal, DX12 and OpenGL; structs
//! have the layout of Rust's; and the text keeps to features that all devices implement alike.

use std::collections::HashMap;
use std::mem::{offset_of, size_of};

use naga::back::spv;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, TypeInner};
use wavesplat_core::Kernel;
use wavesplat_gpu::layout::{GpuFrame, GpuLayer, GpuLighting, GpuSource};
use wavesplat_gpu::permutation::{
    ByGradient, FieldKinds, Format, GpuOperator, GpuProjection, GradientTaps, LayerKind, Permutation, SourceKind,
};

const PLAIN: SourceKind = SourceKind {
    kernel: Kernel::Linear,
    format: Format::Byte { is_signed: false },
    gradient: GradientTaps::Nothing,
    has_holes: false,
};

const SMOOTHED: GradientTaps = GradientTaps::Smoothed { n: 6, before: 2 };

fn permutation(operator: GpuOperator, sources: Vec<SourceKind>) -> Permutation {
    Permutation {
        operator,
        layers: vec![LayerKind { is_shaded: false, evens_cuts: false, by_gradient: ByGradient::Nothing }],
        sources,
        fields: FieldKinds::default(),
        gather: true,
        with_depth: false,
        counted: false,
    }
}

/// Permutations with every value of every choice, each beside default values; and some with all of them at once.
fn permutations() -> Vec<Permutation> {
    let over = |pre_integrated| GpuOperator::Over { pre_integrated };
    let lit = SourceKind { gradient: SMOOTHED, ..PLAIN };
    let mut all = Vec::new();
    let mut operators = vec![over(false), over(true), GpuOperator::FirstHit];
    operators.extend(
        [
            GpuProjection::Maximum,
            GpuProjection::Minimum,
            GpuProjection::DepthShaded,
            GpuProjection::XRay,
            GpuProjection::LocalMaximum,
            GpuProjection::Integral,
        ]
        .map(GpuOperator::Project),
    );
    for operator in operators {
        for gather in [false, true] {
            for with_depth in [false, true] {
                let counted = gather && with_depth;
                all.push(Permutation { gather, with_depth, counted, ..permutation(operator, vec![PLAIN]) });
            }
        }
        let holes = SourceKind { has_holes: true, format: Format::Float, ..PLAIN };
        all.push(permutation(operator, vec![holes]));
    }
    let kernels = Kernel::NAMES.map(|(_, kernel)| kernel);
    let formats =
        [Format::Byte { is_signed: true }, Format::Pair { is_signed: false }, Format::Pair { is_signed: true }];
    for steep in [false, true] {
        for kernel in kernels {
            for gradient in [GradientTaps::Difference, SMOOTHED] {
                for by_gradient in [ByGradient::Nothing, ByGradient::Factor, ByGradient::Both] {
                    let layers = vec![LayerKind { is_shaded: true, evens_cuts: true, by_gradient }];
                    let source = SourceKind { kernel, gradient, has_holes: kernel == Kernel::CatmullRom, ..PLAIN };
                    all.push(Permutation { layers, ..permutation(over(steep), vec![source]) });
                }
            }
        }
        for format in formats {
            all.push(permutation(over(steep), vec![SourceKind { format, ..lit }]));
        }
        let field = SourceKind { format: Format::Float, ..PLAIN };
        let four = SourceKind { format: Format::Four, ..PLAIN };
        let of_matter = SourceKind { gradient: GradientTaps::Difference, kernel: Kernel::Gaussian, ..four };
        let fields = FieldKinds {
            openness: Some(0),
            shadow: Some(1),
            scan: Some(2),
            tint: Some(3),
            medium: Some(4),
            label_medium_is_shaded: true,
        };
        for n_layers in [1, 2, 3] {
            let mut sources = vec![lit; n_layers];
            sources.extend([field; 3]);
            sources.extend([four, of_matter]);
            let layers = (0..n_layers).map(|k| LayerKind {
                is_shaded: k != 1,
                evens_cuts: k == 0,
                by_gradient: [ByGradient::Factor, ByGradient::Both, ByGradient::Nothing][k],
            });
            let layers = layers.collect();
            all.push(Permutation { layers, fields, with_depth: true, ..permutation(over(steep), sources) });
        }
    }
    all
}

fn parsed(text: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    (module, info)
}

#[test]
fn all_are_valid_and_written_for_vulkan() {
    let all = permutations();
    assert!(all.len() > 100, "{}", all.len());
    for permutation in &all {
        let (module, info) = parsed(&permutation.text());
        let words = spv::write_vec(&module, &info, &spv::Options::default(), None).unwrap();
        assert!(words.len() > 1000);
    }
}

/// `make shaders` runs this, since the writers would make a second build of wgpu.
#[cfg(feature = "translations")]
#[test]
fn all_are_written_for_metal_dx12_and_opengl() {
    use naga::back::{glsl, hlsl, msl};

    for permutation in &permutations() {
        let (module, info) = parsed(&permutation.text());
        let bindings = msl::Options { fake_missing_bindings: true, ..msl::Options::default() };
        let (text, _) = msl::write_string(&module, &info, &bindings, &msl::PipelineOptions::default()).unwrap();
        assert!(text.contains("march"));
        let options = hlsl::Options { fake_missing_bindings: true, ..hlsl::Options::default() };
        let (mut text, pipeline) = (String::new(), hlsl::PipelineOptions::default());
        hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None).unwrap();
        assert!(text.contains("march"));
        let options = glsl::Options { version: glsl::Version::Desktop(450), ..glsl::Options::default() };
        let entry = glsl::PipelineOptions {
            shader_stage: naga::ShaderStage::Compute,
            entry_point: "march".to_owned(),
            multiview: None,
        };
        let mut text = String::new();
        let writer =
            glsl::Writer::new(&mut text, &module, &info, &options, &entry, naga::proc::BoundsCheckPolicies::default());
        writer.unwrap().write().unwrap();
        assert!(text.contains("void main"));
    }
}

#[test]
fn the_self_test_is_valid_for_every_format() {
    for format in [Format::Byte { is_signed: false }, Format::Pair { is_signed: true }, Format::Float] {
        for gather in [false, true] {
            let source = SourceKind { format, ..PLAIN };
            let permutation = Permutation { gather, ..permutation(GpuOperator::FirstHit, vec![source]) };
            parsed(&permutation.stage_text(include_str!("../src/shaders/probe.wgsl")));
        }
    }
}

/// Offsets of the members of a shader's struct, and its size.
fn members(module: &Module, name: &str) -> (HashMap<String, u32>, u32) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, ty) = found.unwrap_or_else(|| panic!("no {name}"));
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no struct") };
    (members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect(), *span)
}

macro_rules! lies_alike {
    ($module:expr, $name:literal, $own:ty, [$($field:ident),*]) => {
        let (members, span) = members($module, $name);
        let own: &[(&str, usize)] = &[$((stringify!($field), offset_of!($own, $field))),*];
        assert_eq!(members.len(), own.len(), "fields of {}", $name);
        for (field, offset) in own {
            assert_eq!(members[*field] as usize, *offset, "{}.{field}", $name);
        }
        assert_eq!(span as usize, size_of::<$own>(), "{}", $name);
    };
}

#[test]
fn structs_lie_as_rust_lays_them_out() {
    let (module, _) = parsed(&permutations()[0].text());
    lies_alike!(&module, "Lighting", GpuLighting, [coefficients, limits, metric, lights]);
    lies_alike!(
        &module,
        "Layer",
        GpuLayer,
        [tables, domain, visible, only, joint_size, joint, joint_metric, to_eye, lighting]
    );
    lies_alike!(&module, "Source", GpuSource, [place, last, apron, texel, pages]);
    lies_alike!(&module, "Frame", GpuFrame, [blocks, slabs, axes, number, color, to_next, fade, light, label_lighting]);
}

/// Drivers differ in the features listed here; the study of GPUs has the reasons.
#[test]
fn the_text_keeps_to_what_every_device_does_alike() {
    for permutation in permutations() {
        let text = permutation.text();
        let code: String =
            text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect();
        for word in [
            "enable ",
            "requires ",
            "textureSample",
            "atomic",
            "subgroup",
            "workgroupBarrier",
            "discard",
            "12582912",
            "8388608",
            " inf",
            " nan",
            "f16",
        ] {
            assert!(!code.contains(word), "{word:?}");
        }
        let n_storage = code.matches("var<storage").count();
        assert!(n_storage <= 8, "{n_storage} storage buffers");
        assert!(code.contains("@workgroup_size(16, 8)") && 16 * 8 <= 256);
        // A gather takes no offset: some drivers take it from the wrong place.
        for call in code.split("textureGather(").skip(1) {
            let arguments = call.split(')').next().unwrap_or_default().matches(',').count();
            assert_eq!(arguments, 4, "component, texture, sampler, place, layer: {call:.60}");
        }
        let (module, _) = parsed(&text);
        for (_, function) in module.functions.iter() {
            for (_, expression) in function.expressions.iter() {
                // An index that is not known in advance puts a local array into memory, or is refused.
                if let naga::Expression::Access { base, .. } = expression {
                    let of_local = matches!(function.expressions[*base], naga::Expression::LocalVariable(_));
                    assert!(!of_local, "{:?} of {:?}", expression, function.name);
                }
            }
        }
    }
}

/// Each shader names the Rust file that it is the twin of, and that file exists.
#[test]
fn shaders_name_their_twins() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/shaders");
    let mut n = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let head: String =
            text.lines().take_while(|line| line.starts_with("//")).map(|line| line[2..].to_owned()).collect();
        let twin = head.split([' ', '(', ')', ',', '`', ';']).find(|word| word.contains(".rs"));
        let twin = twin.unwrap_or_else(|| panic!("{path:?} names no twin")).trim_end_matches('.');
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let places = [root.join("../..").join(twin), root.join("src").join(twin)];
        assert!(places.iter().any(|place| place.exists()), "{path:?} names {twin}");
        n += 1;
    }
    assert!(n >= 15);
}
