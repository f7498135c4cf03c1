//! A maximum intensity projection (MIP) and a mean of the same head: one number per ray, then coloured.

mod common;

use wavesplat::{Composite, FrameOptions, Samples, Scene, Volume};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = common::head();
    let volume = Volume::new("head", Samples::U8(&samples), [common::N; 3], common::world_from_index())?;
    let greys = common::look(&[(0.0, 1.0)], &[(0.0, [0.0; 3]), (255.0, [1.0; 3])])?;
    let scene = Scene::new(volume, greys);
    for (name, composite) in [("maximum.png", Composite::Maximum), ("mean.png", Composite::Mean)] {
        let options = FrameOptions { composite, ..FrameOptions::default() };
        let frame = scene.render(&common::camera()?, [512, 512], &options)?;
        let values = frame.picture.value.as_ref().map_or(0.0, |values| values.iter().fold(0.0_f32, |a, b| a.max(*b)));
        println!("largest value of {name}: {values}");
        common::save(&frame, name)?;
    }
    Ok(())
}
