//! Several volumes in one picture, against the ray caster, which mixes media point by point.

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, ColorNode, Crop, Gradient, GradientNode, Kernel, LabelLook, OpacityNode, Picture, Projection,
    RenderOptions, Shading, TransferFunction, TransferFunction2D,
};
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::render::piece::{draw_piece, finish_tile, tiles_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, Report, render_layers, with_threads};
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast_layers};
use wavesplat_testkit::{Phantom, camera_towards, psnr_db};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 4 };

/// A volume, its look, and its light.
struct Part {
    phantom: Phantom,
    tf: TransferFunction,
    shading: Option<Shading>,
}

fn function(nodes: &[(f64, f64)], rgb: [f64; 3]) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb }], Some(1.0)).unwrap()
}

/// A soft ball in the world, on a grid.
fn ball(size: [usize; 3], world_from_index: DAffine3, centre: DVec3, radius: f64) -> Phantom {
    Phantom::sample(size, world_from_index, |p| (120.0 + 25.0 * (radius - p.distance(centre))).clamp(0.0, 250.0))
}

fn placed(spacing: DVec3, origin: DVec3) -> DAffine3 {
    DAffine3 { translation: origin, ..DAffine3::from_scale(spacing) }
}

const SOFT: [(f64, f64); 2] = [(60.0, 0.0), (240.0, 0.25)];
const HARD: [(f64, f64); 2] = [(118.0, 0.0), (121.0, 0.9)];

/// Two overlapping balls, the second on a grid of its own, beyond the first one's box on one side.
fn two(nodes: &[(f64, f64)]) -> Vec<Part> {
    let light = Shading { gradient: Gradient::Difference(1.0), ..Shading::headlight() };
    vec![
        Part {
            phantom: ball([26, 25, 24], DAffine3::IDENTITY, DVec3::new(10.0, 12.0, 11.0), 7.0),
            tf: function(nodes, [1.0, 0.4, 0.2]),
            shading: Some(light.clone()),
        },
        Part {
            phantom: ball(
                [18, 14, 20],
                placed(DVec3::new(1.5, 2.0, 1.25), DVec3::new(4.3, -2.5, 0.4)),
                DVec3::new(17.0, 11.0, 13.0),
                6.5,
            ),
            tf: function(nodes, [0.2, 0.5, 1.0]),
            shading: Some(light),
        },
    ]
}

fn camera(projection: Projection) -> Camera {
    camera_towards(DVec3::new(14.0, 12.0, 12.0), DVec3::new(0.7, -0.6, 0.4), 60.0, projection)
}

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 15.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

fn fine() -> RenderOptions {
    RenderOptions { width_px: 72, height_px: 64, sheets_per_slice: 4.0, oversampling: 2.0, ..RenderOptions::default() }
}

fn draw(parts: &[Part], labels: Option<&Labels>, camera: &Camera, options: &RenderOptions) -> (Picture, Report) {
    let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
    let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, Kernel::Linear)).collect();
    let caches: Vec<_> = parts.iter().map(|_| VisibilityCache::default()).collect();
    let layers: Vec<Layer> = (0..parts.len())
        .map(|k| Layer {
            slices: &slices[k],
            transfer_function: &parts[k].tf,
            shading: parts[k].shading.as_ref(),
            labels: labels.filter(|_| k == 0),
            color: None,
            cache: &caches[k],
        })
        .collect();
    render_layers(&layers, camera, options, &()).unwrap()
}

fn cast(parts: &[Part], labels: Option<&Labels>, camera: &Camera, options: &RenderOptions) -> Picture {
    let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
    let layers: Vec<CastLayer> = (0..parts.len())
        .map(|k| CastLayer {
            volume: &volumes[k],
            transfer_function: &parts[k].tf,
            shading: parts[k].shading.as_ref(),
            labels: labels.filter(|_| k == 0),
            color: None,
        })
        .collect();
    raycast_layers(&layers, camera, options, SAMPLING, &()).unwrap()
}

#[test]
fn layers_are_those_of_the_ray_caster() {
    let crop = Crop::World { lo: DVec3::new(-5.0, -5.0, 3.0), hi: DVec3::new(40.0, 12.0, 40.0) };
    for (name, nodes, least_db) in [("soft", &SOFT[..], 45.0), ("hard", &HARD[..], 38.0)] {
        for (projection, crop) in [(ORTHOGRAPHIC, None), (PERSPECTIVE, None), (ORTHOGRAPHIC, Some(crop))] {
            let options = RenderOptions { crop, ..fine() };
            let (parts, camera) = (two(nodes), camera(projection));
            let want = cast(&parts, None, &camera, &options);
            let got = draw(&parts, None, &camera, &options).0;
            let db = psnr_db(&got.rgba, &want.rgba);
            println!("{name} {projection:?} {}: {db:.1} dB", crop.is_some());
            assert!(db >= least_db, "{name} {projection:?}: {db}");
            // The second layer contributes to the picture.
            assert!(psnr_db(&draw(&parts[..1], None, &camera, &options).0.rgba, &want.rgba) < least_db - 10.0);
        }
    }
}

#[test]
fn four_layers_of_all_kinds() {
    let mut parts = two(&SOFT);
    let coloured = |nodes: &[(f64, f64)], rgb| function(nodes, rgb);
    parts.push(Part {
        phantom: ball([30, 30, 30], DAffine3::IDENTITY, DVec3::new(13.0, 16.0, 8.0), 5.0),
        tf: coloured(&HARD, [0.3, 1.0, 0.3]),
        shading: Some(Shading { gradient: Gradient::Smoothed(0.8), ..Shading::default() }),
    });
    parts.push(Part {
        phantom: ball(
            [12, 12, 12],
            placed(DVec3::new(2.5, 2.5, -2.5), DVec3::new(2.0, 1.0, 28.0)),
            DVec3::new(14.0, 8.0, 16.0),
            9.0,
        ),
        tf: coloured(&[(10.0, 0.0), (250.0, 0.05)], [1.0, 1.0, 0.4]),
        shading: None,
    });
    let options = RenderOptions { shading: Some(Shading::default()), ..fine() };
    for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
        let camera = camera(projection);
        let want = cast(&parts, None, &camera, &options);
        let got = draw(&parts, None, &camera, &options).0;
        let db = psnr_db(&got.rgba, &want.rgba);
        println!("{projection:?}: {db:.1} dB");
        assert!(db >= 38.0, "{db}");
        parts.swap(1, 3);
        let other_order = draw(&parts, None, &camera, &options).0;
        assert!(psnr_db(&other_order.rgba, &got.rgba) > 90.0, "{}", psnr_db(&other_order.rgba, &got.rgba));
        parts.swap(0, 2);
        let other_first = draw(&parts, None, &camera, &options).0;
        assert!(psnr_db(&other_first.rgba, &want.rgba) >= 38.0);
        parts.swap(0, 2);
        parts.swap(1, 3);
    }
}

/// Features of few layers: gradient opacity, a two-dimensional function beside a hard one, and holes.
#[test]
fn gradients_decide_and_holes_are_empty_in_layers_too() {
    let row = |rgb: [f64; 3], most: f64| [0.0, most, most, 0.0].map(|a| [rgb[0], rgb[1], rgb[2], a]);
    let rgba = [row([1.0, 0.2, 0.1], 0.02), row([0.9, 0.8, 0.2], 0.1), row([0.1, 0.3, 1.0], 0.3)].concat();
    let joint = TransferFunction2D::new(vec![60.0, 110.0, 170.0, 230.0], vec![0.0, 10.0, 30.0], rgba).unwrap();
    let nodes = [(0.0, 0.0), (30.0, 1.0)].map(|(magnitude, factor)| GradientNode { magnitude, factor });
    let by_gradient = two(&SOFT)[0].tf.clone().with_gradient_opacity(nodes.to_vec()).unwrap();
    let options = RenderOptions { sheets_per_slice: 8.0, ..fine() };
    for (name, tf, least_db) in [
        ("two dimensions", TransferFunction::two_dimensional(joint, Some(1.0)).unwrap(), 38.0),
        ("gradient opacity", by_gradient, 38.0),
    ] {
        for other in [&SOFT, &HARD] {
            let mut parts = two(other);
            parts[0].tf = tf.clone();
            let n = parts[1].phantom.size;
            for z in 4..9 {
                parts[1].phantom.samples[(z * n[1] + 6) * n[0] + 5] = f32::NAN;
            }
            let camera = camera(ORTHOGRAPHIC);
            let want = cast(&parts, None, &camera, &options);
            let db = psnr_db(&draw(&parts, None, &camera, &options).0.rgba, &want.rgba);
            println!("{name}: {db:.1} dB");
            assert!(db >= least_db, "{name}: {db}");
            parts[0].tf = two(&SOFT).swap_remove(0).tf;
            assert!(psnr_db(&draw(&parts, None, &camera, &options).0.rgba, &want.rgba) < db - 5.0, "{name}");
        }
    }
}

/// Cuts by tiles and sheets, vectors of any width and any number of threads give the same bits.
#[test]
fn the_bits_do_not_depend_on_how_it_is_drawn() {
    for nodes in [SOFT, HARD] {
        let parts = two(&nodes);
        let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
        let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, Kernel::CatmullRom)).collect();
        let slices: Vec<&Slices> = slices.iter().collect();
        let cache = VisibilityCache::default();
        let layers: Vec<Layer> = (0..parts.len())
            .map(|k| Layer {
                slices: slices[k],
                transfer_function: &parts[k].tf,
                shading: parts[k].shading.as_ref(),
                labels: None,
                color: None,
                cache: &cache,
            })
            .collect();
        let options = RenderOptions { sheets_per_slice: 2.0, with_depth: true, ..fine() };
        let bits = |pictures: &[BasePicture]| {
            let texels = pictures.iter().flat_map(BasePicture::texels).flatten().map(f32::to_bits);
            let depths = pictures.iter().flat_map(|picture| picture.w_half.iter()).map(|w| w.to_bits());
            texels.chain(depths).collect::<Vec<u32>>()
        };
        for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
            let plan = |level| Plan::new(level, &layers, &camera(projection), &options).unwrap();
            let whole_plan = plan(Level::best());
            let want = bits(&draw_base_planes(&whole_plan, &slices, &()).unwrap().0);
            assert!(want.len() > 10_000);
            for level in Level::all() {
                assert!(bits(&draw_base_planes(&plan(level), &slices, &()).unwrap().0) == want, "{}", level.name());
            }
            let draw = || with_threads(Some(1), || draw_base_planes(&whole_plan, &slices, &()));
            assert!(bits(&draw().unwrap().0) == want);
            let mut cut = Vec::new();
            for (f, family) in whole_plan.families.iter().enumerate() {
                let (tiles, n) = (tiles_of(&whole_plan, f), family.spacing.n_slabs);
                let mut states = vec![None; tiles.len()];
                for slabs in [0..n / 3, n / 3..n / 3 + 1, n / 3 + 1..n / 2, n / 2..n] {
                    (states, _) = draw_piece(&whole_plan, f, &tiles, &slabs, &slices, &states, &()).unwrap();
                }
                let states: Vec<_> = states.into_iter().map(std::sync::Mutex::new).collect();
                let mut picture = BasePicture::new(family.plane.clone(), true);
                picture.fill_tiles([TILE_U, TILE_V], |k, texels| {
                    let state = states[k].lock().unwrap().take();
                    finish_tile(&whole_plan, f, tiles[k], state, texels);
                });
                cut.push(picture);
            }
            assert!(bits(&cut) == want, "cut, {projection:?}");
        }
    }
}

#[test]
fn labels_stay_beside_the_first_layer() {
    let parts = two(&SOFT);
    let n = parts[0].phantom.size;
    let code = |i: usize| {
        let p = DVec3::new((i % n[0]) as f64, (i / n[0] % n[1]) as f64, (i / (n[0] * n[1])) as f64);
        u8::from(p.distance(DVec3::new(8.0, 13.0, 9.0)) < 4.0) + 2 * u8::from(p.z > 15.0)
    };
    let codes: Vec<u8> = (0..n.iter().product()).map(code).collect();
    let solid = LabelLook { rgb: [0.9, 0.9, 0.1], opacity: 0.5, scan: 0.2, tint: 0.0 };
    let tinted = LabelLook { rgb: [0.1, 0.9, 0.2], tint: 0.8, scan: 0.5, ..LabelLook::NONE };
    let looks = vec![LabelLook::NONE, solid, tinted, LabelLook::NONE];
    let volume = parts[0].phantom.volume();
    let labels = Labels::new(Codes::U8(codes.into()), looks, volume.grid(), Kernel::Linear, 1 << 24).unwrap();
    let camera = camera(ORTHOGRAPHIC);
    let want = cast(&parts, Some(&labels), &camera, &fine());
    let got = draw(&parts, Some(&labels), &camera, &fine()).0;
    let db = psnr_db(&got.rgba, &want.rgba);
    println!("{db:.1} dB");
    assert!(db >= 42.0, "{db}");
    assert!(psnr_db(&draw(&parts, None, &camera, &fine()).0.rgba, &want.rgba) < db - 20.0);
}

/// Extinctions add: a layer twice with half of it is the layer.
#[test]
fn two_halves_are_one() {
    for (nodes, least_db) in [(SOFT, 70.0), (HARD, 45.0)] {
        let whole = two(&nodes).swap_remove(0);
        let halved = nodes.map(|(value, opacity)| (value, 1.0 - f64::sqrt(1.0 - opacity)));
        // Between nodes opacity is linear, not extinction: many nodes follow the root of the curve.
        let many: Vec<(f64, f64)> = (0..=200)
            .map(|k| {
                let share = f64::from(k) / 200.0;
                let value = nodes[0].0 + share * (nodes[1].0 - nodes[0].0);
                (value, 1.0 - (1.0 - share * nodes[1].1).sqrt())
            })
            .collect();
        assert_eq!(many.last().map(|node| node.1), Some(halved[1].1));
        let half = || Part { tf: function(&many, [1.0, 0.4, 0.2]), ..two(&nodes).swap_remove(0) };
        let camera = camera(ORTHOGRAPHIC);
        let once = draw(&[whole], None, &camera, &fine()).0;
        let twice = draw(&[half(), half()], None, &camera, &fine()).0;
        let db = psnr_db(&twice.rgba, &once.rgba);
        println!("{db:.1} dB");
        assert!(db >= least_db, "{db}");
    }
}

#[test]
fn what_lies_behind_a_wall_is_hidden() {
    let wall = Part {
        phantom: Phantom::sample([20, 20, 20], DAffine3::IDENTITY, |p| if p.y < 6.0 { 200.0 } else { 0.0 }),
        tf: function(&HARD, [1.0; 3]),
        shading: None,
    };
    let spot = Part {
        phantom: ball([20, 20, 20], DAffine3::IDENTITY, DVec3::new(10.0, 13.0, 10.0), 4.0),
        tf: function(&HARD, [1.0, 0.0, 0.0]),
        shading: None,
    };
    let parts = [spot, wall];
    let seen_from = |y: f64| {
        let camera = camera_towards(DVec3::splat(9.5), DVec3::new(0.0, y, 0.0), 60.0, ORTHOGRAPHIC);
        let picture = draw(&parts, None, &camera, &fine()).0;
        picture.rgba.iter().filter(|[r, g, _, _]| *r > 0.5 && *g < 0.1).count()
    };
    assert_eq!(seen_from(-1.0).min(seen_from(1.0)), 0);
    assert!(seen_from(-1.0).max(seen_from(1.0)) > 100);
}

#[test]
fn oblique_layers_and_too_many_are_refused() {
    let turned = |parts: &mut Vec<Part>| parts[1].phantom.world_from_index *= DAffine3::from_rotation_x(0.2);
    let mut parts = two(&SOFT);
    turned(&mut parts);
    let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
    let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, Kernel::Linear)).collect();
    let cache = VisibilityCache::default();
    let layer = |k: usize| Layer {
        slices: &slices[k],
        transfer_function: &parts[k].tf,
        shading: None,
        labels: None,
        color: None,
        cache: &cache,
    };
    let error = |layers: &[Layer]| render_layers(layers, &camera(ORTHOGRAPHIC), &fine(), &()).unwrap_err().to_string();
    assert!(error(&[layer(0), layer(1)]).contains("parallel"), "{}", error(&[layer(0), layer(1)]));
    assert!(error(&[layer(0); 9]).contains("1 to 8"));
    assert!(error(&[]).contains("1 to 8"));
}
