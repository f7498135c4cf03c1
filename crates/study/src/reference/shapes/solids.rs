//! Balls and tubes: where a ray enters and leaves them.
//!
//! The capsule of a piece, all points within a radius of it, is the union of a cylinder and two balls, and convex, as
//! these are: a ray is in it from the first to the last point at which it is in one of the three. A tube is the union
//! of the capsules of a path.

use glam::DVec3;
use wavesplat_core::{Paths, Points};

use super::box_tree::BoxTree;
use super::paint::{color, has_colors};
use super::shape_ray::{Met, ShapeRay};

/// Balls around points.
pub(super) struct Balls<'a> {
    points: &'a Points,
    radii: &'a [f64],
    tree: BoxTree,
}

/// Tubes along paths.
pub(super) struct Tubes<'a> {
    paths: &'a Paths,
    radius: f64,
    pieces: Vec<PathPiece>,
    tree: BoxTree,
}

/// A straight piece of a path between two positions, by their numbers.
#[derive(Clone, Copy)]
pub(super) struct PathPiece {
    pub path: usize,
    pub ends: [usize; 2],
}

/// The pieces of paths that have colours; a path of one position is a piece without length.
pub(super) fn pieces(paths: &Paths) -> Vec<PathPiece> {
    let mut pieces = Vec::new();
    for (path, of_path) in paths.starts.windows(2).enumerate() {
        let [first, end] = [of_path[0] as usize, of_path[1] as usize];
        if end == first + 1 {
            pieces.push(PathPiece { path, ends: [first; 2] });
        }
        pieces.extend((first + 1..end).map(|k| PathPiece { path, ends: [k - 1, k] }));
    }
    pieces.retain(|piece| has_colors(&paths.paint, &piece.ends));
    pieces
}

impl<'a> Balls<'a> {
    /// Balls of these radii.
    pub fn new(points: &'a Points, radii: &'a [f64]) -> Self {
        let bounds = |(at, radius): (&[f64; 3], &f64)| {
            let centre = DVec3::from_array(*at);
            [centre - *radius, centre + *radius]
        };
        let boxes: Vec<_> = points.centers.iter().zip(radii).map(bounds).collect();
        Self { points, radii, tree: BoxTree::new(&boxes) }
    }

    /// Calls `add` for the entry and the exit of every ball that a ray passes.
    pub fn meet(&self, ray: &ShapeRay, add: &mut impl FnMut(Met)) {
        self.tree.for_each_met(ray.origin, ray.direction, |k| {
            let centre = DVec3::from_array(self.points.centers[k]);
            let (Some(ends), Some(rgba)) = (ball(ray, centre, self.radii[k]), color(&self.points.paint, &[(k, 1.0)]))
            else {
                return;
            };
            for t in ends {
                add(Met { t, normal: Some((ray.at(t) - centre) / self.radii[k]), rgba });
            }
        });
    }
}

impl<'a> Tubes<'a> {
    /// Tubes of this radius.
    pub fn new(paths: &'a Paths, radius: f64) -> Self {
        let pieces = pieces(paths);
        let bounds = |piece: &PathPiece| {
            let [a, b] = piece.ends.map(|k| DVec3::from_array(paths.positions[k]));
            [a.min(b) - radius, a.max(b) + radius]
        };
        let tree = BoxTree::new(&pieces.iter().map(bounds).collect::<Vec<_>>());
        Self { paths, radius, pieces, tree }
    }

    /// Calls `add` for every entry and exit of a ray that passes tubes.
    pub fn meet(&self, ray: &ShapeRay, add: &mut impl FnMut(Met)) {
        let mut inside = Vec::new();
        self.tree.for_each_met(ray.origin, ray.direction, |k| {
            if let Some([t_in, t_out]) = capsule(ray, self.ends(k), self.radius) {
                inside.push((self.pieces[k].path, [(t_in, k), (t_out, k)]));
            }
        });
        inside.sort_by(|(path, [(a, _), _]), (other, [(b, _), _])| path.cmp(other).then(a.total_cmp(b)));
        let mut unions: Vec<(usize, [(f64, usize); 2])> = Vec::new();
        for (path, [from, to]) in inside {
            match unions.last_mut() {
                Some((same, [_, end])) if *same == path && from.0 <= end.0 => {
                    if to.0 > end.0 {
                        *end = to;
                    }
                }
                _ => unions.push((path, [from, to])),
            }
        }
        for (t, k) in unions.into_iter().flat_map(|(_, ends)| ends) {
            add(self.surface(ray, t, k));
        }
    }

    /// Positions of the ends of a piece.
    fn ends(&self, piece: usize) -> [DVec3; 2] {
        self.pieces[piece].ends.map(|k| DVec3::from_array(self.paths.positions[k]))
    }

    /// The surface of the capsule of a piece at a place of a ray.
    fn surface(&self, ray: &ShapeRay, t: f64, piece: usize) -> Met {
        let [a, b] = self.ends(piece);
        let [first, second] = self.pieces[piece].ends;
        let share = share_along(a, b, ray.at(t));
        let normal = (ray.at(t) - (a + (b - a) * share)) / self.radius;
        // Pieces without colour were left out.
        let rgba = color(&self.paths.paint, &[(first, 1.0 - share), (second, share)]).unwrap_or_default();
        Met { t, normal: Some(normal), rgba }
    }
}

/// Share of the way from `a` to `b` at which a piece is nearest to a point; 0 of a piece without length.
fn share_along(a: DVec3, b: DVec3, point: DVec3) -> f64 {
    let along = b - a;
    if along == DVec3::ZERO { 0.0 } else { ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) }
}

/// Entry and exit of a ball.
fn ball(ray: &ShapeRay, centre: DVec3, radius: f64) -> Option<[f64; 2]> {
    within(ray.origin - centre, ray.direction, radius)
}

/// Entry and exit of the capsule of a piece.
fn capsule(ray: &ShapeRay, [a, b]: [DVec3; 2], radius: f64) -> Option<[f64; 2]> {
    let parts = [ball(ray, a, radius), ball(ray, b, radius), cylinder(ray, [a, b], radius)];
    parts.into_iter().flatten().reduce(|[from, to], [t_in, t_out]| [from.min(t_in), to.max(t_out)])
}

/// Entry and exit of a cylinder with flat ends.
fn cylinder(ray: &ShapeRay, [a, b]: [DVec3; 2], radius: f64) -> Option<[f64; 2]> {
    let axis = (b - a).try_normalize()?;
    let across = |v: DVec3| v - axis * v.dot(axis);
    let [mut from, mut to] = within(across(ray.origin - a), across(ray.direction), radius)?;
    let speed = ray.direction.dot(axis);
    let (height, length) = ((ray.origin - a).dot(axis), (b - a).length());
    if speed == 0.0 {
        return (0.0..=length).contains(&height).then_some([from, to]);
    }
    let ends = [-height / speed, (length - height) / speed];
    from = from.max(ends[0].min(ends[1]));
    to = to.min(ends[0].max(ends[1]));
    (from < to).then_some([from, to])
}

/// Interval of `t` in which `origin + t · direction` is within a distance of 0.
fn within(origin: DVec3, direction: DVec3, distance: f64) -> Option<[f64; 2]> {
    let speed_squared = direction.length_squared();
    if speed_squared == 0.0 {
        return (origin.length() < distance).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    // From the nearest point, not from the origin, which may be far away: the roots of the usual quadratic cancel.
    let nearest = -origin.dot(direction) / speed_squared;
    let half_squared = (distance * distance - (origin + direction * nearest).length_squared()) / speed_squared;
    (half_squared > 0.0).then(|| [nearest - half_squared.sqrt(), nearest + half_squared.sqrt()])
}

#[cfg(test)]
mod tests {
    use super::super::tests::{random_point, ray};
    use super::*;

    #[test]
    fn a_ray_through_the_centre_of_a_ball_meets_it_at_its_radius() {
        for k in 0..100 {
            let (centre, direction) = (1e3 * random_point(2 * k), random_point(2 * k + 1));
            let radius = 0.1 + k as f64;
            let [t_in, t_out] = ball(&ray(centre - direction * 50.0, direction), centre, radius).unwrap();
            let half = radius / direction.length();
            assert!((t_in - (50.0 - half)).abs() < 1e-9 && (t_out - (50.0 + half)).abs() < 1e-9, "{t_in} {t_out}");
            let aside = direction.any_orthogonal_vector().normalize() * radius;
            assert_eq!(ball(&ray(centre + 1.001 * aside, direction), centre, radius), None);
            assert!(ball(&ray(centre + 0.999 * aside, direction), centre, radius).is_some());
        }
    }

    /// Entry and exit by walking along the ray in small steps, and asking for the distance from the pieces.
    fn walked(ray: &ShapeRay, ends: &[[DVec3; 2]], radius: f64, step: f64) -> Vec<[f64; 2]> {
        let is_inside = |t: f64| {
            let p = ray.at(t);
            ends.iter().any(|[a, b]| p.distance(*a + (*b - *a) * share_along(*a, *b, p)) < radius)
        };
        let mut found: Vec<[f64; 2]> = Vec::new();
        let mut was_inside = false;
        for k in 0..(20.0 / step) as usize {
            let t = -10.0 + k as f64 * step;
            let is_inside = is_inside(t);
            match found.last_mut() {
                Some(last) if was_inside => last[1] = t,
                _ if is_inside => found.push([t, t]),
                _ => {}
            }
            was_inside = is_inside;
        }
        found
    }

    #[test]
    fn capsules_hold_the_points_near_a_piece() {
        const STEP: f64 = 1e-3;
        let (mut n_met, mut n_missed) = (0, 0);
        for k in 0..300 {
            let a = 2.0 * random_point(4 * k);
            // Also without length, and along the ray or across it.
            let direction = random_point(4 * k + 1).normalize();
            let along = match k % 5 {
                0 => DVec3::ZERO,
                1 => direction,
                2 => direction.any_orthogonal_vector(),
                _ => 3.0 * random_point(4 * k + 2),
            };
            let (ends, ray) = ([a, a + along], ray(a + 0.5 * along + 0.8 * random_point(4 * k + 3), direction));
            let radius = 0.2 + 0.01 * (k % 70) as f64;
            let walked = walked(&ray, &[ends], radius, STEP);
            let got = capsule(&ray, ends, radius);
            if walked.is_empty() {
                // Between two steps a ray may touch.
                assert!(got.is_none_or(|[from, to]| to - from < STEP), "{k}");
                n_missed += 1;
                continue;
            }
            let [from, to] = got.unwrap();
            assert_eq!(walked.len(), 1);
            assert!(
                (from - walked[0][0]).abs() <= STEP && (to - walked[0][1]).abs() <= STEP,
                "{k}: {walked:?} {got:?}"
            );
            n_met += 1;
        }
        assert!(n_met > 80 && n_missed > 20, "{n_met} {n_missed}");
    }

    #[test]
    fn tubes_are_unions_of_their_capsules() {
        const STEP: f64 = 1e-3;
        let positions: Vec<[f64; 3]> = (0..40).map(|k| (2.0 * random_point(k)).to_array()).collect();
        let colors = (0..40).map(|k| [k as f32 / 40.0, 0.0, 1.0, 1.0]).collect();
        let paths = Paths {
            positions,
            starts: vec![0, 6, 7, 7, 40],
            thickness: wavesplat_core::Thickness::Radius(0.3),
            paint: wavesplat_core::Paint::Each(colors),
            style: wavesplat_core::ShapeStyle::default(),
        };
        let tubes = Tubes::new(&paths, 0.3);
        assert_eq!(tubes.pieces.len(), 5 + 1 + 32);
        let (mut n_hits, mut n_several, mut n_too_fine) = (0, 0, 0);
        for k in 0..200 {
            let ray = ray(random_point(100 + 2 * k), random_point(101 + 2 * k).normalize());
            let mut got = Vec::new();
            tubes.meet(&ray, &mut |met| got.push(met));
            let mut want = Vec::new();
            for path in [0, 1, 3] {
                let of_path: Vec<_> =
                    (0..38).filter(|piece| tubes.pieces[*piece].path == path).map(|piece| tubes.ends(piece)).collect();
                want.extend(walked(&ray, &of_path, 0.3, STEP));
            }
            // Gaps and overlaps shorter than a step are not seen by walking.
            let found: Vec<[f64; 2]> = got.chunks(2).map(|ends| [ends[0].t, ends[1].t]).collect();
            let is_short = found.iter().any(|[from, to]| to - from < 2.0 * STEP);
            if is_short || found.len() != want.len() {
                n_too_fine += 1;
                continue;
            }
            for (found, want) in found.iter().zip(&want) {
                assert!((0..2).all(|end| (found[end] - want[end]).abs() <= STEP), "{k}: {found:?} {want:?}");
            }
            for met in &got {
                assert!((met.normal.unwrap().length() - 1.0).abs() < 1e-9);
            }
            n_hits += got.len();
            n_several += usize::from(found.len() > 2);
        }
        assert!(n_hits > 500 && n_several > 50 && n_too_fine < 10, "{n_hits} {n_several} {n_too_fine}");
    }
}
