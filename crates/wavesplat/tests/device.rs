//! After any failure of a GPU the picture is right, and the frame says which device drew it and why.
#![cfg(feature = "gpu")]

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DAffine3, DVec3};
use wavesplat::gpu::{Choice, DEFAULT_BUDGET_BYTES, Gpu, Gpus, adapters};
use wavesplat::{Camera, Device, Frame, FrameOptions, ProgressCallback, Projection, Scene};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

/// Name of the software device, or of the one that is asked for; `None` where there is none.
fn name() -> Option<String> {
    let asked = std::env::var("WAVESPLAT_TEST_GPU").ok();
    let part = asked.clone().unwrap_or_else(|| "llvmpipe".to_owned());
    let is_there = adapters().iter().any(|adapter| adapter.name.to_lowercase().contains(&part.to_lowercase()));
    assert!(is_there || asked.is_none(), "there is no {part}");
    if !is_there {
        eprintln!("skipped: install mesa-vulkan-drivers");
    }
    is_there.then_some(part)
}

fn camera(phantom: &Phantom) -> Camera {
    camera_towards(
        phantom.centre(),
        DVec3::new(0.5, -0.8, 0.4),
        90.0,
        Projection::Orthographic { parallel_scale: 16.0 },
    )
}

/// Whether both pictures show something, and the same.
fn is_right(frame: &Frame, by_cpu: &Frame) -> bool {
    let pairs = frame.picture.rgba.as_flattened().iter().zip(by_cpu.picture.rgba.as_flattened());
    let seen = by_cpu.picture.rgba.iter().filter(|rgba| rgba[3] > 0.1).count();
    seen > 200 && pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) <= 1.0 / 255.0
}

/// Callback that destroys the device at the second call.
struct EndsDevice(Arc<Gpu>, AtomicUsize);

impl ProgressCallback for EndsDevice {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        if self.1.fetch_add(1, Ordering::Relaxed) == 1 {
            self.0.destroy();
        }
        ControlFlow::Continue(())
    }
}

/// A single test, since the GPUs of a process are shared.
#[test]
fn every_failure_ends_in_a_right_picture_and_a_reason() {
    let Some(part) = name() else { return };
    let phantom = Phantom::ripples(40);
    let scene = Scene::new(phantom.volume(), opacity_ramp(&[(60.0, 0.0), (220.0, 0.3)], None));
    let camera = camera(&phantom);
    let draw = |device: Device, callback: &dyn ProgressCallback| {
        let options = FrameOptions { device, ..FrameOptions::default() };
        scene.render_with_progress(&camera, [90, 80], &options, callback).unwrap()
    };
    let by_cpu = draw(Device::Cpu, &());
    assert_eq!((by_cpu.drawn_by.name.as_str(), &by_cpu.drawn_by.reason), ("cpu", &None));
    let (gpus, choice) = (Gpus::of_process(), Choice::Named(part.clone()));
    let named = || Device::Named(part.clone());

    // All is well.
    let frame = draw(named(), &());
    assert!(is_right(&frame, &by_cpu) && frame.drawn_by.gpu.is_some() && frame.drawn_by.reason.is_none());

    // No adapter.
    let frame = draw(Device::Named("no such GPU".to_owned()), &());
    assert!(is_right(&frame, &by_cpu) && frame.drawn_by.name == "cpu");
    assert!(frame.drawn_by.reason.unwrap().contains("no such GPU"));

    // Lost before a frame, and after one: opened once more.
    for _ in 0..2 {
        gpus.open(&choice).unwrap().destroy();
        let frame = draw(named(), &());
        assert!(is_right(&frame, &by_cpu) && frame.drawn_by.gpu.is_some());
        assert!(frame.drawn_by.reason.unwrap().contains("lost"));
    }

    // Lost in a frame.
    let frame = draw(named(), &EndsDevice(gpus.open(&choice).unwrap(), AtomicUsize::new(0)));
    assert!(is_right(&frame, &by_cpu) && frame.drawn_by.reason.is_some_and(|why| why.contains("lost")));

    // Little memory, and none: pages, or the CPU.
    for budget_bytes in [1 << 20, 1000] {
        gpus.set_budget(budget_bytes);
        let frame = draw(named(), &());
        assert!(is_right(&frame, &by_cpu));
        let why = frame.drawn_by.reason.unwrap_or_default();
        assert!(frame.drawn_by.gpu.is_some() || why.contains("allowed"), "{why}");
    }
    gpus.set_budget(DEFAULT_BUDGET_BYTES);

    // A self-test that fails.
    gpus.forget(&choice);
    gpus.set_self_test_fails(true);
    let frame = draw(named(), &());
    assert!(is_right(&frame, &by_cpu) && frame.drawn_by.reason.unwrap().contains("self-test"));
    gpus.set_self_test_fails(false);
    gpus.forget(&choice);
    assert!(draw(named(), &()).drawn_by.gpu.is_some());
}

#[test]
fn where_nothing_is_in_view_the_frame_is_empty_and_says_why() {
    let Some(part) = name() else { return };
    let phantom = Phantom::fog([4; 3], DAffine3::IDENTITY, 100.0);
    let scene = Scene::new(phantom.volume(), opacity_ramp(&[(0.0, 0.0), (255.0, 0.3)], None));
    let away = camera_towards(DVec3::splat(900.0), DVec3::X, 50.0, Projection::Orthographic { parallel_scale: 3.0 });
    let options = FrameOptions { device: Device::Named(part), ..FrameOptions::default() };
    let frame = scene.render(&away, [20, 20], &options).unwrap();
    assert!(frame.picture.rgba.iter().all(|rgba| rgba[3] == 0.0));
}
