//! Shapes as the ray caster meets them: analytically, in double precision.
//!
//! A ray is dimmed by the opacity of every surface that it passes, whatever the angle: once by a triangle, a card, a
//! disc or a stroke, and twice by a ball or a tube, which it enters and leaves.

mod box_tree;
mod paint;
mod pixel_sized;
mod shape_ray;
mod solids;
mod surfaces;

use std::sync::LazyLock;

use glam::{DAffine3, DVec3};
use wavesplat_core::{Camera, ClipPlane, Crop, Mesh, Paths, Points, RenderOptions, Shading, ShapeStyle};
use wavesplat_core::{Card, Sizes, Thickness};

use self::pixel_sized::{Discs, Strokes};
use self::shape_ray::{Met, PixelView, ShapeRay};
use self::solids::{Balls, Tubes};
use self::surfaces::{Triangles, meet_card};
use super::lights::Lights;

/// Light of shapes where no volume is lit.
static HEADLIGHT: LazyLock<Shading> = LazyLock::new(Shading::headlight);

/// A surface on the way of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Ray parameter.
    pub t: f64,
    /// Straight colour, after light.
    pub rgb: [f64; 3],
    pub opacity: f64,
}

enum Surface<'a> {
    Triangles(Triangles<'a>),
    Tubes(Tubes<'a>),
    Strokes(Strokes<'a>),
    Balls(Balls<'a>),
    Discs(Discs<'a>),
    Card(&'a Card),
}

/// The shapes of a picture.
pub(super) struct CastShapes<'a> {
    surfaces: Vec<(Surface<'a>, ShapeStyle)>,
    view: PixelView<'a>,
    lights: Lights<'a>,
    /// Index positions of the first volume, in which a crop box may stand.
    first_from_world: DAffine3,
    crop: Option<Crop>,
    clip_planes: &'a [ClipPlane],
}

impl<'a> CastShapes<'a> {
    /// The shapes of the options as a camera sees them. `slices_from_world`: the index space whose slices discs and
    /// strokes lie in.
    pub fn new(
        options: &'a RenderOptions,
        camera: &'a Camera,
        shading: Option<&'a Shading>,
        first_from_world: DAffine3,
        slices_from_world: DAffine3,
    ) -> Self {
        let size_px = [options.width_px, options.height_px];
        let view = PixelView { camera, size_px, index_from_world: slices_from_world };
        let shapes = &*options.shapes;
        let of_mesh = |mesh: &'a Mesh| (Surface::Triangles(Triangles::new(mesh)), mesh.style);
        let of_paths = |paths: &'a Paths| {
            let surface = match paths.thickness {
                Thickness::Radius(radius) => Surface::Tubes(Tubes::new(paths, radius)),
                Thickness::WidthPx(width) => Surface::Strokes(Strokes::new(paths, width, view)),
            };
            (surface, paths.style)
        };
        let of_points = |points: &'a Points| {
            let surface = match &points.sizes {
                Sizes::Radii(radii) => Surface::Balls(Balls::new(points, radii)),
                Sizes::DiametersPx(diameters) => Surface::Discs(Discs::new(points, diameters, view)),
            };
            (surface, points.style)
        };
        let mut surfaces: Vec<_> = shapes.meshes().iter().map(of_mesh).collect();
        surfaces.extend(shapes.paths().iter().map(of_paths));
        surfaces.extend(shapes.points().iter().map(of_points));
        surfaces.extend(shapes.cards().iter().map(|card| (Surface::Card(card), card.style)));
        Self {
            surfaces,
            view,
            lights: Lights::new(shading.unwrap_or(&HEADLIGHT), camera),
            first_from_world,
            crop: options.crop,
            clip_planes: &options.clip_planes,
        }
    }

    /// Whether there are no shapes.
    pub fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
    }

    /// The surfaces on the way of the ray through a pixel position, front to back.
    pub fn hits(&self, pixel: [f64; 2]) -> Vec<Hit> {
        let mut hits = Vec::new();
        if self.is_empty() {
            return hits;
        }
        let ray = ShapeRay::new(self.view, pixel);
        for (surface, style) in &self.surfaces {
            let is_seen = |t: f64| t > ray.start && !(style.is_clipped && self.cuts_off(ray.at(t)));
            let mut add = |met: Met| {
                if is_seen(met.t) {
                    hits.push(self.hit(&ray, &met, *style));
                }
            };
            match surface {
                Surface::Triangles(triangles) => triangles.meet(&ray, &mut add),
                Surface::Tubes(tubes) => tubes.meet(&ray, &mut add),
                Surface::Strokes(strokes) => strokes.meet(&ray, is_seen, &mut add),
                Surface::Balls(balls) => balls.meet(&ray, &mut add),
                Surface::Discs(discs) => discs.meet(&ray, &mut add),
                Surface::Card(card) => meet_card(card, &ray).into_iter().for_each(add),
            }
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        hits
    }

    /// A surface with its style, in the light of the picture.
    fn hit(&self, ray: &ShapeRay, met: &Met, style: ShapeStyle) -> Hit {
        let [r, g, b, alpha] = met.rgba;
        let to_eye = -ray.direction.normalize();
        let rgb = match met.normal {
            Some(normal) if style.is_lit => self.lights.on_surface([r, g, b], normal, to_eye),
            _ => [r, g, b],
        };
        Hit { t: met.t, rgb, opacity: f64::from(style.opacity) * alpha }
    }

    /// Whether a position is outside of the crop box or behind a clip plane.
    fn cuts_off(&self, position: DVec3) -> bool {
        let is_in_crop = match self.crop {
            Some(Crop::Index { lo, hi }) => {
                let index = self.first_from_world.transform_point3(position);
                index.cmpge(lo).all() && index.cmple(hi).all()
            }
            Some(Crop::World { lo, hi }) => position.cmpge(lo).all() && position.cmple(hi).all(),
            None => true,
        };
        !is_in_crop || self.clip_planes.iter().any(|plane| (position - plane.origin).dot(plane.normal) < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use glam::DVec2;

    /// A point with coordinates between -1 and 1.
    pub fn random_point(k: usize) -> DVec3 {
        DVec3::from_array(
            [0, 1, 2].map(|c| 2.0 * (((3 * k + c) as f64 * 12.9898).sin() * 43758.5453).rem_euclid(1.0) - 1.0),
        )
    }

    /// A ray without a picture.
    pub fn ray(origin: DVec3, direction: DVec3) -> ShapeRay {
        ShapeRay { origin, direction, pixel: DVec2::ZERO, start: f64::NEG_INFINITY, slice: DVec3::Z }
    }
}
