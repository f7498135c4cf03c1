//! The promise of a wanted PSNR, on volumes, functions and views that no number was fitted on.

use glam::{DAffine3, DVec3};
use wavesplat_core::{Camera, Kernel, LADDER, Picture, Projection, RenderOptions, TransferFunction};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::quality::target_psnr::{Estimate, PsnrTarget, Sampling, render_to_psnr};
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, render};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

/// A number between 0 and 1 of an integer position (Jarzynski & Olano 2020, pcg3d).
fn random(x: u32, y: u32, z: u32) -> f64 {
    let mut v = [x, y, z].map(|n| n.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for _ in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v = v.map(|n| n ^ (n >> 16));
    }
    f64::from(v[0]) / f64::from(u32::MAX)
}

/// Volumes of several kinds, values 0 to 255.
fn phantoms() -> Vec<(&'static str, Phantom)> {
    let blobs = |p: DVec3| {
        let blob = |k: u32| {
            let at = DVec3::new(random(k, 0, 7), random(k, 1, 7), random(k, 2, 7)) * 30.0 + 5.0;
            let radius = 3.0 + 4.0 * random(k, 3, 7);
            (-(p - at).length_squared() / (radius * radius)).exp()
        };
        255.0 * (0..9).map(blob).sum::<f64>().min(1.0)
    };
    let shells = |p: DVec3| {
        let shell = |centre: DVec3, radius: f64| (-((p.distance(centre) - radius) / 1.2).powi(2)).exp();
        255.0 * (shell(DVec3::splat(19.0), 16.0) + shell(DVec3::new(15.0, 20.0, 22.0), 8.0)).min(1.0)
    };
    let noise = |p: DVec3| 255.0 * random(p.x as u32, p.y as u32, p.z as u32);
    let cut = |p: DVec3| 130.0 + 60.0 * (p.x / 5.0).sin() * (p.y / 4.0).cos() + 50.0 * (p.z / 7.0).sin();
    vec![
        ("blobs", Phantom::sample([40, 40, 40], DAffine3::IDENTITY, blobs)),
        ("ripples 20", Phantom::ripples(20)),
        ("ripples 48", Phantom::ripples(48)),
        ("noise", Phantom::sample([24, 26, 22], DAffine3::IDENTITY, noise)),
        ("shells", Phantom::sample([39, 40, 41], DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.0)), shells)),
        ("cut", Phantom::sample([30, 36, 20], DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.5)), cut)),
    ]
}

fn functions() -> Vec<(&'static str, TransferFunction)> {
    vec![
        ("soft", opacity_ramp(&[(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)], None)),
        ("dense", opacity_ramp(&[(40.0, 0.0), (220.0, 0.5)], None)),
        ("hard", opacity_ramp(&[(119.0, 0.0), (120.0, 1.0)], None)),
        ("peak", opacity_ramp(&[(90.0, 0.0), (110.0, 0.4), (130.0, 0.0)], None)),
    ]
}

/// Directions to the eye, and view angle.
const VIEWS: [(DVec3, Option<f64>); 5] = [
    (DVec3::new(0.7, 0.6, 0.5), None),
    (DVec3::new(0.0, -1.0, 0.0), None),
    (DVec3::new(-0.2, 0.9, 0.3), Some(0.5)),
    (DVec3::new(0.1, 0.2, -1.0), None),
    (DVec3::new(0.8, 0.7, 0.75), Some(0.7)),
];

fn psnr_db(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
    let sum: f64 = a.rgba.iter().zip(&b.rgba).map(square).sum();
    -10.0 * (sum / (3 * a.rgba.len()) as f64).max(1e-12).log10()
}

struct Case<'a> {
    slices: &'a Slices<'a>,
    tf: &'a TransferFunction,
    camera: Camera,
    options: RenderOptions,
}

impl Case<'_> {
    fn fixed(&self, sheets_per_slice: f64, oversampling: f64) -> Picture {
        let options = RenderOptions { sheets_per_slice, oversampling, ..self.options.clone() };
        render(self.slices, self.tf, &self.camera, &options, &()).unwrap().0
    }

    fn wanted(&self, wanted: &PsnrTarget) -> (Picture, Estimate) {
        let cache = VisibilityCache::default();
        let layer = Layer {
            slices: self.slices,
            transfer_function: self.tf,
            shading: self.options.shading.as_ref(),
            labels: None,
            color: None,
            cache: &cache,
        };
        let ladder = LADDER.map(|(sheets_per_slice, oversampling)| Sampling { sheets_per_slice, oversampling });
        let wanted = (&ladder, wanted);
        let (picture, _, told) =
            render_to_psnr(&[layer], &self.camera, &self.options, wanted, &draw_base_planes, &()).unwrap();
        (picture, told)
    }
}

fn camera(phantom: &Phantom, (towards, view_angle): (DVec3, Option<f64>)) -> Camera {
    let length = (phantom.volume().grid().last_index() * phantom.world_from_index.matrix3.x_axis.x).length();
    let projection = match view_angle {
        None => Projection::Orthographic { parallel_scale: 0.5 * length },
        Some(view_angle_rad) => Projection::Perspective { view_angle_rad },
    };
    let distance = view_angle.map_or(3.0 * length, |angle| 0.52 * length / (0.5 * angle).tan());
    camera_towards(phantom.centre(), towards, distance, projection)
}

/// Draws every `every`th scene with a wanted PSNR; calls `of_picture` with a description of the scene, the wanted PSNR,
/// the PSNR that was reached, and the estimate.
fn each(every: usize, mut of_picture: impl FnMut(&str, f64, f64, &Estimate)) {
    let every = if std::env::var_os("WAVESPLAT_NIGHTLY").is_some() { 1 } else { every };
    let mut n = 0;
    for (name, phantom) in phantoms() {
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        for (function, tf) in functions() {
            for (view, at) in VIEWS.into_iter().enumerate() {
                n += 1;
                if n % every != 0 {
                    continue;
                }
                let options = RenderOptions { width_px: 160, height_px: 144, ..RenderOptions::default() };
                let case = Case { slices: &slices, tf: &tf, camera: camera(&phantom, at), options };
                let finest = case.fixed(24.0, 8.0);
                for wanted_db in [30.0, 40.0, 50.0] {
                    let (picture, told) = case.wanted(&PsnrTarget { psnr_db: wanted_db, like: None });
                    of_picture(&format!("{name} {function} view {view}"), wanted_db, psnr_db(&picture, &finest), &told);
                }
            }
        }
    }
}

/// Largest shortfalls of a picture, in decibels, from the wanted PSNR, or from the estimate less its spread: of all
/// but one in [`ONE_IN`], and of all.
const SHORT_DB: f64 = 1.0;
const MOST_SHORT_DB: f64 = 3.0;
const ONE_IN: usize = 40;

/// The PSNR that a picture promises: the wanted one, or less where the estimate says so.
fn promised_db(wanted_db: f64, told: &Estimate) -> f64 {
    wanted_db.min(told.psnr_db - told.spread_db)
}

#[test]
fn what_is_promised_is_reached_to_a_decibel() {
    let (mut n_wanted, mut n_short, mut n) = (0, 0, 0);
    each(7, |scene, wanted_db, reached_db, told| {
        let least_db = promised_db(wanted_db, told);
        assert!(reached_db > least_db - MOST_SHORT_DB, "{scene}, {wanted_db}: {reached_db}, {told:?}");
        n_short += usize::from(reached_db <= least_db - SHORT_DB);
        n_wanted += usize::from(reached_db > wanted_db - SHORT_DB);
        n += 1;
    });
    assert!(ONE_IN * n_short <= n, "{n_short} of {n} fall short");
    // Noise with a hard step has an edge in every pixel, and faces seen along an axis lie along the texels: at 50 dB
    // the finest sampling does not do there, and the estimate says so.
    assert!(10 * n_wanted >= 9 * n, "{n_wanted} of {n} reach what was wanted");
}

/// Prints the table: `cargo test -p wavesplat-splat --test promise -- --ignored --nocapture`.
#[test]
#[ignore = "prints a table of all scenes"]
fn table() {
    let every = std::env::var("EVERY").map_or(1, |every| every.parse().unwrap());
    each(every, |scene, wanted_db, reached_db, told| {
        let is_short = reached_db <= promised_db(wanted_db, told) - SHORT_DB;
        let Estimate { sampling, psnr_db, spread_db, .. } = told;
        println!(
            "{scene:26} {wanted_db}: reached {reached_db:.1} ({:+.1}), told {psnr_db:.1} +- {spread_db:.1}, off {:+.1}, \
             {} x {:.2}{}",
            reached_db - wanted_db,
            reached_db - psnr_db,
            sampling.sheets_per_slice,
            sampling.oversampling,
            if is_short { ", short" } else { "" }
        );
    });
}
