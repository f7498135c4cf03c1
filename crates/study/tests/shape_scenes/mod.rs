//! Scenes with shapes: a volume or two, a camera, and every kind of shape in and around them.

mod lines_and_points;
mod surfaces;

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{
    Camera, ColorNode, Gradient, Kernel, LabelLook, OpacityNode, Paint, Projection, RenderOptions, Shading, ShapeStyle,
    Shapes, TransferFunction,
};
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_testkit::{Phantom, camera_towards};

/// A volume, its look, and its light.
pub struct Part {
    pub phantom: Phantom,
    pub tf: TransferFunction,
    pub shading: Option<Shading>,
}

/// Whether a picture has edges of much contrast, by opaque shapes or hard matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edges {
    Soft,
    Hard,
}

/// A picture to compare.
pub struct ShapeScene {
    pub name: &'static str,
    pub edges: Edges,
    pub parts: Vec<Part>,
    pub labels: Option<Labels>,
    pub camera: Camera,
    /// Without the sampling.
    pub options: RenderOptions,
}

/// The middle of the first volume.
pub const CENTRE: DVec3 = DVec3::new(12.0, 12.5, 11.0);
/// An eye in the ball of fog.
pub const EYE: DVec3 = DVec3::new(13.0, 10.5, 11.5);
pub const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 15.0 };
pub const PERSPECTIVE: Projection = Projection::Perspective { view_angle_rad: 0.5 };
const SIZE: [usize; 3] = [26, 25, 24];
const SOFT: [(f64, f64); 2] = [(60.0, 0.0), (240.0, 0.25)];
const HARD: [(f64, f64); 2] = [(118.0, 0.0), (121.0, 0.9)];

/// All scenes.
pub fn scenes() -> Vec<ShapeScene> {
    let mut scenes = surfaces::scenes();
    scenes.extend(lines_and_points::scenes());
    scenes
}

impl ShapeScene {
    /// Shapes around a soft ball of fog, seen obliquely.
    fn new(name: &'static str, edges: Edges, shapes: Shapes) -> Self {
        let options =
            RenderOptions { width_px: 96, height_px: 96, shapes: Arc::new(shapes), ..RenderOptions::default() };
        let camera = camera_towards(CENTRE, DVec3::new(0.7, -0.6, 0.4), 60.0, ORTHOGRAPHIC);
        let parts = vec![Part { phantom: ball(DAffine3::IDENTITY), tf: function(&SOFT, FOG), shading: Some(light()) }];
        Self { name, edges, parts, labels: None, camera, options }
    }

    /// The scene from an eye.
    fn in_perspective(self) -> Self {
        Self { camera: camera_towards(CENTRE, DVec3::new(-0.5, -0.7, 0.55), 60.0, PERSPECTIVE), ..self }
    }

    /// The scene from an eye in the ball of fog.
    fn seen_from_inside(self) -> Self {
        let projection = Projection::Perspective { view_angle_rad: 1.2 };
        Self { camera: Camera::new(EYE, EYE + DVec3::new(0.6, 1.0, -0.3), DVec3::Z, projection).unwrap(), ..self }
    }

    /// The scene with matter that has a surface.
    fn in_hard_matter(mut self) -> Self {
        self.parts[0].tf = function(&HARD, FOG);
        self
    }

    /// The scene with another first volume.
    fn in_volume(mut self, phantom: Phantom) -> Self {
        self.parts[0].phantom = phantom;
        self
    }

    /// The scene with other options, but for the shapes.
    fn with_options(mut self, change: impl FnOnce(&mut RenderOptions)) -> Self {
        change(&mut self.options);
        self
    }

    /// The scene with a second volume, on a grid of its own.
    fn with_second_volume(mut self) -> Self {
        let placed =
            DAffine3 { translation: DVec3::new(4.3, -2.5, 0.4), ..DAffine3::from_scale(DVec3::new(1.5, 2.0, 1.25)) };
        let value = |p: DVec3| (120.0 + 25.0 * (6.5 - p.distance(DVec3::new(17.0, 11.0, 13.0)))).clamp(0.0, 250.0);
        self.parts.push(Part {
            phantom: Phantom::sample([18, 14, 20], placed, value),
            tf: function(&SOFT, [1.0, 0.5, 0.2]),
            shading: Some(light()),
        });
        self
    }

    /// The scene with a segmentation of the first volume: a part of it is hidden, another has matter of its own.
    fn with_labels(mut self) -> Self {
        let code = |i: usize| {
            let p = DVec3::new((i % SIZE[0]) as f64, (i / SIZE[0] % SIZE[1]) as f64, (i / (SIZE[0] * SIZE[1])) as f64);
            u8::from(p.distance(DVec3::new(8.0, 13.0, 9.0)) < 4.0) + 2 * u8::from(p.z > 15.0)
        };
        let codes: Vec<u8> = (0..SIZE.iter().product()).map(code).collect();
        let solid = LabelLook { rgb: [0.9, 0.9, 0.1], opacity: 0.1, scan: 0.2, tint: 0.0 };
        let hidden = LabelLook { scan: 0.0, ..LabelLook::NONE };
        let looks = vec![LabelLook::NONE, solid, hidden, LabelLook::NONE];
        let volume = self.parts[0].phantom.volume();
        let labels = Labels::new(Codes::U8(codes.into()), looks, volume.grid(), Kernel::Linear, 1 << 24).unwrap();
        self.labels = Some(labels);
        self
    }
}

const FOG: [f64; 3] = [0.5, 0.7, 1.0];

fn function(nodes: &[(f64, f64)], rgb: [f64; 3]) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb }], Some(1.0)).unwrap()
}

fn light() -> Shading {
    Shading { gradient: Gradient::Difference(1.0), ..Shading::headlight() }
}

/// A soft ball around the centre, 120 at a radius of 7, on a grid of any affine.
fn ball(world_from_index: DAffine3) -> Phantom {
    Phantom::sample(SIZE, world_from_index, |p| (120.0 + 25.0 * (7.0 - p.distance(CENTRE))).clamp(0.0, 250.0))
}

/// A grid whose axes are not at right angles and have other spacings, around the centre.
fn sheared() -> DAffine3 {
    let shear = DMat3::from_cols(DVec3::new(1.1, 0.0, 0.1), DVec3::new(0.3, 0.9, 0.0), DVec3::new(0.1, 0.4, 1.2));
    let middle = DVec3::from_array(SIZE.map(|n| 0.5 * (n - 1) as f64));
    DAffine3 { matrix3: shear, translation: CENTRE - shear * middle }
}

/// The soft ball with missing samples in a part of it.
fn holed() -> Phantom {
    let mut phantom = ball(DAffine3::IDENTITY);
    for (k, sample) in phantom.samples.iter_mut().enumerate() {
        let p = DVec3::new((k % SIZE[0]) as f64, (k / SIZE[0] % SIZE[1]) as f64, (k / (SIZE[0] * SIZE[1])) as f64);
        if p.distance(CENTRE + DVec3::new(3.0, -3.0, 2.0)) < 2.5 {
            *sample = f32::NAN;
        }
    }
    phantom
}

fn style(opacity: f32) -> ShapeStyle {
    ShapeStyle { opacity, ..ShapeStyle::default() }
}

/// A colour for each of some places: red by x, green by y, blue by z, around the centre.
fn colors(at: &[[f64; 3]], alpha: f32) -> Paint {
    let color = |p: &[f64; 3]| {
        let share = |c: usize| (0.5 + (p[c] - CENTRE[c]) / 20.0).clamp(0.0, 1.0) as f32;
        [share(0), share(1), share(2), alpha]
    };
    Paint::Each(at.iter().map(color).collect())
}

/// Values by height, in a map of few colours; not a number above a height.
fn heights(at: &[[f64; 3]], top: f64) -> Paint {
    let value = |p: &[f64; 3]| if p[2] > top { f32::NAN } else { p[2] as f32 };
    let table = vec![[0.9, 0.1, 0.1, 1.0], [0.9, 0.9, 0.2, 1.0], [0.1, 0.4, 0.2, 1.0], [0.2, 0.2, 0.9, 1.0]];
    Paint::Mapped { values: at.iter().map(value).collect(), limits: [6.0, 17.0], table }
}
