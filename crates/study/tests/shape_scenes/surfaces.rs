//! Scenes of triangle meshes and cards.

use std::f64::consts::TAU;

use glam::{DAffine3, DVec3};
use wavesplat_core::{Card, ClipPlane, Crop, Mesh, Paint, ShapeStyle, Shapes};
use wavesplat_testkit::shapes::{balls, of_meshes, of_points, sheet_mesh, sphere_mesh};
use wavesplat_testkit::{Phantom, camera_towards};

use super::Edges::{Hard, Soft};
use super::{CENTRE, ORTHOGRAPHIC, ShapeScene, ball, colors, heights, holed, sheared, style};

pub fn scenes() -> Vec<ShapeScene> {
    let mut scenes = Vec::new();
    scenes.extend(opaque());
    scenes.extend(translucent());
    scenes.extend(painted());
    scenes.extend(in_other_volumes());
    scenes.extend(clipped());
    scenes.extend(cards());
    scenes
}

fn sphere(radius: f64, opacity: f32) -> Mesh {
    Mesh { style: style(opacity), ..sphere_mesh(CENTRE, radius, 12) }
}

/// A sheet through the centre, far beyond the picture's sides.
fn wide_sheet(normal: DVec3, opacity: f32) -> Mesh {
    let (x, y) = normal.normalize().any_orthonormal_pair();
    Mesh { style: style(opacity), ..sheet_mesh(CENTRE, 60.0 * x, 60.0 * y) }
}

/// A knot in and out of the fog: a tube of triangles, which is in front of itself many times.
fn knot(opacity: f32) -> Mesh {
    const N: [usize; 2] = [64, 8];
    let axis = |s: f64| {
        let ring = 6.5 + 2.5 * (3.0 * s).cos();
        DVec3::new(ring * (2.0 * s).cos(), ring * (2.0 * s).sin(), 3.0 * (3.0 * s).sin())
    };
    let mut mesh = Mesh { style: style(opacity), vertices: Vec::new(), faces: Vec::new(), ..sphere(1.0, 1.0) };
    mesh.normals.clear();
    for k in 0..N[0] {
        let s = TAU * k as f64 / N[0] as f64;
        let (across, up) = (axis(s + 1e-3) - axis(s - 1e-3)).normalize().any_orthonormal_pair();
        for l in 0..N[1] {
            let (sin, cos) = (TAU * l as f64 / N[1] as f64).sin_cos();
            let normal = across * cos + up * sin;
            mesh.vertices.push((CENTRE + axis(s) + 1.2 * normal).to_array());
            mesh.normals.push(normal.to_array().map(|c| c as f32));
        }
    }
    for k in 0..N[0] {
        for l in 0..N[1] {
            let at = |k: usize, l: usize| (k % N[0] * N[1] + l % N[1]) as u32;
            mesh.faces.extend([[at(k, l), at(k + 1, l), at(k + 1, l + 1)], [at(k, l), at(k + 1, l + 1), at(k, l + 1)]]);
        }
    }
    mesh
}

fn opaque() -> Vec<ShapeScene> {
    let crossing = || {
        let sheet = |normal: DVec3, half: f64| {
            let (x, y) = normal.normalize().any_orthonormal_pair();
            sheet_mesh(CENTRE, half * x, half * y)
        };
        let other = Mesh { paint: Paint::Even([0.9, 0.2, 0.3]), ..sheet(DVec3::new(-0.4, 1.0, 0.3), 6.0) };
        of_meshes(vec![sheet(DVec3::new(1.0, 0.3, 0.2), 8.0), other])
    };
    let flat = |mesh: Mesh| of_meshes(vec![Mesh { normals: Vec::new(), ..mesh }]);
    let unlit = ShapeStyle { is_lit: false, ..ShapeStyle::default() };
    let tall = {
        let way = DVec3::new(0.7, -0.6, 0.4).normalize();
        let at = |along: f64, aside: f64| CENTRE + along * way + DVec3::new(0.0, 0.0, aside);
        // In front of the volume's box, behind it, and beside it.
        of_points(vec![balls(&[(at(30.0, 4.0), 3.0), (at(-30.0, -4.0), 5.0), (at(0.0, 13.5), 2.0)])])
    };
    vec![
        ShapeScene::new("opaque sphere in fog", Hard, of_meshes(vec![sphere(5.0, 1.0)])),
        ShapeScene::new("opaque sphere in fog, perspective", Hard, of_meshes(vec![sphere(5.0, 1.0)])).in_perspective(),
        ShapeScene::new("opaque sphere with flat faces", Hard, flat(sphere(6.0, 1.0))),
        ShapeScene::new(
            "opaque sphere without light",
            Hard,
            of_meshes(vec![Mesh { style: unlit, ..sphere(6.0, 1.0) }]),
        ),
        ShapeScene::new("opaque knot", Hard, of_meshes(vec![knot(1.0)])),
        ShapeScene::new("opaque knot in hard matter, perspective", Hard, of_meshes(vec![knot(1.0)]))
            .in_hard_matter()
            .in_perspective(),
        ShapeScene::new("crossing sheets", Hard, crossing()),
        ShapeScene::new("crossing sheets in hard matter", Hard, crossing()).in_hard_matter(),
        ShapeScene::new("opaque balls beyond the volume", Hard, tall),
        ShapeScene::new("opaque sheet through all", Soft, of_meshes(vec![wide_sheet(DVec3::new(0.8, -0.5, 0.6), 1.0)])),
    ]
}

fn translucent() -> Vec<ShapeScene> {
    let shells = |most: f32| of_meshes(vec![sphere(3.0, most), sphere(5.0, 0.7 * most), sphere(8.0, 0.4 * most)]);
    let sheets = || {
        let red = Mesh { paint: Paint::Even([0.9, 0.2, 0.3]), ..wide_sheet(DVec3::new(0.3, -0.9, 0.2), 0.3) };
        of_meshes(vec![wide_sheet(DVec3::new(0.8, -0.5, 0.6), 0.3), red])
    };
    vec![
        ShapeScene::new("translucent shells", Soft, shells(0.3)),
        ShapeScene::new("translucent shells, perspective", Soft, shells(0.3)).in_perspective(),
        ShapeScene::new("translucent shells in hard matter", Hard, shells(0.8)).in_hard_matter(),
        ShapeScene::new("translucent shells around the eye", Soft, shells(0.3)).seen_from_inside(),
        ShapeScene::new("translucent sheets through all", Soft, sheets()),
        ShapeScene::new("translucent knot", Hard, of_meshes(vec![knot(0.5)])),
        ShapeScene::new("translucent knot around the eye", Hard, of_meshes(vec![knot(0.5)])).seen_from_inside(),
    ]
}

fn painted() -> Vec<ShapeScene> {
    let knot = |paint: fn(&[[f64; 3]]) -> Paint| {
        let mesh = knot(1.0);
        of_meshes(vec![Mesh { paint: paint(&mesh.vertices), ..mesh }])
    };
    vec![
        ShapeScene::new("colours of vertices", Hard, knot(|at| colors(at, 1.0))),
        ShapeScene::new("translucent colours of vertices", Soft, knot(|at| colors(at, 0.25))).in_perspective(),
        ShapeScene::new("values of vertices", Hard, knot(|at| heights(at, f64::INFINITY))),
        ShapeScene::new("values of vertices, some missing", Hard, knot(|at| heights(at, 12.0))).in_perspective(),
    ]
}

fn in_other_volumes() -> Vec<ShapeScene> {
    let knot = |opacity: f32| of_meshes(vec![knot(opacity)]);
    let mut without_light = ShapeScene::new("opaque knot in a volume without light", Hard, knot(1.0));
    without_light.parts[0].shading = None;
    let thick = DAffine3::from_scale(DVec3::new(0.8, 1.0, 1.4));
    let along = |direction: DVec3| camera_towards(CENTRE, direction, 60.0, ORTHOGRAPHIC);
    vec![
        ShapeScene::new("knot on a sheared grid", Hard, knot(1.0)).in_volume(ball(sheared())),
        ShapeScene::new("knot on a sheared grid, perspective", Hard, knot(0.6))
            .in_volume(ball(sheared()))
            .in_perspective(),
        ShapeScene::new("knot on thick slices", Hard, knot(1.0)).in_volume(ball(thick)),
        ShapeScene::new("knot among missing samples", Hard, knot(0.6)).in_volume(holed()),
        ShapeScene::new("knot beside labels", Hard, knot(1.0)).with_labels(),
        ShapeScene::new("knot in two volumes", Hard, knot(1.0)).with_second_volume(),
        ShapeScene::new(
            "shells in two volumes, perspective",
            Soft,
            of_meshes(vec![sphere(5.0, 0.2), sphere(8.0, 0.15)]),
        )
        .with_second_volume()
        .in_perspective(),
        without_light,
        ShapeScene { camera: along(DVec3::Z), ..ShapeScene::new("knot along an axis", Hard, knot(1.0)) },
        ShapeScene {
            camera: along(DVec3::new(1.0, 0.98, 0.3)),
            ..ShapeScene::new("knot along a diagonal", Hard, knot(1.0))
        },
        ShapeScene::new("knot in nothing", Hard, knot(0.7)).in_volume(Phantom::fog(
            [26, 25, 24],
            DAffine3::IDENTITY,
            0.0,
        )),
    ]
}

fn clipped() -> Vec<ShapeScene> {
    let knot = |is_clipped: bool| {
        let mesh = knot(1.0);
        of_meshes(vec![Mesh { style: ShapeStyle { is_clipped, ..mesh.style }, ..mesh }])
    };
    let planes = || vec![ClipPlane { origin: CENTRE, normal: DVec3::new(-0.5, 0.8, 0.1) }];
    let crop = Crop::Index { lo: DVec3::new(0.0, 5.3, 6.2), hi: DVec3::new(14.6, 30.0, 20.0) };
    let in_world = Crop::World { lo: DVec3::new(-50.0, 10.0, -50.0), hi: DVec3::new(50.0, 50.0, 13.0) };
    vec![
        ShapeScene::new("clipped knot", Hard, knot(true)).with_options(|o| o.clip_planes = planes()),
        ShapeScene::new("knot that is not clipped", Hard, knot(false)).with_options(|o| o.clip_planes = planes()),
        ShapeScene::new("cropped knot", Hard, knot(true)).with_options(|o| o.crop = Some(crop)).in_perspective(),
        ShapeScene::new("knot cropped in the world", Hard, knot(true)).with_options(|o| o.crop = Some(in_world)),
    ]
}

/// A picture of waves, with a translucent rim.
fn card(along_x: DVec3, along_y: DVec3, opacity: f32) -> Card {
    let size = [13, 9];
    let pixel = |k: usize| {
        let [x, y] = [k % size[0], k / size[0]].map(|at| at as f32);
        let alpha = if x == 0.0 || y == 0.0 { 0.3 } else { 1.0 };
        [0.5 + 0.5 * (0.9 * x).sin(), 0.5 + 0.5 * (0.8 * y + 0.3 * x).cos(), 0.3, alpha]
    };
    Card {
        corner: (CENTRE - 0.5 * (along_x + along_y)).to_array(),
        along_x: along_x.to_array(),
        along_y: along_y.to_array(),
        size,
        rgba: (0..size[0] * size[1]).map(pixel).collect(),
        style: style(opacity),
    }
}

fn cards() -> Vec<ShapeScene> {
    let of = |cards: Vec<Card>| Shapes::new(Vec::new(), Vec::new(), Vec::new(), cards).unwrap();
    let upright = || card(DVec3::new(12.0, 14.0, 0.0), DVec3::new(0.0, 3.0, -15.0), 1.0);
    let lying = || card(DVec3::new(14.0, -9.0, 2.0), DVec3::new(6.0, 14.0, 0.0), 0.6);
    vec![
        ShapeScene::new("card", Hard, of(vec![upright()])),
        ShapeScene::new("crossing cards, perspective", Hard, of(vec![upright(), lying()])).in_perspective(),
        ShapeScene::new(
            "card beyond the picture",
            Soft,
            of(vec![card(DVec3::new(60.0, 70.0, 0.0), DVec3::new(0.0, 5.0, -75.0), 0.7)]),
        ),
    ]
}
