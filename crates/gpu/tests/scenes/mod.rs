//! Small scenes of every kind, drawn on the GPU and on the CPU.

#![allow(dead_code, reason = "each test uses a part of it")]

use std::sync::OnceLock;

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, ClipPlane, ColorNode, Composite, Crop, GradientNode, Kernel, LabelLook, OpacityNode, Picture, Projection,
    RenderOptions, Samples, Shading, TransferFunction, TransferFunction2D, Volume,
};
use wavesplat_gpu::{Choice, DEFAULT_BUDGET_BYTES, Gpu, GpuReport, Schedule};
use wavesplat_splat::Layer;
use wavesplat_splat::optics::labels::{Codes, Labels};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::frame::{draw_base_planes, finish, slices_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{camera_towards, ripples_signal};

/// The device of the tests: any whose name has what `WAVESPLAT_TEST_GPU` says, else the software device of Mesa. `None`
/// where there is none, unless it is asked for.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| open(DEFAULT_BUDGET_BYTES)).as_ref()
}

/// The device of the tests, opened anew with a budget.
pub fn open(budget_bytes: usize) -> Option<Gpu> {
    let asked = std::env::var("WAVESPLAT_TEST_GPU").ok();
    let choice = Choice::Named(asked.clone().unwrap_or_else(|| "llvmpipe".to_owned()));
    match Gpu::open(&choice, budget_bytes) {
        Ok(gpu) => Some(gpu),
        Err(why) if asked.is_none() => {
            eprintln!("skipped, {why}: install mesa-vulkan-drivers");
            None
        }
        Err(why) => panic!("WAVESPLAT_TEST_GPU: {why}"),
    }
}

/// Sample type of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stored {
    U8,
    I8,
    U16,
    I16,
    F32,
    F32WithHoles,
    I32,
}

/// Samples of a scene.
pub enum Owned {
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    I32(Vec<i32>),
    F32(Vec<f32>),
}

impl Owned {
    fn samples(&self) -> Samples<'_> {
        match self {
            Self::U8(s) => Samples::U8(s),
            Self::I8(s) => Samples::I8(s),
            Self::U16(s) => Samples::U16(s),
            Self::I16(s) => Samples::I16(s),
            Self::I32(s) => Samples::I32(s),
            Self::F32(s) => Samples::F32(s),
        }
    }
}

/// A scene.
#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub stored: Stored,
    pub size: [usize; 3],
    pub kernel: Kernel,
    /// Opacity by density, 0 to 255.
    pub opacity: Vec<(f64, f64)>,
    pub gradient: Vec<(f64, f64)>,
    /// Whether a function of two dimensions takes the place of the curves.
    pub is_joint: bool,
    pub composite: Composite,
    /// Direction to the eye.
    pub from: DVec3,
    pub eye: Option<f64>,
    pub shading: Option<Shading>,
    pub options: RenderOptions,
    pub has_labels: bool,
    pub n_layers: usize,
}

impl Default for Case {
    fn default() -> Self {
        Self {
            name: "soft",
            stored: Stored::U8,
            size: [26, 22, 19],
            kernel: Kernel::Linear,
            opacity: vec![(60.0, 0.0), (220.0, 0.35)],
            gradient: Vec::new(),
            is_joint: false,
            composite: Composite::Over,
            from: DVec3::new(0.6, -0.7, 0.5),
            eye: None,
            shading: Some(Shading::default()),
            options: RenderOptions {
                width_px: 83,
                height_px: 71,
                sheets_per_slice: 2.0,
                oversampling: 1.0,
                ..RenderOptions::default()
            },
            has_labels: false,
            n_layers: 1,
        }
    }
}

/// Picture of a scene, and the report of the GPU that drew it.
pub struct Drawn {
    pub picture: Picture,
    pub report: Option<GpuReport>,
}

/// Value of the test signal, 0 to 255, in a box.
fn signal(index: DVec3, size: [usize; 3]) -> f64 {
    let half = DVec3::from_array(size.map(|n| (n - 1) as f64 / 2.0));
    if size == [2; 3] {
        return 85.0 * index.element_sum();
    }
    let p = (index - half) / half;
    let ball = ((0.95 - p.length()) / 0.5).clamp(0.0, 1.0);
    255.0 * ball * (0.4 + 0.6 * ripples_signal(p * 0.6))
}

impl Case {
    /// Samples, and offset and scale from a density of 0 to 255 to a sample.
    fn owned(&self) -> (Owned, f64, f64) {
        let [nx, ny, nz] = self.size;
        let at = |i: usize| {
            let index = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
            signal(index, self.size)
        };
        let n = nx * ny * nz;
        match self.stored {
            Stored::U8 => (Owned::U8((0..n).map(|i| at(i) as u8).collect()), 0.0, 1.0),
            Stored::I8 => (Owned::I8((0..n).map(|i| (at(i) - 128.0) as i8).collect()), -128.0, 1.0),
            Stored::U16 => (Owned::U16((0..n).map(|i| (at(i) * 200.0) as u16).collect()), 0.0, 200.0),
            Stored::I16 => (Owned::I16((0..n).map(|i| (at(i) * 12.0 - 1000.0) as i16).collect()), -1000.0, 12.0),
            Stored::I32 => (Owned::I32((0..n).map(|i| (at(i) * 1000.0 - 5.0) as i32).collect()), -5.0, 1000.0),
            Stored::F32 => (Owned::F32((0..n).map(|i| (at(i) * 0.01) as f32).collect()), 0.0, 0.01),
            Stored::F32WithHoles => {
                let value =
                    |i: usize| if i.is_multiple_of(97) || i % 331 < 4 { f32::NAN } else { (at(i) * 0.01) as f32 };
                (Owned::F32((0..n).map(value).collect()), 0.0, 0.01)
            }
        }
    }

    fn transfer_function(&self, offset: f64, scale: f64) -> TransferFunction {
        let own = |density: f64| offset + scale * density;
        let opacity = self.opacity.iter().map(|&(d, opacity)| OpacityNode { value: own(d), opacity }).collect();
        let colors = [(0.0, [0.2, 0.3, 0.8]), (110.0, [0.9, 0.5, 0.3]), (255.0, [1.0, 1.0, 0.9])];
        let color = colors.iter().map(|&(d, rgb)| ColorNode { value: own(d), rgb }).collect();
        let tf = TransferFunction::new(opacity, color, None).unwrap();
        if self.is_joint {
            let values = [0.0, 60.0, 160.0, 260.0].map(own).to_vec();
            let magnitudes = [0.0, 20.0, 90.0].map(|m| m * scale).to_vec();
            let rgba = (0..12).map(|i| {
                let (value, magnitude) = (f64::from(i % 4) / 3.0, f64::from(i / 4) / 2.0);
                [0.9, 0.4 + 0.5 * value, 1.0 - magnitude, 0.5 * value * (0.2 + 0.8 * magnitude)]
            });
            let joint = TransferFunction2D::new(values, magnitudes, rgba.collect()).unwrap();
            return TransferFunction::two_dimensional(joint, None).unwrap();
        }
        if self.gradient.is_empty() {
            return tf;
        }
        let nodes = self.gradient.iter().map(|&(m, factor)| GradientNode { magnitude: m * scale, factor });
        tf.with_gradient_opacity(nodes.collect()).unwrap()
    }

    /// Draws the scene on a GPU, cut by a schedule.
    pub fn draw_by(&self, gpu: &Gpu, schedule: Schedule) -> Drawn {
        let mut result = None;
        self.with_plan(&mut |plan, layers| {
            let (pictures, report) = gpu.draw_base_planes_by(schedule, plan, &slices_of(layers), &()).unwrap();
            result = Some(Drawn { picture: finish(plan, &pictures), report: Some(report) });
        });
        result.unwrap()
    }

    /// Draws the scene on a GPU or on the CPU.
    pub fn draw(&self, gpu: Option<&Gpu>) -> Drawn {
        if let Some(gpu) = gpu {
            return self.draw_by(gpu, Schedule::default());
        }
        let mut result = None;
        self.with_plan(&mut |plan, layers| {
            let (pictures, _) = draw_base_planes(plan, &slices_of(layers), &()).unwrap();
            result = Some(Drawn { picture: finish(plan, &pictures), report: None });
        });
        result.unwrap()
    }

    /// Calls `work` with the plan of the scene and its layers.
    pub fn with_plan(&self, work: &mut dyn FnMut(&Plan, &[Layer])) {
        let (owned, offset, scale) = self.owned();
        let affine = DAffine3::from_scale(DVec3::new(1.0, 1.2, 0.9));
        let volume = Volume::new("scene", owned.samples(), self.size, affine).unwrap();
        let other_affine =
            DAffine3 { translation: DVec3::new(4.0, 3.0, 2.0), ..DAffine3::from_scale(DVec3::new(0.7, 0.8, 0.6)) };
        let other = Volume::new("other", owned.samples(), self.size, other_affine).unwrap();
        let volumes = [volume, other];
        let tf = self.transfer_function(offset, scale);
        let (slices, cache) = (
            volumes.each_ref().map(|volume| Slices::new(volume, self.kernel)),
            [VisibilityCache::default(), VisibilityCache::default()],
        );
        let labels = self.has_labels.then(|| self.labels(volumes[0].grid()));
        let layers: Vec<Layer> = (0..self.n_layers)
            .map(|k| Layer {
                slices: &slices[k],
                transfer_function: &tf,
                shading: self.shading.as_ref(),
                labels: labels.as_ref().filter(|_| k == 0),
                color: None,
                cache: &cache[k],
            })
            .collect();
        let options =
            RenderOptions { composite: self.composite, shading: self.shading.clone(), ..self.options.clone() };
        let plan = Plan::new(Level::best(), &layers, &self.camera(), &options).unwrap();
        work(&plan, &layers);
    }

    fn labels(&self, grid: &wavesplat_core::Grid) -> Labels {
        let [nx, ny, nz] = self.size;
        let code = |i: usize| {
            let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
            match (x > nx / 2, y > ny / 2, z > nz / 2) {
                (true, true, _) => 1,
                (false, _, true) => 2,
                (true, false, true) => 3,
                _ => 0_u8,
            }
        };
        let codes: Vec<u8> = (0..nx * ny * nz).map(code).collect();
        let plain = LabelLook::NONE;
        let looks = vec![
            plain,
            LabelLook { rgb: [1.0, 0.2, 0.1], tint: 0.7, ..plain },
            LabelLook { rgb: [0.2, 0.9, 0.1], opacity: 0.3, scan: 0.5, ..plain },
            LabelLook { scan: 0.0, ..plain },
        ];
        Labels::new(Codes::U8(codes.into()), looks, grid, Kernel::Linear, 1 << 28).unwrap()
    }

    fn camera(&self) -> Camera {
        let middle = DVec3::new(1.0, 1.2, 0.9) * DVec3::from_array(self.size.map(|n| (n - 1) as f64 / 2.0));
        let parallel_scale = 0.65 * self.size[0] as f64;
        match self.eye {
            None => camera_towards(middle, self.from, 80.0, Projection::Orthographic { parallel_scale }),
            Some(distance) => {
                let view_angle_rad = if distance < 15.0 { 1.6 } else { 0.6 };
                camera_towards(middle, self.from, distance, Projection::Perspective { view_angle_rad })
            }
        }
    }
}

/// Difference of two pictures, in grey levels of 255.
#[derive(Debug)]
pub struct Difference {
    /// Share of pixels within one level.
    pub within_one: f64,
    /// Largest difference.
    pub most: f64,
    /// Mean alpha, or share of pixels with a value, so that nothing is compared with nothing.
    pub coverage: f64,
    /// Largest difference of the values of a projection, as a share of their range.
    pub of_values: f64,
}

/// Compares two pictures.
pub fn difference(got: &Picture, want: &Picture) -> Difference {
    let pixel = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..4)
            .map(|c| f64::from((a[c] - b[c]).abs()) * 255.0)
            .fold(0.0, |m: f64, d| if d.is_nan() { 255.0 } else { m.max(d) })
    };
    let levels: Vec<f64> = got.rgba.iter().zip(&want.rgba).map(pixel).collect();
    let n = levels.len() as f64;
    let mut coverage = want.rgba.iter().map(|rgba| f64::from(rgba[3])).sum::<f64>() / n;
    let mut of_values = 0.0;
    if let (Some(got), Some(want)) = (&got.value, &want.value) {
        let known: Vec<f64> = want.iter().filter(|v| !v.is_nan()).map(|v| f64::from(*v)).collect();
        let range = known.iter().fold(1e-9, |m: f64, v| m.max(v.abs()));
        coverage = known.len() as f64 / n;
        let apart = |(a, b): (&f32, &f32)| match (a.is_nan(), b.is_nan()) {
            (true, true) => 0.0,
            (false, false) => f64::from((a - b).abs()) / range,
            _ => 1.0,
        };
        of_values = got.iter().zip(want).map(apart).fold(0.0, f64::max);
    }
    Difference {
        within_one: levels.iter().filter(|d| **d <= 1.0).count() as f64 / n,
        most: levels.iter().copied().fold(0.0, f64::max),
        coverage,
        of_values,
    }
}

/// Crop box and oblique clip plane of the scenes.
pub fn cuts() -> (Crop, Vec<ClipPlane>) {
    let crop = Crop::Index { lo: DVec3::new(2.3, 1.0, 3.7), hi: DVec3::new(22.0, 18.4, 16.0) };
    let plane = ClipPlane { origin: DVec3::new(12.0, 12.0, 9.0), normal: DVec3::new(-0.4, 0.7, 0.6) };
    (crop, vec![plane])
}
