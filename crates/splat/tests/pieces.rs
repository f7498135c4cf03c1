//! Cutting a picture by tiles and by sheets, anywhere, gives the bytes of one piece, from the samples of boxes alone.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, ClipPlane, Composite, Crop, Gradient, GradientNode, Kernel, LabelLook, Light, Mesh, Paint, Paths, Points,
    Projection, RenderOptions, Samples, Shading, ShapeStyle, Shapes, Sizes, Thickness, TransferFunction, Volume,
};
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::ray::state::TileState;
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::render::piece::{draw_piece, finish_tile, samples_of, tiles_of, unseen_picture};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::segments::{can_fold, fold};
use wavesplat_splat::render::stream::{IndexBox, Storage, StreamPlan, volume_of};
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V};
use wavesplat_splat::source::slices::{Slices, VolumeBox, needed_samples};
use wavesplat_splat::source::strided::light_steps;
use wavesplat_splat::source::survey::Survey;
use wavesplat_splat::{Layer, with_threads};
use wavesplat_testkit::{PROJECTIONS, Phantom, camera_towards, opacity_ramp};

/// Numbers without a visible pattern.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// Samples of two types, which are read in different ways.
enum Data {
    Bytes(Vec<u8>),
    Floats(Vec<f32>),
}

impl Data {
    fn samples(&self) -> Samples<'_> {
        match self {
            Self::Bytes(bytes) => Samples::U8(bytes),
            Self::Floats(floats) => Samples::F32(floats),
        }
    }

    fn copied(&self, size: [usize; 3], part: &[Range<usize>; 3]) -> Self {
        fn rows<T: Copy>(all: &[T], [nx, ny, _]: [usize; 3], [xs, ys, zs]: &[Range<usize>; 3]) -> Vec<T> {
            let row = |y: usize, z: usize| &all[(z * ny + y) * nx..][xs.clone()];
            zs.clone().flat_map(|z| ys.clone().flat_map(move |y| row(y, z))).copied().collect()
        }
        match self {
            Self::Bytes(bytes) => Self::Bytes(rows(bytes, size, part)),
            Self::Floats(floats) => Self::Floats(rows(floats, size, part)),
        }
    }

    /// Copies the samples of `part` from samples of `whole`.
    fn copied_from(&self, whole: &IndexBox, part: &IndexBox) -> Self {
        let own = [0, 1, 2].map(|a| part[a].start - whole[a].start..part[a].end - whole[a].start);
        self.copied(whole.each_ref().map(Range::len), &own)
    }

    /// Puts the samples of `part` in their place in the samples of `whole`.
    fn put(&mut self, whole: &IndexBox, samples: &Self, part: &IndexBox) {
        fn rows<T: Copy>(all: &mut [T], whole: &IndexBox, own: &[T], part: &IndexBox) {
            let [nx, ny] = [whole[0].len(), whole[1].len()];
            let places = part[2].clone().flat_map(|z| part[1].clone().map(move |y| (y, z)));
            for ((y, z), row) in places.zip(own.chunks_exact(part[0].len().max(1))) {
                let from = nx * (y - whole[1].start + ny * (z - whole[2].start)) + part[0].start - whole[0].start;
                all[from..][..row.len()].copy_from_slice(row);
            }
        }
        match (self, samples) {
            (Self::Bytes(all), Self::Bytes(own)) => rows(all, whole, own, part),
            (Self::Floats(all), Self::Floats(own)) => rows(all, whole, own, part),
            _ => unreachable!("samples of one type"),
        }
    }
}

const SIZE: [usize; 3] = [44, 37, 61];

fn phantom() -> Phantom {
    let affine = DAffine3::from_mat3(DMat3::from_cols(
        DVec3::new(1.0, 0.1, 0.0),
        DVec3::new(-0.1, 1.1, 0.2),
        DVec3::new(0.0, 0.1, 0.8),
    ));
    Phantom::sample(SIZE, affine, |p| {
        let wave = (p.x * 0.45).sin() * (p.y * 0.4).cos() + (p.z * 0.5 + p.x * 0.2).sin();
        (125.0 + 60.0 * wave).round()
    })
}

struct Case {
    name: String,
    data: Data,
    kernel: Kernel,
    tf: TransferFunction,
    camera: Camera,
    options: RenderOptions,
    labels: Option<Labels>,
}

fn cases() -> Vec<Case> {
    let phantom = phantom();
    let bytes = || Data::Bytes(phantom.samples.iter().map(|s| *s as u8).collect());
    let with_holes = || {
        let mut floats = phantom.samples.clone();
        for (i, s) in floats.iter_mut().enumerate() {
            let p = DVec3::new((i % SIZE[0]) as f64, (i / SIZE[0] % SIZE[1]) as f64, (i / (SIZE[0] * SIZE[1])) as f64);
            // One hole is larger than the reach of filling from neighbours.
            if p.distance(DVec3::new(20.0, 18.0, 30.0)) < 3.0 || (p.z > 40.0 && p.x > 25.0) {
                *s = f32::NAN;
            }
        }
        Data::Floats(floats)
    };
    let soft = opacity_ramp(&[(60.0, 0.0), (255.0, 0.25)], None);
    let hard = opacity_ramp(&[(159.0, 0.0), (160.0, 1.0)], None);
    let by_gradient = soft.clone().with_gradient_opacity(vec![
        GradientNode { magnitude: 2.0, factor: 0.0 },
        GradientNode { magnitude: 30.0, factor: 1.0 },
    ]);
    let by_gradient = by_gradient.unwrap();
    let from = |direction: DVec3, projection| camera_towards(phantom.centre(), direction, 90.0, projection);
    let parallel = Projection::Orthographic { parallel_scale: 34.0 };
    let perspective = Projection::Perspective { view_angle_rad: 0.8 };
    let aslant = from(DVec3::new(0.7, 0.6, 0.5), parallel);
    let three_families = from(DVec3::new(1.0, 0.97, 0.95), perspective);
    let inside = Camera::new(
        phantom.centre() + DVec3::new(2.0, -3.0, 1.0),
        phantom.centre() + DVec3::new(9.0, 8.0, 7.0),
        DVec3::Z,
        Projection::Perspective { view_angle_rad: 1.9 },
    );
    let views = [
        ("x", from(DVec3::new(1.0, 0.3, -0.2), parallel)),
        ("-y", from(DVec3::new(0.2, -1.0, 0.3), parallel)),
        ("z", from(DVec3::new(-0.3, 0.2, 1.0), parallel)),
        ("-z", from(DVec3::new(-0.3, 0.2, -1.0), perspective)),
        ("three families", three_families.clone()),
        ("inside", inside.unwrap()),
    ];
    let plain = RenderOptions { width_px: 170, height_px: 110, sheets_per_slice: 1.7, ..RenderOptions::default() };
    let of = |composite| RenderOptions { composite, ..plain.clone() };
    let deep = RenderOptions { with_depth: true, ..plain.clone() };
    let mut all = Vec::new();
    let mut add = |name: &str, data: Data, kernel, tf: &TransferFunction, camera: &Camera, options: &RenderOptions| {
        let (tf, camera, options) = (tf.clone(), camera.clone(), options.clone());
        all.push(Case { name: name.to_owned(), data, kernel, tf, camera, options, labels: None });
    };
    for (name, view) in &views {
        add(&format!("soft {name}"), bytes(), Kernel::Linear, &soft, view, &deep);
        add(&format!("hard {name}"), bytes(), Kernel::Linear, &hard, view, &deep);
    }
    for composite in PROJECTIONS.into_iter().chain([Composite::FirstHit { iso_value: 140.0 }]) {
        let options = RenderOptions { with_depth: matches!(composite, Composite::FirstHit { .. }), ..of(composite) };
        add(&format!("{composite:?}"), bytes(), Kernel::Linear, &soft, &aslant, &options);
        add(&format!("{composite:?} in perspective"), with_holes(), Kernel::Linear, &soft, &three_families, &options);
    }
    for (name, kernel) in Kernel::NAMES {
        add(name, bytes(), kernel, &soft, &aslant, &plain);
        add(&format!("{name} with holes"), with_holes(), kernel, &hard, &views[0].1, &plain);
    }
    let sparse = opacity_ramp(&[(225.0, 0.0), (235.0, 0.5)], None);
    add("few things seen", bytes(), Kernel::CatmullRom, &sparse, &three_families, &plain);
    let wide = Some(Shading { gradient: Gradient::Difference(2.5), ..Shading::headlight() });
    add(
        "wide gradient",
        bytes(),
        Kernel::CatmullRom,
        &hard,
        &aslant,
        &RenderOptions { shading: wide, ..plain.clone() },
    );
    add("no shading", bytes(), Kernel::Linear, &soft, &aslant, &RenderOptions { shading: None, ..plain.clone() });
    add("gradient opacity", bytes(), Kernel::Linear, &by_gradient, &aslant, &plain);
    let crop = Some(Crop::Index { lo: DVec3::new(5.3, 4.0, 9.9), hi: DVec3::new(30.0, 33.2, 50.0) });
    let normal = DVec3::new(0.5, -0.3, 1.0);
    let clip_planes = vec![ClipPlane { origin: phantom.centre(), normal }];
    add("cut", bytes(), Kernel::Linear, &soft, &three_families, &RenderOptions { crop, clip_planes, ..plain.clone() });
    let light = Shading { ambient_occlusion: 0.7, shadow: 0.5, lights: vec![Light::HEADLIGHT], ..Shading::headlight() };
    add("occlusion", bytes(), Kernel::Linear, &soft, &aslant, &RenderOptions { shading: Some(light), ..plain.clone() });
    let among_shapes = |options: &RenderOptions| RenderOptions { shapes: shapes(&phantom), ..options.clone() };
    for (name, view) in &views {
        add(&format!("soft with shapes {name}"), bytes(), Kernel::Linear, &soft, view, &among_shapes(&deep));
        add(&format!("hard with shapes {name}"), with_holes(), Kernel::Linear, &hard, view, &among_shapes(&deep));
    }
    let surface = RenderOptions { with_depth: true, ..of(Composite::FirstHit { iso_value: 140.0 }) };
    add("first hit with shapes", bytes(), Kernel::Linear, &soft, &aslant, &among_shapes(&surface));
    add("maximum with shapes", bytes(), Kernel::Linear, &soft, &aslant, &among_shapes(&of(Composite::Maximum)));
    add("labels", bytes(), Kernel::Linear, &soft, &aslant, &plain);
    let codes: Vec<u8> = (0..SIZE.iter().product()).map(|i: usize| u8::from(i / SIZE[0] % SIZE[1] > 20)).collect();
    let look = LabelLook { rgb: [0.9, 0.1, 0.1], opacity: 0.4, scan: 0.3, tint: 0.2 };
    let last = all.len() - 1;
    let volume = phantom.volume();
    let codes = Codes::U8(Arc::from(&codes[..]));
    let labels = Labels::new(codes, vec![LabelLook::NONE, look], volume.grid(), Kernel::Gaussian, 1 << 24);
    all[last].labels = Some(labels.unwrap());
    all
}

/// Balls, tubes, triangles, strokes and discs in a phantom and beside it, opaque and translucent.
fn shapes(phantom: &Phantom) -> Arc<Shapes> {
    let mut random = Random(5);
    let mut place = || {
        let offset = [0, 1, 2].map(|_| random.below(7000) as f64 / 100.0 - 35.0);
        (phantom.centre() + DVec3::from_array(offset)).to_array()
    };
    let mut places = |n: usize| -> Vec<[f64; 3]> { (0..n).map(|_| place()).collect() };
    let style = |opacity| ShapeStyle { opacity, ..ShapeStyle::default() };
    let mesh = |n: usize, vertices, opacity| Mesh {
        vertices,
        faces: (0..n as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        normals: Vec::new(),
        paint: Paint::Even([0.9, 0.5, 0.1]),
        style: style(opacity),
    };
    let meshes = vec![mesh(2, places(6), 1.0), mesh(6, places(18), 0.4)];
    let paths = |thickness, positions: Vec<[f64; 3]>, opacity| Paths {
        starts: vec![0, positions.len() as u32 / 2, positions.len() as u32],
        thickness,
        paint: Paint::Even([0.2, 0.9, 0.3]),
        style: style(opacity),
        positions,
    };
    let lines = vec![paths(Thickness::Radius(1.5), places(10), 0.6), paths(Thickness::WidthPx(2.5), places(10), 0.8)];
    let points = |sizes, centers: Vec<[f64; 3]>, opacity| Points {
        paint: Paint::Each((0..centers.len()).map(|k| [0.1 * (k % 10) as f32, 0.4, 0.8, 1.0]).collect()),
        sizes,
        style: style(opacity),
        centers,
    };
    let spots = vec![
        points(Sizes::Radii(vec![3.0; 12]), places(12), 1.0),
        points(Sizes::Radii(vec![4.0; 12]), places(12), 0.5),
        points(Sizes::DiametersPx(vec![6.0; 8]), places(8), 0.7),
    ];
    Arc::new(Shapes::new(meshes, lines, spots, Vec::new()).unwrap())
}

/// A random number of samples along each axis, for boxes that divide nothing.
fn odd_chunk(random: &mut Random) -> [usize; 3] {
    [5, 4, 3].map(|least| least + random.below(17))
}

/// Slices for planning a frame, with statistics that were collected box by box.
fn surveyed(whole: &Slices, data: &Data, random: &mut Random) -> Slices<'static> {
    let (grid, kernel) = (whole.grid(), whole.kernel());
    let (_, step) = light_steps(grid);
    let chunk = odd_chunk(random);
    let n = [0, 1, 2].map(|a| SIZE[a].div_ceil(chunk[a]));
    let parts: Vec<IndexBox> = (0..n.iter().product())
        .map(|k: usize| {
            let place = [k % n[0], k / n[0] % n[1], k / (n[0] * n[1])];
            [0, 1, 2].map(|a| place[a] * chunk[a]..((place[a] + 1) * chunk[a]).min(SIZE[a]))
        })
        .collect();
    let needs_prepared = matches!(kernel, Kernel::Bspline2 | Kernel::Bspline3) || grid.statistics().n_nonfinite > 0;
    let mut survey = Survey::new(SIZE, kernel, 1 << 20, &[step]);
    let mut prepared = Survey::new(SIZE, kernel, 1 << 20, &[step]);
    for part in &parts {
        let own = data.copied(SIZE, part);
        survey.add(&box_of(part, &own));
        if needs_prepared {
            let held = needed_samples(part, grid, kernel);
            let own = data.copied(SIZE, &held);
            prepared.add_prepared(&Slices::of_box(&box_of(&held, &own), grid, kernel, [0.0; 2]), part);
        }
    }
    assert_eq!(survey.statistics(), grid.statistics());
    survey.slices(grid, needs_prepared.then_some(&prepared), 0)
}

fn box_of<'a>(part: &IndexBox, data: &'a Data) -> VolumeBox<'a> {
    VolumeBox { lo: part.each_ref().map(|r| r.start), size: part.each_ref().map(Range::len), samples: data.samples() }
}

/// Settings of the stream of a plan's base planes: chunks, budget, segments.
struct Streaming {
    chunk: [usize; 3],
    budget_bytes: usize,
    n_blocks: usize,
    segment_slices: Option<usize>,
}

/// Draws the base planes of a plan step by step, from samples that hold nonsense where nothing was read; returns how
/// many samples were left out, and in how many blocks.
fn streamed(plan: &Plan, slices: &Slices, data: &Data, streaming: &Streaming) -> (Vec<BasePicture>, [usize; 2]) {
    let sample_bytes = if matches!(data, Data::Bytes(_)) { 1 } else { 4 };
    let Streaming { chunk, budget_bytes, n_blocks, segment_slices } = *streaming;
    let storage = [Storage { chunk, sample_bytes }];
    let cut = |budget: usize| StreamPlan::new(plan, &[slices], &storage, budget, n_blocks, segment_slices);
    // Wide kernels and holes need more than a small budget.
    let steps = cut(budget_bytes).or_else(|_| cut(usize::MAX)).unwrap();
    let mut pictures: Vec<BasePicture> = (0..plan.families.len()).map(|family| unseen_picture(plan, family)).collect();
    let mut n_read = 0;
    for (b, block) in steps.blocks.iter().enumerate() {
        let tiles = block.all_tiles();
        let mut segments: Vec<Vec<Option<TileState>>> = Vec::new();
        let mut before: Option<(IndexBox, Data)> = None;
        let mut slabs_done = block.steps[0].slabs.start;
        for segment in steps.segments(b) {
            let mut states = vec![None; tiles.len()];
            for k in segment {
                let step = &block.steps[k];
                assert_eq!(step.slabs.start, slabs_done, "no slab is left out");
                slabs_done = step.slabs.end;
                let held = &step.held[0];
                let reads = steps.reads(plan, &[slices], b, k, 0, before.is_none(), &states);
                let mut own = nonsense(data, volume_of(held));
                if let Some((part, samples)) = &before {
                    let common = [0, 1, 2].map(|a| held[a].start.max(part[a].start)..held[a].end.min(part[a].end));
                    own.put(held, &samples.copied_from(part, &common), &common);
                }
                for part in &reads {
                    n_read += volume_of(part);
                    own.put(held, &data.copied(SIZE, part), part);
                }
                let slices_of_box = Slices::of_box(&box_of(held, &own), slices.grid(), slices.kernel(), slices.range());
                (states, _) =
                    draw_piece(plan, block.family, &tiles, &step.slabs, &[&slices_of_box], &states, &()).unwrap();
                before = Some((held.clone(), own));
            }
            segments.push(states);
        }
        let all = segments.into_iter().reduce(|front, back| {
            front.into_iter().zip(back).map(|(near, far)| fold(plan.operator, near, far)).collect()
        });
        let states: Vec<_> = all.unwrap().into_iter().map(std::sync::Mutex::new).collect();
        let n_tiles_u = plan.families[block.family].plane.size[0].div_ceil(TILE_U);
        pictures[block.family].fill_tiles([TILE_U, TILE_V], |k, texels| {
            let place = tiles.iter().position(|tile| *tile == [k % n_tiles_u, k / n_tiles_u]);
            if let Some(place) = place {
                finish_tile(plan, block.family, tiles[place], states[place].lock().unwrap().take(), texels);
            }
        });
    }
    let n_left = steps.n_samples(0).saturating_sub(n_read);
    (pictures, [n_left, steps.blocks.len()])
}

/// Samples unlike any of the volume's.
fn nonsense(data: &Data, n: usize) -> Data {
    match data {
        Data::Bytes(_) => Data::Bytes((0..n).map(|i| if i % 2 == 0 { 255 } else { 0 }).collect()),
        Data::Floats(_) => Data::Floats((0..n).map(|i| if i % 2 == 0 { 1e6 } else { -1e6 }).collect()),
    }
}

fn bits(picture: &BasePicture) -> Vec<u32> {
    let texels = picture.texels();
    let depths = picture.w_half.iter().map(|w| w.to_bits());
    texels.as_flattened().iter().map(|x| x.to_bits()).chain(depths).collect()
}

/// Draws the base planes of a plan by a random cut into pieces, each from a box of its own.
fn in_pieces(plan: &Plan, slices: &Slices, data: &Data, random: &mut Random) -> Vec<BasePicture> {
    let mut pictures = Vec::new();
    for (f, family) in plan.families.iter().enumerate() {
        let mut tiles = tiles_of(plan, f);
        for i in (1..tiles.len()).rev() {
            tiles.swap(i, random.below(i + 1));
        }
        let n_slabs = family.spacing.n_slabs;
        let n_tiles_u = family.plane.size[0].div_ceil(TILE_U);
        let mut states = vec![None; tiles.len()];
        let mut rest = tiles.as_slice();
        while !rest.is_empty() {
            let (group, others) = rest.split_at(1 + random.below(rest.len()));
            rest = others;
            let mut cuts: Vec<usize> = (0..random.below(5)).map(|_| random.below(n_slabs + 1)).collect();
            cuts.extend([0, n_slabs]);
            cuts.sort_unstable();
            let mut of_group = vec![None; group.len()];
            for cut in cuts.windows(2) {
                let slabs = cut[0]..cut[1];
                let reached = samples_of(plan, f, group, &slabs, &[slices], 0).unwrap();
                let part = data.copied(SIZE, &reached);
                let volume_box = VolumeBox {
                    lo: reached.each_ref().map(|r| r.start),
                    size: reached.each_ref().map(Range::len),
                    samples: part.samples(),
                };
                let own = Slices::of_box(&volume_box, slices.grid(), slices.kernel(), slices.range());
                (of_group, _) = draw_piece(plan, f, group, &slabs, &[&own], &of_group, &()).unwrap();
            }
            for (tile, state) in group.iter().zip(of_group) {
                states[tile[1] * n_tiles_u + tile[0]] = state;
            }
        }
        let mut picture = BasePicture::new(family.plane.clone(), plan.with_depth);
        let states: Vec<_> = states.into_iter().map(std::sync::Mutex::new).collect();
        picture.fill_tiles([TILE_U, TILE_V], |k, texels| {
            let tile = [k % n_tiles_u, k / n_tiles_u];
            finish_tile(plan, f, tile, states[k].lock().unwrap().take(), texels);
        });
        pictures.push(picture);
    }
    pictures
}

#[test]
fn any_cut_gives_the_same_bytes() {
    let mut random = Random(7);
    let world_from_index = phantom().world_from_index;
    let cases = cases();
    let n_cuts = 240_usize.div_ceil(cases.len());
    let mut n_seen = 0;
    for case in &cases {
        let volume = Volume::new("cut", case.data.samples(), SIZE, world_from_index).unwrap();
        let slices = Slices::new(&volume, case.kernel);
        let cache = VisibilityCache::default();
        let layer = Layer {
            slices: &slices,
            transfer_function: &case.tf,
            shading: case.options.shading.as_ref(),
            labels: case.labels.as_ref(),
            color: None,
            cache: &cache,
        };
        let plan = Plan::new(Level::best(), &[layer], &case.camera, &case.options).unwrap();
        let (whole, _) = draw_base_planes(&plan, &[&slices], &()).unwrap();
        n_seen += whole.iter().flat_map(BasePicture::texels).filter(|texel| texel[3] > 0.0).count();
        // So many threads draw parts of tiles.
        let (parts, _) = with_threads(Some(64), || draw_base_planes(&plan, &[&slices], &())).unwrap();
        for (whole, parts) in whole.iter().zip(&parts) {
            assert!(bits(whole) == bits(parts), "{}: {:?} by 64 threads", case.name, whole.plane.family);
        }
        for _ in 0..n_cuts {
            let cut = in_pieces(&plan, &slices, &case.data, &mut random);
            for (whole, cut) in whole.iter().zip(&cut) {
                assert!(bits(whole) == bits(cut), "{}: {:?}", case.name, whole.plane.family);
            }
        }
    }
    assert!(cases.len() * n_cuts >= 200 && n_seen > 200_000, "{} {n_seen}", cases.len());
}

/// The bytes do not depend on chunks, budget and blocks; and chunks of which nothing is seen are not read.
#[test]
fn a_stream_of_boxes_gives_the_same_bytes() {
    let mut random = Random(11);
    let world_from_index = phantom().world_from_index;
    let (mut n_hidden, mut n_blocks_seen) = (0, 0);
    for case in &cases() {
        let volume = Volume::new("stream", case.data.samples(), SIZE, world_from_index).unwrap();
        let whole = Slices::new(&volume, case.kernel);
        let planned = surveyed(&whole, &case.data, &mut random);
        let cache = [VisibilityCache::default(), VisibilityCache::default()];
        let of = |k: usize, slices| {
            let layer = Layer {
                slices,
                transfer_function: &case.tf,
                shading: case.options.shading.as_ref(),
                labels: case.labels.as_ref(),
                color: None,
                cache: &cache[k],
            };
            Plan::new(Level::best(), &[layer], &case.camera, &case.options).unwrap()
        };
        let (plan, lazy_plan) = (of(0, &whole), of(1, &planned));
        let (wanted, _) = draw_base_planes(&plan, &[&whole], &()).unwrap();
        for n_blocks in [1, 3] {
            let chunk = odd_chunk(&mut random);
            let sample_bytes = if matches!(case.data, Data::Bytes(_)) { 1 } else { 4 };
            let budget_bytes = sample_bytes * [usize::MAX / 8, 200_000, 120_000][random.below(3)];
            let streaming = Streaming { chunk, budget_bytes, n_blocks, segment_slices: None };
            let (drawn, [n_left, n_here]) = streamed(&lazy_plan, &planned, &case.data, &streaming);
            for (wanted, drawn) in wanted.iter().zip(&drawn) {
                assert!(bits(wanted) == bits(drawn), "{}: {chunk:?} {n_blocks}, {:?}", case.name, wanted.plane.family);
            }
            n_blocks_seen += n_here;
            n_hidden += usize::from(n_left > 0);
        }
    }
    assert!(n_blocks_seen > 200 && n_hidden > 0, "{n_blocks_seen} {n_hidden}");
}

/// Segments begin at fixed slices, so that chunks, budget and blocks change nothing; from the picture in one go they
/// differ by where rays stop.
#[test]
fn folded_segments_do_not_depend_on_how_they_were_read() {
    let mut random = Random(13);
    let world_from_index = phantom().world_from_index;
    let (mut n_folded, mut n_refused) = (0, 0);
    for case in &cases() {
        let volume = Volume::new("segments", case.data.samples(), SIZE, world_from_index).unwrap();
        let whole = Slices::new(&volume, case.kernel);
        let planned = surveyed(&whole, &case.data, &mut random);
        let cache = VisibilityCache::default();
        let layer = Layer {
            slices: &planned,
            transfer_function: &case.tf,
            shading: case.options.shading.as_ref(),
            labels: case.labels.as_ref(),
            color: None,
            cache: &cache,
        };
        let plan = Plan::new(Level::best(), &[layer], &case.camera, &case.options).unwrap().without_even_cuts();
        if !can_fold(&plan) {
            n_refused += 1;
            continue;
        }
        let draw = |chunk, n_blocks, segment_slices| {
            let streaming = Streaming { chunk, budget_bytes: usize::MAX, n_blocks, segment_slices };
            streamed(&plan, &planned, &case.data, &streaming).0
        };
        let in_one_go = draw([16; 3], 1, None);
        let first = draw([16; 3], 1, Some(9));
        let second = draw(odd_chunk(&mut random), 4, Some(9));
        for ((one, first), second) in in_one_go.iter().zip(&first).zip(&second) {
            assert!(bits(first) == bits(second), "{}", case.name);
            let (one, first) = (one.texels(), first.texels());
            for (a, b) in one.as_flattened().iter().zip(first.as_flattened()) {
                let near = (a - b).abs() <= 3e-4_f32.max(1e-5 * a.abs());
                assert!(near, "{}: {a} {b}", case.name);
            }
        }
        n_folded += 1;
    }
    assert!(n_folded > 25 && n_refused > 3, "{n_folded} {n_refused}");
}
