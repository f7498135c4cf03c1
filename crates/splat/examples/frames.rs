//! Draws a few frames of a phantom on one thread: what `make instructions` counts.
//!
//! Usage: frames soft|hard N

use glam::DVec3;
use wavesplat_core::{Kernel, Projection, RenderOptions};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let hard = arguments.next().as_deref() == Some("hard");
    let n: usize = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(1);
    let phantom = Phantom::ripples(48);
    let volume = phantom.volume();
    let soft: &[(f64, f64)] = &[(60.0, 0.0), (128.0, 0.05), (255.0, 0.2)];
    let tf = opacity_ramp(if hard { &[(127.0, 0.0), (128.0, 1.0)] } else { soft }, None);
    let slices = Slices::new(&volume, Kernel::Linear);
    let projection = Projection::Orthographic { parallel_scale: 30.0 };
    let camera = camera_towards(phantom.centre(), DVec3::new(0.3, 0.5, 0.8), 100.0, projection);
    let options = RenderOptions { width_px: 192, height_px: 192, n_threads: Some(1), ..RenderOptions::default() };
    let mut n_texels = 0;
    for _ in 0..n {
        let (_, report) = render(&slices, &tf, &camera, &options, &()).expect("a valid scene");
        n_texels = report.n_texels;
    }
    println!("{n_texels}");
}
