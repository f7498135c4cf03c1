//! One scene by every interface: this crate, Python and the command line give the bytes of
//! `crates/wavesplat/tests/door.png`.
//!
//! `python/tests/house/test_rust_door.py` draws it in Python, from the same numbers.

use glam::{DAffine3, DVec3};
use wavesplat::{
    Camera, ColorNode, Composite, Error, FrameOptions, Kernel, OpacityNode, Plane, PngBits, Projection, Reduction,
    Samples, Scene, SceneLayer, SceneVolume, ThickSlab, TransferFunction, Volume, encode_png,
};

const N: usize = 20;

fn samples() -> Vec<u8> {
    let at = |i: usize| {
        let [x, y, z] = [i % N, i / N % N, i / (N * N)].map(|k| k as i64);
        (255 - 3 * ((x - 9) * (x - 9) + (y - 11) * (y - 11)) - 4 * (z - 8) * (z - 8)).clamp(0, 255) as u8
    };
    (0..N * N * N).map(at).collect()
}

fn look() -> TransferFunction {
    let opacity = [(100.0, 0.0), (200.0, 0.4)].map(|(value, opacity)| OpacityNode { value, opacity });
    let color = [(100.0, [0.2, 0.4, 0.8]), (250.0, [1.0, 0.75, 0.5])].map(|(value, rgb)| ColorNode { value, rgb });
    TransferFunction::new(opacity.to_vec(), color.to_vec(), None).unwrap()
}

fn camera() -> Camera {
    let projection = Projection::Orthographic { parallel_scale: 12.0 };
    Camera::new(DVec3::new(50.0, -30.0, 40.0), DVec3::new(9.5, 9.5, 9.5), DVec3::Z, projection).unwrap()
}

#[test]
fn the_picture_is_that_of_the_other_doors() {
    let samples = samples();
    let volume = Volume::new("door", Samples::U8(&samples), [N; 3], DAffine3::IDENTITY).unwrap();
    let frame = Scene::new(volume, look()).render(&camera(), [64, 48], &FrameOptions::default()).unwrap();
    let golden = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/door.png")).unwrap();
    assert!(
        encode_png(&frame.picture, PngBits::Eight).unwrap() == golden,
        "crates/wavesplat/tests/door.png is another picture"
    );
}

#[test]
fn what_is_kept_changes_no_picture() {
    let samples = samples();
    let volume = || Volume::new("door", Samples::U8(&samples), [N; 3], DAffine3::IDENTITY).unwrap();
    let scene = Scene::new(volume(), look());
    let first = scene.render(&camera(), [64, 48], &FrameOptions::default()).unwrap().picture;
    let options = FrameOptions { composite: Composite::Maximum, ..FrameOptions::default() };
    assert!(scene.render(&camera(), [64, 48], &options).unwrap().picture.value.is_some());
    assert!(scene.render(&camera(), [64, 48], &FrameOptions::default()).unwrap().picture == first);
    // Another scene with the same cache.
    let SceneVolume::Samples(_, cache) = &scene.layers[0].volume else { unreachable!("it was made of samples") };
    let again = Scene::of(vec![SceneLayer::new(SceneVolume::Samples(volume(), cache.clone()), look())]);
    assert!(again.render(&camera(), [64, 48], &FrameOptions::default()).unwrap().picture == first);
}

#[test]
fn times_are_told_where_there_is_a_clock() {
    let samples = samples();
    let volume = Volume::new("door", Samples::U8(&samples), [N; 3], DAffine3::IDENTITY).unwrap();
    let scene = Scene::new(volume, look());
    let options = FrameOptions { clock: Some(|| 1.5), ..FrameOptions::default() };
    assert_eq!(scene.render(&camera(), [8, 8], &options).unwrap().times, Some(wavesplat::StageTimes::default()));
    assert_eq!(scene.render(&camera(), [8, 8], &FrameOptions::default()).unwrap().times, None);
}

#[test]
fn a_slice_through_samples_has_their_values() {
    let samples = samples();
    let volume = Volume::new("door", Samples::U8(&samples), [N; 3], DAffine3::IDENTITY).unwrap();
    let scene = Scene::new(volume, look());
    let plane = Plane { origin: DVec3::Z * 8.0, across: DVec3::X, down: DVec3::Y, width_px: N, height_px: N };
    let slice = |n_planes, reduction| {
        let slab = ThickSlab { reduction, n_planes, step: DVec3::Z };
        scene.layers[0].volume.slice(&plane, &slab, Kernel::Linear, None, &())
    };
    let of_layer = |z: usize| samples[z * N * N..(z + 1) * N * N].iter().map(|s| f32::from(*s)).collect::<Vec<_>>();
    assert_eq!(slice(1, Reduction::Mean).unwrap(), of_layer(8));
    let largest: Vec<f32> = of_layer(8).iter().zip(of_layer(9)).map(|(a, b)| a.max(b)).collect();
    assert_eq!(slice(2, Reduction::Maximum).unwrap(), largest);
    assert!(matches!(slice(0, Reduction::Mean), Err(Error::OutOfRange { .. })));
}
