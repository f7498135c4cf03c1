//! The stage fixtures of `crates/splat/fixtures`, by the functions of the shaders: answers from formulas, to 1e-5
//! relative. `docs/design/012-stage-fixtures.md` describes the format.

mod scenes;

use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec2, DVec3};
use scenes::gpu;
use serde_json::Value;
use wavesplat_compute::simd::{LANES, Level};
use wavesplat_core::{
    Camera, ColorNode, Composite, Crop, Gradient, Kernel, Light, LightFrame, OpacityNode, Projection, RenderOptions,
    Shading, TransferFunction,
};
use wavesplat_gpu::Gpu;
use wavesplat_gpu::layout::{GpuFrame, GpuLayer, GpuSource};
use wavesplat_gpu::numbers::Numbers;
use wavesplat_gpu::permutation::{
    ByGradient, FieldKinds, Format, GpuOperator, GradientTaps, LayerKind, Permutation, SourceKind,
};
use wavesplat_splat::Layer;
use wavesplat_splat::optics::classify::Classifier;
use wavesplat_splat::optics::shade::Shader;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::{Operator, Plan};
use wavesplat_splat::source::geometry::SheetGeometry;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::{Family, IndexRays};
use wavesplat_splat::view::index_frame::world_gradient_from_index;
use wavesplat_testkit::Phantom;

/// A case of a fixture.
struct Case {
    name: String,
    inputs: Value,
    outputs: Value,
}

/// Answers of a case by name.
type Answers = Vec<(&'static str, Vec<f32>)>;

impl Case {
    fn numbers(&self, name: &str) -> Vec<f64> {
        let array = self.inputs[name].as_array().unwrap_or_else(|| panic!("{name} of {}", self.name));
        array.iter().map(|x| x.as_f64().unwrap()).collect()
    }

    fn floats(&self, name: &str) -> Vec<f32> {
        self.numbers(name).into_iter().map(|x| x as f32).collect()
    }

    fn number(&self, name: &str) -> f64 {
        self.inputs[name].as_f64().unwrap_or_else(|| panic!("{name} of {}", self.name))
    }

    fn array<const N: usize>(&self, name: &str) -> [f64; N] {
        self.numbers(name).try_into().unwrap()
    }

    fn text(&self, name: &str) -> &str {
        self.inputs[name].as_str().unwrap()
    }
}

/// Compares the results of a stage with the answers of its fixture.
fn check(stage: &str, run: impl Fn(&Gpu, &Case) -> Answers) {
    let Some(gpu) = gpu() else { return };
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../splat/fixtures/{stage}.json"));
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let [relative, absolute] = ["relative", "absolute"].map(|name| file["tolerance"][name].as_f64().unwrap());
    let (mut n, mut wrong) = (0, Vec::new());
    for case in file["cases"].as_array().unwrap() {
        let case = Case {
            name: case["name"].as_str().unwrap().to_owned(),
            inputs: case["in"].clone(),
            outputs: case["out"].clone(),
        };
        for (name, got) in run(gpu, &case) {
            let want = case.outputs[name].as_array().unwrap();
            assert_eq!(got.len(), want.len(), "{name} of {}", case.name);
            for (i, (got, want)) in got.iter().zip(want).enumerate() {
                let (got, want) = (f64::from(*got), want.as_f64().unwrap_or(f64::NAN));
                let is_near = (got - want).abs() <= absolute + relative * want.abs() || (got.is_nan() && want.is_nan());
                n += 1;
                if !is_near {
                    wrong.push(format!("{stage}, {}: {name}[{i}] is {got}, not {want}", case.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {n} answers:\n{}", wrong.len(), wrong[..wrong.len().min(20)].join("\n"));
    assert!(n > 0);
}

fn permutation(source: SourceKind) -> Permutation {
    Permutation {
        operator: GpuOperator::Over { pre_integrated: true },
        layers: vec![LayerKind { is_shaded: false, evens_cuts: false, by_gradient: ByGradient::Nothing }],
        sources: vec![source],
        fields: FieldKinds::default(),
        gather: true,
        with_depth: true,
        counted: false,
    }
}

/// Runs a function whose inputs are read from `tables`, from `first` on, one or more vec4s each.
fn run_function(gpu: &Gpu, numbers: &mut Numbers, inputs: &[[f32; 4]], n: usize, body: &str) -> Vec<[f32; 4]> {
    let first = numbers.table(inputs);
    if numbers.layers.is_empty() {
        numbers.layers.push(GpuLayer::default());
    }
    numbers.sources = vec![GpuSource::default()];
    let entry = format!(
        "@compute @workgroup_size(64)\nfn stage(@builtin(global_invocation_id) id: vec3<u32>) {{\n    let k = id.x;\n    \
         if k >= {n}u {{ return; }}\n    let first = {first}u;\n    {body}\n}}\n"
    );
    let phantom = Phantom::fog([4; 3], DAffine3::IDENTITY, 1.0);
    let slices = Slices::new(&phantom.volume(), Kernel::Linear);
    let source =
        SourceKind { kernel: Kernel::Linear, format: Format::Float, gradient: GradientTaps::Nothing, has_holes: false };
    gpu.run_stage(&permutation(source), &entry, numbers, &slices, n).unwrap()
}

fn columns<const N: usize>(rows: &[[f32; 4]]) -> [Vec<f32>; N] {
    std::array::from_fn(|c| rows.iter().map(|row| row[c]).collect())
}

fn of_one(numbers: &[f32]) -> Vec<[f32; 4]> {
    numbers.iter().map(|x| [*x, 0.0, 0.0, 0.0]).collect()
}

fn of_two(a: &[f32], b: &[f32]) -> Vec<[f32; 4]> {
    a.iter().zip(b).map(|(a, b)| [*a, *b, 0.0, 0.0]).collect()
}

/// Transfer function of a case, with an opacity unit of 1.
fn transfer_function(case: &Case) -> TransferFunction {
    let node = |&[value, opacity]: &[f64; 2]| OpacityNode { value, opacity };
    let opacity = case.numbers("opacity_nodes").as_chunks().0.iter().map(node).collect();
    let node = |&[value, r, g, b]: &[f64; 4]| ColorNode { value, rgb: [r, g, b] };
    let color = case.numbers("color_nodes").as_chunks().0.iter().map(node).collect();
    TransferFunction::new(opacity, color, Some(1.0)).unwrap()
}

fn with_classifier(case: &Case, slab_thickness: f64) -> Numbers {
    let range = case.array("range").map(|d: f64| d as f32);
    let classifier = Classifier::new(&transfer_function(case), (0.0, 1.0), range, slab_thickness);
    let mut numbers = Numbers::default();
    let layer = numbers.transfer_function(&classifier.arrays(), 1.0);
    numbers.layers.push(layer);
    numbers
}

#[test]
fn look_up() {
    check("look_up", |gpu, case| {
        let mut numbers = Numbers::default();
        let table = case.floats("table");
        let entries: &[[f32; 4]] = table.as_chunks().0;
        let place = numbers.table(entries);
        let positions = case.floats("position");
        let body = format!("state[k] = look_up({place}u, {}u, tables[first + k].x);", entries.len());
        let rows = run_function(gpu, &mut numbers, &of_one(&positions), positions.len(), &body);
        let [r, g, b, depth] = columns(&rows);
        vec![("r", r), ("g", g), ("b", b), ("depth", depth)]
    });
}

#[test]
fn classify() {
    check("classify", |gpu, case| {
        let mut numbers = with_classifier(case, 1.0);
        let densities = case.floats("density");
        let body = "state[k] = classify(0u, tables[first + k].x);";
        let rows = run_function(gpu, &mut numbers, &of_one(&densities), densities.len(), body);
        let [r, g, b, depth] = columns(&rows);
        vec![("r", r), ("g", g), ("b", b), ("depth", depth)]
    });
}

#[test]
fn opacity() {
    check("opacity", |gpu, case| {
        let depths = case.floats("x");
        let body = "state[k] = vec4<f32>(one_minus_exp_neg(tables[first + k].x));";
        let rows = run_function(gpu, &mut Numbers::default(), &of_one(&depths), depths.len(), body);
        let [opacity] = columns(&rows);
        vec![("opacity", opacity)]
    });
}

#[test]
fn preintegrate() {
    check("preintegrate", |gpu, case| {
        let mut numbers = with_classifier(case, case.number("slab_thickness"));
        let (from, to) = (case.floats("from"), case.floats("to"));
        let body = "let ends = tables[first + k];\n    let passage = preintegrate(0u, ends.x, ends.y);\n    \
                    state[k] = vec4<f32>(passage.first, passage.last, passage.depths);";
        let rows = run_function(gpu, &mut numbers, &of_two(&from, &to), from.len(), body);
        let [first, last, a, b] = columns(&rows);
        vec![("first", first), ("last", last), ("depth_first_half", a), ("depth_second_half", b)]
    });
}

#[test]
fn shade() {
    check("shade", |gpu, case| {
        let family = Family { axes: case.array("axes").map(|a: f64| a as usize), ascending: true };
        let world_from_index = DMat3::from_cols_array(&case.array("world_from_index"));
        let (to_lights, colors) = (case.numbers("to_lights"), case.floats("light_colors"));
        let lights = to_lights.as_chunks().0.iter().zip(colors.as_chunks().0).map(|(to_light, rgb)| Light {
            frame: LightFrame::World,
            to_light: DVec3::from_array(*to_light),
            rgb: *rgb,
        });
        let shading = Shading {
            ambient: case.number("ambient") as f32,
            diffuse: case.number("diffuse") as f32,
            specular: case.number("specular") as f32,
            specular_power: case.number("power") as f32,
            lights: lights.collect(),
            ..Shading::headlight()
        };
        let shader = Shader::new(&shading, &camera_along(2, DVec3::ZERO), world_from_index, &family, [0.0, 1.0]);
        let form = world_gradient_from_index(world_from_index, &family).transpose();
        let to_eye = case.numbers("to_eye");
        let forms = to_eye.as_chunks().0.iter().map(|eye| (form * DVec3::from_array(*eye)).as_vec3().to_array());
        let (rgb, gradient) = (case.floats("rgb"), case.floats("gradient"));
        let four = |[a, b, c]: [f32; 3]| [a, b, c, 0.0];
        let triples = |numbers: &[f32]| -> Vec<[f32; 3]> { numbers.as_chunks().0.to_vec() };
        let inputs = triples(&rgb).into_iter().zip(triples(&gradient)).zip(forms);
        let inputs: Vec<[f32; 4]> = inputs.flat_map(|((a, b), c)| [a, b, c].map(four)).collect();
        let mut numbers = Numbers::default();
        let lighting = numbers.lighting(&shader);
        numbers.layers.push(GpuLayer { lighting, ..GpuLayer::default() });
        let body = "let at = first + 3u * k;\n    let rgb = shade(parameters.layers[0].lighting, tables[at].xyz, \
                    tables[at + 1u].xyz, tables[at + 2u].xyz, 1.0f);\n    state[k] = vec4<f32>(rgb, 0.0f);";
        let rows = run_function(gpu, &mut numbers, &inputs, inputs.len() / 3, body);
        vec![("shaded", rows.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect())]
    });
}

/// A camera whose rays run along an axis, the right way round.
fn camera_along(axis: usize, centre: DVec3) -> Camera {
    let forward = DVec3::AXES[axis];
    let up = if axis == 1 { DVec3::Z } else { DVec3::Y };
    let projection = Projection::Orthographic { parallel_scale: 64.0 };
    Camera::new(centre - 100.0 * forward, centre, up, projection).unwrap()
}

/// A base plane of rays along an axis, with texels at a given origin and step.
fn plane_along(axis: usize, origin: DVec2, step: DVec2, size: [usize; 2]) -> BasePlane {
    let camera = camera_along(axis, DVec3::splat(4.0));
    let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 64, 64);
    let mut planes = base_planes(&camera, &rays, [64, 64], 1.0, [DVec3::ZERO, DVec3::splat(8.0)]).unwrap();
    let mut plane = planes.remove(0);
    (plane.origin, plane.step, plane.size) = (origin, step, size);
    plane
}

#[test]
fn sheet() {
    check("sheet", |gpu, case| {
        let size = case.array("size").map(|n: f64| n as usize);
        let axes: [usize; 3] = case.array("axes").map(|a: f64| a as usize);
        let phantom = Phantom { samples: case.floats("samples"), size, world_from_index: DAffine3::IDENTITY };
        let kernel = Kernel::from_name(case.text("kernel")).unwrap();
        let slices = Slices::new(&phantom.volume(), kernel);
        let ([u0, du], [v0, dv], w) = (case.array("u"), case.array("v"), case.number("w"));
        let plane = plane_along(axes[2], DVec2::new(u0, v0), DVec2::new(du, dv), [LANES, 8]);
        let gradient = Gradient::Difference(case.number("offset"));
        let geometry = SheetGeometry::new(Level::best(), &plane, &slices, Some(gradient));
        let mut numbers = Numbers::default();
        numbers.layers.push(GpuLayer::default());
        numbers.frame = GpuFrame { axes: [axes[2] as u32, 0, 0, 0], ..GpuFrame::default() };
        let source = numbers.source(&[w], &geometry);
        numbers.sources.push(source);
        let kind = SourceKind { kernel, format: Format::Float, gradient: GradientTaps::Difference, has_holes: false };
        let entry = "@compute @workgroup_size(64)\nfn stage(@builtin(global_invocation_id) id: vec3<u32>) {\n    \
                     let place = place_0(vec2<u32>(id.x % 16u, id.x / 16u), 0u);\n    \
                     state[id.x] = vec4<f32>(value_0(place, vec3<f32>(0.0f)), gradient_0(place));\n}\n";
        let rows = gpu.run_stage(&permutation(kind), entry, &numbers, &slices, 4 * LANES).unwrap();
        let [density, u, v, w] = columns(&rows);
        vec![("density", density), ("gradient_u", u), ("gradient_v", v), ("gradient_w", w)]
    });
}

/// The row of a tile that is read: away from the volume's faces.
const ROW: usize = 3;

/// Draws sixteen rays through slices as a whole frame: texels of a row, and their positions of opacity 1/2.
fn rays(gpu: &Gpu, case: &Case, tf: &TransferFunction, composite: Composite, steep: bool) -> (Vec<[f32; 4]>, Vec<f32>) {
    let density = case.floats("density");
    let n_sheets = density.len() / LANES;
    // One more sample on either side, so that no ray runs along a face.
    let size = [LANES + 2, 8, n_sheets];
    let sample = |p: DVec3| f64::from(density[p.z as usize * LANES + (p.x as usize).clamp(1, LANES) - 1]);
    let samples = Phantom::sample(size, DAffine3::IDENTITY, sample).samples;
    let world_from_index = DAffine3::from_scale(DVec3::new(1.0, 1.0, case.number("length_per_s")));
    let phantom = Phantom { samples, size, world_from_index };
    let slices = Slices::new(&phantom.volume(), Kernel::Linear);
    let last = slices.grid().last_index();
    let [lo, hi] = case.array("interval");
    let options = RenderOptions {
        width_px: 64,
        height_px: 64,
        composite,
        shading: None,
        sheets_per_slice: 1.0,
        oversampling: 1.0,
        early_ray_termination: false,
        crop: Some(Crop::Index { lo: DVec3::new(0.0, 0.0, lo), hi: DVec3::new(last.x, last.y, hi) }),
        with_depth: true,
        ..RenderOptions::default()
    };
    let cache = VisibilityCache::default();
    let layer =
        Layer { slices: &slices, transfer_function: tf, shading: None, labels: None, color: None, cache: &cache };
    let mut plan = Plan::new(Level::best(), &[layer], &camera_along(2, phantom.centre()), &options).unwrap();
    if let Operator::Over { pre_integrated, .. } = &mut plan.operator {
        *pre_integrated = steep;
    }
    let plane = &mut plan.families[0].plane;
    (plane.origin, plane.step, plane.size) = (DVec2::new(1.0, 0.0), DVec2::ONE, [LANES, 8]);
    let (pictures, _) = gpu.draw_base_planes(&plan, &[&slices], &()).unwrap();
    let picture: &BasePicture = &pictures[0];
    (picture.row(ROW).to_vec(), picture.w_half[ROW * LANES..][..LANES].to_vec())
}

/// A transfer function for projections, which ignore it.
fn any_transfer_function() -> TransferFunction {
    wavesplat_testkit::opacity_ramp(&[(0.0, 0.0), (255.0, 1.0)], None)
}

#[test]
fn over() {
    check("over", |gpu, case| {
        let steep = case.number("pre_integrated") == 1.0;
        let (rows, s_half) = rays(gpu, case, &transfer_function(case), Composite::Over, steep);
        let [r, g, b, a] = columns(&rows);
        vec![("r", r), ("g", g), ("b", b), ("a", a), ("s_half", s_half)]
    });
}

#[test]
fn project() {
    check("project", |gpu, case| {
        let composite = match case.text("operator") {
            "maximum" => Composite::Maximum,
            "minimum" => Composite::Minimum,
            "mean" => Composite::Mean,
            "sum" => Composite::Sum,
            "x-ray" => Composite::XRay { clear: case.number("level"), attenuation: 1.0 },
            "attenuated maximum" => Composite::AttenuatedMaximum {
                black: case.number("level"),
                white: case.number("white"),
                attenuation: case.number("attenuation"),
            },
            _ => Composite::DepthShadedMaximum { strength: case.number("strength"), black: case.number("level") },
        };
        let (rows, _) = rays(gpu, case, &any_transfer_function(), composite, false);
        // The state of a mean is an integral; its texel is the integral divided by the length.
        let value = |row: &[f32; 4]| if composite == Composite::Mean { row[0] * row[1] } else { row[0] };
        let drawn: Vec<bool> = rows.iter().map(|row| row[3] > 0.0).collect();
        assert!(drawn.iter().all(|drawn| *drawn), "{}", case.name);
        vec![("value", rows.iter().map(value).collect()), ("length", rows.iter().map(|row| row[1]).collect())]
    });
}

#[test]
fn first_hit() {
    check("first_hit", |gpu, case| {
        let composite = Composite::FirstHit { iso_value: case.number("iso") };
        let (rows, s_half) = rays(gpu, case, &transfer_function(case), composite, false);
        let [r, g, b, found] = columns(&rows);
        vec![("found", found), ("s_half", s_half), ("r", r), ("g", g), ("b", b)]
    });
}

#[test]
fn local_maximum() {
    check("local_maximum", |gpu, case| {
        let composite = Composite::LocalMaximum { threshold: case.number("threshold") };
        let (rows, _) = rays(gpu, case, &any_transfer_function(), composite, false);
        let [value] = columns(&rows);
        vec![("value", value)]
    });
}
