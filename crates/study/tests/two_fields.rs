//! Layers that a second field colours: equal fields give the picture of one, and the ray caster agrees.

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, ColorNode, Composite, Gradient, Kernel, OpacityNode, Picture, Projection, RenderOptions, Result, Shading,
    TransferFunction, TransferFunction2D,
};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::frame::{draw_base_planes, slices_of};
use wavesplat_splat::render::piece::{draw_piece, finish_tile, tiles_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{ColorField, Layer, render_layers, with_threads};
use wavesplat_study::reference::color_field::CastColor;
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast_layers};
use wavesplat_testkit::{Phantom, camera_towards, psnr_db};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 4 };
const SIZE: [usize; 3] = [26, 25, 24];
const CENTRE: DVec3 = DVec3::new(12.0, 12.5, 11.0);
const SOFT: [(f64, f64); 2] = [(60.0, 0.0), (240.0, 0.25)];
const HARD: [(f64, f64); 2] = [(118.0, 0.0), (121.0, 0.9)];
const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 15.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

/// A layer, and the field that colours it.
struct Part<'a> {
    phantom: &'a Phantom,
    tf: TransferFunction,
    shading: Option<Shading>,
    color: Option<(&'a Phantom, TransferFunction)>,
}

fn function(opacity: &[(f64, f64)], color: &[(f64, [f64; 3])]) -> TransferFunction {
    let opacity = opacity.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = color.iter().map(|&(value, rgb)| ColorNode { value, rgb }).collect();
    TransferFunction::new(opacity, color, Some(1.0)).unwrap()
}

/// Opacity by the nodes, colours over the values of a ball.
fn of_ball(opacity: &[(f64, f64)]) -> TransferFunction {
    function(opacity, &[(60.0, [0.9, 0.1, 0.2]), (130.0, [0.2, 0.9, 0.3]), (240.0, [0.2, 0.4, 1.0])])
}

/// Black at 0 to red at 24, with a little green.
fn along_x() -> TransferFunction {
    function(&[(0.0, 1.0)], &[(0.0, [0.0, 0.25, 0.0]), (24.0, [1.0, 0.25, 0.0])])
}

/// A soft ball: 120 at a radius of 7.
fn ball() -> Phantom {
    Phantom::sample(SIZE, DAffine3::IDENTITY, |p| (120.0 + 25.0 * (7.0 - p.distance(CENTRE))).clamp(0.0, 250.0))
}

fn camera(projection: Projection) -> Camera {
    camera_towards(CENTRE, DVec3::new(0.7, -0.6, 0.4), 60.0, projection)
}

fn light() -> Shading {
    Shading { gradient: Gradient::Difference(1.0), ..Shading::headlight() }
}

fn fine(composite: Composite) -> RenderOptions {
    RenderOptions {
        width_px: 48,
        height_px: 44,
        sheets_per_slice: 4.0,
        oversampling: 2.0,
        composite,
        ..RenderOptions::default()
    }
}

/// Calls `work` with the layers of parts.
fn with_layers<T>(parts: &[Part], kernel: Kernel, work: impl FnOnce(&[Layer]) -> T) -> T {
    let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
    let fields: Vec<_> = parts.iter().map(|part| part.color.as_ref().map(|(field, _)| field.volume())).collect();
    let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, kernel)).collect();
    let colors: Vec<_> = fields.iter().map(|field| field.as_ref().map(|field| Slices::new(field, kernel))).collect();
    let caches: Vec<_> = parts.iter().map(|_| [VisibilityCache::default(), VisibilityCache::default()]).collect();
    let layers: Vec<Layer> = (0..parts.len())
        .map(|k| Layer {
            slices: &slices[k],
            transfer_function: &parts[k].tf,
            shading: parts[k].shading.as_ref(),
            labels: None,
            color: colors[k].as_ref().zip(parts[k].color.as_ref()).map(|(slices, (_, tf))| ColorField {
                slices,
                transfer_function: tf,
                cache: &caches[k][1],
            }),
            cache: &caches[k][0],
        })
        .collect();
    work(&layers)
}

fn draw(parts: &[Part], kernel: Kernel, camera: &Camera, options: &RenderOptions) -> Result<Picture> {
    with_layers(parts, kernel, |layers| Ok(render_layers(layers, camera, options, &())?.0))
}

fn cast(parts: &[Part], camera: &Camera, options: &RenderOptions) -> Picture {
    let volumes: Vec<_> = parts.iter().map(|part| part.phantom.volume()).collect();
    let fields: Vec<_> = parts.iter().map(|part| part.color.as_ref().map(|(field, _)| field.volume())).collect();
    let layers: Vec<CastLayer> = (0..parts.len())
        .map(|k| CastLayer {
            volume: &volumes[k],
            transfer_function: &parts[k].tf,
            shading: parts[k].shading.as_ref(),
            labels: None,
            color: fields[k]
                .as_ref()
                .zip(parts[k].color.as_ref())
                .map(|(volume, (_, transfer_function))| CastColor { volume, transfer_function }),
        })
        .collect();
    raycast_layers(&layers, camera, options, SAMPLING, &()).unwrap()
}

/// Bits of the colours of all pixels.
fn bits(picture: &Picture) -> Vec<[u32; 4]> {
    picture.rgba.iter().map(|rgba| rgba.map(f32::to_bits)).collect()
}

/// A ball with a hole of missing samples near its surface.
fn holed(mut phantom: Phantom) -> Phantom {
    for (k, sample) in phantom.samples.iter_mut().enumerate() {
        let [x, y, z] = [k % SIZE[0], k / SIZE[0] % SIZE[1], k / SIZE[0] / SIZE[1]];
        if (14..19).contains(&x) && (4..10).contains(&y) && (9..15).contains(&z) {
            *sample = f32::NAN;
        }
    }
    phantom
}

#[test]
fn equal_fields_give_the_picture_of_one_to_the_bit() {
    let (whole, holed) = (ball(), holed(ball()));
    let other = Phantom::sample([20, 20, 20], DAffine3::from_scale(DVec3::splat(1.3)), |p| 10.0 * p.y);
    for phantom in [&whole, &holed] {
        let twin = phantom.clone();
        for (nodes, shading) in
            [(&SOFT[..], None), (&HARD, Some(light())), (&[(60.0, 0.0), (240.0, 1.0)], Some(light()))]
        {
            for kernel in [Kernel::Linear, Kernel::Bspline3] {
                for (projection, n_layers) in [(ORTHOGRAPHIC, 1), (PERSPECTIVE, 1), (ORTHOGRAPHIC, 2)] {
                    let parts = |color: Option<(&'_ Phantom, TransferFunction)>| {
                        let first = Part { phantom, tf: of_ball(nodes), shading: shading.clone(), color };
                        let second = Part {
                            phantom: &other,
                            tf: function(&[(90.0, 0.0), (180.0, 0.1)], &[(0.0, [1.0, 1.0, 0.2])]),
                            shading: None,
                            color: None,
                        };
                        // The picture is drawn here, since parts borrow.
                        let parts = if n_layers == 1 { vec![first] } else { vec![first, second] };
                        draw(&parts, kernel, &camera(projection), &fine(Composite::Over)).unwrap()
                    };
                    let (one, two) = (parts(None), parts(Some((&twin, of_ball(nodes)))));
                    assert!(one.rgba.iter().any(|rgba| rgba[3] > 0.3), "{kernel:?}");
                    assert!(bits(&one) == bits(&two), "{nodes:?} {kernel:?} {projection:?} {n_layers}");
                }
            }
        }
    }
}

#[test]
fn a_surface_coloured_by_its_own_value_has_the_colour_of_that_value() {
    let phantom = ball();
    let twin = phantom.clone();
    for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
        let options = fine(Composite::FirstHit { iso_value: 130.0 });
        let part = |color| [Part { phantom: &phantom, tf: of_ball(&SOFT), shading: Some(light()), color }];
        let one = draw(&part(None), Kernel::Linear, &camera(projection), &options).unwrap();
        let two = draw(&part(Some((&twin, of_ball(&SOFT)))), Kernel::Linear, &camera(projection), &options).unwrap();
        // The value at a crossing is the surface's but for the rounding of its place.
        let byte = |rgba: &[f32; 4]| rgba.map(|c| (255.0 * c).round());
        assert!(one.rgba.iter().zip(&two.rgba).all(|(a, b)| byte(a) == byte(b)));
    }
}

#[test]
fn a_sphere_coloured_by_x_is_linear_in_x() {
    let phantom = ball();
    // On a coarser grid of its own, whose ends lie inside of the ends of the ball's.
    let coarse = DAffine3 { translation: DVec3::splat(0.5), ..DAffine3::from_scale(DVec3::new(2.4, 3.1, 2.9)) };
    let fields = [Phantom::sample(SIZE, DAffine3::IDENTITY, |p| p.x), Phantom::sample([11, 9, 9], coarse, |p| p.x)];
    for field in &fields {
        for composite in [Composite::FirstHit { iso_value: 120.0 }, Composite::Over] {
            // Orthographic along y, so that columns of pixels are places along x.
            let eye = camera_towards(CENTRE, DVec3::new(0.0, -1.0, 0.0), 60.0, ORTHOGRAPHIC);
            let options = fine(composite);
            let parts =
                [Part { phantom: &phantom, tf: of_ball(&HARD), shading: None, color: Some((field, along_x())) }];
            let picture = draw(&parts, Kernel::Linear, &eye, &options).unwrap();
            let per_px = 2.0 * 15.0 / options.height_px as f64;
            let mut n_seen = 0;
            for (k, rgba) in picture.rgba.iter().enumerate() {
                if rgba[3] < 0.999 {
                    continue;
                }
                n_seen += 1;
                let x = CENTRE.x + ((k % options.width_px) as f64 + 0.5 - options.width_px as f64 / 2.0) * per_px;
                let off = 255.0 * (f64::from(rgba[0]) - x / 24.0);
                assert!(off.abs() <= 2.0, "{composite:?}, x {x}: {off} levels");
                assert!((rgba[1] - 0.25).abs() < 1e-3, "{rgba:?}");
            }
            assert!(n_seen > 200, "{n_seen}");
        }
    }
}

#[test]
fn colours_are_those_of_the_ray_caster() {
    let (phantom, hole) = (ball(), holed(ball()));
    let field = Phantom::sample(SIZE, DAffine3::IDENTITY, |p| 12.0 + 9.0 * (0.7 * p.x + 0.4 * p.z).sin());
    let holed_field = holed(field.clone());
    for (name, nodes, least_db) in [("soft", &SOFT[..], 60.0), ("hard", &HARD[..], 50.0)] {
        for (phantom, field, projections) in [
            (&phantom, &field, &[ORTHOGRAPHIC, PERSPECTIVE][..]),
            (&hole, &field, &[ORTHOGRAPHIC]),
            (&phantom, &holed_field, &[PERSPECTIVE]),
        ] {
            for &projection in projections {
                let parts =
                    [Part { phantom, tf: of_ball(nodes), shading: Some(light()), color: Some((field, along_x())) }];
                let (camera, options) = (camera(projection), fine(Composite::Over));
                let want = cast(&parts, &camera, &options);
                let got = draw(&parts, Kernel::Linear, &camera, &options).unwrap();
                let db = psnr_db(&got.rgba, &want.rgba);
                println!("{name} {projection:?}: {db:.1} dB");
                assert!(db >= least_db, "{name} {projection:?}: {db}");
                // The field matters.
                let [Part { tf, shading, .. }] = parts;
                let alone = [Part { phantom, tf, shading, color: None }];
                let other = draw(&alone, Kernel::Linear, &camera, &options).unwrap();
                assert!(psnr_db(&other.rgba, &want.rgba) < least_db - 10.0);
            }
        }
    }
}

/// Opaque in a band of both values, red to blue along the second.
fn of_two_fields() -> TransferFunction {
    let rows = [0.0, 0.15, 0.3, 0.0];
    let rgba = rows.iter().zip([0.0, 0.3, 0.7, 1.0]).flat_map(|(alpha, place): (&f64, f64)| {
        [0.0, *alpha, 0.5 * alpha].map(|alpha| [1.0 - place, 0.3, place, alpha])
    });
    let joint = TransferFunction2D::of_fields(vec![60.0, 140.0, 250.0], vec![-9.0, -3.0, 4.0, 10.0], rgba.collect());
    TransferFunction::two_dimensional(joint.unwrap(), Some(1.0)).unwrap()
}

#[test]
fn functions_of_two_fields_are_those_of_the_ray_caster() {
    let (phantom, fog) = (ball(), Phantom::fog(SIZE, DAffine3::IDENTITY, 100.0));
    // Negative values, which no gradient magnitude has.
    let field = Phantom::sample(SIZE, DAffine3::IDENTITY, |p| 9.0 * (0.4 * p.x + 0.3 * p.z).sin());
    for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
        for n_layers in [1, 2] {
            let (camera, options) = (camera(projection), fine(Composite::Over));
            let first = Part {
                phantom: &phantom,
                tf: of_two_fields(),
                shading: Some(light()),
                color: Some((&field, along_x())),
            };
            let second = Part {
                phantom: &fog,
                tf: function(&[(0.0, 0.005)], &[(0.0, [0.4, 1.0, 0.4])]),
                shading: None,
                color: None,
            };
            let parts = if n_layers == 1 { vec![first] } else { vec![first, second] };
            let want = cast(&parts, &camera, &options);
            let got = draw(&parts, Kernel::Linear, &camera, &options).unwrap();
            let db = psnr_db(&got.rgba, &want.rgba);
            println!("{projection:?} {n_layers}: {db:.1} dB");
            assert!(db >= 60.0 && want.rgba.iter().any(|rgba| rgba[3] > 0.5), "{db}");
        }
    }
}

#[test]
fn pieces_and_threads_give_the_same_bytes() {
    let phantom = ball();
    let field = holed(Phantom::sample(SIZE, DAffine3::IDENTITY, |p| 9.0 * (0.4 * p.x + 0.3 * p.z).sin()));
    for (composite, tf) in [
        (Composite::Over, of_ball(&SOFT)),
        (Composite::Over, of_ball(&HARD)),
        (Composite::Over, of_two_fields()),
        (Composite::FirstHit { iso_value: 120.0 }, of_ball(&HARD)),
    ] {
        let parts = [Part { phantom: &phantom, tf, shading: Some(light()), color: Some((&field, along_x())) }];
        with_layers(&parts, Kernel::Linear, |layers| {
            let (camera, options) = (camera(PERSPECTIVE), fine(composite));
            let plan = Plan::new(Level::best(), layers, &camera, &options).unwrap();
            let slices = slices_of(layers);
            let (whole, _) = draw_base_planes(&plan, &slices, &()).unwrap();
            let (alone, _) = with_threads(Some(1), || draw_base_planes(&plan, &slices, &())).unwrap();
            let is_seen = |picture: &BasePicture| picture.texels().iter().any(|texel| texel[3] > 0.3);
            assert!(whole.iter().any(is_seen), "{composite:?}");
            for (family, (whole, alone)) in whole.iter().zip(&alone).enumerate() {
                let tiles = tiles_of(&plan, family);
                let mut states = vec![None; tiles.len()];
                let n_slabs = plan.families[family].spacing.n_slabs;
                for cut in [0, n_slabs / 3, n_slabs / 3 + 1, n_slabs].windows(2) {
                    let range = cut[0]..cut[1];
                    states = draw_piece(&plan, family, &tiles, &range, &slices, &states, &()).unwrap().0;
                }
                let mut joined = BasePicture::new(plan.families[family].plane.clone(), plan.with_depth);
                joined.fill_tiles([TILE_U, TILE_V], |k, texels| {
                    finish_tile(&plan, family, tiles[k], states[k].clone(), texels);
                });
                let bits = |picture: &BasePicture| -> Vec<[u32; 4]> {
                    picture.texels().iter().map(|texel| texel.map(f32::to_bits)).collect()
                };
                assert!(bits(whole) == bits(&joined) && bits(whole) == bits(alone), "{composite:?}");
            }
        });
    }
}

#[test]
fn what_two_fields_cannot_be_drawn_with_is_refused() {
    let (phantom, small) = (ball(), Phantom::fog([9; 3], DAffine3::IDENTITY, 1.0));
    let turned = Phantom::fog(SIZE, DAffine3::from_rotation_z(0.1), 1.0);
    let message = |tf: TransferFunction, field: Option<&Phantom>, composite: Composite| {
        let color = field.map(|field| (field, along_x()));
        let parts = [Part { phantom: &phantom, tf, shading: None, color }];
        draw(&parts, Kernel::Linear, &camera(ORTHOGRAPHIC), &fine(composite)).unwrap_err().to_string()
    };
    let soft = || of_ball(&SOFT);
    let twin = phantom.clone();
    let gradients = {
        let joint = TransferFunction2D::new(vec![0.0, 1.0], vec![0.0], vec![[0.5; 4]; 2]).unwrap();
        TransferFunction::two_dimensional(joint, None).unwrap()
    };
    for (told, wanted) in [
        (message(soft(), Some(&twin), Composite::Maximum), "layer of a projection is coloured by a field"),
        (message(soft(), Some(&small), Composite::Over), "extent of the field that colours a layer"),
        (message(soft(), Some(&turned), Composite::Over), "axes of the field that colours a layer"),
        (message(of_two_fields(), None, Composite::Over), "is of two fields"),
        (message(gradients, Some(&twin), Composite::Over), "is of value and gradient"),
    ] {
        assert!(told.contains(wanted), "{told}");
    }
}
