//! Brightness of coarser levels, against lines that are integrated in double precision.

mod pyramid;

use pyramid::{BUDGET, LIFTED, coarse_values, curve, histogram_of, level_of, volume};
use wavesplat_core::{Shading, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_testkit::by_day;
use wavesplat_wavelet::CoefficientDecoder;

/// Values of a level on a fine grid, with the reach of its differences and its sheets.
struct Field<'a> {
    values: &'a [f64],
    size: [usize; 3],
    reach: usize,
    /// Distance of sheets, and position of one; between sheets values are linear along a line.
    sheet: f64,
    origin: [f64; 3],
}

impl Field<'_> {
    /// Trilinear interpolation, clamped to the grid.
    fn at(&self, position: [f64; 3]) -> f64 {
        let last = self.size.map(|n| (n - 1) as f64);
        let x = [0, 1, 2].map(|a| position[a].clamp(0.0, last[a]));
        let below = [0, 1, 2].map(|a| (x[a] as usize).min(self.size[a] - 2));
        let mut sum = 0.0;
        for corner in 0..8 {
            let up = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = |a: usize| (1.0 - up[a] as f64) - (x[a] - below[a] as f64) * (1.0 - 2.0 * up[a] as f64);
            let [i, j, k] = [0, 1, 2].map(|a| below[a] + up[a]);
            sum += weight(0) * weight(1) * weight(2) * self.values[(k * self.size[1] + j) * self.size[0] + i];
        }
        sum
    }

    /// `|n·v|` for a unit vector; `spacing`: distance of the samples.
    fn cosine(&self, position: [f64; 3], direction: [f64; 3], spacing: [f64; 3]) -> f64 {
        let gradient = [0, 1, 2].map(|a| {
            let end = |offset: f64| {
                let mut end = position;
                end[a] = (end[a] + offset).clamp(0.0, (self.size[a] - 1) as f64);
                end
            };
            let (from, to) = (end(-(self.reach as f64)), end(self.reach as f64));
            (self.at(to) - self.at(from)) / ((to[a] - from[a]) * spacing[a])
        });
        let along: f64 = (0..3).map(|a| gradient[a] * direction[a]).sum();
        along.abs() / gradient.iter().map(|g| g * g).sum::<f64>().sqrt().max(1e-12)
    }

    /// Mean brightness along lines oblique to an axis, all over its face; they are reflected at the sides.
    fn brightness(&self, tf: &TransferFunction, axis: usize, spacing: [f64; 3], shading: Option<&Shading>) -> f64 {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let [n, m] = across.map(|a| self.size[a]);
        let seen = |first: usize| {
            let mut direction = [1.0; 3];
            // All directions across, from neighbouring positions.
            let slopes = if first & 4 == 0 { [0.5, 0.3] } else { [0.3, 0.5] };
            for k in 0..2 {
                direction[across[k]] = if first >> k & 1 == 0 { slopes[k] } else { -slopes[k] };
            }
            let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            let path = |x: f64| {
                let (mut position, mut heading) = ([x; 3], direction.map(|d| d / length));
                for (k, start) in [first % n, first / n].into_iter().enumerate() {
                    let a = across[k];
                    let last = (self.size[a] - 1) as f64;
                    let way = start as f64 + x * direction[a] * spacing[axis] / spacing[a];
                    let turned = (way / last).floor() as i64 % 2 != 0;
                    let rest = way.rem_euclid(last);
                    position[a] = if turned { last - rest } else { rest };
                    heading[a] *= if turned { -1.0 } else { 1.0 };
                }
                (position, heading)
            };
            let (mut sum, mut clear) = (0.0, 1.0);
            // With fewer positions a steep function would miss thin features.
            for x in (0..2 * self.size[axis] - 1).map(|i| 0.5 * i as f64) {
                let (position, heading) = path(x);
                let before = ((x - self.origin[axis]) / self.sheet).floor() * self.sheet + self.origin[axis];
                let after = before + self.sheet;
                let value = if before >= 0.0 && after < self.size[axis] as f64 {
                    let [from, to] = [before, after].map(|x| self.at(path(x).0));
                    from + (to - from) * (x - before) / self.sheet
                } else {
                    self.at(position)
                };
                let alpha = -(0.5 * length * spacing[axis] * (-tf.opacity(value)).ln_1p()).exp_m1();
                if alpha == 0.0 {
                    continue;
                }
                let color = tf.color(value).iter().sum::<f64>() / 3.0;
                let light = shading.map_or(color, |s| {
                    let cosine = self.cosine(position, heading, spacing);
                    let gloss = (2.0 * cosine * cosine - 1.0).max(0.0).powf(f64::from(s.specular_power));
                    color * (f64::from(s.ambient) + f64::from(s.diffuse) * cosine) + f64::from(s.specular) * gloss
                });
                sum += clear * alpha * light;
                clear *= 1.0 - alpha;
            }
            sum
        };
        // A prime step reaches all columns and all directions.
        let firsts: Vec<usize> = (0..n * m).step_by(17).collect();
        let halves = firsts.split_at(firsts.len() / 2);
        let sum = |part: &[usize]| part.iter().map(|&first| seen(first)).sum::<f64>();
        std::thread::scope(|scope| {
            let second = scope.spawn(|| sum(halves.1));
            (sum(halves.0) + second.join().unwrap()) / firsts.len() as f64
        })
    }
}

/// Grains of a few samples in clusters, so that some rays meet many and others none.
fn grains([x, y, z]: [usize; 3]) -> f32 {
    let [x, y, z] = [x, y, z].map(|i| i as f32);
    let fine = (0.7 * x).sin() + (0.6 * y + 1.0).sin() + (0.65 * z + 2.0).sin();
    let coarse = (0.11 * x).sin() * (0.09 * y).sin() + 0.5 * (0.13 * z).sin();
    (30.0 * fine * (coarse + 0.3)).clamp(0.0, 100.0)
}

#[test]
fn a_level_is_as_bright_as_the_samples() {
    let size = [48, 44, 40];
    let between = size.map(|n| 2 * n - 1);
    let spacing = [0.7, 1.0, 1.6];
    let shading = Shading::headlight();
    for family in by_day(LIFTED, 2) {
        let volume = volume(family, size, grains);
        // Level 0 is the samples.
        let fine = coarse_values(&volume, 0, 2);
        for level in 1..3 {
            let (grid, coarse) = level_of(&volume, level);
            let finest = CoefficientDecoder::new(volume.clone(), 0, &[]).unwrap();
            let range = finest.range().map(f64::from);
            // Rays through the decoded volume, and in bundles.
            let histograms =
                [BUDGET, 0].map(|budget| LevelHistogram::new(&finest, &coarse, &grid, spacing, range, budget));
            let coarse = coarse_values(&volume, level, 2);
            for tf in [curve(&[(10.0, 0.0), (90.0, 0.3)]), curve(&[(60.0, 0.0), (60.0, 0.9)])] {
                for shading in [None, Some(&shading)] {
                    // Two sheets per slice; slices are two values apart.
                    let mean = |tf: &TransferFunction, values: &[f64], per_slice: usize| -> f64 {
                        let origin = if per_slice == 2 { [0.0; 3] } else { grid.origin.map(|x| 2.0 * x) };
                        let field =
                            Field { values, size: between, reach: per_slice, sheet: per_slice as f64 / 2.0, origin };
                        (0..3).map(|axis| field.brightness(tf, axis, spacing.map(|s| s / 2.0), shading)).sum()
                    };
                    let want = mean(&tf, &fine, 2);
                    let plain = mean(&tf, &coarse, 2 << level) / want;
                    let got = [0, 1].map(|k| {
                        let filtered = histograms[k].filter(&tf, spacing, shading, false).unwrap();
                        mean(&filtered, &coarse, 2 << level) / want
                    });
                    let case = format!("{family:?} level {level}, lit {}: {got:?}, plain {plain}", shading.is_some());
                    // The probe rays are a sample of all lines, and slopes between samples can be defined in several
                    // ways.
                    let most = if shading.is_some() { 0.05 } else { 0.015 };
                    assert!(got.iter().all(|got| (got - 1.0).abs() < most), "{case}");
                    assert!(level == 1 || plain < 0.95, "{case}");
                }
            }
        }
    }
}

/// Volumes thinner than a bundle of rays, and thinner than a gradient difference.
#[test]
fn thin_volumes_have_rays_too() {
    for size in [[2, 2, 2], [3, 40, 2], [2, 17, 33], [90, 3, 4]] {
        for family in LIFTED {
            let volume = volume(family, size, |[x, y, z]| ((x * 7 + y * 5 + z * 3) % 11) as f32);
            let tf = curve(&[(2.0, 0.0), (10.0, 0.5)]);
            let levels = 1..=volume.plan().n_levels().min(3);
            for level in levels.filter(|level| volume.plan().level_grid(*level).is_some()) {
                let filtered =
                    histogram_of(&volume, level).filter(&tf, [1.0; 3], Some(&Shading::headlight()), true).unwrap();
                let opacities = (0..=10).map(|value| filtered.opacity(f64::from(value)));
                assert!(opacities.clone().all(|o| (0.0..=1.0).contains(&o)), "{family:?} {size:?}");
                assert!(opacities.clone().any(|o| o > 0.0), "{family:?} {size:?}");
            }
        }
    }
}
