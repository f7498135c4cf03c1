//! Pixel pitch on the base planes: which rays of each slice family a picture needs, and how close together they are.

use std::ops::Range;

use glam::DVec2;
use wavesplat_compute::parallel;

use crate::view::family::{Family, IndexRays, MAX_SLOPE};
use crate::view::ray_model::RayModel;

/// Extent and pitch of the pixels that a family of rays serves, in base coordinates.
pub struct PixelSpacing {
    pub family: Family,
    pub model: RayModel,
    /// Range of `(p, q)`.
    pub range: [DVec2; 2],
    distance: PixelDistance,
}

/// Distance of neighbouring pixels in base coordinates: the finest, and the sum over `n` pixels.
#[derive(Clone, Copy)]
struct PixelDistance {
    finest: DVec2,
    sum: DVec2,
    n: f64,
}

/// Side of the squares of pixels that are measured together where they are of one family: the pitch changes smoothly.
const SQUARE_PX: usize = 8;

/// Largest ratio of the chosen pitch to the pitch of the finest pixels.
const COARSER: f64 = std::f64::consts::SQRT_2;

/// The pixel spacing of each family, whatever is drawn in it: a texel stays where it is as a volume is cut.
pub fn pixel_spacings(rays: &IndexRays, size_px: [usize; 2], is_parallel: bool) -> Vec<PixelSpacing> {
    let mut spacings = Vec::new();
    if is_parallel {
        // The map is affine, so the corners of the picture are enough.
        let family = Family::of(rays.direction(0.0, 0.0));
        let spacing = spacing_of(&mut spacings, rays, family, is_parallel);
        let [right, lower] = size_px;
        spacing.widen(rays, [0, right], [0, lower]);
        for [x, y] in [[0, 0], [right, 0], [0, lower], [right, lower]] {
            spacing.add(rays, [x as f64, y as f64], 1.0);
        }
        return spacings;
    }
    let band = |k: usize| {
        let rows = SQUARE_PX * k..size_px[1].min(SQUARE_PX * (k + 1));
        spacings_of_rows(rays, rows, size_px[0])
    };
    for of_band in parallel::map(size_px[1].div_ceil(SQUARE_PX), band).into_iter().flatten() {
        match spacings.iter_mut().find(|spacing: &&mut PixelSpacing| spacing.family == of_band.family) {
            Some(spacing) => spacing.merge(&of_band),
            None => spacings.push(of_band),
        }
    }
    spacings
}

/// Pixel spacings of the families in some rows of pixels, for rays from an eye.
fn spacings_of_rows(rays: &IndexRays, rows: Range<usize>, width_px: usize) -> Vec<PixelSpacing> {
    let mut spacings = Vec::new();
    for x in (0..width_px).step_by(SQUARE_PX) {
        let columns = x..width_px.min(x + SQUARE_PX);
        let (last_x, last_y) = (columns.end - 1, rows.end - 1);
        let corners = [[x, rows.start], [last_x, rows.start], [x, last_y], [last_x, last_y]].map(middle);
        if let Some(family) = rays.family_of_all(&corners) {
            let spacing = spacing_of(&mut spacings, rays, family, false);
            // Straight lines of pixels are straight in base coordinates.
            spacing.widen(rays, [columns.start, columns.end], [rows.start, rows.end]);
            let [first, .., last] = corners;
            let center = [0, 1].map(|axis| 0.5 * (first[axis] + last[axis]));
            spacing.add(rays, center, (columns.len() * rows.len()) as f64);
            // Pixels are closest at one of the corners.
            for corner in corners {
                spacing.add(rays, corner, 0.0);
            }
            continue;
        }
        for y in rows.clone() {
            let mut x = columns.start;
            while x < columns.end {
                let first = middle([x, y]);
                let (family, n) = rays.families_along_x(first, columns.end - x);
                let spacing = spacing_of(&mut spacings, rays, family, false);
                spacing.widen(rays, [x, x + n], [y, y + 1]);
                spacing.add(rays, first, n as f64);
                x += n;
            }
        }
        // The tip of a family may lie between the middles of pixels.
        for [x, y] in (rows.start..=rows.end).flat_map(|y| (columns.start..=columns.end).map(move |x| [x, y])) {
            let at = [x as f64, y as f64];
            let spacing = spacing_of(&mut spacings, rays, Family::of(rays.direction(at[0], at[1])), false);
            spacing.widen(rays, [x.saturating_sub(1), x + 1], [y.saturating_sub(1), y + 1]);
            spacing.add(rays, at, 0.0);
        }
    }
    spacings
}

/// The middle of a pixel.
fn middle(pixel: [usize; 2]) -> [f64; 2] {
    pixel.map(|i| i as f64 + 0.5)
}

/// The entry of a family, appended where it is missing.
fn spacing_of<'a>(
    spacings: &'a mut Vec<PixelSpacing>,
    rays: &IndexRays,
    family: Family,
    is_parallel: bool,
) -> &'a mut PixelSpacing {
    let known = spacings.iter().position(|spacing| spacing.family == family);
    let place = known.unwrap_or_else(|| {
        let model = RayModel::new(&family, rays, is_parallel);
        spacings.push(PixelSpacing {
            family,
            model,
            range: [DVec2::INFINITY, DVec2::NEG_INFINITY],
            distance: PixelDistance::NONE,
        });
        spacings.len() - 1
    });
    &mut spacings[place]
}

impl PixelSpacing {
    /// Adds the pixel distance at a position, weighted by `n` pixels.
    fn add(&mut self, rays: &IndexRays, [x_px, y_px]: [f64; 2], n: f64) {
        // Largest change of p and of q per pixel, in any direction of the picture.
        let [dx, dy] = self.model.base_per_pixel(&self.family, rays, x_px, y_px);
        let distance =
            PixelDistance::of(DVec2::new(dx.x * dx.x + dy.x * dy.x, dx.y * dx.y + dy.y * dy.y).map(f64::sqrt), n);
        self.distance.merge(&distance);
    }

    /// Extends the range by the pixels between edges along x and along y, as a whole: a pixel may be the mean of reads
    /// anywhere in it. The part of a pixel that belongs to another family is beyond the slopes of this one.
    fn widen(&mut self, rays: &IndexRays, edges_x: [usize; 2], edges_y: [usize; 2]) {
        for [x_px, y_px] in edges_x.into_iter().flat_map(|x| edges_y.map(|y| [x as f64, y as f64])) {
            let here = self.model.base_from_pixel(&self.family, rays, x_px, y_px);
            let here = if matches!(self.model, RayModel::Perspective { .. }) {
                here.clamp(DVec2::splat(-MAX_SLOPE), DVec2::splat(MAX_SLOPE))
            } else {
                here
            };
            self.range = [self.range[0].min(here), self.range[1].max(here)];
        }
    }

    fn merge(&mut self, other: &Self) {
        self.range = [self.range[0].min(other.range[0]), self.range[1].max(other.range[1])];
        self.distance.merge(&other.distance);
    }

    /// Pixel pitch along p and along q.
    ///
    /// It is constant for parallel rays. In perspective it grows with the slope of the rays, up to twofold within a
    /// family; the mean is taken, so that there are about as many texels as pixels.
    pub fn pixel_distance(&self) -> DVec2 {
        let PixelDistance { finest, sum, n } = self.distance;
        if n > 0.0 { (sum / n).clamp(finest, COARSER * finest) } else { finest }
    }
}

impl PixelDistance {
    const NONE: Self = Self { finest: DVec2::INFINITY, sum: DVec2::ZERO, n: 0.0 };

    /// The distance of `n` pixels that are equally far apart.
    fn of(distance: DVec2, n: f64) -> Self {
        Self { finest: distance, sum: distance * n, n }
    }

    fn merge(&mut self, other: &Self) {
        self.finest = self.finest.min(other.finest);
        self.sum += other.sum;
        self.n += other.n;
    }
}
