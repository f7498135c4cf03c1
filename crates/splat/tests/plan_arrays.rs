//! The plain arrays of a plan agree with what the CPU draws.

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{Kernel, Projection, RenderOptions};
use wavesplat_splat::Layer;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V};
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

fn with_plan(check: impl FnOnce(&Plan)) {
    let phantom = Phantom::sample([21, 18, 16], DAffine3::IDENTITY, |p| 100.0 + 60.0 * (p.x * 0.6).sin() + 3.0 * p.y);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::CatmullRom);
    let tf = opacity_ramp(&[(120.0, 0.0), (200.0, 0.5)], None);
    let camera = camera_towards(
        phantom.centre(),
        DVec3::new(0.3, -0.4, 1.0),
        80.0,
        Projection::Orthographic { parallel_scale: 14.0 },
    );
    let cache = VisibilityCache::default();
    let options = RenderOptions { width_px: 90, height_px: 60, ..RenderOptions::default() };
    let shading = options.shading.as_ref();
    let layer = Layer { slices: &slices, transfer_function: &tf, shading, labels: None, color: None, cache: &cache };
    check(&Plan::new(Level::best(), &[layer], &camera, &options).unwrap());
}

#[test]
fn tables_are_the_transfer_function() {
    with_plan(|plan| {
        let tables = plan.layers[0].tables.arrays();
        for k in 0..1000 {
            let density = -20.0 + 0.3 * k as f32;
            let position = ((density - tables.first) * tables.per_density).clamp(0.0, (tables.colors.len() - 2) as f32);
            let (cell, share) = (position as usize, position.fract());
            let want = plan.layers[0].tables.look_up_one(density);
            for c in 0..4 {
                let [a, b] = [tables.colors[cell][c], tables.colors[cell + 1][c]];
                assert!((a + share * (b - a) - want[c]).abs() < 1e-5, "{density}");
            }
            let is_beyond = density < tables.visible_range[0] || density > tables.visible_range[1];
            assert!(!is_beyond || want[3] == 0.0, "{density}");
        }
    });
}

#[test]
fn sheets_footprints_and_intervals_are_those_of_the_view() {
    with_plan(|plan| {
        let family = &plan.families[0];
        let positions = family.sheet_positions();
        assert_eq!((positions[0], positions[positions.len() - 1]), (0.0, 15.0));
        let footprints = family.footprints(plan, 0, Kernel::CatmullRom, [0, 0], positions[7]);
        let sum: f32 = footprints.slices.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        assert!(footprints.slice_differences.iter().map(|(_, weight)| weight).sum::<f32>().abs() < 1e-6);
        for (axis, n) in footprints.axes.iter().zip([TILE_U, TILE_V]) {
            for i in 0..n {
                let sum: f32 = (0..axis.value.n_taps).map(|t| axis.value.weight(i, t)).sum();
                assert!((sum - 1.0).abs() < 1e-5, "{i}: {sum}");
            }
        }
        // Rays of a box that is looked at from above end on its lowest or highest slice, or at a side.
        let mut n_drawn = 0;
        for [from, to] in family.ray_intervals(plan, 0, [0, 0]) {
            if from < to {
                n_drawn += 1;
                let (lo, hi) = (from.abs().min(to.abs()), from.abs().max(to.abs()));
                assert!(lo > -1e-4 && hi < 15.0 + 1e-4, "{from} {to}");
            }
        }
        assert!(n_drawn > 100, "{n_drawn}");
    });
}

#[test]
fn occupancy_is_one_bit_per_brick() {
    with_plan(|plan| {
        let occupancy = plan.families[0].layers[0].occupancy.as_ref().unwrap();
        let (n @ [n_u, n_v, n_w], n_words, words) = occupancy.arrays();
        assert_eq!(words.len(), n_words * n_v * n_w);
        let mut n_occupied = 0;
        for k in 0..n_u * n_v * n_w {
            let [u, v, w] = [k % n_u, k / n_u % n_v, k / (n_u * n_v)];
            let bit = words[(w * n_v + v) * n_words + u / 64] >> (u % 64) & 1 == 1;
            assert_eq!(bit, occupancy.any([u; 2], [v; 2], [w; 2]), "{u} {v} {w} of {n:?}");
            n_occupied += usize::from(bit);
        }
        assert!(n_occupied > 0 && n_occupied < n_u * n_v * n_w, "{n_occupied}");
    });
}
