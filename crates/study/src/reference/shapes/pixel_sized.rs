//! Discs and strokes, which have a size in pixels: they are met where the pixel position of a ray is near their
//! projection, in the slice of the volume through the projected point.

use glam::{DVec2, DVec3};
use wavesplat_core::{Paths, Points};

use super::box_tree::BoxTree;
use super::paint::color;
use super::shape_ray::{Met, PixelView, ShapeRay};
use super::solids::{PathPiece, pieces};

/// Depth from which on strokes are drawn, as a share of the depth of their further end: they have no projection where
/// they pass the eye.
const NEAR: f64 = 1e-6;

/// The box around what is near pixel positions, for the line through a pixel position along the third axis.
fn box_around(positions: &[DVec2], reach: f64) -> [DVec3; 2] {
    let corner = |start: f64, merge: fn(DVec2, DVec2) -> DVec2, reach: f64| {
        (positions.iter().fold(DVec2::splat(start), |corner, at| merge(corner, *at)) + reach).extend(0.0)
    };
    [corner(f64::INFINITY, DVec2::min, -reach), corner(f64::NEG_INFINITY, DVec2::max, reach)]
}

/// Discs around points.
pub(super) struct Discs<'a> {
    points: &'a Points,
    shown: Vec<Disc>,
    tree: BoxTree,
}

struct Disc {
    point: usize,
    centre_px: DVec2,
    radius_px: f64,
}

impl<'a> Discs<'a> {
    /// Discs of these diameters in pixels.
    pub fn new(points: &'a Points, diameters_px: &[f64], view: PixelView) -> Self {
        let mut discs = Vec::new();
        for (point, (centre, diameter_px)) in points.centers.iter().zip(diameters_px).enumerate() {
            let centre = DVec3::from_array(*centre);
            if !view.has_eye() || view.depth(centre) > 0.0 {
                discs.push(Disc { point, centre_px: view.project(centre), radius_px: 0.5 * diameter_px });
            }
        }
        let boxes: Vec<_> = discs.iter().map(|disc| box_around(&[disc.centre_px], disc.radius_px)).collect();
        Self { points, shown: discs, tree: BoxTree::new(&boxes) }
    }

    /// Calls `add` for every disc over the pixel position of a ray.
    pub fn meet(&self, ray: &ShapeRay, add: &mut impl FnMut(Met)) {
        self.tree.for_each_met(ray.pixel.extend(0.0), DVec3::Z, |k| {
            let disc = &self.shown[k];
            if ray.pixel.distance(disc.centre_px) <= disc.radius_px
                && let Some(rgba) = color(&self.points.paint, &[(disc.point, 1.0)])
            {
                let t = ray.at_slice_of(DVec3::from_array(self.points.centers[disc.point]));
                add(Met { t, normal: None, rgba });
            }
        });
    }
}

/// Strokes along paths.
pub(super) struct Strokes<'a> {
    paths: &'a Paths,
    width_px: f64,
    has_eye: bool,
    shown: Vec<Stroke>,
    tree: BoxTree,
}

/// The part of a piece in front of the eye.
struct Stroke {
    piece: PathPiece,
    /// Shares of the way along the piece at which the part begins and ends.
    shares: [f64; 2],
    depths: [f64; 2],
    ends_px: [DVec2; 2],
}

impl<'a> Strokes<'a> {
    /// Strokes of this width in pixels.
    pub fn new(paths: &'a Paths, width_px: f64, view: PixelView) -> Self {
        let strokes: Vec<_> = pieces(paths).into_iter().filter_map(|piece| Stroke::new(paths, piece, view)).collect();
        let boxes: Vec<_> = strokes.iter().map(|stroke| box_around(&stroke.ends_px, 0.5 * width_px)).collect();
        Self { paths, width_px, has_eye: view.has_eye(), shown: strokes, tree: BoxTree::new(&boxes) }
    }

    /// Calls `add` for the nearest place of every path over the pixel position of a ray, of those that are seen.
    pub fn meet(&self, ray: &ShapeRay, is_seen: impl Fn(f64) -> bool, add: &mut impl FnMut(Met)) {
        let mut nearest: Vec<(usize, Met)> = Vec::new();
        self.tree.for_each_met(ray.pixel.extend(0.0), DVec3::Z, |k| {
            let stroke = &self.shown[k];
            let Some(share) = stroke.share_near(ray.pixel, 0.5 * self.width_px, self.has_eye) else { return };
            let [first, second] = stroke.piece.ends;
            let [a, b] = stroke.piece.ends.map(|k| DVec3::from_array(self.paths.positions[k]));
            let t = ray.at_slice_of(a + (b - a) * share);
            let rgba = color(&self.paths.paint, &[(first, 1.0 - share), (second, share)]).unwrap_or_default();
            let met = Met { t, normal: None, rgba };
            match nearest.iter_mut().find(|(path, _)| *path == stroke.piece.path) {
                _ if !is_seen(t) => {}
                Some((_, other)) if t < other.t => *other = met,
                Some(_) => {}
                None => nearest.push((stroke.piece.path, met)),
            }
        });
        for (_, met) in nearest {
            add(met);
        }
    }
}

impl Stroke {
    /// The part of a piece in front of the eye; `None` where there is none.
    fn new(paths: &Paths, piece: PathPiece, view: PixelView) -> Option<Self> {
        let ends = piece.ends.map(|k| DVec3::from_array(paths.positions[k]));
        let depths = ends.map(|end| view.depth(end));
        let mut shares = [0.0, 1.0];
        if view.has_eye() {
            let near = NEAR * depths[0].max(depths[1]);
            if near <= 0.0 {
                return None;
            }
            for k in 0..2 {
                if depths[k] < near {
                    shares[k] = (near - depths[0]) / (depths[1] - depths[0]);
                }
            }
        }
        let at = shares.map(|share| ends[0] + (ends[1] - ends[0]) * share);
        let depths = shares.map(|share| depths[0] + (depths[1] - depths[0]) * share);
        Some(Self { piece, shares, depths, ends_px: at.map(|end| view.project(end)) })
    }

    /// Share of the way along the piece of its point whose projection is nearest to a pixel position; `None` where that
    /// is further than `reach`.
    fn share_near(&self, pixel: DVec2, reach: f64, has_eye: bool) -> Option<f64> {
        let [a, b] = self.ends_px;
        let along = b - a;
        let in_picture = if along == DVec2::ZERO {
            // Seen along itself: its nearer end hides the rest.
            if self.depths[0] <= self.depths[1] { 0.0 } else { 1.0 }
        } else {
            ((pixel - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
        };
        if pixel.distance(a + along * in_picture) > reach {
            return None;
        }
        let [first, second] = self.depths;
        // Of a point on a line, 1 / depth changes evenly in the picture.
        let in_space = if has_eye { in_picture * first / (second + (first - second) * in_picture) } else { in_picture };
        Some(self.shares[0] + (self.shares[1] - self.shares[0]) * in_space)
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use wavesplat_core::{Camera, Paint, Projection, ShapeStyle, Sizes, Thickness};

    use super::super::tests::random_point;
    use super::*;

    const SIZE_PX: [usize; 2] = [90, 60];

    fn camera(projection: Projection) -> Camera {
        Camera::new(DVec3::new(3.0, -20.0, 5.0), DVec3::new(1.0, 2.0, 0.5), DVec3::Z, projection).unwrap()
    }

    const PROJECTIONS: [Projection; 2] =
        [Projection::Orthographic { parallel_scale: 9.0 }, Projection::Perspective { view_angle_rad: 0.9 }];

    fn ray(view: PixelView, pixel: DVec2) -> ShapeRay {
        ShapeRay::new(view, pixel.to_array())
    }

    #[test]
    fn rays_pass_through_the_points_of_their_pixels() {
        for projection in PROJECTIONS {
            let camera = camera(projection);
            let view = PixelView { camera: &camera, size_px: SIZE_PX, index_from_world: DAffine3::IDENTITY };
            for k in 0..100 {
                let point = 6.0 * random_point(k);
                let ray = ray(view, view.project(point));
                let t = ray.at_slice_of(point);
                assert!(ray.at(t).distance(point) < 1e-9, "{projection:?}");
            }
        }
    }

    #[test]
    fn discs_are_round_and_flat() {
        let camera = camera(PROJECTIONS[1]);
        // In these index positions the slices that rays of this camera cross are planes of constant y + z.
        let shear = DAffine3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let view = PixelView { camera: &camera, size_px: SIZE_PX, index_from_world: shear };
        let points = Points {
            centers: vec![[1.0, 2.0, 3.0], [3.0, -30.0, 5.0]],
            sizes: Sizes::DiametersPx(vec![12.0, 1000.0]),
            paint: Paint::Even([0.0, 1.0, 0.0]),
            style: ShapeStyle::default(),
        };
        let discs = Discs::new(&points, &[12.0, 1000.0], view);
        let centre_px = view.project(DVec3::new(1.0, 2.0, 3.0));
        for k in 0..100 {
            let ray = ray(view, centre_px + 8.0 * random_point(k).truncate());
            let mut hits = Vec::new();
            discs.meet(&ray, &mut |met| hits.push(met));
            // The other one lies behind the eye.
            assert_eq!(hits.len(), usize::from(ray.pixel.distance(centre_px) <= 6.0));
            for hit in hits {
                let at = ray.at(hit.t);
                assert!((at.y + at.z - 5.0).abs() < 1e-9, "{at}");
                assert!(hit.normal.is_none() && hit.rgba == [0.0, 1.0, 0.0, 1.0]);
            }
        }
    }

    /// Distances of pixels from densely sampled pieces, with the depth and the colour of the nearest sample.
    #[test]
    fn strokes_are_near_their_pieces() {
        const WIDTH: f64 = 6.0;
        for projection in PROJECTIONS {
            let camera = camera(projection);
            let view = PixelView { camera: &camera, size_px: SIZE_PX, index_from_world: DAffine3::IDENTITY };
            // The last piece runs past the eye, and its end lies behind it.
            let positions: Vec<[f64; 3]> = (0..7).map(|k| (6.0 * random_point(k)).to_array()).collect();
            let positions = [positions, vec![[3.5, -25.0, 5.0]]].concat();
            let paths = Paths {
                starts: vec![0, 4, 8],
                thickness: Thickness::WidthPx(WIDTH),
                paint: Paint::Each((0..8).map(|k| [k as f32 / 8.0, 0.0, 0.0, 1.0]).collect()),
                style: ShapeStyle::default(),
                positions,
            };
            let strokes = Strokes::new(&paths, WIDTH, view);
            let samples_of = |path: usize| {
                let between = move |k: usize| (0..4000).map(move |s| (k, f64::from(s) / 4000.0));
                (4 * path..4 * path + 3).flat_map(between).collect::<Vec<_>>()
            };
            let at = |(k, share): (usize, f64)| {
                let [a, b] = [k, k + 1].map(|k| DVec3::from_array(paths.positions[k]));
                a + (b - a) * share
            };
            let (mut n_hits, mut n_rim) = (0, 0);
            for k in 0..200 {
                let ray =
                    ray(view, DVec2::new(90.0 * (f64::from(k) * 0.618).fract(), 60.0 * (f64::from(k) * 0.755).fract()));
                let mut hits = Vec::new();
                strokes.meet(&ray, |t| t > ray.start, &mut |met| hits.push(met));
                let mut n_want = 0;
                for path in 0..2 {
                    // The nearest sample of each piece, if near enough, and of these the one at the least depth.
                    let mut want: Option<(f64, f64, f64)> = None;
                    for piece in 4 * path..4 * path + 3 {
                        let seen = samples_of(path).into_iter().filter(|(k, _)| *k == piece);
                        let seen = seen.filter(|sample| !view.has_eye() || view.depth(at(*sample)) > 1e-3);
                        let with_distance = seen.map(|sample| (view.project(at(sample)).distance(ray.pixel), sample));
                        let Some((distance, sample)) = with_distance.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                            continue;
                        };
                        let t = ray.at_slice_of(at(sample));
                        if distance <= WIDTH / 2.0 && want.is_none_or(|(other, ..)| t < other) {
                            want = Some((t, (sample.0 as f64 + sample.1) / 8.0, distance));
                        }
                    }
                    let Some((t, red, distance)) = want else { continue };
                    n_want += 1;
                    // At the rim, samples decide otherwise than lines.
                    if let Some(hit) = hits.iter().find(|hit| (hit.rgba[0] - red).abs() < 1e-3) {
                        let error = (hit.t - t) * ray.direction.length();
                        assert!(error.abs() < 0.02, "{projection:?}: {} {t}", hit.t);
                    } else {
                        assert!(distance > WIDTH / 2.0 - 0.1, "{projection:?}: {distance}");
                        n_rim += 1;
                    }
                }
                n_hits += hits.len();
                assert!(hits.len().abs_diff(n_want) <= 1);
            }
            assert!(n_hits > 15 && n_rim < 5, "{n_hits} {n_rim}");
        }
    }
}
