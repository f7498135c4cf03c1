//! Levels of detail: the head as wavelet coefficients, complete, and without the details of one and of two levels.

mod common;

use std::sync::Arc;

use wavesplat::{
    FrameOptions, Keep, LevelVolume, Norm, Samples, Scene, SceneLayer, SceneVolume, WaveletFamily, WaveletVolume,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = Samples::U8(&common::head()).to_f32();
    let size = [common::N; 3];
    let family = WaveletFamily::from_name("cdf97").ok_or("no such wavelets")?;
    let coefficients = Arc::new(WaveletVolume::new(family, size, samples, None, Norm::L2, Keep::Psnr(45.0))?);
    println!(
        "{} of {} coefficients in {} bytes",
        coefficients.n_kept(),
        size.iter().product::<usize>(),
        coefficients.n_bytes()
    );
    let look = common::look(
        &[(30.0, 0.0), (60.0, 0.1), (130.0, 0.1), (255.0, 0.6)],
        &[(30.0, [0.9, 0.5, 0.4]), (130.0, [1.0, 0.95, 0.85])],
    )?;
    let weights = vec![1.0; coefficients.plan().n_levels() + 1];
    for level in 0..3 {
        let opened = LevelVolume::open(&coefficients, level, &weights, common::world_from_index(), "head", 256 << 20)?;
        let volume = SceneVolume::Level(Arc::new(opened));
        let scene = Scene::of(vec![SceneLayer::new(volume, look.clone())]);
        let frame = scene.render(&common::camera()?, [512, 512], &FrameOptions::default())?;
        common::save(&frame, &format!("level_{level}.png"))?;
    }
    Ok(())
}
