//! Every failure of a GPU is reported with its reason, and never ends in a wrong picture: callers draw on the CPU then.

mod scenes;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use scenes::{Case, difference, gpu, open};
use wavesplat_gpu::{Choice, DEFAULT_BUDGET_BYTES, DeviceChoice, Failure, Gpu, Gpus, Schedule};
use wavesplat_splat::render::frame::{finish, slices_of};
use wavesplat_splat::render::progress::ProgressCallback;

/// Failure that drawing the scene ends in.
fn failure(gpu: &Gpu, case: &Case, callback: &dyn ProgressCallback) -> Failure {
    let mut told = None;
    let schedule = Schedule { most_slabs: Some(4), ..Schedule::default() };
    case.with_plan(&mut |plan, layers| {
        told = gpu.draw_base_planes_by(schedule, plan, &slices_of(layers), callback).err();
    });
    told.expect("it fails")
}

#[test]
fn no_adapter_is_told_with_those_that_there_are() {
    let choice = Choice::Named("no such GPU".to_owned());
    let Err(Failure::NoAdapter(why)) = Gpu::open(&choice, DEFAULT_BUDGET_BYTES) else { panic!("it is not there") };
    assert!(why.contains("no such GPU") && why.contains("there"), "{why}");
    // Software devices are taken by their name alone.
    if let Err(failure) = Gpu::open(&Choice::Best, DEFAULT_BUDGET_BYTES) {
        assert!(matches!(failure, Failure::NoAdapter(_)), "{failure}");
    }
}

#[test]
fn a_device_that_fails_its_self_test_is_not_used() {
    let Some(gpu) = gpu() else { return };
    let choice = Choice::Named(gpu.adapter().name.clone());
    let Err(Failure::Untrusted(why)) = Gpu::open_with(&choice, DEFAULT_BUDGET_BYTES, true) else { panic!("used") };
    assert!(why.contains("self-test"), "{why}");
}

#[test]
fn too_little_memory_is_told_in_numbers() {
    let Some(gpu) = open(1 << 20) else { return };
    // Three pages of 8-bit samples fit; a block of texels may reach eight.
    let case = Case { size: [150, 140, 133], ..Case::default() };
    let why = failure(&gpu, &case, &());
    assert!(matches!(&why, Failure::Memory(_)), "{why}");
    gpu.set_budget(1000);
    let why = failure(&gpu, &case, &()).to_string();
    assert!(why.contains("MB are allowed"), "{why}");
    // The same device draws what fits.
    gpu.set_budget(DEFAULT_BUDGET_BYTES);
    let (got, want) = (case.draw(Some(&gpu)), case.draw(None));
    assert!(difference(&got.picture, &want.picture).within_one >= 1.0);
}

/// Callback that destroys the device when a part of a frame is drawn.
struct EndsDevice<'a>(&'a Gpu, AtomicUsize);

impl ProgressCallback for EndsDevice<'_> {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        if self.1.fetch_add(1, Ordering::Relaxed) == 1 {
            self.0.destroy();
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn a_device_that_is_lost_says_so_before_in_and_after_a_frame() {
    let case = Case::default();
    let Some(gpu) = open(DEFAULT_BUDGET_BYTES) else { return };
    gpu.destroy();
    assert!(matches!(failure(&gpu, &case, &()), Failure::Lost(_)));
    let Some(gpu) = open(DEFAULT_BUDGET_BYTES) else { return };
    let why = failure(&gpu, &case, &EndsDevice(&gpu, AtomicUsize::new(0)));
    assert!(matches!(why, Failure::Lost(_)), "{why}");
    let Some(gpu) = open(DEFAULT_BUDGET_BYTES) else { return };
    let drawn = case.draw(Some(&gpu));
    gpu.destroy();
    assert!(difference(&drawn.picture, &case.draw(None).picture).within_one >= 1.0);
    assert!(matches!(failure(&gpu, &case, &()), Failure::Lost(_)));
}

#[test]
fn a_lost_device_is_opened_once_more() {
    static GPUS: std::sync::LazyLock<Gpus> = std::sync::LazyLock::new(Gpus::default);
    let Some(gpu) = gpu() else { return };
    let choice = Choice::Named(gpu.adapter().name.clone());
    GPUS.open(&choice).unwrap().destroy();
    let case = Case::default();
    case.with_plan(&mut |plan, layers| {
        let device = DeviceChoice::Gpu(choice.clone());
        let drawn = GPUS.draw_base_planes(&device, plan, &slices_of(layers), &()).unwrap();
        assert!(drawn.reopened.is_some());
        let picture = finish(plan, &drawn.pictures);
        assert!(difference(&picture, &case.draw(None).picture).within_one >= 1.0);
        let drawn = GPUS.draw_base_planes(&device, plan, &slices_of(layers), &()).unwrap();
        assert!(drawn.reopened.is_none());
    });
}

/// Callback that draws another frame at every call.
struct DrawsAnother<'a>(&'a Gpu);

impl ProgressCallback for DrawsAnother<'_> {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        let why = failure(self.0, &Case { size: [4, 4, 4], ..Case::default() }, &());
        assert!(matches!(why, Failure::DrawnByCpu(_)), "{why}");
        ControlFlow::Continue(())
    }
}

#[test]
fn a_frame_within_a_frame_waits_for_nobody() {
    let Some(gpu) = gpu() else { return };
    let case = Case::default();
    case.with_plan(&mut |plan, layers| {
        let (pictures, _) = gpu.draw_base_planes(plan, &slices_of(layers), &DrawsAnother(gpu)).unwrap();
        assert!(difference(&finish(plan, &pictures), &case.draw(None).picture).within_one >= 1.0);
    });
}

/// Callback that stops the frame at the second call.
struct Stops(AtomicBool);

impl ProgressCallback for Stops {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        if self.0.swap(true, Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn frames_are_cancelled_between_dispatches() {
    let Some(gpu) = gpu() else { return };
    let why = failure(gpu, &Case::default(), &Stops(AtomicBool::new(false)));
    assert_eq!(why, Failure::Cancelled);
    // The next frame is a whole one.
    let case = Case::default();
    assert!(difference(&case.draw(Some(gpu)).picture, &case.draw(None).picture).within_one >= 1.0);
}
