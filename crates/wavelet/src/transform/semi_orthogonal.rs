//! Semi-orthogonal B-spline wavelets on an interval (Chui & Wang), with knots for which splines end on their last
//! coefficient.
//!
//! The samples are taken as coefficients of B-splines of order m on the knots `0, 1, .. n − m + 1`, the first and the
//! last of multiplicity m. A level drops every second break point. A coarse spline is a fine one,
//! `P` holds its coefficients; the wavelets `Q` are the fine splines orthogonal to all coarse ones, `Pᵀ G Q = 0` with
//! G the integrals of products. Synthesis is `x = P low + Q detail`, finite sums; analysis solves that banded system,
//! so nothing is cut off and reconstruction is exact to rounding.
//!
//! - Size: any. With an odd number of intervals the last one is not halved; it stays shorter than the others until a
//!   later level merges it.
//! - Ends: no signal is assumed beyond them; boundary wavelets have the shortest support, found as the null space
//!   of a window of `Pᵀ G`. Inside they are the wavelets of Chui & Wang, with 3m − 1 taps.
//! - Normalisation: scaling functions have sum 1, so low-pass coefficients of a constant are that constant. The largest
//!   tap of each wavelet is 1; of two largest of opposite sign (quadratic splines) the first.
//! - Polynomials of degree below m, given by their spline coefficients, have no details, not even at the ends.
//!
//! Sources: Chui & Wang, "On compactly supported spline wavelets and a duality principle", 1992; Chui & Quak, "Wavelets
//! on a bounded interval", 1992; Stollnitz, `DeRose`, Salesin, *Wavelets for Computer Graphics*, 1996, ch. 7.

use super::spline::{MAX_ORDER, SparseColumn, gram, refine};

/// One level of a split: coarse break points, and scaling functions `P` and wavelets `Q` as fine coefficients.
#[derive(Debug)]
pub(crate) struct SplineSplit {
    pub breaks: Vec<f64>,
    pub scaling: Vec<SparseColumn>,
    pub wavelets: Vec<SparseColumn>,
}

/// Splits the spline space of an order on at least two intervals into coarse splines and wavelets.
pub(crate) fn split(breaks: &[f64], order: usize) -> SplineSplit {
    let n_intervals = breaks.len() - 1;
    let last = breaks[n_intervals];
    let coarse: Vec<f64> = breaks[..n_intervals].iter().copied().step_by(2).chain([last]).collect();
    let scaling = refine(&coarse, breaks, order);
    let products = products(&scaling, &gram(breaks, order), order);
    let n = n_intervals + order - 1;
    let n_wavelets = n - scaling.len();
    let wavelets = (0..n_wavelets).map(|k| {
        let [first, end] = window(k, n_wavelets, n, order, n_intervals % 2);
        let mut found = null_space(&products, first, end);
        assert_eq!(found.len(), 1, "a window of {first}..{end} of {n} B-splines of order {order} holds one wavelet");
        normalise(found.swap_remove(0))
    });
    SplineSplit { breaks: coarse, scaling, wavelets: wavelets.collect() }
}

/// The rows of `Pᵀ G`: integrals of each coarse function with the fine ones.
fn products(scaling: &[SparseColumn], gram: &[[f64; MAX_ORDER]], order: usize) -> Vec<SparseColumn> {
    let product = |i: usize, j: usize| gram[i.min(j)][i.abs_diff(j)];
    let row = |function: &SparseColumn| {
        let first = function.first.saturating_sub(order - 1);
        let end = gram.len().min(function.end() + order - 1);
        let value = |i: usize| {
            let near = function.first.max(i.saturating_sub(order - 1))..function.end().min(i + order);
            near.map(|j| function.at(j) * product(i, j)).sum()
        };
        SparseColumn { first, values: (first..end).map(value).collect() }
    };
    scaling.iter().map(row).collect()
}

/// Shortest window of fine functions that holds wavelet `k` of `n_wavelets`: the only spline in it that is orthogonal
/// to all coarse functions.
fn window(k: usize, n_wavelets: usize, n: usize, order: usize, odd: usize) -> [usize; 2] {
    // Away from the ends a window starts at 2k − m + 1; towards an end it is as short as the functions there allow.
    let start = |k: usize, odd: usize| k.max((2 * k + 1 + odd).saturating_sub(order));
    [start(k, 0), n - start(n_wavelets - 1 - k, odd)]
}

/// All vectors on `first..end` that are orthogonal to every row, by Gauss-Jordan elimination with full pivoting.
fn null_space(rows: &[SparseColumn], first: usize, end: usize) -> Vec<SparseColumn> {
    let n = end - first;
    let rows = &rows[rows.partition_point(|row| row.end() <= first)..rows.partition_point(|row| row.first < end)];
    // Columns are scaled to a common size: functions next to a short last interval are small.
    let scale: Vec<f64> =
        (first..end).map(|i| rows.iter().fold(0.0_f64, |a, row| a.max(row.at(i).abs())).recip()).collect();
    let mut matrix: Vec<Vec<f64>> =
        rows.iter().map(|row| (0..n).map(|i| row.at(first + i) * scale[i]).collect()).collect();
    let mut free: Vec<usize> = (0..n).collect();
    let mut pivots = Vec::new();
    for r in 0..matrix.len() {
        let candidates = (r..matrix.len()).flat_map(|i| free.iter().map(move |&j| (i, j)));
        let Some((i, j)) = candidates.max_by(|a, b| matrix[a.0][a.1].abs().total_cmp(&matrix[b.0][b.1].abs())) else {
            break;
        };
        // Columns are scaled to 1: a smaller pivot is the rounding error of dependent rows.
        if matrix[i][j].abs() < 1e-11 {
            break;
        }
        matrix.swap(r, i);
        let pivot = matrix[r][j];
        matrix[r].iter_mut().for_each(|x| *x /= pivot);
        let pivot_row = matrix[r].clone();
        for (_, row) in matrix.iter_mut().enumerate().filter(|(i, _)| *i != r) {
            let weight = row[j];
            row.iter_mut().zip(&pivot_row).for_each(|(x, p)| *x -= weight * p);
        }
        free.retain(|&f| f != j);
        pivots.push(j);
    }
    let vector = |&f: &usize| {
        let mut values = vec![0.0; n];
        values[f] = scale[f];
        for (row, &j) in matrix.iter().zip(&pivots) {
            values[j] = -row[f] * scale[j];
        }
        SparseColumn { first, values }
    };
    free.iter().map(vector).collect()
}

fn normalise(wavelet: SparseColumn) -> SparseColumn {
    let largest = wavelet.values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    // The first of equal peaks, independent of rounding.
    let peak = wavelet.values.iter().copied().find(|x| x.abs() > largest * (1.0 - 1e-6)).unwrap_or(1.0);
    SparseColumn { first: wavelet.first, values: wavelet.values.into_iter().map(|x| x / peak).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integers(n_intervals: usize) -> Vec<f64> {
        (0..=n_intervals).map(|i| i as f64).collect()
    }

    fn binomial(n: usize, k: usize) -> f64 {
        (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
    }

    /// B-spline of an order at an integer, on the knots 0, 1, .. order.
    fn cardinal(order: usize, x: usize) -> f64 {
        let power = |t: usize| ((x - t) as f64).powi(order as i32 - 1);
        let sum: f64 =
            (0..=x.min(order)).map(|t| (1 - 2 * (t % 2) as i64) as f64 * binomial(order, t) * power(t)).sum();
        sum / (1..order).map(|i| i as f64).product::<f64>()
    }

    #[test]
    fn inner_functions_are_those_of_the_papers() {
        for order in 2..=4 {
            let split = split(&integers(40), order);
            let two_scale: Vec<f64> = (0..=order).map(|k| binomial(order, k) / f64::from(1 << (order - 1))).collect();
            let inside = &split.scaling[10].values;
            assert!(inside.iter().zip(&two_scale).all(|(a, b)| (a - b).abs() < 1e-14), "order {order}: {inside:?}");
            assert_eq!(inside.len(), order + 1);
            // Chui & Wang: q_k = (−1)^k / 2^(m−1) Σ_l C(m, l) N_2m(k + 1 − l), k = 0 .. 3m − 2.
            let q = |k: usize| -> f64 {
                let terms = (0..=order.min(k)).map(|l| binomial(order, l) * cardinal(2 * order, k + 1 - l));
                (1 - 2 * (k % 2) as i64) as f64 * terms.sum::<f64>()
            };
            let paper = normalise(SparseColumn { first: 0, values: (0..3 * order - 1).map(q).collect() });
            let wavelet = &split.wavelets[10];
            assert_eq!(wavelet.values.len(), 3 * order - 1);
            for (got, want) in wavelet.values.iter().zip(&paper.values) {
                assert!((got - want).abs() < 1e-10, "order {order}: {wavelet:?} for {paper:?}");
            }
        }
    }

    #[test]
    fn the_first_linear_boundary_wavelet_is_the_published_one() {
        // Stollnitz, DeRose, Salesin 1996, appendix B: (−11.022704, 10.104145, −5.511352, 0.918559) by a common factor.
        let want = [-11.022_704, 10.104_145, -5.511_352, 0.918_559].map(|x| x / -11.022_704);
        let got = &split(&integers(16), 2).wavelets[0];
        assert_eq!(got.first, 0);
        assert!(got.values.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-6), "{got:?}");
    }

    #[test]
    fn wavelets_are_orthogonal_to_coarse_functions_down_to_one_interval() {
        for order in 2..=4 {
            for n_intervals in 2..70 {
                let mut breaks = integers(n_intervals);
                while breaks.len() > 2 {
                    let split = split(&breaks, order);
                    let gram = gram(&breaks, order);
                    let products = products(&split.scaling, &gram, order);
                    assert_eq!(split.scaling.len() + split.wavelets.len(), gram.len());
                    for (p, q) in products.iter().flat_map(|p| split.wavelets.iter().map(move |q| (p, q))) {
                        let (dot, size) = (p.first.max(q.first)..p.end().min(q.end()))
                            .map(|i| p.at(i) * q.at(i))
                            .fold((0.0, 0.0_f64), |(dot, size), term| (dot + term, size + term.abs()));
                        assert!(dot.abs() <= 1e-10 * size + 1e-13, "order {order}, {n_intervals}: {dot} of {size}");
                    }
                    breaks = split.breaks;
                }
            }
        }
    }
}
