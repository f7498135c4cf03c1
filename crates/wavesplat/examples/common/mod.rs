//! Helpers of the examples: a head phantom made from a formula, a camera, a look, and saving of pictures.

use std::path::PathBuf;

use glam::{DAffine3, DVec3};
use wavesplat::view::{Fit, InView, box_corners};
use wavesplat::{Camera, ColorNode, Frame, OpacityNode, PngBits, TransferFunction, encode_png};

/// Samples along each axis.
pub const N: usize = 96;

/// Samples of the head phantom of Shepp and Logan in three dimensions (Kak and Slaney 1988, with the contrast of Toft
/// 1996), 0..255, x fastest.
#[allow(dead_code, reason = "one example reads another volume from a file")]
pub fn head() -> Vec<u8> {
    // Additive value, semi-axes, centre, rotation about z in degrees.
    const ELLIPSOIDS: [(f64, [f64; 3], [f64; 3], f64); 10] = [
        (1.0, [0.69, 0.92, 0.81], [0.0, 0.0, 0.0], 0.0),
        (-0.8, [0.6624, 0.874, 0.78], [0.0, -0.0184, 0.0], 0.0),
        (-0.2, [0.11, 0.31, 0.22], [0.22, 0.0, 0.0], -18.0),
        (-0.2, [0.16, 0.41, 0.28], [-0.22, 0.0, 0.0], 18.0),
        (0.1, [0.21, 0.25, 0.41], [0.0, 0.35, -0.15], 0.0),
        (0.1, [0.046, 0.046, 0.05], [0.0, 0.1, 0.25], 0.0),
        (0.1, [0.046, 0.046, 0.05], [0.0, -0.1, 0.25], 0.0),
        (0.1, [0.046, 0.023, 0.05], [-0.08, -0.605, 0.0], 0.0),
        (0.1, [0.023, 0.023, 0.02], [0.0, -0.606, 0.0], 0.0),
        (0.1, [0.023, 0.046, 0.02], [0.06, -0.605, 0.0], 0.0),
    ];
    let value = |p: DVec3| {
        let inside = |(_, axes, middle, turn): &(f64, [f64; 3], [f64; 3], f64)| {
            let (sin, cos) = turn.to_radians().sin_cos();
            let d = p - DVec3::from_array(*middle);
            let turned = DVec3::new(d.x * cos + d.y * sin, d.y * cos - d.x * sin, d.z);
            (turned / DVec3::from_array(*axes)).length_squared() <= 1.0
        };
        ELLIPSOIDS.iter().filter(|ellipsoid| inside(ellipsoid)).map(|(value, ..)| value).sum::<f64>()
    };
    // Mean of eight positions in each voxel, as a scanner would measure it.
    let at = |i: usize| {
        let index = DVec3::new((i % N) as f64, (i / N % N) as f64, (i / (N * N)) as f64);
        let sum: f64 = (0..8)
            .map(|k| {
                let offset = DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 0.5 - 0.25;
                value((index + offset) * (2.0 / (N - 1) as f64) - 1.0)
            })
            .sum();
        (sum / 8.0 * 255.0).round().clamp(0.0, 255.0) as u8
    };
    (0..N * N * N).map(at).collect()
}

/// Affine with two millimetres from sample to sample.
pub fn world_from_index() -> DAffine3 {
    DAffine3::from_scale(DVec3::splat(2.0))
}

/// Camera in perspective that shows all of the head, which leaves the corners of its box empty, from above and beside.
pub fn camera() -> wavesplat::Result<Camera> {
    let corners =
        box_corners([DVec3::ZERO, DVec3::splat(N as f64 - 1.0)]).map(|p| world_from_index().transform_point3(p));
    InView::around(&corners).perspective(30.0).zoom(1.6).orbit(142.0, 22.0, Fit::View)?.camera()
}

/// Transfer function that is linear between opacities and colours.
pub fn look(opacity: &[(f64, f64)], color: &[(f64, [f64; 3])]) -> wavesplat::Result<TransferFunction> {
    let opacity = opacity.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = color.iter().map(|&(value, rgb)| ColorNode { value, rgb }).collect();
    TransferFunction::new(opacity, color, Some(2.0))
}

/// Writes a frame as PNG to the folder that is the first argument, or to the system's folder for temporary files.
pub fn save(frame: &Frame, name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let path = folder.join(name);
    std::fs::write(&path, encode_png(&frame.picture, PngBits::Eight)?)?;
    println!(
        "{}: {} sheets in all, {} million texels",
        path.display(),
        frame.report.n_sheets.iter().sum::<usize>(),
        frame.report.n_texels / 1_000_000
    );
    Ok(())
}
