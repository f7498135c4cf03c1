//! Separable wavelet transform in place: samples `[z][y][x]` <-> coefficients in the layout of [`TransformPlan`].

use wavesplat_compute::simd;

use super::lines::{self, LowBox, TransformDirection};
use super::plan::TransformPlan;
use super::real::Real;

/// Samples -> coefficients, all levels of the plan.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn analyse<T: Real>(plan: &TransformPlan, data: &mut [T]) {
    analyse_at(simd::Level::best(), plan, data);
}

/// Coefficients -> samples, all levels of the plan.
///
/// # Panics
/// Where the data have another size than the plan.
pub fn synthesise<T: Real>(plan: &TransformPlan, data: &mut [T]) {
    synthesise_at(simd::Level::best(), plan, data);
}

/// One level of [`analyse`]: splits the low-pass box of `level`, in place, into the next level's and its details.
///
/// # Panics
/// Where the data have another size than the plan, or the plan has no such level.
pub fn analyse_level<T: Real>(plan: &TransformPlan, level: usize, data: &mut [T]) {
    plan.check_len(data.len());
    run_level(simd::Level::best(), plan, level, data, pitch(plan.size()), TransformDirection::Analysis);
}

/// One level of [`synthesise`]: undoes [`analyse_level`], to rounding.
///
/// # Panics
/// Where the data have another size than the plan, or the plan has no such level.
pub fn synthesise_level<T: Real>(plan: &TransformPlan, level: usize, data: &mut [T]) {
    plan.check_len(data.len());
    run_level(simd::Level::best(), plan, level, data, pitch(plan.size()), TransformDirection::Synthesis);
}

/// Volume at a coarser level: the low-pass box of `level`, at its own size, from the coefficients of all coarser
/// levels. Low-pass coefficients of a constant are that constant, so the result has the data's own units.
///
/// # Panics
/// Where the coefficients have another size than the plan, or the plan has no such level.
pub fn synthesise_to<T: Real>(plan: &TransformPlan, coefficients: &[T], level: usize) -> Vec<T> {
    plan.check_len(coefficients.len());
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
        run_level(width, plan, level, &mut low, [nx, ny], TransformDirection::Synthesis);
    }
    low
}

fn analyse_at<T: Real>(width: simd::Level, plan: &TransformPlan, data: &mut [T]) {
    plan.check_len(data.len());
    for level in 0..plan.n_levels() {
        run_level(width, plan, level, data, pitch(plan.size()), TransformDirection::Analysis);
    }
}

fn synthesise_at<T: Real>(width: simd::Level, plan: &TransformPlan, data: &mut [T]) {
    plan.check_len(data.len());
    for level in (0..plan.n_levels()).rev() {
        run_level(width, plan, level, data, pitch(plan.size()), TransformDirection::Synthesis);
    }
}

fn pitch([nx, ny, _]: [usize; 3]) -> [usize; 2] {
    [nx, ny]
}

fn run_level<T: Real>(
    width: simd::Level,
    plan: &TransformPlan,
    level: usize,
    data: &mut [T],
    pitch: [usize; 2],
    direction: TransformDirection,
) {
    let steps = [0, 1, 2].map(|axis| plan.step(level, axis));
    let corner = LowBox { pitch, size: plan.low_size(level) };
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
    use crate::family::WaveletFamily;

    #[test]
    fn every_width_of_vectors_gives_the_same_bits() {
        let size = [45, 37, 9];
        let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
        for (name, family) in WaveletFamily::NAMES {
            let plan = TransformPlan::new(family, size, None).unwrap();
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
