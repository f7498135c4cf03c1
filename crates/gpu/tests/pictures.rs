//! The GPU's pictures are the CPU's, within one grey level of 255: every operator, kernel, sample type, camera, light
//! and cut.

mod scenes;

use glam::DVec3;
use scenes::{Case, Stored, cuts, difference, gpu};
use wavesplat_core::{Composite, Gradient, Kernel, Light, RenderOptions, Shading};

/// Tolerance of a scene.
#[derive(Clone, Copy)]
enum Allowed {
    /// Every pixel within one level.
    Soft,
    /// 99.99 % of the pixels within one level, and none further off than this number of levels.
    But(f64),
}

fn check(cases: Vec<(Case, Allowed)>) {
    let Some(gpu) = gpu() else { return };
    let mut wrong = Vec::new();
    for (case, allowed) in cases {
        let (got, want) = (case.draw(Some(gpu)), case.draw(None));
        let told = difference(&got.picture, &want.picture);
        println!(
            "{:32} {:.6} within 1, at most {:.4}, of values {:.1e}, covered {:.3}",
            case.name, told.within_one, told.most, told.of_values, told.coverage
        );
        let (least, most) = match allowed {
            Allowed::Soft => (1.0, 1.0),
            Allowed::But(most) => (0.9999, most),
        };
        let depth_is_right = match (&got.picture.depth, &want.picture.depth) {
            (Some(got), Some(want)) => {
                let is_near = |(a, b): (&f32, &f32)| (a.is_nan() && b.is_nan()) || (a - b).abs() < 0.02;
                got.iter().zip(want).filter(|pair| !is_near(*pair)).count() * 1000 <= got.len()
            }
            (got, want) => got.is_none() && want.is_none(),
        };
        if told.within_one < least
            || told.most > most
            || told.coverage < 0.01
            || (least == 1.0 && told.of_values > 1e-4)
            || !depth_is_right
        {
            wrong.push(format!("{}: {told:?}, depth {depth_is_right}", case.name));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn soft(case: Case) -> (Case, Allowed) {
    (case, Allowed::Soft)
}

const HARD: [(f64, f64); 2] = [(120.0, 0.0), (122.0, 0.95)];

fn hard(case: Case) -> Case {
    Case { opacity: HARD.to_vec(), ..case }
}

#[expect(clippy::unnecessary_wraps, reason = "as the scenes have it")]
fn shading(change: impl Fn(&mut Shading)) -> Option<Shading> {
    let mut shading = Shading::default();
    change(&mut shading);
    Some(shading)
}

fn options(change: impl Fn(&mut RenderOptions)) -> RenderOptions {
    let mut options = Case::default().options;
    change(&mut options);
    options
}

#[test]
fn sample_types() {
    let of = |name, stored| soft(Case { name, stored, ..Case::default() });
    check(vec![
        of("u8", Stored::U8),
        of("i8", Stored::I8),
        of("u16", Stored::U16),
        of("i16", Stored::I16),
        of("i32", Stored::I32),
        of("f32", Stored::F32),
        of("f32 with holes", Stored::F32WithHoles),
        soft(Case {
            name: "cubic with holes",
            stored: Stored::F32WithHoles,
            kernel: Kernel::CatmullRom,
            ..Case::default()
        }),
    ]);
}

#[test]
fn kernels() {
    let of = |name, kernel| {
        [
            soft(Case { name, kernel, ..Case::default() }),
            (hard(Case { name, kernel, ..Case::default() }), Allowed::But(3.0)),
        ]
    };
    check(
        [
            of("catmull-rom", Kernel::CatmullRom),
            of("bspline2", Kernel::Bspline2),
            of("bspline3", Kernel::Bspline3),
            of("gaussian", Kernel::Gaussian),
            of("linear", Kernel::Linear),
        ]
        .concat(),
    );
}

#[test]
fn cameras() {
    let of = |name, from: [f64; 3], eye| soft(Case { name, from: DVec3::from_array(from), eye, ..Case::default() });
    check(vec![
        of("along x", [1.0, 0.1, 0.2], None),
        of("along -x", [-1.0, 0.1, 0.2], None),
        of("along y", [0.2, 1.0, -0.1], None),
        of("along -y", [0.2, -1.0, -0.1], None),
        of("along z", [0.0, 0.0, 1.0], None),
        of("along -z", [0.3, 0.2, -1.0], None),
        of("perspective", [0.6, -0.7, 0.5], Some(60.0)),
        of("three families", [1.0, 1.0, 1.0], Some(42.0)),
        of("eye inside", [0.3, 0.5, 0.8], Some(3.0)),
        (hard(of("hard perspective", [1.0, 0.9, 1.1], Some(42.0)).0), Allowed::But(3.0)),
    ]);
}

#[test]
fn operators() {
    let of = |name, composite| soft(Case { name, composite, ..Case::default() });
    let stored = |(case, allowed): (Case, Allowed), stored| (Case { stored, ..case }, allowed);
    check(vec![
        of("maximum", Composite::Maximum),
        of("minimum", Composite::Minimum),
        of("mean", Composite::Mean),
        of("sum", Composite::Sum),
        of("x-ray", Composite::XRay { clear: 40.0, attenuation: 0.0005 }),
        of("depth-shaded maximum", Composite::DepthShadedMaximum { strength: 0.8, black: 20.0 }),
        of("attenuated maximum", Composite::AttenuatedMaximum { black: 20.0, white: 180.0, attenuation: 0.05 }),
        stored(of("maximum f32", Composite::Maximum), Stored::F32WithHoles),
        // Which of two maxima of nearly the same density is the first is a matter of rounding.
        (of("local maximum", Composite::LocalMaximum { threshold: 100.0 }).0, Allowed::But(60.0)),
        // A ray that touches the surface meets it or not by rounding.
        (of("first hit", Composite::FirstHit { iso_value: 90.0 }).0, Allowed::But(255.0)),
        (
            Case {
                eye: Some(45.0),
                kernel: Kernel::Bspline3,
                ..of("first hit, bspline3", Composite::FirstHit { iso_value: 90.0 }).0
            },
            Allowed::But(255.0),
        ),
        (
            Case {
                options: options(|o| o.with_depth = true),
                ..of("first hit, depth", Composite::FirstHit { iso_value: 90.0 }).0
            },
            Allowed::But(255.0),
        ),
    ]);
}

#[test]
fn lights() {
    let of = |name, shading| soft(Case { name, shading, ..Case::default() });
    check(vec![
        of("no light", None),
        of("headlight", Some(Shading::headlight())),
        of("half voxel differences", shading(|s| s.gradient = Gradient::Difference(0.5))),
        of("wide differences", shading(|s| s.gradient = Gradient::Difference(2.5))),
        of("very smooth", shading(|s| s.gradient = Gradient::Smoothed(1.25))),
        of("fractional power", shading(|s| s.specular_power = 7.5)),
        of(
            "coloured lights",
            shading(|s| {
                s.lights =
                    vec![Light { rgb: [1.0, 0.4, 0.2], ..Light::KEY }, Light { rgb: [0.1, 0.2, 0.9], ..Light::FILL }];
            }),
        ),
        soft(Case {
            name: "cubic, differences",
            kernel: Kernel::CatmullRom,
            shading: Some(Shading::headlight()),
            ..Case::default()
        }),
        soft(Case {
            name: "quadratic, smoothed",
            kernel: Kernel::Bspline2,
            shading: shading(|s| s.gradient = Gradient::Smoothed(1.0)),
            ..Case::default()
        }),
        of("ambient occlusion", shading(|s| s.ambient_occlusion = 0.8)),
        of("shadow", shading(|s| s.shadow = 0.7)),
        (
            hard(Case {
                name: "hard, both",
                shading: shading(|s| (s.shadow, s.ambient_occlusion) = (0.7, 0.6)),
                ..Case::default()
            }),
            Allowed::But(3.0),
        ),
    ]);
}

#[test]
fn opacity_by_gradient() {
    let gradient = vec![(0.0, 0.1), (40.0, 1.0)];
    check(vec![
        soft(Case { name: "gradient opacity", gradient: gradient.clone(), ..Case::default() }),
        soft(Case { name: "gradient opacity, no light", gradient: gradient.clone(), shading: None, ..Case::default() }),
        (hard(Case { name: "gradient opacity, hard", gradient, ..Case::default() }), Allowed::But(3.0)),
        soft(Case { name: "two-dimensional", is_joint: true, ..Case::default() }),
    ]);
}

#[test]
fn cuts_and_sizes() {
    let (crop, planes) = cuts();
    let cut = |o: &mut RenderOptions| (o.crop, o.clip_planes) = (Some(crop), planes.clone());
    let sized = |width: usize, height: usize| options(|o| (o.width_px, o.height_px) = (width, height));
    check(vec![
        soft(Case { name: "cut", options: options(cut), ..Case::default() }),
        soft(Case { name: "cut in perspective", eye: Some(50.0), options: options(cut), ..Case::default() }),
        (hard(Case { name: "hard cut", options: options(cut), ..Case::default() }), Allowed::But(3.0)),
        soft(Case { name: "cut maximum", composite: Composite::Maximum, options: options(cut), ..Case::default() }),
        soft(Case { name: "one pixel", options: sized(1, 1), ..Case::default() }),
        soft(Case { name: "one column", options: sized(1, 97), ..Case::default() }),
        soft(Case { name: "prime", options: sized(127, 61), ..Case::default() }),
        soft(Case { name: "two samples", size: [2, 2, 2], ..Case::default() }),
        soft(Case { name: "few sheets", options: options(|o| o.sheets_per_slice = 0.3), ..Case::default() }),
        soft(Case { name: "many sheets", options: options(|o| o.sheets_per_slice = 7.3), ..Case::default() }),
        soft(Case { name: "oversampled", options: options(|o| o.oversampling = 2.0), ..Case::default() }),
        soft(Case { name: "undersampled", options: options(|o| o.oversampling = 0.4), ..Case::default() }),
        soft(Case {
            name: "depth",
            options: options(|o| o.with_depth = true),
            opacity: vec![(40.0, 0.0), (160.0, 0.8)],
            ..Case::default()
        }),
        soft(Case { name: "to the end", options: options(|o| o.early_ray_termination = false), ..Case::default() }),
        soft(Case {
            name: "plain sheets",
            options: options(|o| o.pre_integration = false),
            opacity: HARD.to_vec(),
            ..Case::default()
        }),
    ]);
}

#[test]
fn labels() {
    let of = |name| Case { name, has_labels: true, ..Case::default() };
    check(vec![
        soft(of("labels")),
        soft(Case { shading: None, ..of("labels, no light") }),
        soft(Case { shading: shading(|s| s.shadow = 0.6), ..of("labels in shadow") }),
        (hard(of("labels, hard")), Allowed::But(3.0)),
    ]);
}

#[test]
fn layers() {
    let of = |name| Case { name, n_layers: 2, ..Case::default() };
    check(vec![
        soft(of("two layers")),
        soft(Case { shading: None, ..of("two layers, no light") }),
        soft(Case { eye: Some(45.0), shading: shading(|s| s.ambient_occlusion = 0.7), ..of("two layers, occlusion") }),
        (hard(of("two layers, hard")), Allowed::But(3.0)),
        (hard(Case { has_labels: true, ..of("two layers, labels, hard") }), Allowed::But(3.0)),
        soft(Case { has_labels: true, gradient: vec![(0.0, 0.1), (40.0, 1.0)], ..of("two layers, labels") }),
        soft(Case { is_joint: true, ..of("two layers, joint") }),
        soft(Case { stored: Stored::F32WithHoles, ..of("two layers with holes") }),
    ]);
}
