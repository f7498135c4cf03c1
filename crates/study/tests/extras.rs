//! Features of few pictures, against the ray caster, which evaluates every sample on its own: two-dimensional transfer
//! functions and labels.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, Kernel, LabelLook, Picture, Projection, RenderOptions, Shading, TransferFunction, TransferFunction2D,
};
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, render, render_base_planes_at, render_layers};
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast, raycast_layers};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 4 };

fn oblique(phantom: &Phantom, parallel_scale: f64) -> Camera {
    camera_towards(phantom.centre(), DVec3::new(0.7, 0.6, 0.5), 60.0, Projection::Orthographic { parallel_scale })
}

fn fine(shading: Option<Shading>) -> RenderOptions {
    RenderOptions {
        width_px: 48,
        height_px: 48,
        sheets_per_slice: 8.0,
        oversampling: 3.0,
        shading,
        ..RenderOptions::default()
    }
}

fn mean_error(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.rgba.as_flattened().iter().zip(b.rgba.as_flattened());
    pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / (4 * a.rgba.len()) as f64
}

/// A function that is red where the gradient is small, blue where it is large, and opaque around the value 130 only.
fn two_dimensional() -> TransferFunction {
    let row = |rgb: [f64; 3], most: f64| [0.0, most, most, 0.0].map(|a| [rgb[0], rgb[1], rgb[2], a]);
    let rgba = [row([1.0, 0.2, 0.1], 0.05), row([0.9, 0.8, 0.2], 0.0), row([0.1, 0.3, 1.0], 0.5)].concat();
    let joint = TransferFunction2D::new(vec![60.0, 110.0, 150.0, 200.0], vec![0.0, 10.0, 40.0], rgba).unwrap();
    TransferFunction::two_dimensional(joint, None).unwrap()
}

#[test]
fn functions_of_two_dimensions_are_those_of_direct_evaluation() {
    let phantom = Phantom::ripples(20);
    let volume = phantom.volume();
    let camera = oblique(&phantom, 8.0);
    for shading in [None, Some(Shading::headlight())] {
        let options = fine(shading);
        let tf = two_dimensional();
        let want = raycast(&volume, &tf, &camera, &options, SAMPLING, &()).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let got = render(&slices, &tf, &camera, &options, &()).unwrap().0;
        let error = mean_error(&got, &want);
        assert!(error < 1e-3, "{error}");
        // Without the gradient it would be another picture.
        let bounds = TransferFunction::new(tf.opacity_nodes().to_vec(), tf.color_nodes().to_vec(), None).unwrap();
        let plain = render(&slices, &bounds, &camera, &options, &()).unwrap().0;
        assert!(mean_error(&plain, &want) > 2e-2);
    }
}

/// A scan of a shell in fog; label 1 is a ball beside the middle, label 2 the lower half around it.
fn labelled() -> (Phantom, Vec<u8>) {
    let n = 20;
    let centre = DVec3::splat(9.5);
    let phantom =
        Phantom::sample([n; 3], glam::DAffine3::IDENTITY, |p| 250.0 - 30.0 * (p.distance(centre) - 6.0).abs());
    let code = |i: usize| {
        let p = DVec3::new((i % n) as f64, (i / n % n) as f64, (i / (n * n)) as f64);
        if p.distance(DVec3::new(7.0, 10.0, 10.0)) < 4.0 { 1 } else { 2 * u8::from(p.z < 9.0) }
    };
    (phantom, (0..n * n * n).map(code).collect())
}

fn looks(ball: LabelLook, half: LabelLook) -> Vec<LabelLook> {
    vec![LabelLook::NONE, ball, half]
}

#[test]
fn labels_are_those_of_direct_evaluation() {
    let (phantom, codes) = labelled();
    let volume = phantom.volume();
    let camera = oblique(&phantom, 11.0);
    let tf = opacity_ramp(&[(100.0, 0.0), (250.0, 0.3)], None);
    let hidden = LabelLook { scan: 0.0, ..LabelLook::NONE };
    let tinted = LabelLook { rgb: [0.1, 0.9, 0.2], tint: 0.8, scan: 0.5, ..LabelLook::NONE };
    let solid = LabelLook { rgb: [0.9, 0.1, 0.1], opacity: 0.6, scan: 0.0, tint: 0.0 };
    let slices = Slices::new(&volume, Kernel::Linear);
    for (name, looks) in
        [("hidden", looks(LabelLook::NONE, hidden)), ("tinted", looks(tinted, hidden)), ("solid", looks(solid, tinted))]
    {
        for kernel in [Kernel::Linear, Kernel::Gaussian] {
            for shading in [None, Some(Shading::headlight())] {
                let codes = Codes::U8(Arc::from(&codes[..]));
                let labels = Labels::new(codes, looks.clone(), volume.grid(), kernel, 1 << 24).unwrap();
                let options = fine(shading);
                let (shading, labels) = (options.shading.as_ref(), Some(&labels));
                let cast = CastLayer { volume: &volume, transfer_function: &tf, shading, labels, color: None };
                let want = raycast_layers(&[cast], &camera, &options, SAMPLING, &()).unwrap();
                let cache = VisibilityCache::default();
                let got = render_layers(
                    &[Layer { slices: &slices, transfer_function: &tf, shading, labels, color: None, cache: &cache }],
                    &camera,
                    &options,
                    &(),
                )
                .unwrap()
                .0;
                let error = mean_error(&got, &want);
                assert!(error < 1e-3, "{name} {kernel:?}: {error}");
                let plain = render(&slices, &tf, &camera, &options, &()).unwrap().0;
                assert!(mean_error(&plain, &want) > 1e-2, "{name}: labels matter");
            }
        }
    }
}

#[test]
fn labels_with_the_looks_of_nothing_change_nothing() {
    let (phantom, codes) = labelled();
    let volume = phantom.volume();
    let camera = oblique(&phantom, 11.0);
    let tf = opacity_ramp(&[(100.0, 0.0), (250.0, 0.3)], None);
    let codes = Codes::U16(codes.iter().map(|c| u16::from(*c)).collect());
    let labels = Labels::new(codes, vec![LabelLook::NONE; 3], volume.grid(), Kernel::Linear, 1 << 24).unwrap();
    let slices = Slices::new(&volume, Kernel::Linear);
    let options = RenderOptions { sheets_per_slice: 2.0, ..fine(Some(Shading::headlight())) };
    let plain = render(&slices, &tf, &camera, &options, &()).unwrap().0;
    let (shading, cache) = (options.shading.as_ref(), VisibilityCache::default());
    let got = render_layers(
        &[Layer {
            slices: &slices,
            transfer_function: &tf,
            shading,
            labels: Some(&labels),
            color: None,
            cache: &cache,
        }],
        &camera,
        &options,
        &(),
    )
    .unwrap()
    .0;
    assert!(mean_error(&got, &plain) < 1e-7);
}

#[test]
fn every_simd_level_gives_the_same_bits() {
    let (phantom, _) = labelled();
    let volume = phantom.volume();
    let camera = oblique(&phantom, 11.0);
    let shading = Shading { ambient_occlusion: 0.7, shadow: 0.5, ..Shading::headlight() };
    let options = RenderOptions { sheets_per_slice: 2.0, ..fine(Some(shading)) };
    let slices = Slices::new(&volume, Kernel::Linear);
    for tf in [two_dimensional(), opacity_ramp(&[(90.0, 0.0), (110.0, 0.95)], None)] {
        let draw = |level: Level| {
            let (pictures, _) = render_base_planes_at(level, &slices, &tf, &camera, &options, &()).unwrap();
            pictures.into_iter().map(|p| p.texels()).collect::<Vec<_>>()
        };
        let want = draw(Level::best());
        assert!(want.iter().flatten().any(|texel| texel[3] > 0.1));
        for level in Level::all() {
            assert!(draw(level) == want, "{}", level.name());
        }
    }
}
