//! How bright a coarser level looks beside the finest, and what makes it as bright.
//!
//! Rays aslant to the axes, spread evenly over the volume, know the samples and the coarse values that they meet, and how
//! steeply the gradients of both stand to them. Between sheets values are linear, as the renderer takes them to be. Drawn
//! by a function each, in the light of a lamp at the eye,
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
const N_BUNDLES: usize = 256;
const N_MET: usize = 1 << 19;

/// Volumes of no more samples are decoded.
const N_DECODED: usize = 1 << 24;

/// Slices that one thread decodes.
const N_LAYERS: usize = 32;

/// Sheets per slice: of the finest samples, of a level, and of a level that is drawn with a steep function.
const SHEETS: [usize; 3] = [2, 2, 1];

/// Positions per sample of the finest grid for each of them: steep functions miss what lies between fewer, and the first
/// visible one on a ray tells how a surface stands.
const N_PER_SAMPLE: [usize; 3] = [4, 4, 2];

/// Factors of the extinction: from one over this up to this.
const LARGEST: f64 = 20.0;

/// From this factor on a level may be darker all the same; it is bright enough with this share of the brightness.
const OUT_OF_REACH: f64 = 0.9 * LARGEST;
const BRIGHT_ENOUGH: f64 = 0.93;

/// How much brighter without light, or darker, a level may get to be as bright in it: slopes that are lost cannot be made
/// up for by more of what has none.
const MOST_FOR_LIGHT: f64 = 1.25;

/// How much brighter colours may get where more extinction does not help: what is opaque has lost highlights on its
/// edges, which are rounder on a level. More would be seen in the hue of colours that have a full channel.
const MOST_OF_COLOR: f64 = 1.02;

/// How alike the logarithms of the brightnesses get, if it takes no more steps than the second number.
const TOLERANCE: f64 = 2e-3;
const N_STEPS: usize = 12;

/// Half distance of the differences that estimate the gradient, in samples of the level: what is usual.
const GRADIENT_OFFSET: f64 = 1.0;

/// How far rays run along an axis and across it: between those along it and those that run as much along another.
const DIRECTION: [f64; 3] = [1.0, 0.5, 0.3];

/// Steps of `|n·v|`; one more number stands for where there is no gradient.
const N_COSINES: usize = 31;

/// Rays that are followed by one thread.
const N_TOGETHER: usize = 64;

/// What of the light is left when the rest of a ray does not count.
const DARK: f32 = 1e-4;

/// Mean of the colour, and opacity, in each bin of values.
pub type Look = Vec<[f64; 2]>;

/// A ray along an axis, more or less.
struct Ray {
    axis: usize,
    /// What it meets in order, for each of [`SHEETS`].
    met: [Vec<Met>; 3],
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
                let path = Path::new(axis, start, [first, end], spacing, k);
                let finest = LevelGrid::finest(size);
                let of = |which: usize| {
                    let (samples, grid) = if which == 0 { (fine, &finest) } else { (coarse, grid) };
                    Sheets::new(samples, grid, &path, spacing, SHEETS[which] as f64).along(
                        size[axis],
                        N_PER_SAMPLE[which],
                        &bin,
                    )
                };
                let mut met = [of(0), of(1), of(2)];
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

    /// By how much the extinction of the coarse look has to be multiplied, and then its colours by a little, so that the
    /// level is as bright as the finest. `lengths`: from sample to sample along each axis, in units of the opacities.
    /// Without shading, colours are as they are. `is_steep`: whether the level gets the sheets of a steep function.
    pub fn factors(
        &self,
        [fine, coarse]: [&Look; 2],
        shading: Option<&Shading>,
        lengths: [f64; 3],
        is_steep: bool,
    ) -> [f64; 2] {
        let (lit, unlit) = (light(shading), light(None));
        let wanted_lit = self.brightness(0, fine, &lit, lengths);
        let mut factor = self.factor_for(wanted_lit, coarse, is_steep, &lit, lengths);
        if shading.is_none() {
            return [factor, 1.0];
        }
        let coarse_brightness = |factor: f64, light: &[[f64; 2]]| {
            self.brightness(coarse_sheets(is_steep), coarse, light, lengths.map(|length| factor * length))
        };
        let (wanted, got) = (self.brightness(0, fine, &unlit, lengths), coarse_brightness(factor, &unlit));
        let bounded = got.clamp(wanted / MOST_FOR_LIGHT, wanted * MOST_FOR_LIGHT);
        if got != bounded {
            factor = self.factor_for(bounded, coarse, is_steep, &unlit, lengths);
        }
        let is_out_of_reach = got != bounded || factor >= OUT_OF_REACH;
        let gain = if is_out_of_reach { wanted_lit / coarse_brightness(factor, &lit) } else { 1.0 };
        [factor, if gain > 1.0 { gain.min(MOST_OF_COLOR) } else { 1.0 }]
    }

    /// Whether a factor of the extinction that [`Rays::factors`] found makes the coarse look about as bright, without light.
    pub fn is_bright_enough(&self, [fine, coarse]: [&Look; 2], factor: f64, lengths: [f64; 3], is_steep: bool) -> bool {
        if factor < OUT_OF_REACH {
            return true;
        }
        let unlit = light(None);
        let wanted = self.brightness(0, fine, &unlit, lengths);
        self.brightness(coarse_sheets(is_steep), coarse, &unlit, lengths.map(|length| factor * length))
            >= BRIGHT_ENOUGH * wanted
    }

    /// The factor that makes the coarse look as bright as is wanted.
    fn factor_for(&self, wanted: f64, coarse: &Look, is_steep: bool, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        if wanted <= 0.0 {
            return 1.0;
        }
        // The logarithm of the factor: where it can lie, where it is looked at, and how much too bright that is.
        let [mut lo, mut hi] = [-LARGEST.ln(), LARGEST.ln()];
        let (mut at, mut before) = (0.0, None);
        for _ in 0..N_STEPS {
            let brightness =
                self.brightness(coarse_sheets(is_steep), coarse, light, lengths.map(|length| f64::exp(at) * length));
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

    /// Mean over the rays, for one of [`SHEETS`]. `lengths`: from sample to sample along each axis.
    fn brightness(&self, which: usize, look: &Look, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        let lengths = step_lengths(which, lengths);
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

/// Which of [`SHEETS`] a level gets.
fn coarse_sheets(is_steep: bool) -> usize {
    1 + usize::from(is_steep)
}

/// Lengths of rays along each axis from one position to the next. `lengths`: from sample to sample.
fn step_lengths(which: usize, lengths: [f64; 3]) -> [f64; 3] {
    let longer = DIRECTION.iter().map(|d| d * d).sum::<f64>().sqrt() / DIRECTION[0];
    lengths.map(|length| length * longer / N_PER_SAMPLE[which] as f64)
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

    /// Around paths along an axis that stay between two index positions.
    fn around(decoder: &dyn Decoder, axis: usize, first: [f64; 3], end: [f64; 3]) -> Self {
        let (mut lo, mut hi) = ([0; 3], decoder.size());
        for a in [(axis + 1) % 3, (axis + 2) % 3] {
            // What differences to both sides reach.
            lo[a] = ((first[a] - GRADIENT_OFFSET).max(0.0) as usize).min(hi[a] - 1);
            hi[a] = ((end[a] + GRADIENT_OFFSET).max(0.0) as usize + 2).min(hi[a]);
        }
        Self::new(decoder, lo, hi)
    }

    /// Trilinear, at an index position; the nearest one of the box where it is outside.
    fn at(&self, position: [f64; 3]) -> f32 {
        let mut first = 0;
        let (mut strides, mut shares) = ([1, self.n[0], self.n[0] * self.n[1]], [0.0; 3]);
        for a in 0..3 {
            let x = (position[a] - self.lo[a] as f64).clamp(0.0, (self.n[a] - 1) as f64);
            let below = (x as usize).min(self.n[a].saturating_sub(2));
            first += below * strides[a];
            shares[a] = (x - below as f64) as f32;
            // A box of one sample has no neighbour, and nothing of its share.
            strides[a] *= usize::from(self.n[a] > 1);
        }
        let [tx, ty, tz] = shares;
        let between = |i: usize, stride: usize, t: f32| self.values[i] + (self.values[i + stride] - self.values[i]) * t;
        let row = |i: usize| between(i, strides[0], tx);
        let plane = |i: usize| row(i) + (row(i + strides[1]) - row(i)) * ty;
        plane(first) + (plane(first + strides[2]) - plane(first)) * tz
    }

    /// What is at a position, and at both ends of a difference along each axis.
    fn with_neighbours(&self, position: [f64; 3]) -> (f32, [[f32; 2]; 3]) {
        self.inner_neighbours(position).unwrap_or_else(|| {
            let end = |a: usize, offset: f64| {
                let mut end = position;
                end[a] = (end[a] + offset).clamp(0.0, (self.size[a] - 1) as f64);
                self.at(end)
            };
            (self.at(position), [0, 1, 2].map(|a| [-GRADIENT_OFFSET, GRADIENT_OFFSET].map(|offset| end(a, offset))))
        })
    }

    /// The same where all of it is inside: one sample further on the shares are the same.
    #[inline]
    fn inner_neighbours(&self, position: [f64; 3]) -> Option<(f32, [[f32; 2]; 3])> {
        const { assert!(GRADIENT_OFFSET == 1.0, "shares are the same a whole sample further on") };
        let strides = [1, self.n[0], self.n[0] * self.n[1]];
        let (mut first, mut shares) = (0, [0.0; 3]);
        for a in 0..3 {
            let x = position[a] - self.lo[a] as f64;
            if x < 1.0 || x + 2.0 >= (self.n[a] - 1) as f64 {
                return None;
            }
            first += x as usize * strides[a];
            shares[a] = (x - x.floor()) as f32;
        }
        let [tx, ty, tz] = shares;
        let at = |i: usize| {
            let row = |i: usize| self.values[i] + (self.values[i + 1] - self.values[i]) * tx;
            let plane = |i: usize| row(i) + (row(i + strides[1]) - row(i)) * ty;
            plane(i) + (plane(i + strides[2]) - plane(i)) * tz
        };
        Some((at(first), strides.map(|stride| [at(first - stride), at(first + stride)])))
    }
}

/// The way of a ray, by index positions of the finest grid. It is thrown back from the sides of its box.
struct Path {
    axis: usize,
    start: [f64; 3],
    /// Per sample along the axis.
    slope: [f64; 3],
    bounds: [[f64; 3]; 2],
    /// Unit vector at the start, in the space of the spacing.
    direction: [f64; 3],
}

impl Path {
    /// `spacing`: of the finest samples along each axis. `k`: which of the ways across.
    fn new(axis: usize, start: [f64; 3], bounds: [[f64; 3]; 2], spacing: [f64; 3], k: usize) -> Self {
        let mut direction = [0.0; 3];
        direction[axis] = DIRECTION[0];
        // Either of the other axes more, and either way.
        let across = if k & 2 == 0 { [1, 2] } else { [2, 1] };
        direction[(axis + across[0]) % 3] = DIRECTION[1] * if k & 4 == 0 { 1.0 } else { -1.0 };
        direction[(axis + across[1]) % 3] = DIRECTION[2] * if k & 8 == 0 { 1.0 } else { -1.0 };
        let slope = [0, 1, 2].map(|a| direction[a] / DIRECTION[0] * spacing[axis] / spacing[a]);
        let length = DIRECTION.iter().map(|d| d * d).sum::<f64>().sqrt();
        Self { axis, start, slope, bounds, direction: direction.map(|d| d / length) }
    }

    /// Position where it is `x` along its axis, and along which axes it runs as it did at the start: 1, or else −1.
    fn at(&self, x: f64) -> [[f64; 3]; 2] {
        let (mut position, mut signs) = (self.start, [1.0; 3]);
        for a in 0..3 {
            let [lo, hi] = [self.bounds[0][a], self.bounds[1][a]];
            if a == self.axis {
                position[a] = x;
            } else if hi > lo {
                // Forth and back.
                let way = (self.start[a] + self.slope[a] * x - lo).rem_euclid(2.0 * (hi - lo));
                let is_back = way > hi - lo;
                position[a] = if is_back { 2.0 * hi - lo - way } else { lo + way };
                signs[a] = if is_back { -1.0 } else { 1.0 };
            }
        }
        [position, signs]
    }
}

/// What a ray meets in sheets.
struct Sheets {
    /// Sheets per sample of the finest grid, along the axis, and where the first one lies.
    per_sample: f64,
    origin: f64,
    /// Value, and its slopes along the three axes, as the ray runs.
    numbers: Vec<[f32; 4]>,
    /// Unit vector of the ray.
    direction: [f64; 3],
}

impl Sheets {
    /// Of samples that lie on `grid`, of whose slices one has `per_slice` sheets. `spacing`: of the finest samples.
    fn new(samples: &Samples, grid: &LevelGrid, path: &Path, spacing: [f64; 3], per_slice: f64) -> Self {
        let axis = path.axis;
        let n = ((samples.size[axis] - 1) as f64 * per_slice) as usize + 1;
        let sheet = |k: usize| {
            let mut x = grid.origin[axis] + grid.spacing[axis] * k as f64 / per_slice;
            x = x.clamp(path.bounds[0][axis], path.bounds[1][axis]);
            let [position, signs] = path.at(x);
            let position = grid.level_from_finest(position);
            let (value, ends) = samples.with_neighbours(position);
            let mut numbers = [value; 4];
            for a in 0..3 {
                let last = (samples.size[a] - 1) as f64;
                let way = (position[a] + GRADIENT_OFFSET).min(last) - (position[a] - GRADIENT_OFFSET).max(0.0);
                let way = way * grid.spacing[a] * spacing[a];
                let change = f64::from(ends[a][1] - ends[a][0]);
                numbers[a + 1] = if way > 0.0 { (signs[a] * change / way) as f32 } else { 0.0 };
            }
            numbers
        };
        Self {
            per_sample: per_slice / grid.spacing[axis],
            origin: grid.origin[axis],
            numbers: (0..n).map(sheet).collect(),
            direction: path.direction,
        }
    }

    /// What there is on a ray that is `n` samples of the finest grid long, at so many positions per sample.
    fn along(&self, n: usize, n_per_sample: usize, bin: impl Fn(f32) -> usize) -> Vec<Met> {
        let last = (self.numbers.len() - 1) as f64;
        let direction = self.direction.map(|d| d as f32);
        let met = |i: usize| {
            let x = ((i as f64 / n_per_sample as f64 - self.origin) * self.per_sample).clamp(0.0, last);
            let below = x as usize;
            let (from, to) = (self.numbers[below], self.numbers[(below + 1).min(self.numbers.len() - 1)]);
            let t = (x - below as f64) as f32;
            let [value, slopes @ ..] = [0, 1, 2, 3].map(|c| from[c] + (to[c] - from[c]) * t);
            let slope = slopes.iter().map(|slope| slope * slope).sum::<f32>().sqrt();
            let along: f32 = slopes.iter().zip(direction).map(|(slope, d)| slope * d).sum();
            let step = if slope > 0.0 {
                ((along.abs() / slope * N_COSINES as f32) as usize).min(N_COSINES - 1)
            } else {
                N_COSINES
            };
            (bin(value) * (N_COSINES + 1) + step) as Met
        };
        (0..=(n - 1) * n_per_sample).map(met).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_found_at_once_where_they_are_inside() {
        let (size, lo, n) = ([20, 30, 40], [5, 0, 12], [9, 30, 11]);
        let random = |i: usize| ((i as f64 * 12.9898).sin() * 43_758.545).rem_euclid(1.0);
        let values = (0..n.iter().product()).map(|i| random(i) as f32).collect();
        let samples = Samples { size, lo, n, values };
        let mut n_inner = 0;
        for i in 0..2000 {
            let position = [0, 1, 2].map(|a| lo[a] as f64 + random(3 * i + a) * (n[a] - 1) as f64);
            let Some((value, ends)) = samples.inner_neighbours(position) else { continue };
            n_inner += 1;
            assert!((value - samples.at(position)).abs() < 1e-6);
            for a in 0..3 {
                for (k, offset) in [-GRADIENT_OFFSET, GRADIENT_OFFSET].into_iter().enumerate() {
                    let mut end = position;
                    end[a] += offset;
                    assert!((ends[a][k] - samples.at(end)).abs() < 1e-6, "{position:?} {a} {offset}");
                }
            }
        }
        assert!(n_inner > 500);
    }
}
