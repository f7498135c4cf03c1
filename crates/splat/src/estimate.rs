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
use crate::render::{Monitor, Part, render_labelled, render_parts};
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
const SHEETS: [f64; 8] = [0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];
const OVERSAMPLINGS: [f64; 7] = [0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0];

/// Settings that are measured, each against the last of them: as many as it takes, two at least.
/// Oversampling is measured with as few sheets as leave the picture what it is, and are drawn anyway: the second.
const PROBED_SHEETS: [f64; 4] = [0.7, 1.5, 3.0, 6.0];
const PROBED_OVERSAMPLINGS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
const FEWEST_PROBES: usize = 2;

/// How the mean square error falls with the effort as long as a single one was measured: 6 dB per doubling.
const USUAL_SLOPE: f64 = -2.0;

/// What is chosen is at most this share of the last that was measured, while there is more to measure: nearer to it,
/// errors are told by what was measured far from it.
const TRUSTED: f64 = 0.5;

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
    // Each part stands for as much of what is covered.
    let n_numbers = parts.iter().map(|part| 3 * part.size_px[0] * part.size_px[1]).sum::<usize>().max(1) as f64;
    let scale = n_covered as f64 / overview.rgba.len() as f64 / n_numbers;
    let draw = |sheets: f64, oversampling: f64| -> Result<Vec<Picture>> {
        let options = with(full, sheets, oversampling);
        Ok(render_parts(slices, labels, tf, camera, &options, &parts, monitor)?.0)
    };
    let mut along = Probes::new(&PROBED_SHEETS, scale);
    let mut across = Probes::new(&PROBED_OVERSAMPLINGS, scale);
    loop {
        along.draw(|sheets| draw(sheets, 1.0))?;
        across.draw(|oversampling| match oversampling {
            // These parts are there already.
            1.0 => Ok(along.pictures[1].clone()),
            _ => draw(PROBED_SHEETS[1], oversampling),
        })?;
        let chosen = cheapest(&along.decay(), &across.decay(), psnr_db);
        let is_too_far = [along.wants_more(chosen.sheets_per_slice), across.wants_more(chosen.oversampling)];
        if is_too_far == [false; 2] {
            return Ok(chosen);
        }
    }
}

/// The cheapest settings that promise a PSNR, by how errors decay along rays and across them; those that promise most,
/// if none does.
fn cheapest(along: &Decay, across: &Decay, psnr_db: f64) -> Estimate {
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
    best.expect("there are settings")
}

/// Parts of the picture at growing effort along one axis of the settings.
struct Probes<'a> {
    efforts: &'a [f64],
    /// How many of them are wanted.
    n: usize,
    /// Pictures of the parts at each effort so far.
    pictures: Vec<Vec<Picture>>,
    /// Mean square error per sum of squares.
    scale: f64,
}

impl<'a> Probes<'a> {
    fn new(efforts: &'a [f64], scale: f64) -> Self {
        Self { efforts, n: FEWEST_PROBES, pictures: Vec::new(), scale }
    }

    /// Draws what is wanted and not there yet.
    fn draw(&mut self, draw: impl Fn(f64) -> Result<Vec<Picture>>) -> Result<()> {
        while self.pictures.len() < self.n {
            self.pictures.push(draw(self.efforts[self.pictures.len()])?);
        }
        Ok(())
    }

    /// Whether a choice goes too far beyond what has been measured; then one more is wanted.
    fn wants_more(&mut self, chosen: f64) -> bool {
        let wants_more = self.n < self.efforts.len() && chosen > TRUSTED * self.efforts[self.n - 1];
        self.n += usize::from(wants_more);
        wants_more
    }

    fn decay(&self) -> Decay {
        let (last, others) = self.pictures.split_last().expect("there are two at least");
        let error = |pictures: &Vec<Picture>| {
            let of_parts = pictures.iter().zip(last).map(|(picture, last)| sum_of_squares(picture, last));
            self.scale * likely_most(&of_parts.collect::<Vec<_>>())
        };
        Decay::new(&self.efforts[..self.n], others.iter().map(error))
    }
}

/// Parts of a picture of a size, centred where an overview of it shows something, evenly in reading order; and how
/// many pixels of the overview do.
fn parts(overview: &Picture, full: [usize; 2]) -> (Vec<Part>, usize) {
    let covered: Vec<usize> = (0..overview.rgba.len()).filter(|i| overview.rgba[*i][3] > 1e-3).collect();
    let small = [overview.width_px, overview.height_px];
    let size = full.map(|n| n.min(PART_PX));
    let part = |k: usize| {
        let i = covered[(2 * k + 1) * covered.len() / (2 * N_PARTS)];
        let at = [i % small[0], i / small[0]];
        let first = |a: usize| ((2 * at[a] + 1) * full[a] / (2 * small[a])).saturating_sub(size[a] / 2);
        Part { first_px: [0, 1].map(|a| first(a).min(full[a] - size[a])), size_px: size }
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
    /// `errors`: of all efforts but the last, against the last, which has next to none.
    fn new(efforts: &[f64], errors: impl Iterator<Item = f64>) -> Self {
        Self { points: efforts.iter().zip(errors).map(|(x, y)| [x.ln(), y.max(1e-12).ln()]).collect() }
    }

    /// The error at an effort, on the line through the nearest two points.
    fn at(&self, effort: f64) -> f64 {
        let x = effort.ln();
        let after = self.points.iter().position(|p| p[0] >= x).unwrap_or(self.points.len() - 1).max(1);
        let [x1, y1] = self.points[after.min(self.points.len() - 1)];
        let slope = match self.points.get(after) {
            // Errors do not grow with the effort.
            Some(_) => ((y1 - self.points[after - 1][1]) / (x1 - self.points[after - 1][0])).min(0.0),
            None => USUAL_SLOPE,
        };
        (y1 + slope * (x - x1)).exp()
    }
}

/// The sum of numbers drawn from many, and its standard error: few parts may happen to be good ones.
fn likely_most(numbers: &[f64]) -> f64 {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if numbers.len() < 2 { numbers.iter().sum() } else { n * mean + (n * variance).sqrt() }
}

/// Square differences of the colours over black.
fn sum_of_squares(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..3).map(|c| f64::from(a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum::<f64>()
    };
    a.rgba.iter().zip(&b.rgba).map(square).sum()
}
