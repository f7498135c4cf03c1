//! Shapes in fog whose pictures can be computed with a pencil.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use wavesplat_core::{
    Camera, ClipPlane, ColorNode, Kernel, Mesh, OpacityNode, Paint, Paths, Picture, Points, Projection, RenderOptions,
    ShapeStyle, Shapes, Thickness, TransferFunction,
};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_study::reference::raycast::{RaycastOptions, raycast};
use wavesplat_testkit::shapes::{balls, of_meshes, of_paths, of_points, paths, sheet_mesh, sphere_mesh};
use wavesplat_testkit::{Phantom, max_difference};

/// Side of the box of fog, and the side of the picture in pixels: a pixel is one world unit.
const SIDE: usize = 20;
const FOG: [f64; 3] = [0.4, 0.5, 0.7];
/// Extinction per world unit.
const K: f64 = 0.06;
const CENTRE: DVec3 = DVec3::splat(10.0);

fn fog() -> Phantom {
    Phantom::fog([SIDE + 1; 3], DAffine3::IDENTITY, 100.0)
}

fn tf() -> TransferFunction {
    let opacity = vec![OpacityNode { value: 0.0, opacity: -(-K).exp_m1() }];
    TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: FOG }], Some(1.0)).unwrap()
}

/// A camera that looks along z, from below, x to the right.
fn camera() -> Camera {
    let parallel_scale = 0.5 * SIDE as f64;
    let eye = CENTRE - 50.0 * DVec3::Z;
    Camera::new(eye, CENTRE, -DVec3::Y, Projection::Orthographic { parallel_scale }).unwrap()
}

fn options(shapes: Shapes) -> RenderOptions {
    RenderOptions {
        width_px: SIDE,
        height_px: SIDE,
        shading: None,
        shapes: Arc::new(shapes),
        ..RenderOptions::default()
    }
}

/// Pictures of the ray caster and of the renderer, and how far they may be from paper. Rays of the caster are the
/// middles of pixels; the renderer reads a pixel at several places, and rounds to f32.
fn pictures(options: &RenderOptions, camera: &Camera) -> [(&'static str, Picture, f64); 2] {
    let fog = fog();
    let volume = fog.volume();
    let sampling = RaycastOptions { kernel: Kernel::Linear, step: 0.5, rays_per_pixel: 1 };
    let cast = raycast(&volume, &tf(), camera, options, sampling, &()).unwrap();
    let drawn = render(&Slices::new(&volume, Kernel::Linear), &tf(), camera, options, &()).unwrap().0;
    [("cast", cast, 1e-6), ("drawn", drawn, 2.0 / 255.0)]
}

/// Fog of a length, or a surface with its colour and opacity.
#[derive(Clone, Copy)]
enum Way {
    Fog(f64),
    Surface([f64; 3], f64),
}

/// Associated colour and opacity along a way, front to back.
fn along(way: &[Way]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for part in way {
        let (rgb, opacity) = match *part {
            Way::Fog(length) => (FOG, 1.0 - (-K * length).exp()),
            Way::Surface(rgb, opacity) => (rgb, opacity),
        };
        let weight = (1.0 - sum[3]) * opacity;
        (0..3).for_each(|c| sum[c] += weight * rgb[c]);
        sum[3] += weight;
    }
    sum
}

/// Nine places around the centre: pixels, and their distances from it.
fn places() -> Vec<([usize; 2], f64)> {
    let mut places = Vec::new();
    for x in [6, 9, 12] {
        for y in [7, 10, 13] {
            let [dx, dy] = [x, y].map(|px| px as f64 + 0.5 - 10.0);
            places.push(([x, y], dx.hypot(dy)));
        }
    }
    places
}

/// Checks the nine places of both pictures against the way of a ray at their distance from the centre. `facets`: what
/// flat triangles in place of a sphere may add to the difference.
fn check_from(camera: &Camera, options: &RenderOptions, facets: f64, way: impl Fn(f64) -> Vec<Way>) {
    for (name, picture, within) in pictures(options, camera) {
        for ([x, y], distance) in places() {
            let (got, want) = (picture.rgba[y * SIDE + x], along(&way(distance)));
            for c in 0..4 {
                assert!(
                    (f64::from(got[c]) - want[c]).abs() < within + facets,
                    "{name} at {x}, {y}: {got:?}, not {want:?}"
                );
            }
        }
    }
}

fn check(shapes: Shapes, way: impl Fn(f64) -> Vec<Way>) {
    check_from(&camera(), &options(shapes), 0.0, way);
}

const RED: [f32; 3] = [1.0, 0.25, 0.0];
const BLUE: [f32; 3] = [0.0, 0.25, 1.0];

fn style(opacity: f32) -> ShapeStyle {
    ShapeStyle { opacity, is_lit: false, ..ShapeStyle::default() }
}

fn ball(radius: f64, rgb: [f32; 3], opacity: f32) -> Points {
    let paint = Paint::Even(rgb);
    Points { paint, style: style(opacity), ..balls(&[(CENTRE, radius)]) }
}

fn tube(ways: &[Vec<DVec3>], radius: f64, opacity: f32) -> Paths {
    Paths { paint: Paint::Even(RED), style: style(opacity), ..paths(ways, Thickness::Radius(radius)) }
}

fn half_chord(radius: f64, distance: f64) -> f64 {
    (radius * radius - distance * distance).sqrt()
}

#[test]
fn fog_before_an_opaque_ball_dims_it() {
    const RADIUS: f64 = 6.0;
    let way = |distance: f64| {
        let before = 10.0 - half_chord(RADIUS, distance);
        vec![Way::Fog(before), Way::Surface(RED.map(f64::from), 1.0)]
    };
    check(of_points(vec![ball(RADIUS, RED, 1.0)]), way);
    let mesh = Mesh { paint: Paint::Even(RED), style: style(1.0), ..sphere_mesh(CENTRE, RADIUS, 60) };
    // The facets lie up to 6 (1 - cos(π / 120)) = 0.002 inside of the sphere, and rays meet it at up to 50 degrees.
    check_from(&camera(), &options(of_meshes(vec![mesh])), K * 0.0034, way);
}

#[test]
fn fog_lies_before_between_and_behind_translucent_shells() {
    let [outer, inner] = [8.0, 6.5];
    let shells = of_points(vec![ball(inner, BLUE, 0.5), ball(outer, RED, 0.25)]);
    check(shells, |distance| {
        let [outer, inner] = [outer, inner].map(|radius| half_chord(radius, distance));
        let [red, blue] = [Way::Surface(RED.map(f64::from), 0.25), Way::Surface(BLUE.map(f64::from), 0.5)];
        let [before, between] = [Way::Fog(10.0 - outer), Way::Fog(outer - inner)];
        vec![before, red, between, blue, Way::Fog(2.0 * inner), blue, between, red, before]
    });
}

#[test]
fn surfaces_before_and_behind_the_volume_are_in_the_picture() {
    let sheet = |z: f64, rgb: [f32; 3], opacity: f32| {
        let sheet = sheet_mesh(DVec3::new(10.0, 10.0, z), 9.0 * DVec3::X, 9.0 * DVec3::Y);
        Mesh { paint: Paint::Even(rgb), style: style(opacity), ..sheet }
    };
    let [red, blue] = [Way::Surface(RED.map(f64::from), 0.5), Way::Surface(BLUE.map(f64::from), 1.0)];
    let both = of_meshes(vec![sheet(25.0, BLUE, 1.0), sheet(-5.0, RED, 0.5)]);
    check(both, |_| vec![red, Way::Fog(20.0), blue]);
    // An orthographic picture has no eye: what lies before the camera's position is in it, too.
    let before_camera = of_meshes(vec![sheet(-60.0, RED, 0.5)]);
    check(before_camera, |_| vec![red, Way::Fog(20.0)]);
}

#[test]
fn an_eye_in_a_ball_sees_its_far_side_through_fog() {
    let projection = Projection::Perspective { view_angle_rad: 0.8 };
    let camera = Camera::new(CENTRE, CENTRE + DVec3::Z, -DVec3::Y, projection).unwrap();
    // The box ends 10 units before the eye.
    let slant = |distance: f64| (1.0 + (distance / 10.0 * 0.4_f64.tan()).powi(2)).sqrt();
    for opacity in [0.5, 1.0] {
        let surface = Way::Surface(RED.map(f64::from), f64::from(opacity));
        check_from(&camera, &options(of_points(vec![ball(7.0, RED, opacity)])), 0.0, |distance| {
            let slant = slant(distance);
            vec![Way::Fog(7.0), surface, Way::Fog(10.0 * slant - 7.0)]
        });
    }
    // In both pieces of a tube at once, of which the second ends with half a ball 3 units before the eye.
    let ways = [vec![CENTRE - 4.0 * DVec3::Z, CENTRE, CENTRE + 3.0 * DVec3::Z]];
    let tube = of_paths(vec![tube(&ways, 4.0, 0.5)]);
    check_from(&camera, &options(tube), 0.0, |distance| {
        let slant = slant(distance);
        let (cos, sin_squared) = (1.0 / slant, 1.0 - 1.0 / (slant * slant));
        let end = 3.0 * cos + (16.0 - 9.0 * sin_squared).sqrt();
        vec![Way::Fog(end), Way::Surface(RED.map(f64::from), 0.5), Way::Fog(10.0 * slant - end)]
    });
}

#[test]
fn what_is_clipped_shows_its_inside() {
    let behind = |z: f64, shapes: Shapes| RenderOptions {
        clip_planes: vec![ClipPlane { origin: DVec3::new(0.0, 0.0, z), normal: DVec3::Z }],
        ..options(shapes)
    };
    for opacity in [0.5, 1.0] {
        let half = ball(6.0, RED, opacity);
        let half = Points { style: ShapeStyle { is_clipped: true, ..half.style }, ..half };
        check_from(&camera(), &behind(10.0, of_points(vec![half])), 0.0, |distance| {
            let length = half_chord(6.0, distance);
            vec![Way::Fog(length), Way::Surface(RED.map(f64::from), f64::from(opacity)), Way::Fog(10.0 - length)]
        });
    }
    // The ray enters the first piece of the tube before the plane, and is in it where it enters the second.
    let ways = [vec![CENTRE - 5.0 * DVec3::Z, CENTRE, CENTRE + 4.0 * DVec3::Z]];
    let tube = tube(&ways, 6.0, 0.5);
    let tube = Paths { style: ShapeStyle { is_clipped: true, ..tube.style }, ..tube };
    check_from(&camera(), &behind(3.0, of_paths(vec![tube])), 0.0, |distance| {
        let end = 14.0 + half_chord(6.0, distance);
        vec![Way::Fog(end - 3.0), Way::Surface(RED.map(f64::from), 0.5), Way::Fog(20.0 - end)]
    });
}

#[test]
fn colours_of_shapes_that_are_not_lit_are_shown_as_they_are() {
    check(of_points(vec![ball(6.0, RED, 1.0)]), |distance| {
        vec![Way::Fog(10.0 - half_chord(6.0, distance)), Way::Surface(RED.map(f64::from), 1.0)]
    });
}

#[test]
fn the_order_of_shapes_changes_nothing() {
    let points = |k: usize| ball(8.0 - 0.37 * k as f64, [RED, BLUE][k % 2], 0.3);
    let forth = pictures(&options(of_points((0..12).map(points).collect())), &camera());
    let back = pictures(&options(of_points((0..12).rev().map(points).collect())), &camera());
    let none = pictures(&options(Shapes::default()), &camera());
    let clear = pictures(&options(of_points((0..12).map(|k| ball(1.0 + f64::from(k), RED, 0.0)).collect())), &camera());
    for k in 0..2 {
        assert!(forth[k].1.rgba == back[k].1.rgba);
        let difference = max_difference(&clear[k].1.rgba, &none[k].1.rgba);
        assert!(difference < 1e-6, "{difference}");
    }
}
