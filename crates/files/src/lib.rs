//! Readers of volumes: NIfTI and NRRD, from bytes in memory.
//!
//! [`read`] gives samples in their own type, the affine from index to world, and the facts of the header. The world of
//! a patient is RAS. A file that this crate does not read right is refused with the reason; nothing is guessed without a
//! sentence in [`Facts::guesses`](wavesplat_core::Facts). Python's readers know more formats, and give the same
//! samples, affine and facts for these: `tests/headers.rs` compares the two.
//!
//! ```
//! # fn main() -> Result<(), wavesplat_files::FileError> {
//! let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 2 2\nspacings: 1 1 2\nencoding: raw\n\n";
//! let bytes = [header.as_bytes(), &[7; 12]].concat();
//! let volume = wavesplat_files::read("small.nrrd", &bytes, |name| Err(format!("no file {name}")))?;
//! assert_eq!((volume.size, volume.samples().len()), ([3, 2, 2], 12));
//! assert_eq!(volume.world_from_index.matrix3.z_axis.z, 2.0);
//! # Ok(())
//! # }
//! ```

mod error;
pub mod length_units;
mod nifti;
mod nrrd;
mod stored;

use glam::DAffine3;
use wavesplat_core::{Facts, Result as CoreResult, SampleBuffer, Samples, Volume};

pub use error::FileError;
pub use nrrd::NO_PLACE;

/// A volume that was read from a file.
#[derive(Clone, Debug)]
pub struct FileVolume {
    /// Samples along x, y and z.
    pub size: [usize; 3],
    /// World from index.
    pub world_from_index: DAffine3,
    /// The facts of the header, and the file's name without its folders.
    pub facts: Facts,
    /// The samples in their own type, x fastest.
    pub buffer: SampleBuffer,
}

impl FileVolume {
    /// The samples, x fastest.
    pub fn samples(&self) -> Samples<'_> {
        self.buffer.samples()
    }

    /// The volume as the renderer takes it. An error where it cannot be drawn: of two axes, or an affine that is singular.
    pub fn volume(&self) -> CoreResult<Volume<'_>> {
        Volume::new(&self.facts.name, self.samples(), self.size, self.world_from_index)
    }
}

/// Reads a NIfTI or NRRD file, by its content.
///
/// `name`: the file's name, for messages. `bytes`: all of it. `other`: gives the bytes of another file of the same
/// folder by its name, for NRRD headers that name one; or the reason why it cannot.
///
/// # Errors
/// A file of another format, a damaged or truncated one, and one whose samples are no single volume of real numbers.
pub fn read(
    name: &str,
    bytes: &[u8],
    other: impl FnOnce(&str) -> Result<Vec<u8>, String>,
) -> Result<FileVolume, FileError> {
    let made = if bytes.is_empty() {
        Err("the file is empty; copy or export it again".to_owned())
    } else if bytes.starts_with(b"NRRD") {
        nrrd::read(bytes, other)
    } else {
        nifti::read(bytes)
    };
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned();
    match made {
        Ok((buffer, size, world_from_index, facts)) => {
            Ok(FileVolume { size, world_from_index, facts: Facts { name: file, ..facts }, buffer })
        }
        Err(reason) => Err(FileError { reason, name: name.to_owned() }),
    }
}
