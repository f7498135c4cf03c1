//! Shapes in matter: answers from paper, permutations, and what opaque shapes save.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, Card, ClipPlane, Composite, Kernel, Mesh, Paint, Paths, Picture, Points, Projection, RenderOptions,
    ShapeStyle, Shapes, Sizes, Thickness, TransferFunction,
};
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{Report, render, render_base_planes_at};
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

const N: usize = 33;

/// Even white fog in a box from 0 to 32 along each axis, of `opacity` per unit of length.
struct Fog {
    phantom: Phantom,
    tf: TransferFunction,
}

impl Fog {
    fn new(opacity: f64) -> Self {
        let phantom = Phantom::fog([N; 3], DAffine3::IDENTITY, 255.0);
        Self { phantom, tf: opacity_ramp(&[(0.0, opacity), (255.0, opacity)], Some(1.0)) }
    }

    fn draw(&self, shapes: Shapes, camera: &Camera, options: &RenderOptions) -> (Picture, Report) {
        let volume = self.phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let options = RenderOptions { shapes: Arc::new(shapes), ..options.clone() };
        render(&slices, &self.tf, camera, &options, &()).unwrap()
    }
}

fn plain() -> RenderOptions {
    RenderOptions { width_px: 65, height_px: 65, shading: None, ..RenderOptions::default() }
}

fn style(opacity: f32) -> ShapeStyle {
    ShapeStyle { opacity, is_lit: false, is_clipped: false }
}

fn balls(centers: Vec<[f64; 3]>, radius: f64, opacity: f32) -> Shapes {
    let radii = Sizes::Radii(vec![radius; centers.len()]);
    let points = Points { centers, sizes: radii, paint: Paint::Even([1.0, 0.0, 0.0]), style: style(opacity) };
    Shapes::new(Vec::new(), Vec::new(), vec![points], Vec::new()).unwrap()
}

/// A camera along −z whose pixel (32, 32) looks at the middle of the box; a pixel is half a unit.
fn from_front(projection: Projection) -> Camera {
    camera_towards(DVec3::splat(16.0), DVec3::Z, 200.0, projection)
}

fn parallel() -> Projection {
    Projection::Orthographic { parallel_scale: 65.0 / 4.0 }
}

fn pixel(picture: &Picture, x: usize, y: usize) -> [f32; 4] {
    picture.rgba[y * picture.width_px + x]
}

#[test]
fn fog_in_front_of_a_ball_dims_it_by_its_depth() {
    let fog = Fog::new(0.05);
    let per_unit = -(1.0_f64 - 0.05).ln();
    let mut n = 0;
    for z in [2.0, 4.0, 7.3, 11.0, 16.0, 19.7, 24.0, 28.9, 30.0] {
        for radius in [1.0, 1.9] {
            let (picture, _) = fog.draw(balls(vec![[16.0, 16.0, z]], radius, 1.0), &from_front(parallel()), &plain());
            let [r, .., a] = pixel(&picture, 32, 32);
            // The eye is beyond z = 32.
            let passing = (-per_unit * (32.0 - z - radius)).exp();
            // The fog is white: red is 1 whatever lies behind, green only from the fog.
            let [_, g, ..] = pixel(&picture, 32, 32);
            let off = (f64::from(g) - (1.0 - passing)).abs().max((f64::from(r) - 1.0).abs());
            assert!(off < 1.0 / 255.0 && a > 0.9999, "{z} {radius}: {g} {passing}");
            n += 1;
        }
    }
    assert_eq!(n, 18);
}

#[test]
fn between_two_clear_shells_lies_the_right_amount_of_fog() {
    let fog = Fog::new(0.05);
    let per_unit = -(1.0_f64 - 0.05).ln();
    for (radius, opacity) in [(10.0, 0.5), (5.5, 0.25), (13.0, 0.9)] {
        for projection in [parallel(), Projection::Perspective { view_angle_rad: 0.16 }] {
            let camera = from_front(projection);
            let (picture, _) = fog.draw(balls(vec![[16.0; 3]], radius, opacity), &camera, &plain());
            let [_, g, _, a] = pixel(&picture, 32, 32);
            // Fog, shell, fog, shell, fog; shells are red.
            let fog_of = |length: f64| 1.0 - (-per_unit * length).exp();
            let (mut left, mut green) = (1.0, 0.0);
            for length in [16.0 - radius, 2.0 * radius, 16.0 - radius] {
                green += left * fog_of(length);
                left *= (1.0 - fog_of(length)) * (1.0 - f64::from(opacity));
            }
            left /= 1.0 - f64::from(opacity);
            let off = (f64::from(g) - green).abs().max((1.0 - left - f64::from(a)).abs());
            assert!(off < 1.0 / 255.0, "{radius} {opacity}: {g} {green}, {a} {left}");
        }
    }
}

#[test]
fn steep_functions_are_cut_where_a_surface_lies() {
    // The value rises from 0 to 32 along z, and is opaque from 16 on: the eye sees it from behind a card, or the card.
    let phantom = Phantom::sample([N; 3], DAffine3::IDENTITY, |p| p.z);
    let volume = phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    let hard = opacity_ramp(&[(15.999, 0.0), (16.0, 1.0)], Some(1.0));
    let camera = camera_towards(DVec3::splat(16.0), -DVec3::Z, 200.0, parallel());
    for (z, is_in_front) in [(15.2, true), (15.7, true), (16.2, false), (16.7, false)] {
        let card = Card {
            corner: [6.0, 6.0, z],
            along_x: [20.0, 0.0, 0.0],
            along_y: [0.0, 20.0, 0.0],
            size: [1, 1],
            rgba: vec![[1.0, 0.0, 0.0, 1.0]],
            style: style(1.0),
        };
        let shapes = Shapes::new(Vec::new(), Vec::new(), Vec::new(), vec![card]).unwrap();
        let options = RenderOptions { shapes: Arc::new(shapes), with_depth: true, ..plain() };
        for composite in [Composite::Over, Composite::FirstHit { iso_value: 16.0 }] {
            let options = RenderOptions { composite, ..options.clone() };
            let (picture, _) = render(&slices, &hard, &camera, &options, &()).unwrap();
            let [r, g, ..] = pixel(&picture, 32, 32);
            // The matter is blue there.
            assert!((r > 0.999 && g < 0.001) == is_in_front, "{z} {composite:?}: {r} {g}");
            let depth = f64::from(picture.depth.unwrap()[32 * 65 + 32]);
            let wanted = 200.0 - 16.0 + z.min(16.0);
            assert!((depth - wanted).abs() < 0.02, "{z} {composite:?}: {depth} {wanted}");
        }
    }
}

#[test]
fn shapes_are_seen_beside_the_volume() {
    let fog = Fog::new(0.3);
    let far = vec![[40.0, 16.0, 16.0], [16.0, 16.0, -20.0], [16.0, 16.0, 60.0], [16.0, -12.0, 50.0]];
    let camera = from_front(Projection::Orthographic { parallel_scale: 32.5 });
    let (picture, _) = fog.draw(balls(far, 3.0, 1.0), &camera, &plain());
    let red = |rgba: &[f32; 4]| rgba[0] - rgba[1];
    let [r, g, _, a] = pixel(&picture, 32, 32);
    assert!(r > 0.99 && g < 0.01 && a > 0.99, "one in front");
    // Three balls: one each in front, beside and below; one is behind.
    let sum: f32 = picture.rgba.iter().map(red).sum();
    let of_ball = std::f32::consts::PI * 9.0;
    assert!((sum - 3.0 * of_ball).abs() < 0.02 * of_ball, "{sum} {of_ball}");
}

/// Shapes of all types, spread over the box and beyond.
fn many(turned: usize) -> Shapes {
    let place = |k: usize| {
        let at = |n: f64| 16.0 + 20.0 * ((k as f64) * n).sin();
        [at(1.3), at(2.1), at(3.7)]
    };
    let mut centers: Vec<[f64; 3]> = (0..30).map(place).collect();
    let mut colors: Vec<[f32; 4]> = (0..30).map(|k| [k as f32 / 30.0, 0.5, 1.0 - k as f32 / 30.0, 1.0]).collect();
    centers.rotate_left(turned);
    colors.rotate_left(turned);
    let points =
        |centers: Vec<[f64; 3]>, sizes, paint, opacity| Points { centers, sizes, paint, style: style(opacity) };
    let mut faces: Vec<[u32; 3]> = (0..10).map(|k| [k, (k + 7) % 30, (k + 13) % 30]).collect();
    faces.rotate_left(turned % 10);
    let mesh = Mesh {
        vertices: (0..30).map(place).collect(),
        faces,
        normals: Vec::new(),
        paint: Paint::Even([0.1, 0.8, 0.2]),
        style: ShapeStyle { opacity: 0.4, ..ShapeStyle::default() },
    };
    let path = |first: usize| (first..first + 6).map(place).collect::<Vec<_>>();
    let mut paths = [path(3), path(40), path(80)];
    paths.rotate_left(turned % 3);
    let lines = |thickness, opacity| Paths {
        positions: paths.concat(),
        starts: vec![0, 6, 12, 18],
        thickness,
        paint: Paint::Even([0.9, 0.9, 0.1]),
        style: ShapeStyle { opacity, ..ShapeStyle::default() },
    };
    let radii = Sizes::Radii(vec![1.5; 30]);
    let mut sets = vec![
        points(centers.clone(), radii, Paint::Each(colors), 0.6),
        points(centers, Sizes::DiametersPx(vec![3.0; 30]), Paint::Even([1.0; 3]), 1.0),
    ];
    let mut tubes = vec![lines(Thickness::Radius(0.7), 0.7), lines(Thickness::WidthPx(1.5), 1.0)];
    if turned % 2 == 1 {
        sets.reverse();
        tubes.reverse();
    }
    Shapes::new(vec![mesh], tubes, sets, Vec::new()).unwrap()
}

/// Cameras from outside and inside, parallel and in perspective.
fn cameras() -> Vec<Camera> {
    let wide = Projection::Perspective { view_angle_rad: 1.6 };
    let inside = Camera::new(DVec3::new(15.0, 17.0, 16.0), DVec3::new(22.0, 21.0, 23.0), DVec3::Z, wide).unwrap();
    let aslant = DVec3::new(0.6, 0.5, 0.7);
    let from = |projection, distance| camera_towards(DVec3::splat(16.0), aslant, distance, projection);
    vec![
        from(Projection::Orthographic { parallel_scale: 25.0 }, 100.0),
        from(Projection::Perspective { view_angle_rad: 0.9 }, 50.0),
        inside,
    ]
}

#[test]
fn wide_discs_beyond_all_positions_are_whole() {
    let fog = Fog::new(0.001);
    for projection in
        [Projection::Orthographic { parallel_scale: 65.0 }, Projection::Perspective { view_angle_rad: 0.6 }]
    {
        let points = Points {
            centers: vec![[16.0, 34.0, 16.0]],
            sizes: Sizes::DiametersPx(vec![24.0]),
            paint: Paint::Even([1.0, 0.0, 0.0]),
            style: style(1.0),
        };
        let shapes = Shapes::new(Vec::new(), Vec::new(), vec![points], Vec::new()).unwrap();
        let (picture, _) = fog.draw(shapes, &from_front(projection), &plain());
        let sum: f32 = picture.rgba.iter().map(|[r, g, ..]| r - g).sum();
        let area = std::f32::consts::PI * 144.0;
        assert!((sum - area).abs() < 0.03 * area, "{sum} {area}");
    }
}

#[test]
fn order_of_shapes_changes_nothing() {
    let fog = Fog::new(0.02);
    for camera in cameras() {
        let (wanted, _) = fog.draw(many(0), &camera, &plain());
        assert!(wanted.rgba.iter().filter(|rgba| rgba[0] != rgba[1]).count() > 500);
        for turned in [1, 4, 9, 17] {
            let (picture, _) = fog.draw(many(turned), &camera, &plain());
            assert!(picture.rgba == wanted.rgba, "{turned} {:?}", camera.position());
        }
    }
}

/// A hundred winding paths behind each other, each set of paths in one shape.
fn tangle(sets: &[Vec<usize>], thickness: Thickness) -> Shapes {
    let path = |path: usize| {
        (0..20).map(move |k| {
            let (t, phase) = (f64::from(k) / 19.0, path as f64);
            let aside = |n: f64| 16.0 + 12.0 * (n * phase).sin() + 3.0 * (5.0 * t + n * phase).cos();
            [aside(1.7), aside(2.9), 32.0 * t]
        })
    };
    let of_set = |set: &Vec<usize>| Paths {
        positions: set.iter().flat_map(|k| path(*k)).collect(),
        starts: (0..=set.len()).map(|k| 20 * k as u32).collect(),
        thickness,
        paint: Paint::Each(set.iter().flat_map(|k| [[(k % 10) as f32 / 10.0, 0.4, 0.6, 1.0]; 20]).collect()),
        style: ShapeStyle::default(),
    };
    Shapes::new(Vec::new(), sets.iter().map(of_set).collect(), Vec::new(), Vec::new()).unwrap()
}

#[test]
fn what_opaque_paths_hide_is_left_out_whatever_their_order() {
    let fog = Fog::new(0.02);
    let all: Vec<usize> = (0..100).collect();
    let reversed: Vec<usize> = all.iter().rev().copied().collect();
    let apart = [1, 0].map(|odd| all.iter().copied().filter(|k| k % 2 == odd).collect());
    for camera in cameras() {
        for thickness in [Thickness::Radius(1.2), Thickness::WidthPx(3.0)] {
            let draw = |sets: &[Vec<usize>]| fog.draw(tangle(sets, thickness), &camera, &plain());
            let (wanted, report) = draw(std::slice::from_ref(&all));
            assert!(report.n_fragments[0] > 1000, "{:?}", report.n_fragments);
            assert!(draw(std::slice::from_ref(&reversed)).0.rgba == wanted.rgba, "{:?}", camera.position());
            assert!(draw(&apart).0.rgba == wanted.rgba, "{:?}", camera.position());
        }
    }
}

#[test]
fn threads_and_vectors_change_nothing() {
    let fog = Fog::new(0.02);
    let volume = fog.phantom.volume();
    let slices = Slices::new(&volume, Kernel::Linear);
    for camera in cameras() {
        let options = RenderOptions { shapes: Arc::new(many(0)), n_threads: Some(1), ..plain() };
        let draw = |level, n_threads| {
            let options = RenderOptions { n_threads: Some(n_threads), ..options.clone() };
            let (pictures, _) = render_base_planes_at(level, &slices, &fog.tf, &camera, &options, &()).unwrap();
            pictures.iter().flat_map(BasePicture::texels).flatten().map(f32::to_bits).collect::<Vec<_>>()
        };
        let wanted = draw(Level::best(), 1);
        for level in Level::all() {
            assert!(draw(level, 1) == wanted, "{}", level.name());
        }
        assert!(draw(Level::best(), 5) == wanted);
    }
}

#[test]
fn clear_shapes_cost_nothing_and_opaque_ones_save_what_is_behind() {
    let fog = Fog::new(0.01);
    let camera = from_front(parallel());
    let (plain_picture, of_fog) = fog.draw(Shapes::default(), &camera, &plain());
    let (picture, of_clear) = fog.draw(balls(vec![[16.0; 3]], 8.0, 0.0), &camera, &plain());
    assert_eq!(of_clear.n_texels, of_fog.n_texels);
    assert_eq!(of_clear.n_fragments[0], 0);
    assert!(wavesplat_testkit::max_difference(&picture.rgba, &plain_picture.rgba) < 1e-6);
    // A wall at three quarters of the way from the far side.
    let (_, of_wall) = fog.draw(balls(vec![[16.0, 16.0, -76.0]], 100.0, 1.0), &camera, &plain());
    let share = of_wall.n_texels as f64 / of_fog.n_texels as f64;
    assert!((0.2..0.35).contains(&share), "{share}");
}

#[test]
fn clip_planes_cut_shapes_where_asked() {
    let fog = Fog::new(0.01);
    let camera = from_front(parallel());
    let planes = vec![ClipPlane { origin: DVec3::splat(16.0), normal: DVec3::X }];
    let options = RenderOptions { clip_planes: planes, ..plain() };
    let draw = |is_clipped| {
        let points = Points {
            centers: vec![[16.0, 16.0, 30.0]],
            sizes: Sizes::Radii(vec![8.0]),
            paint: Paint::Even([1.0, 0.0, 0.0]),
            style: ShapeStyle { is_clipped, ..style(1.0) },
        };
        let shapes = Shapes::new(Vec::new(), Vec::new(), vec![points], Vec::new()).unwrap();
        let (picture, _) = fog.draw(shapes, &camera, &options);
        picture.rgba.iter().filter(|[r, g, ..]| r - g > 0.5).count()
    };
    let (whole, half) = (draw(false), draw(true));
    assert!(whole > 750 && half > whole * 45 / 100 && half < whole * 55 / 100, "{whole} {half}");
}

#[test]
fn values_that_are_none_are_not_drawn() {
    let fog = Fog::new(0.01);
    let points = Points {
        centers: vec![[10.0, 16.0, 16.0], [22.0, 16.0, 16.0]],
        sizes: Sizes::Radii(vec![3.0; 2]),
        paint: Paint::Mapped { values: vec![f32::NAN, 1.0], limits: [0.0, 1.0], table: vec![[1.0, 0.0, 0.0, 1.0]] },
        style: style(1.0),
    };
    let shapes = Shapes::new(Vec::new(), Vec::new(), vec![points], Vec::new()).unwrap();
    let (picture, _) = fog.draw(shapes, &from_front(parallel()), &plain());
    let n_red = picture.rgba.iter().filter(|[r, g, ..]| r - g > 0.5).count();
    assert!((90..130).contains(&n_red), "{n_red}");
}
