//! The fast path against itself: one scene drawn in several ways is one picture.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{Composite, Gradient, Kernel, Projection, RenderOptions, Shading};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::frame::{draw_base_planes, finish};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, render, render_base_planes_at};
use wavesplat_testkit::{PROJECTIONS, Phantom, camera_towards, max_difference, opacity_ramp, psnr_db};

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 9.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

#[test]
fn every_simd_level_gives_the_same_bits() {
    let phantom = Phantom::sheared_waves();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(40.0, 0.0), (120.0, 0.2), (121.0, 1.0), (200.0, 0.6)], None);
    for (_, kernel) in Kernel::NAMES {
        let slices = Slices::new(&volume, kernel);
        let drawn = [Composite::Over, Composite::FirstHit { iso_value: 130.0 }];
        for composite in drawn.into_iter().chain(PROJECTIONS) {
            let camera = camera_towards(phantom.centre(), DVec3::new(0.6, -1.0, -0.5), 30.0, PERSPECTIVE);
            let options = RenderOptions { width_px: 90, height_px: 60, composite, ..RenderOptions::default() };
            let draw = |level| {
                let pictures = render_base_planes_at(level, &slices, &tf, &camera, &options, &()).unwrap().0;
                let texels = pictures.iter().flat_map(|p| [p.texels().into_flattened(), p.w_half.clone()]);
                texels.flatten().map(f32::to_bits).collect()
            };
            let baseline: Vec<u32> = draw(Level::all()[0]);
            for level in Level::all() {
                assert!(draw(level) == baseline, "{level:?} {kernel:?} {composite:?}");
            }
        }
    }
}

/// The same bits on every processor: the stored hashes are of pictures drawn on x86-64, and 64-bit ARM draws them too.
///
/// Samples are made without sines. The system's mathematical library (`tan`, `ln_1p`, `exp_m1`, in double precision,
/// while the renderer sets up) may differ by its last bit between libraries, which rounding to f32 nearly always hides.
/// A change that is meant to change pictures changes the hashes: the test prints the new ones.
#[test]
fn every_processor_gives_the_same_bits() {
    let phantom = Phantom::sample([21, 20, 19], DAffine3::from_scale(DVec3::new(0.5, 0.4, 0.6)), |p| {
        let [x, y, z] = [p.x - 5.0, p.y - 4.0, p.z - 5.5];
        120.0 + 7.0 * x * y - 4.0 * y * z + 0.8 * x * x * z - 1.5 * z * z + 90.0 / (1.0 + x * x + y * y)
    });
    let volume = phantom.volume();
    let (soft, hard) = (&[(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)][..], &[(149.0, 0.0), (150.0, 1.0)][..]);
    let shaded = || Some(Shading::headlight());
    let orthographic = Projection::Orthographic { parallel_scale: 5.0 };
    let mut wrong = Vec::new();
    for (name, kernel, nodes, shading, projection, want) in [
        ("soft", Kernel::Linear, soft, None, orthographic, 0x4969_5879_8a63_6829),
        ("hard", Kernel::Linear, hard, None, PERSPECTIVE, 0xec3b_121b_3ee6_58df),
        ("soft shaded", Kernel::CatmullRom, soft, shaded(), PERSPECTIVE, 0xa23f_fbf7_250f_aad4),
        ("hard shaded", Kernel::Bspline3, hard, shaded(), orthographic, 0x257b_388a_6eb3_02e4),
    ] {
        let camera = camera_towards(phantom.centre(), DVec3::new(0.6, -1.0, -0.5), 20.0, projection);
        let options =
            RenderOptions { width_px: 48, height_px: 32, shading, oversampling: 2.0, ..RenderOptions::default() };
        let (picture, _) =
            render(&Slices::new(&volume, kernel), &opacity_ramp(nodes, None), &camera, &options, &()).unwrap();
        let n_shown = picture.rgba.iter().filter(|pixel| pixel[3] > 0.1).count();
        assert!(n_shown > 300, "{name}: {n_shown} pixels show something");
        let got = hash(picture.rgba.as_flattened());
        if got != want {
            wrong.push(format!("{name}: {got:#018x}, not {want:#018x}"));
        }
    }
    assert!(wrong.is_empty(), "pictures have other bits:\n{}", wrong.join("\n"));
}

/// FNV-1a of the bits of numbers.
fn hash(numbers: &[f32]) -> u64 {
    let bytes = numbers.iter().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Early ray termination changes no channel by a grey level of 1024.
#[test]
fn stopping_changes_no_channel_by_a_grey_level_of_1024() {
    let phantom = Phantom::sheared_waves();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(40.0, 0.0), (100.0, 0.1)], Some(0.03));
    let slices = Slices::new(&volume, Kernel::Linear);
    for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
        let camera = camera_towards(phantom.centre(), DVec3::new(0.6, -1.0, -0.5), 30.0, projection);
        let draw = |early_ray_termination| {
            let options = RenderOptions {
                width_px: 90,
                height_px: 70,
                early_ray_termination,
                sheets_per_slice: 32.0,
                ..RenderOptions::default()
            };
            render(&slices, &tf, &camera, &options, &()).unwrap().0
        };
        let (stopped, whole) = (draw(true), draw(false));
        assert!(whole.rgba.iter().any(|pixel| pixel[3] > 0.9999), "some rays are opaque");
        let difference = max_difference(&stopped.rgba, &whole.rgba);
        assert!(difference > 0.0 && difference < 1.0 / 1024.0, "{difference}");
    }
}

/// Few pre-integrated slabs give the picture of very many plain sheets, and the more the nearer.
#[test]
fn pre_integrated_slabs_converge_to_plain_sheets() {
    let phantom = Phantom::ripples(24);
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(120.0, 0.0), (136.0, 1.0)], None);
    let slices = Slices::new(&volume, Kernel::Linear);
    let camera = camera_towards(phantom.centre(), DVec3::new(0.7, 0.7, 0.55), 60.0, ORTHOGRAPHIC);
    let draw = |pre_integration, sheets_per_slice| {
        let options = RenderOptions {
            width_px: 90,
            height_px: 90,
            pre_integration,
            sheets_per_slice,
            // Even light is taken once per fragment, so it converges more slowly than slabs of it do.
            shading: Some(Shading { even_cuts: 0.0, ..Shading::default() }),
            ..RenderOptions::default()
        };
        let cache = VisibilityCache::default();
        let shading = options.shading.as_ref();
        let layer =
            Layer { slices: &slices, transfer_function: &tf, shading, labels: None, color: None, cache: &cache };
        // Means of several reads have less of the sheets' errors.
        let plan = Plan { reads_per_axis: 1, ..Plan::new(Level::best(), &[layer], &camera, &options).unwrap() };
        let (base_pictures, _) = draw_base_planes(&plan, &[&slices], &()).unwrap();
        finish(&plan, &base_pictures).rgba
    };
    let want = draw(false, 64.0);
    let psnr = |pre_integration, sheets| psnr_db(&draw(pre_integration, sheets), &want);
    let (two, eight, plain) = (psnr(true, 2.0), psnr(true, 8.0), psnr(false, 2.0));
    assert!(two > plain + 4.0 && eight > two + 3.0 && eight > 40.0, "{two} {eight} dB, plain {plain} dB");
}

/// A volume that is decoded gives the picture of its samples, all at once or as it is drawn: the same bits, but for
/// splines in blocks, whose coefficients come from a part of each line.
#[test]
fn a_decoded_volume_gives_the_picture_of_its_samples() {
    let affine = DAffine3::from_scale(DVec3::new(0.3, 0.25, 0.4));
    let phantom = Phantom::sample([70, 45, 41], affine, |p| {
        120.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
    });
    let volume = phantom.volume();
    let grid = volume.grid();
    let tf = opacity_ramp(&[(140.0, 0.0), (150.0, 0.1), (151.0, 1.0), (200.0, 0.6)], None);
    let decoder = Arc::new(phantom.clone());
    // Enough for all, and hardly less, which keeps few blocks but bounds of the same bricks: the same work is reported.
    let block_bytes = 32 * 32 * 32 * 4;
    let budgets_bytes = [100 * block_bytes, 70 * 45 * 41 * 4 - 1];
    for (_, kernel) in Kernel::NAMES {
        let slices = Slices::new(&volume, kernel);
        let decoded = budgets_bytes.map(|bytes| Slices::of_decoder(decoder.clone(), grid, kernel, bytes));
        for (from, sheets_per_slice, projection) in [
            (DVec3::new(0.2, 0.3, 1.0), 2.0, ORTHOGRAPHIC),
            (DVec3::new(-1.0, 0.5, 0.4), 1.3, ORTHOGRAPHIC),
            (DVec3::new(-0.3, 1.0, 0.2), 0.06, ORTHOGRAPHIC),
            (DVec3::new(0.6, -1.0, -0.5), 2.0, PERSPECTIVE),
        ] {
            let camera = camera_towards(phantom.centre(), from, 40.0, projection);
            let options = RenderOptions { width_px: 90, height_px: 70, sheets_per_slice, ..RenderOptions::default() };
            let draw = |slices: &Slices| render(slices, &tf, &camera, &options, &()).unwrap();
            let (want, report) = draw(&slices);
            assert!(want.rgba.iter().any(|pixel| pixel[3] > 0.9));
            for (decoded, in_blocks) in decoded.iter().zip([false, true]) {
                assert_eq!(decoded.must_load(), in_blocks);
                let (got, other) = draw(decoded);
                let difference = max_difference(&got.rgba, &want.rgba);
                match kernel {
                    Kernel::Bspline2 | Kernel::Bspline3 if in_blocks => {
                        assert!(difference < 1e-4, "{kernel:?} {from}: {difference}");
                    }
                    _ => assert!(difference == 0.0 && other == report, "{kernel:?} {from}: {difference}"),
                }
            }
        }
    }
}

/// Differences of any width find their samples in panels, also at the faces, where they are not centred.
#[test]
fn panels_hold_what_wide_differences_need() {
    let phantom = Phantom::sample([41, 38, 36], DAffine3::IDENTITY, |p| {
        130.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
    });
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(20.0, 0.02), (240.0, 0.3)], None);
    let projection = Projection::Orthographic { parallel_scale: 26.0 };
    let decoder = Arc::new(phantom.clone());
    for (_, kernel) in Kernel::NAMES {
        let slices = Slices::new(&volume, kernel);
        let decoded = Slices::of_decoder(decoder.clone(), volume.grid(), kernel, 1 << 17);
        assert!(decoded.must_load());
        let differences = [0.5, 1.7, 2.0, 2.5, 4.0].map(Gradient::Difference);
        for gradient in differences.into_iter().chain([0.5, 0.8, 1.25].map(Gradient::Smoothed)) {
            for from in [DVec3::new(0.1, 0.2, 1.0), DVec3::new(1.0, 0.2, 0.1), DVec3::new(-0.2, -1.0, 0.3)] {
                let camera = camera_towards(phantom.centre(), from, 90.0, projection);
                let shading = Some(Shading { gradient, ..Shading::headlight() });
                let options = RenderOptions { width_px: 48, height_px: 48, shading, ..RenderOptions::default() };
                let draw = |slices: &Slices| render(slices, &tf, &camera, &options, &()).unwrap().0;
                let difference = max_difference(&draw(&decoded).rgba, &draw(&slices).rgba);
                assert!(difference < 1e-4, "{kernel:?} {gradient:?} {from}: {difference}");
            }
        }
    }
}

/// Slices across x are turned in panels; the same volume with x and z swapped needs none.
#[test]
fn panels_hold_all_that_their_sheets_need() {
    // Scattered, so that the blocks that are looked at differ from slab to slab.
    let share = |i: u32, k: f64| (f64::from(i) * k).fract();
    let centre = |i| DVec3::new(96.0 * share(i, 0.618), 56.0 * share(i, 0.414), 60.0 * share(i, 0.732));
    let centres: Vec<DVec3> = (1..40).map(centre).collect();
    let value = |p: DVec3| {
        let nearest = centres.iter().map(|c| c.distance(p)).fold(f64::INFINITY, f64::min);
        255.0 * ((6.0 - nearest) / 4.0).clamp(0.0, 1.0)
    };
    let phantom = Phantom::sample([96, 56, 60], DAffine3::IDENTITY, value);
    let swap = DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::X);
    let swapped = Phantom::sample([60, 56, 96], DAffine3::from_mat3(swap), value);
    let tf = opacity_ramp(&[(60.0, 0.0), (200.0, 0.1)], None);
    let mut n_drawn = 0;
    // Not near the diagonals, where slices across x are avoided.
    for degrees in (0..90).map(|i| f64::from(i * 4)).filter(|d| (d % 90.0 - 45.0).abs() > 8.0) {
        let from = DVec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.4);
        let projection = Projection::Orthographic { parallel_scale: 55.0 };
        let camera = camera_towards(phantom.centre(), from, 200.0, projection);
        let options = RenderOptions { width_px: 512, height_px: 512, shading: None, ..RenderOptions::default() };
        let [a, b] = [&phantom, &swapped].map(|phantom| {
            let slices = Slices::new(&phantom.volume(), Kernel::Linear);
            render(&slices, &tf, &camera, &options, &()).unwrap().0
        });
        let difference = max_difference(&a.rgba, &b.rgba);
        assert!(difference < 0.01 / 255.0, "{degrees}: {} grey levels", 255.0 * difference);
        n_drawn += usize::from(a.rgba.iter().any(|pixel| pixel[3] > 0.3));
    }
    assert!(n_drawn > 70);
}
