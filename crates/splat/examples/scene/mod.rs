//! Scenes of the examples that benches run: a phantom at 192 x 192, or a file of 8-bit samples at 512 x 512, as
//! `benches/scenes.py` draws it. Arguments: `soft|hard headlight|default N [RAW NX NY NZ SX SY SZ LO HI]`: number of
//! frames, samples along x, y, z, their spacing, and the values between which opacity rises.

use std::process::exit;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{Camera, Kernel, Projection, RenderOptions, Samples, Shading, TransferFunction, Volume};
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

/// A volume with its look and view, and how often it is drawn.
pub struct Scene<'a> {
    pub slices: Slices<'a>,
    pub tf: TransferFunction,
    pub camera: Camera,
    pub options: RenderOptions,
    pub n_frames: usize,
}

/// Calls `work` with the scene that the arguments of the process name.
pub fn with_scene(program: &str, work: impl FnOnce(&Scene)) {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (is_hard, is_default, n_frames, file) = match words[..] {
        [curve @ ("soft" | "hard"), light @ ("headlight" | "default"), n, ref file @ ..]
            if matches!(file.len(), 0 | 9) =>
        {
            (curve == "hard", light == "default", n.parse().unwrap_or(1), file)
        }
        _ => {
            eprintln!("usage: {program} soft|hard headlight|default N [RAW NX NY NZ SX SY SZ LO HI]");
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
    work(&Scene { slices, tf, camera, options, n_frames });
}
