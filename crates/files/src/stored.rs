//! Samples as files store them: types, byte orders, gzip streams, slopes; and the types that the renderer takes.

use std::io::Read;

use flate2::bufread::MultiGzDecoder;
use glam::DAffine3;
use wavesplat_core::{Facts, SampleBuffer};

/// Deflate cannot shrink data by more than this factor (RFC 1951: 258 bytes from two bits).
const DEFLATE_RATIO: usize = 1032;

/// Samples, size, world from index, and facts; or the reason why there are none.
pub(crate) type FileContent = Result<(SampleBuffer, [usize; 3], DAffine3, Facts), String>;

/// A type of stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StoredType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl StoredType {
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// NumPy's name of the type, for messages.
    fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }
}

/// An error unless `stored` bytes hold the samples.
pub(crate) fn needed_bytes(size: [usize; 3], stored_type: StoredType) -> Option<usize> {
    size.iter().try_fold(stored_type.bytes(), |n, &m| n.checked_mul(m))
}

/// The sentence for a file that ends too early.
pub(crate) fn truncated(size: [usize; 3], stored_type: StoredType, held: usize) -> String {
    let [x, y, z] = size;
    let needed = needed_bytes(size, stored_type).map_or_else(|| "too many".to_owned(), |n| n.to_string());
    format!(
        "truncated, or a wrong header: {x} x {y} x {z} samples of {} need {needed} bytes, the file holds {held}; copy or \
         export it again",
        stored_type.name()
    )
}

/// The first `needed` bytes of a gzip stream, which is read to its end for its checksum.
pub(crate) fn inflated(packed: &[u8], needed: usize) -> Result<Vec<u8>, String> {
    // A header of a few bytes may promise terabytes: the stream decides how much memory is taken.
    let room = needed.min(packed.len().saturating_mul(DEFLATE_RATIO));
    let mut stream = MultiGzDecoder::new(packed);
    let mut bytes = Vec::with_capacity(room);
    let damaged = |error| format!("damaged: the packed samples do not unpack ({error}); copy it again");
    stream.by_ref().take(needed as u64).read_to_end(&mut bytes).map_err(damaged)?;
    std::io::copy(&mut stream, &mut std::io::sink()).map_err(damaged)?;
    Ok(bytes)
}

/// The first `n` bytes of a gzip stream, or fewer where it ends or is damaged.
pub(crate) fn inflated_start(packed: &[u8], n: usize) -> Vec<u8> {
    let mut bytes = vec![0; n];
    let mut stream = MultiGzDecoder::new(packed);
    let mut at = 0;
    while at < n {
        match stream.read(&mut bytes[at..]) {
            Ok(0) | Err(_) => break,
            Ok(read) => at += read,
        }
    }
    bytes.truncate(at);
    bytes
}

/// Runs `$body` with `$read` bound to a reader of one number of `$stored` in a byte order.
macro_rules! numbers {
    ($bytes:expr, $t:ty, $is_big:expr) => {{
        let read = if $is_big { <$t>::from_be_bytes } else { <$t>::from_le_bytes };
        let (parts, _) = $bytes.as_chunks::<{ size_of::<$t>() }>();
        parts.iter().map(move |part| read(*part))
    }};
}

/// The samples in bytes, in the type that the renderer takes: integers of 64 bits in the narrowest one that holds all.
pub(crate) fn samples(bytes: &[u8], stored_type: StoredType, is_big: bool) -> SampleBuffer {
    match stored_type {
        StoredType::U8 => SampleBuffer::U8(bytes.to_vec()),
        StoredType::I8 => SampleBuffer::I8(numbers!(bytes, i8, is_big).collect()),
        StoredType::U16 => SampleBuffer::U16(numbers!(bytes, u16, is_big).collect()),
        StoredType::I16 => SampleBuffer::I16(numbers!(bytes, i16, is_big).collect()),
        StoredType::U32 => SampleBuffer::U32(numbers!(bytes, u32, is_big).collect()),
        StoredType::I32 => SampleBuffer::I32(numbers!(bytes, i32, is_big).collect()),
        StoredType::F32 => SampleBuffer::F32(numbers!(bytes, f32, is_big).collect()),
        StoredType::F64 => SampleBuffer::F64(numbers!(bytes, f64, is_big).collect()),
        StoredType::U64 => narrowest(numbers!(bytes, u64, is_big).map(i128::from)),
        StoredType::I64 => narrowest(numbers!(bytes, i64, is_big).map(i128::from)),
    }
}

/// The samples in the first type of the renderer that holds all of them exactly, else as 64-bit floats.
fn narrowest(values: impl Iterator<Item = i128> + Clone) -> SampleBuffer {
    let (lo, hi) = values.clone().fold((i128::MAX, i128::MIN), |(lo, hi), value| (lo.min(value), hi.max(value)));
    macro_rules! first_that_fits {
        ($($variant:ident: $t:ty),*) => {$(
            if i128::from(<$t>::MIN) <= lo && hi <= i128::from(<$t>::MAX) {
                return SampleBuffer::$variant(values.map(|value| value as $t).collect());
            }
        )*};
    }
    first_that_fits!(U8: u8, I8: i8, U16: u16, I16: i16, U32: u32, I32: i32);
    SampleBuffer::F64(values.map(|value| value as f64).collect())
}

/// Samples times a slope, plus an intercept; integers stay integers where nothing is lost.
///
/// Whole numbers become 16- or else 32-bit integers where these hold them; others 32-bit floats, or 64-bit ones of wide
/// types, and where values would be too large.
pub(crate) fn scaled(bytes: &[u8], stored_type: StoredType, is_big: bool, slope: f64, intercept: f64) -> SampleBuffer {
    if (slope, intercept) == (1.0, 0.0) {
        return samples(bytes, stored_type, is_big);
    }
    macro_rules! integers {
        ($t:ty) => {{
            let values = numbers!(bytes, $t, is_big).map(i128::from);
            scaled_integers(values.clone(), slope, intercept)
                .unwrap_or_else(|| floats(values.map(|value| value as f64), stored_type, slope, intercept))
        }};
    }
    macro_rules! reals {
        ($t:ty) => {
            floats(numbers!(bytes, $t, is_big).map(f64::from), stored_type, slope, intercept)
        };
    }
    match stored_type {
        StoredType::U8 => integers!(u8),
        StoredType::I8 => integers!(i8),
        StoredType::U16 => integers!(u16),
        StoredType::I16 => integers!(i16),
        StoredType::U32 => integers!(u32),
        StoredType::I32 => integers!(i32),
        StoredType::U64 => integers!(u64),
        StoredType::I64 => integers!(i64),
        StoredType::F32 => reals!(f32),
        StoredType::F64 => reals!(f64),
    }
}

/// Whole numbers scaled by whole numbers, as 16- or 32-bit integers; none where they do not fit.
fn scaled_integers(values: impl Iterator<Item = i128> + Clone, slope: f64, intercept: f64) -> Option<SampleBuffer> {
    let is_whole = |number: f64| number.fract() == 0.0 && number.abs() < 9e18;
    if !is_whole(slope) || !is_whole(intercept) {
        return None;
    }
    let (slope, intercept) = (slope as i128, intercept as i128);
    let (lo, hi) = values.clone().fold((i128::MAX, i128::MIN), |(lo, hi), value| (lo.min(value), hi.max(value)));
    let ends = [lo * slope + intercept, hi * slope + intercept];
    let fits = |least: i128, most: i128| ends.iter().all(|end| (least..=most).contains(end));
    let values = values.map(|value| value * slope + intercept);
    if fits(i16::MIN.into(), i16::MAX.into()) {
        return Some(SampleBuffer::I16(values.map(|value| value as i16).collect()));
    }
    fits(i32::MIN.into(), i32::MAX.into()).then(|| SampleBuffer::I32(values.map(|value| value as i32).collect()))
}

fn floats(
    values: impl Iterator<Item = f64> + Clone,
    stored_type: StoredType,
    slope: f64,
    intercept: f64,
) -> SampleBuffer {
    let values = values.map(|value| value * slope + intercept);
    let is_wide = stored_type.bytes() > 4;
    let is_float = matches!(stored_type, StoredType::F32 | StoredType::F64);
    // Slopes near the limit of 32-bit floats make values beyond it.
    let may_be_large = slope.abs().max(intercept.abs()) > 1e20 || (is_float && slope.abs() > 1.0);
    let largest =
        || values.clone().filter(|value| value.is_finite()).fold(0.0_f64, |most, value| most.max(value.abs()));
    if is_wide || (may_be_large && largest() > f64::from(f32::MAX)) {
        return SampleBuffer::F64(values.collect());
    }
    SampleBuffer::F32(values.map(|value| value as f32).collect())
}
