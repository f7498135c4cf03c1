//! B-splines on an interval with open-uniform knots: values, Gram matrix, knot insertion.
//!
//! A space is given by its break points, ascending; the first and the last are knots of full multiplicity, so the first
//! and the last function reach 1 there and a spline's end values are its first and last coefficient. With `m` the order
//! (degree plus one), `n` break intervals carry `n + m − 1` functions of sum 1.
//!
//! Sources: de Boor, *A Practical Guide to Splines* (values by the stable recurrence); Cohen, Lyche, Riesenfeld,
//! "Discrete B-splines and subdivision techniques", 1980 (the Oslo algorithm: the same recurrence at several fine
//! knots).

/// Largest order of a spline.
pub const MAX_ORDER: usize = 4;

/// A column of a banded matrix: entries from `first` on, 0 elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseColumn {
    pub first: usize,
    pub values: Vec<f64>,
}

impl SparseColumn {
    pub fn end(&self) -> usize {
        self.first + self.values.len()
    }

    pub fn at(&self, i: usize) -> f64 {
        if i < self.first { 0.0 } else { self.values.get(i - self.first).copied().unwrap_or(0.0) }
    }
}

/// Knots of a space: its break points, the first and the last repeated.
pub fn knots(breaks: &[f64], order: usize) -> Vec<f64> {
    let ends = |b: f64| std::iter::repeat_n(b, order - 1);
    ends(breaks[0]).chain(breaks.iter().copied()).chain(ends(breaks[breaks.len() - 1])).collect()
}

/// Values of the functions that are not 0 between knots `span` and `span + 1`, function `span + 1 − order` first. The
/// recurrence goes from order r to r + 1 at `x(r)`: one point for values, successive fine knots for refinement.
fn recurrence(knots: &[f64], order: usize, span: usize, x: impl Fn(usize) -> f64) -> [f64; MAX_ORDER] {
    let mut b = [1.0, 0.0, 0.0, 0.0];
    for r in 1..order {
        let x = x(r);
        let mut next = [0.0; MAX_ORDER];
        for (k, share) in b.iter().enumerate().take(r) {
            // The function of order r that starts at knot `start` and is split between its two parents.
            let start = span + 1 + k - r;
            let t = (x - knots[start]) / (knots[start + r] - knots[start]);
            next[k] += (1.0 - t) * share;
            next[k + 1] += t * share;
        }
        b = next;
    }
    b
}

/// Values at `x` of the `order` functions that are not 0 on a break interval; function `interval` is the first.
pub fn values(knots: &[f64], order: usize, interval: usize, x: f64) -> [f64; MAX_ORDER] {
    recurrence(knots, order, interval + order - 1, |_| x)
}

/// Integrals of products: entry `[i][d]` is `∫ B_i B_(i+d)`.
pub fn gram(breaks: &[f64], order: usize) -> Vec<[f64; MAX_ORDER]> {
    // Four Gauss-Legendre points are exact up to degree 7; products of cubics have 6.
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
    ];
    let knots = knots(breaks, order);
    let n_intervals = breaks.len() - 1;
    let mut gram = vec![[0.0; MAX_ORDER]; n_intervals + order - 1];
    for interval in 0..n_intervals {
        let half = (breaks[interval + 1] - breaks[interval]) / 2.0;
        for (node, weight) in NODES {
            let x = breaks[interval] + half * (1.0 + node);
            let b = recurrence(&knots, order, interval + order - 1, |_| x);
            for i in 0..order {
                for j in i..order {
                    gram[interval + i][j - i] += half * weight * b[i] * b[j];
                }
            }
        }
    }
    gram
}

/// Functions of a coarse space as sums of functions of a fine one, whose breaks include the coarse ones.
pub fn refine(coarse: &[f64], fine: &[f64], order: usize) -> Vec<SparseColumn> {
    let (coarse_knots, fine_knots) = (knots(coarse, order), knots(fine, order));
    let mut columns = vec![SparseColumn { first: 0, values: Vec::new() }; coarse.len() + order - 2];
    let mut interval = 0;
    for i in 0..fine.len() + order - 2 {
        while interval + 2 < coarse.len() && coarse[interval + 1] <= fine_knots[i] {
            interval += 1;
        }
        let weights = recurrence(&coarse_knots, order, interval + order - 1, |r| fine_knots[i + r]);
        for (k, &weight) in weights.iter().enumerate().take(order) {
            let column = &mut columns[interval + k];
            if weight != 0.0 {
                if column.values.is_empty() {
                    column.first = i;
                }
                // There are no gaps: a discrete B-spline is positive on its support.
                column.values.resize(i - column.first, 0.0);
                column.values.push(weight);
            }
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_the_cardinal_splines() {
        let breaks: Vec<f64> = (0..10).map(f64::from).collect();
        // At a break and half way between two, well inside.
        let values = |order, interval, x| values(&knots(&breaks, order), order, interval, x);
        assert_eq!(values(2, 4, 4.5)[..2], [0.5, 0.5]);
        assert_eq!(values(3, 4, 4.5)[..3], [0.125, 0.75, 0.125]);
        for (got, want) in values(4, 4, 4.0).into_iter().zip([1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0]) {
            assert!((got - want).abs() < 1e-15);
        }
        // At the ends only one function is left.
        assert_eq!(values(4, 0, 0.0), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(values(4, 8, 9.0), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn integrals_are_those_of_the_cardinal_splines() {
        let breaks: Vec<f64> = (0..12).map(f64::from).collect();
        // Values of the B-spline of twice the order at the integers.
        let known: [&[f64]; 3] = [&[4.0, 1.0], &[66.0, 26.0, 1.0], &[2416.0, 1191.0, 120.0, 1.0]];
        for (order, (known, scale)) in (2..).zip(known.into_iter().zip([6.0, 120.0, 5040.0])) {
            let inside = gram(&breaks, order)[5];
            for (d, want) in known.iter().enumerate() {
                assert!((inside[d] - want / scale).abs() < 1e-14, "order {order}, {d}");
            }
        }
    }

    #[test]
    fn a_refined_function_has_the_same_values() {
        let fine = [0.0, 1.0, 2.0, 3.0, 4.0, 4.25];
        let coarse = [0.0, 2.0, 4.0, 4.25];
        for order in 2..=4 {
            let columns = refine(&coarse, &fine, order);
            for x in [0.0, 0.3, 1.7, 2.0, 3.9, 4.1, 4.25] {
                let interval_of = |breaks: &[f64]| breaks[1..breaks.len() - 1].iter().filter(|b| **b <= x).count();
                let (i, j) = (interval_of(&coarse), interval_of(&fine));
                let direct = values(&knots(&coarse, order), order, i, x);
                let on_fine = values(&knots(&fine, order), order, j, x);
                for (k, column) in columns.iter().enumerate() {
                    let got: f64 = (0..order).map(|f| column.at(j + f) * on_fine[f]).sum();
                    let want = if (i..i + order).contains(&k) { direct[k - i] } else { 0.0 };
                    assert!((got - want).abs() < 1e-14, "order {order}, function {k} at {x}: {got} for {want}");
                }
            }
        }
    }
}
