//! Samples that are read box by box, from files, networks or decoders, and volumes and frames of them.
//!
//! The caller implements [`SampleReader`]; [`LazyVolume::survey`] reads all samples once, and [`Stream::read_and_draw`]
//! reads what a frame needs while it is drawn. Both read in the caller's thread.

use std::io;
use std::ops::Range;

use glam::DAffine3;
use wavesplat_core::{Error, Grid, Kernel, SampleBuffer, Samples, Statistics};
use wavesplat_splat::render::stream::{IndexBox, Storage, volume_of};
use wavesplat_splat::source::slices::{Slices, VolumeBox, needed_samples};
use wavesplat_splat::source::strided::light_steps;
use wavesplat_splat::source::survey::Survey;
use wavesplat_splat::{ProgressCallback, ProgressPart};

use crate::block_state::BlockState;
use crate::frame::Frame;
use crate::lazy_volume::LazyVolume;
use crate::stream::Stream;

/// `n` zeros of the type of samples.
fn zeros_as(samples: &SampleBuffer, n: usize) -> SampleBuffer {
    match samples {
        SampleBuffer::U8(_) => SampleBuffer::U8(vec![0; n]),
        SampleBuffer::I8(_) => SampleBuffer::I8(vec![0; n]),
        SampleBuffer::U16(_) => SampleBuffer::U16(vec![0; n]),
        SampleBuffer::I16(_) => SampleBuffer::I16(vec![0; n]),
        SampleBuffer::U32(_) => SampleBuffer::U32(vec![0; n]),
        SampleBuffer::I32(_) => SampleBuffer::I32(vec![0; n]),
        SampleBuffer::F32(_) => SampleBuffer::F32(vec![0.0; n]),
        SampleBuffer::F64(_) => SampleBuffer::F64(vec![0.0; n]),
    }
}

/// Copies the samples that two boxes share; `false` where the types differ.
fn copy_shared(into: &mut SampleBuffer, own: &IndexBox, from: &SampleBuffer, other: &IndexBox) -> bool {
    match (into, from) {
        (SampleBuffer::U8(a), SampleBuffer::U8(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::I8(a), SampleBuffer::I8(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::U16(a), SampleBuffer::U16(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::I16(a), SampleBuffer::I16(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::U32(a), SampleBuffer::U32(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::I32(a), SampleBuffer::I32(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::F32(a), SampleBuffer::F32(b)) => copy_overlap(a, own, b, other),
        (SampleBuffer::F64(a), SampleBuffer::F64(b)) => copy_overlap(a, own, b, other),
        _ => return false,
    }
    true
}

fn copy_overlap<T: Copy>(into: &mut [T], own: &IndexBox, from: &[T], other: &IndexBox) {
    let shared = [0, 1, 2].map(|a| own[a].start.max(other[a].start)..own[a].end.min(other[a].end));
    if shared.iter().any(Range::is_empty) {
        return;
    }
    let row = |part: &IndexBox, y: usize, z: usize| {
        ((z - part[2].start) * part[1].len() + y - part[1].start) * part[0].len() + shared[0].start - part[0].start
    };
    for z in shared[2].clone() {
        for y in shared[1].clone() {
            let n = shared[0].len();
            into[row(own, y, z)..][..n].copy_from_slice(&from[row(other, y, z)..][..n]);
        }
    }
}

/// A source of the samples of a volume.
pub trait SampleReader {
    /// Number of samples along x, y, z.
    fn size(&self) -> [usize; 3];

    /// Size of a chunk along x, y, z, which the source reads at once: boxes are cut along chunks. A slice by default.
    fn chunk(&self) -> [usize; 3] {
        let [nx, ny, _] = self.size();
        [nx, ny, 1]
    }

    /// Reads the samples of a box, `x` fastest, always of the same type.
    ///
    /// # Errors
    ///
    /// Any error of the source; it ends the survey or the frame.
    fn read(&self, part: &IndexBox) -> io::Result<SampleBuffer>;
}

/// Error on reading or drawing samples from a [`SampleReader`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The samples could not be read.
    #[error("the samples could not be read: {0}")]
    Read(#[from] io::Error),
    /// The volume or the frame is not possible, or was cancelled.
    #[error(transparent)]
    Draw(#[from] Error),
}

/// Reads a box and checks that as many samples came as were asked for.
fn read_box(reader: &dyn SampleReader, part: &IndexBox) -> io::Result<SampleBuffer> {
    let samples = reader.read(part)?;
    let (n, expected) = (samples.len(), volume_of(part));
    if n == expected {
        return Ok(samples);
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidData,
        format!("the reader gave {n} samples of the {expected} of {part:?}"),
    ))
}

/// Boxes of at most about `max_samples` samples that fill a volume: chunks, joined along x, then y, then z.
fn boxes_of(size: [usize; 3], chunk: [usize; 3], max_samples: usize) -> Vec<IndexBox> {
    let mut step = [0, 1, 2].map(|a| chunk[a].clamp(1, size[a]));
    for a in 0..3 {
        let others = step.iter().product::<usize>() / step[a];
        let fitting = (max_samples / others.max(1) / step[a]).max(1) * step[a];
        step[a] = fitting.min(size[a]);
    }
    let ranges = |a: usize| (0..size[a]).step_by(step[a]).map(move |i| i..(i + step[a]).min(size[a]));
    ranges(2)
        .flat_map(|z| {
            ranges(1).flat_map(move |y| {
                ranges(0).map({
                    let z = z.clone();
                    move |x| [x, y.clone(), z.clone()]
                })
            })
        })
        .collect()
}

impl LazyVolume {
    /// A volume from one pass over all samples, or two: B-spline kernels, and holes (samples that are not finite), need
    /// a second one, which reads a margin around each box. `memory_bytes`: budget of which a box of samples takes a
    /// quarter, or a chunk where that is larger, and bounds of bricks another quarter.
    ///
    /// # Errors
    ///
    /// [`StreamError::Read`]; [`StreamError::Draw`] with the errors of [`wavesplat_core::Volume::new`].
    pub fn survey(
        name: &str,
        reader: &dyn SampleReader,
        world_from_index: DAffine3,
        kernel: Kernel,
        memory_bytes: usize,
    ) -> Result<Self, StreamError> {
        let size = reader.size();
        let any = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let (_, light_step) = light_steps(&Grid::new(name, size, world_from_index, any, true)?);
        // Types are known by the first read.
        let first = read_box(reader, &[0..1, 0..1, 0..1])?;
        let sample_bytes = first.sample_bytes();
        let boxes = boxes_of(size, reader.chunk(), memory_bytes / 4 / sample_bytes);
        let new_survey = || Survey::new(size, kernel, memory_bytes / 4, &[light_step]);
        let mut survey = new_survey();
        for part in &boxes {
            let samples = read_box(reader, part)?;
            survey.add(&volume_box(part, &samples));
        }
        let is_narrow = first.samples().is_narrow();
        let grid = Grid::new(name, size, world_from_index, survey.statistics(), is_narrow)?;
        let mut prepared = None;
        if Self::needs_prepared(&grid, kernel) {
            let own = prepared.insert(new_survey());
            for part in &boxes {
                let held = needed_samples(part, &grid, kernel);
                let samples = read_box(reader, &held)?;
                own.add_prepared(&Slices::of_box(&volume_box(&held, &samples), &grid, kernel, [0.0; 2]), part);
            }
        }
        let storage = Storage { chunk: reader.chunk(), sample_bytes };
        Ok(Self::new(grid, storage, kernel, &survey, prepared.as_ref(), 0, None)?)
    }
}

fn volume_box<'a>(part: &IndexBox, samples: &'a SampleBuffer) -> VolumeBox<'a> {
    VolumeBox {
        lo: part.each_ref().map(|r| r.start),
        size: part.each_ref().map(ExactSizeIterator::len),
        samples: samples.samples(),
    }
}

impl Stream {
    /// Reads the samples of all steps and draws them, and returns the picture; one reader per layer of the scene, in
    /// its order, and after these one per field that colours a layer. At most [`crate::StreamOptions::budget_bytes`] of
    /// samples are held.
    ///
    /// # Errors
    ///
    /// [`StreamError::Read`]; [`StreamError::Draw`] with [`Error::Cancelled`], or where there are too few readers.
    pub fn read_and_draw(
        &mut self,
        readers: &[&dyn SampleReader],
        callback: &dyn ProgressCallback,
    ) -> Result<Frame, StreamError> {
        let n_sources = self.n_sources();
        if readers.len() != n_sources {
            let needed = "as many as layers and fields that colour them";
            return Err(
                Error::out_of_range("number of readers", readers.len(), needed, "give one for each layer").into()
            );
        }
        let n_texels = (0..self.n_blocks()).map(|block| self.n_texels(block).max(1)).sum::<u64>() as f32;
        let mut before = 0.0;
        for block in 0..self.n_blocks() {
            let share = self.n_texels(block).max(1) as f32 / n_texels / self.n_steps(block).max(1) as f32;
            let mut states = Vec::new();
            for steps in self.segments(block) {
                let mut state = BlockState::default();
                let mut held: Vec<Option<(IndexBox, SampleBuffer)>> = vec![None; n_sources];
                for step in steps.clone() {
                    let reads = self.reads(block, step, step == steps.start, &state);
                    for (source, boxes) in reads.iter().enumerate() {
                        let part = self.held(block, step)[source].clone();
                        held[source] = Some(filled(readers[source], part, boxes, held[source].as_ref())?);
                    }
                    let samples: Vec<Samples<'_>> = held.iter().flatten().map(|(_, own)| own.samples()).collect();
                    let from = before + share * step as f32;
                    let part = ProgressPart { of: callback, from, to: from + share };
                    state = self.draw(block, step, &samples, &state, &part)?;
                    if self.is_done(block, &state) {
                        break;
                    }
                }
                states.push(state);
            }
            before += share * self.n_steps(block) as f32;
            self.put(block, self.fold(states));
        }
        Ok(self.picture())
    }
}

/// Samples of a box: some were held before, the others are read box by box.
fn filled(
    reader: &dyn SampleReader,
    part: IndexBox,
    boxes: &[IndexBox],
    before: Option<&(IndexBox, SampleBuffer)>,
) -> Result<(IndexBox, SampleBuffer), StreamError> {
    let mut read = Vec::with_capacity(boxes.len());
    for own in boxes {
        read.push((own.clone(), read_box(reader, own)?));
    }
    let sources = || before.into_iter().chain(&read);
    let mut samples = match sources().next() {
        Some((_, one)) => zeros_as(one, volume_of(&part)),
        // Nothing of the box is visible; the type alone counts.
        None => zeros_as(&read_box(reader, &[0..1, 0..1, 0..1])?, volume_of(&part)),
    };
    for (own, from) in sources() {
        if !copy_shared(&mut samples, &part, from, own) {
            let problem = io::Error::new(io::ErrorKind::InvalidData, "the reader gave samples of two types");
            return Err(problem.into());
        }
    }
    Ok((part, samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_fill_the_volume_along_chunks() {
        for (size, chunk, max_samples) in [
            ([10, 7, 5], [4, 7, 1], 20),
            ([10, 7, 5], [10, 7, 1], 140),
            ([3, 3, 3], [64; 3], 1),
            ([9, 8, 7], [2; 3], 1 << 20),
        ] {
            let mut seen = vec![0; size.iter().product()];
            for part in boxes_of(size, chunk, max_samples) {
                assert!(volume_of(&part) <= max_samples.max(chunk.iter().product()));
                for z in part[2].clone() {
                    for y in part[1].clone() {
                        for x in part[0].clone() {
                            seen[(z * size[1] + y) * size[0] + x] += 1;
                        }
                    }
                }
                for a in 0..3 {
                    assert!(part[a].start % chunk[a] == 0 && (part[a].end % chunk[a] == 0 || part[a].end == size[a]));
                }
            }
            assert!(seen.iter().all(|n| *n == 1));
        }
    }
}
