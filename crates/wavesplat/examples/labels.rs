//! A segmentation beside the scan: two ventricles in colours of their own, the rest of the head as haze.

mod common;

use std::sync::Arc;

use wavesplat::{Codes, FrameOptions, Kernel, LabelLook, Labels, Samples, Scene, Volume};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = common::head();
    let volume = Volume::new("head", Samples::U8(&samples), [common::N; 3], common::world_from_index())?;
    // Label 1: fluid on the left of the middle; label 2: on the right.
    let code = |(i, sample): (usize, &u8)| {
        let (x, y) = (i % common::N, i / common::N % common::N);
        let is_ventricle = *sample < 12 && (20..76).contains(&x) && (20..76).contains(&y);
        if is_ventricle { 1 + u8::from(x >= common::N / 2) } else { 0 }
    };
    let codes: Vec<u8> = samples.iter().enumerate().map(code).collect();
    let organ = |rgb| LabelLook { rgb, opacity: 0.8, scan: 0.0, tint: 0.0 };
    let looks = vec![LabelLook::NONE, organ([0.2, 0.6, 1.0]), organ([1.0, 0.5, 0.1])];
    let labels = Labels::new(Codes::U8(Arc::from(codes)), looks, volume.grid(), Kernel::Gaussian, 64 << 20)?;

    let haze = common::look(&[(30.0, 0.0), (255.0, 0.05)], &[(30.0, [0.8; 3]), (255.0, [1.0; 3])])?;
    let mut scene = Scene::new(volume, haze);
    scene.labels = Some(Arc::new(labels));
    scene.background = Some([0.0, 0.0, 0.0, 1.0]);
    let frame = scene.render(&common::camera()?, [512, 512], &FrameOptions::default())?;
    common::save(&frame, "labels.png")?;
    Ok(())
}
