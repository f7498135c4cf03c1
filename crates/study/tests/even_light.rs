//! Even light on cut faces, against the ray caster: sheets, slabs, several layers, missing samples, perspective.

use glam::{DAffine3, DVec3};
use wavesplat_core::{
    Camera, ClipPlane, ColorNode, Crop, Kernel, LabelLook, OpacityNode, Picture, Projection, RenderOptions, Shading,
    TransferFunction,
};
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, render_layers};
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast_layers};
use wavesplat_testkit::{Phantom, camera_towards, psnr_db};

const SAMPLING: RaycastOptions = RaycastOptions { kernel: Kernel::Linear, step: 0.1, rays_per_pixel: 4 };

/// Matter with a fine texture, whose gradients point everywhere, up to the walls.
fn texture(seed: f64) -> Phantom {
    Phantom::sample([26, 24, 22], DAffine3::IDENTITY, |p| {
        150.0 + 60.0 * (1.1 * p.x + 0.4 * p.z + seed).sin() * (0.9 * p.y - 0.5 * p.z).cos()
    })
}

fn function(nodes: &[(f64, f64)], dark: [f64; 3]) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = vec![ColorNode { value: 80.0, rgb: dark }, ColorNode { value: 220.0, rgb: [1.0, 0.9, 0.8] }];
    TransferFunction::new(opacity, color, Some(1.0)).unwrap()
}

const DENSE: [(f64, f64); 2] = [(0.0, 0.85), (255.0, 0.9)];
const HARD: [(f64, f64); 2] = [(149.0, 0.0), (151.0, 1.0)];
const FAINT: [(f64, f64); 2] = [(0.0, 0.15), (255.0, 0.2)];
/// Opacities of which the entry of a ray has less than its full strength.
const HAZE: [(f64, f64); 2] = [(0.0, 0.008), (255.0, 0.03)];

fn shading(even_cuts: f32) -> Shading {
    Shading { even_cuts, shoulder: 1.0, specular: 0.4, ..Shading::default() }
}

fn clipped() -> RenderOptions {
    RenderOptions {
        width_px: 48,
        height_px: 48,
        sheets_per_slice: 4.0,
        oversampling: 3.0,
        clip_planes: vec![ClipPlane { origin: DVec3::new(12.0, 11.0, 12.0), normal: DVec3::new(-0.8, -0.3, -0.4) }],
        ..RenderOptions::default()
    }
}

fn camera(projection: Projection) -> Camera {
    camera_towards(texture(0.0).centre(), DVec3::new(0.7, 0.5, 0.4), 70.0, projection)
}

const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 15.0 };
const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.45 };

/// Our picture and the reference's. `hides`: half of the first volume is a label that hides the scan.
fn both(phantoms: &[Phantom], look: &[(f64, f64)], light: &Shading, camera: &Camera, hides: bool) -> [Picture; 2] {
    let volumes: Vec<_> = phantoms.iter().map(Phantom::volume).collect();
    let labels = hides.then(|| {
        let codes: Vec<u8> = (0..26 * 24 * 22).map(|i| u8::from(i % 26 > 9)).collect();
        let looks = vec![LabelLook::NONE, LabelLook { scan: 0.0, ..LabelLook::NONE }];
        Labels::new(Codes::U8(codes.into()), looks, volumes[0].grid(), Kernel::Linear, 1 << 24).unwrap()
    });
    let labels_of = |k: usize| labels.as_ref().filter(|_| k == 0);
    let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, Kernel::Linear)).collect();
    let functions = [function(look, [0.1, 0.2, 0.5]), function(look, [0.5, 0.1, 0.1])];
    let caches = [VisibilityCache::default(), VisibilityCache::default()];
    let layers: Vec<Layer> = (0..volumes.len())
        .map(|k| Layer {
            slices: &slices[k],
            transfer_function: &functions[k],
            shading: Some(light),
            labels: labels_of(k),
            color: None,
            cache: &caches[k],
        })
        .collect();
    let cast: Vec<CastLayer> = (0..volumes.len())
        .map(|k| CastLayer {
            volume: &volumes[k],
            transfer_function: &functions[k],
            shading: Some(light),
            labels: labels_of(k),
            color: None,
        })
        .collect();
    let options = RenderOptions { shading: Some(light.clone()), ..clipped() };
    let drawn = render_layers(&layers, camera, &options, &()).unwrap().0;
    [drawn, raycast_layers(&cast, camera, &options, SAMPLING, &()).unwrap()]
}

/// The renderer comes as close to the reference with even light as without, and even light changes the picture much
/// more than that.
#[test]
fn even_light_is_that_of_the_reference() {
    let mut holed = texture(0.0);
    for (i, sample) in holed.samples.iter_mut().enumerate() {
        let [x, y, z] = [i % 26, i / 26 % 24, i / (26 * 24)];
        if x > 8 && y > 9 && z > 7 {
            *sample = f32::NAN;
        }
    }
    let scenes = [
        ("sheets", vec![texture(0.0)], FAINT, ORTHOGRAPHIC),
        ("haze", vec![texture(0.0)], HAZE, ORTHOGRAPHIC),
        ("slabs", vec![texture(0.0)], HARD, ORTHOGRAPHIC),
        ("dense", vec![texture(0.0)], DENSE, ORTHOGRAPHIC),
        ("perspective", vec![texture(0.0)], DENSE, PERSPECTIVE),
        ("holes", vec![holed], DENSE, ORTHOGRAPHIC),
        ("layers", vec![texture(0.0), texture(2.0)], FAINT, ORTHOGRAPHIC),
        ("hard layers", vec![texture(0.0), texture(2.0)], HARD, ORTHOGRAPHIC),
    ];
    for (name, phantoms, look, projection) in scenes {
        let camera = camera(projection);
        let [uneven, uneven_reference] = both(&phantoms, &look, &shading(0.0), &camera, false);
        let [even, reference] = both(&phantoms, &look, &shading(1.0), &camera, false);
        let [before, after] = [psnr_db(&uneven.rgba, &uneven_reference.rgba), psnr_db(&even.rgba, &reference.rgba)];
        let change = psnr_db(&even.rgba, &uneven.rgba);
        println!("{name}: {before:.1} dB without, {after:.1} dB with even light, which changes {change:.1} dB");
        assert!(after > before - 1.0 && after > 32.0, "{name}: {before} {after}");
        assert!(change < after - 4.0, "{name}: {change}");
    }
}

/// Matter that a label hides makes no face: what lies behind it is lit by its gradients, in sheets and in slabs.
#[test]
fn hidden_matter_makes_no_face() {
    let camera = camera(ORTHOGRAPHIC);
    let scenes = [("sheets", 1, FAINT), ("slabs", 1, HARD), ("layers", 2, FAINT), ("hard layers", 2, HARD)];
    for (name, n, look) in scenes {
        let phantoms: Vec<Phantom> = (0..n).map(|k| texture(2.0 * f64::from(k))).collect();
        let [uneven, uneven_reference] = both(&phantoms, &look, &shading(0.0), &camera, true);
        let [even, reference] = both(&phantoms, &look, &shading(1.0), &camera, true);
        let [before, after] = [psnr_db(&uneven.rgba, &uneven_reference.rgba), psnr_db(&even.rgba, &reference.rgba)];
        println!("{name}: {before:.1} dB without, {after:.1} dB with even light");
        assert!(after > before - 1.0, "{name}: {before} {after}");
    }
}

/// An opaque cut face has the transfer function's colour in even light, whatever the gradient.
#[test]
fn a_cut_face_shows_its_values() {
    let phantom = texture(0.0);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let tf = function(&[(0.0, 1.0), (255.0, 1.0)], [0.1, 0.2, 0.5]);
    let light = shading(1.0);
    let z = 12.3;
    let crop = Crop::Index { lo: DVec3::splat(-1.0), hi: DVec3::new(40.0, 40.0, z) };
    let options =
        RenderOptions { crop: Some(crop), clip_planes: Vec::new(), shading: Some(light.clone()), ..clipped() };
    let scale = 9.0;
    let from_above = Projection::Orthographic { parallel_scale: scale };
    let camera = Camera::new(DVec3::new(12.5, 11.5, 60.0), DVec3::new(12.5, 11.5, 0.0), DVec3::Y, from_above).unwrap();
    let cache = VisibilityCache::default();
    let layer = Layer {
        slices: &slices,
        transfer_function: &tf,
        shading: Some(&light),
        labels: None,
        color: None,
        cache: &cache,
    };
    let drawn = render_layers(&[layer], &camera, &options, &()).unwrap().0;
    let factors = [0, 1, 2].map(|c| {
        light.ambient + light.diffuse * light.unoriented * light.lights.iter().map(|one| one.rgb[c]).sum::<f32>()
    });
    for (k, got) in drawn.rgba.iter().enumerate() {
        let [px, py] = [k % 48, k / 48].map(|i| (i as f64 + 0.5) / 24.0 - 1.0);
        let place = DVec3::new(12.5 + scale * px, 11.5 - scale * py, z);
        let value = trilinear(&phantom, place);
        let t = ((value - 80.0) / 140.0).clamp(0.0, 1.0) as f32;
        for c in 0..3 {
            let color = [0.1, 0.2, 0.5][c] + t * ([1.0, 0.9, 0.8][c] - [0.1, 0.2, 0.5][c]);
            assert!((got[c] - color * factors[c]).abs() < 0.03, "{px} {py}: {} for {}", got[c], color * factors[c]);
        }
    }
}

fn trilinear(phantom: &Phantom, p: DVec3) -> f64 {
    let [x, y, z] = p.to_array().map(f64::floor);
    let mut sum = 0.0;
    for corner in 0..8 {
        let at = [x, y, z].iter().enumerate().map(|(a, first)| first + f64::from(corner >> a & 1)).collect::<Vec<_>>();
        let weight: f64 = (0..3).map(|a| 1.0 - (p[a] - at[a]).abs()).product();
        let index = (at[2] as usize * 24 + at[1] as usize) * 26 + at[0] as usize;
        sum += weight * f64::from(phantom.samples[index]);
    }
    sum
}
