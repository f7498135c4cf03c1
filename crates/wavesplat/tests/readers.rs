//! Volumes that are read while they are drawn give the pictures of the same samples in memory, to the byte.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DAffine3, DVec3};
use wavesplat::{
    Camera, ColorNode, Composite, Error, FrameOptions, IndexBox, Kernel, LazyVolume, OpacityNode, Picture, Projection,
    SampleBuffer, SampleReader, Samples, Scene, SceneColor, SceneLayer, SceneVolume, StreamError, StreamOptions,
    TransferFunction, Volume,
};

const SIZE: [usize; 3] = [40, 36, 120];
/// Of the 691,200 bytes of the samples.
const BUDGET_BYTES: usize = 300_000;

/// Samples in memory, given out box by box; counts the largest box.
struct Source {
    samples: Vec<f32>,
    size: [usize; 3],
    chunk: [usize; 3],
    largest: AtomicUsize,
    /// Reads after which every read fails.
    n_good: AtomicUsize,
}

impl Source {
    fn new(samples: Vec<f32>) -> Self {
        let (largest, n_good) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX));
        Self { samples, size: SIZE, chunk: [16, 16, 4], largest, n_good }
    }
}

impl SampleReader for Source {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn chunk(&self) -> [usize; 3] {
        self.chunk
    }

    fn read(&self, [x, y, z]: &IndexBox) -> io::Result<SampleBuffer> {
        if self.n_good.fetch_sub(1, Ordering::Relaxed) == 0 {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the disk is gone"));
        }
        let rows = z.clone().flat_map(|z| y.clone().map(move |y| (z * self.size[1] + y) * self.size[0]));
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

/// Samples of a field that covers [`SIZE`], coarser and with z the other way round, and where they lie.
fn heat(has_holes: bool) -> (Source, DAffine3) {
    let size = [21, 19, 31];
    let at = |i: usize| {
        let [x, y, z] = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])].map(|k| k as f32);
        if has_holes && (x + y + z) as usize % 11 == 3 {
            f32::NAN
        } else {
            100.0 + 5.0 * x - y + 40.0 * (z * 0.4).sin()
        }
    };
    let samples = (0..size.iter().product()).map(at).collect();
    let scale = DAffine3::from_scale(DVec3::new(2.0, 2.0, -4.0));
    let place = DAffine3 { translation: DVec3::new(0.0, 0.0, 119.0), ..scale };
    (Source { size, chunk: [8, 5, 7], ..Source::new(samples) }, place)
}

#[test]
fn a_layer_and_the_field_that_colours_it_are_read_together() {
    let colors = [(100.0, [0.1, 0.9, 0.2]), (200.0, [1.0, 0.1, 0.6])].map(|(value, rgb)| ColorNode { value, rgb });
    let seen = [OpacityNode { value: 0.0, opacity: 1.0 }];
    let of_heat = TransferFunction::new(seen.to_vec(), colors.to_vec(), None).unwrap();
    for (kernel, has_holes, composite, is_alike) in [
        (Kernel::Linear, false, Composite::Over, false),
        (Kernel::Linear, true, Composite::Over, false),
        (Kernel::Bspline3, false, Composite::Over, true),
        (Kernel::Linear, true, Composite::FirstHit { iso_value: 130.0 }, true),
        (Kernel::CatmullRom, false, Composite::FirstHit { iso_value: 130.0 }, false),
    ] {
        let source = Source::new(waves(has_holes));
        let (field, place) =
            if is_alike { (Source::new(waves(has_holes)), DAffine3::IDENTITY) } else { heat(has_holes) };
        let options = FrameOptions { kernel, composite, ..FrameOptions::default() };
        let scene_of = |volume, field| {
            let color = Some(SceneColor { volume: field, transfer_function: of_heat.clone() });
            Scene::of(vec![SceneLayer { color, ..SceneLayer::new(volume, look()) }])
        };
        let in_memory = |source: &'static Source, place| {
            let samples = Samples::F32(&source.samples);
            SceneVolume::Samples(Volume::new("waves", samples, source.size, place).unwrap(), Arc::default())
        };
        let lazy = |source, place| {
            let volume = LazyVolume::survey("waves", source, place, kernel, BUDGET_BYTES).unwrap();
            SceneVolume::Lazy(Arc::new(volume))
        };
        let (source, field): (&'static Source, &'static Source) = (Box::leak(source.into()), Box::leak(field.into()));
        let both = scene_of(in_memory(source, DAffine3::IDENTITY), in_memory(field, place));
        let wanted = both.render(&camera(), [50, 40], &options).unwrap().picture;
        let scene = scene_of(lazy(source, DAffine3::IDENTITY), lazy(field, place));
        let smallest = scene.smallest_budget(&camera(), [50, 40], &options, &StreamOptions::default()).unwrap();
        for budget_bytes in [smallest, 4 * smallest] {
            let streaming = StreamOptions { budget_bytes, ..StreamOptions::default() };
            let mut stream = scene.stream(&camera(), [50, 40], &options, &streaming).unwrap();
            let held = (0..stream.n_blocks()).map(|block| stream.peak_sample_bytes(block)).max();
            assert!(held.unwrap() <= budget_bytes as u64, "{kernel:?}: {held:?} bytes of {budget_bytes}");
            let got = stream.read_and_draw(&[source, field], &()).unwrap().picture;
            let bits = |picture: &Picture| picture.rgba.iter().map(|t| t.map(f32::to_bits)).collect::<Vec<_>>();
            assert!(bits(&got) == bits(&wanted), "{kernel:?} {composite:?}, holes: {has_holes}");
            assert!(got.rgba.iter().any(|texel| texel[3] > 0.1));
        }
        let mixed = scene_of(lazy(source, DAffine3::IDENTITY), in_memory(field, place));
        assert!(mixed.render(&camera(), [50, 40], &options).is_err());
        let streamed = mixed.stream(&camera(), [50, 40], &options, &StreamOptions::default());
        assert!(matches!(streamed, Err(Error::OutOfRange { .. })));
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
