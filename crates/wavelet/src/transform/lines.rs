//! Line bundles: a 1-D transform runs along x, y and z of a volume on many lines at once.
//!
//! Row `i` of a bundle holds sample `i` of [`LANES`] neighbouring lines, so that every operation works on whole
//! vectors, whatever the axis. Along y and z the rows are pieces of the volume's own rows; along x they are transposed.
//! Bundles are independent, and the arithmetic of a lane does not depend on its neighbours: the result depends neither
//! on the number of threads nor on the width of the vectors.

use wavesplat_compute::{parallel, simd};

/// Lines in a bundle: two cache lines of f32; 256 rows just fit into the L1 cache of today's processors.
pub const LANES: usize = 32;

/// One sample of each line of a bundle.
pub type LineRow<T> = [T; LANES];

/// A bundle, and scratch space of its size.
pub struct LineBundle<T> {
    pub rows: Vec<LineRow<T>>,
    pub spare: Vec<LineRow<T>>,
}

impl<T: Copy + Default> LineBundle<T> {
    pub fn new() -> Self {
        Self { rows: Vec::new(), spare: Vec::new() }
    }

    #[inline(always)]
    fn resize(&mut self, n: usize) {
        self.rows.resize(n, [T::default(); LANES]);
        self.spare.resize(n, [T::default(); LANES]);
    }
}

/// Whether a transform analyses or synthesises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransformDirection {
    /// Samples -> coefficients, along x, y, then z.
    Analysis,
    /// Coefficients -> samples, along z, y, then x.
    Synthesis,
}

/// Row in the bundle of each sample or coefficient of a line, on loading and on storing. Transforms work in place with
/// low-pass and detail coefficients interleaved; in the volume low-pass coefficients come first. `None`: the order of
/// the line.
#[derive(Clone, Copy)]
struct RowOrders<'a> {
    load: Option<&'a [usize]>,
    store: Option<&'a [usize]>,
}

impl<'a> RowOrders<'a> {
    fn new(order: &'a [usize], direction: TransformDirection) -> Self {
        match direction {
            TransformDirection::Analysis => Self { load: None, store: Some(order) },
            TransformDirection::Synthesis => Self { load: Some(order), store: None },
        }
    }
}

#[inline(always)]
fn row_of(order: Option<&[usize]>, i: usize) -> usize {
    order.map_or(i, |order| order[i])
}

/// The box of `size` at the first corner of a volume with rows of `pitch[0]` and slices of `pitch[1]` such rows.
#[derive(Clone, Copy)]
pub struct LowBox {
    pub pitch: [usize; 2],
    pub size: [usize; 3],
}

/// Runs `analyse(axis, bundle)` or `synthesise(axis, bundle)`, by direction, on all lines of a box along all axes that
/// have an order, the row in the bundle of each coefficient. Axes without an order are left unchanged.
pub fn transform<T: Copy + Default + Send + Sync>(
    data: &mut [T],
    corner: LowBox,
    orders: [Option<&[usize]>; 3],
    direction: TransformDirection,
    width: simd::Level,
    analyse: impl Fn(usize, &mut LineBundle<T>) + Sync + Send,
    synthesise: impl Fn(usize, &mut LineBundle<T>) + Sync + Send,
) {
    // The direction is decided here, once, not for every bundle.
    match direction {
        TransformDirection::Analysis => on_lines(data, corner, orders, direction, width, analyse),
        TransformDirection::Synthesis => on_lines(data, corner, orders, direction, width, synthesise),
    }
}

/// One direction of [`transform`].
fn on_lines<T: Copy + Default + Send + Sync>(
    data: &mut [T],
    corner: LowBox,
    orders: [Option<&[usize]>; 3],
    direction: TransformDirection,
    width: simd::Level,
    work: impl Fn(usize, &mut LineBundle<T>) + Sync + Send,
) {
    let LowBox { pitch: [row_len, n_rows], size: [nx, ny, nz] } = corner;
    let slice_len = row_len * n_rows;
    let row_orders = orders.map(|order| order.map(|order| RowOrders::new(order, direction)));
    let slices = &mut data[..nz * slice_len];

    let in_slice_axes = match direction {
        TransformDirection::Analysis => [0, 1],
        TransformDirection::Synthesis => [1, 0],
    };
    let in_slices = |slices: &mut [T]| {
        if row_orders[0].is_none() && row_orders[1].is_none() {
            return;
        }
        parallel::for_each_chunk(slices, slice_len, |_, slice| {
            width.run(
                #[inline(always)]
                || {
                    let mut rows: Vec<&mut [T]> = slice.chunks_mut(row_len).take(ny).map(|r| &mut r[..nx]).collect();
                    let lines = &mut LineBundle::new();
                    for axis in in_slice_axes {
                        match row_orders[axis] {
                            Some(orders) if axis == 0 => {
                                for rows in rows.chunks_mut(LANES) {
                                    along(rows, nx, orders, lines, |lines| work(0, lines));
                                }
                            }
                            Some(orders) => across(&mut rows, nx, orders, lines, |lines| work(1, lines)),
                            None => {}
                        }
                    }
                },
            );
        });
    };
    let across_slices = |slices: &mut [T]| {
        let Some(orders) = row_orders[2] else { return };
        // The rows of all slices by their y: each list is one job.
        let mut rows_by_y: Vec<Vec<&mut [T]>> = (0..ny).map(|_| Vec::with_capacity(nz)).collect();
        for slice in slices.chunks_mut(slice_len) {
            for (rows, row) in rows_by_y.iter_mut().zip(slice.chunks_mut(row_len)) {
                rows.push(&mut row[..nx]);
            }
        }
        parallel::for_each_chunk(&mut rows_by_y, 1, |_, rows| {
            width.run(
                #[inline(always)]
                || across(&mut rows[0], nx, orders, &mut LineBundle::new(), |lines| work(2, lines)),
            );
        });
    };

    match direction {
        TransformDirection::Analysis => {
            in_slices(slices);
            across_slices(slices);
        }
        TransformDirection::Synthesis => {
            across_slices(slices);
            in_slices(slices);
        }
    }
}

/// Runs `work` on the lines along the given rows, at most [`LANES`] of them.
#[inline(always)]
fn along<T: Copy + Default>(
    rows: &mut [&mut [T]],
    n: usize,
    orders: RowOrders,
    lines: &mut LineBundle<T>,
    work: impl Fn(&mut LineBundle<T>),
) {
    lines.resize(n);
    for (lane, row) in rows.iter().enumerate() {
        for (i, sample) in row.iter().enumerate() {
            lines.rows[row_of(orders.load, i)][lane] = *sample;
        }
    }
    work(lines);
    for (lane, row) in rows.iter_mut().enumerate() {
        for (i, sample) in row.iter_mut().enumerate() {
            *sample = lines.rows[row_of(orders.store, i)][lane];
        }
    }
}

/// Runs `work` on the lines across the given rows, of `n_lines` samples each.
#[inline(always)]
fn across<T: Copy + Default>(
    rows: &mut [&mut [T]],
    n_lines: usize,
    orders: RowOrders,
    lines: &mut LineBundle<T>,
    work: impl Fn(&mut LineBundle<T>),
) {
    lines.resize(rows.len());
    for first in (0..n_lines).step_by(LANES) {
        let n_lanes = LANES.min(n_lines - first);
        for (i, row) in rows.iter().enumerate() {
            lines.rows[row_of(orders.load, i)][..n_lanes].copy_from_slice(&row[first..first + n_lanes]);
        }
        work(lines);
        for (i, row) in rows.iter_mut().enumerate() {
            row[first..first + n_lanes].copy_from_slice(&lines.rows[row_of(orders.store, i)][..n_lanes]);
        }
    }
}
