//! Level of detail: coarser levels of a volume that are as bright as the finest.
//!
//! A coarser level has fewer samples, each of which stands for many. Classified by their mean, thin walls vanish and
//! the picture gets darker. A [`LevelHistogram`] has the distribution of samples for each coarse value and makes the
//! transfer function that the level is to be drawn with in place of the given one: averaged in opacity, then scaled
//! until rays through the level are as bright as rays through the finest samples.
//!
//! Its inputs are two [`wavesplat_core::Decoder`]s, of the finest level and of the coarser one, so any pyramid will do:
//! wavelets, OME-Zarr, or levels in memory.
//!
//! ```
//! use wavesplat_core::{ColorNode, Decoder, LevelGrid, OpacityNode, TransferFunction};
//! use wavesplat_lod::LevelHistogram;
//!
//! /// Samples in memory, `[z][y][x]`.
//! struct InMemory([usize; 3], Vec<f32>);
//!
//! impl Decoder for InMemory {
//!     fn size(&self) -> [usize; 3] {
//!         self.0
//!     }
//!     fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
//!         let [nx, ny, _] = self.0;
//!         let rows = (lo[2]..hi[2]).flat_map(|z| (lo[1]..hi[1]).map(move |y| (z * ny + y) * nx));
//!         for (out, row) in out.chunks_exact_mut(hi[0] - lo[0]).zip(rows) {
//!             out.copy_from_slice(&self.1[row + lo[0]..row + hi[0]]);
//!         }
//!     }
//! }
//!
//! // Walls one sample thin, and a level of every second sample, of means: the walls are grey there.
//! let fine = InMemory([32; 3], (0..32 * 32 * 32).map(|i| if i % 4 == 2 { 100.0 } else { 0.0 }).collect());
//! let coarse = InMemory([16; 3], (0..16 * 16 * 16).map(|i| if i % 2 == 1 { 50.0 } else { 0.0 }).collect());
//! let grid = LevelGrid { origin: [0.0; 3], spacing: [2.0; 3], size: [16; 3] };
//! let histogram = LevelHistogram::new(&fine, &coarse, &grid, [1.0; 3], [0.0, 100.0], 1 << 20);
//!
//! let opacity = vec![OpacityNode { value: 60.0, opacity: 0.0 }, OpacityNode { value: 60.0, opacity: 0.5 }];
//! let color = vec![ColorNode { value: 0.0, rgb: [1.0; 3] }];
//! let tf = TransferFunction::new(opacity, color, None)?;
//! let of_level = histogram.filter(&tf, [1.0; 3], None, false)?;
//! assert!(tf.opacity(50.0) == 0.0 && of_level.opacity(50.0) > 0.1, "grey walls are drawn");
//! # Ok::<(), wavesplat_core::Error>(())
//! ```
//!
//! # Features
//!
//! `threads` (on by default): boxes and rays in parallel. Results are the same to the bit without it.

mod level_brightness;
mod level_histogram;
mod level_transfer_function;
mod probe_rays;
mod sample_box;

pub use level_histogram::LevelHistogram;
