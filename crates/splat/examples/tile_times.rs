//! Measures the tiles of a frame on one thread: what `make bench-threads` simulates more threads with. For 1 thread and
//! for each larger number it prints the parts of tiles that the renderer draws, in its order: the number of threads, the
//! estimated cost of the part's tile, and the part's time in microseconds, the least of the frames. Arguments: see
//! [`scene`].

mod scene;

use std::sync::Mutex;
use std::time::Instant;

use wavesplat_compute::simd::Level;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::frame::{draw_part, tile_costs};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::tile_parts::parts_for;
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V, TilePart};
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
                for n_threads in [1, 2, 4, 8, 16, 32, 64, 128] {
                    let whole = || (0..costs.len()).map(|tile| TilePart { tile, rows: 0..TILE_V }).collect();
                    let parts = parts_for(n_threads, || costs.clone()).unwrap_or_else(whole);
                    let mut least = vec![f64::INFINITY; parts.len()];
                    for _ in 0..scene.n_frames {
                        let times = Mutex::new(Vec::new());
                        let mut picture = BasePicture::new(plan.families[family].plane.clone(), false);
                        picture.fill_parts([TILE_U, TILE_V], &parts, |part, texels| {
                            let begun = Instant::now();
                            draw_part(&plan, family, &[&scene.slices], part, texels);
                            times.lock().expect("no panic").push(begun.elapsed().as_secs_f64() * 1e6);
                        });
                        let times = times.into_inner().expect("no panic");
                        least.iter_mut().zip(times).for_each(|(least, time)| *least = least.min(time));
                    }
                    for (part, least) in parts.iter().zip(least) {
                        println!("{n_threads} {} {least:.2}", costs[part.tile]);
                    }
                }
            }
        });
    });
}
