//! What a picture needs of each family of rays: which rays, and how close together.

use glam::DVec2;
use wavesplat_compute::parallel;

use crate::base_plane::Spread;
use crate::family::{Family, IndexRays};

/// What the picture needs of a family of rays.
pub struct Need {
    pub family: Family,
    pub spread: Spread,
    /// Range of `(p, q)`.
    pub range: [DVec2; 2],
    distance: PixelDistance,
}

/// How far apart pixels are in base coordinates.
#[derive(Clone, Copy)]
struct PixelDistance {
    finest: DVec2,
    sum: DVec2,
    n: f64,
}

/// So many pixels of a row tell by the first of them how far apart they are: that changes smoothly.
const EVERY: usize = 8;

/// Where pixels are finest, texels are coarser than they by this at most.
const COARSER: f64 = std::f64::consts::SQRT_2;

/// What a picture needs of each family, whatever is drawn in it: a texel stays where it is as a volume is cut.
pub fn needs(rays: &IndexRays, size_px: [usize; 2], is_parallel: bool) -> Vec<Need> {
    let mut needs = Vec::new();
    if is_parallel {
        // The map is affine, so the corners of the picture are enough.
        let [right, lower] = size_px.map(|n| n as f64);
        for [x, y] in [[0.0, 0.0], [right, 0.0], [0.0, lower], [right, lower]] {
            let family = Family::of(rays.direction(x, y));
            need_of(&mut needs, rays, family, is_parallel).add(rays, [x, y], 1.0);
        }
        return needs;
    }
    let row = |y: usize| {
        let mut needs = Vec::new();
        let mut x = 0;
        while x < size_px[0] {
            let [x_px, y_px] = [x as f64 + 0.5, y as f64 + 0.5];
            let (family, n) = rays.families_along_x([x_px, y_px], EVERY.min(size_px[0] - x));
            let need = need_of(&mut needs, rays, family, is_parallel);
            // Along a row, base coordinates go one way.
            need.add(rays, [x_px, y_px], n as f64);
            need.widen(rays, [x_px + (n - 1) as f64, y_px]);
            x += n;
        }
        needs
    };
    for of_row in parallel::map(size_px[1], row).into_iter().flatten() {
        match needs.iter_mut().find(|need: &&mut Need| need.family == of_row.family) {
            Some(need) => need.merge(&of_row),
            None => needs.push(of_row),
        }
    }
    needs
}

/// The entry of a family.
fn need_of<'a>(needs: &'a mut Vec<Need>, rays: &IndexRays, family: Family, is_parallel: bool) -> &'a mut Need {
    let known = needs.iter().position(|need| need.family == family);
    let place = known.unwrap_or_else(|| {
        let spread = Spread::new(&family, rays, is_parallel);
        needs.push(Need {
            family,
            spread,
            range: [DVec2::INFINITY, DVec2::NEG_INFINITY],
            distance: PixelDistance::NONE,
        });
        needs.len() - 1
    });
    &mut needs[place]
}

impl Need {
    /// Adds a pixel position, and how far apart pixels are there, for `n` of them.
    fn add(&mut self, rays: &IndexRays, at_px: [f64; 2], n: f64) {
        self.widen(rays, at_px);
        let [x_px, y_px] = at_px;
        let base = |dx: f64, dy: f64| self.spread.base_from_pixel(&self.family, rays, x_px + dx, y_px + dy);
        // Largest change of p and of q per pixel, in any direction of the picture. Central differences are exact for the
        // affine map and good to second order for the homography.
        let (dx, dy) = (base(0.25, 0.0) - base(-0.25, 0.0), base(0.0, 0.25) - base(0.0, -0.25));
        let distance = PixelDistance::of(DVec2::new(dx.x.hypot(dy.x), dx.y.hypot(dy.y)) * 2.0, n);
        self.distance.merge(&distance);
    }

    /// Adds a pixel position.
    fn widen(&mut self, rays: &IndexRays, [x_px, y_px]: [f64; 2]) {
        let here = self.spread.base_from_pixel(&self.family, rays, x_px, y_px);
        self.range = [self.range[0].min(here), self.range[1].max(here)];
    }

    fn merge(&mut self, other: &Self) {
        self.range = [self.range[0].min(other.range[0]), self.range[1].max(other.range[1])];
        self.distance.merge(&other.distance);
    }

    /// How far apart pixels are, along p and along q.
    ///
    /// Parallel rays have one such distance. In perspective it grows with the slope of the rays, to the double within a
    /// family: texels lie as pixels do on the whole, so that they are as many.
    pub fn pixel_distance(&self) -> DVec2 {
        let PixelDistance { finest, sum, n } = self.distance;
        (sum / n).clamp(finest, COARSER * finest)
    }
}

impl PixelDistance {
    const NONE: Self = Self { finest: DVec2::INFINITY, sum: DVec2::ZERO, n: 0.0 };

    /// That of `n` pixels.
    fn of(distance: DVec2, n: f64) -> Self {
        Self { finest: distance, sum: distance * n, n }
    }

    fn merge(&mut self, other: &Self) {
        self.finest = self.finest.min(other.finest);
        self.sum += other.sum;
        self.n += other.n;
    }
}
