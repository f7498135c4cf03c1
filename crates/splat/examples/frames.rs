//! Draws a few frames on one thread: what `make instructions` counts.
//!
//! Usage: `frames soft|hard headlight|default N [RAW NX NY NZ SX SY SZ LO HI]`. Of a phantom at 192 x 192, or of a file
//! of 8-bit samples at 512 x 512, as `benches/scenes.py` draws it: samples along x, y, z, their spacing, and the values
//! between which opacity rises. Prints the number of texels of a frame and a hash of its pixels.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::process::exit;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{Kernel, Projection, RenderOptions, Samples, Shading, Volume};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (is_hard, is_default, n, file) = match words[..] {
        [curve @ ("soft" | "hard"), light @ ("headlight" | "default"), n, ref file @ ..]
            if matches!(file.len(), 0 | 9) =>
        {
            (curve == "hard", light == "default", n.parse().unwrap_or(1), file)
        }
        _ => {
            eprintln!("usage: frames soft|hard headlight|default N [RAW NX NY NZ SX SY SZ LO HI]");
            exit(2);
        }
    };
    let numbers: Vec<f64> = file.iter().skip(1).map(|x| x.parse().expect("numbers after the file's name")).collect();
    let phantom;
    let bytes;
    let (volume, half_height, from, ramp, unit, size_px) = if let &[nx, ny, nz, sx, sy, sz, lo, hi] = &numbers[..] {
        bytes = std::fs::read(file[0]).expect("a file of samples");
        let spacing = DVec3::new(sx, sy, sz);
        let size = [nx, ny, nz].map(|n| n as usize);
        let affine = DAffine3::from_mat3(DMat3::from_diagonal(spacing));
        let volume = Volume::new("file", Samples::U8(&bytes), size, affine).expect("samples of that size");
        let extent = volume.grid().last_index() * spacing;
        let (az, el) = (45_f64.to_radians(), 35_f64.to_radians());
        let from = DVec3::new(az.sin() * el.cos(), -az.cos() * el.cos(), el.sin());
        (volume, 0.62 * extent.max_element(), from, [lo, hi], Some(spacing.min_element()), 512)
    } else {
        phantom = Phantom::ripples(48);
        (phantom.volume(), 30.0, DVec3::new(0.3, 0.5, 0.8), [60.0, 128.0], None, 192)
    };
    let [lo, hi] = ramp;
    let soft = [(lo, 0.0), (hi, 0.05), (255.0, 0.2)];
    let hard = [(hi - 1.0, 0.0), (hi, 1.0)];
    let tf = opacity_ramp(if is_hard { &hard } else { &soft }, unit);
    let slices = Slices::new(&volume, Kernel::Linear);
    let centre = volume.grid().world_from_index().transform_point3(volume.grid().last_index() / 2.0);
    let camera =
        camera_towards(centre, from, 10.0 * half_height, Projection::Orthographic { parallel_scale: half_height });
    let shading = if is_default { Shading::default() } else { Shading::headlight() };
    let options = RenderOptions {
        width_px: size_px,
        height_px: size_px,
        n_threads: Some(1),
        shading: Some(shading),
        ..RenderOptions::default()
    };
    let mut last = None;
    for _ in 0..n {
        last = Some(render(&slices, &tf, &camera, &options, &()).expect("a valid scene"));
    }
    if let Some((picture, report)) = last {
        let mut hash = DefaultHasher::new();
        picture.rgba.as_flattened().iter().for_each(|x| x.to_bits().hash(&mut hash));
        println!("{} {:016x}", report.n_texels, hash.finish());
    }
}
