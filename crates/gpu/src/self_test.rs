//! Self-test of a device at opening: samples of every format as they were stored, the exponential, and a small picture
//! against the CPU's. A device that fails is not used.

use glam::{DAffine3, DVec3};
use wavesplat_compute::simd::{Level, Plain};
use wavesplat_core::Kernel;
use wavesplat_core::{
    Camera, ColorNode, OpacityNode, Projection, RenderOptions, Samples, Shading, TransferFunction, Volume,
};
use wavesplat_splat::Layer;
use wavesplat_splat::optics::classify::one_minus_exp_neg;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::source::slices::Slices;

use crate::device::OpenDevice;
use crate::failure::{Failure, GpuResult};
use crate::layout::{GpuFrame, GpuLayer, GpuSource};
use crate::numbers::Numbers;
use crate::permutation::{
    ByGradient, FieldKinds, Format, GpuOperator, GradientTaps, LayerKind, Permutation, SourceKind,
};
use crate::samples::SampleTexture;
use crate::stage::Stage;

/// Samples of the volume of the test along x, y, z; quads begin at all but the last of x and y.
const SIZE: [usize; 3] = [7, 5, 3];

/// Number of exponents that are tried, and relative tolerance of the exponential.
const N_EXPONENTS: usize = 64;
const EXPONENTIAL_IS_NEAR: f32 = 1e-6;

/// Tolerance of a texel of the small picture: half a grey level.
const PICTURE_IS_NEAR: f32 = 0.5 / 255.0;

/// Sample i of the test volume: its stored bytes and its density.
type StoredSample = fn(usize) -> (Vec<u8>, f32);

const FORMATS: [(&str, Format, StoredSample); 5] = [
    ("unsigned bytes", Format::Byte { is_signed: false }, |i| (vec![spread(i) as u8], f32::from(spread(i) as u8))),
    ("signed bytes", Format::Byte { is_signed: true }, |i| {
        (vec![spread(i) as u8 ^ 0x80], f32::from(spread(i) as u8 as i8))
    }),
    ("unsigned 16-bit samples", Format::Pair { is_signed: false }, |i| {
        (spread(i).to_le_bytes().to_vec(), f32::from(spread(i)))
    }),
    ("signed 16-bit samples", Format::Pair { is_signed: true }, |i| {
        ((spread(i) ^ 0x8000).to_le_bytes().to_vec(), f32::from(spread(i) as i16))
    }),
    ("f32 samples", Format::Float, |i| {
        let value = f32::from(spread(i)) * 1.7e-3 - 41.0;
        (value.to_le_bytes().to_vec(), value)
    }),
];

/// Numbers that use all bits, the ends of the range among them.
fn spread(i: usize) -> u16 {
    match i {
        0 => 0,
        1 => u16::MAX,
        _ => (i as u32 * 40_503 % 65_536) as u16,
    }
}

/// Whether this device fetches four samples at once correctly; one that reads no samples correctly is not trusted.
/// `fails`: make the test fail.
pub(crate) fn test_samples(device: &OpenDevice, fails: bool) -> GpuResult<bool> {
    if fails {
        return Err(Failure::Untrusted("its self-test was made to fail".to_owned()));
    }
    let wrong_gather = wrong_samples(device, true)?;
    if wrong_gather.is_none() {
        return Ok(true);
    }
    match wrong_samples(device, false)? {
        None => Ok(false),
        Some(what) => Err(Failure::Untrusted(format!("{} reads {what} wrong", device.adapter.name))),
    }
}

/// Name of the format or function that the device gets wrong, if any.
fn wrong_samples(device: &OpenDevice, gather: bool) -> GpuResult<Option<String>> {
    for (name, format, stored) in FORMATS {
        let permutation = probe_permutation(format, gather);
        let texture = SampleTexture::new(device, SIZE, format)?;
        let n_samples: usize = SIZE.iter().product();
        let bytes: Vec<u8> = (0..n_samples).flat_map(|i| stored(i).0).collect();
        texture.write(device, [0; 3], SIZE, &bytes);
        let places: Vec<[usize; 3]> = (0..n_samples)
            .map(|i| [i % SIZE[0], i / SIZE[0] % SIZE[1], i / SIZE[0] / SIZE[1]])
            .filter(|[x, y, _]| *x + 1 < SIZE[0] && *y + 1 < SIZE[1])
            .collect();
        let exponents: Vec<f32> = (0..N_EXPONENTS).map(|k| 1e-6 * 1.4_f32.powi(k as i32)).collect();
        let mut source = GpuSource::default();
        source.lies_in(SIZE, 0);
        let numbers = Numbers {
            frame: GpuFrame { blocks: [0, places.len() as u32, 1, 1], ..GpuFrame::default() },
            layers: vec![GpuLayer::default()],
            sources: vec![source],
            tables: exponents.iter().map(|x| [*x; 4]).collect(),
            words: places.as_flattened().iter().map(|i| *i as u32).collect(),
        };
        let n = places.len() + exponents.len();
        let entry = include_str!("shaders/probe.wgsl");
        let stage = Stage { permutation: &permutation, entry, numbers: &numbers, texture: &texture, n };
        let got = stage.run(device)?;
        for ([x, y, z], got) in places.iter().zip(&got) {
            let density = |x: usize, y: usize| stored(x + SIZE[0] * (y + SIZE[1] * z)).1;
            if *got != [density(*x, *y), density(x + 1, *y), density(*x, y + 1), density(x + 1, y + 1)] {
                return Ok(Some(name.to_owned()));
            }
        }
        for (x, got) in exponents.iter().zip(&got[places.len()..]) {
            let want = one_minus_exp_neg(Plain, [*x; 16])[0];
            if got[0].is_nan() || (got[0] - want).abs() > EXPONENTIAL_IS_NEAR * want {
                return Ok(Some("the exponential".to_owned()));
            }
        }
    }
    Ok(None)
}

/// Permutation of the probe: all but the format is fixed.
fn probe_permutation(format: Format, gather: bool) -> Permutation {
    let source = SourceKind { kernel: Kernel::Linear, format, gradient: GradientTaps::Nothing, has_holes: false };
    Permutation {
        operator: GpuOperator::FirstHit,
        layers: vec![LayerKind { is_shaded: false, evens_cuts: false, by_gradient: ByGradient::Nothing }],
        sources: vec![source],
        fields: FieldKinds::default(),
        gather,
        with_depth: false,
        counted: false,
    }
}

/// Compares a small picture with the CPU's. `name`: name of the GPU; `draw`: draws a plan's base planes on it.
pub(crate) fn test_picture(
    name: &str,
    draw: impl Fn(&Plan, &[&Slices]) -> GpuResult<Vec<BasePicture>>,
) -> GpuResult<()> {
    const N: usize = 8;
    let at = |i: usize| DVec3::new((i % N) as f64, (i / N % N) as f64, (i / N / N) as f64) - 3.5;
    let sample = |i: usize| (255.0 * (1.0 - at(i).length() / 5.0).clamp(0.0, 1.0)) as u8;
    let samples: Vec<u8> = (0..N * N * N).map(sample).collect();
    let wrong = |what: &str| Failure::Untrusted(format!("{name} {what}"));
    let volume = Volume::new("self-test", Samples::U8(&samples), [N; 3], DAffine3::IDENTITY);
    let opacity = [(40.0, 0.0), (200.0, 0.6)].map(|(value, opacity)| OpacityNode { value, opacity });
    let color = [(0.0, [0.2, 0.4, 1.0]), (255.0, [1.0, 0.8, 0.3])].map(|(value, rgb)| ColorNode { value, rgb });
    let tf = TransferFunction::new(opacity.to_vec(), color.to_vec(), None);
    let projection = Projection::Perspective { view_angle_rad: 0.6 };
    let camera = Camera::new(DVec3::new(13.0, 9.0, 11.0), DVec3::splat(3.5), DVec3::Z, projection);
    let (Ok(volume), Ok(tf), Ok(camera)) = (volume, tf, camera) else { return Err(wrong("has no self-test")) };
    let shading = Shading::default();
    let options = RenderOptions {
        width_px: 24,
        height_px: 20,
        shading: Some(shading.clone()),
        sheets_per_slice: 2.0,
        ..RenderOptions::default()
    };
    let (slices, cache) = (Slices::new(&volume, Kernel::Linear), VisibilityCache::default());
    let layer = Layer {
        slices: &slices,
        transfer_function: &tf,
        shading: Some(&shading),
        labels: None,
        color: None,
        cache: &cache,
    };
    let plan = Plan::new(Level::best(), &[layer], &camera, &options);
    let Ok(plan) = plan else { return Err(wrong("has no self-test")) };
    let Ok((want, _)) = draw_base_planes(&plan, &[&slices], &()) else { return Err(wrong("has no self-test")) };
    let got = draw(&plan, &[&slices])?;
    for (got, want) in got.iter().zip(&want) {
        let (got, want) = (got.texels(), want.texels());
        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() <= PICTURE_IS_NEAR;
        if !got.as_flattened().iter().zip(want.as_flattened()).all(is_near) {
            return Err(wrong("draws a small picture otherwise than the CPU"));
        }
    }
    Ok(())
}
