//! Missing samples: their effect on a picture is known from paper, for every kernel, number of sheets and operator.

use glam::{DAffine3, DVec3};
use wavesplat_core::{Composite, Kernel, Picture, Projection, RenderOptions, TransferFunction};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

const SIZE: [usize; 3] = [13, 12, 14];
const PARALLEL_SCALE: f64 = 8.0;
const HEIGHT_PX: usize = 96;
const DIRECTION: DVec3 = DVec3::new(0.35, 0.2, 1.0);

/// Even matter of which some samples are missing.
fn with_missing(value: f64, is_missing: impl Fn(usize) -> bool) -> Phantom {
    let mut phantom = Phantom::fog(SIZE, DAffine3::IDENTITY, value);
    for (i, sample) in phantom.samples.iter_mut().enumerate().filter(|(i, _)| is_missing(*i)) {
        *sample = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][i % 3];
    }
    phantom
}

fn one_missing(value: f64) -> Phantom {
    with_missing(value, |i| i == 6 + 13 * (5 + 12 * 7))
}

fn options(composite: Composite, sheets_per_slice: f64) -> RenderOptions {
    let height_px = HEIGHT_PX;
    RenderOptions { width_px: HEIGHT_PX, height_px, composite, sheets_per_slice, ..RenderOptions::default() }
}

fn draw(phantom: &Phantom, kernel: Kernel, tf: &TransferFunction, options: &RenderOptions) -> Picture {
    let camera =
        camera_towards(phantom.centre(), DIRECTION, 60.0, Projection::Orthographic { parallel_scale: PARALLEL_SCALE });
    render(&Slices::new(&phantom.volume(), kernel), tf, &camera, options, &()).unwrap().0
}

/// World area of a pixel.
fn pixel_area() -> f64 {
    (2.0 * PARALLEL_SCALE / HEIGHT_PX as f64).powi(2)
}

/// Faint matter, steep or not, so that pictures are integrals of the extinction: a lone missing sample takes one cell.
#[test]
fn a_missing_sample_takes_one_cell_of_faint_matter() {
    let faint = 1e-3;
    let soft = opacity_ramp(&[(0.0, 0.0), (200.0, 2.0 * faint)], Some(1.0));
    // Rises to its height within a hundredth of the range: pre-integrated.
    let steep = opacity_ramp(&[(0.0, 0.0), (90.0, 0.0), (91.0, faint), (200.0, faint)], Some(1.0));
    let per_length = -(-faint).ln_1p();
    for (_, kernel) in Kernel::NAMES {
        for tf in [&soft, &steep] {
            for sheets_per_slice in [1.0, 2.0, 3.3] {
                let options = options(Composite::Over, sheets_per_slice);
                let [whole, holed] =
                    [with_missing(100.0, |_| false), one_missing(100.0)].map(|p| draw(&p, kernel, tf, &options));
                let pairs = whole.rgba.iter().zip(&holed.rgba);
                let taken: f64 = pairs.map(|(whole, holed)| f64::from(whole[3] - holed[3])).sum();
                let cells = taken * pixel_area() / per_length;
                assert!((cells - 1.0).abs() < 0.04, "{kernel:?} {sheets_per_slice}: {cells} cells");
            }
        }
    }
}

/// The integral of a projection loses the part of rays on which half or more is missing; the mean of even matter is
/// that matter, and its largest and smallest value are.
#[test]
fn projections_leave_out_what_is_missing() {
    let tf = opacity_ramp(&[(0.0, 1.0)], None);
    let slab = with_missing(100.0, |i| i / (13 * 12) == 7);
    let camera_distance = 60.0;
    let straight = |phantom: &Phantom, kernel, composite, sheets| {
        let camera = camera_towards(
            phantom.centre(),
            DVec3::Z,
            camera_distance,
            Projection::Orthographic { parallel_scale: 4.0 },
        );
        let options = RenderOptions { width_px: 24, height_px: 24, ..options(composite, sheets) };
        render(&Slices::new(&phantom.volume(), kernel), &tf, &camera, &options, &()).unwrap().0.value.unwrap()
            [12 * 24 + 12]
    };
    for (_, kernel) in Kernel::NAMES {
        for sheets in [1.0, 2.0, 4.0] {
            let value = |composite| straight(&slab, kernel, composite, sheets);
            // Thirteen cells along the ray, less one.
            let sum = value(Composite::Sum);
            assert!((sum - 1200.0).abs() < 0.5, "{kernel:?} {sheets}: {sum}");
            for composite in [Composite::Mean, Composite::Maximum, Composite::Minimum] {
                let got = value(composite);
                assert!((got - 100.0).abs() < 0.01, "{kernel:?} {sheets} {composite:?}: {got}");
            }
        }
    }
}

/// The brightest sample is seen with missing ones on all sides of it.
#[test]
fn a_lone_known_sample_is_found_by_the_maximum() {
    let bright = 6 + 13 * (5 + 12 * 7);
    let mut phantom = with_missing(10.0, |i| [1, 13, 156].iter().any(|d| i.abs_diff(bright) == *d));
    phantom.samples[bright] = 200.0;
    let tf = opacity_ramp(&[(0.0, 1.0)], None);
    let picture = draw(&phantom, Kernel::Linear, &tf, &options(Composite::Maximum, 1.0));
    let most = picture.value.unwrap().into_iter().fold(0.0, f32::max);
    assert!((most - 200.0).abs() < 8.0, "{most}");
}
