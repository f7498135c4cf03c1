//! Pixels through which a wall of what is drawn passes, against a ray caster with sixteen rays a pixel.

use glam::{DAffine3, DVec3};
use wavesplat_core::{Camera, ClipPlane, Crop, Kernel, Picture, Projection, RenderOptions, TransferFunction};
use wavesplat_splat::reference::raycast::{RaycastOptions, raycast};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::view::region::Region;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.2, rays_per_pixel: 16 };

/// Matter everywhere, also at the walls, that changes slowly.
fn waves() -> Phantom {
    Phantom::sample([30, 26, 22], DAffine3::from_scale(DVec3::new(1.0, 1.1, 1.3)), |p| {
        130.0 + 60.0 * (0.31 * p.x + 0.2 * p.z).sin() * (0.27 * p.y - 0.1 * p.z).cos() + 30.0 * (0.35 * p.z).sin()
    })
}

const FAINT: [(f64, f64); 2] = [(0.0, 0.0), (255.0, 0.03)];
const DENSE: [(f64, f64); 2] = [(0.0, 0.1), (255.0, 0.9)];
const HARD: [(f64, f64); 2] = [(129.0, 0.0), (131.0, 1.0)];

/// The root of the mean square error of pixels that have an edge, and of the others that show something.
fn errors(drawn: &Picture, converged: &Picture, has_edge: &[bool]) -> [f64; 2] {
    let of = |wanted: bool| {
        let (mut sum, mut n) = (0.0, 0);
        for (k, (a, b)) in drawn.rgba.iter().zip(&converged.rgba).enumerate() {
            if has_edge[k] == wanted && (a[3] > 0.0 || b[3] > 0.0) {
                sum += (0..4).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>() / 4.0;
                n += 1;
            }
        }
        (sum / f64::from(n.max(1))).sqrt()
    };
    [of(true), of(false)]
}

/// Pixels of which some corners see what is drawn and some do not.
fn edge_pixels(phantom: &Phantom, camera: &Camera, options: &RenderOptions) -> Vec<bool> {
    let volume = phantom.volume();
    let region = Region::new(volume.grid(), options).unwrap();
    let [width, height] = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, volume.grid().index_from_world(), width, height);
    let start = match camera.projection() {
        Projection::Orthographic { .. } => f64::NEG_INFINITY,
        Projection::Perspective { .. } => 0.0,
    };
    let sees = |x: usize, y: usize| {
        let [x, y] = [x as f64, y as f64];
        let [lo, hi] = region.clip(rays.origin(x, y), rays.direction(x, y), [start, f64::INFINITY]);
        lo < hi
    };
    let has_edge = |k: usize| {
        let [x, y] = [k % width, k / width];
        let n = [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].into_iter().filter(|[x, y]| sees(*x, *y)).count();
        0 < n && n < 4
    };
    (0..width * height).map(has_edge).collect()
}

fn table(name: &str, camera: &Camera, base: &RenderOptions) {
    let phantom = waves();
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    for (look, nodes) in [("faint", &FAINT[..]), ("dense", &DENSE), ("hard", &HARD)] {
        let tf: TransferFunction = opacity_ramp(nodes, Some(1.0));
        let reference = raycast(&volume, &tf, camera, base, SAMPLING, &()).unwrap();
        let has_edge = edge_pixels(&phantom, camera, base);
        let n = has_edge.iter().filter(|e| **e).count();
        let mut line = format!("{name:24} {look:6} n {n:4}");
        for (sheets, texels) in [(1.0, 0.5), (2.0, 1.0), (3.0, 2.0), (6.0, 3.0)] {
            let options = RenderOptions { sheets_per_slice: sheets, oversampling: texels, ..base.clone() };
            let picture = render(&slices, &tf, camera, &options, &()).unwrap().0;
            let [edge, rest] = errors(&picture, &reference, &has_edge).map(|e| 1e3 * e);
            line += &format!(" | {edge:7.2} {rest:7.2}");
        }
        println!("{line}");
    }
}

#[test]
fn explore() {
    let phantom = waves();
    let centre = phantom.centre();
    let plain = RenderOptions { width_px: 40, height_px: 36, shading: None, ..RenderOptions::default() };
    let orthographic = Projection::Orthographic { parallel_scale: 17.3 };
    let perspective = Projection::Perspective { view_angle_rad: 0.5 };
    let look = |d: DVec3, p: Projection| camera_towards(centre, d, 75.0, p);
    let tilt = DVec3::new(0.02, 0.013, 1.0);
    table("ortho z", &look(DVec3::Z, orthographic), &plain);
    table("ortho x", &look(DVec3::X, orthographic), &plain);
    table("ortho tilted", &look(tilt, orthographic), &plain);
    table("ortho oblique", &look(DVec3::new(0.7, 0.5, 0.4), orthographic), &plain);
    table("persp z", &look(DVec3::Z, perspective), &plain);
    table("persp y", &look(DVec3::Y, perspective), &plain);
    table("persp oblique", &look(DVec3::new(0.7, 0.5, 0.4), perspective), &plain);
    let crop = Some(Crop::Index { lo: DVec3::new(4.3, 3.7, 2.2), hi: DVec3::new(22.4, 20.9, 15.1) });
    let cropped = RenderOptions { crop, ..plain.clone() };
    table("crop ortho z", &look(DVec3::Z, orthographic), &cropped);
    table("crop persp -y", &look(-DVec3::Y, perspective), &cropped);
    table("crop oblique", &look(DVec3::new(0.7, 0.5, 0.4), orthographic), &cropped);
    let clip =
        |normal: DVec3| RenderOptions { clip_planes: vec![ClipPlane { origin: centre, normal }], ..plain.clone() };
    table("clip along z", &look(DVec3::Z, orthographic), &clip(DVec3::new(1.0, 0.6, 0.0)));
    table("clip grazing", &look(DVec3::Z, orthographic), &clip(DVec3::new(1.0, 0.6, 0.03)));
    table("clip oblique", &look(DVec3::Z, orthographic), &clip(DVec3::new(1.0, 0.6, 0.8)));
    table("clip persp through eye", &look(DVec3::Z, perspective), &clip(DVec3::new(1.0, 0.6, 0.0)));
    let inside = camera_towards(
        centre + DVec3::new(1.0, 2.0, 0.5),
        DVec3::new(0.1, 0.2, 1.0),
        0.01,
        Projection::Perspective { view_angle_rad: 1.5 },
    );
    table("inside, clip", &inside, &clip(DVec3::new(1.0, 0.6, 0.1)));
}
