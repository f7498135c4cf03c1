//! The CPU's stages, fed with the inputs of a fixture.

use glam::{DAffine3, DMat3, DVec2, DVec3};
use wavesplat_compute::simd::{LANES, Lanes, Level, Simd, VectorKernel};
use wavesplat_core::{
    Camera, ColorNode, Composite, Crop, Gradient, Kernel, Light, LightFrame, OpacityNode, Projection, RenderOptions,
    Shading, TransferFunction,
};
use wavesplat_splat::Layer;
use wavesplat_splat::kernel::footprint::{Axis, AxisFootprints};
use wavesplat_splat::kernel::slice_taps::SliceTaps;
use wavesplat_splat::kernel::weights::mirror_index;
use wavesplat_splat::optics::classify::{Classifier, Entry, one_minus_exp_neg};
use wavesplat_splat::optics::shade::Shader;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::picture::resample::Resampler;
use wavesplat_splat::ray::state::TileState;
use wavesplat_splat::render::piece::draw_piece;
use wavesplat_splat::render::plan::{Operator, Plan};
use wavesplat_splat::sheet::buffer::Sheet;
use wavesplat_splat::sheet::tile_layout::{Block, Chunk};
use wavesplat_splat::source::geometry::SheetGeometry;
use wavesplat_splat::source::min_max_bricks::{Bricks, FloatRows};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::source::transposed::TransposedSlices;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::{Family, IndexRays};
use wavesplat_splat::view::index_frame::world_gradient_from_index;
use wavesplat_testkit::Phantom;

use crate::fixture::{Arrays, Case};

/// Output of a stage for a case.
pub fn run(stage: &str, level: Level, case: &Case) -> Arrays {
    match stage {
        "footprint" => footprint(level, case),
        "slice_taps" => slice_taps(case),
        "bricks" => bricks(level, case),
        "sheet" => sheet(level, case),
        "look_up" => look_up(level, case),
        "classify" => classify(level, case),
        "opacity" => opacity(level, case),
        "preintegrate" => preintegrate(level, case),
        "shade" => shade(level, case),
        "over" => over(level, case),
        "project" => project(level, case),
        "first_hit" => first_hit(level, case),
        "local_maximum" => local_maximum(level, case),
        "resample" => resample(level, case),
        _ => panic!("no stage {stage}"),
    }
}

fn kernel(case: &Case) -> Kernel {
    Kernel::from_name(case.text("kernel")).expect("a kernel")
}

fn footprint(level: Level, case: &Case) -> Arrays {
    let (kernel, n) = (kernel(case), case.count("n_positions"));
    let axis = Axis {
        kernel,
        n_samples: case.count("n_samples"),
        gradient: Some(Gradient::Difference(case.number("offset"))),
    };
    let n_groups = n / LANES;
    let mut tables = AxisFootprints::default();
    level.run(
        #[inline(always)]
        || {
            tables.build(&axis, [case.number("origin"), case.number("step")], n_groups, (1 << n_groups) - 1);
            tables.make_difference();
        },
    );
    let (value, difference, first) = (&tables.value, &tables.difference, tables.window[0]);
    let mut dense = vec![0.0; n * axis.n_samples];
    for i in 0..n {
        for t in 0..difference.n_taps {
            let sample = mirror_index(kernel, first + (difference.first(i) + t) as i64, axis.n_samples);
            dense[i * axis.n_samples + sample] += difference.weight(i, t);
        }
    }
    let firsts = (0..n).map(|i| (first + value.first(i) as i64) as f32).collect();
    let weights = (0..n).flat_map(|i| (0..value.n_taps).map(move |t| value.weight(i, t))).collect();
    Arrays::from([("first", firsts), ("weights", weights), ("difference", dense)])
}

fn slice_taps(case: &Case) -> Arrays {
    let n_samples = case.count("n_samples");
    let axis = Axis { kernel: kernel(case), n_samples, gradient: Some(Gradient::Difference(case.number("offset"))) };
    let dense = |taps: &dyn Fn(f64) -> SliceTaps| {
        let mut dense = Vec::new();
        for w in case.numbers("w") {
            let mut weights = vec![0.0; n_samples];
            taps(w).iter().for_each(|(slice, weight)| weights[*slice] += weight);
            dense.append(&mut weights);
        }
        dense
    };
    Arrays::from([
        ("weights", dense(&|w| axis.slice_taps(w))),
        ("difference", dense(&|w| axis.slice_difference_taps(w))),
    ])
}

fn bricks(level: Level, case: &Case) -> Arrays {
    let size = case.array("size").map(|n: f64| n as usize);
    let densities = case.floats("samples");
    let [lo, hi] = densities.iter().fold([f32::MAX, f32::MIN], |[lo, hi], d| [lo.min(*d), hi.max(*d)]);
    let side = case.count("side");
    // One byte too few for bricks of half the side.
    let n_bricks: usize = size.iter().map(|n| (n - 1).div_ceil(side / 2)).product();
    let budget_bytes = if side == 2 { usize::MAX } else { 4 * n_bricks - 1 };
    let rows = FloatRows { densities: &densities, level };
    let bricks = Bricks::new(&rows, size, kernel(case), [lo, hi], budget_bytes);
    let threshold = case.number("threshold") as f32;
    let occupied = bricks.occupied([0, 1, 2], &bricks.visible_ranges(|[_, hi]| hi > threshold));
    assert_eq!(occupied.side(), side);
    let [nx, ny, nz] = size.map(|n| (n - 1).div_ceil(side));
    let at = |i: usize| occupied.any([i % nx; 2], [i / nx % ny; 2], [i / (nx * ny); 2]);
    Arrays::from([("occupied", (0..nx * ny * nz).map(|i| f32::from(u8::from(at(i)))).collect())])
}

/// A camera whose rays run along an axis, the right way round.
fn camera_along(axis: usize, centre: DVec3) -> Camera {
    let forward = DVec3::AXES[axis];
    let up = if axis == 1 { DVec3::Z } else { DVec3::Y };
    let projection = Projection::Orthographic { parallel_scale: 64.0 };
    Camera::new(centre - 100.0 * forward, centre, up, projection).expect("a camera")
}

/// A base plane of rays along an axis, with its texels where they are wanted.
fn plane_along(axis: usize, origin: DVec2, step: DVec2, size: [usize; 2]) -> BasePlane {
    let camera = camera_along(axis, DVec3::splat(4.0));
    let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 64, 64);
    let mut planes = base_planes(&camera, &rays, [64, 64], 1.0, [DVec3::ZERO, DVec3::splat(8.0)]).expect("a plane");
    let mut plane = planes.remove(0);
    (plane.origin, plane.step, plane.size) = (origin, step, size);
    plane
}

fn sheet(level: Level, case: &Case) -> Arrays {
    let size = case.array("size").map(|n: f64| n as usize);
    let axes = case.array("axes").map(|a: f64| a as usize);
    let phantom = Phantom { samples: case.floats("samples"), size, world_from_index: DAffine3::IDENTITY };
    let slices = Slices::new(&phantom.volume(), kernel(case));
    let ([u0, du], [v0, dv], w) = (case.array("u"), case.array("v"), case.number("w"));
    let plane = plane_along(axes[2], DVec2::new(u0, v0), DVec2::new(du, dv), [LANES, 8]);
    assert_eq!(plane.family, Family { axes, ascending: true });
    assert_eq!(plane.sheet(w), [(u0, du), (v0, dv)]);
    let geometry = SheetGeometry::new(level, &plane, &slices, Some(Gradient::Difference(case.number("offset"))));
    let mut transposed = TransposedSlices::default();
    transposed.cover(&geometry, [w; 2], [w; 2], |_| [[0, 0], [LANES - 1, 7]]);
    let (mut sheet, block) = (Sheet::default(), Block::new(0));
    sheet.combine(&geometry, &transposed, w, [0, 0], block.mask());
    sheet.prepare(&geometry, block.mask());
    sheet.prepare_gradient(&geometry, &transposed, block);
    let names = ["density", "gradient_u", "gradient_v", "gradient_w"];
    let rows = (0..4).map(|row| level.dispatch(ReadSheet { sheet: &sheet, chunk: Chunk { strip: 0, row } }));
    let rows: Vec<[[f32; LANES]; 4]> = rows.collect();
    names.into_iter().enumerate().map(|(k, name)| (name, rows.iter().flat_map(|row| row[k]).collect())).collect()
}

struct ReadSheet<'a> {
    sheet: &'a Sheet,
    chunk: Chunk,
}

impl VectorKernel for ReadSheet<'_> {
    type Output = [[f32; LANES]; 4];

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let chunks = [self.chunk; 2];
        let [u, v, w] = self.sheet.gradient(s, chunks);
        [self.sheet.density(s, chunks), u, v, w].map(|x| stored(s, x))
    }
}

#[inline(always)]
fn stored<S: Simd>(s: S, x: S::F) -> [f32; LANES] {
    let mut out = [0.0; LANES];
    s.store(x, &mut out);
    out
}

/// A function of `IN` numbers, lane by lane.
trait LaneFunction<const IN: usize, const OUT: usize> {
    /// Result for sixteen lanes; implementations are `#[inline(always)]`.
    fn call<S: Simd>(&self, s: S, x: [S::F; IN]) -> [S::F; OUT];
}

/// Vector kernel that calls a function on sixteen lanes.
struct Call<'a, F, const IN: usize, const OUT: usize>(&'a F, [[f32; LANES]; IN]);

impl<const IN: usize, const OUT: usize, F: LaneFunction<IN, OUT>> VectorKernel for Call<'_, F, IN, OUT> {
    type Output = [[f32; LANES]; OUT];

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        self.0.call(s, self.1.map(|lanes| s.load(&lanes))).map(|x| stored(s, x))
    }
}

/// Calls a function on arrays of one length.
fn map_lanes<const IN: usize, const OUT: usize>(
    level: Level,
    function: &impl LaneFunction<IN, OUT>,
    inputs: [&[f32]; IN],
) -> [Vec<f32>; OUT] {
    let n = inputs[0].len();
    let mut all = [(); OUT].map(|()| Vec::new());
    for first in (0..n).step_by(LANES) {
        let lanes = inputs.map(|input| std::array::from_fn(|i| *input.get(first + i).unwrap_or(&1.0)));
        for (all, output) in all.iter_mut().zip(level.dispatch(Call::<_, IN, OUT>(function, lanes))) {
            all.extend_from_slice(&output[..LANES.min(n - first)]);
        }
    }
    all
}

/// Every `n`th number from `first` on.
fn column(numbers: &[f32], n: usize, first: usize) -> Vec<f32> {
    numbers.iter().skip(first).step_by(n).copied().collect()
}

/// Columns side by side.
fn interleaved<const N: usize>(columns: &[Vec<f32>; N]) -> Vec<f32> {
    (0..columns[0].len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
}

struct LookUp(Vec<Entry>);

impl LaneFunction<1, 4> for LookUp {
    #[inline(always)]
    fn call<S: Simd>(&self, s: S, [position]: [S::F; 1]) -> [S::F; 4] {
        s.look_up(&self.0, position)
    }
}

fn look_up(level: Level, case: &Case) -> Arrays {
    let table = LookUp(case.floats("table").as_chunks().0.to_vec());
    let [r, g, b, depth] = map_lanes(level, &table, [&case.floats("position")]);
    Arrays::from([("r", r), ("g", g), ("b", b), ("depth", depth)])
}

/// The transfer function of a case, with an `opacity_unit` of 1.
fn transfer_function(case: &Case) -> TransferFunction {
    let node = |&[value, opacity]: &[f64; 2]| OpacityNode { value, opacity };
    let opacity = case.numbers("opacity_nodes").as_chunks().0.iter().map(node).collect();
    let node = |&[value, r, g, b]: &[f64; 4]| ColorNode { value, rgb: [r, g, b] };
    let color = case.numbers("color_nodes").as_chunks().0.iter().map(node).collect();
    TransferFunction::new(opacity, color, Some(1.0)).expect("a transfer function")
}

fn classifier(case: &Case, slab_thickness: f64) -> Classifier {
    let range = case.array("range").map(|d: f64| d as f32);
    Classifier::new(&transfer_function(case), (0.0, 1.0), range, slab_thickness)
}

impl LaneFunction<1, 4> for Classifier {
    #[inline(always)]
    fn call<S: Simd>(&self, s: S, [density]: [S::F; 1]) -> [S::F; 4] {
        Self::look_up(self, s, density)
    }
}

fn classify(level: Level, case: &Case) -> Arrays {
    let [r, g, b, depth] = map_lanes(level, &classifier(case, 1.0), [&case.floats("density")]);
    Arrays::from([("r", r), ("g", g), ("b", b), ("depth", depth)])
}

struct Opacity;

impl LaneFunction<1, 1> for Opacity {
    #[inline(always)]
    fn call<S: Simd>(&self, s: S, [x]: [S::F; 1]) -> [S::F; 1] {
        [one_minus_exp_neg(s, x)]
    }
}

fn opacity(level: Level, case: &Case) -> Arrays {
    let [opacity] = map_lanes(level, &Opacity, [&case.floats("x")]);
    Arrays::from([("opacity", opacity)])
}

struct Preintegrate(Classifier);

impl LaneFunction<2, 4> for Preintegrate {
    #[inline(always)]
    fn call<S: Simd>(&self, s: S, [from, to]: [S::F; 2]) -> [S::F; 4] {
        let segment = self.0.preintegrate(s, from, to);
        [segment.first, segment.last, segment.depths[0], segment.depths[1]]
    }
}

fn preintegrate(level: Level, case: &Case) -> Arrays {
    let tables = Preintegrate(classifier(case, case.number("slab_thickness")));
    let [first, last, a, b] = map_lanes(level, &tables, [&case.floats("from"), &case.floats("to")]);
    Arrays::from([("first", first), ("last", last), ("depth_first_half", a), ("depth_second_half", b)])
}

impl LaneFunction<9, 3> for Shader {
    #[inline(always)]
    fn call<S: Simd>(&self, s: S, x: [S::F; 9]) -> [S::F; 3] {
        self.shade(s, [x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]])
    }
}

fn shade(level: Level, case: &Case) -> Arrays {
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
    let camera = camera_along(2, DVec3::ZERO);
    let shader = Shader::new(&shading, &camera, world_from_index, &family, [0.0, 1.0]);
    // Directions to the eye come as forms on gradients.
    let form = world_gradient_from_index(world_from_index, &family).transpose();
    let to_eye = case.numbers("to_eye");
    let forms = to_eye.as_chunks().0.iter().flat_map(|to_eye| (form * DVec3::from_array(*to_eye)).as_vec3().to_array());
    let (rgb, gradient, forms) = (case.floats("rgb"), case.floats("gradient"), forms.collect::<Vec<f32>>());
    let columns: [Vec<f32>; 9] = std::array::from_fn(|k| column([&rgb, &gradient, &forms][k / 3], 3, k % 3));
    let shaded = map_lanes(level, &shader, columns.each_ref().map(Vec::as_slice));
    Arrays::from([("shaded", interleaved(&shaded))])
}

/// The row of a tile that is read: away from the volume's faces.
const ROW: usize = 3;

/// Sixteen rays through slices, by the tile loop of a frame, which runs from sheet to sheet.
fn rays(level: Level, case: &Case, tf: &TransferFunction, composite: Composite, is_preintegrated: bool) -> TileState {
    let density = case.floats("density");
    let n_sheets = density.len() / LANES;
    // A sample more on either side, so that no ray runs along a face.
    let size = [LANES + 2, 8, n_sheets];
    let sample = |p: DVec3| f64::from(density[p.z as usize * LANES + (p.x as usize).clamp(1, LANES) - 1]);
    let samples = Phantom::sample(size, DAffine3::IDENTITY, sample).samples;
    let world_from_index = DAffine3::from_scale(DVec3::new(1.0, 1.0, case.number("length_per_s")));
    let phantom = Phantom { samples, size, world_from_index };
    let slices = Slices::new(&phantom.volume(), Kernel::Linear);
    assert_eq!(slices.grid().density_from_sample(), (0.0, 1.0));
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
    let mut plan = Plan::new(level, &[layer], &camera_along(2, phantom.centre()), &options).expect("a plan");
    if let Operator::Over { pre_integrated, .. } = &mut plan.operator {
        *pre_integrated = is_preintegrated;
    }
    let plane = &mut plan.families[0].plane;
    (plane.origin, plane.step, plane.size) = (DVec2::new(1.0, 0.0), DVec2::ONE, [LANES, 8]);
    assert_eq!(plane.sheet(1.0), [(1.0, 1.0), (0.0, 1.0)]);
    let (mut states, _) = draw_piece(&plan, 0, &[[0, 0]], &(0..n_sheets - 1), &[&slices], &[], &()).unwrap();
    states.remove(0).expect("something is drawn")
}

fn of_row<T: Copy>(per_chunk: &[T]) -> T {
    per_chunk[Chunk { strip: 0, row: ROW }.index()]
}

fn lanes(per_chunk: &[Lanes]) -> Vec<f32> {
    of_row(per_chunk).0.to_vec()
}

fn bits(per_chunk: &[u16]) -> Vec<f32> {
    (0..LANES).map(|i| f32::from(of_row(per_chunk) >> i & 1)).collect()
}

fn over(level: Level, case: &Case) -> Arrays {
    let state = rays(level, case, &transfer_function(case), Composite::Over, case.number("pre_integrated") == 1.0);
    let [r, g, b, a] = of_row(&state.rgba).map(|channel| channel.0.to_vec());
    Arrays::from([("r", r), ("g", g), ("b", b), ("a", a), ("s_half", lanes(&state.s_half))])
}

/// A transfer function that projections do not look at.
fn any_transfer_function() -> TransferFunction {
    wavesplat_testkit::opacity_ramp(&[(0.0, 0.0), (255.0, 1.0)], None)
}

fn project(level: Level, case: &Case) -> Arrays {
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
    let state = rays(level, case, &any_transfer_function(), composite, false);
    Arrays::from([("value", lanes(&state.value)), ("length", lanes(&state.length))])
}

fn first_hit(level: Level, case: &Case) -> Arrays {
    let composite = Composite::FirstHit { iso_value: case.number("iso") };
    let state = rays(level, case, &transfer_function(case), composite, false);
    let [r, g, b, _] = of_row(&state.rgba).map(|channel| channel.0.to_vec());
    let (found, s_half) = (bits(&state.found), lanes(&state.s_half));
    Arrays::from([("found", found), ("s_half", s_half), ("r", r), ("g", g), ("b", b)])
}

fn local_maximum(level: Level, case: &Case) -> Arrays {
    let composite = Composite::LocalMaximum { threshold: case.number("threshold") };
    let state = rays(level, case, &any_transfer_function(), composite, false);
    Arrays::from([("value", lanes(&state.value)), ("found", bits(&state.found))])
}

fn resample(level: Level, case: &Case) -> Arrays {
    let [n_u, n_v] = case.array("size").map(|n: f64| n as usize);
    let plane = plane_along(2, DVec2::ZERO, DVec2::ONE, [n_u, n_v]);
    let mut picture = BasePicture::new(plane, false);
    let texels = case.floats("texels");
    for (j, row) in texels.as_chunks().0.chunks(n_u).enumerate() {
        for i in (0..n_u).step_by(LANES) {
            let chunk = std::array::from_fn(|lane| row.get(i + lane).copied().unwrap_or_default());
            picture.put(i, j, &chunk, None);
        }
    }
    let (us, vs) = (case.floats("u"), case.floats("v"));
    let read = us.as_chunks().0.iter().zip(vs.as_chunks().0).flat_map(|(u, v)| {
        let read = Read { picture: &picture, positions: [u, v], peak: case.number("peak") as f32 };
        level.dispatch(read).into_iter().flatten()
    });
    Arrays::from([("rgba", read.collect())])
}

struct Read<'a> {
    picture: &'a BasePicture,
    positions: [&'a [f32; LANES]; 2],
    peak: f32,
}

impl VectorKernel for Read<'_> {
    type Output = [[f32; LANES]; 4];

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let positions = self.positions.map(|x| s.load(x));
        let read = Resampler::new(self.picture).read(s, [0, 0], positions, 0..LANES, true, self.peak);
        read.map_or([[0.0; LANES]; 4], |quads| quads.map(|quad| stored(s, quad)))
    }
}
