//! Projections, ray by ray, in double precision, by their definitions ([`Composite`]).
//!
//! A ray is cut where it meets the sheets; between two of them the density is linear. Extremes are taken over the ends
//! of these pieces, integrals are exact.

use glam::DVec3;
use wavesplat_core::{Camera, Composite, Projection, RenderOptions, Result, TransferFunction, Volume};
use wavesplat_splat::sheet::spacing::SheetSpacing;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::{BasePlane, TexelRay};
use wavesplat_splat::view::region::Region;

use super::sampler::Sampler;

/// A piece of a ray between two sheets: sample values and world positions of its ends.
struct RayPiece {
    values: [f64; 2],
    ends: [DVec3; 2],
}

impl RayPiece {
    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// The projected value, in sample units, of every texel of a base plane, before the warp; `None` outside the volume.
pub fn base_plane(
    volume: &Volume,
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    plane: &BasePlane,
) -> Result<Vec<Option<f64>>> {
    options.validate()?;
    let region = Region::new(volume.grid(), options)?;
    let sampler = Sampler::new(volume, slices, tf, camera, None);
    let caster = ProjectionCaster { volume, sampler, region, plane, sheets_per_slice: options.sheets_per_slice };
    let [near, far] = depths(camera, volume, &caster.region);
    let texel = |t: usize| {
        let ray = plane.ray((t % plane.size[0]) as f64, (t / plane.size[0]) as f64);
        let pieces = caster.pieces(&ray);
        let share = |at: DVec3| (camera.forward().dot(at - camera.position()) - near) / (far - near);
        (!pieces.is_empty()).then(|| project(options.composite, &pieces, share))
    };
    Ok((0..plane.size[0] * plane.size[1]).map(texel).collect())
}

/// Projected value of the pieces of a ray. `share`: fraction of the way from the nearest to the farthest corner of the
/// region.
fn project(operator: Composite, pieces: &[RayPiece], share: impl Fn(DVec3) -> f64) -> f64 {
    let ends = || pieces.iter().flat_map(|piece| piece.values.into_iter().zip(piece.ends));
    let values = || ends().map(|(value, _)| value);
    let largest = values().fold(f64::NEG_INFINITY, f64::max);
    let integral = |of: &dyn Fn([f64; 2]) -> f64| pieces.iter().map(|p| of(p.values) * p.length()).sum::<f64>();
    let sum = integral(&|[a, b]| 0.5 * (a + b));
    match operator {
        Composite::Maximum => largest,
        Composite::Minimum => values().fold(f64::INFINITY, f64::min),
        Composite::Sum => sum,
        Composite::Mean => sum / pieces.iter().map(RayPiece::length).sum::<f64>(),
        Composite::DepthShadedMaximum { strength, black } => {
            let shaded = |(value, at): (f64, DVec3)| {
                if value > black { black + (value - black) * (1.0 - strength * share(at)) } else { value }
            };
            ends().map(shaded).fold(f64::NEG_INFINITY, f64::max)
        }
        Composite::AttenuatedMaximum { black, white, attenuation } => {
            let mut depth = 0.0;
            let mut largest = f64::NEG_INFINITY;
            for piece in pieces {
                let [near, far] = piece.values;
                let share = mean_above(near - black, far - black) - mean_above(near - white, far - white);
                let behind = depth + attenuation * share / (white - black) * piece.length();
                for (value, depth) in [(near, depth), (far, behind)] {
                    let dimmed = if value > black { black + (value - black) * (-depth).exp() } else { value };
                    largest = largest.max(dimmed);
                }
                depth = behind;
            }
            largest
        }
        Composite::LocalMaximum { threshold } => {
            let values: Vec<f64> = values().collect();
            let falls = |k: &usize| {
                // A difference below the resolution of f32 is not a fall.
                let top = values[..*k].iter().copied().fold(f64::NEG_INFINITY, f64::max);
                top >= threshold && values[*k] < top - 1e-6 * top.abs()
            };
            let end = (1..values.len()).find(falls).unwrap_or(values.len());
            values[..end].iter().copied().fold(f64::NEG_INFINITY, f64::max)
        }
        Composite::XRay { clear, attenuation } => {
            let above = integral(&|[a, b]| mean_above(a - clear, b - clear));
            (-attenuation * above).exp()
        }
        Composite::Over | Composite::FirstHit { .. } => f64::NAN,
    }
}

/// Mean of the positive part of a value that goes evenly from `a` to `b`.
fn mean_above(a: f64, b: f64) -> f64 {
    let (lo, hi) = (a.min(b), a.max(b));
    if lo >= 0.0 {
        0.5 * (a + b)
    } else if hi <= 0.0 {
        0.0
    } else {
        // A triangle over the part above 0.
        0.5 * hi * hi / (hi - lo)
    }
}

/// Distances along the view of the nearest and the farthest corner of the region.
fn depths(camera: &Camera, volume: &Volume, region: &Region) -> [f64; 2] {
    let [lo, hi] = region.bounds;
    let corner = |x: f64, y: f64, z: f64| {
        let world = volume.grid().world_from_index().transform_point3(DVec3::new(x, y, z));
        camera.forward().dot(world - camera.position())
    };
    let mut depths = [f64::INFINITY, f64::NEG_INFINITY];
    for x in [lo.x, hi.x] {
        for y in [lo.y, hi.y] {
            for z in [lo.z, hi.z] {
                let depth = corner(x, y, z);
                depths = [depths[0].min(depth), depths[1].max(depth)];
            }
        }
    }
    if matches!(camera.projection(), Projection::Perspective { .. }) {
        depths[0] = depths[0].max(0.0);
    }
    depths
}

struct ProjectionCaster<'a> {
    volume: &'a Volume<'a>,
    sampler: Sampler<'a>,
    region: Region,
    plane: &'a BasePlane,
    sheets_per_slice: f64,
}

impl ProjectionCaster<'_> {
    /// The pieces of a ray, front to back, without the missing parts: those where the weights of missing samples,
    /// linear within sheets and between them, come to half or more.
    fn pieces(&self, ray: &TexelRay) -> Vec<RayPiece> {
        let [lo, hi] = self.region.drawn_interval(self.plane, ray);
        let family = self.plane.family;
        let spacing = SheetSpacing::new(self.volume.grid().size()[family.axes[2]], self.sheets_per_slice);
        let at = |w: f64| {
            let mut index = DVec3::ZERO;
            let uvw = [ray.at_zero[0] + ray.slope[0] * w, ray.at_zero[1] + ray.slope[1] * w, w];
            (0..3).for_each(|c| index[family.axes[c]] = uvw[c]);
            index
        };
        let (offset, scale) = self.volume.grid().density_from_sample();
        let value = |w: f64| self.sampler.density(at(w)) / scale + offset;
        let mut pieces = Vec::new();
        for k in 0..spacing.n_slabs {
            let sheets = [spacing.w(k), spacing.w(k + 1)];
            let mut ends = [sheets[0].max(lo), sheets[1].min(hi)];
            let missing = sheets.map(|w| self.sampler.missing(at(w)));
            if missing[0].max(missing[1]) >= 0.5 {
                let half = sheets[0] + (sheets[1] - sheets[0]) * (0.5 - missing[0]) / (missing[1] - missing[0]);
                match missing.map(|share| share < 0.5) {
                    [true, _] => ends[1] = ends[1].min(half),
                    [_, true] => ends[0] = ends[0].max(half),
                    _ => continue,
                }
            }
            if ends[0] >= ends[1] {
                continue;
            }
            let [first, last] = sheets.map(value);
            let between = |w: f64| first + (last - first) * (w - sheets[0]) / (sheets[1] - sheets[0]);
            let world = |w: f64| self.volume.grid().world_from_index().transform_point3(at(w));
            let mut piece = RayPiece { values: ends.map(between), ends: ends.map(world) };
            if !family.ascending {
                piece.values.reverse();
                piece.ends.reverse();
            }
            pieces.push(piece);
        }
        if !family.ascending {
            pieces.reverse();
        }
        pieces
    }
}
