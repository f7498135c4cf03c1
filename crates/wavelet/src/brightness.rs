//! How bright a coarser level looks beside the finest, and what makes it as bright.
//!
//! Rays along the axes, spread evenly over the volume, know the samples and the coarse values that they meet, and how
//! steeply the gradients of both stand to them. Drawn by a function each, in the light of a lamp at the eye,
//!
//! `B = Σ T α (c (ambient + diffuse |n·v|) + specular max(0, 2 (n·v)² − 1)^power)`,
//!
//! `T` the product of `1 − α` so far, `c` the mean of red, green and blue, the two sums tell how much the level changes
//! the brightness, whatever hides what. The factor of the coarse function's extinction that makes them equal is found
//! by the method of secants. The rays know no function and are made once per level.

use wavesplat_compute::parallel;
use wavesplat_core::{Decoder, Shading};

use crate::coarse::LevelGrid;

/// Rays lie in bundles of so many. Each bundle crosses the whole volume where that is decoded, or else a part so many
/// samples wide.
const N_IN_BUNDLE: usize = 16;
const SIDE: usize = 16;

/// Bundles along each axis, if all rays together meet no more samples than the second number.
const N_BUNDLES: usize = 128;
const N_MET: usize = 1 << 19;

/// Volumes of no more samples are decoded.
const N_DECODED: usize = 1 << 24;

/// Slices that one thread decodes.
const N_LAYERS: usize = 32;

/// Positions per sample: the first visible one on a ray tells how a surface stands.
const N_PER_SAMPLE: usize = 2;

/// Factors of the extinction: from one over this up to this.
const LARGEST: f64 = 8.0;

/// From this factor on a level may be darker all the same; it is bright enough with this share of the brightness.
const OUT_OF_REACH: f64 = 0.9 * LARGEST;
const BRIGHT_ENOUGH: f64 = 0.93;

/// How much brighter without light, or darker, a level may get to be as bright in it: slopes that are lost cannot be made
/// up for by more of what has none.
const MOST_FOR_LIGHT: f64 = 1.25;

/// How alike the logarithms of the brightnesses get, if it takes no more steps than the second number.
const TOLERANCE: f64 = 2e-3;
const N_STEPS: usize = 12;

/// Half distance of the differences that estimate the gradient, in samples of the level: what is usual.
const GRADIENT_OFFSET: f64 = 1.0;

/// Steps of `|n·v|`; one more number stands for where there is no gradient.
const N_COSINES: usize = 31;

/// Rays that are followed by one thread.
const N_TOGETHER: usize = 64;

/// What of the light is left when the rest of a ray does not count.
const DARK: f32 = 1e-4;

/// Mean of the colour, and opacity, in each bin of values.
pub type Look = Vec<[f64; 2]>;

/// A ray along an axis.
struct Ray {
    axis: usize,
    /// What it meets in order, of the finest samples and of the coarse values.
    met: [Vec<Met>; 2],
}

/// Bin of a value, times `N_COSINES + 1`, and step of `|n·v|`.
type Met = u16;

/// Rays through a volume and a level of it.
pub struct Rays(Vec<Ray>);

impl Rays {
    /// Through a volume and a level of it that lies on `grid`. `spacing`: of the finest samples along each axis, in any
    /// unit. `bin`: of a value, one of at most 2048. Takes as much work space as `budget_bytes`, but
    /// no more than 64 MB for the samples.
    pub fn new(
        [fine, coarse]: [&dyn Decoder; 2],
        grid: &LevelGrid,
        spacing: [f64; 3],
        budget_bytes: usize,
        bin: impl Fn(f32) -> usize + Sync,
    ) -> Self {
        let size = fine.size();
        let coarse_spacing = [0, 1, 2].map(|a| spacing[a] * grid.spacing[a]);
        let step = 1.0 / N_PER_SAMPLE as f64;
        let n_samples = size.iter().product::<usize>();
        let fits = n_samples <= N_DECODED && 2 * n_samples * size_of::<f32>() <= budget_bytes;
        let whole = fits.then(|| [fine, coarse].map(|decoder| Samples::new(decoder, [0; 3], decoder.size())));
        let n_per_axis = N_BUNDLES.min(N_MET / (N_IN_BUNDLE * size.iter().sum::<usize>())).max(1);
        let bundles = parallel::map(3 * n_per_axis, |i| {
            let (axis, bundle) = (i % 3, i / 3);
            let last = size.map(|n| (n - 1) as f64);
            // The volume is cut into bundles of equal width, so that its middle counts no more than its faces.
            let n_across = last.map(|last| if fits { 1.0 } else { (last / SIDE as f64).ceil().max(1.0) });
            let width = [0, 1, 2].map(|a| last[a] / n_across[a]);
            let first = evenly_spread(axis, bundle, n_across);
            let first = [0, 1, 2].map(|a| if a == axis { 0.0 } else { first[a].floor() * width[a] });
            let end = [0, 1, 2].map(|a| if a == axis { last[a] } else { first[a] + width[a] });
            let mut decoded = None;
            let [fine, coarse] = whole.as_ref().unwrap_or_else(|| {
                let [low_first, low_end] = [first, end].map(|at| grid.level_from_finest(at));
                decoded.insert([
                    Samples::around(fine, axis, first, end),
                    Samples::around(coarse, axis, low_first, low_end),
                ])
            });
            let ray = |k: usize| {
                let within = evenly_spread(axis, bundle * N_IN_BUNDLE + k, width);
                let start = [0, 1, 2].map(|a| if a == axis { 0.0 } else { first[a] + within[a] });
                let n = (size[axis] - 1) * N_PER_SAMPLE + 1;
                let own = Line::new(fine, axis, start, spacing).along(n, step, &bin);
                let low = Line::new(coarse, axis, grid.level_from_finest(start), coarse_spacing);
                let low = low.along(n, step / grid.spacing[axis], &bin);
                let mut met = [own, low];
                // Seen from both ends.
                if k % 2 == 1 {
                    for met in &mut met {
                        met.reverse();
                    }
                }
                Ray { axis, met }
            };
            (0..N_IN_BUNDLE).map(ray).collect::<Vec<_>>()
        });
        Self(bundles.into_iter().flatten().collect())
    }

    /// By how much the extinction of the coarse look has to be multiplied, so that the level is as bright as the finest.
    /// `lengths`: from sample to sample along each axis, in units of the opacities. Without shading, colours are as they
    /// are.
    pub fn factor(&self, [fine, coarse]: [&Look; 2], shading: Option<&Shading>, lengths: [f64; 3]) -> f64 {
        let lengths = lengths.map(|length| length / N_PER_SAMPLE as f64);
        let (lit, unlit) = (light(shading), light(None));
        let factor = self.factor_for(self.brightness(0, fine, &lit, lengths), coarse, &lit, lengths);
        if shading.is_none() {
            return factor;
        }
        let [wanted, got] = [
            self.brightness(0, fine, &unlit, lengths),
            self.brightness(1, coarse, &unlit, lengths.map(|length| factor * length)),
        ];
        let bounded = got.clamp(wanted / MOST_FOR_LIGHT, wanted * MOST_FOR_LIGHT);
        if got == bounded { factor } else { self.factor_for(bounded, coarse, &unlit, lengths) }
    }

    /// Whether a factor that [`Rays::factor`] found makes the coarse look about as bright, without light.
    pub fn is_bright_enough(&self, [fine, coarse]: [&Look; 2], factor: f64, lengths: [f64; 3]) -> bool {
        if factor < OUT_OF_REACH {
            return true;
        }
        let lengths = lengths.map(|length| length / N_PER_SAMPLE as f64);
        let unlit = light(None);
        let wanted = self.brightness(0, fine, &unlit, lengths);
        self.brightness(1, coarse, &unlit, lengths.map(|length| factor * length)) >= BRIGHT_ENOUGH * wanted
    }

    /// The factor that makes the coarse look as bright as is wanted.
    fn factor_for(&self, wanted: f64, coarse: &Look, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        if wanted <= 0.0 {
            return 1.0;
        }
        // The logarithm of the factor: where it can lie, where it is looked at, and how much too bright that is.
        let [mut lo, mut hi] = [-LARGEST.ln(), LARGEST.ln()];
        let (mut at, mut before) = (0.0, None);
        for _ in 0..N_STEPS {
            let brightness = self.brightness(1, coarse, light, lengths.map(|length| f64::exp(at) * length));
            let excess = (brightness / wanted).ln();
            if excess.abs() < TOLERANCE {
                break;
            }
            if excess < 0.0 {
                lo = at;
            } else {
                hi = at;
            }
            // What is thin is as bright as it is dense.
            let slope = before.map_or(1.0, |(x, y): (f64, f64)| (excess - y) / (at - x));
            before = Some((at, excess));
            let next = at - excess / slope;
            at = if lo < next && next < hi { next } else { 0.5 * (lo + hi) };
        }
        at.exp()
    }

    /// Mean over the rays, of the finest samples (0) or the coarse values (1).
    fn brightness(&self, which: usize, look: &Look, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        // By what is met: light that comes from there, and share of the light behind that passes.
        let of_axis = lengths.map(|length| -> Vec<[f32; 2]> {
            let entries = look.iter().flat_map(|&[color, opacity]| {
                let alpha = -(length * (-opacity).ln_1p()).exp_m1();
                light
                    .iter()
                    .map(move |[matte, gloss]| [alpha * (color * matte + gloss), 1.0 - alpha].map(|entry| entry as f32))
            });
            entries.collect()
        });
        let of_ray = |ray: &Ray| {
            let entries = &of_axis[ray.axis];
            let (mut sum, mut clear) = (0.0_f32, 1.0_f32);
            for met in &ray.met[which] {
                let [emitted, passed] = entries[usize::from(*met)];
                sum += clear * emitted;
                clear *= passed;
                if clear < DARK {
                    break;
                }
            }
            f64::from(sum)
        };
        let parts = parallel::map(self.0.len().div_ceil(N_TOGETHER), |part| {
            let rays = self.0[part * N_TOGETHER..].iter().take(N_TOGETHER);
            rays.map(of_ray).sum::<f64>()
        });
        parts.into_iter().sum::<f64>() / self.0.len() as f64
    }
}

/// Light that comes back by step of `|n·v|`: factor of the colour, and highlight.
fn light(shading: Option<&Shading>) -> Vec<[f64; 2]> {
    let Some(shading) = shading else { return vec![[1.0, 0.0]; N_COSINES + 1] };
    let Shading { ambient, diffuse, specular, specular_power, .. } = *shading;
    let [ambient, diffuse, specular, power] = [ambient, diffuse, specular, specular_power].map(f64::from);
    let lit = |step: usize| {
        let cosine = (step as f64 + 0.5) / N_COSINES as f64;
        [ambient + diffuse * cosine, specular * (2.0 * cosine * cosine - 1.0).max(0.0).powf(power)]
    };
    (0..N_COSINES).map(lit).chain([[ambient, 0.0]]).collect()
}

/// A point of a box for every number, at 0 along an axis: without a pattern across it, and evenly spread, by the sequence
/// R2 (M. Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn evenly_spread(axis: usize, k: usize, size: [f64; 3]) -> [f64; 3] {
    let mut at = [0.0; 3];
    for (a, step) in [(1, 0.754_877_666_246_693), (2, 0.569_840_290_998_053)] {
        let a = (axis + a) % 3;
        at[a] = (0.5 + step * k as f64).fract() * size[a];
    }
    at
}

/// Samples of a box.
struct Samples {
    /// Of the whole volume.
    size: [usize; 3],
    /// The box.
    lo: [usize; 3],
    n: [usize; 3],
    values: Vec<f32>,
}

impl Samples {
    fn new(decoder: &dyn Decoder, lo: [usize; 3], hi: [usize; 3]) -> Self {
        let n = [0, 1, 2].map(|a| hi[a] - lo[a]);
        let mut values = vec![0.0; n.iter().product()];
        let layer = n[0] * n[1] * N_LAYERS;
        parallel::for_each_chunk(&mut values, layer, |k, values| {
            let first = [lo[0], lo[1], lo[2] + k * N_LAYERS];
            decoder.decode(first, [hi[0], hi[1], (first[2] + N_LAYERS).min(hi[2])], values);
        });
        Self { size: decoder.size(), lo, n, values }
    }

    /// Around lines along an axis that begin between two index positions.
    fn around(decoder: &dyn Decoder, axis: usize, first: [f64; 3], end: [f64; 3]) -> Self {
        let (mut lo, mut hi) = ([0; 3], decoder.size());
        for a in [(axis + 1) % 3, (axis + 2) % 3] {
            // What differences to both sides reach.
            lo[a] = ((first[a] - GRADIENT_OFFSET).max(0.0) as usize).min(hi[a] - 1);
            hi[a] = ((end[a] + GRADIENT_OFFSET).max(0.0) as usize + 2).min(hi[a]);
        }
        Self::new(decoder, lo, hi)
    }
}

/// Values along a line along an axis, one per sample, and slopes across it.
struct Line {
    /// Position of the line's begin along its axis.
    first: f64,
    values: Vec<f32>,
    /// Along the other two axes, per unit of length.
    slopes: [Vec<f32>; 2],
    /// Slopes per unit of length, of those per sample along the axis.
    per_sample: f32,
}

impl Line {
    /// From an index position on. `spacing`: of the samples along each axis.
    fn new(samples: &Samples, axis: usize, start: [f64; 3], spacing: [f64; 3]) -> Self {
        let Samples { size, lo, n, ref values } = *samples;
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        // Middle, and the ends of a difference, which stay inside.
        let at = |a: usize, shift: f64| (start[a] + shift).clamp(0.0, (size[a] - 1) as f64);
        let strides = [1, n[0], n[0] * n[1]];
        // Bilinear between the four samples around a position across the line.
        let line = |shift: [f64; 2]| -> Vec<f32> {
            let mut first = 0;
            let mut next = [(0, 0.0); 2];
            for k in 0..2 {
                let a = across[k];
                let x = (at(a, shift[k]) - lo[a] as f64).max(0.0);
                let below = (x as usize).min(n[a].saturating_sub(2));
                first += below * strides[a];
                next[k] = (if n[a] > 1 { strides[a] } else { 0 }, (x - below as f64) as f32);
            }
            let [(db, b), (dc, c)] = next;
            let weights = [(0, (1.0 - b) * (1.0 - c)), (db, b * (1.0 - c)), (dc, (1.0 - b) * c), (db + dc, b * c)];
            let value = |i: usize| weights.iter().map(|(d, w)| w * values[first + i * strides[axis] + d]).sum();
            (0..n[axis]).map(value).collect()
        };
        let slope = |k: usize| {
            let a = across[k];
            let way = (at(a, GRADIENT_OFFSET) - at(a, -GRADIENT_OFFSET)) * spacing[a];
            let shift = |sign: f64| if k == 0 { [sign * GRADIENT_OFFSET, 0.0] } else { [0.0, sign * GRADIENT_OFFSET] };
            let per_way = if way > 0.0 { (1.0 / way) as f32 } else { 0.0 };
            let (before, after) = (line(shift(-1.0)), line(shift(1.0)));
            before.iter().zip(&after).map(|(before, after)| (after - before) * per_way).collect()
        };
        Self {
            first: start[axis],
            values: line([0.0; 2]),
            slopes: [slope(0), slope(1)],
            per_sample: (1.0 / spacing[axis]) as f32,
        }
    }

    /// What there is at `n` positions, a `step` apart.
    fn along(&self, n: usize, step: f64, bin: impl Fn(f32) -> usize) -> Vec<Met> {
        let last = (self.values.len() - 1) as f64;
        let between = |line: &[f32], x: f64| {
            let below = (x as usize).min(line.len().saturating_sub(2));
            let to = line[(below + 1).min(line.len() - 1)];
            line[below] + (to - line[below]) * (x - below as f64) as f32
        };
        let met = |i: usize| {
            let x = (self.first + step * i as f64).clamp(0.0, last);
            let [before, after] = [(x - GRADIENT_OFFSET).max(0.0), (x + GRADIENT_OFFSET).min(last)];
            let change = between(&self.values, after) - between(&self.values, before);
            let along = change * self.per_sample / (after - before).max(GRADIENT_OFFSET) as f32;
            let [b, c] = [0, 1].map(|k| between(&self.slopes[k], x));
            let squared = along * along + b * b + c * c;
            let step = if squared > 0.0 {
                ((along.abs() / squared.sqrt() * N_COSINES as f32) as usize).min(N_COSINES - 1)
            } else {
                N_COSINES
            };
            (bin(between(&self.values, x)) * (N_COSINES + 1) + step) as Met
        };
        (0..n).map(met).collect()
    }
}
