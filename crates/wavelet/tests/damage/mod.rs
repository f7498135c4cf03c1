//! Damaged coefficient arrays, as in a broken file, and checks of volumes made from them. Shared by a test and by
//! fuzzing.

use std::sync::{Arc, LazyLock};

use wavesplat_core::Decoder as _;
use wavesplat_wavelet::{CoarseLevel, CoefficientArrays, CoefficientDecoder, Keep, Norm, WaveletFamily, WaveletVolume};

/// Source of choices: bytes, and zeros after the last. A fuzzer changes bytes to reach more of the code.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn word(&mut self) -> u64 {
        (0..8).fold(0, |word, _| word << 8 | u64::from(self.byte()))
    }

    /// A number below `n`, or 0.
    fn below(&mut self, n: usize) -> usize {
        usize::from(u16::from_be_bytes([self.byte(), self.byte()])) % n.max(1)
    }

    /// Any f32: ordinary ones, and all patterns of bits.
    fn float(&mut self) -> f32 {
        if self.byte().is_multiple_of(2) { f32::from(self.byte()) - 128.0 } else { f32::from_bits(self.word() as u32) }
    }

    /// A length along an axis, seldom too large for any memory.
    fn length(&mut self) -> usize {
        match self.byte() {
            255 => self.word() as usize,
            254 => self.below(1 << 16),
            byte => usize::from(byte % 24),
        }
    }
}

/// Sound arrays of every family, with shapes some of whose axes are split up early.
static SOUND: LazyLock<Vec<CoefficientArrays>> = LazyLock::new(|| {
    let sizes = [[11, 9, 10], [17, 1, 2], [1, 1, 1], [8, 16, 5]];
    let volume = |family, size: [usize; 3]| {
        let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
        let keep = Keep::Fraction(0.3);
        WaveletVolume::new(family, size, samples, None, Norm::L2, keep).expect("a sound volume").to_arrays()
    };
    WaveletFamily::NAMES.iter().flat_map(|(_, family)| sizes.map(|size| volume(*family, size))).collect()
});

/// Sound arrays with damage that the bytes choose.
pub fn damaged(bytes: &mut Bytes) -> CoefficientArrays {
    let mut arrays = SOUND[bytes.below(SOUND.len())].clone();
    for _ in 0..bytes.below(7) {
        damage(&mut arrays, bytes);
    }
    // With lengths that fit, damage gets as far as the checks of the contents.
    if bytes.byte().is_multiple_of(2) {
        let n_blocks = arrays.has_block.iter().filter(|has| **has != 0).count();
        arrays.masks.resize(8 * n_blocks, 0);
        let n_values = arrays.masks.iter().map(|mask| mask.count_ones() as usize).sum();
        arrays.values.resize(n_values, 1.5);
    }
    arrays
}

fn damage(arrays: &mut CoefficientArrays, bytes: &mut Bytes) {
    let CoefficientArrays { family, size, n_levels, threshold, offset, has_block, masks, values, range } = arrays;
    match bytes.byte() % 13 {
        0 => *family = WaveletFamily::NAMES[bytes.below(7)].1,
        1 => size[bytes.below(3)] = bytes.length(),
        2 => *n_levels = bytes.length(),
        3 => *threshold = f64::from_bits(bytes.word()),
        4 => *range = Some([bytes.float(), bytes.float()]),
        5 => change(has_block, bytes, |_, bytes| bytes.byte()),
        6 => change(has_block, bytes, |has, _| 1 - has.min(1)),
        7 => change(masks, bytes, |mask, bytes| mask ^ 1 << (bytes.byte() % 64)),
        8 => change(masks, bytes, |_, bytes| bytes.word()),
        9 => change(values, bytes, |_, bytes| bytes.float()),
        10 => *offset = bytes.float(),
        11 => has_block.resize(bytes.below(600), 1),
        _ => {
            masks.resize(bytes.below(1200), u64::MAX);
            values.truncate(bytes.below(2000));
        }
    }
}

fn change<T: Copy>(array: &mut [T], bytes: &mut Bytes, new: impl Fn(T, &mut Bytes) -> T) {
    if !array.is_empty() {
        let place = bytes.below(array.len());
        array[place] = new(array[place], bytes);
    }
}

/// Whether arrays are accepted; then the volume must return the same arrays, and decode the same samples in every box.
///
/// # Panics
/// Where an accepted volume returns other arrays or samples.
pub fn check(arrays: &CoefficientArrays, bytes: &mut Bytes) -> bool {
    let Ok(volume) = WaveletVolume::from_arrays(arrays.clone()) else { return false };
    let back = volume.to_arrays();
    assert_eq!((back.family, back.size, back.n_levels), (arrays.family, arrays.size, arrays.n_levels));
    assert!(back.masks == arrays.masks && back.values.len() == arrays.values.len());
    assert!(back.has_block.iter().zip(&arrays.has_block).all(|(a, b)| (*a != 0) == (*b != 0)));
    assert!(volume.n_kept() == arrays.values.len() && volume.n_bytes() >= 4 * volume.n_kept());
    let volume = Arc::new(volume);
    let level = bytes.below(volume.plan().n_levels() + 1);
    let weights = if bytes.byte() == 0 { vec![0.0, bytes.float()] } else { Vec::new() };
    let decoder = CoefficientDecoder::new(volume.clone(), level, &weights).expect("a level that there is");
    let size @ [nx, ny, _] = decoder.size();
    let all = decoder.all();
    let lo = size.map(|n| bytes.below(n));
    let hi = [0, 1, 2].map(|a| lo[a] + 1 + bytes.below(size[a] - lo[a]));
    let [bx, by, bz] = [0, 1, 2].map(|a| hi[a] - lo[a]);
    let mut part = vec![f32::NAN; bx * by * bz];
    decoder.decode(lo, hi, &mut part);
    // Damaged coefficients may be finite, and sums of them not: then neither box means anything.
    if all.iter().all(|sample| sample.is_finite()) {
        for (i, sample) in part.iter().enumerate() {
            let [x, y, z] = [lo[0] + i % bx, lo[1] + i / bx % by, lo[2] + i / (bx * by)];
            assert_eq!(sample.to_bits(), all[(z * ny + y) * nx + x].to_bits(), "a box differs at {x} {y} {z}");
        }
    }
    let _ = decoder.range();
    assert!(CoefficientDecoder::new(volume.clone(), volume.plan().n_levels() + 1, &[]).is_err());
    if let Ok(coarse) = CoarseLevel::new(decoder) {
        let size = coarse.size();
        let mut samples = vec![0.0; size.iter().product()];
        coarse.decode([0; 3], size, &mut samples);
    }
    true
}
