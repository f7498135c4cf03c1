//! Phantoms: volumes whose pictures are known, or can be computed.

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{
    Camera, ColorNode, Composite, Decoder, OpacityNode, Projection, Samples, TransferFunction, Volume,
};

/// Every projection, with parameters that suit [`Phantom::sheared_waves`].
pub const PROJECTIONS: [Composite; 8] = [
    Composite::Maximum,
    Composite::DepthShadedMaximum { strength: 0.7, black: 60.0 },
    Composite::AttenuatedMaximum { black: 60.0, white: 200.0, attenuation: 0.1 },
    Composite::LocalMaximum { threshold: 150.0 },
    Composite::Minimum,
    Composite::Mean,
    Composite::Sum,
    Composite::XRay { clear: 90.0, attenuation: 0.004 },
];

/// An owned volume of f32 samples.
#[derive(Clone, Debug)]
pub struct Phantom {
    /// Samples, x fastest.
    pub samples: Vec<f32>,
    /// `[nx, ny, nz]`.
    pub size: [usize; 3],
    /// World position of an index position.
    pub world_from_index: DAffine3,
}

impl Decoder for Phantom {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let [nx, ny, _] = self.size;
        let mut rows = out.chunks_exact_mut(hi[0] - lo[0]);
        for z in lo[2]..hi[2] {
            for y in lo[1]..hi[1] {
                let row = &self.samples[(z * ny + y) * nx..][lo[0]..hi[0]];
                rows.next().expect("the box has room").copy_from_slice(row);
            }
        }
    }
}

impl Phantom {
    /// Samples a function of the world position.
    pub fn sample(size: [usize; 3], world_from_index: DAffine3, mut value: impl FnMut(DVec3) -> f64) -> Self {
        let [nx, ny, nz] = size;
        let mut samples = Vec::with_capacity(nx * ny * nz);
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let index = DVec3::new(i as f64, j as f64, k as f64);
                    samples.push(value(world_from_index.transform_point3(index)) as f32);
                }
            }
        }
        Self { samples, size, world_from_index }
    }

    /// A volume with the same value everywhere.
    pub fn fog(size: [usize; 3], world_from_index: DAffine3, value: f64) -> Self {
        Self::sample(size, world_from_index, |_| value)
    }

    /// A ball: 255 inside, 0 outside, with a ramp `2 · blur` wide across the radius.
    pub fn ball(size: [usize; 3], world_from_index: DAffine3, centre: DVec3, radius: f64, blur: f64) -> Self {
        Self::sample(size, world_from_index, |p| {
            255.0 * ((radius - p.distance(centre)) / (2.0 * blur) + 0.5).clamp(0.0, 1.0)
        })
    }

    /// The ripples of Marschner & Lobb (1994) on `[−1, 1]³`, 0..255, unit spacing.
    pub fn ripples(n: usize) -> Self {
        let scale = 2.0 / (n - 1) as f64;
        Self::sample([n; 3], DAffine3::IDENTITY, |p| 255.0 * ripples_signal(p * scale - 1.0))
    }

    /// Waves of values 10 to 230 on a small grid that is sheared, anisotropic and off the origin.
    pub fn sheared_waves() -> Self {
        let shear = DMat3::from_cols(DVec3::new(1.1, 0.0, 0.1), DVec3::new(0.0, 0.9, 0.0), DVec3::new(0.1, 0.2, 1.4));
        let affine = DAffine3 { matrix3: shear, translation: DVec3::new(3.0, -2.0, 7.0) };
        Self::sample([11, 10, 9], affine, |p| {
            120.0 + 60.0 * (p.x * 0.8).sin() * (p.y * 0.6).cos() + 50.0 * (p.z * 0.5 + p.x * 0.3).sin()
        })
    }

    /// The phantom as a volume.
    pub fn volume(&self) -> Volume<'_> {
        let volume = Volume::new("phantom", Samples::F32(&self.samples), self.size, self.world_from_index);
        volume.expect("phantoms are valid volumes")
    }

    /// World position of the middle of the box.
    pub fn centre(&self) -> DVec3 {
        self.world_from_index.transform_point3(self.volume().grid().last_index() / 2.0)
    }
}

/// Marschner & Lobb's test signal with `f_M = 6` and `α = 0.25`, `0..=1`.
pub fn ripples_signal(p: DVec3) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    let (frequency, alpha) = (6.0, 0.25);
    let rho = (TAU * frequency * (FRAC_PI_2 * p.x.hypot(p.y)).cos()).cos();
    (1.0 - (PI * p.z / 2.0).sin() + alpha * (1.0 + rho)) / (2.0 * (1.0 + alpha))
}

/// A camera that looks at `focal` from the direction `from`, at `distance`.
pub fn camera_towards(focal: DVec3, from: DVec3, distance: f64, projection: Projection) -> Camera {
    let from = from.normalize();
    let up = if from.z.abs() > 0.99 { DVec3::Y } else { DVec3::Z };
    Camera::new(focal + distance * from, focal, up, projection).expect("test cameras are valid")
}

/// Transfer function with opacity through the nodes and colour from blue to white.
pub fn opacity_ramp(nodes: &[(f64, f64)], opacity_unit: Option<f64>) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = [(0.0, [0.2, 0.3, 0.8]), (100.0, [0.9, 0.6, 0.4]), (255.0, [1.0, 1.0, 1.0])];
    let color = color.iter().map(|&(value, rgb)| ColorNode { value, rgb }).collect();
    TransferFunction::new(opacity, color, opacity_unit).expect("test curves are valid")
}
