//! A head with a translucent skull and shaded structures inside.

mod common;

use wavesplat::{FrameOptions, Samples, Scene, Shading, Volume};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = common::head();
    let volume = Volume::new("head", Samples::U8(&samples), [common::N; 3], common::world_from_index())?;
    let look = common::look(
        &[(30.0, 0.0), (50.0, 0.06), (60.0, 0.0), (70.0, 0.0), (76.0, 0.5), (110.0, 0.5), (130.0, 0.02), (255.0, 0.04)],
        &[(30.0, [0.6, 0.7, 0.9]), (76.0, [0.9, 0.4, 0.3]), (130.0, [1.0, 0.95, 0.85])],
    )?;
    let mut scene = Scene::new(volume, look);
    scene.layers[0].shading = Some(Shading { ambient_occlusion: 0.4, ..Shading::default() });
    scene.background = Some([0.0, 0.0, 0.0, 1.0]);
    let frame = scene.render(&common::camera()?, [512, 512], &FrameOptions::default())?;
    common::save(&frame, "head.png")?;
    Ok(())
}
