//! Sheets per slice and oversampling that reach a wanted PSNR, by an estimate of the picture's error.
//!
//! Two errors add up, and neither knows much of the other: that of the sheets, along the rays, and that of the base
//! plane and the warp, across them. Both are measured on a few small parts of the picture, spread over what it shows,
//! drawn with growing effort. Errors in between follow a power law. Of all settings that promise the PSNR the cheapest
//! is taken: the number of texels is `sheets_per_slice · oversampling²`.
//!
//! PSNR is that of the colours over black against the converged picture with many rays a pixel, peak 1.

use wavesplat_core::{Camera, Error, Picture, RenderOptions, Result, TransferFunction};

use crate::labels::Labels;
use crate::render::{Monitor, render_labelled, render_part};
use crate::slices::Slices;

/// Settings and what they should reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Sheets per slice distance.
    pub sheets_per_slice: f64,
    /// Texels per pixel along each axis.
    pub oversampling: f64,
    /// Expected PSNR, dB: less than what was asked for where the finest settings do not reach it.
    pub psnr_db: f64,
}

/// Settings that are chosen from.
const SHEETS: [f64; 9] = [0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];
const OVERSAMPLINGS: [f64; 7] = [0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0];

/// Settings that are measured; the last stands for the converged picture.
const PROBED_SHEETS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
const PROBED_OVERSAMPLINGS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// Sheets per slice while oversampling is measured: as few as leave the picture what it is.
const SHEETS_FOR_OVERSAMPLING: f64 = 2.0;

/// Parts of the picture that are drawn, and their sides in pixels.
const N_PARTS: usize = 5;
const PART_PX: usize = 32;

/// Sides of the overview that shows where there is something.
const OVERVIEW_PX: usize = 64;

/// Chooses settings for a picture. The options' own settings are not used. PSNR between 20 and 80 dB.
pub fn settings_for_psnr(
    slices: &Slices,
    labels: Option<&Labels>,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    psnr_db: f64,
    monitor: &dyn Monitor,
) -> Result<Estimate> {
    if !(20.0..=80.0).contains(&psnr_db) {
        let mend = "pass 40 for a good picture, 50 for one that cannot be told from the converged one";
        return Err(Error::out_of_range("psnr", psnr_db, "between 20 and 80 dB", mend));
    }
    let full = [options.width_px, options.height_px];
    let with = |size: [usize; 2], sheets_per_slice: f64, oversampling: f64| RenderOptions {
        width_px: size[0],
        height_px: size[1],
        sheets_per_slice,
        oversampling,
        background: None,
        with_depth: false,
        ..options.clone()
    };
    let overview = with(full.map(|n| n.min(OVERVIEW_PX)), 0.5, 1.0);
    let (overview, _) = render_labelled(slices, labels, tf, camera, &overview, monitor)?;
    let (parts, n_covered) = parts(&overview, full);
    let measure = |efforts: &[f64], settings: &dyn Fn(f64) -> [f64; 2]| {
        let mut square = vec![0.0; efforts.len() - 1];
        for part in &parts {
            let draw = |effort: &f64| {
                let [sheets, oversampling] = settings(*effort);
                let options = with(full, sheets, oversampling);
                render_part(slices, labels, tf, camera, &options, *part, monitor).map(|(picture, _)| picture)
            };
            let pictures: Vec<Picture> = efforts.iter().map(draw).collect::<Result<_>>()?;
            for (square, picture) in square.iter_mut().zip(&pictures) {
                *square += sum_of_squares(picture, &pictures[efforts.len() - 1]);
            }
        }
        // Each part stands for as much of what is covered.
        let n_numbers = parts.iter().map(|[_, size]| 3 * size[0] * size[1]).sum::<usize>().max(1) as f64;
        let covered = n_covered as f64 / overview.rgba.len() as f64;
        Ok(Decay::new(efforts, square.into_iter().map(|square| square / n_numbers * covered)))
    };
    let along = measure(&PROBED_SHEETS, &|sheets| [sheets, 1.0])?;
    let across = measure(&PROBED_OVERSAMPLINGS, &|oversampling| [SHEETS_FOR_OVERSAMPLING, oversampling])?;
    let mut best: Option<Estimate> = None;
    for sheets_per_slice in SHEETS {
        for oversampling in OVERSAMPLINGS {
            let error = along.at(sheets_per_slice) + across.at(oversampling);
            let new = Estimate { sheets_per_slice, oversampling, psnr_db: -10.0 * error.max(1e-12).log10() };
            let is_better = |old: &Estimate| {
                let cost = |e: &Estimate| e.sheets_per_slice * e.oversampling * e.oversampling;
                let reached = [old, &new].map(|e| e.psnr_db >= psnr_db);
                match reached {
                    [true, true] => cost(&new) < cost(old),
                    [false, false] => new.psnr_db > old.psnr_db,
                    [_, new_does] => new_does,
                }
            };
            if best.as_ref().is_none_or(is_better) {
                best = Some(new);
            }
        }
    }
    best.ok_or(Error::Cancelled)
}

/// Parts of a picture of a size, centred where an overview of it shows something, evenly in reading order; and how
/// many pixels of the overview do.
fn parts(overview: &Picture, full: [usize; 2]) -> (Vec<[[usize; 2]; 2]>, usize) {
    let covered: Vec<usize> = (0..overview.rgba.len()).filter(|i| overview.rgba[*i][3] > 1e-3).collect();
    let small = [overview.width_px, overview.height_px];
    let size = full.map(|n| n.min(PART_PX));
    let part = |k: usize| {
        let i = covered[(2 * k + 1) * covered.len() / (2 * N_PARTS)];
        let at = [i % small[0], i / small[0]];
        let first = |a: usize| ((2 * at[a] + 1) * full[a] / (2 * small[a])).saturating_sub(size[a] / 2);
        [std::array::from_fn(|a| first(a).min(full[a] - size[a])), size]
    };
    let n_parts = if covered.is_empty() { 0 } else { N_PARTS };
    ((0..n_parts).map(part).collect(), covered.len())
}

/// Mean square error over effort.
struct Decay {
    /// Logarithms of effort and error.
    points: Vec<[f64; 2]>,
}

impl Decay {
    /// `errors`: of all efforts but the last, against the last.
    fn new(efforts: &[f64], errors: impl Iterator<Item = f64>) -> Self {
        let last = efforts[efforts.len() - 1];
        let point = |(effort, error): (&f64, f64)| {
            // The last has an error too; both fall with the square of the effort.
            let share_seen = 1.0 - (effort / last).powi(2);
            [effort.ln(), (error / share_seen.powi(2)).max(1e-12).ln()]
        };
        Self { points: efforts.iter().zip(errors).map(point).collect() }
    }

    /// The error at an effort, on the line through the nearest two points.
    fn at(&self, effort: f64) -> f64 {
        let x = effort.ln();
        let after = self.points.iter().position(|p| p[0] >= x).unwrap_or(self.points.len() - 1).max(1);
        let ([x0, y0], [x1, y1]) = (self.points[after - 1], self.points[after]);
        // Errors do not grow with the effort.
        let slope = ((y1 - y0) / (x1 - x0)).min(0.0);
        (y1 + slope * (x - x1)).exp()
    }
}

/// Square differences of the colours over black.
fn sum_of_squares(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..3).map(|c| f64::from(a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum::<f64>()
    };
    a.rgba.iter().zip(&b.rgba).map(square).sum()
}
