//! Analysis and synthesis of volumes, in place: samples `[z][y][x]` <-> coefficients in the layout of [`Plan`].

use wavesplat_compute::simd;

use crate::lines::{self, Corner, Direction};
use crate::plan::Plan;
use crate::sample::Sample;

/// Samples -> coefficients, all levels of the plan.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn analyse<T: Sample>(plan: &Plan, data: &mut [T]) {
    analyse_at(simd::Level::best(), plan, data);
}

/// Coefficients -> samples, all levels of the plan.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn synthesise<T: Sample>(plan: &Plan, data: &mut [T]) {
    synthesise_at(simd::Level::best(), plan, data);
}

/// One level of [`analyse`]: the low box of `level`, in its place, becomes that of the next level and its details.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn analyse_level<T: Sample>(plan: &Plan, level: usize, data: &mut [T]) {
    run_level(simd::Level::best(), plan, level, data, pitch(plan.size()), Direction::Analysis);
}

/// One level of [`synthesise`]: undoes [`analyse_level`], to rounding.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn synthesise_level<T: Sample>(plan: &Plan, level: usize, data: &mut [T]) {
    run_level(simd::Level::best(), plan, level, data, pitch(plan.size()), Direction::Synthesis);
}

/// The volume at a coarser level: the low box of `level`, at its own size, from the coefficients of all coarser levels.
/// Low coefficients of a constant are that constant, so it has the data's own range.
///
/// # Panics
/// Where the coefficients have another size than the plan.
pub fn synthesise_to<T: Sample>(plan: &Plan, coefficients: &[T], level: usize) -> Vec<T> {
    assert_eq!(coefficients.len(), plan.n_samples(), "coefficients and plan differ in size");
    let [row_len, n_rows] = pitch(plan.size());
    let [nx, ny, nz] = plan.low_size(level);
    let mut low = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            low.extend_from_slice(&coefficients[(z * n_rows + y) * row_len..][..nx]);
        }
    }
    let width = simd::Level::best();
    for level in (level..plan.n_levels()).rev() {
        run_level(width, plan, level, &mut low, [nx, ny], Direction::Synthesis);
    }
    low
}

fn analyse_at<T: Sample>(width: simd::Level, plan: &Plan, data: &mut [T]) {
    assert_eq!(data.len(), plan.n_samples(), "data and plan differ in size");
    for level in 0..plan.n_levels() {
        run_level(width, plan, level, data, pitch(plan.size()), Direction::Analysis);
    }
}

fn synthesise_at<T: Sample>(width: simd::Level, plan: &Plan, data: &mut [T]) {
    assert_eq!(data.len(), plan.n_samples(), "data and plan differ in size");
    for level in (0..plan.n_levels()).rev() {
        run_level(width, plan, level, data, pitch(plan.size()), Direction::Synthesis);
    }
}

fn pitch([nx, ny, _]: [usize; 3]) -> [usize; 2] {
    [nx, ny]
}

fn run_level<T: Sample>(
    width: simd::Level,
    plan: &Plan,
    level: usize,
    data: &mut [T],
    pitch: [usize; 2],
    direction: Direction,
) {
    let steps = [0, 1, 2].map(|axis| plan.step(level, axis));
    let corner = Corner { pitch, size: plan.low_size(level) };
    let orders = steps.map(|step| step.order());
    lines::transform(
        data,
        corner,
        orders,
        direction,
        width,
        #[inline(always)]
        |axis, lines| steps[axis].analyse(lines),
        #[inline(always)]
        |axis, lines| steps[axis].synthesise(lines),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::Family;

    #[test]
    fn every_width_of_vectors_gives_the_same_bits() {
        let size = [45, 37, 9];
        let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
        for (name, family) in Family::NAMES {
            let plan = Plan::new(family, size, None);
            let run = |width| {
                let mut coefficients = samples.clone();
                analyse_at(width, &plan, &mut coefficients);
                let mut back = coefficients.clone();
                synthesise_at(width, &plan, &mut back);
                coefficients.into_iter().chain(back).map(f32::to_bits).collect::<Vec<_>>()
            };
            let [first, others @ ..] = &simd::Level::all()[..] else { unreachable!() };
            let plain = run(*first);
            assert!(others.iter().all(|width| run(*width) == plain), "{name}");
        }
    }
}
