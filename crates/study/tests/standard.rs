//! Standard splatting: against its literal twin, and against answers from paper.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{
    Camera, ClipPlane, ColorNode, Composite, Crop, Error, Gradient, GradientNode, Kernel, Light, LightFrame,
    OpacityNode, Picture, Projection, RenderOptions, Samples, Shading, TransferFunction, Volume,
};
use wavesplat_splat::ProgressCallback;
use wavesplat_splat::kernel::weights::{radius, weight};
use wavesplat_splat::source::slices::Slices;
use wavesplat_study::reference;
use wavesplat_study::reference::standard as literal;
use wavesplat_study::standard::{Buffer, StandardOptions, render, render_base_planes};
use wavesplat_testkit::{Phantom, camera_towards, max_difference, opacity_ramp, psnr_db};

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 9.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

const VIEWS: [(DVec3, Projection); 4] = [
    (DVec3::new(0.2, 0.3, 1.0), ORTHOGRAPHIC),
    (DVec3::new(-1.0, 0.5, 0.4), ORTHOGRAPHIC),
    (DVec3::new(0.6, -1.0, -0.5), PERSPECTIVE),
    (DVec3::new(0.9, 1.0, 1.1), PERSPECTIVE),
];

fn all_standards(kernel: Kernel) -> impl Iterator<Item = StandardOptions> {
    let both = move |buffer| {
        [true, false].map(|view_angle_correction| StandardOptions { buffer, view_angle_correction, kernel })
    };
    [Buffer::Axis, Buffer::View].into_iter().flat_map(both)
}

/// A sheared, anisotropic, mirrored grid, off the origin.
fn scene() -> Phantom {
    let shear = DMat3::from_cols(DVec3::new(1.1, 0.0, 0.1), DVec3::new(0.0, -0.9, 0.0), DVec3::new(0.1, 0.2, 1.4));
    let affine = DAffine3 { matrix3: shear, translation: DVec3::new(3.0, -2.0, 7.0) };
    Phantom::sample([11, 10, 9], affine, |p| {
        120.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
    })
}

fn draw(
    phantom: &Phantom,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    standard: StandardOptions,
) -> Picture {
    let volume = phantom.volume();
    render(&Slices::new(&volume, Kernel::Linear), tf, camera, options, standard, &()).unwrap().0
}

/// Options with the light that standard splatting can have.
fn plain() -> RenderOptions {
    RenderOptions { shading: Some(Shading::headlight()), ..RenderOptions::default() }
}

fn small() -> RenderOptions {
    RenderOptions { width_px: 40, height_px: 32, ..plain() }
}

/// A function of one colour; `nodes`: opacity per unit by the sample's value.
fn white(nodes: &[(f64, f64)], opacity_unit: Option<f64>) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], opacity_unit).unwrap()
}

#[test]
fn the_fast_path_equals_the_literal_twin() {
    let phantom = scene();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let tf = opacity_ramp(&[(40.0, 0.0), (120.0, 0.2), (200.0, 0.6), (255.0, 1.0)], None);
    let coloured = Light { frame: LightFrame::World, to_light: DVec3::new(1.0, 2.0, -1.0), rgb: [1.0, 0.4, 0.2] };
    let shadings = [
        None,
        Some(Shading::headlight()),
        Some(Shading { lights: vec![Light::HEADLIGHT, coloured], ..Shading::headlight() }),
    ];
    let (mut n_compared, mut n_scenes) = (0, 0);
    for (_, kernel) in Kernel::NAMES {
        for (from, projection) in VIEWS {
            for standard in all_standards(kernel) {
                n_scenes += 1;
                let shading = shadings[n_scenes % 3].clone();
                let gradient = GradientNode { magnitude: 40.0, factor: 1.0 };
                let gradient = if n_scenes % 4 == 0 {
                    vec![GradientNode { magnitude: 0.0, factor: 0.2 }, gradient]
                } else {
                    vec![]
                };
                let tf = tf.clone().with_gradient_opacity(gradient).unwrap();
                let camera = camera_towards(phantom.centre(), from, 30.0, projection);
                let options = RenderOptions { shading, ..small() };
                let mut check = |got: &[[f32; 4]], want: &[[f64; 4]]| {
                    assert_eq!(got.len(), want.len());
                    for (t, (got, want)) in got.iter().zip(want).enumerate() {
                        for c in 0..4 {
                            let apart = (f64::from(got[c]) - want[c]).abs();
                            assert!(apart < 5e-4, "{kernel:?} {from} {standard:?} texel {t}: {got:?} for {want:?}");
                        }
                        n_compared += usize::from(want[3] > 0.1);
                    }
                };
                if standard.buffer == Buffer::Axis {
                    let pictures = render_base_planes(&slices, &tf, &camera, &options, standard).unwrap();
                    let planes = literal::base_planes(&volume, &camera, &options, kernel).unwrap();
                    assert_eq!(pictures.len(), planes.len());
                    for picture in &pictures {
                        let plane = &picture.plane;
                        let want = literal::base_plane(&volume, &tf, &camera, &options, standard, plane).unwrap();
                        check(&picture.texels(), &want);
                    }
                } else {
                    let (picture, _) = render(&slices, &tf, &camera, &options, standard, &()).unwrap();
                    check(&picture.rgba, &literal::view_picture(&volume, &tf, &camera, &options, standard).unwrap());
                }
            }
        }
    }
    assert!(n_compared > 40_000, "{n_compared} texels show something");
}

/// An eye inside the volume, with rays of all three axes: everything but what is next to the eye is there.
#[test]
fn an_eye_inside_sees_what_the_literal_twin_sees() {
    let phantom = scene();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let tf = opacity_ramp(&[(40.0, 0.05), (200.0, 0.3)], None);
    let projection = Projection::Perspective { view_angle_rad: 1.6 };
    let camera = camera_towards(phantom.centre(), DVec3::new(0.9, 1.0, 1.1), 2.5, projection);
    let options = RenderOptions { width_px: 70, height_px: 66, ..small() };
    for standard in all_standards(Kernel::Bspline2) {
        let largest = if standard.buffer == Buffer::Axis {
            let pictures = render_base_planes(&slices, &tf, &camera, &options, standard).unwrap();
            assert!(pictures.len() >= 3, "{} axes", pictures.len());
            let apart = pictures.iter().map(|picture| {
                let want = literal::base_plane(&volume, &tf, &camera, &options, standard, &picture.plane).unwrap();
                largest_difference(&picture.texels(), &want)
            });
            apart.fold(0.0, f64::max)
        } else {
            let (picture, _) = render(&slices, &tf, &camera, &options, standard, &()).unwrap();
            let want = literal::view_picture(&volume, &tf, &camera, &options, standard).unwrap();
            assert!(want.iter().any(|pixel| pixel[3] > 0.3));
            largest_difference(&picture.rgba, &want)
        };
        assert!(largest < 1e-3, "{standard:?}: {largest}");
    }
}

fn largest_difference(got: &[[f32; 4]], want: &[[f64; 4]]) -> f64 {
    assert_eq!(got.len(), want.len(), "pictures differ in size");
    let pairs = got.as_flattened().iter().zip(want.as_flattened());
    pairs.map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max)
}

/// A sample alone, seen head-on: its opacity times the footprint, and at its own place in the picture.
#[test]
fn a_single_sample_draws_the_footprint() {
    let centre = DVec3::new(5.0, 3.0, 4.0);
    let phantom = Phantom::sample([10, 9, 8], DAffine3::IDENTITY, |p| if p == centre { 200.0 } else { 0.0 });
    let tf = white(&[(199.0, 0.0), (200.0, 0.5)], None);
    let projection = Projection::Orthographic { parallel_scale: 4.0 };
    let camera = camera_towards(phantom.centre(), DVec3::Z, 20.0, projection);
    for (name, kernel) in Kernel::NAMES {
        let options = RenderOptions { width_px: 70, height_px: 64, shading: None, ..small() };
        for standard in all_standards(kernel) {
            let picture = draw(&phantom, &tf, &camera, &options, standard);
            let mut n_inside = 0;
            for (i, pixel) in picture.rgba.iter().enumerate() {
                let [x, y] = [i % 70, i / 70].map(|k| k as f64 + 0.5);
                let offset = camera.ray(x, y, 70, 64).origin - centre;
                let footprint = match standard.buffer {
                    Buffer::Axis => normalised(kernel, offset.x) * normalised(kernel, offset.y),
                    Buffer::View => radial(kernel, offset.x.hypot(offset.y)),
                };
                // Weights below 0 take away from other samples only.
                let want = 0.5 * footprint.max(0.0);
                // The warp is clamped between texels, and reads linearly at the very border.
                assert!(
                    (f64::from(pixel[3]) - want).abs() < 1e-3,
                    "{name} {standard:?} at {offset}: {pixel:?} for {want}"
                );
                assert!((0..3).all(|c| pixel[c] == pixel[3]), "white");
                n_inside += usize::from(want > 0.01);
            }
            assert!(n_inside > 100, "{name} {standard:?}: {n_inside} pixels");
        }
    }
}

/// The kernel with weights of sum 1.
fn normalised(kernel: Kernel, x: f64) -> f64 {
    weight(kernel, x) / (-4..=4).map(|i| weight(kernel, x - x.round() - f64::from(i))).sum::<f64>()
}

/// The kernel as a sphere, integrated along a ray at a distance from its middle, of unit mass.
fn radial(kernel: Kernel, rho: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let step = 1e-3;
    let radii = || (0..(radius(kernel) / step) as i32).map(|i| (f64::from(i) + 0.5) * step);
    match kernel {
        // `√(1 − ρ²) − ρ² arcosh(1/ρ)` and the cone's volume.
        Kernel::Linear if rho >= 1.0 => 0.0,
        Kernel::Linear => ((1.0 - rho * rho).sqrt() - rho * rho * (1.0 / rho.max(1e-9)).acosh()) * 3.0 / PI,
        // From any side a Gaussian is a Gaussian.
        Kernel::Gaussian if rho >= 2.0 => 0.0,
        Kernel::Gaussian => (-2.0 * rho * rho).exp() / FRAC_PI_2,
        Kernel::CatmullRom => {
            weight(kernel, rho) / (2.0 * PI * step * radii().map(|r| r * weight(kernel, r)).sum::<f64>())
        }
        _ => {
            let along = (-2000..2000).map(|i| (f64::from(i) + 0.5) * step);
            let line: f64 = along.map(|t| step * weight(kernel, rho.hypot(t))).sum();
            line / (4.0 * PI * step * radii().map(|r| r * r * weight(kernel, r)).sum::<f64>())
        }
    }
}

/// Footprints sum to 1: inside a homogeneous volume there is one colour, and Beer-Lambert holds.
#[test]
fn a_homogeneous_volume_is_even() {
    let phantom = Phantom::fog([24, 24, 12], DAffine3::IDENTITY, 100.0);
    let colored = |opacity| {
        let color = vec![ColorNode { value: 100.0, rgb: [0.9, 0.5, 0.2] }];
        TransferFunction::new(vec![OpacityNode { value: 100.0, opacity }], color, None).unwrap()
    };
    let projection = Projection::Orthographic { parallel_scale: 4.0 };
    for (name, kernel) in Kernel::NAMES {
        let options = RenderOptions { shading: None, ..small() };
        for (from, slices_met) in [(DVec3::Z, 12.0), (DVec3::new(0.3, 0.2, 1.0), f64::NAN)] {
            let camera = camera_towards(phantom.centre(), from, 20.0, projection);
            for standard in all_standards(kernel) {
                let opaque = draw(&phantom, &colored(1.0), &camera, &options, standard).rgba;
                let want = [0.9, 0.5, 0.2, 1.0];
                if standard.buffer == Buffer::View && from != DVec3::Z {
                    // Samples are spread unevenly over slabs, and what is too much is clamped; opacity ends at 1.
                    let mean = |c: usize| opaque.iter().map(|p| p[c]).sum::<f32>() / opaque.len() as f32;
                    assert!((0..3).all(|c| (mean(c) - want[c]).abs() < 0.1), "{name} {standard:?}: {}", mean(1));
                    assert!(opaque.iter().all(|p| p[3] > 0.99), "{name} {from} {standard:?}");
                    continue;
                }
                // Radial kernels do not sum to 1 exactly.
                let limit = if standard.buffer == Buffer::View { 0.05 } else { 2e-4 };
                for pixel in &opaque {
                    assert!(
                        (0..4).all(|c| (pixel[c] - want[c]).abs() <= limit),
                        "{name} {from} {standard:?}: {pixel:?}"
                    );
                }
                if slices_met > 0.0 && standard.buffer == Buffer::Axis {
                    let fog = draw(&phantom, &colored(0.1), &camera, &options, standard);
                    let want = 1.0 - 0.9_f64.powf(slices_met);
                    assert!(fog.rgba.iter().all(|p| (f64::from(p[3]) - want).abs() < 2e-4), "{name}");
                }
            }
        }
    }
}

/// A ramp of colour seen head-on: kernels that keep a ramp draw it, one slice deep.
#[test]
fn a_ramp_of_colour_stays_a_ramp() {
    let phantom = Phantom::sample([20, 16, 5], DAffine3::IDENTITY, |p| p.x);
    let ramp = vec![ColorNode { value: 0.0, rgb: [0.0, 0.5, 1.0] }, ColorNode { value: 20.0, rgb: [1.0, 0.5, 0.0] }];
    let tf = TransferFunction::new(vec![OpacityNode { value: 0.0, opacity: 1.0 }], ramp, None).unwrap();
    let projection = Projection::Orthographic { parallel_scale: 5.0 };
    let camera = camera_towards(phantom.centre(), DVec3::Z, 20.0, projection);
    for (name, kernel) in Kernel::NAMES.into_iter().filter(|(_, k)| *k != Kernel::Gaussian) {
        let options = RenderOptions { shading: None, ..small() };
        let picture = draw(&phantom, &tf, &camera, &options, StandardOptions { kernel, ..StandardOptions::default() });
        for (i, pixel) in picture.rgba.iter().enumerate() {
            let x = camera.ray((i % 40) as f64 + 0.5, 0.5, 40, 32).origin.x / 20.0;
            let want = [x, 0.5, 1.0 - x, 1.0];
            for c in 0..4 {
                assert!((f64::from(pixel[c]) - want[c]).abs() < 2e-4, "{name}: {pixel:?} for {want:?}");
            }
        }
    }
}

/// One visible slice, met at 60 degrees: twice its thickness, which only the correction knows.
#[test]
fn a_thin_slab_needs_the_view_angle() {
    let affine = DAffine3::from_scale(DVec3::new(4.0, 4.0, 1.0));
    let phantom = Phantom::sample([40, 20, 7], affine, |p| if p.z == 3.0 { 100.0 } else { 0.0 });
    let tf = white(&[(99.0, 0.0), (100.0, 0.4)], Some(1.0));
    let from = DVec3::new(60.0_f64.to_radians().sin(), 0.0, 0.5);
    let projection = Projection::Orthographic { parallel_scale: 8.0 };
    let camera = camera_towards(phantom.centre(), from, 200.0, projection);
    let options = RenderOptions { shading: None, ..small() };
    for (view_angle_correction, want) in [(true, 1.0 - 0.6_f64.powi(2)), (false, 0.4)] {
        let standard = StandardOptions { buffer: Buffer::Axis, view_angle_correction, kernel: Kernel::Linear };
        let picture = draw(&phantom, &tf, &camera, &options, standard);
        for pixel in &picture.rgba {
            assert!((f64::from(pixel[3]) - want).abs() < 1e-4, "{view_angle_correction}: {pixel:?} for {want}");
        }
    }
}

/// A slab of fog in buffers parallel to the view plane, at 45 degrees: right on average with the correction; without it
/// the samples that lie closer in the picture add up to more opacity than there is.
#[test]
fn samples_packed_closer_are_too_opaque_without_the_view_angle() {
    let phantom = Phantom::fog([48, 40, 4], DAffine3::IDENTITY, 100.0);
    let camera = |from| camera_towards(phantom.centre(), from, 200.0, Projection::Orthographic { parallel_scale: 3.0 });
    let mean = |tf: &TransferFunction, from, view_angle_correction| {
        let options = RenderOptions { shading: None, ..small() };
        let standard = StandardOptions { buffer: Buffer::View, view_angle_correction, kernel: Kernel::Gaussian };
        let picture = draw(&phantom, tf, &camera(from), &options, standard);
        picture.rgba.iter().map(|p| f64::from(p[3])).sum::<f64>() / picture.rgba.len() as f64
    };
    let oblique = DVec3::new(1.0, 0.13, 1.04);
    let cos = oblique.normalize().z;
    let (a, n) = (0.3_f64, 4.0);
    let fog = white(&[(100.0, a)], None);
    let right = 1.0 - (1.0 - a).powf(n / cos);
    let corrected = mean(&fog, oblique, true);
    assert!((corrected - right).abs() < 0.01, "{corrected} for {right}");
    // From slab to slab the sum of the footprints is `1 / cos θ`.
    let uncorrected = mean(&fog, oblique, false);
    let wrong = 1.0 - (1.0 - a / cos).powf(n);
    assert!(wrong - right > 0.01 && (uncorrected - wrong).abs() < 0.01, "{uncorrected} for {wrong}, not {right}");
    // Head-on nothing is packed.
    assert!((mean(&fog, DVec3::Z, true) - mean(&fog, DVec3::Z, false)).abs() < 1e-6);
}

#[test]
fn a_far_eye_is_a_parallel_one() {
    let phantom = scene();
    let tf = opacity_ramp(&[(40.0, 0.0), (200.0, 0.5)], None);
    let from = DVec3::new(0.5, 0.3, 1.0);
    let distance = 1e5;
    let angle = Projection::Perspective { view_angle_rad: 2.0 * (9.0_f64 / distance).atan() };
    for standard in all_standards(Kernel::Bspline3) {
        let options = small();
        let picture = |projection, distance| {
            draw(&phantom, &tf, &camera_towards(phantom.centre(), from, distance, projection), &options, standard)
        };
        let (parallel, far) = (picture(ORTHOGRAPHIC, 50.0), picture(angle, distance));
        let apart = max_difference(&parallel.rgba, &far.rgba);
        assert!(apart < 3e-3, "{standard:?}: {apart}");
        let near = picture(Projection::Perspective { view_angle_rad: 2.0 * (9.0_f64 / 25.0).atan() }, 25.0);
        assert!(max_difference(&parallel.rgba, &near.rgba) > 0.05, "perspective is not parallel");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let phantom = Phantom::ripples(40);
    let tf = opacity_ramp(&[(60.0, 0.0), (255.0, 0.4)], None);
    for (from, projection) in [VIEWS[1], VIEWS[3]] {
        let scale = Projection::Orthographic { parallel_scale: 36.0 };
        let projection = if projection == ORTHOGRAPHIC { scale } else { projection };
        let camera = camera_towards(phantom.centre(), from, 140.0, projection);
        for standard in all_standards(Kernel::Linear) {
            let options =
                |n| RenderOptions { n_threads: Some(n), ..RenderOptions { width_px: 150, height_px: 140, ..small() } };
            let pictures = [1, 2, 7].map(|n| draw(&phantom, &tf, &camera, &options(n), standard));
            assert!(pictures[0].rgba.iter().any(|p| p[3] > 0.5));
            assert!(pictures.iter().all(|p| p.rgba == pictures[0].rgba), "{standard:?}");
        }
    }
}

/// Cut away, not a number, infinite, or of a value without opacity: all the same, where nothing is shaded.
#[test]
fn samples_that_are_left_out_are_empty() {
    let value = |p: DVec3| 100.0 + p.x + 3.0 * p.y + 2.0 * p.z;
    let size = [12, 11, 10];
    let volume = |keep: &dyn Fn(DVec3) -> bool, else_value: f64| {
        Phantom::sample(size, DAffine3::IDENTITY, |p| if keep(p) { value(p) } else { else_value })
    };
    let tf = white(&[(99.0, 0.0), (100.0, 0.1), (150.0, 0.7)], None);
    let camera = camera_towards(DVec3::splat(5.0), DVec3::new(0.4, -0.9, 0.5), 40.0, ORTHOGRAPHIC);
    let options = RenderOptions { shading: None, ..small() };
    let in_box = |p: DVec3| p.x >= 3.0 && p.y <= 6.0;
    let below = |p: DVec3| p.z < 5.5;
    let odd = |p: DVec3| (p.x + p.y + p.z) as i64 % 7 == 3;
    for standard in all_standards(Kernel::Linear) {
        let picture = |phantom: &Phantom, options: &RenderOptions| draw(phantom, &tf, &camera, options, standard);
        let all = picture(&volume(&|_| true, 0.0), &options);
        let crop = Some(Crop::Index { lo: DVec3::new(3.0, -5.0, 0.0), hi: DVec3::new(20.0, 6.0, 9.0) });
        let cropped = picture(&volume(&|_| true, 0.0), &RenderOptions { crop, ..options.clone() });
        let clip_planes = vec![ClipPlane { origin: DVec3::new(0.0, 0.0, 5.5), normal: DVec3::NEG_Z }];
        let clipped = picture(&volume(&|_| true, 0.0), &RenderOptions { clip_planes, ..options.clone() });
        let nan = picture(&volume(&|p| !odd(p), f64::NAN), &options);
        let infinite = picture(&volume(&|p| !odd(p), f64::INFINITY), &options);
        // Volumes of another range have another table of the transfer function.
        for (name, got, want, limit) in [
            ("crop", cropped, picture(&volume(&in_box, 0.0), &options), 1e-2),
            ("clip plane", clipped, picture(&volume(&below, 0.0), &options), 1e-3),
            ("NaN", nan, picture(&volume(&|p| !odd(p), 0.0), &options), 1e-3),
            ("infinity", infinite, picture(&volume(&|p| !odd(p), 0.0), &options), 1e-3),
        ] {
            let apart = max_difference(&got.rgba, &want.rgba);
            assert!(apart < limit, "{name} {standard:?}: {apart}");
            assert!(max_difference(&got.rgba, &all.rgba) > 0.05, "{name} leaves something out");
        }
    }
}

#[test]
fn nothing_visible_leaves_the_background() {
    let phantom = scene();
    let background = Some([0.2, 0.4, 0.6, 1.0]);
    let options = RenderOptions { background, ..small() };
    let away =
        Camera::new(phantom.centre() + 40.0 * DVec3::X, phantom.centre() + 80.0 * DVec3::X, DVec3::Z, PERSPECTIVE);
    let towards = camera_towards(phantom.centre(), DVec3::X, 40.0, ORTHOGRAPHIC);
    let seen = opacity_ramp(&[(0.0, 0.5)], None);
    for standard in all_standards(Kernel::Linear) {
        for (tf, camera) in [(white(&[(0.0, 0.0)], None), &towards), (seen.clone(), &away.clone().unwrap())] {
            let volume = phantom.volume();
            let slices = Slices::new(&volume, Kernel::Linear);
            let (picture, report) = render(&slices, &tf, camera, &options, standard, &()).unwrap();
            assert!(picture.rgba.iter().all(|p| *p == [0.2, 0.4, 0.6, 1.0]), "{standard:?}");
            assert_eq!(report.n_splats, 0);
        }
    }
}

/// Opacity summed over the picture is the opacity of the samples, however few texels there are.
#[test]
fn texels_wider_than_samples_lose_nothing() {
    let is_bright = |p: DVec3| p.z == 12.0 && p.x > 11.5 && p.x < 20.5 && p.y > 14.5 && p.y < 21.5;
    let phantom = Phantom::sample([40, 40, 24], DAffine3::IDENTITY, |p| if is_bright(p) { 200.0 } else { 0.0 });
    let tf = white(&[(199.0, 0.0), (200.0, 0.2)], None);
    let want = 9.0 * 7.0 * 0.2;
    // Weights below 0 are clamped where nothing else is, so Catmull-Rom shows more.
    for (name, kernel) in Kernel::NAMES.into_iter().filter(|(_, kernel)| *kernel != Kernel::CatmullRom) {
        for (n_px, oversampling) in [(13, 1.0), (40, 0.3), (13, 2.0), (80, 1.0), (30, 1.7)] {
            let options = RenderOptions { width_px: n_px, height_px: n_px, oversampling, shading: None, ..small() };
            for standard in all_standards(kernel) {
                let projection = Projection::Orthographic { parallel_scale: 20.0 };
                let camera = camera_towards(phantom.centre(), DVec3::Z, 90.0, projection);
                let picture = draw(&phantom, &tf, &camera, &options, standard);
                let side = 40.0 / n_px as f64;
                let sum = side * side * picture.rgba.iter().map(|p| f64::from(p[3])).sum::<f64>();
                let limit = 0.05 * want;
                assert!((sum - want).abs() < limit, "{name} {n_px} px, {oversampling} texels, {standard:?}: {sum}");
            }
        }
    }
}

#[test]
fn a_decoded_volume_gives_the_picture_of_its_samples() {
    let affine = DAffine3::from_scale(DVec3::new(0.3, 0.25, 0.4));
    let phantom = Phantom::sample([70, 45, 41], affine, |p| {
        120.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
    });
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(140.0, 0.0), (150.0, 0.1), (151.0, 1.0), (200.0, 0.6)], None);
    let decoded = Slices::of_decoder(Arc::new(phantom.clone()), volume.grid(), Kernel::Linear, 3 << 17);
    assert!(decoded.must_load());
    let slices = Slices::new(&volume, Kernel::Linear);
    for from in [DVec3::new(0.2, 0.3, 1.0), DVec3::new(-1.0, 0.5, 0.4), DVec3::new(-0.3, 1.0, 0.2)] {
        let camera = camera_towards(phantom.centre(), from, 40.0, ORTHOGRAPHIC);
        let options = RenderOptions { width_px: 90, height_px: 80, ..small() };
        for standard in all_standards(Kernel::Gaussian) {
            let picture = |slices: &Slices| render(slices, &tf, &camera, &options, standard, &()).unwrap().0.rgba;
            let (want, got) = (picture(&slices), picture(&decoded));
            assert!(got == want, "{from} {standard:?}: {}", max_difference(&got, &want));
        }
    }
}

/// Standard splatting comes closer to the converged picture than noise, and less close than splatting densities with as
/// many sheets.
#[test]
fn standard_splatting_blurs() {
    let phantom = Phantom::ripples(32);
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)], None);
    let projection = Projection::Orthographic { parallel_scale: 28.0 };
    let camera = camera_towards(phantom.centre(), DVec3::new(1.0, -1.1, 0.9), 90.0, projection);
    let options = RenderOptions { width_px: 96, height_px: 96, sheets_per_slice: 1.0, ..small() };
    let sampling = reference::raycast::RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 1 };
    let converged = reference::raycast::raycast(&volume, &tf, &camera, &options, sampling, &()).unwrap();
    let slices = Slices::new(&volume, Kernel::Linear);
    let (high_resolution, _) = wavesplat_splat::render(&slices, &tf, &camera, &options, &()).unwrap();
    let densities = psnr_db(&high_resolution.rgba, &converged.rgba);
    for buffer in [Buffer::Axis, Buffer::View] {
        let standard = StandardOptions { buffer, view_angle_correction: true, kernel: Kernel::Linear };
        let colours = psnr_db(&draw(&phantom, &tf, &camera, &options, standard).rgba, &converged.rgba);
        assert!(colours > 24.0 && colours + 5.0 < densities, "{buffer:?}: {colours} dB against {densities} dB");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let phantom = scene();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(0.0, 0.5)], None);
    let camera = camera_towards(phantom.centre(), DVec3::X, 40.0, ORTHOGRAPHIC);
    for standard in all_standards(Kernel::Linear) {
        let refused = |kernel, change: &dyn Fn(&mut RenderOptions)| {
            let mut options = small();
            change(&mut options);
            render(&Slices::new(&volume, kernel), &tf, &camera, &options, standard, &()).unwrap_err()
        };
        let message = |kernel, change: &dyn Fn(&mut RenderOptions)| refused(kernel, change).to_string();
        let linear = Kernel::Linear;
        assert!(message(linear, &|o| o.composite = Composite::Maximum).contains("projections"));
        assert!(message(linear, &|o| o.with_depth = true).contains("depth"));
        let offset = Some(Shading { gradient: Gradient::Difference(0.5), ..Shading::headlight() });
        assert!(message(linear, &|o| o.shading = offset.clone()).contains("gradient"));
        assert!(message(linear, &|o| o.width_px = 0).contains("width"));
        assert!(message(Kernel::Bspline3, &|_| ()).contains("coefficients"));
        let nothing = Some(Crop::Index { lo: DVec3::splat(90.0), hi: DVec3::splat(99.0) });
        assert!(matches!(refused(linear, &|o| o.crop = nothing), Error::EmptyCrop { .. }));
    }
    let options = RenderOptions { width_px: 16_384, height_px: 16_384, oversampling: 2.0, ..plain() };
    let standard = StandardOptions { buffer: Buffer::View, view_angle_correction: true, kernel: Kernel::Linear };
    let too_large = render(&Slices::new(&volume, Kernel::Linear), &tf, &camera, &options, standard, &()).unwrap_err();
    assert!(matches!(too_large, Error::TooLarge { .. }), "{too_large}");
    assert_eq!(Buffer::from_name("view"), Ok(Buffer::View));
    assert!(Buffer::from_name("front").unwrap_err().to_string().contains("axis, view"));
}

#[test]
fn a_monitor_stops_the_work() {
    struct Stop;
    impl ProgressCallback for Stop {
        fn progress(&self, fraction: f32) -> ControlFlow<()> {
            assert!(fraction > 0.0 && fraction <= 1.0);
            ControlFlow::Break(())
        }
    }
    let phantom = scene();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(0.0, 0.5)], None);
    let camera = camera_towards(phantom.centre(), DVec3::X, 40.0, ORTHOGRAPHIC);
    for standard in all_standards(Kernel::Linear) {
        let slices = Slices::new(&volume, Kernel::Linear);
        let stopped = render(&slices, &tf, &camera, &small(), standard, &Stop);
        assert_eq!(stopped.unwrap_err(), Error::Cancelled);
    }
}

/// Narrow samples are read as they are.
#[test]
fn sample_types_make_no_difference() {
    let bytes: Vec<u8> = (0..12 * 11 * 10).map(|i| (i * 7 % 256) as u8).collect();
    let wide: Vec<f64> = bytes.iter().map(|b| f64::from(*b)).collect();
    let size = [12, 11, 10];
    let narrow = Volume::new("narrow", Samples::U8(&bytes), size, DAffine3::IDENTITY).unwrap();
    let float = Volume::new("float", Samples::F64(&wide), size, DAffine3::IDENTITY).unwrap();
    let tf = opacity_ramp(&[(100.0, 0.0), (255.0, 0.5)], None);
    for (from, projection) in VIEWS {
        let camera = camera_towards(DVec3::splat(5.0), from, 40.0, projection);
        for standard in all_standards(Kernel::CatmullRom) {
            let picture = |volume: &Volume| {
                let slices = Slices::new(volume, Kernel::Linear);
                render(&slices, &tf, &camera, &small(), standard, &()).unwrap().0.rgba
            };
            let apart = max_difference(&picture(&narrow), &picture(&float));
            assert!(apart < 1e-3, "{from} {standard:?}: {apart}");
        }
    }
}
