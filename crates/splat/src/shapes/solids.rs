//! Balls and tubes on a base plane: rays meet them where quadratic equations say.
//!
//! With the vector `o` from a centre to a point of the ray and the way `d` of the ray per slice, a ray meets a ball of
//! radius `r` at `t = −o·d / d² ∓ √((r² − p²) / d²)` slices from there, where `p` is the part of `o` across the ray. A
//! tube is made of pieces, each a cylinder with half balls at its ends; the same holds for a cylinder with the parts of
//! `o` and `d` across its axis. The parts across are worked out first, since squares of long vectors would lose the
//! small radius. Where pieces of a path overlap, the rays enter and leave their union
//! ([`crate::shapes::fragments`]).

use glam::{DVec3, Vec3};
use wavesplat_compute::parallel;
use wavesplat_core::{Paint, Paths, Points};

use crate::shapes::canvas::{Canvas, OnPlane, RowRange, SurfacePart, rows_of, vector};
use crate::shapes::cover::Covering;
use crate::shapes::fragments::{ALONE, Crossing};
use crate::shapes::paint::color_at;
use crate::shapes::placement::{NEAR, Placed, PlaneReach, PlaneView};
use crate::shapes::samples::{N, OFFSETS, mask_of, mean_offset};

/// Balls on a base plane.
pub struct BallsOnPlane<'a> {
    points: &'a Points,
    radii: &'a [f64],
    ends: Vec<End>,
}

impl<'a> BallsOnPlane<'a> {
    /// Balls around points.
    pub fn new(points: &'a Points, radii: &'a [f64], view: &PlaneView) -> Self {
        Self { points, radii, ends: ends_of(&points.centers, |k| radii[k], view) }
    }
}

impl OnPlane for BallsOnPlane<'_> {
    fn n_elements(&self) -> usize {
        self.points.centers.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        rows_of_ends(view, [self.ends[element]; 2])
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let center = &self.points.centers[element];
        let piece = Capsule { ends: [center; 2], radius: self.radii[element], on_plane: [self.ends[element]; 2] };
        let Some(rgba) = color_at(&self.points.paint, [element as u32], [1.0]) else { return };
        // Through a cut the wall behind is seen, too.
        let is_opaque = rgba[3] * self.points.style.opacity >= 1.0 && !self.points.style.is_clipped;
        draw_piece::<true>(&piece, is_opaque, canvas, |canvas, hit| {
            let CapsuleHit { texel, at, mask, s, normal, side, is_hidden, .. } = hit;
            if is_hidden {
                return;
            }
            let (normal, covering) = (Some(normal), Covering::Behind);
            let solid = ALONE;
            let surface = SurfacePart { texel, at, mask, s, rgba, normal, side, solid, is_hidden, covering };
            canvas.add(self.points.style, &surface);
        });
    }
}

/// Tubes on a base plane.
pub struct TubesOnPlane<'a> {
    paths: &'a Paths,
    radius: f64,
    /// Numbers of both positions of each piece, and of its solid.
    pieces: Vec<[u32; 3]>,
    ends: Vec<End>,
    covering: Covering,
}

impl<'a> TubesOnPlane<'a> {
    /// Tubes around paths. `first_solid`: number of the first path's solid.
    pub fn new(paths: &'a Paths, radius: f64, first_solid: u32, view: &PlaneView) -> Self {
        let ends = ends_of(&paths.positions, |_| radius, view);
        let pieces = pieces_of(paths, first_solid, |k| ends[k as usize].placed.s);
        // From an eye inside of a piece, or behind a cut, rays also meet walls inside of the solid, which are not seen.
        let is_whole = !paths.style.is_clipped && ends.iter().all(|end| end.reach[0].is_finite());
        let covering = if is_whole && paths.paint.is_opaque() { Covering::Behind } else { Covering::Nothing };
        Self { paths, radius, pieces, ends, covering }
    }

    #[inline(always)]
    fn draw_as<const BALL: bool>(&self, element: usize, canvas: &mut Canvas) {
        let [a, b, solid] = self.pieces[element];
        let style = self.paths.style;
        let piece = Capsule {
            ends: [a, b].map(|k| &self.paths.positions[k as usize]),
            radius: self.radius,
            on_plane: [a, b].map(|k| self.ends[k as usize]),
        };
        // Of opaque tubes, walls behind the first are hidden, whichever piece they belong to.
        let is_opaque = style.opacity >= 1.0 && matches!(self.paths.paint, Paint::Even(_)) && !style.is_clipped;
        draw_piece::<BALL>(&piece, is_opaque, canvas, |canvas, hit| {
            let CapsuleHit { texel, at, mask, s, normal, side, along, is_hidden } = hit;
            let Some(rgba) = color_at(&self.paths.paint, [a, b], [1.0 - along, along]) else { return };
            let (normal, covering) = (Some(normal), self.covering);
            canvas.add(style, &SurfacePart { texel, at, mask, s, rgba, normal, side, solid, is_hidden, covering });
        });
    }
}

/// Pieces of paths: numbers of both positions, and of the path's solid. A path of one position has one piece, from
/// there to there. The nearest paths come first, each from its nearer end on: so pieces that hide others are mostly
/// drawn before them. `place`: of a position, along the ray.
pub fn pieces_of(paths: &Paths, first_solid: u32, place: impl Fn(u32) -> f32) -> Vec<[u32; 3]> {
    let nearest = |ends: &[u32]| (ends[0]..ends[1]).map(&place).fold(f32::INFINITY, f32::min);
    let mut order: Vec<(f32, usize)> = paths.starts.windows(2).map(nearest).zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut pieces = Vec::with_capacity(paths.positions.len());
    for (_, path) in order {
        let (first, end, solid) = (paths.starts[path], paths.starts[path + 1], first_solid + path as u32);
        match end - first {
            0 => {}
            1 => pieces.push([first, first, solid]),
            _ if place(first) <= place(end - 1) => pieces.extend((first..end - 1).map(|k| [k, k + 1, solid])),
            _ => pieces.extend((first..end - 1).rev().map(|k| [k, k + 1, solid])),
        }
    }
    pieces
}

impl OnPlane for TubesOnPlane<'_> {
    fn n_elements(&self) -> usize {
        self.pieces.len()
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        let [a, b, _] = self.pieces[element];
        rows_of_ends(view, [a, b].map(|k| self.ends[k as usize]))
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        let [a, b, _] = self.pieces[element];
        // Of two ends at one place, too, both are right, to the bit.
        if a == b {
            self.draw_as::<true>(element, canvas);
        } else {
            self.draw_as::<false>(element, canvas);
        }
    }
}

/// A cylinder with half balls at its ends; a ball where both ends are one.
struct Capsule<'a> {
    ends: [&'a [f64; 3]; 2],
    radius: f64,
    on_plane: [End; 2],
}

/// An end of a piece on a base plane.
#[derive(Clone, Copy, Default)]
struct End {
    placed: Placed,
    /// Half its size in texels along u and v; infinite around the eye, not a number where it cannot be seen.
    reach: [f32; 2],
}

impl End {
    fn is_unseen(&self) -> bool {
        self.reach[0].is_nan()
    }
}

/// Balls around positions on a base plane.
fn ends_of(positions: &[[f64; 3]], radius: impl Fn(usize) -> f64 + Sync, view: &PlaneView) -> Vec<End> {
    const SOME: usize = 4096;
    let mut ends = vec![End::default(); positions.len()];
    parallel::for_each_chunk(&mut ends, SOME, |first, some| {
        for (k, end) in some.iter_mut().enumerate() {
            let uvw = view.uvw(vector(positions[first * SOME + k]));
            let reach = match view.reach_of_ball(uvw, radius(first * SOME + k)) {
                PlaneReach::Nowhere => [f32::NAN; 2],
                PlaneReach::Within(reach) => reach.map(|reach| reach as f32),
                PlaneReach::Everywhere => [f32::INFINITY; 2],
            };
            *end = End { placed: view.place(uvw), reach };
        }
    });
    ends
}

/// Where a ray meets a piece, on the covered places of a texel.
struct CapsuleHit {
    texel: [usize; 2],
    at: [f32; 2],
    mask: u16,
    s: f32,
    normal: Vec3,
    side: Crossing,
    /// Share of the way from the first end to the second.
    along: f32,
    /// Whether the eye is in the piece, which is entered behind it.
    is_hidden: bool,
}

fn rows_of_ends(view: &PlaneView, ends: [End; 2]) -> RowRange {
    if ends.iter().all(End::is_unseen) {
        return None;
    }
    let Some(reach) = reach_of(ends) else { return rows_of(view, [0.0, view.plane.size[1] as f64]) };
    let of = |k: usize, [a, b]: [f32; 2]| [f64::from(a.min(b)) - reach[k], f64::from(a.max(b)) + reach[k]];
    let [x, y] = [of(0, ends.map(|end| end.placed.x)), of(1, ends.map(|end| end.placed.y))];
    if x[1] < -0.5 || x[0] > view.plane.size[0] as f64 - 0.5 {
        return None;
    }
    rows_of(view, y)
}

/// Half the size of the larger end; `None` where any is around the eye or behind it.
fn reach_of([a, b]: [End; 2]) -> Option<[f64; 2]> {
    let reach = [0, 1].map(|k| f64::from(a.reach[k].max(b.reach[k])));
    let is_known = !a.is_unseen() && !b.is_unseen() && reach[0].is_finite() && reach[1].is_finite();
    is_known.then_some(reach)
}

/// Columns that a chain of two discs reaches in a row. `ends`: texel positions; `reach`: half the discs' sizes.
pub fn columns_in_row(ends: [[f64; 2]; 2], reach: [f64; 2], row: f64) -> [f64; 2] {
    let [a, b] = if ends[0][1] <= ends[1][1] { ends } else { [ends[1], ends[0]] };
    let height = b[1] - a[1];
    // The part of the way whose discs reach the row.
    let shares = [row - 0.5 - reach[1], row + 0.5 + reach[1]]
        .map(|y| if height > 1e-9 { ((y - a[1]) / height).clamp(0.0, 1.0) } else { f64::NAN });
    let [from, to] = if shares[0].is_nan() { [0.0, 1.0] } else { shares };
    let [x, y] = [from, to].map(|share| a[0] + share * (b[0] - a[0]));
    [x.min(y) - reach[0], x.max(y) + reach[0]]
}

/// Calls `with` where rays enter a piece and where they leave it; where it `is_opaque`, leaving counts only if the eye
/// is inside.
#[inline(always)]
fn draw_piece<const BALL: bool>(
    piece: &Capsule<'_>,
    is_opaque: bool,
    canvas: &mut Canvas,
    mut with: impl FnMut(&mut Canvas, CapsuleHit),
) {
    let view = canvas.view;
    let [n_u, n_v] = view.plane.size;
    let reach = reach_of(piece.on_plane);
    let places = piece.on_plane.map(|end| [end.placed.x, end.placed.y].map(f64::from));
    let rows = match reach {
        Some(reach) => {
            let [a, b] = [places[0][1], places[1][1]];
            canvas.own_rows([a.min(b) - reach[1], a.max(b) + reach[1]])
        }
        None => canvas.own_rows([0.0, n_v as f64]),
    };
    // Most pieces are hidden where many lie behind each other, and need no rays.
    let mut rays: Option<CapsuleRays<BALL>> = None;
    // With some slack for rounding.
    let nearest = piece.on_plane[0].placed.s.min(piece.on_plane[1].placed.s)
        - (piece.radius * view.slices_per_unit() * 1.001 + 0.01) as f32;
    let nearest = if reach.is_some() { nearest } else { f32::NEG_INFINITY };
    for j in rows {
        let columns = match reach {
            Some(reach) => canvas.columns(columns_in_row(places, reach, j as f64)),
            None => 0..n_u,
        };
        let mut row = None;
        for i in columns {
            if canvas.is_hidden([i, j], nearest) {
                continue;
            }
            let rays = rays.get_or_insert_with(|| CapsuleRays::new(piece, view));
            let row = row.get_or_insert_with(|| rays.row(j, view));
            let texel = of_texel(row, i);
            let [enter, leave, inside] = rays.masks(texel);
            let leave = if is_opaque { leave & !enter } else { leave };
            let sides =
                [(inside, Crossing::Enter, true), (enter, Crossing::Enter, false), (leave, Crossing::Leave, false)];
            for (mask, side, is_hidden) in sides {
                if mask == 0 {
                    continue;
                }
                let offset = mean_offset(mask);
                let (ray, way) = rays.aside(texel, offset);
                let [enter, leave] = rays.meet(ray.to_array(), way.to_array());
                // Pieces that the eye is in are entered where the rays begin.
                let t = if is_hidden { rays.nearest } else { [enter, leave][usize::from(side == Crossing::Leave)] };
                // The middle of the covered places is covered, but for rounding.
                if t.is_nan() {
                    continue;
                }
                let from_first = ray + way * t;
                let along = (from_first.dot(rays.axis) * rays.per_axis).clamp(0.0, 1.0);
                let at = [i as f32 + offset[0], j as f32 + offset[1]];
                let normal = from_first - rays.axis * along;
                with(canvas, CapsuleHit { texel: [i, j], at, mask, s: rays.s + t, normal, side, along, is_hidden });
            }
        }
    }
}

/// The rays of a base plane as seen from the first end of a piece, which is a `BALL` or has two ends.
struct CapsuleRays<const BALL: bool> {
    /// Vector from that end to where the ray of texel (0, 0) passes its slice, and the change per texel.
    from_end: [DVec3; 3],
    per_texel: [Vec3; 2],
    way_per_texel: [Vec3; 2],
    is_parallel: bool,
    /// Place of that end along the rays.
    s: f32,
    /// From the first end to the second; and its inverse square, 0 for a ball.
    axis: Vec3,
    per_axis: f32,
    radius: f32,
    radius_squared: f32,
    /// How far the rays of a texel are from the ray of its middle, at most, and the change of that per slice.
    spread: [f32; 2],
    /// Place along the rays, less `s`, in front of which nothing is met.
    nearest: f32,
}

impl<const BALL: bool> CapsuleRays<BALL> {
    fn new(piece: &Capsule<'_>, view: &PlaneView) -> Self {
        let ends = piece.ends.map(|end| vector(*end));
        let uvw = view.uvw(ends[0]);
        let from_end = view.from_point(uvw);
        let axis = (ends[1] - ends[0]).as_vec3();
        let square = axis.length_squared();
        let s = uvw[2] * if view.plane.family.ascending { 1.0 } else { -1.0 };
        let per_texel = [from_end[1], from_end[2]].map(|v| v.as_vec3());
        let way_per_texel = view.way_per_texel().map(|v| v.as_vec3());
        // Some more, for rounding.
        let corner = |[u, v]: [Vec3; 2]| 1.1 * 0.5 * (u + v).length().max((u - v).length());
        Self {
            from_end,
            per_texel,
            way_per_texel,
            is_parallel: way_per_texel == [Vec3::ZERO; 2],
            spread: [corner(per_texel), corner(way_per_texel)],
            s: s as f32,
            axis,
            per_axis: if square > 0.0 { 1.0 / square } else { 0.0 },
            radius: piece.radius as f32,
            radius_squared: (piece.radius * piece.radius) as f32,
            nearest: view.eye_s().map_or(f32::NEG_INFINITY, |eye| (eye + NEAR - s) as f32),
        }
    }

    /// Vector from the first end to a point of the ray of a row's first texel, and that ray's way per slice; and the
    /// changes of both per texel of the row.
    #[inline(always)]
    fn row(&self, j: usize, view: &PlaneView) -> [[DVec3; 2]; 2] {
        let first = [self.from_end[0] + self.from_end[2] * j as f64, view.way(0.0, j as f64)];
        [first, [self.from_end[1], view.way_per_texel()[0]]]
    }

    /// Middle and way of a ray beside the texel's own. `offset`: from the middle of the texel.
    #[inline(always)]
    fn aside(&self, (middle, way): (Vec3, Vec3), offset: [f32; 2]) -> (Vec3, Vec3) {
        (
            middle + self.per_texel[0] * offset[0] + self.per_texel[1] * offset[1],
            way + self.way_per_texel[0] * offset[0] + self.way_per_texel[1] * offset[1],
        )
    }

    /// Places of a texel whose rays enter the piece ahead of the eye, that leave it there, and that begin in it.
    #[inline(always)]
    fn masks(&self, (middle, way): (Vec3, Vec3)) -> [u16; 3] {
        let (middle, way) = (middle.to_array(), way.to_array());
        if self.is_off(middle, way) {
            return [0; 3];
        }
        let [enter, leave] =
            if self.is_parallel { self.meet_all::<true>(middle, way) } else { self.meet_all::<false>(middle, way) };
        let [enter, leave] = [enter, leave].map(|of_all| mask_of(of_all.map(|t| t > self.nearest)));
        [enter, leave, leave & !enter]
    }

    /// [`Self::meet`] at all places of a texel. Terms that only depend on the way are worked out once where rays are
    /// `PARALLEL`.
    #[inline(always)]
    fn meet_all<const PARALLEL: bool>(&self, middle: [f32; 3], way: [f32; 3]) -> [[f32; N]; 2] {
        let [per_u, per_v] = self.per_texel.map(|v| v.to_array());
        let [way_u, way_v] = self.way_per_texel.map(|v| v.to_array());
        let [mut enter, mut leave] = [[0.0; N]; 2];
        // Without branches and closures, so that the loop becomes vectors.
        for k in 0..N {
            let (x, y) = (OFFSETS[0][k], OFFSETS[1][k]);
            let (mut ray, mut own_way) = (middle, way);
            for c in 0..3 {
                ray[c] += per_u[c] * x + per_v[c] * y;
                if !PARALLEL {
                    own_way[c] += way_u[c] * x + way_v[c] * y;
                }
            }
            [enter[k], leave[k]] = self.meet(ray, own_way);
        }
        [enter, leave]
    }

    /// Whether a texel's ray passes the piece at more than half a texel.
    #[inline(always)]
    fn is_off(&self, ray: [f32; 3], way: [f32; 3]) -> bool {
        let square = dot(way, way);
        if BALL {
            return self.is_off_by(ray, way, square);
        }
        let axis = self.axis.to_array();
        let (m, n) = (dot(ray, axis) * self.per_axis, dot(way, axis) * self.per_axis);
        let (across, way_across) = (less(ray, axis, m), less(way, axis, n));
        // A ray along the axis is equally near to it everywhere: any place will do.
        let across_square = dot(way_across, way_across).max(1e-10 * square);
        let along = m - dot(across, way_across) / across_square * n;
        if (0.0..=1.0).contains(&along) {
            return self.is_off_by(across, way_across, across_square);
        }
        // Beyond an end, it is the nearest part of the piece.
        self.is_off_by(less(ray, axis, if along < 0.5 { 0.0 } else { 1.0 }), way, square)
    }

    /// The same of a ray and the point that `ray` begins at. `square`: of the way.
    #[inline(always)]
    fn is_off_by(&self, ray: [f32; 3], way: [f32; 3], square: f32) -> bool {
        let middle = -dot(ray, way) / square;
        let nearest = less(ray, way, -middle);
        let limit = self.radius + self.spread[0] + middle.abs() * self.spread[1];
        dot(nearest, nearest) > limit * limit
    }

    /// Slices from the first end to where a ray enters the piece, and to where it leaves it; not a number where it does
    /// not.
    #[inline(always)]
    fn meet(&self, ray: [f32; 3], way: [f32; 3]) -> [f32; 2] {
        let square = dot(way, way);
        if BALL {
            return self.meet_ball(ray, way, square);
        }
        let axis = self.axis.to_array();
        let (m, n) = (dot(ray, axis) * self.per_axis, dot(way, axis) * self.per_axis);
        let (across, way_across) = (less(ray, axis, m), less(way, axis, n));
        // Of a ray along the axis, which never leaves the cylinder, the ends are far beyond it.
        let across_square = dot(way_across, way_across).max(1e-10 * square);
        let middle = -dot(across, way_across) / across_square;
        let nearest = less(across, way_across, -middle);
        let left = (self.radius_squared - dot(nearest, nearest)) / across_square;
        let half = left.max(0.0).sqrt();
        let mut ends = [middle - half, middle + half];
        for k in 0..2 {
            // Where the ray meets the cylinder beyond its ends, the balls there count.
            let along = m + ends[k] * n;
            let first = if along < 0.5 { 0.0 } else { 1.0 };
            let of_ball = self.meet_ball(less(ray, axis, first), way, square)[k];
            ends[k] = if (0.0..=1.0).contains(&along) { ends[k] } else { of_ball };
            ends[k] = if left >= 0.0 { ends[k] } else { f32::NAN };
        }
        ends
    }

    /// The same for a ball around the point that `ray` begins at. `square`: of the way.
    #[inline(always)]
    fn meet_ball(&self, ray: [f32; 3], way: [f32; 3], square: f32) -> [f32; 2] {
        let middle = -dot(ray, way) / square;
        let nearest = less(ray, way, -middle);
        let left = (self.radius_squared - dot(nearest, nearest)) / square;
        let half = if left >= 0.0 { left.max(0.0).sqrt() } else { f32::NAN };
        [middle - half, middle + half]
    }
}

/// Vector from the first end of a piece to a point of the ray of a texel, and the ray's way per slice. For the row,
/// both at its first texel, and their changes per texel ([`CapsuleRays::row`]).
#[inline(always)]
fn of_texel([first, change]: &[[DVec3; 2]; 2], i: usize) -> (Vec3, Vec3) {
    let [middle, way] = [0, 1].map(|k| (first[k] + change[k] * i as f64).as_vec3());
    (middle, way)
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a − b · share`.
#[inline(always)]
fn less(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    [a[0] - b[0] * share, a[1] - b[1] * share, a[2] - b[2] * share]
}
