//! Draws a few frames on one thread: what `make instructions` counts. Prints the number of texels of a frame and a hash
//! of its pixels. Arguments: see [`scene`].

mod scene;

use std::hash::{DefaultHasher, Hash, Hasher};

use wavesplat_splat::render;

fn main() {
    scene::with_scene("frames", |scene| {
        let mut last = None;
        for _ in 0..scene.n_frames {
            last = Some(render(&scene.slices, &scene.tf, &scene.camera, &scene.options, &()).expect("a valid scene"));
        }
        if let Some((picture, report)) = last {
            let mut hash = DefaultHasher::new();
            picture.rgba.as_flattened().iter().for_each(|x| x.to_bits().hash(&mut hash));
            println!("{} {:016x}", report.n_texels, hash.finish());
        }
    });
}
