//! Range of an array: its smallest and largest number.

use crate::simd::LANES;

/// Smallest and largest number; `[∞, −∞]` of an empty array. NaN is ignored.
///
/// Keeps sixteen of each side by side: with only one, each comparison would wait for the one before it.
pub fn of(numbers: &[f32]) -> [f32; 2] {
    let mut least = [f32::INFINITY; LANES];
    let mut largest = [f32::NEG_INFINITY; LANES];
    let (vectors, rest) = numbers.as_chunks::<LANES>();
    let mut widen = |numbers: &[f32]| {
        for ((least, largest), x) in least.iter_mut().zip(&mut largest).zip(numbers) {
            *least = if *x < *least { *x } else { *least };
            *largest = if *x > *largest { *x } else { *largest };
        }
    };
    for vector in vectors {
        widen(vector);
    }
    widen(rest);
    [least.into_iter().fold(f32::INFINITY, f32::min), largest.into_iter().fold(f32::NEG_INFINITY, f32::max)]
}

/// Smallest range that contains two ranges.
pub fn union(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_found_wherever_they_are() {
        assert_eq!(of(&[]), [f32::INFINITY, f32::NEG_INFINITY]);
        for n in [1, 15, 16, 17, 40] {
            for (lowest, highest) in [(0, n - 1), (n - 1, 0), (n / 2, n / 3)] {
                let mut numbers: Vec<f32> = (0..n).map(|i| (i as f32).sin()).collect();
                numbers[highest] = 7.0;
                numbers[lowest] = -5.0;
                let want = [-5.0, if lowest == highest { numbers.iter().copied().fold(-9.0, f32::max) } else { 7.0 }];
                assert_eq!(of(&numbers), want);
                numbers.push(f32::NAN);
                assert_eq!(of(&numbers), want);
            }
        }
        assert_eq!(of(&[f32::NAN, f32::INFINITY, 2.0]), [2.0, f32::INFINITY]);
        assert_eq!(union([1.0, 2.0], [0.0, 1.5]), [0.0, 2.0]);
    }
}
