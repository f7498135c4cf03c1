//! Measures the tiles of a frame on one thread: what `make bench-threads` simulates more threads with. Prints for each
//! tile, row by row, its estimated cost, and its time in microseconds, the least of the frames. Arguments: see [`scene`].

mod scene;

use std::time::Instant;

use wavesplat_compute::simd::Level;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::frame::tile_costs;
use wavesplat_splat::render::piece::{draw_piece, tiles_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::{Layer, with_threads};

fn main() {
    scene::with_scene("tile_times", |scene| {
        let cache = VisibilityCache::default();
        let (tf, shading) = (&scene.tf, scene.options.shading.as_ref());
        let layer =
            Layer { slices: &scene.slices, transfer_function: tf, shading, labels: None, color: None, cache: &cache };
        with_threads(Some(1), || {
            let plan = Plan::new(Level::best(), &[layer], &scene.camera, &scene.options).expect("a valid scene");
            for family in 0..plan.families.len() {
                let costs = tile_costs(&plan, family, &[&scene.slices]);
                let all = 0..plan.families[family].spacing.n_slabs;
                for (tile, cost) in tiles_of(&plan, family).into_iter().zip(costs) {
                    let time = || {
                        let begun = Instant::now();
                        draw_piece(&plan, family, &[tile], &all, &[&scene.slices], &[None], &()).expect("a piece");
                        begun.elapsed().as_secs_f64() * 1e6
                    };
                    let least = (0..scene.n_frames).map(|_| time()).fold(f64::INFINITY, f64::min);
                    println!("{cost} {least:.2}");
                }
            }
        });
    });
}
