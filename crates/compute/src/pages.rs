//! Huge pages: large arrays in large pages of memory, where the system has them.
//!
//! The C library gives large arrays back to the system when they are freed, and the next one is new memory: the
//! processor stops at each of its pages of 4096 bytes for the system to fill it with zeros. Pages of 2 MiB are filled
//! as fast as memory is, and take 512 times fewer stops (Linux: `transparent_hugepage`, man 2 madvise).
#![allow(unsafe_code, reason = "a hint to the system")]

/// Bytes from which an array is large: smaller ones have hardly a page of their own.
#[cfg(target_os = "linux")]
const LARGE_BYTES: usize = 4 << 20;

/// Bytes of a large page.
#[cfg(target_os = "linux")]
const PAGE_BYTES: usize = 2 << 20;

/// Asks for large pages for an array that nothing has been written to yet, not even zeros. A hint: without large pages,
/// nothing changes.
pub fn prefer_large<T>(places: &mut [T]) {
    #[cfg(target_os = "linux")]
    if size_of_val(places) >= LARGE_BYTES {
        let bytes = places.as_mut_ptr_range();
        let (start, end) = (bytes.start.addr(), bytes.end.addr());
        // Only whole pages inside the array.
        let first = start.next_multiple_of(PAGE_BYTES);
        let n_bytes = (end - first) / PAGE_BYTES * PAGE_BYTES;
        // SAFETY: all of it lies in the array, and the advice changes no contents.
        unsafe { libc::madvise(bytes.start.byte_add(first - start).cast(), n_bytes, libc::MADV_HUGEPAGE) };
    }
    #[cfg(not(target_os = "linux"))]
    let _ = places;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_any_size_keep_their_contents() {
        for n in [0, 1, 1 << 20, (1 << 20) + 1, 5 << 20, 33 << 20] {
            let mut zeros = vec![0_u8; n];
            prefer_large(&mut zeros);
            assert!(zeros.iter().all(|x| *x == 0));
            zeros.fill(7);
            prefer_large(&mut zeros[n / 3..]);
            assert!(zeros.iter().all(|x| *x == 7));
        }
    }

    /// Not on other processors, which may be emulated together with the system's calls.
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    #[test]
    fn large_arrays_are_advised() {
        if !std::path::Path::new("/sys/kernel/mm/transparent_hugepage").exists() {
            println!("skipped: this system has no large pages");
            return;
        }
        let mut all = vec![0_u8; 64 << 20];
        prefer_large(&mut all);
        // "hg": the advice is known to the system, whether or not it has large pages.
        let place = all[32 << 20..].as_ptr().addr();
        let maps = std::fs::read_to_string("/proc/self/smaps").unwrap();
        let mut is_here = false;
        for line in maps.lines() {
            let range = line.split(' ').next().and_then(|range| range.split_once('-'));
            let ends = range.map(|(a, b)| [a, b].map(|end| usize::from_str_radix(end, 16).ok()));
            if let Some([Some(start), Some(end)]) = ends {
                is_here = (start..end).contains(&place);
            } else if is_here && let Some(flags) = line.strip_prefix("VmFlags:") {
                assert!(flags.split_whitespace().any(|flag| flag == "hg"), "{flags}");
                return;
            }
        }
        panic!("no flags of {place:x}");
    }
}
