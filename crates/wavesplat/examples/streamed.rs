//! A raw file that is larger than the memory for its samples, read while it is drawn.

mod common;

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::sync::Arc;
use std::sync::Mutex;

use wavesplat::{
    FrameOptions, IndexBox, Kernel, LazyVolume, SampleBuffer, SampleReader, Scene, SceneLayer, SceneVolume,
    StreamOptions,
};

/// Samples along each axis of the file: 33 MB, of which 4 MB are in memory at once.
const N: usize = 320;
const BUDGET_BYTES: usize = 4 << 20;

/// A file of 8-bit samples, x fastest, then y, then z.
struct RawFile(Mutex<File>);

impl SampleReader for RawFile {
    fn size(&self) -> [usize; 3] {
        [N; 3]
    }

    fn read(&self, part: &IndexBox) -> io::Result<SampleBuffer> {
        let [x, y, z] = part;
        let mut samples = vec![0; x.len() * y.len() * z.len()];
        let mut rows = samples.chunks_exact_mut(x.len());
        let mut file = self.0.lock().map_err(|_| io::Error::other("another read has failed"))?;
        for z in z.clone() {
            for y in y.clone() {
                let Some(row) = rows.next() else { break };
                file.seek(SeekFrom::Start(((z * N + y) * N + x.start) as u64))?;
                file.read_exact(row)?;
            }
        }
        Ok(SampleBuffer::U8(samples))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::temp_dir().join(format!("wavesplat-streamed-{}.raw", std::process::id()));
    let mut file = BufWriter::new(File::create(&path)?);
    for z in 0..N {
        file.write_all(&shells(z))?;
    }
    file.flush()?;
    drop(file);
    let reader = RawFile(Mutex::new(File::open(&path)?));

    let world_from_index = common::world_from_index() * glam::DAffine3::from_scale(glam::DVec3::splat(0.3));
    let volume = LazyVolume::survey("shells", &reader, world_from_index, Kernel::Linear, BUDGET_BYTES)?;
    let look =
        common::look(&[(90.0, 0.0), (120.0, 0.2), (150.0, 0.0)], &[(90.0, [0.3, 0.6, 1.0]), (150.0, [1.0, 0.8, 0.5])])?;
    let mut scene = Scene::of(vec![SceneLayer::new(SceneVolume::Lazy(Arc::new(volume)), look)]);
    scene.background = Some([0.0, 0.0, 0.0, 1.0]);
    let options = StreamOptions { budget_bytes: BUDGET_BYTES, ..StreamOptions::default() };
    let mut stream = scene.stream(&common::camera()?, [512, 512], &FrameOptions::default(), &options)?;
    let held = (0..stream.n_blocks()).map(|block| stream.peak_sample_bytes(block)).max().unwrap_or(0);
    println!("{} blocks; at most {held} bytes of the {} are held", stream.n_blocks(), N * N * N);
    let frame = stream.read_and_draw(&[&reader], &())?;
    common::save(&frame, "streamed.png")?;
    std::fs::remove_file(&path)?;
    Ok(())
}

/// A slice of nested shells.
fn shells(z: usize) -> Vec<u8> {
    let middle = (N - 1) as f64 / 2.0;
    let at = |i: usize| {
        let [x, y, z] = [i % N, i / N, z].map(|k| (k as f64 - middle) / middle);
        let radius = (x * x + y * y + z * z).sqrt();
        if radius > 0.95 { 0 } else { (127.5 + 127.5 * (radius * 30.0).cos()) as u8 }
    };
    (0..N * N).map(at).collect()
}
