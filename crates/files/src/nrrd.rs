//! NRRD: a header of text lines, then samples; or a header that names the file with the samples.
//!
//! Format: <https://teem.sourceforge.net/nrrd/format.html>. Lines are `field: value`, or `key:=value` of other programs.
//! A world whose `space` is a patient's becomes RAS; other axes are kept as they are.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::Facts;

use crate::length_units;
use crate::stored::{FileContent, StoredType, inflated, needed_bytes, samples, truncated};

/// Longest header that is read, in bytes; Python's readers have the same.
const MAX_HEADER_BYTES: usize = 1 << 24;

/// A convention of a file that names a patient's axes, and nothing else of a place.
pub const NO_PLACE: &str =
    "axes of a patient: they are named, but samples are 1 apart, from the origin on, as by default";

/// Lines of a header, their names in lower case.
struct NrrdHeader {
    fields: HashMap<String, String>,
    keys: HashMap<String, String>,
    /// Bytes of the header, its empty line included.
    n_bytes: usize,
}

impl NrrdHeader {
    fn field(&self, name: &str) -> &str {
        self.fields.get(name).map_or("", String::as_str)
    }

    fn key(&self, name: &str) -> &str {
        self.keys.get(name).map_or("", String::as_str)
    }

    /// A field of a whole number; 0 where it is missing.
    fn number(&self, name: &str) -> Result<i64, String> {
        let text = self.field(name);
        let number = if text.is_empty() { Ok(0) } else { text.parse() };
        number.map_err(|_| format!("a wrong header: {name} is {text:?}; write a whole number"))
    }
}

/// Reads a file's bytes; `other` gives those of the file that a header names.
pub(crate) fn read(bytes: &[u8], other: impl FnOnce(&str) -> Result<Vec<u8>, String>) -> FileContent {
    let header = header(bytes)?;
    let size = size(&header)?;
    let stored = stored_type(header.field("type"))?;
    let named = header.field("data file");
    let place =
        if named.is_empty() { Cow::Borrowed(&bytes[header.n_bytes..]) } else { Cow::Owned(named_file(named, other)?) };
    let is_big = stored.bytes() > 1 && header.field("endian").eq_ignore_ascii_case("big");
    let payload = payload(&header, &place, size, stored)?;
    let signs = ras_signs(header.field("space"));
    let (facts, factors, index_factors) = facts(&header, signs.is_some());
    let affine = world_from_index(&header, signs, factors, index_factors)?;
    Ok((samples(&payload, stored, is_big), size, affine, facts))
}

/// The fields and keys of a header, which ends at an empty line or, where samples are elsewhere, with the file.
fn header(bytes: &[u8]) -> Result<NrrdHeader, String> {
    let start = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let mut header = NrrdHeader { fields: HashMap::new(), keys: HashMap::new(), n_bytes: start.len() };
    let mut at = 0;
    for (number, line) in start.split_inclusive(|byte| *byte == b'\n').enumerate() {
        at += line.len();
        // Letters are Latin-1, in which every byte is one.
        let line: String = line.iter().map(|byte| char::from(*byte)).collect();
        let line = line.trim_end_matches(['\r', '\n']);
        if number == 0 {
            continue;
        }
        if line.is_empty() {
            header.n_bytes = at;
            break;
        }
        let Some((name, value)) = line.split_once(':').filter(|_| !line.starts_with('#')) else { continue };
        let name = name.trim().to_lowercase();
        if let Some(value) = value.strip_prefix('=') {
            header.keys.insert(name, value.trim().to_owned());
            continue;
        }
        let name = match name.as_str() {
            "datafile" => "data file".to_owned(),
            "lineskip" => "line skip".to_owned(),
            "byteskip" => "byte skip".to_owned(),
            _ => name,
        };
        if name == "data file" && header.fields.contains_key(&name) {
            return Err("the header says twice where the samples are; mend its line 'data file'".to_owned());
        }
        header.fields.insert(name, value.trim().to_owned());
    }
    if header.n_bytes == MAX_HEADER_BYTES {
        return Err(format!("the header has no end in {} MiB; copy or export it again", MAX_HEADER_BYTES >> 20));
    }
    Ok(header)
}

fn size(header: &NrrdHeader) -> Result<[usize; 3], String> {
    let text = header.field("sizes");
    let sizes: Vec<usize> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>().unwrap_or_default();
    match sizes[..] {
        [x, y, z] if x > 0 && y > 0 && z > 0 => Ok([x, y, z]),
        [_, _, _, _, ..] => Err(format!(
            "the file has {} axes, {text}; export one volume of three axes, or draw it with the command line: wavesplat \
             render FILE --time N, or --channel N",
            sizes.len()
        )),
        _ => Err(format!("a wrong header: its sizes are {text:?}; a volume has three, of at least 1 each")),
    }
}

fn stored_type(text: &str) -> Result<StoredType, String> {
    let folded: String = text.to_lowercase().split_whitespace().collect();
    Ok(match folded.as_str() {
        "signedchar" | "int8" | "int8_t" => StoredType::I8,
        "uchar" | "unsignedchar" | "uint8" | "uint8_t" => StoredType::U8,
        "short" | "shortint" | "signedshort" | "signedshortint" | "int16" | "int16_t" => StoredType::I16,
        "ushort" | "unsignedshort" | "unsignedshortint" | "uint16" | "uint16_t" => StoredType::U16,
        "int" | "signedint" | "int32" | "int32_t" => StoredType::I32,
        "uint" | "unsignedint" | "uint32" | "uint32_t" => StoredType::U32,
        "longlong" | "longlongint" | "signedlonglong" | "signedlonglongint" | "int64" | "int64_t" => StoredType::I64,
        "ulonglong" | "unsignedlonglong" | "unsignedlonglongint" | "uint64" | "uint64_t" => StoredType::U64,
        "float" => StoredType::F32,
        "double" => StoredType::F64,
        _ => return Err(format!("samples of type {text:?} cannot be drawn; write numbers")),
    })
}

/// The bytes of the one file that a header names.
fn named_file(named: &str, other: impl FnOnce(&str) -> Result<Vec<u8>, String>) -> Result<Vec<u8>, String> {
    if named.to_uppercase().starts_with("LIST") || named.contains('%') {
        return Err(format!(
            "the header names several files, {named:?}; draw them with the command line: wavesplat render FILE"
        ));
    }
    if named.contains(['/', '\\']) || named == ".." {
        return Err(format!("the header names a file in another folder, {named:?}; put it beside the header"));
    }
    other(named).map_err(|reason| {
        format!("the header names the data file {named:?}, which is not read ({reason}); put it beside the header")
    })
}

/// The stored samples, unpacked.
fn payload<'a>(
    header: &NrrdHeader,
    place: &'a [u8],
    size: [usize; 3],
    stored: StoredType,
) -> Result<Cow<'a, [u8]>, String> {
    let needed = needed_bytes(size, stored).ok_or_else(|| truncated(size, stored, place.len()))?;
    let mut rest = place;
    for _ in 0..header.number("line skip")?.max(0) {
        let Some(end) = rest.iter().position(|byte| *byte == b'\n') else { break };
        rest = &rest[end + 1..];
    }
    let skip = header.number("byte skip")?;
    let encoding = header.field("encoding").to_lowercase();
    match encoding.as_str() {
        "raw" | "" => {
            // -1: the samples are the last bytes of the file.
            let first = if skip < 0 { rest.len().checked_sub(needed) } else { usize::try_from(skip).ok() };
            let held = first.and_then(|first| rest.get(first..)).unwrap_or_default();
            held.get(..needed).map(Cow::Borrowed).ok_or_else(|| truncated(size, stored, held.len()))
        }
        "gzip" | "gz" => {
            let skip = usize::try_from(skip)
                .map_err(|_| format!("a byte skip of {skip} beside encoding gzip; write how many bytes to skip"))?;
            let whole = inflated(rest, needed.saturating_add(skip))?;
            let held = whole.get(skip..).unwrap_or_default();
            held.get(..needed).map(|part| Cow::Owned(part.to_vec())).ok_or_else(|| truncated(size, stored, held.len()))
        }
        _ => Err(format!(
            "samples of encoding {encoding:?}; write raw or gzip, or draw the file with the command line: wavesplat \
             render FILE"
        )),
    }
}

/// Signs by which the world's x, y and z become RAS; none where the space is no patient's.
fn ras_signs(space: &str) -> Option<[f64; 3]> {
    match space.trim().to_lowercase().as_str() {
        "left-posterior-superior" | "lps" => Some([-1.0, -1.0, 1.0]),
        "right-anterior-superior" | "ras" => Some([1.0, 1.0, 1.0]),
        "left-anterior-superior" | "las" => Some([-1.0, 1.0, 1.0]),
        _ => None,
    }
}

/// World from index, in one unit.
fn world_from_index(
    header: &NrrdHeader,
    signs: Option<[f64; 3]>,
    factors: [f64; 3],
    index_factors: [f64; 3],
) -> Result<DAffine3, String> {
    let directions = header.field("space directions");
    let columns = if directions.is_empty() {
        if !header.field("axis mins").is_empty() {
            return Err("the header has axis mins, which this reader does not know; write a space origin".to_owned());
        }
        let spacings = numbers(header.field("spacings"));
        let spacings = if spacings.is_empty() { vec![1.0; 3] } else { spacings };
        let &[x, y, z] = &spacings[..] else {
            return Err(format!("a wrong header: its spacings are {:?}; write three", header.field("spacings")));
        };
        let known = |step: f64| if step.is_finite() { step } else { 1.0 };
        [DVec3::new(known(x), 0.0, 0.0), DVec3::new(0.0, known(y), 0.0), DVec3::new(0.0, 0.0, known(z))]
    } else {
        let found = vectors(directions);
        let [Some(x), Some(y), Some(z)] = found[..] else {
            return Err(format!("a wrong header: its space directions are {directions:?}; write three vectors"));
        };
        // The distance of samples and the direction apart, and multiplied again, as ITK has them.
        [x, y, z].map(|axis| {
            let distance = (axis.x * axis.x + axis.y * axis.y + axis.z * axis.z).sqrt();
            (axis * (1.0 / distance)) * distance
        })
    };
    let origin = header.field("space origin");
    let origin = match vectors(origin)[..] {
        [Some(origin)] => origin,
        _ if origin.is_empty() => DVec3::ZERO,
        _ => return Err(format!("a wrong header: its space origin is {origin:?}; write one vector")),
    };
    let signs = DVec3::from_array(signs.unwrap_or([1.0; 3])) * DVec3::from_array(factors);
    let column = |a: usize| columns[a] * index_factors[a] * signs;
    let matrix3 = DMat3::from_cols(column(0), column(1), column(2));
    // Adding 0 makes -0 of mirrored axes 0.
    let affine = DAffine3 { matrix3: matrix3 + DMat3::ZERO, translation: origin * signs + DVec3::ZERO };
    if !affine.is_finite() {
        return Err("a wrong header: its directions or distances of samples are no numbers; mend them".to_owned());
    }
    Ok(affine)
}

/// Vectors of three numbers, "(1,0,0)", also with blanks in them; none for other words.
fn vectors(text: &str) -> Vec<Option<DVec3>> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(open) = rest.find(|sign: char| sign == '(' || sign.is_alphabetic()) {
        let close = rest[open..].find(if rest[open..].starts_with('(') { ')' } else { ' ' });
        let end = close.map_or(rest.len(), |close| open + close);
        let inner: Option<Vec<f64>> = rest[open..end]
            .strip_prefix('(')
            .and_then(|inner| inner.split(',').map(|n| n.trim().parse().ok()).collect());
        found.push(inner.and_then(|inner| <[f64; 3]>::try_from(inner).ok()).map(DVec3::from_array));
        rest = &rest[(end + 1).min(rest.len())..];
    }
    found
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap_or(f64::NAN)).collect()
}

/// The facts of a header, and the factors of lengths along the world's axes and along the index axes.
fn facts(header: &NrrdHeader, is_anatomical: bool) -> (Facts, [f64; 3], [f64; 3]) {
    let mut named = three_units(header.field("space units"));
    let (mut unit, mut factors) = length_units::in_one_unit(&named);
    let mut index_factors = [1.0; 3];
    if unit.is_none() && header.field("space directions").is_empty() {
        named = three_units(header.field("units"));
        (unit, index_factors) = length_units::in_one_unit(&named);
    }
    if unit.is_none() {
        // ITK has no units, and keeps one as a key.
        let own = length_units::canonical(header.key("unit"));
        let (of_key, by) = length_units::in_one_unit(&[own.clone(), own.clone(), own]);
        (unit, factors) = (of_key, [by[0]; 3]);
    }
    let mut facts = Facts { is_anatomical, modality: modality(header), ..Facts::default() };
    if unit.is_none() && is_anatomical {
        unit = Some("mm".to_owned());
        facts
            .conventions
            .push("unit mm: the file names none; programs that read NRRD of patients take millimetres".to_owned());
        if facts.modality.is_none() && has_no_place(header) {
            facts.conventions.push(NO_PLACE.to_owned());
        }
    }
    if header.field("spacings").is_empty() && header.field("space directions").is_empty() {
        facts.guesses.push("distances of samples 1, 1, 1: the file has none".to_owned());
    }
    facts.guesses.extend(length_units::guesses(&named));
    facts.unit = unit;
    let own = header.field("sample units").trim_matches('"');
    facts.value_unit = value_unit(if own.is_empty() { header.key("value_unit") } else { own });
    (facts, factors, index_factors)
}

/// A unit of values; none where it cannot be shown.
fn value_unit(text: &str) -> Option<String> {
    let text = text.trim();
    let is_shown = !text.is_empty() && text.chars().count() <= 24 && !text.chars().any(char::is_control);
    is_shown.then(|| text.to_owned())
}

/// The units in `"mm" "mm" "mm"`: the last three.
fn three_units(text: &str) -> [Option<String>; 3] {
    let mut names: Vec<String> = Vec::new();
    let mut name: Option<String> = None;
    let mut is_escaped = false;
    for sign in text.chars() {
        match (&mut name, sign) {
            (None, '"') => name = Some(String::new()),
            (None, _) => {}
            (Some(own), sign) if is_escaped || (sign != '"' && sign != '\\') => {
                own.push(sign);
                is_escaped = false;
            }
            (Some(_), '"') => names.extend(name.take()),
            (Some(own), sign) => {
                own.push(sign);
                is_escaped = true;
            }
        }
    }
    let Some([x, y, z]) = names.last_chunk::<3>() else { return [None, None, None] };
    [x, y, z].map(|name| length_units::canonical(name))
}

/// Whether directions and origin are those that ITK writes for an image without a place.
fn has_no_place(header: &NrrdHeader) -> bool {
    let all = |name: &str| numbers(&header.field(name).replace(['(', ')', ','], " "));
    let origin = all("space origin");
    all("space directions") == [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        && (origin.is_empty() || origin == [0.0; 3])
}

/// DICOM's code of the modality that keys name.
fn modality(header: &NrrdHeader) -> Option<String> {
    let words = [header.key("modality"), header.key("0008|0060")].map(|word| word.trim().to_lowercase());
    let words = words.map(|word| word.strip_prefix("met_mod_").map_or(word.clone(), str::to_owned));
    let known = |word: &String| match word.as_str() {
        "mri" | "dwmri" | "mr" => Some("MR"),
        "ct" => Some("CT"),
        "pet" | "pt" => Some("PT"),
        "nm" => Some("NM"),
        "us" => Some("US"),
        "rtdose" => Some("RTDOSE"),
        _ => None,
    };
    let code = words[1].to_uppercase();
    let found = words.iter().find_map(known).map(str::to_owned);
    found.or_else(|| DICOM_CODES.contains(&code.as_str()).then_some(code))
}

/// DICOM's codes of images (PS3.3, C.7.3.1.1.1) beside those that have words.
const DICOM_CODES: [&str; 27] = [
    "BI", "BMD", "CR", "DG", "DX", "ES", "GM", "IO", "IVOCT", "IVUS", "LS", "MG", "OCT", "OP", "OPM", "OPT", "OT",
    "PA", "PX", "RF", "RG", "RTIMAGE", "SEG", "SM", "TG", "XA", "XC",
];
