//! The fast path against its literal twins in double precision.

use glam::{DAffine3, DVec3};
use wavesplat_core::{
    Composite, Crop, Gradient, GradientNode, Kernel, Light, LightFrame, Picture, Projection, RenderOptions, Shading,
    TransferFunction,
};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{render, render_base_planes};
use wavesplat_study::reference::ablation::Ablation;
use wavesplat_study::reference::raycast::{RaycastOptions, raycast};
use wavesplat_study::reference::{original, project, splat};
use wavesplat_testkit::{PROJECTIONS, Phantom, by_day, camera_towards, opacity_ramp, psnr_db};

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 9.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

#[test]
fn the_fast_path_equals_the_literal_splatter() {
    let phantom = Phantom::sheared_waves();
    let tf = opacity_ramp(&[(40.0, 0.0), (120.0, 0.2), (200.0, 0.6), (255.0, 1.0)], None);
    let coloured = Light { frame: LightFrame::World, to_light: DVec3::new(1.0, 2.0, -1.0), rgb: [1.0, 0.4, 0.2] };
    let shadings = [
        None,
        Some(Shading::headlight()),
        Some(Shading {
            gradient: Gradient::Difference(0.4),
            lights: vec![Light::HEADLIGHT, coloured],
            ..Shading::headlight()
        }),
    ];
    let pairs = Kernel::NAMES.into_iter().flat_map(|(_, kernel)| shadings.iter().map(move |shading| (kernel, shading)));
    let mut n_compared = 0;
    for (kernel, shading) in by_day(pairs, 2) {
        n_compared += check_twin(&phantom, &tf, kernel, shading.as_ref(), 1.0);
    }
    assert!(n_compared > 2500, "{n_compared} texels show something");
}

/// Checks base planes from three sides against the literal splatter; returns how many texels show something.
fn check_twin(
    phantom: &Phantom,
    tf: &TransferFunction,
    kernel: Kernel,
    shading: Option<&Shading>,
    oversampling: f64,
) -> usize {
    let volume = phantom.volume();
    let slices = Slices::new(&volume, kernel);
    let (mut n_compared, mut n_left_out) = (0, 0);
    for (from, projection) in [
        (DVec3::new(0.2, 0.3, 1.0), ORTHOGRAPHIC),
        (DVec3::new(-1.0, 0.5, 0.4), ORTHOGRAPHIC),
        (DVec3::new(0.6, -1.0, -0.5), PERSPECTIVE),
    ] {
        let camera = camera_towards(phantom.centre(), from, 30.0, projection);
        let options = RenderOptions {
            width_px: 40,
            height_px: 32,
            sheets_per_slice: 1.5,
            oversampling,
            shading: shading.cloned(),
            pre_integration: false,
            early_ray_termination: false,
            ..RenderOptions::default()
        };
        let (pictures, _) = render_base_planes(&slices, tf, &camera, &options, &()).unwrap();
        for picture in &pictures {
            let plane = &picture.plane;
            let want = splat::base_plane(&volume, &slices, tf, &camera, &options, &Ablation::NONE, plane).unwrap();
            for (t, (texel, want)) in picture.texels().iter().zip(&want).enumerate() {
                // In perspective, corners of a base plane may be left out, but only those that no pixel reads.
                let at = [t % picture.plane.size[0], t / picture.plane.size[0]];
                if *texel == [0.0; 4] && !picture.plane.is_needed(at, at) {
                    n_left_out += usize::from(want[3] > 0.0);
                    continue;
                }
                for c in 0..4 {
                    let (got, want) = (f64::from(texel[c]), want[c]);
                    assert!((got - want).abs() < 1e-4, "{kernel:?} {from} texel {t}: {got} for {want}");
                }
                n_compared += usize::from(want[3] > 0.1);
            }
        }
    }
    assert!(n_left_out <= n_compared / 100, "{n_left_out} left out of {n_compared} texels");
    n_compared
}

/// Texels further apart than samples: sixteen of them reach over two vectors of samples, or more.
#[test]
fn sparse_texels_equal_their_literal_twin() {
    let phantom = Phantom::sample([60, 57, 55], DAffine3::from_scale(DVec3::splat(0.2)), |p| {
        120.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
    });
    // No node at 120, which is the density all along one edge of the box and beyond it: the table rounds the corner
    // that a curve has at a node, which changes what is seen there by 1.1e-4.
    let tf = opacity_ramp(&[(40.0, 0.0), (117.0, 0.2), (200.0, 0.6), (255.0, 1.0)], None);
    for oversampling in [2.0, 0.5] {
        let differences = [(Kernel::Linear, 1.0), (Kernel::Linear, 0.7), (Kernel::Bspline3, 1.0)];
        let differences = differences.map(|(kernel, offset)| (kernel, Gradient::Difference(offset)));
        let smoothed = Kernel::NAMES.map(|(_, kernel)| (kernel, Gradient::Smoothed(0.8)));
        for (kernel, gradient) in by_day(differences.into_iter().chain(smoothed), 2) {
            let shading = Shading { gradient, ..Shading::headlight() };
            let n_compared = check_twin(&phantom, &tf, kernel, Some(&shading), oversampling);
            assert!(n_compared > 100, "{kernel:?} {oversampling}: {n_compared} texels show something");
        }
    }
}

/// The original form (sheets as textures, gradients from three buffers) is the same method, blurred by its textures.
#[test]
fn the_original_form_draws_the_same_scene() {
    let phantom = Phantom::sheared_waves();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(40.0, 0.0), (200.0, 0.3)], None);
    for (from, projection, shading, at_least) in [
        // The cut faces of this small volume are edges a pixel or two wide, which the textures blur.
        (DVec3::new(0.1, 0.2, 1.0), ORTHOGRAPHIC, None, 30.0),
        (DVec3::new(0.6, -1.0, -0.5), PERSPECTIVE, None, 29.0),
        // The original's gradient is a difference over one texel and one sheet, ours over a voxel either way: less
        // smooth.
        (DVec3::new(0.1, 0.2, 1.0), ORTHOGRAPHIC, Some(Shading::headlight()), 28.0),
    ] {
        let camera = camera_towards(phantom.centre(), from, 30.0, projection);
        let options = RenderOptions {
            width_px: 40,
            height_px: 32,
            sheets_per_slice: 2.0,
            shading,
            pre_integration: false,
            early_ray_termination: false,
            ..RenderOptions::default()
        };
        let literal = original::image(&volume, Kernel::Linear, &tf, &camera, &options, &()).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let (fast, _) = render(&slices, &tf, &camera, &options, &()).unwrap();
        let psnr = psnr_db(&fast.rgba, &literal.rgba);
        assert!(psnr > at_least, "{from}: {psnr} dB");
    }
}

/// Checks a picture against the ray caster. `settings`: sheets per slice, oversampling.
fn check_against_raycast(
    kernel: Kernel,
    nodes: &[(f64, f64)],
    settings: (f64, f64),
    (side_px, rays_per_pixel): (usize, usize),
    at_least: f64,
) {
    let phantom = Phantom::ripples(24);
    let volume = phantom.volume();
    let tf = opacity_ramp(nodes, None);
    for projection in
        [Projection::Orthographic { parallel_scale: 9.0 }, Projection::Perspective { view_angle_rad: 0.3 }]
    {
        let camera = camera_towards(phantom.centre(), DVec3::new(0.7, 0.7, 0.55), 60.0, projection);
        let (sheets_per_slice, oversampling) = settings;
        let options = RenderOptions {
            width_px: side_px,
            height_px: side_px,
            sheets_per_slice,
            oversampling,
            ..RenderOptions::default()
        };
        let sampling = RaycastOptions { kernel, step: 0.1, rays_per_pixel };
        let want = raycast(&volume, &tf, &camera, &options, sampling, &()).unwrap();
        let slices = Slices::new(&volume, kernel);
        let (got, _) = render(&slices, &tf, &camera, &options, &()).unwrap();
        let psnr = psnr_db(&got.rgba, &want.rgba);
        assert!(psnr >= at_least, "{kernel:?} {projection:?} {settings:?}: {psnr} dB, at least {at_least}");
    }
}

const SOFT: [(f64, f64); 3] = [(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)];

#[test]
fn soft_pictures_approach_the_converged_ray_caster() {
    let (normal, high) = (
        wavesplat_core::quality_settings("normal", false, 1.0, 1.0),
        wavesplat_core::quality_settings("high", false, 1.0, 1.0),
    );
    check_against_raycast(Kernel::Linear, &SOFT, normal.unwrap(), (96, 1), 40.0);
    check_against_raycast(Kernel::Linear, &SOFT, high.unwrap(), (96, 1), 45.0);
}

#[test]
fn smooth_kernels_agree_with_the_ray_caster_too() {
    for kernel in [Kernel::CatmullRom, Kernel::Bspline2, Kernel::Bspline3, Kernel::Gaussian] {
        check_against_raycast(kernel, &SOFT, (4.0, 1.0), (40, 1), 38.0);
    }
}

#[test]
fn hard_pictures_approach_the_converged_ray_caster() {
    let high = wavesplat_core::quality_settings("high", true, 1.0, 1.0).unwrap();
    check_against_raycast(Kernel::Linear, &[(127.0, 0.0), (128.0, 1.0)], high, (64, 16), 34.0);
}

/// Gradient opacity: the fast path equals the literal splatter, and approaches the ray caster, which evaluates every
/// sample on its own.
#[test]
fn gradient_opacity_is_that_of_direct_evaluation() {
    let curve = [(2.0, 0.0), (25.0, 0.4), (80.0, 1.0)];
    let curve = curve.map(|(magnitude, factor)| GradientNode { magnitude, factor }).to_vec();
    let with_gradient = |nodes: &[(f64, f64)]| opacity_ramp(nodes, None).with_gradient_opacity(curve.clone()).unwrap();
    let phantom = Phantom::sheared_waves();
    let volume = phantom.volume();
    let tf = with_gradient(&[(40.0, 0.0), (120.0, 0.2), (200.0, 0.6)]);
    for shading in [None, Some(Shading { gradient: Gradient::Difference(0.5), ..Shading::headlight() })] {
        let camera = camera_towards(phantom.centre(), DVec3::new(-1.0, 0.5, 0.4), 30.0, ORTHOGRAPHIC);
        let options = RenderOptions {
            width_px: 40,
            height_px: 32,
            pre_integration: false,
            early_ray_termination: false,
            shading,
            ..RenderOptions::default()
        };
        let slices = Slices::new(&volume, Kernel::Linear);
        for picture in render_base_planes(&slices, &tf, &camera, &options, &()).unwrap().0 {
            let want =
                splat::base_plane(&volume, &slices, &tf, &camera, &options, &Ablation::NONE, &picture.plane).unwrap();
            for (got, want) in picture.texels().iter().zip(&want) {
                assert!((0..4).all(|c| (f64::from(got[c]) - want[c]).abs() < 1e-4), "{got:?} for {want:?}");
            }
        }
    }
    let phantom = Phantom::ripples(24);
    let volume = phantom.volume();
    for (name, nodes) in [("soft", &SOFT[..]), ("steep", &[(120.0, 0.0), (136.0, 0.9)])] {
        let (tf, plain) = (with_gradient(nodes), opacity_ramp(nodes, None));
        let camera = camera_towards(
            phantom.centre(),
            DVec3::new(0.7, 0.7, 0.55),
            60.0,
            Projection::Orthographic { parallel_scale: 9.0 },
        );
        let options = RenderOptions {
            width_px: 64,
            height_px: 64,
            sheets_per_slice: 8.0,
            oversampling: 3.0,
            ..RenderOptions::default()
        };
        let sampling = RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 4 };
        let want = raycast(&volume, &tf, &camera, &options, sampling, &()).unwrap();
        let slices = Slices::new(&volume, Kernel::Linear);
        let draw = |tf| render(&slices, tf, &camera, &options, &()).unwrap().0;
        let mean = |a: &Picture, b: &Picture| {
            let pairs = a.rgba.as_flattened().iter().zip(b.rgba.as_flattened());
            pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / (4 * a.rgba.len()) as f64
        };
        let error = mean(&draw(&tf), &want);
        assert!(error < 1e-3, "{name}: {error}");
        assert!(mean(&draw(&plain), &want) > 2e-2, "{name}: the gradient matters");
    }
}

/// Projections equal their definitions on every ray: any operator, view, cut and number of sheets, with holes.
#[test]
fn projections_equal_their_definitions() {
    let mut phantom = Phantom::sheared_waves();
    phantom.samples[456] = f32::NAN;
    let volume = phantom.volume();
    let (offset, scale) = volume.grid().density_from_sample();
    let tf = opacity_ramp(&[(0.0, 1.0)], None);
    let crop = Some(Crop::Index { lo: DVec3::new(0.7, 1.2, 0.9), hi: DVec3::new(8.3, 8.0, 7.1) });
    for composite in PROJECTIONS {
        let (mut n, mut n_off) = (0, 0);
        for (from, projection, distance, crop, sheets_per_slice) in [
            (DVec3::new(0.2, 0.3, 1.0), ORTHOGRAPHIC, 30.0, None, 1.5),
            (DVec3::new(-1.0, 0.5, 0.4), ORTHOGRAPHIC, 30.0, crop, 2.0),
            (DVec3::new(0.6, -1.0, -0.5), PERSPECTIVE, 30.0, None, 1.0),
            // The eye is inside.
            (DVec3::new(0.1, 0.2, -1.0), Projection::Perspective { view_angle_rad: 1.6 }, 0.5, None, 2.0),
        ] {
            let camera = camera_towards(phantom.centre(), from, distance, projection);
            let options = RenderOptions {
                width_px: 40,
                height_px: 32,
                sheets_per_slice,
                composite,
                crop,
                ..RenderOptions::default()
            };
            let slices = Slices::new(&volume, Kernel::Linear);
            for picture in render_base_planes(&slices, &tf, &camera, &options, &()).unwrap().0 {
                let want = project::base_plane(&volume, &slices, &tf, &camera, &options, &picture.plane).unwrap();
                for (t, ([density, length, _, coverage], want)) in picture.texels().iter().zip(want).enumerate() {
                    let n_u = picture.plane.size[0];
                    let (i, j) = (t % n_u / 16 * 16, t / n_u / 8 * 8);
                    if *coverage == 0.0 && !picture.plane.is_needed([i, j], [i + 15, j + 7]) {
                        continue;
                    }
                    assert_eq!(want.is_some(), *coverage == 1.0, "{composite:?} {from} texel {t}");
                    let Some(want) = want else { continue };
                    let got = match composite {
                        Composite::Sum => f64::from(*density) / scale + offset * f64::from(*length),
                        Composite::XRay { attenuation, .. } => (-attenuation * f64::from(*density) / scale).exp(),
                        _ => f64::from(*density) / scale + offset,
                    };
                    n += 1;
                    n_off += usize::from((got - want).abs() > 1e-4 * want.abs().max(1e-3));
                }
            }
        }
        assert!(n > 3000, "only {n} rays meet the volume");
        // Where two maxima on a ray are equal to rounding, either may be the first.
        let limit = if matches!(composite, Composite::LocalMaximum { .. }) { n / 500 } else { 0 };
        assert!(n_off <= limit, "{composite:?}: {n_off} of {n} rays are off");
    }
}
