//! A volume in a NIfTI or NRRD file: `cargo run --release -p wavesplat --example first -- FILE OUT.png`.
//!
//! The picture is that of `wavesplat render FILE -o OUT.png`; a third argument is a preset, such as `ct-bone`.

use std::path::Path;

use wavesplat::look::Look;
use wavesplat::{AutoLook, Camera, FrameOptions, PlacedCamera, PngBits, Scene, cut_open, encode_png, files};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, picture, rest @ ..] = &arguments[..] else { return Err("give a file and the PNG file to write".into()) };
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let other = |name: &str| std::fs::read(folder.join(name)).map_err(|error| error.to_string());
    let scan = files::read(file, &std::fs::read(file)?, other)?;
    let look = match rest {
        [preset, ..] => Look::preset(preset)?,
        [] => Look::auto(&scan.volume()?, &scan.facts)?,
    };
    let shown = if look.is_cut_open { cut_open(&scan.volume()?, &scan.facts, look.view)? } else { scan };
    let mut scene = Scene::with_look(shown.volume()?, &look);
    scene.background.get_or_insert([0.0, 0.0, 0.0, 1.0]);
    let camera = Camera::fit_for(&scene, &shown.facts, &look, 1.0)?;
    let options = FrameOptions { composite: look.composite, ..FrameOptions::default() };
    let frame = scene.render(&camera, [512, 512], &options)?;
    std::fs::write(picture, encode_png(&frame.picture, PngBits::Eight)?)?;
    Ok(())
}
