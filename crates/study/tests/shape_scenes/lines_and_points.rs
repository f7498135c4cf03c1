//! Scenes of balls, discs, tubes and strokes, and of all kinds of shapes together.

use glam::DVec3;
use wavesplat_core::Thickness::{Radius, WidthPx};
use wavesplat_core::{ClipPlane, Paint, Paths, Points, RenderOptions, ShapeStyle, Shapes, Sizes, Thickness};
use wavesplat_testkit::shapes::{balls, of_paths, of_points, paths, sheet_mesh, sphere_mesh};

use super::Edges::{Hard, Soft};
use super::{CENTRE, EYE, ShapeScene, ball, colors, heights, sheared, style};

pub fn scenes() -> Vec<ShapeScene> {
    let mut scenes = Vec::new();
    scenes.extend(of_balls());
    scenes.extend(of_discs());
    scenes.extend(of_tubes());
    scenes.extend(of_strokes());
    scenes.extend(of_all_kinds());
    scenes
}

/// A number between 0 and 1.
fn random(k: usize) -> f64 {
    ((k as f64 * 12.9898).sin() * 43758.5453).rem_euclid(1.0)
}

/// A place up to 10 around the centre.
fn place(k: usize) -> DVec3 {
    CENTRE + 20.0 * (DVec3::new(random(3 * k), random(3 * k + 1), random(3 * k + 2)) - 0.5)
}

/// Balls of several sizes and colours, some of which cross.
fn many_balls(n: usize, opacity: f32) -> Points {
    let places: Vec<(DVec3, f64)> = (0..n).map(|k| (place(k), 0.5 + 2.5 * random(7 * k + 1))).collect();
    let points = Points { style: style(opacity), ..balls(&places) };
    Points { paint: colors(&points.centers, 1.0), ..points }
}

fn of_balls() -> Vec<ShapeScene> {
    let clipped = || {
        let style = ShapeStyle { is_clipped: true, ..ShapeStyle::default() };
        of_points(vec![Points { style, ..many_balls(30, 1.0) }])
    };
    vec![
        ShapeScene::new("balls", Hard, of_points(vec![many_balls(30, 1.0)])),
        ShapeScene::new("balls in hard matter, perspective", Hard, of_points(vec![many_balls(30, 1.0)]))
            .in_hard_matter()
            .in_perspective(),
        ShapeScene::new("translucent balls", Soft, of_points(vec![many_balls(6, 0.1)])),
        ShapeScene::new("translucent balls around the eye", Hard, of_points(vec![many_balls(24, 0.7)]))
            .seen_from_inside(),
        ShapeScene::new("balls on a sheared grid", Hard, of_points(vec![many_balls(30, 1.0)]))
            .in_volume(ball(sheared())),
        ShapeScene::new("clipped balls", Hard, clipped()).with_options(cut),
    ]
}

/// Discs of several sizes.
fn discs(n: usize, opacity: f32) -> Points {
    let sizes = Sizes::DiametersPx((0..n).map(|k| 3.0 + 9.0 * random(5 * k + 2)).collect());
    Points { sizes, ..many_balls(n, opacity) }
}

fn of_discs() -> Vec<ShapeScene> {
    vec![
        ShapeScene::new("discs", Hard, of_points(vec![discs(30, 1.0)])),
        ShapeScene::new("translucent discs, perspective", Hard, of_points(vec![discs(30, 0.5)])).in_perspective(),
        ShapeScene::new("discs on a sheared grid", Hard, of_points(vec![discs(30, 1.0)])).in_volume(ball(sheared())),
        ShapeScene::new("discs around the eye", Hard, of_points(vec![discs(60, 1.0)])).seen_from_inside(),
    ]
}

/// Two spirals that cross themselves and each other, a single position, and a path of no position.
fn spirals(thickness: Thickness, opacity: f32) -> Paths {
    let spiral = |turn: f64| {
        let at = |k: i32| {
            let s = f64::from(k) / 40.0;
            let (sin, cos) = (12.0 * s + turn).sin_cos();
            CENTRE + DVec3::new(9.0 * cos, 5.0 * sin, 18.0 * (s - 0.5) * (turn - 1.0).signum())
        };
        (0..=40).map(at).collect::<Vec<_>>()
    };
    let ways = [spiral(0.0), vec![CENTRE + DVec3::new(2.0, -6.0, 3.0)], Vec::new(), spiral(2.5)];
    let paths = paths(&ways, thickness);
    Paths { style: style(opacity), paint: colors(&paths.positions, 1.0), ..paths }
}

/// The spirals, cut by clip planes.
fn clipped(thickness: Thickness, opacity: f32) -> Shapes {
    let style = ShapeStyle { is_clipped: true, ..style(opacity) };
    of_paths(vec![Paths { style, ..spirals(thickness, opacity) }])
}

/// Cuts away what is before the centre.
fn cut(options: &mut RenderOptions) {
    options.clip_planes = vec![ClipPlane { origin: CENTRE, normal: DVec3::new(-0.7, 0.8, -0.3) }];
}

fn of_tubes() -> Vec<ShapeScene> {
    let by_height = || {
        let spirals = spirals(Radius(0.8), 1.0);
        of_paths(vec![Paths { paint: heights(&spirals.positions, 15.0), ..spirals }])
    };
    // The eye is in two pieces at once.
    let in_tube = || {
        let ways = [vec![EYE + DVec3::new(-1.0, -5.0, 1.0), EYE, EYE + DVec3::new(3.0, 4.0, -2.0)]];
        of_paths(vec![Paths { style: style(0.8), ..paths(&ways, Radius(1.5)) }])
    };
    vec![
        ShapeScene::new("tubes", Hard, of_paths(vec![spirals(Radius(0.8), 1.0)])),
        ShapeScene::new("tubes in hard matter, perspective", Hard, of_paths(vec![spirals(Radius(0.8), 1.0)]))
            .in_hard_matter()
            .in_perspective(),
        ShapeScene::new("translucent tubes", Soft, of_paths(vec![spirals(Radius(1.5), 0.06)])),
        ShapeScene::new("translucent tubes, perspective", Hard, of_paths(vec![spirals(Radius(1.2), 0.4)]))
            .in_perspective(),
        ShapeScene::new("tubes by values, some missing", Hard, by_height()),
        ShapeScene::new("tubes around the eye", Hard, of_paths(vec![spirals(Radius(0.6), 1.0)])).seen_from_inside(),
        ShapeScene::new("eye in a tube", Hard, in_tube()).seen_from_inside(),
        ShapeScene::new("clipped translucent tubes", Hard, clipped(Radius(1.2), 0.4)).with_options(cut),
    ]
}

fn of_strokes() -> Vec<ShapeScene> {
    let by_height = || {
        let spirals = spirals(WidthPx(3.5), 1.0);
        of_paths(vec![Paths { paint: heights(&spirals.positions, 15.0), ..spirals }])
    };
    vec![
        ShapeScene::new("strokes", Hard, of_paths(vec![spirals(WidthPx(3.5), 1.0)])),
        ShapeScene::new("strokes by values, some missing, perspective", Hard, by_height()).in_perspective(),
        ShapeScene::new("translucent strokes on a sheared grid", Hard, of_paths(vec![spirals(WidthPx(5.0), 0.5)]))
            .in_volume(ball(sheared())),
        ShapeScene::new("strokes past the eye", Hard, of_paths(vec![spirals(WidthPx(4.0), 1.0)])).seen_from_inside(),
        ShapeScene::new("clipped strokes", Hard, clipped(WidthPx(5.0), 0.7)).with_options(cut),
    ]
}

fn of_all_kinds() -> Vec<ShapeScene> {
    let all = |opacity: f32| {
        let sheet = sheet_mesh(CENTRE - 3.0 * DVec3::Z, 10.0 * DVec3::X, 8.0 * DVec3::Y);
        let mut sheet = wavesplat_core::Mesh { style: style(0.6 * opacity), ..sheet };
        sheet.paint = Paint::Even([0.7, 0.7, 0.3]);
        let sphere = wavesplat_core::Mesh { style: style(opacity), ..sphere_mesh(CENTRE, 4.0, 10) };
        let lines = vec![spirals(Radius(0.4), opacity), spirals(WidthPx(2.0), opacity)];
        Shapes::new(vec![sheet, sphere], lines, vec![many_balls(8, opacity), discs(8, opacity)], Vec::new()).unwrap()
    };
    vec![
        ShapeScene::new("all kinds", Hard, all(1.0)),
        ShapeScene::new("all kinds in two volumes, perspective", Hard, all(0.6)).with_second_volume().in_perspective(),
        ShapeScene::new("all kinds over a background", Hard, all(0.8)).with_options(|o| {
            o.background = Some([0.2, 0.3, 0.2, 1.0]);
        }),
    ]
}
