//! Pixels that a wall of the drawn region crosses, against a ray caster with sixteen rays per pixel.

use glam::{DAffine3, DVec3};
use wavesplat_core::{
    Camera, ClipPlane, Composite, Crop, Kernel, Picture, Projection, RenderOptions, TransferFunction,
};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::view::region::Region;
use wavesplat_splat::{Layer, render, render_layers};
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast, raycast_layers};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp, psnr_db};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.2, rays_per_pixel: 16 };

/// Matter that changes slowly, and is everywhere, also at the walls.
fn waves() -> Phantom {
    Phantom::sample([30, 26, 22], DAffine3::from_scale(DVec3::new(1.0, 1.1, 1.3)), |p| {
        130.0 + 60.0 * (0.31 * p.x + 0.2 * p.z).sin() * (0.27 * p.y - 0.1 * p.z).cos() + 30.0 * (0.35 * p.z).sin()
    })
}

const FAINT: [(f64, f64); 2] = [(0.0, 0.0), (255.0, 0.03)];
const DENSE: [(f64, f64); 2] = [(0.0, 0.1), (255.0, 0.9)];
const HARD: [(f64, f64); 2] = [(129.0, 0.0), (131.0, 1.0)];

/// The root of the mean square error of pixels that have an edge, and of the others that show something.
fn errors(drawn: &Picture, converged: &Picture, has_edge: &[bool]) -> [f64; 2] {
    let of = |wanted: bool| {
        let (mut sum, mut n) = (0.0, 0);
        for (k, (a, b)) in drawn.rgba.iter().zip(&converged.rgba).enumerate() {
            if has_edge[k] == wanted && (a[3] > 0.0 || b[3] > 0.0) {
                sum += (0..4).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>() / 4.0;
                n += 1;
            }
        }
        (sum / f64::from(n.max(1))).sqrt()
    };
    [of(true), of(false)]
}

/// Mask of the pixels of which some corners see the drawn region and some do not.
fn edge_pixels(phantom: &Phantom, camera: &Camera, options: &RenderOptions) -> Vec<bool> {
    let volume = phantom.volume();
    let region = Region::new(volume.grid(), options).unwrap();
    let [width, height] = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, volume.grid().index_from_world(), width, height);
    let start = match camera.projection() {
        Projection::Orthographic { .. } => f64::NEG_INFINITY,
        Projection::Perspective { .. } => 0.0,
    };
    let sees = |x: usize, y: usize| {
        let [x, y] = [x as f64, y as f64];
        let [lo, hi] = region.passage(rays.origin(x, y), rays.direction(x, y), [start, f64::INFINITY]).ends;
        lo < hi
    };
    let has_edge = |k: usize| {
        let [x, y] = [k % width, k / width];
        let n = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].into_iter().filter(|[x, y]| sees(*x, *y)).count();
        0 < n && n < 4
    };
    (0..width * height).map(has_edge).collect()
}

/// Errors of a picture with some sheets per slice and texels per pixel.
fn errors_at(look: &[(f64, f64)], camera: &Camera, base: &RenderOptions, [sheets, texels]: [f64; 2]) -> [f64; 2] {
    let phantom = waves();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let tf: TransferFunction = opacity_ramp(look, Some(1.0));
    let converged = raycast(&volume, &tf, camera, base, SAMPLING, &()).unwrap();
    let has_edge = edge_pixels(&phantom, camera, base);
    assert!(has_edge.iter().filter(|edge| **edge).count() > 50);
    let options = RenderOptions { sheets_per_slice: sheets, oversampling: texels, ..base.clone() };
    let drawn = render(&slices, &tf, camera, &options, &()).unwrap().0;
    errors(&drawn, &converged, &has_edge)
}

const NORMAL: [f64; 2] = [2.0, 1.0];
const HIGH: [f64; 2] = [3.0, 2.0];
const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 17.3 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };
const OBLIQUE: DVec3 = DVec3::new(0.7, 0.5, 0.4);

fn look_from(direction: DVec3, projection: Projection) -> Camera {
    camera_towards(waves().centre(), direction, 75.0, projection)
}

fn plain() -> RenderOptions {
    RenderOptions { width_px: 40, height_px: 36, shading: None, ..RenderOptions::default() }
}

fn cropped() -> RenderOptions {
    let crop = Some(Crop::Index { lo: DVec3::new(4.3, 3.7, 2.2), hi: DVec3::new(22.4, 20.9, 15.1) });
    RenderOptions { crop, ..plain() }
}

fn clipped(normal: DVec3) -> RenderOptions {
    RenderOptions { clip_planes: vec![ClipPlane { origin: waves().centre(), normal }], ..plain() }
}

#[test]
fn walls_along_the_rays_are_as_good_as_the_rest() {
    let scenes = [
        ("z", DVec3::Z, plain()),
        ("x", DVec3::X, plain()),
        ("crop box", DVec3::Z, cropped()),
        ("clip plane", DVec3::Z, clipped(DVec3::new(1.0, 0.6, 0.0))),
    ];
    for (name, direction, options) in scenes {
        for (look, nodes) in [("faint", &FAINT), ("dense", &DENSE), ("hard", &HARD)] {
            for sampling in [[1.0, 0.5], NORMAL, HIGH] {
                let [edge, rest] = errors_at(nodes, &look_from(direction, ORTHOGRAPHIC), &options, sampling);
                assert!(edge < 2.0 * rest, "{name}, {look}, {sampling:?}: {edge} beside {rest}");
            }
        }
    }
}

#[test]
fn walls_that_rays_meet_aslant_cover_their_share() {
    let scenes = [
        ("perspective along z", look_from(DVec3::Z, PERSPECTIVE), plain()),
        ("perspective along y", look_from(DVec3::Y, PERSPECTIVE), plain()),
        ("oblique", look_from(OBLIQUE, ORTHOGRAPHIC), plain()),
        ("oblique perspective", look_from(OBLIQUE, PERSPECTIVE), plain()),
        ("crop box in perspective", look_from(-DVec3::Y, PERSPECTIVE), cropped()),
        ("oblique crop box", look_from(OBLIQUE, ORTHOGRAPHIC), cropped()),
        ("oblique clip plane", look_from(DVec3::Z, ORTHOGRAPHIC), clipped(DVec3::new(1.0, 0.6, 0.8))),
        ("clip plane through the eye", look_from(DVec3::Z, PERSPECTIVE), clipped(DVec3::new(1.0, 0.6, 0.0))),
        ("clip plane nearly along the rays", look_from(DVec3::Z, ORTHOGRAPHIC), clipped(DVec3::new(1.0, 0.6, 0.03))),
    ];
    for (name, camera, options) in scenes {
        let [edge, rest] = errors_at(&FAINT, &camera, &options, HIGH);
        assert!(edge < 2.0 * rest.max(5e-4), "{name}, faint: {edge} beside {rest}");
        let [edge, rest] = errors_at(&DENSE, &camera, &options, HIGH);
        assert!(edge < 0.012, "{name}, dense: {edge} beside {rest}");
    }
}

/// A pixel of a projection is as opaque as it is covered, and shows the value of its middle ray to the bit.
#[test]
fn projections_are_covered_by_shares() {
    let phantom = waves();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let gray = opacity_ramp(&[(0.0, 1.0)], Some(1.0));
    // A pixel is a sample: the outermost are samples of the wall, cut in half.
    let options = RenderOptions { width_px: 30, height_px: 26, composite: Composite::Maximum, ..plain() };
    let projection = Projection::Orthographic { parallel_scale: 13.0 * 1.1 };
    let square = Phantom { world_from_index: DAffine3::from_scale(DVec3::splat(1.1)), ..waves() };
    let square_volume = square.volume();
    let camera = camera_towards(square.centre(), DVec3::Z, 75.0, projection);
    let picture = render(&Slices::new(&square_volume, Kernel::Linear), &gray, &camera, &options, &()).unwrap().0;
    let values = picture.value.unwrap();
    for (k, value) in values.iter().enumerate() {
        let [x, y] = [k % 30, k / 30];
        let column = |i: usize, j: usize| (0..22).map(move |z| i + 30 * (j + 26 * z));
        let highest = |i: usize, j: usize| column(i, j).map(|at| square.samples[at]).fold(0.0, f32::max);
        // From +z with +y up, x runs to the right and y upwards.
        let want = highest(x, 25 - y);
        assert!(*value == want, "{x} {y}: {value} for {want}");
        let share = [x == 0 || x == 29, y == 0 || y == 25].map(|cut| if cut { 0.5 } else { 1.0 });
        let alpha = picture.rgba[k][3];
        assert!((alpha - share[0] * share[1]).abs() < 1e-6, "{x} {y}: {alpha} for {share:?}");
    }
    // Sums grow with the length of the ray, which falls to 0 at an edge that is seen obliquely.
    let options = RenderOptions { composite: Composite::Sum, oversampling: 2.0, ..plain() };
    let camera = look_from(OBLIQUE, ORTHOGRAPHIC);
    let sum = render(&slices, &gray, &camera, &options, &()).unwrap().0;
    let finer = RenderOptions { width_px: 160, height_px: 144, ..options };
    let finer = render(&slices, &gray, &camera, &finer, &()).unwrap().0;
    let has_edge = edge_pixels(&phantom, &camera, &plain());
    for k in (0..has_edge.len()).filter(|k| has_edge[*k]) {
        let [x, y] = [k % 40, k / 40];
        let within = |n: usize| (4 * x + n % 4) + 160 * (4 * y + n / 4);
        let covered = (0..16).map(|n| finer.rgba[within(n)][3]).sum::<f32>() / 16.0;
        assert!((sum.rgba[k][3] - covered).abs() < 0.1, "{x} {y}: {} for {covered}", sum.rgba[k][3]);
    }
}

/// The sum of even matter is the length of the middle ray in world units, also where that falls to 0 at an edge.
#[test]
fn sums_of_even_matter_are_the_lengths_of_rays() {
    let even = Phantom { samples: vec![10.0; waves().samples.len()], ..waves() };
    let volume = even.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let gray = opacity_ramp(&FAINT, Some(1.0));
    for (name, camera, options) in [
        ("oblique", look_from(OBLIQUE, ORTHOGRAPHIC), plain()),
        ("oblique perspective", look_from(OBLIQUE, PERSPECTIVE), plain()),
        ("crop box along an axis", look_from(DVec3::Z, ORTHOGRAPHIC), cropped()),
        ("oblique crop box", look_from(OBLIQUE, ORTHOGRAPHIC), cropped()),
    ] {
        let options = RenderOptions { composite: Composite::Sum, oversampling: 2.0, ..options };
        let picture = render(&slices, &gray, &camera, &options, &()).unwrap().0;
        let region = Region::new(volume.grid(), &options).unwrap();
        let rays = IndexRays::new(&camera, volume.grid().index_from_world(), options.width_px, options.height_px);
        let start = if matches!(camera.projection(), Projection::Perspective { .. }) { 0.0 } else { f64::NEG_INFINITY };
        let has_edge = edge_pixels(&even, &camera, &options);
        let mut n_compared = 0;
        for (k, value) in picture.value.unwrap().iter().enumerate().filter(|(k, _)| has_edge[*k]) {
            let [x, y] = [k % options.width_px, k / options.width_px].map(|px| px as f64 + 0.5);
            let (origin, direction) = (rays.origin(x, y), rays.direction(x, y));
            let [lo, hi] = region.passage(origin, direction, [start, f64::INFINITY]).ends;
            if lo < hi {
                let want = 10.0 * (hi - lo) * (volume.grid().world_from_index().matrix3 * direction).length();
                // A texel's ray that is much shorter than the pixel's gives no length: the nearest other texels do.
                let near = 1e-3 * want + 1e-2;
                assert!((f64::from(*value) - want).abs() < near, "{name}, {x} {y}: {value} for {want}");
                n_compared += 1;
            }
        }
        assert!(n_compared > 20, "{name}: {n_compared} rays in the middle of pixels with an edge");
    }
}

/// Depth ends where what is drawn ends, though texels beyond the wall are drawn.
#[test]
fn beyond_a_wall_there_is_no_depth() {
    let phantom = waves();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let tf = opacity_ramp(&DENSE, Some(1.0));
    let camera = look_from(DVec3::Z, ORTHOGRAPHIC);
    let options = RenderOptions { with_depth: true, ..cropped() };
    let picture = render(&slices, &tf, &camera, &options, &()).unwrap().0;
    let region = Region::new(volume.grid(), &options).unwrap();
    let rays = IndexRays::new(&camera, volume.grid().index_from_world(), 40, 36);
    let depth = picture.depth.unwrap();
    let mut n_seen = 0;
    for (k, depth) in depth.iter().enumerate() {
        let [x, y] = [(k % 40) as f64 + 0.5, (k / 40) as f64 + 0.5];
        let [lo, hi] = region.passage(rays.origin(x, y), rays.direction(x, y), [f64::NEG_INFINITY, f64::INFINITY]).ends;
        assert_eq!(depth.is_finite(), lo < hi, "{x} {y}: {depth}");
        n_seen += usize::from(lo < hi);
    }
    assert!(n_seen > 200);
}

/// Two volumes whose boxes end in different places.
#[test]
fn layers_end_where_their_own_boxes_do() {
    let parts = [waves(), Phantom { world_from_index: placed(), ..waves() }];
    let volumes = [parts[0].volume(), parts[1].volume()];
    let slices = volumes.each_ref().map(|volume| Slices::new(volume, Kernel::Linear));
    let functions = [opacity_ramp(&FAINT, Some(1.0)), opacity_ramp(&DENSE, Some(1.0))];
    let caches = [VisibilityCache::default(), VisibilityCache::default()];
    let options = RenderOptions { sheets_per_slice: 3.0, oversampling: 2.0, ..plain() };
    let camera = look_from(DVec3::Z, ORTHOGRAPHIC);
    let layer = |k: usize| Layer {
        slices: &slices[k],
        transfer_function: &functions[k],
        shading: None,
        labels: None,
        color: None,
        cache: &caches[k],
    };
    let cast = |k: usize| CastLayer {
        volume: &volumes[k],
        transfer_function: &functions[k],
        shading: None,
        labels: None,
        color: None,
    };
    let drawn = render_layers(&[layer(0), layer(1)], &camera, &options, &()).unwrap().0;
    let converged = raycast_layers(&[cast(0), cast(1)], &camera, &options, SAMPLING, &()).unwrap();
    let error = psnr_db(&drawn.rgba, &converged.rgba);
    assert!(error > 42.0, "{error} dB");
}

/// Where boxes overlap in a strip that is narrower than a texel, rays meet layers together that no texel's ray does.
#[test]
fn boxes_that_overlap_in_less_than_a_texel_leave_no_gap() {
    let even = |x: f64| Phantom {
        samples: vec![200.0; waves().samples.len()],
        world_from_index: DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)),
        ..waves()
    };
    let function = opacity_ramp(&[(0.0, 0.9)], Some(1.0));
    let options = RenderOptions { width_px: 64, height_px: 24, ..plain() };
    for overlap in [0.1, 0.3, 0.6] {
        let parts = [even(0.0), even(29.0 - overlap)];
        let volumes = parts.each_ref().map(Phantom::volume);
        let slices = volumes.each_ref().map(|volume| Slices::new(volume, Kernel::Linear));
        let caches = [VisibilityCache::default(), VisibilityCache::default()];
        let layers = [0, 1].map(|k| Layer {
            slices: &slices[k],
            transfer_function: &function,
            shading: None,
            labels: None,
            color: None,
            cache: &caches[k],
        });
        let middle = parts[0].centre() + DVec3::new(0.5 * (29.0 - overlap), 0.0, 0.0);
        let camera = camera_towards(middle, DVec3::Z, 75.0, Projection::Orthographic { parallel_scale: 12.0 });
        let picture = render_layers(&layers, &camera, &options, &()).unwrap().0;
        for x in 28..36 {
            let alpha = picture.rgba[12 * 64 + x][3];
            assert!(alpha > 0.99, "{overlap}, column {x}: {alpha}");
        }
    }
}

/// Affine of a volume half as large, and beyond the first one on two sides.
fn placed() -> DAffine3 {
    DAffine3 { translation: DVec3::new(-2.3, 7.4, 5.1), ..DAffine3::from_scale(DVec3::new(0.5, 0.55, 0.65)) }
}
