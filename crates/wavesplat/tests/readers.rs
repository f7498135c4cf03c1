//! Volumes that are read while they are drawn give the pictures of the same samples in memory, to the byte.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DAffine3, DVec3};
use wavesplat::{
    Camera, ColorNode, Composite, Error, FrameOptions, IndexBox, Kernel, LazyVolume, OpacityNode, Picture, Projection,
    SampleBuffer, SampleReader, Samples, Scene, SceneLayer, SceneVolume, StreamError, StreamOptions, TransferFunction,
    Volume,
};

const SIZE: [usize; 3] = [40, 36, 120];
/// Of the 691,200 bytes of the samples.
const BUDGET_BYTES: usize = 300_000;

/// Samples in memory, given out box by box; counts the largest box.
struct Source {
    samples: Vec<f32>,
    largest: AtomicUsize,
    /// Reads after which every read fails.
    n_good: AtomicUsize,
}

impl Source {
    fn new(samples: Vec<f32>) -> Self {
        Self { samples, largest: AtomicUsize::new(0), n_good: AtomicUsize::new(usize::MAX) }
    }
}

impl SampleReader for Source {
    fn size(&self) -> [usize; 3] {
        SIZE
    }

    fn chunk(&self) -> [usize; 3] {
        [16, 16, 4]
    }

    fn read(&self, [x, y, z]: &IndexBox) -> io::Result<SampleBuffer> {
        if self.n_good.fetch_sub(1, Ordering::Relaxed) == 0 {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the disk is gone"));
        }
        let rows = z.clone().flat_map(|z| y.clone().map(move |y| (z * SIZE[1] + y) * SIZE[0]));
        let samples: Vec<f32> = rows.flat_map(|row| self.samples[row + x.start..row + x.end].to_vec()).collect();
        self.largest.fetch_max(samples.len(), Ordering::Relaxed);
        Ok(SampleBuffer::F32(samples))
    }
}

fn waves(has_holes: bool) -> Vec<f32> {
    let at = |i: usize| {
        let [x, y, z] = [i % SIZE[0], i / SIZE[0] % SIZE[1], i / (SIZE[0] * SIZE[1])].map(|k| k as f32);
        let value = 100.0 + 60.0 * (x * 0.4).sin() * (y * 0.3).cos() + 40.0 * (z * 0.5).sin();
        if has_holes && i % 997 == 5 { f32::NAN } else { value }
    };
    (0..SIZE.iter().product()).map(at).collect()
}

fn look() -> TransferFunction {
    let opacity = [(90.0, 0.0), (130.0, 0.3)].map(|(value, opacity)| OpacityNode { value, opacity });
    let color = [(90.0, [0.2, 0.4, 0.8]), (180.0, [1.0, 0.75, 0.5])].map(|(value, rgb)| ColorNode { value, rgb });
    TransferFunction::new(opacity.to_vec(), color.to_vec(), None).unwrap()
}

fn camera() -> Camera {
    let middle = DVec3::new(19.5, 17.5, 59.5);
    let projection = Projection::Perspective { view_angle_rad: 0.6 };
    Camera::new(middle + DVec3::new(150.0, -130.0, 90.0), middle, DVec3::Z, projection).unwrap()
}

fn lazy_scene(source: &Source, kernel: Kernel) -> Result<Scene<'static>, StreamError> {
    let volume = LazyVolume::survey("waves", source, DAffine3::IDENTITY, kernel, BUDGET_BYTES)?;
    Ok(Scene::of(vec![SceneLayer::new(SceneVolume::Lazy(Arc::new(volume)), look())]))
}

#[test]
fn pictures_are_those_of_samples_in_memory() {
    for (kernel, has_holes, composite) in [
        (Kernel::Linear, false, Composite::Over),
        (Kernel::Linear, true, Composite::Over),
        (Kernel::Bspline3, false, Composite::Over),
        (Kernel::CatmullRom, true, Composite::Maximum),
    ] {
        let source = Source::new(waves(has_holes));
        let options = FrameOptions { kernel, composite, ..FrameOptions::default() };
        let volume = Volume::new("waves", Samples::F32(&source.samples), SIZE, DAffine3::IDENTITY).unwrap();
        let wanted = Scene::new(volume, look()).render(&camera(), [50, 40], &options).unwrap().picture;
        let scene = lazy_scene(&source, kernel).unwrap();
        let smallest = scene.smallest_budget(&camera(), [50, 40], &options, &StreamOptions::default()).unwrap();
        let streaming = StreamOptions { budget_bytes: smallest, ..StreamOptions::default() };
        let mut stream = scene.stream(&camera(), [50, 40], &options, &streaming).unwrap();
        let got = stream.read_and_draw(&[&source], &()).unwrap().picture;
        let bits = |picture: &Picture| {
            let values = picture.value.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
            (picture.rgba.iter().map(|texel| texel.map(f32::to_bits)).collect::<Vec<_>>(), values)
        };
        assert!(bits(&got) == bits(&wanted), "{kernel:?}, holes: {has_holes}");
        assert!(got.rgba.iter().any(|texel| texel[3] > 0.1));
        // Splines and holes need samples from further around each box.
        let largest_bytes = 4 * source.largest.load(Ordering::Relaxed);
        if kernel == Kernel::Linear && !has_holes {
            assert!(largest_bytes <= BUDGET_BYTES / 2, "{largest_bytes} bytes were read at once");
        }
    }
}

#[test]
fn errors_of_readers_and_frames_reach_the_caller() {
    let source = Source::new(waves(false));
    let scene = lazy_scene(&source, Kernel::Linear).unwrap();
    let streaming = StreamOptions { budget_bytes: BUDGET_BYTES, ..StreamOptions::default() };
    let mut stream = scene.stream(&camera(), [50, 40], &FrameOptions::default(), &streaming).unwrap();
    let none = stream.read_and_draw(&[], &());
    assert!(matches!(none, Err(StreamError::Draw(Error::OutOfRange { .. }))));
    source.n_good.store(3, Ordering::Relaxed);
    let Err(StreamError::Read(error)) = stream.read_and_draw(&[&source], &()) else { panic!("it was read") };
    assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
    source.n_good.store(2, Ordering::Relaxed);
    assert!(matches!(lazy_scene(&source, Kernel::Linear), Err(StreamError::Read(_))));

    let empty = Source::new(vec![f32::NAN; SIZE.iter().product()]);
    assert!(matches!(lazy_scene(&empty, Kernel::Linear), Err(StreamError::Draw(Error::NoFiniteSample { .. }))));
}

/// A reader that gives one sample too few.
struct Short;

impl SampleReader for Short {
    fn size(&self) -> [usize; 3] {
        SIZE
    }

    fn read(&self, [x, y, z]: &IndexBox) -> io::Result<SampleBuffer> {
        Ok(SampleBuffer::U8(vec![7; x.len() * y.len() * z.len() - 1]))
    }
}

#[test]
fn too_few_samples_are_an_error_that_says_so() {
    let Err(error) = LazyVolume::survey("short", &Short, DAffine3::IDENTITY, Kernel::Linear, BUDGET_BYTES) else {
        panic!("they were enough")
    };
    assert!(error.to_string().contains("gave 0 samples of the 1"), "{error}");
}
