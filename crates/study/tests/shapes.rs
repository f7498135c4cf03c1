//! Surfaces, lines, points and cards in the picture, against the ray caster, which meets them analytically.

mod shape_scenes;

use std::sync::Arc;

use wavesplat_core::{Kernel, Picture, RenderOptions};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Layer, render_layers};
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast_layers};
use wavesplat_testkit::{by_day, psnr_db};

use self::shape_scenes::{Edges, ShapeScene, scenes};

/// The least PSNR in dB.
fn least_db(edges: Edges) -> f64 {
    match edges {
        Edges::Soft => 45.0,
        Edges::Hard => 38.0,
    }
}

/// Options with the sampling of quality `high`.
fn options(scene: &ShapeScene) -> RenderOptions {
    let (sheets_per_slice, oversampling) = match scene.edges {
        Edges::Soft => (4.0, 1.5),
        Edges::Hard => (6.0, 3.0),
    };
    RenderOptions { sheets_per_slice, oversampling, ..scene.options.clone() }
}

/// Sampling of the ray caster: as coarse as the least PSNR allows, since all scenes take a minute.
fn sampling(edges: Edges) -> RaycastOptions {
    let (step, rays_per_pixel) = match edges {
        Edges::Soft => (0.3, 4),
        Edges::Hard => (0.3, 9),
    };
    RaycastOptions { kernel: Kernel::Linear, step, rays_per_pixel }
}

fn draw(scene: &ShapeScene, options: &RenderOptions) -> Picture {
    let volumes: Vec<_> = scene.parts.iter().map(|part| part.phantom.volume()).collect();
    let slices: Vec<_> = volumes.iter().map(|volume| Slices::new(volume, Kernel::Linear)).collect();
    let caches: Vec<_> = volumes.iter().map(|_| VisibilityCache::default()).collect();
    let layers: Vec<Layer> = (0..volumes.len())
        .map(|k| Layer {
            slices: &slices[k],
            transfer_function: &scene.parts[k].tf,
            shading: scene.parts[k].shading.as_ref(),
            labels: scene.labels.as_ref().filter(|_| k == 0),
            color: None,
            cache: &caches[k],
        })
        .collect();
    render_layers(&layers, &scene.camera, options, &()).unwrap().0
}

fn cast(scene: &ShapeScene, options: &RenderOptions) -> Picture {
    let volumes: Vec<_> = scene.parts.iter().map(|part| part.phantom.volume()).collect();
    let layers: Vec<CastLayer> = (0..volumes.len())
        .map(|k| CastLayer {
            volume: &volumes[k],
            transfer_function: &scene.parts[k].tf,
            shading: scene.parts[k].shading.as_ref(),
            labels: scene.labels.as_ref().filter(|_| k == 0),
            color: None,
        })
        .collect();
    raycast_layers(&layers, &scene.camera, options, sampling(scene.edges), &()).unwrap()
}

#[test]
fn pictures_with_shapes_are_those_of_the_ray_caster() {
    let mut failed = Vec::new();
    for scene in by_day(scenes(), 2) {
        let options = options(&scene);
        let want = cast(&scene, &options);
        let db = psnr_db(&draw(&scene, &options).rgba, &want.rgba);
        let without = RenderOptions { shapes: Arc::default(), ..options };
        let db_without = psnr_db(&draw(&scene, &without).rgba, &want.rgba);
        println!("{}, {:?}: {db:.1} dB, without the shapes {db_without:.1} dB", scene.name, scene.edges);
        let least_db = least_db(scene.edges);
        // Shapes that cannot be seen would test nothing.
        if db < least_db || db_without > least_db - 5.0 {
            failed.push(scene.name);
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
