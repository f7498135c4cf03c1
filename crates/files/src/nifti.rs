//! NIfTI-1 and NIfTI-2 in one file, also compressed by gzip.
//!
//! Sources: nifti1.h and nifti2.h of the NIfTI data format working group. The sform wins over the qform; where both have
//! code 0 the file gives distances alone. The world is RAS already.

use std::borrow::Cow;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::Facts;

use crate::stored::{FileContent, StoredType, inflated, inflated_start, needed_bytes, scaled, truncated};

const GZIP: [u8; 2] = [0x1f, 0x8b];

/// The header of either version, in the widest types.
struct NiftiHeader {
    is_big: bool,
    /// Bytes of the header: 348 or 540.
    own_size: usize,
    shape: Vec<i64>,
    datatype: i32,
    pixdim: [f64; 8],
    first_sample: f64,
    slope: f64,
    intercept: f64,
    units: u32,
    intent: i32,
    description: Vec<u8>,
    qform_code: i32,
    sform_code: i32,
    quaternion: [f64; 3],
    offset: [f64; 3],
    sform: [[f64; 4]; 3],
}

/// Reads a file's bytes.
pub(crate) fn read(bytes: &[u8]) -> FileContent {
    let is_packed = bytes.starts_with(&GZIP);
    let start = if is_packed { Cow::Owned(inflated_start(bytes, 544)) } else { Cow::Borrowed(bytes) };
    let header = header(&start)?;
    let size = size(&header)?;
    let stored = stored_type(header.datatype)?;
    let (first, guess) = first_sample(&header, &start)?;
    let needed = needed_bytes(size, stored).and_then(|n| n.checked_add(first));
    let whole = match needed {
        Some(needed) if is_packed => Cow::Owned(inflated(bytes, needed)?),
        _ => Cow::Borrowed(if is_packed { &[][..] } else { bytes }),
    };
    let held = whole.len().saturating_sub(first);
    let Some(samples) = needed.and_then(|needed| whole.get(first..needed)) else {
        return Err(truncated(size, stored, held));
    };
    let (slope, intercept) = slope_of(&header)?;
    let mut facts = facts(&header);
    facts.guesses.extend(guess);
    Ok((scaled(samples, stored, header.is_big, slope, intercept), size, world_from_index(&header)?, facts))
}

/// Reads fields of a header, which are at other places in each version.
fn header(start: &[u8]) -> Result<NiftiHeader, String> {
    let unknown = || {
        "not a NIfTI file in one part, nor NRRD; draw it with the command line, which reads more formats: \
         wavesplat render FILE"
            .to_owned()
    };
    let size_field: [u8; 4] = start.get(..4).and_then(|part| part.try_into().ok()).ok_or_else(unknown)?;
    let (is_big, own_size) = match (i32::from_le_bytes(size_field), i32::from_be_bytes(size_field)) {
        (size @ (348 | 540), _) => (false, size as usize),
        (_, size @ (348 | 540)) => (true, size as usize),
        _ => return Err(unknown()),
    };
    let is_second = own_size == 540;
    let magic = if is_second { &start.get(4..7) } else { &start.get(344..347) };
    if !matches!(magic, Some([b'n', b'+', b'1' | b'2'])) {
        return Err(unknown());
    }
    if start.len() < own_size {
        return Err(format!("truncated: the header has {own_size} bytes, the file {}; copy it again", start.len()));
    }
    let fields = HeaderBytes { start, is_big };
    let n_axes = if is_second { fields.i64(16) } else { fields.i16(40).into() };
    if !(1..=7).contains(&n_axes) {
        return Err(format!("a wrong header: it says {n_axes} axes, and NIfTI has 1 to 7; export the file again"));
    }
    let shape = 1..=n_axes as usize;
    Ok(if is_second {
        NiftiHeader {
            is_big,
            own_size,
            shape: shape.map(|a| fields.i64(16 + 8 * a)).collect(),
            datatype: fields.i16(12).into(),
            pixdim: [0, 1, 2, 3, 4, 5, 6, 7].map(|a| fields.f64(104 + 8 * a)),
            first_sample: fields.i64(168) as f64,
            slope: fields.f64(176),
            intercept: fields.f64(184),
            units: fields.i32(500) as u32,
            intent: fields.i32(504),
            description: start[240..320].to_vec(),
            qform_code: fields.i32(344),
            sform_code: fields.i32(348),
            quaternion: [352, 360, 368].map(|at| fields.f64(at)),
            offset: [376, 384, 392].map(|at| fields.f64(at)),
            sform: [400, 432, 464].map(|at| [0, 8, 16, 24].map(|part| fields.f64(at + part))),
        }
    } else {
        NiftiHeader {
            is_big,
            own_size,
            shape: shape.map(|a| fields.i16(40 + 2 * a).into()).collect(),
            datatype: fields.i16(70).into(),
            pixdim: [0, 1, 2, 3, 4, 5, 6, 7].map(|a| fields.f32(76 + 4 * a)),
            first_sample: fields.f32(108),
            slope: fields.f32(112),
            intercept: fields.f32(116),
            units: start[123].into(),
            intent: fields.i16(68).into(),
            description: start[148..228].to_vec(),
            qform_code: fields.i16(252).into(),
            sform_code: fields.i16(254).into(),
            quaternion: [256, 260, 264].map(|at| fields.f32(at)),
            offset: [268, 272, 276].map(|at| fields.f32(at)),
            sform: [280, 296, 312].map(|at| [0, 4, 8, 12].map(|part| fields.f32(at + part))),
        }
    })
}

/// Numbers at places of a header that is long enough.
struct HeaderBytes<'a> {
    start: &'a [u8],
    is_big: bool,
}

impl HeaderBytes<'_> {
    fn part<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut part: [u8; N] = std::array::from_fn(|i| self.start[at + i]);
        if self.is_big {
            part.reverse();
        }
        part
    }

    fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.part(at))
    }

    fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.part(at))
    }

    fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.part(at))
    }

    fn f32(&self, at: usize) -> f64 {
        f32::from_le_bytes(self.part(at)).into()
    }

    fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.part(at))
    }
}

/// Samples along x, y, z; an error for several volumes.
fn size(header: &NiftiHeader) -> Result<[usize; 3], String> {
    let shape = &header.shape;
    if shape.iter().any(|n| *n < 1) {
        return Err(format!("the header says shape {shape:?} (x, y, z), which holds no samples"));
    }
    let n_volumes: i64 = shape.iter().skip(3).fold(1, |n, m| n.saturating_mul(*m));
    if n_volumes > 1 {
        return Err(format!(
            "the file holds {n_volumes} volumes, shape {shape:?}; export one of them, or draw it with the command line: \
             wavesplat render FILE --time N"
        ));
    }
    match shape[..] {
        [x, y, z, ..] => Ok([x as usize, y as usize, z as usize]),
        _ => Err(format!("the file holds an image of {} axes; a volume has 3", shape.len())),
    }
}

fn stored_type(code: i32) -> Result<StoredType, String> {
    Ok(match code {
        2 => StoredType::U8,
        4 => StoredType::I16,
        8 => StoredType::I32,
        16 => StoredType::F32,
        64 => StoredType::F64,
        256 => StoredType::I8,
        512 => StoredType::U16,
        768 => StoredType::U32,
        1024 => StoredType::I64,
        1280 => StoredType::U64,
        128 | 2304 => {
            return Err(
                "the samples are colours; draw the file with the command line: wavesplat render FILE".to_owned()
            );
        }
        _ => return Err(format!("samples of type {code} of NIfTI cannot be drawn; write real numbers")),
    })
}

/// The byte of the first sample, and a guess where the header's is not believed.
fn first_sample(header: &NiftiHeader, start: &[u8]) -> Result<(usize, Option<String>), String> {
    let least = header.own_size + 4;
    let first = header.first_sample;
    if first == 0.0 {
        if start.get(header.own_size).is_some_and(|flag| *flag != 0) {
            return Err(
                "the header says that the samples begin at byte 0, and extensions of unknown length lie between \
                        it and them; write the file's vox_offset"
                    .to_owned(),
            );
        }
        return Ok((least, Some(format!("samples from byte {least} on: the file says byte 0, where its header is"))));
    }
    if !(first >= least as f64 && first < 1e15) {
        return Err(format!(
            "a wrong header: it says that the samples begin at byte {first}, where it is itself; write the file's \
             vox_offset, {least} or more"
        ));
    }
    Ok((first as usize, None))
}

/// Slope and intercept; without a slope the samples are values.
fn slope_of(header: &NiftiHeader) -> Result<(f64, f64), String> {
    if header.slope == 0.0 || !header.slope.is_finite() {
        return Ok((1.0, 0.0));
    }
    if !header.intercept.is_finite() {
        return Err(format!("a wrong header: the intercept of the values is {}; mend scl_inter", header.intercept));
    }
    Ok((header.slope, header.intercept))
}

fn is_placed(header: &NiftiHeader) -> bool {
    header.sform_code > 0 || header.qform_code > 0
}

/// World (RAS, millimetres where the unit is known) from index.
fn world_from_index(header: &NiftiHeader) -> Result<DAffine3, String> {
    let distances = DVec3::new(header.pixdim[1].abs(), header.pixdim[2].abs(), header.pixdim[3].abs());
    let mut affine = if header.sform_code > 0 {
        let [x, y, z] = header.sform;
        let column = |a: usize| DVec3::new(x[a], y[a], z[a]);
        DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) }
    } else if header.qform_code > 0 {
        let sign = if header.pixdim[0] == -1.0 { -1.0 } else { 1.0 };
        let scale = DVec3::new(distances.x, distances.y, distances.z * sign);
        let turn = rotation(header.quaternion, header.own_size == 540)?;
        let matrix3 = DMat3::from_cols(turn.x_axis * scale.x, turn.y_axis * scale.y, turn.z_axis * scale.z);
        DAffine3 { matrix3, translation: DVec3::from_array(header.offset) }
    } else {
        let one = |distance: f64| if distance == 0.0 { 1.0 } else { distance };
        DAffine3::from_scale(DVec3::new(one(distances.x), one(distances.y), one(distances.z)))
    };
    let factor = match header.units & 0x07 {
        1 => 1000.0,
        3 => 0.001,
        _ => 1.0,
    };
    affine.matrix3 *= factor;
    affine.translation *= factor;
    Ok(affine)
}

/// The rotation of a unit quaternion by its last three parts; the first is not negative.
fn rotation([x, y, z]: [f64; 3], is_second: bool) -> Result<DMat3, String> {
    // Parts in 32-bit floats may add up to slightly more than 1.
    let off = 3.0 * if is_second { f64::EPSILON } else { f32::EPSILON.into() };
    // What is left to 1 may be small beside 1, so what the sums lose is carried along.
    let (square, lost) = [x, y, z].iter().fold((1.0, 0.0), |(sum, lost): (f64, f64), part| {
        let product = -part * part;
        let next = sum + product;
        (next, lost + ((sum - next) + product) + (-part).mul_add(*part, -product))
    });
    let square = square + lost;
    if square.is_nan() || square < -off {
        return Err(format!("a wrong header: the quaternion of its qform, {x} {y} {z}, is longer than 1; mend it"));
    }
    let w = if square.abs() < off { 0.0 } else { square.sqrt() };
    let s = 2.0 / if w == 0.0 { x * x + y * y + z * z } else { 1.0 };
    let (sx, sy, sz) = (x * s, y * s, z * s);
    let (wx, wy, wz) = (w * sx, w * sy, w * sz);
    let (xx, xy, xz) = (x * sx, x * sy, x * sz);
    let (yy, yz, zz) = (y * sy, y * sz, z * sz);
    Ok(DMat3::from_cols(
        DVec3::new(1.0 - (yy + zz), xy + wz, xz - wy),
        DVec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
        DVec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)),
    ))
}

/// Description that Wavesplat writes for a world that is no patient's, since NIfTI has no code for it.
const NO_ANATOMY: &[u8] = b"axes without anatomy";

fn facts(header: &NiftiHeader) -> Facts {
    let is_placed = is_placed(header);
    let end = header.description.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let is_anatomical = is_placed && header.description[..end] != *NO_ANATOMY;
    let code = header.units & 0x07;
    let mut facts = Facts { is_anatomical, ..Facts::default() };
    if !is_placed {
        facts.guesses.push(
            "axes without anatomy, sample (0, 0, 0) at the origin: the file has no orientation (its qform and sform \
             codes are 0, or it is Analyze), only distances"
                .to_owned(),
        );
    }
    let is_known = (1..=3).contains(&code);
    if code != 0 && !is_known {
        facts
            .guesses
            .push(format!("lengths as numbers of millimetres: the file's unit has code {code}, which NIfTI has not"));
    }
    if code != 0 || is_anatomical {
        facts.unit = Some("mm".to_owned());
    }
    if code == 0 && is_anatomical {
        facts.conventions.push("unit mm: the file names none; programs that read NIfTI take millimetres".to_owned());
    }
    facts.quantity = quantity(header.intent).map(str::to_owned);
    facts
}

/// The quantity that an intent names; none for images.
fn quantity(intent: i32) -> Option<&'static str> {
    match intent {
        3 => Some("t statistic"),
        4 => Some("F statistic"),
        5 => Some("z statistic"),
        22 => Some("p-value"),
        _ => None,
    }
}
