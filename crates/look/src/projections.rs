//! Greys of projections: a grey ramp over the values that a volume projects to, along its three index axes or in a view.

use crate::histogram::robust_range;
use crate::numbers::{linspace, power};
use crate::scans::CurveNodes;
use crate::statistics::{extremes, median, percentile, percentiles, sum, those};

/// Share of a window below which values count as empty.
const CLEAR: f64 = 0.05;
/// Least width of a window, as a share of the volume's range, so that noise in uniform matter stays dark.
const MIN_WINDOW: f64 = 0.05;
/// Grey of the median of a radiograph, and the number of its nodes, which are even in the logarithm of the light.
const MIDDLE_GREY: f64 = 0.45;
const N_RADIOGRAPH: usize = 65;
/// Largest grey of the median of a mean's or a sum's pixels.
const BRIGHTEST_MEDIAN: f64 = 0.6;
/// Percentile of the samples beyond which some may be hot pixels of a camera, and how many times as far above the
/// background as all their neighbours these are.
const BRIGHT_PERCENT: f64 = 99.8;
const HOT: f64 = 3.0;
/// Value of air, which absorbs nothing, in Hounsfield units, and absorption per millimetre and unit above it, a
/// thousandth of that of water for photons of 60 keV, about the mean of a radiograph at 120 kV: 0.2059 per cm (Hubbell
/// and Seltzer, NIST).
pub const HOUNSFIELD_ATTENUATION: (f64, f64) = (-1000.0, 2.059e-5);
/// Optical depth that the most absorbing rays get where the units of absorption are not known: a 150th comes through.
const UNKNOWN_DEPTH: f64 = 5.0;

/// Operator along a ray, without its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each variant is named after its operator")]
pub enum RayOperator {
    Over,
    FirstHit,
    Maximum,
    DepthShadedMaximum,
    DepthColoredMaximum,
    AttenuatedMaximum,
    LocalMaximum,
    Minimum,
    Mean,
    Sum,
    XRay,
}

impl RayOperator {
    /// All operators with their public names.
    pub const NAMES: [(&'static str, Self); 11] = [
        ("over", Self::Over),
        ("first-hit", Self::FirstHit),
        ("maximum", Self::Maximum),
        ("depth-shaded-maximum", Self::DepthShadedMaximum),
        ("depth-colored-maximum", Self::DepthColoredMaximum),
        ("attenuated-maximum", Self::AttenuatedMaximum),
        ("local-maximum", Self::LocalMaximum),
        ("minimum", Self::Minimum),
        ("mean", Self::Mean),
        ("sum", Self::Sum),
        ("x-ray", Self::XRay),
    ];

    /// The operator of a public name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|&(_, operator)| operator)
    }

    /// Its public name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, operator)| *operator == self).map_or("", |(name, _)| name)
    }

    /// Whether the result is one number per pixel, coloured at the end.
    pub fn is_projection(self) -> bool {
        !matches!(self, Self::Over | Self::FirstHit)
    }

    /// Whether the greys depend on where the volume is seen from.
    pub fn is_by_view(self) -> bool {
        matches!(self, Self::Minimum | Self::Mean | Self::Sum | Self::XRay)
    }

    /// Whether the result is a maximum, which does not depend much on where the volume is seen from.
    pub fn is_maximum(self) -> bool {
        self.is_projection() && !self.is_by_view()
    }

    /// Whether black is the value that most of an object exceeds, so that its front stands out.
    fn hides_half(self) -> bool {
        matches!(self, Self::DepthShadedMaximum | Self::LocalMaximum)
    }
}

/// Samples spread over a volume, x fastest.
#[derive(Clone, Copy, Debug)]
pub struct SpreadSamples<'a> {
    /// Their values.
    pub samples: &'a [f64],
    /// Their numbers along z, y and x.
    pub shape: [usize; 3],
    /// Numbers of the volume's own samples along z, y and x.
    pub size: [usize; 3],
    /// Distances between the volume's samples along x, y and z.
    pub spacing: [f64; 3],
}

impl SpreadSamples<'_> {
    /// Samples that are numbers.
    pub fn finite(&self) -> Vec<f64> {
        those(self.samples, f64::is_finite)
    }

    /// Pixels of the projections along each of the three index axes, all together.
    ///
    /// For an x-ray, the integral of the values above `clear`.
    pub fn pixels(&self, operator: RayOperator, clear: f64) -> Vec<f64> {
        let mut samples = self.samples.to_vec();
        // Of a larger volume some samples were left out, and neighbours are not known.
        if operator.is_maximum() && self.shape == self.size {
            dim_hot_samples(&mut samples, self.shape);
        }
        for value in &mut samples {
            *value = match *value {
                own if !own.is_finite() => f64::NAN,
                own if operator == RayOperator::XRay => (own - clear).max(0.0),
                own => own,
            };
        }
        let mut pixels = Vec::new();
        for axis in 0..3 {
            let is_length = matches!(operator, RayOperator::Sum | RayOperator::XRay);
            let length = self.spacing[2 - axis] * (self.size[axis] - 1) as f64;
            let found = reduced(&samples, self.shape, axis, operator);
            pixels.extend(found.into_iter().map(|pixel| if is_length { pixel * length } else { pixel }));
        }
        pixels
    }

    /// The value that absorbs no x-rays, and absorption per world unit and sample unit above it.
    ///
    /// Both are fixed for values that look like Hounsfield units; for others they follow from the range of values.
    pub fn attenuation(&self, is_hounsfield: bool) -> (f64, f64) {
        if is_hounsfield {
            return HOUNSFIELD_ATTENUATION;
        }
        let (clear, _) = robust_range(&self.finite());
        let most = percentile(&self.pixels(RayOperator::XRay, clear), 99.5);
        (clear, if most > 0.0 { UNKNOWN_DEPTH / most } else { 1.0 })
    }
}

/// The rays along an axis (0 is z) that have a finite sample, reduced: to the largest, the smallest, or the mean value.
fn reduced(samples: &[f64], shape: [usize; 3], axis: usize, operator: RayOperator) -> Vec<f64> {
    let stride = shape[axis + 1..].iter().product::<usize>();
    let n = shape[axis];
    let starts = (0..samples.len()).filter(|at| at / stride % n == 0);
    let mut line = Vec::with_capacity(n);
    let mut found = Vec::new();
    for start in starts {
        line.clear();
        line.extend((0..n).map(|k| samples[start + k * stride]));
        let n_finite = line.iter().filter(|value| !value.is_nan()).count();
        if n_finite == 0 {
            continue;
        }
        let finite = line.iter().copied().filter(|value| !value.is_nan());
        found.push(if operator.is_maximum() {
            finite.fold(f64::NEG_INFINITY, f64::max)
        } else if operator == RayOperator::Minimum {
            finite.fold(f64::INFINITY, f64::min)
        } else {
            for value in line.iter_mut().filter(|value| value.is_nan()) {
                *value = 0.0;
            }
            // Lines of neighbours in memory are summed in pairs of halves, others one after the other.
            let whole = if stride == 1 { sum(&line) } else { line.iter().fold(0.0, |whole, value| whole + value) };
            whole / n_finite as f64
        });
    }
    found
}

/// Gives lone samples that are far brighter than all neighbours, hot pixels of a camera, the largest of these.
fn dim_hot_samples(samples: &mut [f64], shape: [usize; 3]) {
    let finite = those(samples, f64::is_finite);
    if finite.is_empty() {
        return;
    }
    let [background, bright] = percentiles(&finite, [50.0, BRIGHT_PERCENT]);
    let [_, n_y, n_x] = shape;
    let strides = [n_y * n_x, n_x, 1];
    let mut dimmed = Vec::new();
    for (at, &own) in samples.iter().enumerate().filter(|(_, own)| **own > bright) {
        let mut around = f64::NEG_INFINITY;
        for (stride, n) in strides.into_iter().zip(shape) {
            let place = at / stride % n;
            if place > 0 {
                around = around.max(samples[at - stride]);
            }
            if place + 1 < n {
                around = around.max(samples[at + stride]);
            }
        }
        if own - background > HOT * (around - background) {
            dimmed.push((at, around));
        }
    }
    for (at, around) in dimmed {
        samples[at] = around;
    }
}

impl CurveNodes {
    /// Greys for the pixels of the projections along the three index axes.
    pub fn of_projection(spread: &SpreadSamples<'_>, operator: RayOperator, is_hounsfield: bool) -> Self {
        if operator != RayOperator::XRay {
            return Self::of_pixels(&spread.pixels(operator, 0.0), operator, robust_range(&spread.finite()));
        }
        let (clear, per_unit) = spread.attenuation(is_hounsfield);
        let mut pixels = spread.pixels(operator, clear);
        for pixel in &mut pixels {
            *pixel = (-per_unit * *pixel).exp();
        }
        Self::of_pixels(&pixels, operator, (0.0, 0.0))
    }

    /// Greys for a projection's pixels. `range`: the values that count as the volume's smallest and largest.
    pub fn of_pixels(pixels: &[f64], operator: RayOperator, range: (f64, f64)) -> Self {
        if operator == RayOperator::XRay {
            let least = f64::from(f32::MIN_POSITIVE);
            return Self::of_radiograph(&pixels.iter().map(|light| -light.max(least).ln()).collect::<Vec<_>>());
        }
        if operator.is_maximum() {
            return Self::of_maxima(pixels, operator.hides_half());
        }
        Self::of_means(pixels, MIN_WINDOW * (range.1 - range.0))
    }

    /// Greys of a maximum whose white is at most the value `white`.
    #[must_use]
    pub(crate) fn not_beyond(self, white: f64) -> Self {
        let (low, black, own) = (self.opacity[0].value, self.color[0].value, self.white());
        if own <= white || white <= low { self } else { Self::ramp(low, black.min(low + 0.9 * (white - low)), white) }
    }

    /// Greys of a maximum whose black is at least the value `black`, if that is well below white.
    #[must_use]
    pub(crate) fn not_before(self, black: f64) -> Self {
        let (own, white) = (self.color[0].value, self.white());
        if own >= black || white - black < 0.1 * (white - own) { self } else { Self::ramp(black, black, white) }
    }

    /// The value of the last colour.
    pub(crate) fn white(&self) -> f64 {
        self.color[self.color.len() - 1].value
    }

    /// Greys over at least the extent `least`; the darkest is transparent, so that the volume's box does not show.
    ///
    /// Black is higher where the object would be nearly white: a body's mean is, and its rim would take half of the
    /// greys.
    fn of_means(pixels: &[f64], least: f64) -> Self {
        let [low, high] = percentiles(pixels, [1.0, 99.8]);
        let high = high.max(low + if least == 0.0 { 1.0 } else { least });
        let inside = those(pixels, |value| value > low + CLEAR * (high - low));
        let middle = if inside.is_empty() { low } else { median(&inside) };
        let black = (middle - BRIGHTEST_MEDIAN * high) / (1.0 - BRIGHTEST_MEDIAN);
        Self::ramp(low, black.max(low).min(low + 0.9 * (high - low)), high)
    }

    /// Greys of a maximum: white is near the value that a fiftieth of the pixels exceeds.
    ///
    /// So metal or a bladder full of tracer dims nothing else. Where that fiftieth is all there is, such as a single
    /// vessel, a third of its range is left for what is around it. `hides_half`: black is not the background but what a
    /// quarter of the object does not exceed; else white is a quarter higher, so that vessels stand out from a brain.
    fn of_maxima(pixels: &[f64], hides_half: bool) -> Self {
        let [low, white, high] = percentiles(pixels, [1.0, 98.0, 99.8]);
        let reach = if hides_half { 1.0 } else { 1.25 };
        let high = (low + reach * (white - low)).min(high).max(low + 0.3 * (high - low));
        let high = if low < high { high } else { low + 1.0 };
        let inside = those(pixels, |value| value > low + CLEAR * (high - low));
        let black = if hides_half && !inside.is_empty() { percentile(&inside, 25.0) } else { low };
        Self::ramp(low, black.min(low + 0.9 * (high - low)), high)
    }

    /// Greys from black to white, clear at `low`.
    fn ramp(low: f64, black: f64, white: f64) -> Self {
        let clear = low + CLEAR * (white - low);
        Self::new([(low, 0.0), (clear, 1.0)], [(black, [0.0; 3]), (white, [1.0; 3])])
    }

    /// Greys by the optical depth, as a digital radiograph shows it: bone is bright.
    ///
    /// Its median over the object becomes a middle grey, whatever the exponent that it takes, so that a thick object
    /// keeps its contrast. What absorbs next to nothing is transparent.
    fn of_radiograph(depths: &[f64]) -> Self {
        let white = percentile(depths, 99.8).max(1e-3);
        let inside = those(depths, |depth| depth > CLEAR * white);
        let middle = if inside.is_empty() { 0.5 } else { median(&inside) / white };
        let exponent = (MIDDLE_GREY.ln() / middle.min(0.99).ln()).clamp(0.7, 2.5);
        let steps = linspace(1.0, 0.0, N_RADIOGRAPH);
        let color = steps.iter().map(|&step| ((-white * step).exp(), [power(step, exponent); 3]));
        Self::new([((-CLEAR * white).exp(), 1.0), (1.0, 0.0)], color)
    }

    /// The largest uptake along each ray, black on white. `threshold`: between background and object.
    pub(crate) fn of_uptake(pixels: &[f64], threshold: f64) -> Self {
        let greys = Self::of_maxima(pixels, false);
        let (mut first, last) = (greys.color[0].value, greys.white());
        // The noise of air, whose largest value along a ray is no 0, showed the box of the scan as a grey one on white.
        let air = those(pixels, |pixel| pixel < threshold);
        if !air.is_empty() {
            first = first.max(percentile(&air, AIR_PERCENT).min(first + MAX_AIR * (last - first)));
        }
        // Faint uptake must show: half of the greys for the lower third.
        let color = [(first, [1.0; 3]), (first + 0.3 * (last - first), [0.48; 3]), (last, [0.0; 3])];
        Self::new([(first, 1.0)], color)
    }

    /// A maximum projection for a few bright samples over noise, in which the noise is nearly black.
    ///
    /// `far`: deviations of the noise above its median that are far.
    pub(crate) fn of_few_bright(pixels: &[f64], far: f64) -> Self {
        let noise = median(pixels);
        let distances: Vec<f64> = pixels.iter().map(|pixel| (pixel - noise).abs()).collect();
        let deviation = 1.4826 * median(&distances);
        let bright = those(pixels, |pixel| pixel > noise + far * deviation);
        let white = if bright.is_empty() { extremes(pixels).1 } else { percentile(&bright, 98.0) };
        let black = (noise + 2.0 * deviation).min(0.5 * (noise + white));
        Self::new([(black, 1.0)], [(black, [0.0; 3]), (white, [1.0; 3])])
    }
}

/// Percentile of the pixels of air in a PET that is still white, and the largest share of the greys that white has.
const AIR_PERCENT: f64 = 99.5;
const MAX_AIR: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(samples: &[f64], shape: [usize; 3]) -> SpreadSamples<'_> {
        SpreadSamples { samples, shape, size: shape, spacing: [1.0, 2.0, 3.0] }
    }

    #[test]
    fn rays_without_a_number_are_left_out_and_sums_have_a_length() {
        let samples = [1.0, f64::NAN, 3.0, f64::INFINITY, 5.0, 7.0, 9.0, 11.0];
        let of = |operator| spread(&samples, [2, 2, 2]).pixels(operator, 0.0);
        assert_eq!(of(RayOperator::Minimum), [1.0, 7.0, 3.0, 11.0, 1.0, 5.0, 7.0, 1.0, 3.0, 5.0, 9.0]);
        let means = [3.0, 7.0, 6.0, 11.0, 2.0, 7.0, 9.0, 1.0, 3.0, 6.0, 10.0];
        assert_eq!(of(RayOperator::Mean), means);
        let sums = of(RayOperator::Sum);
        assert_eq!([sums[0], sums[5], sums[10]], [9.0, 14.0, 10.0]);
    }

    #[test]
    fn a_hot_pixel_dims_nothing_else() {
        let mut samples: Vec<f64> = (0..1000).map(|k| f64::from(k % 7)).collect();
        samples[555] = 5000.0;
        let greys = CurveNodes::of_projection(&spread(&samples, [10; 3]), RayOperator::Maximum, false);
        assert!(greys.white() <= 7.0, "{greys:?}");
        let kept = SpreadSamples { size: [20; 3], ..spread(&samples, [10; 3]) };
        assert!(kept.pixels(RayOperator::Maximum, 0.0).contains(&5000.0));
    }

    #[test]
    fn the_median_of_a_radiograph_is_a_middle_grey() {
        let depths: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 250.0).collect();
        let found = CurveNodes::of_radiograph(&depths);
        let middle = (-median(&those(&depths, |depth| depth > 0.2))).exp();
        let at =
            found.color.iter().min_by(|a, b| (a.value - middle).abs().total_cmp(&(b.value - middle).abs())).unwrap();
        assert!((at.rgb[0] - MIDDLE_GREY).abs() < 0.02, "{at:?}");
    }

    #[test]
    fn ends_of_greys_move_inwards_alone() {
        let greys = CurveNodes::ramp(0.0, 0.0, 10.0);
        assert_eq!(greys.clone().not_beyond(20.0), greys);
        assert_eq!(greys.clone().not_beyond(5.0), CurveNodes::ramp(0.0, 0.0, 5.0));
        assert_eq!(greys.clone().not_before(9.5), greys);
        assert_eq!(greys.not_before(4.0), CurveNodes::ramp(4.0, 4.0, 10.0));
    }

    #[test]
    fn operators_have_names() {
        for (name, operator) in RayOperator::NAMES {
            assert_eq!((RayOperator::named(name), operator.name()), (Some(operator), name));
        }
        assert!(
            RayOperator::LocalMaximum.is_maximum() && RayOperator::XRay.is_by_view() && !RayOperator::Over.is_maximum()
        );
        assert_eq!(RayOperator::named("mip"), None);
    }
}
