//! Framing of a volume by a picture: decides what the errors of one view say about another.

use std::hash::{DefaultHasher, Hash, Hasher};

use glam::DVec3;
use wavesplat_core::{Camera, Grid, RenderOptions};

use crate::view::family::IndexRays;

/// Framing of a volume by a picture: distances and directions of the rays in the middle of the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// Distance between rays of neighbouring pixels, in samples: 0.01 to 100.
    pub pixel_in_samples: f64,
    /// Share of the pixels that a square as wide as the volume's diagonal would cover, `0..=1`: how much is seen, from
    /// any side.
    pub covered: f64,
    /// Unit vector along the picture's middle ray, world coordinates.
    pub direction: [f64; 3],
    /// Vector from the volume's middle to the picture's middle ray, in widths of the picture, index coordinates.
    pub aside: [f64; 3],
    /// Hash of crop and clip planes: 0 without.
    pub cut: u64,
}

/// Largest factor by which the distance of pixels may differ for the errors of another picture to be used.
const MAX_FARTHER: f64 = 1.5;

/// Standard deviations of the PSNR, dB, from one framing to another: from other sides, from aside, per octave of the
/// distance of pixels, and with other cuts. Between the views of `ladder.rs`' pictures it is 1.3 dB for functions that
/// are not smooth, 2.5 dB for those that are.
const SIDE_SPREAD_DB: f64 = 2.5;
const ASIDE_SPREAD_DB: f64 = 2.0;
const OCTAVE_SPREAD_DB: f64 = 2.0;
const CUT_SPREAD_DB: f64 = 2.0;

/// Angle in radians, and way in widths of the picture, from which on pictures differ as much as any.
const FULL_ANGLE: f64 = 0.25;
const FULL_ASIDE: f64 = 0.5;

impl Framing {
    pub fn new(grid: &Grid, camera: &Camera, options: &RenderOptions) -> Self {
        let size_px = [options.width_px, options.height_px];
        let [first, last] = grid.bounds();
        let rays = IndexRays::new(camera, grid.index_from_world(), size_px[0], size_px[1]);
        let middle = size_px.map(|n| 0.5 * n as f64);
        let center = 0.5 * (first + last);
        let pixel_in_samples = rays.distance_at(center, middle).clamp(0.01, 100.0);
        let n_covered = ((last - first).length() / pixel_in_samples).powi(2);
        let covered = (n_covered / (size_px[0] * size_px[1]) as f64).min(1.0);
        let along = rays.direction(middle[0], middle[1]).normalize_or_zero();
        let to_ray = rays.origin(middle[0], middle[1]) - center;
        let aside = (to_ray - along * to_ray.dot(along)) / (pixel_in_samples * size_px[0] as f64);
        let direction = camera.ray(middle[0], middle[1], size_px[0], size_px[1]).direction.normalize_or_zero();
        Self { pixel_in_samples, covered, direction: direction.to_array(), aside: aside.to_array(), cut: cut(options) }
    }

    /// Whether errors measured with this framing say something about a picture with another one.
    pub(crate) fn serves(&self, other: &Self) -> bool {
        let all = [self.pixel_in_samples, self.covered].into_iter().chain(self.direction).chain(self.aside);
        let farther = other.pixel_in_samples / self.pixel_in_samples;
        all.into_iter().all(f64::is_finite)
            && self.covered > 0.0
            && (1.0 / MAX_FARTHER..=MAX_FARTHER).contains(&farther)
    }

    /// Change of the PSNR from a picture with another framing to one with this, and its standard deviation, dB.
    pub(crate) fn change_from(&self, other: &Self) -> (f64, f64) {
        let [own, others] = [self, other].map(|framing| DVec3::from_array(framing.direction));
        let angle = own.angle_between(others);
        let way = (DVec3::from_array(self.aside) - DVec3::from_array(other.aside)).length();
        let octaves = (self.pixel_in_samples / other.pixel_in_samples).log2();
        let part = |amount: f64, full: f64| if amount.is_finite() { (amount / full).min(1.0) } else { 1.0 };
        // Differences of rounding do not count.
        let part = |amount, full| if amount < 1e-6 { 0.0 } else { part(amount, full) };
        let spreads = [
            SIDE_SPREAD_DB * part(angle, FULL_ANGLE),
            ASIDE_SPREAD_DB * part(way, FULL_ASIDE),
            OCTAVE_SPREAD_DB * octaves,
            if self.cut == other.cut { 0.0 } else { CUT_SPREAD_DB },
        ];
        let change_db = -10.0 * (self.covered / other.covered).log10();
        (change_db, spreads.iter().map(|db| db * db).sum::<f64>().sqrt())
    }

    /// Whether two pictures show the same from the same place.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.change_from(other).1 < 1e-3
    }
}

fn cut(options: &RenderOptions) -> u64 {
    if options.crop.is_none() && options.clip_planes.is_empty() {
        return 0;
    }
    let mut hasher = DefaultHasher::new();
    format!("{:?} {:?}", options.crop, options.clip_planes).hash(&mut hasher);
    hasher.finish()
}
