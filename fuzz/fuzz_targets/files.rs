//! Fuzz target: bytes of any kind are a volume or are refused; what is read has as many samples as its size says.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let (bytes, rest) = data.split_at(data.len() / 2);
    for bytes in [data, bytes] {
        if let Ok(volume) = wavesplat_files::read("any", bytes, |_| Ok(rest.to_vec())) {
            assert_eq!(volume.samples().len(), volume.size.iter().product());
            let _ = volume.volume();
        }
    }
});
