//! Tiles of a base plane on many threads: the same texels as on one, and no thread waits for another.

use std::ops::Range;
use std::sync::{Condvar, Mutex};
use std::time::Duration;

use glam::{DAffine3, DVec2, DVec3};
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Camera, Projection};
use wavesplat_splat::picture::base_picture::{BasePicture, TileTexels};
use wavesplat_splat::sheet::tile_layout::TilePart;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::with_threads;

const TILE: [usize; 2] = [32, 16];

/// A base plane of some texels.
fn plane(size: [usize; 2]) -> BasePlane {
    let projection = Projection::Orthographic { parallel_scale: 9.0 };
    let camera = Camera::new(DVec3::new(4.0, 5.0, 40.0), DVec3::splat(4.0), DVec3::Y, projection).unwrap();
    let rays = IndexRays::new(&camera, DAffine3::IDENTITY, 9, 9);
    let mut plane = base_planes(&camera, &rays, [9, 9], 1.0, [DVec3::ZERO, DVec3::splat(9.0)]).unwrap().remove(0);
    (plane.origin, plane.step, plane.size) = (DVec2::ZERO, DVec2::ONE, size);
    plane
}

/// Draws rows of a tile: something in most chunks, nothing in some, and a wait that differs from tile to tile.
fn draw(tile: usize, rows: Range<usize>, texels: &mut TileTexels) {
    std::thread::sleep(Duration::from_micros((tile * 7919 % 11) as u64 * 30));
    for j in rows {
        for i in (0..TILE[0]).step_by(LANES) {
            let number = |k: usize| ((tile * 7919 + j * 31 + i + k) % 251) as f32 / 251.0;
            let is_drawn = !(tile + j / 8).is_multiple_of(5);
            let chunk = std::array::from_fn(|k| if is_drawn { [number(k), number(k + 1), 0.5, 1.0] } else { [0.0; 4] });
            texels.put(i, j, &chunk, Some(&std::array::from_fn(number)));
        }
    }
}

#[test]
fn many_threads_draw_what_one_draws() {
    // Tiles that are cut off at both ends, too.
    for size in [[333_usize, 141], [32, 16], [5, 300]] {
        let n_tiles = size[0].div_ceil(TILE[0]) * size[1].div_ceil(TILE[1]);
        let picture = |n_threads: usize, parts: Option<&[TilePart]>| {
            let mut picture = BasePicture::new(plane(size), true);
            with_threads(Some(n_threads), || match parts {
                None => picture.fill_tiles(TILE, |tile, texels| draw(tile, 0..TILE[1], texels)),
                Some(parts) => picture.fill_parts(TILE, parts, |part, texels| {
                    draw(part.tile, part.rows.clone(), texels);
                }),
            });
            picture
        };
        let alone = picture(1, None);
        // Parts of tiles in any order: here the last ones first, and every third tile in halves.
        let parts_of = |tile: usize| {
            let middle = if tile.is_multiple_of(3) { 8 } else { 0 };
            [0..middle, middle..TILE[1]].map(|rows| TilePart { tile, rows })
        };
        let parts: Vec<TilePart> = (0..n_tiles).rev().flat_map(parts_of).collect();
        assert!(!alone.is_empty());
        let bits = |picture: &BasePicture| picture.w_half.iter().map(|w| w.to_bits()).collect::<Vec<_>>();
        for n_threads in [8, 16] {
            for parts in [None, Some(&*parts)] {
                let together = picture(n_threads, parts);
                assert!(together.texels() == alone.texels(), "{size:?} on {n_threads} threads");
                assert!(bits(&together) == bits(&alone), "{size:?} on {n_threads} threads");
                assert_eq!(together.drawn_cells(), alone.drawn_cells(), "{size:?} on {n_threads} threads");
            }
        }
    }
}

/// A barrier of `n` threads that gives up after a while, so that a test fails and does not hang.
struct MeetingPoint {
    n: usize,
    n_there: Mutex<usize>,
    all_there: Condvar,
}

impl MeetingPoint {
    fn new(n: usize) -> Self {
        Self { n, n_there: Mutex::new(0), all_there: Condvar::new() }
    }

    fn wait(&self) {
        let mut n_there = self.n_there.lock().unwrap();
        *n_there += 1;
        self.all_there.notify_all();
        let (n_there, _) =
            self.all_there.wait_timeout_while(n_there, Duration::from_mins(1), |n_there| *n_there < self.n).unwrap();
        assert!(*n_there >= self.n, "{} of {} tiles are worked on at the same time", *n_there, self.n);
    }
}

#[test]
fn as_many_tiles_are_worked_on_at_once_as_there_are_threads() {
    for n in [8, 16] {
        let meeting = MeetingPoint::new(n);
        let mut picture = BasePicture::new(plane([TILE[0] * n / 4, TILE[1] * 4]), false);
        with_threads(Some(n), || {
            picture.fill_tiles(TILE, |tile, texels| {
                // Half done, all wait for all.
                texels.put(0, 0, &[[0.5; 4]; LANES], None);
                meeting.wait();
                texels.put(0, 1, &[[tile as f32, 0.0, 0.0, 1.0]; LANES], None);
            });
        });
        for tile in 0..n {
            let [i, j] = [tile % (n / 4) * TILE[0], tile / (n / 4) * TILE[1]];
            assert_eq!(picture.row(j)[i], [0.5; 4]);
            assert_eq!(picture.row(j + 1)[i], [tile as f32, 0.0, 0.0, 1.0]);
        }
    }
}
