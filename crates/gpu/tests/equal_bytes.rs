//! However a frame is cut, its bytes are the same: whole and in pages, in one range of slabs and in many, with empty
//! space skipped and not, and when drawn again.

mod scenes;

use glam::DVec3;
use scenes::{Case, Stored, difference, gpu, open};
use wavesplat_core::{Composite, Kernel, Picture, Shading};
use wavesplat_gpu::{DEFAULT_BUDGET_BYTES, Schedule};
use wavesplat_splat::render::frame::slices_of;
use wavesplat_testkit::by_day;

fn cases() -> Vec<Case> {
    let hard = vec![(120.0, 0.0), (122.0, 0.95)];
    let soft = Case::default();
    vec![
        soft.clone(),
        Case { name: "hard", opacity: hard.clone(), ..soft.clone() },
        Case {
            name: "hard cubic u16",
            opacity: hard.clone(),
            stored: Stored::U16,
            kernel: Kernel::Bspline3,
            ..soft.clone()
        },
        Case { name: "holes", stored: Stored::F32WithHoles, ..soft.clone() },
        Case { name: "perspective", eye: Some(45.0), from: DVec3::ONE, ..soft.clone() },
        Case { name: "first hit", composite: Composite::FirstHit { iso_value: 90.0 }, ..soft.clone() },
        Case { name: "mean", composite: Composite::Mean, ..soft.clone() },
        Case { name: "local maximum", composite: Composite::LocalMaximum { threshold: 100.0 }, ..soft.clone() },
        Case { name: "two layers", n_layers: 2, shading: Some(Shading::headlight()), ..soft.clone() },
        Case { name: "two layers, labels, hard", n_layers: 2, has_labels: true, opacity: hard, ..soft },
    ]
}

fn is_same(got: &Picture, want: &Picture) -> bool {
    let bits = |picture: &Picture| -> Vec<u32> { picture.rgba.as_flattened().iter().map(|x| x.to_bits()).collect() };
    let covered = want.rgba.iter().filter(|rgba| rgba[3] > 0.0).count();
    covered > 100 && bits(got) == bits(want)
}

#[test]
fn cuts_change_nothing() {
    let Some(gpu) = gpu() else { return };
    for (number, case) in cases().into_iter().enumerate() {
        let want = case.draw(Some(gpu)).picture;
        let mut schedules = [
            ("again", Schedule::default()),
            ("in single slabs", Schedule { most_slabs: Some(1), ..Schedule::default() }),
            ("in ranges of 7", Schedule { most_slabs: Some(7), ..Schedule::default() }),
            ("without skipping", Schedule { skips: false, ..Schedule::default() }),
            ("counted", Schedule { counts: true, most_slabs: Some(50), ..Schedule::default() }),
            ("in pages", Schedule { is_paged: true, ..Schedule::default() }),
            ("in pages and ranges", Schedule { is_paged: true, most_slabs: Some(5), ..Schedule::default() }),
        ];
        // By day four of them, others for each case.
        let n_schedules = schedules.len();
        schedules.rotate_left(number % n_schedules);
        for (name, schedule) in by_day(schedules, 2) {
            let drawn = case.draw_by(gpu, schedule);
            let told = difference(&drawn.picture, &want);
            assert!(is_same(&drawn.picture, &want), "{} {name}: {told:?}", case.name);
            let report = drawn.report.unwrap();
            assert_eq!(report.is_paged, schedule.is_paged);
            if let Some([n_fetches, n_texels]) = report.counted {
                assert!(n_texels > 1000 && n_fetches >= 2 * n_texels && n_texels <= 2 * report.n_texels, "{report:?}");
            }
            assert_eq!(report.counted.is_some(), schedule.counts);
            assert!(schedule.most_slabs.is_none_or(|n| report.n_dispatches > 100 / n as u64 / 5), "{report:?}");
        }
    }
}

/// Volumes beyond the budget are drawn in pages that come and go as the rays pass.
#[test]
fn volumes_beyond_the_memory_are_drawn_without_seams() {
    let Some(gpu) = gpu() else { return };
    let large = Case { size: [150, 140, 133], ..Case::default() };
    let page = 70 * 70 * 70;
    for case in [
        Case { name: "soft", ..large.clone() },
        Case { name: "hard", opacity: vec![(120.0, 0.0), (122.0, 0.95)], ..large.clone() },
        Case { name: "perspective u16", stored: Stored::U16, eye: Some(160.0), from: DVec3::ONE, ..large.clone() },
        Case { name: "maximum", composite: Composite::Maximum, ..large.clone() },
    ] {
        let want = case.draw(Some(gpu));
        let n_bytes = if case.stored == Stored::U16 { 2 } else { 1 };
        let Some(small) = open(n_bytes * (9 * page + 1000)) else { return };
        let got = case.draw(Some(&small));
        let (got_report, want_report) = (got.report.unwrap(), want.report.unwrap());
        let told = difference(&got.picture, &want.picture);
        assert!(is_same(&got.picture, &want.picture), "{}: {told:?}", case.name);
        assert!(got_report.is_paged && !want_report.is_paged);
        assert!(got_report.n_sample_bytes <= small.budget_bytes() as u64, "{got_report:?}");
        assert!(got_report.n_page_bytes > 9 * page as u64, "pages came and went: {got_report:?}");
    }
}

/// Only pages that show something are uploaded.
#[test]
fn pages_that_show_nothing_are_left_out() {
    let Some(gpu) = open(DEFAULT_BUDGET_BYTES) else { return };
    let case = Case { size: [190, 180, 170], opacity: vec![(235.0, 0.0), (240.0, 0.9)], ..Case::default() };
    let schedule = Schedule { is_paged: true, ..Schedule::default() };
    case.with_plan(&mut |plan, layers| {
        let draw = || gpu.draw_base_planes_by(schedule, plan, &slices_of(layers), &()).unwrap().1.n_page_bytes;
        let (first, all) = (draw(), 3 * 3 * 3 * 70 * 70 * 70);
        assert!(first > 0 && first < all / 2, "{first} of {all}");
        assert_eq!(draw(), 0, "they stay for the next frame");
    });
}

/// A base plane of more texels than are drawn at once is drawn in several bands.
#[test]
fn large_pictures_are_drawn_band_by_band() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case { size: [5, 5, 4], from: DVec3::Z, shading: None, ..Case::default() };
    (case.options.width_px, case.options.height_px) = (800, 700);
    (case.options.sheets_per_slice, case.options.oversampling) = (1.0, 2.7);
    let (got, want) = (case.draw(Some(gpu)), case.draw(None));
    let told = difference(&got.picture, &want.picture);
    let report = got.report.unwrap();
    assert!(told.within_one >= 1.0 && told.coverage > 0.01, "{told:?}");
    assert!(report.n_bytes_moved > 16 << 20, "more than a band of 1 M texels was read back: {report:?}");
}
