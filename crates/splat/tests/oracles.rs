//! Answers from paper, which hold for any renderer of this model.

use std::ops::ControlFlow;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{
    Camera, ClipPlane, Composite, Crop, Error, Kernel, Picture, Projection, RenderOptions, Samples, Shading,
    TransferFunction, Volume,
};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::{ProgressCallback, render, render_base_planes};
use wavesplat_testkit::{Phantom, camera_towards, max_difference, mean_brightness, opacity_ramp, psnr_db};

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 14.0 };

fn perspective(degrees: f64) -> Projection {
    Projection::Perspective { view_angle_rad: degrees.to_radians() }
}

fn options() -> RenderOptions {
    RenderOptions { width_px: 72, height_px: 56, ..RenderOptions::default() }
}

fn draw(volume: &Volume, tf: &TransferFunction, camera: &Camera, options: &RenderOptions) -> Picture {
    draw_with(volume, Kernel::Linear, tf, camera, options)
}

fn draw_with(
    volume: &Volume,
    kernel: Kernel,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
) -> Picture {
    let slices = Slices::new(volume, kernel);
    render(&slices, tf, camera, options, &()).expect("the scene is valid").0
}

/// A sheared, anisotropic, rotated grid.
fn awkward_affine() -> DAffine3 {
    let shear = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.2, -0.35, 1.0));
    let scale = DMat3::from_diagonal(DVec3::new(0.8, 1.3, 1.7));
    DAffine3 { matrix3: DMat3::from_rotation_y(0.4) * shear * scale, translation: DVec3::new(-3.0, 5.0, 11.0) }
}

/// Directions that cover all three families, both signs, and their borders.
fn directions() -> Vec<DVec3> {
    let mut all = Vec::new();
    for (x, y, z) in
        [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 0.0), (1.0, 0.9, 1.1), (0.3, -1.0, 0.6)]
    {
        all.push(DVec3::new(x, y, z));
        all.push(-DVec3::new(x, y, z));
    }
    all
}

/// Fog of a known density obeys `A = 1 − exp(−τ L)` on every ray, for any number of sheets, view, grid and cut.
fn check_beer_lambert(phantom: &Phantom, camera: &Camera, options: &RenderOptions) {
    let opacity_per_unit: f64 = 0.06;
    let tf = opacity_ramp(&[(0.0, opacity_per_unit)], Some(1.5));
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let (pictures, _) = render_base_planes(&slices, &tf, camera, options, &()).unwrap();
    let region = wavesplat_splat::view::region::Region::new(volume.grid(), options).unwrap();
    let mut n_hit = 0;
    for picture in &pictures {
        for (t, texel) in picture.texels().iter().enumerate() {
            let n_u = picture.plane.size[0];
            let ray = picture.plane.ray((t % n_u) as f64, (t / n_u) as f64);
            let [lo, hi] = region.drawn_interval(&picture.plane, &ray);
            let axes = picture.plane.family.axes;
            let columns = axes.map(|a| volume.grid().world_from_index().matrix3.col(a));
            let per_slice = columns[0] * ray.slope[0] + columns[1] * ray.slope[1] + columns[2];
            let depth = -(-opacity_per_unit).ln_1p() * (hi - lo).max(0.0) * per_slice.length() / 1.5;
            let want = -(-depth).exp_m1();
            let got = f64::from(texel[3]);
            let (i, j) = (t % n_u / 16 * 16, t / n_u / 8 * 8);
            if !picture.plane.is_needed([i, j], [i + 15, j + 7]) {
                assert!(got == 0.0, "texel {t}: {got} where no pixel looks, {options:?}");
                continue;
            }
            assert!((got - want).abs() < 1e-6, "texel {t}: {got} for {want}, {options:?}");
            n_hit += usize::from(want > 0.01);
        }
    }
    assert!(n_hit > 100, "only {n_hit} rays meet the fog");
}

#[test]
fn fog_obeys_beer_lambert_from_every_side() {
    for affine in [DAffine3::IDENTITY, awkward_affine()] {
        let phantom = Phantom::fog([13, 11, 9], affine, 100.0);
        for direction in directions() {
            for projection in [ORTHOGRAPHIC, perspective(35.0)] {
                let camera = camera_towards(phantom.centre(), direction, 40.0, projection);
                check_beer_lambert(&phantom, &camera, &RenderOptions { shading: None, ..options() });
            }
        }
    }
}

#[test]
fn fog_obeys_beer_lambert_for_any_number_of_sheets() {
    let phantom = Phantom::fog([13, 11, 17], awkward_affine(), 100.0);
    let camera = camera_towards(phantom.centre(), DVec3::new(0.3, 0.4, 1.0), 50.0, ORTHOGRAPHIC);
    for sheets_per_slice in [0.05, 0.3, 1.0, 2.0, 7.3, 64.0] {
        check_beer_lambert(&phantom, &camera, &RenderOptions { sheets_per_slice, shading: None, ..options() });
    }
}

#[test]
fn cuts_are_clean_at_sub_voxel_positions() {
    let phantom = Phantom::fog([13, 11, 17], awkward_affine(), 100.0);
    let camera = camera_towards(phantom.centre(), DVec3::new(-0.5, 0.4, 0.7), 50.0, ORTHOGRAPHIC);
    let crop = |lo: f64, hi: f64| Some(Crop::Index { lo: DVec3::splat(lo), hi: DVec3::new(9.0, 9.5, hi) });
    for crop in [crop(0.3, 12.7), crop(2.41, 2.93), crop(-4.0, 99.0)] {
        check_beer_lambert(&phantom, &camera, &RenderOptions { crop, shading: None, ..options() });
    }
    let centre = phantom.centre();
    let crop = Some(Crop::World { lo: centre - DVec3::new(3.1, 2.2, 4.7), hi: centre + DVec3::splat(2.9) });
    let clip_planes = vec![ClipPlane { origin: centre, normal: DVec3::new(0.3, 2.0, -0.4) }];
    check_beer_lambert(&phantom, &camera, &RenderOptions { crop, clip_planes, shading: None, ..options() });
}

#[test]
fn the_eye_may_be_inside_and_the_angle_wide() {
    let phantom = Phantom::fog([13, 11, 17], awkward_affine(), 100.0);
    for degrees in [60.0, 120.0, 150.0] {
        for direction in [DVec3::new(0.1, 0.2, 1.0), DVec3::new(1.0, 0.8, -0.9)] {
            let inside = phantom.centre() + DVec3::new(0.4, -0.7, 0.9);
            let camera = camera_towards(inside, direction, 0.001, perspective(degrees));
            let options = RenderOptions { shading: None, ..options() };
            check_beer_lambert(&phantom, &camera, &options);
            // Every pixel is served: no gap at the seams between families.
            let tf = opacity_ramp(&[(0.0, 0.06)], Some(1.5));
            let picture = draw(&phantom.volume(), &tf, &camera, &options);
            let volume = phantom.volume();
            let rays = IndexRays::new(&camera, volume.grid().index_from_world(), 72, 56);
            let region = wavesplat_splat::view::region::Region::new(volume.grid(), &options).unwrap();
            for (i, pixel) in picture.rgba.iter().enumerate() {
                let (x, y) = ((i % 72) as f64 + 0.5, (i / 72) as f64 + 0.5);
                let (origin, direction) = (rays.origin(x, y), rays.direction(x, y));
                let [t0, t1] = region.passage(origin, direction, [0.0, f64::INFINITY]).ends;
                let length = (volume.grid().world_from_index().matrix3 * direction).length() * (t1 - t0);
                let want = -(0.94_f64.ln() * length / 1.5).exp_m1();
                // The warp is a cubic: second-order small where the fog's edges are not in reach.
                assert!((f64::from(pixel[3]) - want).abs() < 0.02, "pixel {x} {y}: {} for {want}", pixel[3]);
            }
        }
    }
}

fn ball_scene() -> (Phantom, TransferFunction) {
    let centre = DVec3::new(9.3, 10.2, 8.6);
    let phantom = Phantom::sample([20, 21, 19], DAffine3::IDENTITY, |p| {
        let ball = 255.0 * ((7.0 - p.distance(centre)) / 3.0 + 0.5).clamp(0.0, 1.0);
        ball * (0.8 + 0.2 * (p.x * 0.9).sin() * (p.y * 0.7).cos())
    });
    (phantom, opacity_ramp(&[(30.0, 0.0), (120.0, 0.1), (255.0, 0.5)], None))
}

#[test]
fn quarter_turns_permute_pixels() {
    let (phantom, tf) = ball_scene();
    // One family serves each picture.
    let direction = DVec3::new(0.3, 0.9, 0.25);
    let [nx, ny, nz] = phantom.size;
    // (x, y) -> (n_y − 1 − y, x): a quarter turn about z.
    let mut turned = Phantom { samples: Vec::new(), size: [ny, nx, nz], world_from_index: DAffine3::IDENTITY };
    for k in 0..nz {
        for j in 0..nx {
            for i in 0..ny {
                turned.samples.push(phantom.samples[j + nx * ((ny - 1 - i) + ny * k)]);
            }
        }
    }
    let turn = DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2);
    for projection in [ORTHOGRAPHIC, perspective(30.0)] {
        let straight_camera = camera_towards(phantom.centre(), direction, 50.0, projection);
        let turned_camera = camera_towards(turned.centre(), turn * direction, 50.0, projection);
        let a = draw(&phantom.volume(), &tf, &straight_camera, &options());
        let b = draw(&turned.volume(), &tf, &turned_camera, &options());
        assert!(mean_brightness(&a.rgba) > 0.05);
        let difference = max_difference(&a.rgba, &b.rgba);
        assert!(difference < 2e-5, "{difference}");
    }
}

#[test]
fn front_slab_over_back_slab_is_the_whole() {
    let (phantom, tf) = ball_scene();
    let volume = phantom.volume();
    for (direction, projection) in [(DVec3::Z, ORTHOGRAPHIC), (DVec3::new(0.3, 0.2, 1.0), perspective(30.0))] {
        let camera = camera_towards(phantom.centre(), direction, 50.0, projection);
        let part = |z: [f64; 2]| {
            let crop = Crop::Index { lo: DVec3::new(0.0, 0.0, z[0]), hi: DVec3::new(19.0, 20.0, z[1]) };
            // The parts have a cut face more than the whole.
            let shading = Some(Shading { even_cuts: 0.0, ..Shading::default() });
            let options = RenderOptions { crop: Some(crop), shading, ..options() };
            let slices = Slices::new(&volume, Kernel::Linear);
            render_base_planes(&slices, &tf, &camera, &options, &()).unwrap().0
        };
        // The eye is at +z: the upper half is in front. Sheets lie on the slices, so 9 is a sheet.
        let (whole, front, back) = (part([0.0, 18.0]), part([9.0, 18.0]), part([0.0, 9.0]));
        let [nu, nv] = whole[0].plane.size;
        let mut n = 0;
        for j in 0..nv {
            for i in 0..nu {
                let at = |picture: &wavesplat_splat::picture::base_picture::BasePicture| {
                    // Cropped parts have their own base plane; find the texel on the same ray.
                    let p = &picture.plane;
                    let offset = (whole[0].plane.origin - p.origin) / p.step;
                    let (i, j) = (i as f64 + offset.x.round(), j as f64 + offset.y.round());
                    let inside = i >= 0.0 && j >= 0.0 && i < p.size[0] as f64 && j < p.size[1] as f64;
                    if inside { picture.texels()[j as usize * p.size[0] + i as usize] } else { [0.0; 4] }
                };
                let (w, f, b) = (at(&whole[0]), at(&front[0]), at(&back[0]));
                for c in 0..4 {
                    let composed = f[c] + (1.0 - f[3]) * b[c];
                    assert!((composed - w[c]).abs() < 1e-5, "texel {i} {j}: {composed} for {}", w[c]);
                }
                n += usize::from(f[3] > 0.1 && b[3] > 0.1);
            }
        }
        assert!(n > 100, "both halves are seen");
    }
}

#[test]
fn a_volume_scaled_with_its_opacity_unit_gives_the_same_picture() {
    let (phantom, _) = ball_scene();
    let nodes = [(30.0, 0.0), (120.0, 0.1), (255.0, 0.5)];
    let scaled = Phantom { world_from_index: DAffine3::from_scale(DVec3::splat(0.001)), ..phantom.clone() };
    let direction = DVec3::new(0.4, 0.8, 0.3);
    let camera = camera_towards(phantom.centre(), direction, 50.0, ORTHOGRAPHIC);
    let small = Projection::Orthographic { parallel_scale: 0.014 };
    let scaled_camera = camera_towards(scaled.centre(), direction, 0.05, small);
    let a = draw(&phantom.volume(), &opacity_ramp(&nodes, Some(2.0)), &camera, &options());
    let b = draw(&scaled.volume(), &opacity_ramp(&nodes, Some(0.002)), &scaled_camera, &options());
    let c = draw(&scaled.volume(), &opacity_ramp(&nodes, None), &scaled_camera, &options());
    assert!(max_difference(&a.rgba, &b.rgba) < 1e-5);
    assert!(max_difference(&a.rgba, &c.rgba) > 0.05, "the unit matters");
}

#[test]
fn halving_the_sheets_changes_no_brightness() {
    let (phantom, tf) = ball_scene();
    let camera = camera_towards(phantom.centre(), DVec3::new(0.4, 0.8, 0.3), 50.0, ORTHOGRAPHIC);
    let brightness = [4.0, 2.0, 1.0].map(|sheets_per_slice| {
        let options =
            RenderOptions { sheets_per_slice, pre_integration: false, early_ray_termination: false, ..options() };
        // Highlights are narrower than sheets are apart.
        let options = RenderOptions { shading: Some(Shading::headlight()), ..options };
        mean_brightness(&draw(&phantom.volume(), &tf, &camera, &options).rgba)
    });
    for b in brightness {
        assert!((b / brightness[0] - 1.0).abs() < 3e-3, "{brightness:?}");
    }
}

#[test]
fn a_gantry_tilt_draws_a_sphere_as_a_sphere() {
    let centre = DVec3::new(14.0, 14.0, 14.0);
    let tf = opacity_ramp(&[(120.0, 0.0), (136.0, 1.0)], None);
    let straight = Phantom::ball([29, 29, 29], DAffine3::IDENTITY, centre, 9.0, 2.0);
    // Slices tilted by 20 degrees about x: each one shifted along y.
    let tilt = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.0, 20.0_f64.to_radians().tan(), 1.0));
    let affine = DAffine3 { matrix3: tilt, translation: DVec3::new(0.0, -5.5, 0.0) };
    let tilted = Phantom::ball([29, 40, 29], affine, centre, 9.0, 2.0);
    for direction in directions() {
        let camera = camera_towards(centre, direction, 60.0, ORTHOGRAPHIC);
        let a = draw(&straight.volume(), &tf, &camera, &options());
        let b = draw(&tilted.volume(), &tf, &camera, &options());
        let psnr = psnr_db(&a.rgba, &b.rgba);
        assert!(mean_brightness(&a.rgba) > 0.1 && psnr > 33.0, "{direction}: {psnr} dB");
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let (phantom, tf) = ball_scene();
    let camera = camera_towards(phantom.centre(), DVec3::new(0.4, 0.8, 0.3), 30.0, perspective(60.0));
    let draw_with = |n_threads| {
        let options = RenderOptions { n_threads, oversampling: 2.0, with_depth: true, ..options() };
        let picture = draw(&phantom.volume(), &tf, &camera, &options);
        let depth = picture.depth.unwrap();
        (
            picture.rgba.as_flattened().iter().map(|c| c.to_bits()).collect::<Vec<_>>(),
            depth.iter().map(|d| d.to_bits()).collect::<Vec<_>>(),
        )
    };
    let one = draw_with(Some(1));
    assert_eq!(one, draw_with(Some(2)));
    assert_eq!(one, draw_with(Some(7)));
    assert_eq!(one, draw_with(None));
}

#[test]
fn every_sample_type_gives_the_same_picture() {
    let (phantom, tf) = ball_scene();
    let camera = camera_towards(phantom.centre(), DVec3::new(0.4, 0.8, 0.3), 50.0, ORTHOGRAPHIC);
    let bytes: Vec<u8> = phantom.samples.iter().map(|s| s.round() as u8).collect();
    let picture = |samples: Samples, tf: &TransferFunction| {
        let volume = Volume::new("typed", samples, phantom.size, DAffine3::IDENTITY).unwrap();
        draw(&volume, tf, &camera, &options()).rgba
    };
    macro_rules! check {
        ($($variant:ident $t:ty),*) => {$(
            let values: Vec<$t> = bytes.iter().map(|&b| <$t>::from(b)).collect();
            let difference = max_difference(&picture(Samples::$variant(&values), &tf), &picture(Samples::U8(&bytes), &tf));
            assert!(difference < 2e-4, "{}: {difference}", stringify!($variant));
        )*};
    }
    check!(U16 u16, I16 i16, U32 u32, I32 i32, F32 f32, F64 f64);
    let signed: Vec<i8> = bytes.iter().map(|&b| (i16::from(b) / 2) as i8).collect();
    let halves: Vec<u8> = bytes.iter().map(|&b| b / 2).collect();
    assert_eq!(picture(Samples::I8(&signed), &tf), picture(Samples::U8(&halves), &tf));
}

#[test]
fn large_offsets_and_ranges_do_not_lose_the_picture() {
    let (phantom, tf) = ball_scene();
    let camera = camera_towards(phantom.centre(), DVec3::new(0.4, 0.8, 0.3), 50.0, ORTHOGRAPHIC);
    let want = draw(&phantom.volume(), &tf, &camera, &options()).rgba;
    for (offset, scale) in [(1e12, 1.0), (0.0, 1e200), (-5e-7, 1e-9)] {
        let values: Vec<f64> = phantom.samples.iter().map(|&s| f64::from(s) * scale + offset).collect();
        let volume = Volume::new("far", Samples::F64(&values), phantom.size, DAffine3::IDENTITY).unwrap();
        let map = |v: f64| v * scale + offset;
        let tf = TransferFunction::new(
            tf.opacity_nodes().iter().map(|n| wavesplat_core::OpacityNode { value: map(n.value), ..*n }).collect(),
            tf.color_nodes().iter().map(|n| wavesplat_core::ColorNode { value: map(n.value), ..*n }).collect(),
            None,
        );
        let got = draw(&volume, &tf.unwrap(), &camera, &options()).rgba;
        let difference = max_difference(&got, &want);
        assert!(difference < 2e-3, "offset {offset}, scale {scale}: {difference}");
    }
}

#[test]
fn what_is_not_finite_is_empty() {
    let mut phantom = Phantom::fog([12, 12, 12], DAffine3::IDENTITY, 100.0);
    for (i, s) in phantom.samples.iter_mut().enumerate() {
        if i % 12 < 6 {
            *s = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][i % 3];
        }
    }
    let tf = opacity_ramp(&[(0.0, 0.5)], None);
    let volume = phantom.volume();
    let camera = camera_towards(phantom.centre(), DVec3::Z, 50.0, Projection::Orthographic { parallel_scale: 5.5 });
    for (_, kernel) in Kernel::NAMES {
        let options = RenderOptions { width_px: 48, height_px: 48, ..options() };
        let slices = Slices::new(&volume, kernel);
        let (picture, report) = render(&slices, &tf, &camera, &options, &()).unwrap();
        assert_eq!(report.n_nonfinite_samples, 6 * 12 * 12);
        assert!(picture.rgba.as_flattened().iter().all(|c| c.is_finite()), "{kernel:?}");
        let row = &picture.rgba[24 * 48..25 * 48];
        assert!(row[..16].iter().all(|p| p[3] == 0.0), "{kernel:?}: holes are empty");
        // The holes' border is not a surface: right of it the fog is even.
        assert!(row[36..46].iter().all(|p| (p[3] - row[40][3]).abs() < 1e-5 && p[3] > 0.9), "{kernel:?}");
    }
}

#[test]
fn projections_along_an_axis_are_those_of_the_samples() {
    let (phantom, _) = ball_scene();
    let tf = opacity_ramp(&[(0.0, 1.0)], None);
    let [nx, ny, nz] = phantom.size;
    let volume = phantom.volume();
    // One pixel per sample, looking down z with y up.
    let projection = Projection::Orthographic { parallel_scale: ny as f64 / 2.0 };
    let camera = camera_towards(phantom.centre(), DVec3::Z, 50.0, projection);
    let samples = &phantom.samples;
    let column = |x: usize, y: usize| (0..nz).map(move |z| f64::from(samples[x + nx * (y + ny * z)]));
    let check = |composite, sheets_per_slice, want: &dyn Fn(usize, usize) -> f64, tolerance: f64| {
        let options = RenderOptions { width_px: nx, height_px: ny, composite, sheets_per_slice, ..options() };
        let value = draw(&volume, &tf, &camera, &options).value.unwrap();
        for y in 0..ny {
            for x in 0..nx {
                let got = f64::from(value[(ny - 1 - y) * nx + x]);
                let want = want(x, y);
                assert!((got - want).abs() <= tolerance, "{composite:?} at {x} {y}: {got} for {want}");
            }
        }
    };
    let trapezoid = |x: usize, y: usize| {
        let ends = f64::from(phantom.samples[x + nx * y] + phantom.samples[x + nx * (y + ny * (nz - 1))]);
        column(x, y).sum::<f64>() - ends / 2.0
    };
    for sheets in [1.0, 2.0] {
        check(Composite::Maximum, sheets, &|x, y| column(x, y).fold(0.0, f64::max), 1e-4);
        check(Composite::Minimum, sheets, &|x, y| column(x, y).fold(999.0, f64::min), 1e-4);
        check(Composite::Sum, sheets, &trapezoid, 1e-2);
        check(Composite::Mean, sheets, &|x, y| trapezoid(x, y) / (nz - 1) as f64, 1e-3);
    }
}

#[test]
fn first_hit_finds_the_sphere() {
    let centre = DVec3::splat(14.0);
    let (radius, distance) = (9.0, 60.0);
    // The distance itself as the value: linear across the surface.
    let phantom = Phantom::sample([29; 3], DAffine3::IDENTITY, |p| 200.0 - 10.0 * p.distance(centre));
    let tf = opacity_ramp(&[(0.0, 0.3)], None);
    for direction in directions() {
        let camera = camera_towards(centre, direction, distance, ORTHOGRAPHIC);
        let composite = Composite::FirstHit { iso_value: 200.0 - 10.0 * radius };
        let options = RenderOptions { width_px: 57, height_px: 57, composite, with_depth: true, ..options() };
        let picture = draw(&phantom.volume(), &tf, &camera, &options);
        let depth = picture.depth.unwrap();
        for (i, pixel) in picture.rgba.iter().enumerate() {
            let offset = |p: usize| (p as f64 + 0.5 - 28.5) / 28.5 * 14.0;
            let r = offset(i % 57).hypot(offset(i / 57));
            if r < radius - 1.0 {
                let want = distance - (radius * radius - r * r).sqrt();
                assert!(pixel[3] > 0.999, "{direction} r = {r}");
                // Trilinear reconstruction cuts the corners of the cone by up to an eighth of its curvature.
                assert!((f64::from(depth[i]) - want).abs() < 0.2, "{direction} r = {r}: {} for {want}", depth[i]);
            } else if r > radius + 0.8 {
                assert!(pixel[3] < 1e-3 && depth[i].is_nan(), "{direction} r = {r}");
            }
        }
        let middle = 28 * 57 + 28;
        assert!((f64::from(depth[middle]) - (distance - radius)).abs() < 0.05, "{direction}: {}", depth[middle]);
    }
}

#[test]
fn depth_is_where_half_the_light_is_gone() {
    let phantom = Phantom::fog([21; 3], DAffine3::IDENTITY, 100.0);
    let tf = opacity_ramp(&[(0.0, 0.1)], None);
    for projection in [ORTHOGRAPHIC, perspective(20.0)] {
        let camera = camera_towards(phantom.centre(), DVec3::NEG_Y, 50.0, projection);
        let options = RenderOptions { width_px: 33, height_px: 33, with_depth: true, ..options() };
        let depth = draw(&phantom.volume(), &tf, &camera, &options).depth.unwrap();
        // 0.9^L = ½ at L = 6.58 below the face, which is 40 in front of the eye.
        let want = 40.0 + 0.5_f64.ln() / 0.9_f64.ln();
        let got = f64::from(depth[16 * 33 + 16]);
        assert!((got - want).abs() < 0.02, "{got} for {want}");
    }
}

struct StopAfter(f32);

impl ProgressCallback for StopAfter {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        if fraction > self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn work_can_be_cancelled() {
    let (phantom, tf) = ball_scene();
    let volume = phantom.volume();
    let camera = camera_towards(phantom.centre(), DVec3::ONE, 50.0, ORTHOGRAPHIC);
    let options = RenderOptions { width_px: 256, height_px: 256, ..options() };
    let slices = Slices::new(&volume, Kernel::Linear);
    let result = render(&slices, &tf, &camera, &options, &StopAfter(0.3));
    assert_eq!(result.unwrap_err(), Error::Cancelled);
}

#[test]
fn nothing_visible_is_an_empty_picture() {
    let (phantom, _) = ball_scene();
    let tf = opacity_ramp(&[(0.0, 0.0)], None);
    let camera = camera_towards(phantom.centre(), DVec3::ONE, 50.0, ORTHOGRAPHIC);
    let picture = draw(&phantom.volume(), &tf, &camera, &options());
    assert!(picture.rgba.iter().all(|p| *p == [0.0; 4]));
    // Beside the volume, and turned away from it.
    for (focal, from) in [(DVec3::splat(500.0), DVec3::X), (DVec3::splat(-90.0), DVec3::ONE)] {
        let camera = camera_towards(focal, from, 10.0, perspective(30.0));
        let picture = draw(&phantom.volume(), &opacity_ramp(&[(0.0, 0.5)], None), &camera, &options());
        assert!(picture.rgba.iter().all(|p| *p == [0.0; 4]));
    }
}

#[test]
fn the_background_lies_behind() {
    let phantom = Phantom::fog([12; 3], DAffine3::IDENTITY, 100.0);
    let camera = camera_towards(phantom.centre(), DVec3::Z, 50.0, ORTHOGRAPHIC);
    let tf = opacity_ramp(&[(0.0, 0.1)], None);
    let transparent = draw(&phantom.volume(), &tf, &camera, &options());
    let options = RenderOptions { background: Some([1.0, 0.5, 0.0, 1.0]), ..options() };
    let opaque = draw(&phantom.volume(), &tf, &camera, &options);
    for (t, o) in transparent.rgba.iter().zip(&opaque.rgba) {
        for (c, back) in [1.0, 0.5, 0.0, 1.0].into_iter().enumerate() {
            assert!((o[c] - (t[c] + (1.0 - t[3]) * back)).abs() < 1e-6);
        }
    }
}

mod properties {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

        /// Any scene gives finite associated colours, whatever its sizes, grid, view, kernel and quality.
        #[test]
        fn pictures_are_always_valid(
            size in prop::array::uniform3(2_usize..12),
            spacing in prop::array::uniform3(0.05_f64..20.0),
            seed in 0_u32..1000,
            direction in prop::array::uniform3(-1.0_f64..1.0),
            angle in prop::option::of(5.0_f64..170.0),
            distance in 0.01_f64..60.0,
            kernel in 0_usize..5,
            quality in (0.1_f64..5.0, 0.2_f64..2.5),
            shaded in any::<bool>(),
            composite in 0_usize..10,
        ) {
            let from = DVec3::from_array(direction);
            prop_assume!(from.length() > 0.1);
            let affine = DAffine3::from_scale(DVec3::from_array(spacing));
            let mut state = seed;
            let phantom = Phantom::sample(size, affine, |_| {
                state_step(&mut state)
            });
            let tf = opacity_ramp(&[(40.0, 0.0), (90.0, 0.4), (91.0, 1.0), (200.0, 0.2)], None);
            let projection = angle.map_or(ORTHOGRAPHIC, perspective);
            let camera = camera_towards(phantom.centre(), from, distance, projection);
            let operators = [
                Composite::Over, Composite::Maximum, Composite::Minimum, Composite::Mean, Composite::Sum,
                Composite::FirstHit { iso_value: 100.0 },
                Composite::DepthShadedMaximum { strength: 0.8, black: 50.0 },
                Composite::LocalMaximum { threshold: 150.0 },
                Composite::AttenuatedMaximum { black: 50.0, white: 180.0, attenuation: 0.3 },
                Composite::XRay { clear: 30.0, attenuation: 0.001 },
            ];
            let options = RenderOptions {
                width_px: 23,
                height_px: 17,
                composite: operators[composite],
                sheets_per_slice: quality.0,
                oversampling: quality.1,
                shading: shaded.then(Shading::default),
                with_depth: true,
                ..RenderOptions::default()
            };
            let kernel = Kernel::NAMES[kernel].1;
            let picture = draw_with(&phantom.volume(), kernel, &tf, &camera, &options);
            for p in &picture.rgba {
                prop_assert!(p.iter().all(|c| c.is_finite() && *c >= -1e-6 && *c <= 1.001), "{p:?}");
                // The default terms of Phong shading sum to 1.
                prop_assert!((0..3).all(|c| p[c] <= p[3] + 1e-5), "{p:?}");
            }
        }
    }

    fn state_step(state: &mut u32) -> f64 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(*state >> 24)
    }
}
