//! A CT in a NIfTI or NRRD file, drawn by a preset: `cargo run --release -p wavesplat --example first -- FILE OUT.png`.
//!
//! The picture is that of `wavesplat render FILE -o OUT.png --preset ct-bone`; a third argument is another preset.

use std::path::Path;

use wavesplat::look::Look;
use wavesplat::{Camera, FrameOptions, PlacedCamera, PngBits, Scene, encode_png, files};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, picture, rest @ ..] = &arguments[..] else { return Err("give a file and the PNG file to write".into()) };
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let other = |name: &str| std::fs::read(folder.join(name)).map_err(|error| error.to_string());
    let scan = files::read(file, &std::fs::read(file)?, other)?;
    let look = Look::preset(rest.first().map_or("ct-bone", String::as_str))?;
    let mut scene = Scene::with_look(scan.volume()?, &look);
    scene.background.get_or_insert([0.0, 0.0, 0.0, 1.0]);
    let camera = Camera::fit(&scene, &scan.facts, 1.0)?;
    let options = FrameOptions { composite: look.composite, ..FrameOptions::default() };
    let frame = scene.render(&camera, [512, 512], &options)?;
    std::fs::write(picture, encode_png(&frame.picture, PngBits::Eight)?)?;
    Ok(())
}
