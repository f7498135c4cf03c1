//! Missing samples, by every kernel and by the literal renderers.

use glam::{DAffine3, DVec3};
use wavesplat_core::{Kernel, Projection, RenderOptions};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_study::reference::original;
use wavesplat_study::reference::raycast::{RaycastOptions, raycast};
use wavesplat_testkit::{Phantom, camera_towards, max_difference, opacity_ramp, psnr_db};

/// A twentieth of all samples is missing: even matter looks the same by all kernels, and as the reference has it.
#[test]
fn holes_are_the_same_by_every_kernel_and_in_the_reference() {
    let mut phantom = Phantom::fog([13, 12, 14], DAffine3::IDENTITY, 100.0);
    for (i, sample) in phantom.samples.iter_mut().enumerate().filter(|(i, _)| i * 7919 % 20 == 3) {
        *sample = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][i % 3];
    }
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(0.0, 0.0), (200.0, 0.5)], Some(1.0));
    let projection = Projection::Orthographic { parallel_scale: 8.0 };
    let camera = camera_towards(phantom.centre(), DVec3::new(0.35, 0.2, 1.0), 60.0, projection);
    let options = RenderOptions { width_px: 40, height_px: 40, sheets_per_slice: 1.0, ..RenderOptions::default() };
    let fine = RenderOptions { sheets_per_slice: 4.0, oversampling: 3.0, ..options.clone() };
    let draw = |kernel, options| render(&Slices::new(&volume, kernel), &tf, &camera, options, &()).unwrap().0;
    let linear = draw(Kernel::Linear, &options);
    for (_, kernel) in Kernel::NAMES {
        let got = draw(kernel, &options);
        assert!(max_difference(&got.rgba, &linear.rgba) < 1e-3, "{kernel:?}");
        let sampling = RaycastOptions { kernel, step: 0.1, rays_per_pixel: 9 };
        let want = raycast(&volume, &tf, &camera, &options, sampling, &()).unwrap();
        let db = psnr_db(&got.rgba, &want.rgba);
        assert!(db > 34.0, "{kernel:?}: {db}");
        let db = psnr_db(&draw(kernel, &fine).rgba, &want.rgba);
        assert!(db > 42.0, "{kernel:?}, four sheets a slice: {db}");
        let literal = original::image(&volume, kernel, &tf, &camera, &options, &()).unwrap();
        let db = psnr_db(&literal.rgba, &want.rgba);
        assert!(db > 28.0, "{kernel:?}, the published form: {db}");
    }
}
