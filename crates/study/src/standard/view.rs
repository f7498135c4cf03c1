//! Sheet buffers parallel to the view plane: samples sorted by depth into slabs, each slab a buffer.
//!
//! A sample at `p` lies at the picture position `x(p)`, and its kernel, a sphere of index space, is an ellipse around
//! it: a texel `d` away passes the sample at the index distance `ρ² = dᵀ Q d`, where Q is the part of the metric of the
//! texel steps at the sample's depth that is perpendicular to its ray. (In perspective that is exact to first order
//! around the sample.) Its weight is `V √det Q / (s a) · F(ρ²)` with the footprint `F` of unit mass, the volume `V` of
//! a sample, the thickness `s` of a slab and the area `a` of a texel at that depth: on average over a slab, weights sum
//! to 1. Where samples are closer than texels, Q is limited to at most one sample per texel.
//!
//! Work is cut into tiles of the picture. A tile goes through its samples slice by slice, front to back, keeps what is
//! visible in the bin of its slab, and composites a slab when no slice to come can add to it.

use std::sync::Mutex;

use glam::{DMat3, DVec3, Vec4};
use wavesplat_compute::locks::{lock, unlocked};
use wavesplat_compute::parallel;
use wavesplat_core::{Error, Result};
use wavesplat_splat::render::progress::{Progress, ProgressCallback};
use wavesplat_splat::source::window::Window;
use wavesplat_splat::view::family::{Family, IndexRays};

use super::axis::OPAQUE_ENOUGH;
use super::footprint::RadialFootprint;
use super::resample::resample;
use super::samples::{Densities, SampleLayer, visible_layers};
use super::shaded::Shaded;
use super::{FamilyScene, SliceDistance, StandardReport, StandardScene};

/// Side of a tile, in texels.
const TILE: usize = 64;

/// Smallest depth that is drawn in perspective, in slabs.
pub const NEAREST_SLAB: f64 = 1.0;

/// Tolerance at the border of a slab, in slabs: depths this close to it belong to the slab behind, however they are
/// rounded.
const ON_A_BORDER: f64 = 1e-6;

/// Largest number of texels of the picture: 16 bytes each, 4 GiB in all.
const MAX_TEXELS: f64 = (1 << 28) as f64;

/// Draws the picture, as associated RGBA.
pub fn draw(
    scene: &StandardScene,
    monitor: &dyn ProgressCallback,
    report: &mut StandardReport,
) -> Result<Vec<[f32; 4]>> {
    let options = scene.options;
    let pixels = [options.width_px, options.height_px];
    let size = pixels.map(|n| (n as f64 * options.oversampling).round().max(1.0));
    if size[0] * size[1] > MAX_TEXELS {
        return Err(Error::TooLarge {
            what: "the sheet buffer of this picture",
            needed_mib: (size[0] * size[1] * 16.0 / f64::from(1 << 20)) as u64,
            limit_mib: (MAX_TEXELS * 16.0 / f64::from(1 << 20)) as u64,
            mend: "ask for a smaller picture or less oversampling",
        });
    }
    let size = size.map(|n| n as usize);
    let view = View::new(scene, size);
    let n_tiles = size.map(|n| n.div_ceil(TILE));
    let first = |t: usize| [t % n_tiles[0] * TILE, t / n_tiles[0] * TILE];
    let mut families: Vec<FamilyScene> = Vec::new();
    for t in 0..n_tiles[0] * n_tiles[1] {
        let family = view.family(first(t));
        if families.iter().all(|known| known.family != family) {
            families.push(FamilyScene::new(scene, family));
        }
    }
    let progress = Progress::new(monitor, n_tiles[0] * n_tiles[1]);
    let all = Mutex::new((vec![[0.0; 4]; size[0] * size[1]], 0, [i64::MAX, i64::MIN]));
    parallel::for_each(n_tiles[0] * n_tiles[1], |t| {
        let family = families.iter().find(|known| known.family == view.family(first(t)));
        let (Some(family), false) = (family, progress.is_stopped()) else { return };
        let mut tile = ViewTile::new(&view, first(t));
        if tile.draw(&view, family) {
            let mut all = lock(&all);
            let (texels, n_splats, [nearest, furthest]) = &mut *all;
            tile.put(texels, size[0]);
            *n_splats += tile.n_splats;
            (*nearest, *furthest) = ((*nearest).min(tile.slabs[0]), (*furthest).max(tile.slabs[1]));
        }
        progress.tile_done();
    });
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    let (texels, n_splats, [nearest, furthest]) = unlocked(all);
    report.n_splats += n_splats;
    report.n_sheets.push((furthest.saturating_sub(nearest) + 1).max(0) as usize);
    Ok(if size == pixels { texels } else { resample(&texels, size, pixels) })
}

/// Map from samples to their places in the picture, and to slabs.
struct View {
    size: [usize; 2],
    rays: IndexRays,
    /// Pixels per texel along x and y.
    per_texel: [f64; 2],
    is_parallel: bool,
    /// Index position from which offsets are taken: the eye, or the place of the first texel's corner.
    origin: DVec3,
    /// Map from index offsets to (x, y, depth), in texels and world units; in perspective, x and y times the depth.
    picture_from_index: DMat3,
    /// Index steps from texel to texel; in perspective, at a depth of 1.
    steps: [DVec3; 2],
    /// Direction of all rays, where they are parallel.
    direction: DVec3,
    /// Depth of the sample 0, 0, 0, and thickness of a slab.
    slab_origin: f64,
    slab: f64,
    /// World area of a texel; in perspective, at a depth of 1. World volume of a sample.
    texel_area: f64,
    sample_volume: f64,
    /// Factor of the weights: not 1 where the view angle is not corrected for, so that opacities are of the slice
    /// distance.
    packing: f64,
    footprint: RadialFootprint,
}

/// A kernel's ellipse in the picture: `ρ² = xx dx² + 2 xy dx dy + yy dy²`, with the numbers for drawing it row by row.
#[derive(Clone, Copy, Debug)]
struct Ellipse {
    xx: f32,
    twice_xy: f32,
    yy: f32,
    /// Largest distance from the middle along x and y.
    reach: [f32; 2],
    /// In the row `dy` from the middle, the row's middle is `shear · dy` further, and half its width is
    /// `√(width − narrowing · dy²)`.
    shear: f32,
    width: f32,
    narrowing: f32,
    /// Factor of the footprint.
    weight: f32,
}

impl Ellipse {
    fn new([xx, xy, yy]: [f64; 3], radius_squared: f64, weight: f64) -> Self {
        let det = (xx * yy - xy * xy).max(f64::MIN_POSITIVE);
        Self {
            xx: xx as f32,
            twice_xy: (2.0 * xy) as f32,
            yy: yy as f32,
            reach: [yy, xx].map(|q| (radius_squared * q / det).sqrt() as f32),
            shear: (-xy / xx) as f32,
            width: (radius_squared / xx) as f32,
            narrowing: (det / (xx * xx)) as f32,
            weight: weight as f32,
        }
    }
}

impl View {
    fn new(scene: &StandardScene, size: [usize; 2]) -> Self {
        let (grid, camera, options) = (scene.grid, scene.camera, scene.options);
        let pixels = [options.width_px, options.height_px];
        let rays = IndexRays::new(camera, grid.index_from_world(), pixels[0], pixels[1]);
        let per_texel = [0, 1].map(|k| pixels[k] as f64 / size[k] as f64);
        let is_parallel = scene.eye().is_none();
        let at = |x: f64, y: f64| if is_parallel { rays.origin(x, y) } else { rays.direction(x, y) };
        let steps = [at(per_texel[0], 0.0) - at(0.0, 0.0), at(0.0, per_texel[1]) - at(0.0, 0.0)];
        let origin = rays.origin(0.0, 0.0);
        let direction = rays.direction(0.0, 0.0);
        let picture_from_index = DMat3::from_cols(steps[0], steps[1], direction).inverse();
        let matrix = grid.world_from_index().matrix3;
        let distance = SliceDistance::new(grid, camera.forward());
        Self {
            size,
            rays,
            per_texel,
            is_parallel,
            origin,
            picture_from_index,
            steps,
            direction,
            slab_origin: (picture_from_index * -origin).z,
            slab: distance.along_view,
            texel_area: (matrix * steps[0]).cross(matrix * steps[1]).length(),
            sample_volume: matrix.determinant().abs(),
            packing: if scene.standard.view_angle_correction { 1.0 } else { distance.along_view / distance.across },
            footprint: RadialFootprint::new(scene.standard.kernel),
        }
    }

    /// Index origin and direction of the ray through a texel position.
    fn ray(&self, x: f64, y: f64) -> [DVec3; 2] {
        let (x, y) = (x * self.per_texel[0], y * self.per_texel[1]);
        [self.rays.origin(x, y), self.rays.direction(x, y)]
    }

    /// The axis that the rays of a tile run most along.
    fn family(&self, first: [usize; 2]) -> Family {
        let [x, y] = [0, 1].map(|k| (first[k] as f64 + 0.5 * TILE as f64).min(self.size[k] as f64));
        Family::of(self.ray(x, y)[1])
    }

    /// Number of the slab at a depth.
    fn slab(&self, depth: f64) -> i64 {
        ((depth - self.slab_origin) / self.slab + 0.5 + ON_A_BORDER).floor() as i64
    }

    /// The ellipse of the sample at an index position whose depth is known.
    #[inline(always)]
    fn ellipse(&self, position: DVec3, depth: f64) -> Ellipse {
        let (direction, scale) = if self.is_parallel { (self.direction, 1.0) } else { (position - self.origin, depth) };
        let [x, y] = self.steps.map(|step| step * scale);
        let inverse = direction.length_squared().recip();
        let (along_x, along_y) = (x.dot(direction), y.dot(direction));
        let xx = x.length_squared() - along_x * along_x * inverse;
        let xy = x.dot(y) - along_x * along_y * inverse;
        let yy = y.length_squared() - along_y * along_y * inverse;
        let (xx, xy, yy) = widen(xx, xy, yy);
        let root = (xx * yy - xy * xy).max(f64::MIN_POSITIVE).sqrt();
        let weight = self.packing * self.sample_volume * root / (self.slab * self.texel_area * scale * scale);
        Ellipse::new([xx, xy, yy], self.footprint.radius_squared, weight)
    }

    /// Ranges of u and v of the samples on the slice at `w` that a tile may show; `None` behind the eye.
    fn hull(&self, family: &Family, first: [usize; 2], w: f64) -> Option<[[f64; 2]; 2]> {
        /// Largest slope of the rays of a tile at which the ranges are bounded.
        const STEEPEST: f64 = 8.0;
        let sign = if family.ascending { 1.0 } else { -1.0 };
        let everything = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
        let mut hull = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut corners = [[0.0; 2]; 4];
        let mut slopes = [0.0_f64; 2];
        for (k, corner) in corners.iter_mut().enumerate() {
            let [x, y] = [k % 2, k / 2].map(|far| (far * TILE) as f64);
            let [origin, direction] = self.ray(first[0] as f64 + x, first[1] as f64 + y);
            let ([ou, ov, ow], [du, dv, dw]) = (family.uvw(origin), family.uvw(direction));
            if sign * dw <= 0.0 || du.abs().max(dv.abs()) > STEEPEST * dw.abs() {
                return Some(everything);
            }
            *corner = [ou + (w - ow) * du / dw, ov + (w - ow) * dv / dw];
            for c in 0..2 {
                hull[c] = [hull[c][0].min(corner[c]), hull[c][1].max(corner[c])];
                slopes[c] = slopes[c].max(([du, dv][c] / dw).abs());
            }
        }
        let [_, _, eye_w] = family.uvw(self.origin);
        if !self.is_parallel && sign * (w - eye_w) <= 0.0 {
            return None;
        }
        // Reach of a cylinder around a ray, cut by the slice, and of a widened footprint. In perspective the cylinder
        // is a cone, and the ellipses belong to the samples, not to the texels.
        let radius = self.footprint.radius_squared.sqrt();
        let (factor, spare) = if self.is_parallel { (1.0, 1e-6) } else { (1.3, 0.5) };
        for c in 0..2 {
            let per_texel =
                ((corners[1][c] - corners[0][c]).abs() + (corners[2][c] - corners[0][c]).abs()) / TILE as f64;
            let reach = factor * radius * (slopes[c].hypot(1.0) + per_texel) + spare;
            hull[c] = [hull[c][0] - reach, hull[c][1] + reach];
        }
        Some(hull)
    }

    /// Least and largest depth of the samples of a layer.
    fn depths(&self, family: &FamilyScene, layer: &SampleLayer) -> [f64; 2] {
        let Window { u, v } = layer.window;
        let corner = |k: usize| {
            let position = family.position([u[k % 2] as f64, v[k / 2] as f64, layer.slice as f64]);
            (self.picture_from_index * (position - self.origin)).z
        };
        (0..4).map(corner).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], z| [lo.min(z), hi.max(z)])
    }
}

/// Limits the quadratic form of an ellipse to at most one sample per texel in every direction: its eigenvalues to 1.
#[inline(always)]
fn widen(xx: f64, xy: f64, yy: f64) -> (f64, f64, f64) {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let apart = half.hypot(xy);
    if mean + apart <= 1.0 {
        return (xx, xy, yy);
    }
    let (large, small) = (1.0, (mean - apart).min(1.0));
    // The ellipse keeps its axes, with other lengths.
    let (mean_new, factor) = (0.5 * (large + small), if apart > 0.0 { 0.5 * (large - small) / apart } else { 0.0 });
    (mean_new + factor * half, factor * xy, mean_new - factor * half)
}

/// A sample on its way into the sheet buffer.
#[derive(Clone, Copy)]
struct Splat {
    /// Texel position in the tile.
    at: [f32; 2],
    ellipse: Ellipse,
    /// Associated colour and opacity, times the weight.
    rgba: [f32; 4],
}

/// A tile of the picture.
struct ViewTile {
    first: [usize; 2],
    size: [usize; 2],
    rgba: Vec<Vec4>,
    sheet: Vec<Vec4>,
    /// Number of texels that are not opaque yet.
    n_open: usize,
    n_splats: u64,
    /// Numbers of the first and the last slab.
    slabs: [i64; 2],
}

/// Part of a tile: first and last texel along x and y; empty where a first is above a last.
type TexelRectangle = [[usize; 2]; 2];

impl ViewTile {
    fn new(view: &View, first: [usize; 2]) -> Self {
        let size = [0, 1].map(|k| TILE.min(view.size[k] - first[k]));
        let n = size[0] * size[1];
        Self {
            first,
            size,
            rgba: vec![Vec4::ZERO; n],
            sheet: vec![Vec4::ZERO; n],
            n_open: n,
            n_splats: 0,
            slabs: [0, -1],
        }
    }

    /// Draws all slabs; returns whether there are any.
    fn draw(&mut self, view: &View, family: &FamilyScene) -> bool {
        let layers = visible_layers(family, |w| view.hull(&family.family, self.first, w));
        let depths: Vec<[f64; 2]> = layers.iter().map(|layer| view.depths(family, layer)).collect();
        let nearest = if view.is_parallel { f64::NEG_INFINITY } else { NEAREST_SLAB * view.slab };
        let [lo, hi] =
            depths.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], d| [lo.min(d[0]), hi.max(d[1])]);
        if layers.is_empty() || hi < nearest {
            return false;
        }
        self.slabs = [view.slab(lo.max(nearest)), view.slab(hi)];
        // First slab that this slice or a later one adds to.
        let mut from = i64::MAX;
        let mut open_from: Vec<i64> = depths
            .iter()
            .rev()
            .map(|depths| {
                from = from.min(view.slab(depths[0].max(nearest)));
                from
            })
            .collect();
        open_from.reverse();
        let mut bins: Vec<Vec<Splat>> = vec![Vec::new(); (self.slabs[1] - self.slabs[0] + 1) as usize];
        let mut spare = Vec::new();
        let mut next = self.slabs[0];
        let (mut densities, mut shaded) = (Densities::default(), Shaded::default());
        let form = view.is_parallel.then(|| view.ellipse(view.origin, 1.0));
        for (k, layer) in layers.iter().enumerate() {
            densities.cover(family, &layers, k);
            if shaded.fill(family, &densities, layer, 0) > 0 {
                self.sort(view, family, layer, &shaded, form, nearest, &mut bins, &mut spare);
            }
            let done_before = open_from.get(k + 1).copied().unwrap_or(self.slabs[1] + 1);
            while next < done_before {
                let mut bin = std::mem::take(&mut bins[(next - self.slabs[0]) as usize]);
                next += 1;
                if bin.is_empty() {
                    continue;
                }
                self.n_splats += bin.len() as u64;
                family.scene.level.run(
                    #[inline(always)]
                    || {
                        let part = self.splat(&bin, &view.footprint);
                        self.composite(part, family.scene.peak);
                    },
                );
                bin.clear();
                spare.push(bin);
                if self.n_open == 0 {
                    return true;
                }
            }
        }
        true
    }

    /// Puts the visible samples of a slice that reach the tile into the bins of their slabs.
    #[expect(clippy::too_many_arguments, reason = "one loop over what draw() prepared")]
    fn sort(
        &self,
        view: &View,
        family: &FamilyScene,
        layer: &SampleLayer,
        shaded: &Shaded,
        form: Option<Ellipse>,
        nearest: f64,
        bins: &mut [Vec<Splat>],
        spare: &mut Vec<Vec<Splat>>,
    ) {
        let Window { u: [u_lo, _], v: [v_lo, _] } = layer.window;
        let along = family.position([1.0, 0.0, 0.0]);
        let step = view.picture_from_index * along;
        // The outermost texel centres.
        let [end_x, end_y] = self.size.map(|n| n as f32 - 0.5);
        for row in 0..layer.window.n_v() {
            let Some([from, to]) = shaded.span(row) else { continue };
            let start = family.position([u_lo as f64, (v_lo + row as i64) as f64, layer.slice as f64]);
            let first = view.picture_from_index * (start - view.origin);
            let [r, g, b, a] = [0, 1, 2, 3].map(|c| &shaded.row(c, row)[shaded.padding()..]);
            for i in from..=to {
                let alpha = a[i];
                let at = first + step * i as f64;
                if alpha <= 0.0 || at.z < nearest {
                    continue;
                }
                let ellipse = form.unwrap_or_else(|| view.ellipse(start + along * i as f64, at.z));
                let [x, y] = if view.is_parallel { [at.x, at.y] } else { [at.x / at.z, at.y / at.z] };
                let [x, y] = [(x - self.first[0] as f64) as f32, (y - self.first[1] as f64) as f32];
                let [reach_x, reach_y] = ellipse.reach;
                if x + reach_x < 0.5 || x - reach_x > end_x || y + reach_y < 0.5 || y - reach_y > end_y {
                    continue;
                }
                let bin = &mut bins[(view.slab(at.z) - self.slabs[0]) as usize];
                if bin.capacity() == 0 {
                    *bin = spare.pop().unwrap_or_default();
                }
                let weight = ellipse.weight;
                let rgba = [r[i] * weight, g[i] * weight, b[i] * weight, alpha * weight];
                bin.push(Splat { at: [x, y], ellipse, rgba });
            }
        }
    }

    /// Adds splats to the sheet buffer; returns the part of it that they reach. Runs at the SIMD level of the caller.
    #[inline(always)]
    fn splat(&mut self, splats: &[Splat], footprint: &RadialFootprint) -> TexelRectangle {
        let [n_x, n_y] = self.size;
        let (last_x, last_y) = ((n_x - 1) as f32, (n_y - 1) as f32);
        let mut part = [[usize::MAX, 0], [usize::MAX, 0]];
        for Splat { at: [x, y], ellipse, rgba } in splats {
            let color = Vec4::from_array(*rgba);
            // Texel centres lie at halves.
            let [from_y, to_y] = [y - ellipse.reach[1] - 0.5, y + ellipse.reach[1] - 0.5];
            let (from_y, to_y) = (from_y.ceil().max(0.0), to_y.floor().min(last_y));
            if from_y > to_y {
                continue;
            }
            let (from_y, to_y) = (from_y as usize, to_y as usize);
            part[1] = [part[1][0].min(from_y), part[1][1].max(to_y)];
            for row in from_y..=to_y {
                let dy = row as f32 + 0.5 - y;
                let middle = x + ellipse.shear * dy - 0.5;
                let half = (ellipse.width - ellipse.narrowing * dy * dy).max(0.0).sqrt();
                let (from, to) = ((middle - half).ceil().max(0.0), (middle + half).floor().min(last_x));
                if from > to {
                    continue;
                }
                let (from, to) = (from as usize, to as usize);
                part[0] = [part[0][0].min(from), part[0][1].max(to)];
                let (of_row, along) = (ellipse.yy * dy * dy, ellipse.twice_xy * dy);
                for (k, texel) in self.sheet[row * n_x + from..=row * n_x + to].iter_mut().enumerate() {
                    let dx = (from + k) as f32 + 0.5 - x;
                    let squared = (ellipse.xx * dx + along) * dx + of_row;
                    *texel += color * footprint.weight(squared.max(0.0));
                }
            }
        }
        part
    }

    /// Clamps the sums of the sheet buffer to valid colours, composites them, and clears them.
    #[inline(always)]
    fn composite(&mut self, [[from_x, to_x], [from_y, to_y]]: TexelRectangle, peak: f32) {
        if from_x > to_x || from_y > to_y {
            return;
        }
        for row in from_y..=to_y {
            let texels = row * self.size[0] + from_x..=row * self.size[0] + to_x;
            for (pixel, sum) in self.rgba[texels.clone()].iter_mut().zip(&mut self.sheet[texels]) {
                let alpha = sum.w.clamp(0.0, 1.0);
                let most = Vec4::new(peak * alpha, peak * alpha, peak * alpha, alpha);
                let was_open = pixel.w < OPAQUE_ENOUGH;
                *pixel += (1.0 - pixel.w) * sum.max(Vec4::ZERO).min(most);
                self.n_open -= usize::from(was_open && pixel.w >= OPAQUE_ENOUGH);
                *sum = Vec4::ZERO;
            }
        }
    }

    /// Puts the tile into a picture of `width` texels.
    fn put(&self, texels: &mut [[f32; 4]], width: usize) {
        for (row, from) in self.rgba.chunks_exact(self.size[0]).enumerate() {
            let start = (self.first[1] + row) * width + self.first[0];
            for (to, from) in texels[start..start + self.size[0]].iter_mut().zip(from) {
                *to = from.to_array();
            }
        }
    }
}
