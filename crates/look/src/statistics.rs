//! Sums, means, percentiles, medians and counts of values, equal to the bit to those of `NumPy`.
//!
//! Curves begin and end at percentiles and means, so these do not depend on who computes them. Percentiles are those of
//! `numpy.percentile`, linear between two values; sums have its order: pairs of halves down to 128 values, of which
//! eight are summed side by side.

use crate::numbers::linspace;

/// Values of which one half is added to the other, and values that are summed side by side.
const BLOCK: usize = 128;
const LANES: usize = 8;

/// The sum of values, in pairs of halves.
pub fn sum(values: &[f64]) -> f64 {
    0.0 + pairwise(values)
}

fn pairwise(values: &[f64]) -> f64 {
    let n = values.len();
    if n < LANES {
        return values.iter().fold(-0.0, |sum, value| sum + value);
    }
    if n > BLOCK {
        let half = n / 2 - (n / 2) % LANES;
        return pairwise(&values[..half]) + pairwise(&values[half..]);
    }
    let (rows, rest) = values.as_chunks::<LANES>();
    let mut lanes = rows[0];
    for row in &rows[1..] {
        for lane in 0..LANES {
            lanes[lane] += row[lane];
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let whole = ((a + b) + (c + d)) + ((e + f) + (g + h));
    rest.iter().fold(whole, |sum, value| sum + value)
}

/// The mean of values; NaN of none.
pub fn mean(values: &[f64]) -> f64 {
    sum(values) / values.len() as f64
}

/// The standard deviation of values, with their number as the divisor.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: Vec<f64> = values.iter().map(|value| (value - mean) * (value - mean)).collect();
    (sum(&squares) / values.len() as f64).sqrt()
}

/// The share of values that are of some sort; NaN of no values.
pub fn share(values: &[f64], is_counted: impl Fn(f64) -> bool) -> f64 {
    count(values, is_counted) as f64 / values.len() as f64
}

/// The number of values that are of some sort.
pub fn count(values: &[f64], is_counted: impl Fn(f64) -> bool) -> usize {
    values.iter().filter(|&&value| is_counted(value)).count()
}

/// The values that are of some sort, in their order.
pub fn those(values: &[f64], is_kept: impl Fn(f64) -> bool) -> Vec<f64> {
    values.iter().copied().filter(|&value| is_kept(value)).collect()
}

/// Whether a number has no fraction; infinity has none.
pub fn is_whole(value: f64) -> bool {
    // From 2^52 on there are no fractions; adding it rounds those below.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let size = value.abs();
    size >= WHOLE || (size + WHOLE) - WHOLE == size
}

/// Smallest and largest value; infinity and minus infinity of none.
pub fn extremes(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| {
        (if v < low { v } else { low }, if v > high { v } else { high })
    })
}

/// The value that a percentage 0..100 of the values does not exceed; NaN if one is NaN, or of none.
pub fn percentile(values: &[f64], percent: f64) -> f64 {
    percentiles(values, [percent])[0]
}

/// Several percentiles of the same values, see [`percentile`].
pub fn percentiles<const N: usize>(values: &[f64], percents: [f64; N]) -> [f64; N] {
    let mut found = [f64::NAN; N];
    percentiles_into(values, &percents, &mut found);
    found
}

/// Any number of percentiles of the same values, see [`percentile`].
pub fn percentiles_of(values: &[f64], percents: &[f64]) -> Vec<f64> {
    let mut found = vec![f64::NAN; percents.len()];
    percentiles_into(values, percents, &mut found);
    found
}

fn percentiles_into(values: &[f64], percents: &[f64], found: &mut [f64]) {
    let Some(last) = values.len().checked_sub(1) else { return };
    if values.iter().any(|value| value.is_nan()) {
        return;
    }
    let places: Vec<f64> = percents.iter().map(|percent| last as f64 * (percent / 100.0)).collect();
    let below = |place: f64| (place.max(0.0) as usize).min(last);
    let mut ranks: Vec<usize> = places.iter().flat_map(|&place| [below(place), (below(place) + 1).min(last)]).collect();
    ranks.sort_unstable();
    ranks.dedup();
    let ranked = ranked(values, &ranks);
    let at = |rank: usize| ranked[ranks.partition_point(|&one| one < rank)];
    for (&place, found) in places.iter().zip(found) {
        let first = below(place);
        let (a, b) = (at(first), at((first + 1).min(last)));
        let t = place - first as f64;
        *found = if t >= 0.5 { b - (b - a) * (1.0 - t) } else { a + (b - a) * t };
    }
}

/// The median of values, half of the sum of the two in the middle of an even number; NaN if one is NaN, or of none.
pub fn median(values: &[f64]) -> f64 {
    let n = values.len();
    if n == 0 || values.iter().any(|value| value.is_nan()) {
        return f64::NAN;
    }
    let middle = if n % 2 == 1 { ranked(values, &[n / 2]) } else { ranked(values, &[n / 2 - 1, n / 2]) };
    mean(&middle)
}

/// The values of growing ranks, from 0 for the smallest. No value is NaN.
fn ranked(values: &[f64], ranks: &[usize]) -> Vec<f64> {
    let mut keys: Vec<i64> = values.iter().map(|&value| key(value)).collect();
    let mut found = vec![0.0; ranks.len()];
    select(&mut keys, 0, ranks, &mut found);
    found
}

/// Finds the values of ranks among keys, of which the first has rank `start`; the middle one first, so that the parts halve.
fn select(keys: &mut [i64], start: usize, ranks: &[usize], found: &mut [f64]) {
    let middle = ranks.len() / 2;
    let Some(&rank) = ranks.get(middle) else { return };
    let (below, &mut own, above) = keys.select_nth_unstable(rank - start);
    found[middle] = f64::from_bits(bits(own) as u64);
    let (few, many) = found.split_at_mut(middle);
    select(below, start, &ranks[..middle], few);
    select(above, rank + 1, &ranks[middle + 1..], &mut many[1..]);
}

/// A whole number that has the order of a number; integers are compared faster. Zeros of both signs are one value.
fn key(value: f64) -> i64 {
    bits((value + 0.0).to_bits() as i64)
}

/// Bits of a number and its key, which is the same the other way round.
fn bits(of: i64) -> i64 {
    of ^ (((of >> 63) as u64) >> 1) as i64
}

/// The different values, growing, each with the number of times it occurs. No value is NaN.
pub fn distinct(values: &[f64]) -> Vec<(f64, usize)> {
    let mut keys: Vec<i64> = values.iter().map(|&value| key(value)).collect();
    keys.sort_unstable();
    keys.chunk_by(|a, b| a == b).map(|same| (f64::from_bits(bits(same[0]) as u64), same.len())).collect()
}

/// The value that occurs most often, the least of several; `None` of no values.
pub fn commonest(distinct: &[(f64, usize)]) -> Option<f64> {
    let most = distinct.iter().map(|&(_, n)| n).max()?;
    distinct.iter().find(|&&(_, n)| n == most).map(|&(value, _)| value)
}

/// Numbers of values in bins of one width from `low` to `high`, which counts too; values outside are left out.
pub fn histogram(values: &[f64], n_bins: usize, low: f64, high: f64) -> Vec<usize> {
    let edges = linspace(low, high, n_bins + 1);
    let mut counts = vec![0; n_bins];
    for &value in values.iter().filter(|&&value| value >= low && value <= high) {
        let mut bin = ((value - low) / (high - low) * n_bins as f64) as usize;
        bin = bin.min(n_bins - 1);
        // Division is exact within one unit of the last place of an edge.
        if value < edges[bin] {
            bin -= 1;
        } else if value >= edges[bin + 1] && bin != n_bins - 1 {
            bin += 1;
        }
        counts[bin] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_lie_between_two_values_and_medians_in_the_middle() {
        let values = [40.0, 10.0, 30.0, 20.0];
        assert_eq!(percentiles(&values, [0.0, 10.0, 50.0, 90.0, 100.0]), [10.0, 13.0, 25.0, 37.0, 40.0]);
        assert_eq!(percentiles_of(&values, &[50.0]), [median(&values)]);
        assert_eq!(median(&[-1.0, -5.0, -3.0]), -3.0);
        assert!(percentile(&[], 50.0).is_nan() && median(&[1.0, f64::NAN]).is_nan());
    }

    #[test]
    fn sums_add_halves() {
        // 1e16 + 1 is 1e16: one after the other all ones would be lost; now those beside it in the first half are.
        let mut values = vec![1.0; 256];
        values[0] = 1e16;
        assert_eq!(sum(&values), 1e16 + 240.0);
        assert_eq!((mean(&[1.0, 2.0, 6.0]), deviation(&[1.0, 3.0])), (3.0, 1.0));
    }

    #[test]
    fn values_are_counted() {
        assert_eq!(distinct(&[2.0, -0.0, -1.5, 0.0, 2.0]), [(-1.5, 1), (0.0, 2), (2.0, 2)]);
        assert_eq!(commonest(&distinct(&[2.0, -0.0, -1.5, 0.0, 2.0])), Some(0.0));
        assert_eq!(histogram(&[0.0, 0.5, 0.99, 1.0, 1.01, -0.01], 2, 0.0, 1.0), [1, 3]);
        assert!(
            [0.0, -3.0, 4.5e15 + 0.5, f64::INFINITY].map(is_whole) == [true, true, false, true] && !is_whole(f64::NAN)
        );
        assert_eq!(share(&[1.0, 2.0, 3.0, 4.0], |value| value > 1.0), 0.75);
    }
}
