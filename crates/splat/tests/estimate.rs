//! Pictures of a wanted PSNR, against pictures of the finest settings.

use std::ops::ControlFlow;
use std::sync::Mutex;

use glam::DVec3;
use wavesplat_core::{Camera, Composite, Error, Kernel, LADDER, Picture, Projection, RenderOptions, TransferFunction};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::quality::target_psnr::{
    Estimate, Ladder, Measured, PsnrTarget, RungError, Sampling, render_to_psnr,
};
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, ProgressCallback, render};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

fn layer<'a>(
    slices: &'a Slices,
    transfer_function: &'a TransferFunction,
    options: &'a RenderOptions,
    cache: &'a VisibilityCache,
) -> [Layer<'a>; 1] {
    [Layer { slices, transfer_function, shading: options.shading.as_ref(), labels: None, color: None, cache }]
}

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 22.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };

fn options(composite: Composite) -> RenderOptions {
    RenderOptions { width_px: 160, height_px: 130, composite, ..RenderOptions::default() }
}

fn camera(phantom: &Phantom, projection: Projection) -> Camera {
    camera_towards(phantom.centre(), DVec3::new(0.7, 0.6, 0.5), 90.0, projection)
}

fn soft() -> TransferFunction {
    opacity_ramp(&[(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)], None)
}

fn hard() -> TransferFunction {
    opacity_ramp(&[(127.0, 0.0), (128.0, 1.0)], None)
}

fn ladder() -> Ladder {
    LADDER.map(|(sheets_per_slice, oversampling)| Sampling { sheets_per_slice, oversampling })
}

/// A wanted PSNR, without a picture before.
fn wanted(psnr_db: f64) -> PsnrTarget {
    PsnrTarget { psnr_db, like: None }
}

fn psnr_db(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
    let sum: f64 = a.rgba.iter().zip(&b.rgba).map(square).sum();
    -10.0 * (sum / (3 * a.rgba.len()) as f64).log10()
}

#[test]
fn the_picture_has_the_error_that_is_told() {
    let phantom = Phantom::ripples(32);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let mut off_db = Vec::new();
    for (tf, composite, projection, all_wanted) in [
        (soft(), Composite::Over, ORTHOGRAPHIC, [34.0, 40.0, 48.0]),
        (soft(), Composite::Over, PERSPECTIVE, [34.0, 40.0, 48.0]),
        (hard(), Composite::Over, ORTHOGRAPHIC, [26.0, 30.0, 34.0]),
        (soft(), Composite::Maximum, ORTHOGRAPHIC, [34.0, 40.0, 48.0]),
        // The coarsest picture has 54 dB: means change slowly, and walls cover their shares of pixels at every
        // sampling.
        (soft(), Composite::Mean, ORTHOGRAPHIC, [34.0, 48.0, 58.0]),
        // The model predicts 33.5 dB for the finest sampling.
        (soft(), Composite::FirstHit { iso_value: 128.0 }, ORTHOGRAPHIC, [26.0, 30.0, 33.0]),
    ] {
        let options = RenderOptions { with_depth: composite == Composite::Over, ..options(composite) };
        let camera = camera(&phantom, projection);
        let finest = RenderOptions { sheets_per_slice: 12.0, oversampling: 6.0, ..options.clone() };
        let finest = render(&slices, &tf, &camera, &finest, &()).unwrap().0;
        let (mut reached, mut efforts) = (Vec::new(), Vec::new());
        for wanted_db in all_wanted {
            let (picture, _, chosen) = render_to_psnr(
                &layer(&slices, &tf, &options, &VisibilityCache::default()),
                &camera,
                &options,
                (&ladder(), &wanted(wanted_db)),
                &draw_base_planes,
                &(),
            )
            .unwrap();
            let got_db = psnr_db(&picture, &finest);
            assert!(chosen.psnr_db >= wanted_db, "{composite:?}, {wanted_db}: {chosen:?}");
            assert!(got_db > wanted_db - 1.0, "{composite:?}: {got_db}, {chosen:?}");
            assert!((got_db - chosen.psnr_db).abs() < 3.0, "{composite:?}: {got_db}, {chosen:?}");
            off_db.push((got_db - chosen.psnr_db).abs());
            reached.push(got_db);
            let Sampling { sheets_per_slice, oversampling } = chosen.sampling;
            efforts.push(sheets_per_slice * oversampling.powi(2));
            let fixed = RenderOptions { sheets_per_slice, oversampling, ..options.clone() };
            let fixed = render(&slices, &tf, &camera, &fixed, &()).unwrap().0;
            assert!(
                (0..fixed.rgba.len()).all(|pixel| same_pixel(&fixed, &picture, pixel)),
                "{composite:?}: {chosen:?}"
            );
        }
        assert!(reached.is_sorted() && reached[0] < reached[2], "{composite:?}: {reached:?}");
        assert!(efforts[0] < efforts[2], "{composite:?}: {efforts:?}");
    }
    off_db.sort_by(f64::total_cmp);
    assert!(off_db[off_db.len() * 8 / 10] < 2.0, "{off_db:?}");
}

/// Whether two pictures have the same colour, depth and value at a pixel.
fn same_pixel(a: &Picture, b: &Picture, pixel: usize) -> bool {
    let same = |a: &Option<Vec<f32>>, b: &Option<Vec<f32>>| match (a, b) {
        (Some(a), Some(b)) => a[pixel].to_bits() == b[pixel].to_bits(),
        (a, b) => a.is_none() && b.is_none(),
    };
    a.rgba[pixel] == b.rgba[pixel] && same(&a.depth, &b.depth) && same(&a.value, &b.value)
}

#[test]
fn what_cannot_be_reached_is_told_and_nothing_costs_nothing() {
    let phantom = Phantom::ripples(12);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let (options, camera) = (options(Composite::Over), camera(&phantom, ORTHOGRAPHIC));
    let draw = |tf: &TransferFunction| {
        render_to_psnr(
            &layer(&slices, tf, &options, &VisibilityCache::default()),
            &camera,
            &options,
            (&ladder(), &wanted(80.0)),
            &draw_base_planes,
            &(),
        )
        .unwrap()
        .2
    };
    assert!(draw(&hard()).psnr_db < 80.0);
    let invisible = draw(&opacity_ramp(&[(0.0, 0.0), (255.0, 0.0)], None));
    assert!(invisible.psnr_db > 80.0 && invisible.spread_db == 0.0 && invisible.measured.is_none());
    for psnr_db in [5.0, 100.0, f64::NAN] {
        let refused = render_to_psnr(
            &layer(&slices, &soft(), &options, &VisibilityCache::default()),
            &camera,
            &options,
            (&ladder(), &wanted(psnr_db)),
            &draw_base_planes,
            &(),
        );
        assert!(matches!(refused, Err(Error::OutOfRange { .. })));
    }
}

#[test]
fn pictures_like_one_that_was_measured_are_drawn_without_pilot_tiles_and_promise_less() {
    let phantom = Phantom::ripples(32);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let options = options(Composite::Over);
    for (tf, all_wanted) in [(soft(), [38.0, 44.0]), (hard(), [28.0, 33.0])] {
        let draw = |camera: &Camera, psnr_db: f64, like: Option<Measured>| {
            let wanted = PsnrTarget { psnr_db, like };
            let (picture, _, told) = render_to_psnr(
                &layer(&slices, &tf, &options, &VisibilityCache::default()),
                camera,
                &options,
                (&ladder(), &wanted),
                &draw_base_planes,
                &(),
            )
            .unwrap();
            (picture, told)
        };
        let first = draw(&camera(&phantom, ORTHOGRAPHIC), all_wanted[0], None).1;
        assert!(first.measured.is_some());
        let mut better_db = Vec::new();
        for (towards, projection) in [
            (DVec3::new(0.8, 0.5, 0.4), ORTHOGRAPHIC),
            (DVec3::new(0.3, 0.9, 0.3), ORTHOGRAPHIC),
            (DVec3::new(0.1, 0.2, 0.9), ORTHOGRAPHIC),
            (DVec3::new(0.8, 0.5, 0.4), PERSPECTIVE),
            (DVec3::new(0.2, 0.3, 0.9), PERSPECTIVE),
        ] {
            let camera = camera_towards(phantom.centre(), towards, 90.0, projection);
            let fixed = |sheets_per_slice, oversampling| {
                let options = RenderOptions { sheets_per_slice, oversampling, ..options.clone() };
                render(&slices, &tf, &camera, &options, &()).unwrap().0
            };
            let finest = fixed(12.0, 6.0);
            for wanted_db in all_wanted {
                let (picture, told) = draw(&camera, wanted_db, first.measured);
                let Estimate { sampling: Sampling { sheets_per_slice, oversampling }, .. } = told;
                assert!(picture.rgba == fixed(sheets_per_slice, oversampling).rgba);
                assert_eq!(told.measured, first.measured, "what is handed on is what was measured");
                let reached = psnr_db(&picture, &finest);
                assert!(
                    told.psnr_db >= wanted_db && reached >= wanted_db - told.spread_db,
                    "{wanted_db}: {reached}, {told:?}"
                );
                better_db.push(reached - told.psnr_db);
            }
        }
        // One view can have far smaller errors than the one that was measured, but not all of them.
        better_db.sort_by(f64::total_cmp);
        assert!(better_db[0] < 10.0, "{better_db:?}");
        // The same framing adds no spread, and a turn the more the wider it is.
        let spreads = [0.0, 0.1, 0.3].map(|turn| {
            let camera = camera_towards(phantom.centre(), DVec3::new(0.7 + turn, 0.6, 0.5), 90.0, ORTHOGRAPHIC);
            draw(&camera, all_wanted[0], first.measured).1.spread_db
        });
        assert!(spreads[0] == first.spread_db && spreads.is_sorted_by(|a, b| a < b), "{spreads:?}");
        // From so near that other errors count, or with a function of another kind, the error is measured.
        let near = Projection::Orthographic { parallel_scale: 9.0 };
        let near = camera_towards(phantom.centre(), DVec3::new(0.8, 0.5, 0.4), 90.0, near);
        let anew = draw(&near, all_wanted[0], first.measured).1.measured.unwrap();
        assert!(anew.framing.pixel_in_samples < first.measured.unwrap().framing.pixel_in_samples);
        let other_kind = first.measured.map(|measured| Measured { is_smooth: !measured.is_smooth, ..measured });
        let anew = draw(&camera(&phantom, ORTHOGRAPHIC), all_wanted[0], other_kind).1;
        assert_eq!(anew, first);
        for damaged in [f64::NAN, f64::INFINITY] {
            let errors = [Some(RungError { mean_square: damaged, deviation: 0.1 }); LADDER.len() - 1];
            let damaged = first.measured.map(|measured| Measured { errors, ..measured });
            assert_eq!(draw(&camera(&phantom, ORTHOGRAPHIC), all_wanted[0], damaged).1, first);
        }
    }
}

#[test]
fn two_slices_and_volumes_that_are_seen_edge_on_are_drawn() {
    for size in [[2, 9, 9], [9, 2, 9], [9, 9, 2]] {
        let phantom = Phantom::sample(size, glam::DAffine3::IDENTITY, |p| 20.0 * p.length());
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let camera = camera_towards(phantom.centre(), DVec3::X, 90.0, ORTHOGRAPHIC);
        let options = options(Composite::Over);
        let (picture, _, chosen) = render_to_psnr(
            &layer(&slices, &soft(), &options, &VisibilityCache::default()),
            &camera,
            &options,
            (&ladder(), &wanted(40.0)),
            &draw_base_planes,
            &(),
        )
        .unwrap();
        let finest = RenderOptions { sheets_per_slice: 12.0, oversampling: 6.0, ..options };
        let finest = render(&slices, &soft(), &camera, &finest, &()).unwrap().0;
        assert!(psnr_db(&picture, &finest) > 38.0, "{size:?}: {chosen:?}");
    }
}

#[test]
fn what_a_picture_hardly_shows_is_drawn_too() {
    let phantom = Phantom::ripples(12);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    for projection in [ORTHOGRAPHIC, PERSPECTIVE] {
        for aside in 0..120 {
            let towards = DVec3::new(0.3, 0.2, 1.0);
            let aside = DVec3::new(0.25 * f64::from(aside), 0.2 * f64::from(aside), 0.0);
            let camera = camera_towards(phantom.centre() + aside, towards, 60.0, projection);
            for [width_px, height_px] in [[40, 30], [1, 1], [300, 2]] {
                let options = RenderOptions { width_px, height_px, ..options(Composite::Over) };
                let drawn = render_to_psnr(
                    &layer(&slices, &soft(), &options, &VisibilityCache::default()),
                    &camera,
                    &options,
                    (&ladder(), &wanted(40.0)),
                    &draw_base_planes,
                    &(),
                );
                let (picture, _, chosen) = drawn.unwrap();
                assert!(picture.rgba.as_flattened().iter().all(|number| number.is_finite()), "{chosen:?}");
                assert!(chosen.psnr_db.is_finite(), "{chosen:?}");
            }
        }
    }
}

/// Records the progress reports, and stops at a fraction.
struct Listener {
    told: Mutex<Vec<f32>>,
    until: f32,
}

impl ProgressCallback for Listener {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.told.lock().unwrap().push(fraction);
        if fraction < self.until { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

#[test]
fn progress_grows_to_one_and_stops_where_it_is_told_to() {
    let phantom = Phantom::ripples(16);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let options = RenderOptions { n_threads: Some(1), ..options(Composite::Over) };
    let camera = camera(&phantom, ORTHOGRAPHIC);
    for (until, is_drawn) in [(2.0, true), (0.1, false), (0.45, false), (0.6, false), (1.0, false)] {
        let listener = Listener { told: Mutex::new(Vec::new()), until };
        let drawn = render_to_psnr(
            &layer(&slices, &hard(), &options, &VisibilityCache::default()),
            &camera,
            &options,
            (&ladder(), &wanted(60.0)),
            &draw_base_planes,
            &listener,
        );
        let told = listener.told.into_inner().unwrap();
        assert!(told.is_sorted() && told.len() > 3, "{told:?}");
        if is_drawn {
            assert!(drawn.is_ok() && told.last() == Some(&1.0));
        } else {
            assert!(matches!(drawn, Err(Error::Cancelled)) && *told.last().unwrap() >= until);
        }
    }
}
