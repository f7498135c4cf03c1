//! The automatic look of a volume in memory, and volumes that are cut open.

use wavesplat_core::{Error, Facts, Result, SampleBuffer, Samples, Volume};
use wavesplat_files::FileVolume;
use wavesplat_look::{Look, Refusal, SliceFacts, Subject, VolumeChannel};
use wavesplat_view::{Stack, orbit_axes, view_angles};

use crate::kind::{kind_of, natural_angles, with_evidence};

/// The look that suits a volume, by the kind of its data.
///
/// ```
/// use wavesplat::glam::DAffine3;
/// use wavesplat::{AutoLook, Facts, Look, Samples, Volume};
///
/// # fn main() -> wavesplat::Result<()> {
/// // A smooth hill, as a simulation writes it.
/// let away = |k: usize| [k % 20, k / 20 % 20, k / 400].map(|at| (at as f32 - 9.5).powi(2)).iter().sum::<f32>();
/// let samples: Vec<f32> = (0..20 * 20 * 20).map(|k| (-0.05 * away(k)).exp()).collect();
/// let volume = Volume::new("density", Samples::F32(&samples), [20; 3], DAffine3::IDENTITY)?;
/// let look = Look::auto(&volume, &Facts::default())?;
/// assert_eq!(look.reason, "a field of floating-point numbers");
/// # Ok(())
/// # }
/// ```
pub trait AutoLook: Sized {
    /// The look of the first picture: that of `wavesplat render FILE`, but for the numbers of a segmentation, which is
    /// drawn as one solid thing, and for the table of a CT, which stays.
    ///
    /// Where [`Look::is_cut_open`], draw [`cut_open`]; the camera is that of [`fit_for`].
    ///
    /// [`fit_for`]: crate::PlacedCamera::fit_for
    ///
    /// # Errors
    ///
    /// If all samples are equal, so that there is nothing to tell apart, or they are too far apart for numbers of 64 bits.
    fn auto(volume: &Volume<'_>, facts: &Facts) -> Result<Self>;
}

impl AutoLook for Look {
    fn auto(volume: &Volume<'_>, facts: &Facts) -> Result<Self> {
        let grid = volume.grid();
        let (low, high) = (grid.statistics().min, grid.statistics().max);
        if let Some(refusal) = Refusal::of((low, high), grid.statistics().n_nonfinite > 0, None) {
            let (allowed, mend) = match refusal {
                Refusal::Uniform => ("a range of different values", "pass a transfer function, or check the file"),
                Refusal::TooFarApart => ("a range that a number of 64 bits holds", "divide the samples"),
            };
            let what = format!("the range of volume {:?}", facts.name);
            return Err(Error::out_of_range(what, format!("{low} to {high}"), allowed, mend));
        }
        let stack = Stack::of(grid);
        let [n_x, n_y, n_z] = grid.size();
        let largest_of_type = match volume.samples() {
            Samples::U8(_) => Some(f64::from(u8::MAX)),
            Samples::I8(_) => Some(f64::from(i8::MAX)),
            Samples::U16(_) => Some(f64::from(u16::MAX)),
            Samples::I16(_) => Some(f64::from(i16::MAX)),
            Samples::U32(_) => Some(f64::from(u32::MAX)),
            Samples::I32(_) => Some(f64::from(i32::MAX)),
            Samples::F32(_) | Samples::F64(_) => None,
        };
        let look = with_evidence(volume, facts, |evidence, found, all| {
            let seen = &evidence.seen;
            Subject {
                facts: evidence.facts,
                found: &found,
                values: &seen.values,
                gradients: &seen.gradients,
                fill: seen.fill(),
                size: [n_z, n_y, n_x],
                slices: SliceFacts {
                    are_few: stack.axis_of_few_slices().is_some(),
                    distant_axis: stack.axis_of_distant_slices(),
                    is_thin: stack.is_thin(),
                },
                channel: VolumeChannel { largest_of_type, ..VolumeChannel::default() },
            }
            .look(None, None, all)
        });
        match look {
            Ok(look) => look.look(),
            Err(never) => match never {},
        }
    }
}

/// An axis is cut if the cosine of its angle to the direction of the eye is larger.
const TOWARDS_EYE: f64 = 0.2;

/// The volume without the corner, or of a view along its slices the half, that is nearest to the eye, so that planes
/// through its middle are seen. Its samples are missing there.
///
/// `view`: the name of one, see [`VIEWS`](wavesplat_view::VIEWS); `None` is the view that suits the volume.
///
/// # Errors
///
/// If there is no view of that name.
pub fn cut_open(volume: &Volume<'_>, facts: &Facts, view: Option<&str>) -> Result<FileVolume> {
    let grid = volume.grid();
    let (azimuth, elevation) = match view {
        Some(name) => view_angles(name, facts.is_anatomical)?,
        None => natural_angles(grid, facts, || kind_of(volume, facts)),
    };
    let to_eye = orbit_axes(azimuth, elevation).back;
    let (matrix, spacing) = (grid.world_from_index().matrix3, grid.spacing());
    let size = grid.size();
    let ends: [(usize, usize); 3] = std::array::from_fn(|axis| {
        let (facing, n) = (to_eye.dot(matrix.col(axis) / spacing[axis]), size[axis]);
        let middle = (n - 1) as f64 / 2.0;
        // Faces at the middle go through samples, or between them; those have no part in it.
        let begin = if facing > TOWARDS_EYE { (middle + ON_FACE).floor() as usize + 1 } else { 0 };
        let end = if facing < -TOWARDS_EYE { (middle - ON_FACE).ceil() as usize } else { n };
        (begin, end.max(begin))
    });
    let mut is_out = vec![false; size.iter().product()];
    for z in ends[2].0..ends[2].1 {
        for y in ends[1].0..ends[1].1 {
            let row = (z * size[1] + y) * size[0];
            is_out[row + ends[0].0..row + ends[0].1].fill(true);
        }
    }
    mark_lone(&mut is_out, size);
    let samples = volume.samples();
    let kept = |k: usize| if is_out[k] { f64::NAN } else { samples.get(k) };
    let buffer = match samples {
        Samples::U32(_) | Samples::I32(_) | Samples::F64(_) => SampleBuffer::F64((0..is_out.len()).map(kept).collect()),
        _ => SampleBuffer::F32((0..is_out.len()).map(|k| kept(k) as f32).collect()),
    };
    Ok(FileVolume { size, world_from_index: grid.world_from_index(), facts: facts.clone(), buffer })
}

/// Tolerance within which a sample lies on a face, in samples.
const ON_FACE: f64 = 1e-5;

/// Marks also samples that have no neighbour left on either side along an axis.
///
/// Nothing is drawn between them and their neighbours, but a sheet that runs through them would show them.
fn mark_lone(is_out: &mut [bool], size: [usize; 3]) {
    for (axis, stride) in [(2, size[0] * size[1]), (1, size[0]), (0, 1)] {
        let n = size[axis];
        for start in (0..is_out.len()).filter(|at| at / stride % n == 0) {
            let mut before = is_out[start];
            is_out[start] |= is_out[start + stride];
            for k in 1..n {
                let at = start + k * stride;
                let own = is_out[at];
                is_out[at] |= before && (k == n - 1 || is_out[at + stride]);
                before = own;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;

    #[test]
    fn the_corner_at_the_eye_is_left_out() {
        let samples: Vec<u8> = (0..5 * 5 * 5).map(|k| k as u8).collect();
        let volume = Volume::new("block", Samples::U8(&samples), [5; 3], DAffine3::IDENTITY).unwrap();
        let cut = cut_open(&volume, &Facts::default(), Some("isometric")).unwrap();
        let SampleBuffer::F32(left) = &cut.buffer else { panic!("bytes and missing samples are numbers of 32 bits") };
        assert_eq!(left.iter().filter(|value| value.is_nan()).count(), 8);
        // The half in front of a view along x; the middle plane stays.
        let half = cut_open(&volume, &Facts::default(), Some("yz")).unwrap();
        let left = (0..5).map(|x| half.samples().get(x).is_nan()).filter(|is_out| *is_out).count();
        assert_eq!(left, 2);
    }

    #[test]
    fn uniform_samples_have_no_look() {
        let volume = Volume::new("flat", Samples::U8(&[7; 8]), [2; 3], DAffine3::IDENTITY).unwrap();
        let told = Look::auto(&volume, &Facts::default()).unwrap_err().to_string();
        assert!(told.starts_with("the range of volume \"\" is 7 to 7, which is not"), "{told}");
    }
}
