//! Levels as volumes of their own: where their samples lie, and which transfer function they are drawn with.

use std::sync::Arc;

use wavesplat_core::{ColorNode, Decoder as _, OpacityNode, Shading, TransferFunction};
use wavesplat_wavelet::{Coarse, Decoder, Family, Keep, LevelGrid, Norm, Plan, Spread, WaveletVolume};

/// Families whose low coefficients are samples.
const LIFTED: [Family; 3] = [Family::Haar, Family::Cdf53, Family::Cdf97];

fn volume(family: Family, size: [usize; 3], sample: impl Fn([usize; 3]) -> f32) -> Arc<WaveletVolume> {
    let [nx, ny, nz] = size;
    let samples: Vec<f32> = (0..nx * ny * nz).map(|i| sample([i % nx, i / nx % ny, i / (nx * ny)])).collect();
    Arc::new(WaveletVolume::new(family, size, samples, None, Norm::L2, Keep::Amplitude(0.0)))
}

fn level_of(volume: &Arc<WaveletVolume>, level: usize) -> (LevelGrid, Coarse) {
    let grid = LevelGrid::new(volume.plan(), level).unwrap();
    (grid, Coarse::new(Decoder::new(volume.clone(), level, &[]), grid))
}

fn all(decoder: &Coarse) -> Vec<f32> {
    let size = decoder.size();
    let mut all = vec![f32::NAN; size.iter().product()];
    decoder.decode([0; 3], size, &mut all);
    all
}

/// Origin, spacing and size along an axis.
fn check_axis(family: Family, n: usize, level: usize, want: (f64, f64, usize)) {
    let grid = LevelGrid::new(&Plan::new(family, [n, 64, 64], None), level).unwrap();
    assert_eq!((grid.origin[0], grid.spacing[0], grid.size[0]), want, "{family:?} of {n} at level {level}");
}

#[test]
fn low_samples_lie_on_every_second_one_or_between_two() {
    for family in [Family::Cdf53, Family::Cdf97] {
        check_axis(family, 17, 0, (0.0, 1.0, 17));
        // Nine of 17 reach the end; eight of 16 end at 14, and one more does.
        check_axis(family, 17, 1, (0.0, 2.0, 9));
        check_axis(family, 16, 1, (0.0, 2.0, 9));
        check_axis(family, 16, 3, (0.0, 8.0, 3));
        // Split up before the others.
        check_axis(family, 2, 5, (0.0, 2.0, 2));
    }
    check_axis(Family::Haar, 16, 0, (0.0, 1.0, 16));
    // Eight from 0.5 to 14.5, and one before and after.
    check_axis(Family::Haar, 16, 1, (-1.5, 2.0, 10));
    check_axis(Family::Haar, 17, 1, (-1.5, 2.0, 10));
    // Four from 1.5 to 13.5.
    check_axis(Family::Haar, 16, 2, (-2.5, 4.0, 6));
    check_axis(Family::Haar, 2, 5, (-1.5, 2.0, 3));
}

#[test]
fn every_level_reaches_both_ends() {
    for family in LIFTED {
        for size in [[64, 17, 2], [5, 6, 7], [31, 32, 33]] {
            let plan = Plan::new(family, size, None);
            for level in 0..=plan.n_levels() {
                let grid = LevelGrid::new(&plan, level).unwrap();
                for a in 0..3 {
                    let last = grid.origin[a] + grid.spacing[a] * (grid.size[a] - 1) as f64;
                    let end = (size[a] - 1) as f64;
                    assert!(grid.size[a] >= 2, "{family:?} {size:?} {level}: a volume needs two samples");
                    assert!(grid.origin[a] <= 0.0 && last >= end, "{family:?} {size:?} {level}");
                    assert!(last < end + grid.spacing[a], "{family:?} {size:?} {level}: no more than is needed");
                    let mut position = [0.0; 3];
                    position[a] = last;
                    assert_eq!(grid.level_from_finest(position)[a], (grid.size[a] - 1) as f64);
                }
            }
        }
    }
}

#[test]
fn spline_coefficients_are_no_samples() {
    for family in [Family::Spline4, Family::Bspline2, Family::Bspline3, Family::Bspline4] {
        let plan = Plan::new(family, [20, 21, 22], None);
        assert_eq!(LevelGrid::new(&plan, 0).map(|grid| (grid.origin, grid.size)), Some(([0.0; 3], [20, 21, 22])));
        assert_eq!(LevelGrid::new(&plan, 1), None);
    }
}

#[test]
fn a_ramp_has_its_values_where_the_low_samples_lie() {
    let slope = [1.0, -2.0, 0.5];
    for family in LIFTED {
        let ramp = volume(family, [64, 48, 50], |p| (0..3).map(|a| slope[a] * p[a] as f32).sum());
        for level in 0..3 {
            let (grid, coarse) = level_of(&ramp, level);
            let samples = all(&coarse);
            let [nx, ny, _] = grid.size;
            for (i, got) in samples.iter().enumerate() {
                let index = [i % nx, i / nx % ny, i / (nx * ny)];
                // The mirrored ends bend the ramp there.
                if (0..3).all(|a| (4..grid.size[a] - 4).contains(&index[a])) {
                    let want: f64 = (0..3)
                        .map(|a| f64::from(slope[a]) * (grid.origin[a] + grid.spacing[a] * index[a] as f64))
                        .sum();
                    assert!((f64::from(*got) - want).abs() < 1e-3, "{family:?} level {level} {index:?}: {got} {want}");
                }
            }
        }
    }
}

#[test]
fn the_ends_are_repeated_in_every_box() {
    let sample = |[x, y, z]: [usize; 3]| ((x * 31 + y * 17 + z * 7) % 23) as f32;
    for family in LIFTED {
        let volume = volume(family, [18, 15, 8], sample);
        for level in 1..3 {
            let (grid, coarse) = level_of(&volume, level);
            let low = Decoder::new(volume.clone(), level, &[]);
            let (low_size, low) = (low.size(), low.all());
            let n_before = usize::from(family == Family::Haar);
            let want = |index: [usize; 3]| {
                let [x, y, z] = [0, 1, 2].map(|a| index[a].saturating_sub(n_before).min(low_size[a] - 1));
                low[(z * low_size[1] + y) * low_size[0] + x]
            };
            assert!((0..3).any(|a| grid.size[a] > low_size[a]), "something is repeated");
            for lo in [[0; 3], [1, 0, 1], grid.size.map(|n| n - 1), grid.size.map(|n| n - 2)] {
                for hi in [grid.size, [0, 1, 2].map(|a| (lo[a] + 1).min(grid.size[a]))] {
                    let n = [0, 1, 2].map(|a| hi[a] - lo[a]);
                    let mut part = vec![f32::NAN; n.iter().product()];
                    coarse.decode(lo, hi, &mut part);
                    for (i, got) in part.iter().enumerate() {
                        let index = [lo[0] + i % n[0], lo[1] + i / n[0] % n[1], lo[2] + i / (n[0] * n[1])];
                        assert_eq!(got.to_bits(), want(index).to_bits(), "{family:?} {level} {lo:?} {hi:?} {index:?}");
                    }
                }
            }
        }
    }
}

/// Blue below 30, red from 40 on; as opaque as the nodes say.
fn curve(nodes: &[(f64, f64)]) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = vec![ColorNode { value: 30.0, rgb: [0.0, 0.0, 1.0] }, ColorNode { value: 40.0, rgb: [1.0, 0.0, 0.0] }];
    TransferFunction::new(opacity, color, None).unwrap()
}

/// Enough for any volume here.
const BUDGET: usize = 1 << 30;

fn spread_of(volume: &Arc<WaveletVolume>, level: usize) -> Spread {
    let (grid, coarse) = level_of(volume, level);
    let fine = Decoder::new(volume.clone(), 0, &[]);
    Spread::new(&fine, &coarse, &grid, [1.0; 3], fine.range().map(f64::from), BUDGET)
}

/// Interpolated samples of a level at the places of all samples, and `per_sample - 1` between them.
fn coarse_values(volume: &Arc<WaveletVolume>, level: usize, per_sample: usize) -> Vec<f64> {
    let (grid, coarse) = level_of(volume, level);
    let samples = all(&coarse);
    let [nx, ny, _] = grid.size;
    let [fx, fy, fz] = volume.plan().size().map(|n| (n - 1) * per_sample + 1);
    (0..fx * fy * fz)
        .map(|i| {
            let index = [i % fx, i / fx % fy, i / (fx * fy)].map(|i| i as f64 / per_sample as f64);
            let place = grid.level_from_finest(index);
            let below: [usize; 3] = [0, 1, 2].map(|a| (place[a] as usize).min(grid.size[a] - 2));
            let share = |corner: usize| -> f64 {
                let t = |a: usize| place[a] - below[a] as f64;
                (0..3).map(|a| if corner >> a & 1 == 1 { t(a) } else { 1.0 - t(a) }).product()
            };
            let at = |c: usize| samples[((below[2] + c / 4) * ny + below[1] + c / 2 % 2) * nx + below[0] + c % 2];
            (0..8).map(|corner| share(corner) * f64::from(at(corner))).sum()
        })
        .collect()
}

/// Mean opacity of a length over places that have these values.
fn mean_opacity(tf: &TransferFunction, values: &[f64], length: f64) -> f64 {
    let opacity = |value: &f64| -(length * (-tf.opacity(*value)).ln_1p()).exp_m1();
    values.iter().map(opacity).sum::<f64>() / values.len() as f64
}

/// Walls one sample thin, of 80 to 120, in a space of 0 to 8: no value is so frequent that its bin stands out.
fn walls([x, y, z]: [usize; 3]) -> f32 {
    let wave = (0.31 * y as f32 + 0.23 * z as f32 + 0.05 * x as f32).sin();
    if x % 5 == 2 { 100.0 + 20.0 * wave } else { 4.0 + 4.0 * wave }
}

#[test]
fn thin_walls_keep_their_mean_opacity() {
    let hard = curve(&[(60.0, 0.0), (60.0, 0.6)]);
    let soft = curve(&[(0.0, 0.0), (100.0, 0.6)]);
    for family in LIFTED {
        let volume = volume(family, [80, 40, 40], walls);
        let fine: Vec<f64> = Decoder::new(volume.clone(), 0, &[]).all().into_iter().map(f64::from).collect();
        for level in 1..4 {
            let (spread, coarse) = (spread_of(&volume, level), coarse_values(&volume, level, 1));
            for tf in [&hard, &soft] {
                for length in [0.5, 1.0, 2.0] {
                    let want = mean_opacity(tf, &fine, length);
                    let filtered = spread.average(tf, length).unwrap();
                    let got = mean_opacity(&filtered, &coarse, length);
                    assert!((got / want - 1.0).abs() < 0.03, "{family:?} level {level} length {length}: {got} {want}");
                }
            }
            let unfiltered = mean_opacity(&hard, &coarse, 1.0) / mean_opacity(&hard, &fine, 1.0);
            assert!(level == 1 || unfiltered < 0.3, "{family:?} level {level} loses the walls: {unfiltered}");
        }
    }
}

#[test]
fn what_cannot_be_seen_lends_no_color() {
    let volume = volume(Family::Cdf53, [80, 40, 40], walls);
    let filtered = spread_of(&volume, 2).average(&curve(&[(60.0, 0.0), (60.0, 0.6)]), 1.0).unwrap();
    let seen: Vec<f64> = coarse_values(&volume, 2, 1).into_iter().filter(|d| filtered.opacity(*d) > 0.01).collect();
    let n_low = seen.iter().filter(|d| **d < 30.0).count();
    assert!(n_low > 1000, "values that are blue themselves stand for red walls: {n_low}");
    // Beside a bin that nothing falls into, a color is mixed with that of the value itself.
    let n_mixed = seen.iter().filter(|d| filtered.color(**d)[0] < 0.99).count();
    assert!(n_mixed < seen.len() / 100, "{n_mixed} of {}", seen.len());
}

/// A few samples among many, whose coarse values are those of many others, are no reason to draw all of these; unless
/// there is nothing else.
#[test]
fn what_is_rare_makes_no_haze() {
    let step = curve(&[(60.0, 0.0), (60.0, 1.0)]);
    // Of a thousand samples one stands out; the others lie in a wave.
    let grain = |[x, y, z]: [usize; 3]| if (7 * x + 83 * y + 331 * z) % 1009 == 0 { 100.0 } else { walls([5, y, z]) };
    let beside_a_block = |[x, y, z]: [usize; 3]| if x < 40 { 90.0 } else { grain([x, y, z]) };
    for family in LIFTED {
        for level in 2..4 {
            let drawn = |sample: &dyn Fn([usize; 3]) -> f32| {
                let volume = volume(family, [80, 40, 40], sample);
                let (spread, coarse) = (spread_of(&volume, level), coarse_values(&volume, level, 1));
                let of_grains = coarse.iter().filter(|d| **d < 50.0);
                [spread.average(&step, 1.0), spread.filter(&step, [1.0; 3], None, true)].map(|tf| {
                    let tf = tf.unwrap();
                    of_grains.clone().filter(|d| tf.opacity(**d) > 0.0).count() as f64
                        / of_grains.clone().count() as f64
                })
            };
            let [averaged, filtered] = drawn(&beside_a_block);
            assert!(averaged > 0.5 && filtered < 0.1, "{family:?} level {level}: {averaged} {filtered} are drawn");
            let [averaged, filtered] = drawn(&grain);
            assert!(
                averaged > 0.5 && filtered == averaged,
                "{family:?} level {level}: {averaged} {filtered} are drawn"
            );
        }
    }
}

/// Bars with sharp edges, which are rounder on a level.
#[test]
fn what_is_opaque_gets_lost_light_back_as_color() {
    let is_bar = |[x, y, z]: [usize; 3]| (x % 16 < 8) ^ (y % 16 < 8) ^ (z % 16 < 8);
    let volume = volume(Family::Cdf97, [64; 3], |at| if is_bar(at) { 200.0 } else { 0.0 });
    let opacity = [(99.0, 0.0), (100.0, 1.0)].map(|(value, opacity)| OpacityNode { value, opacity }).to_vec();
    let color = vec![ColorNode { value: 0.0, rgb: [0.5, 0.995, 0.0] }];
    let step = TransferFunction::new(opacity, color, Some(1.0)).unwrap();
    let shiny = Shading { ambient: 0.1, diffuse: 0.7, specular: 0.2, ..Shading::default() };
    let spread = spread_of(&volume, 1);
    let colors = |shading| spread.filter(&step, [1.0; 3], shading, true).unwrap().color(200.0);
    assert_eq!(colors(None), [0.5, 0.995, 0.0]);
    let [r, g, b] = colors(Some(&shiny));
    assert!(0.5005 < r && r <= 0.51 + 1e-12, "{r}");
    assert!(0.995 < g && g <= 1.0 && b == 0.0, "{g} {b}");
}

#[test]
fn a_linear_function_of_a_ramp_stays_as_it_is() {
    let linear = curve(&[(0.0, 0.0), (63.0, 0.9)]);
    for family in LIFTED {
        let ramp = volume(family, [64, 40, 40], |[x, ..]| x as f32);
        for level in 1..3 {
            let spread = spread_of(&ramp, level);
            let filtered = spread.average(&linear, 2.0).unwrap();
            // Away from the mirrored ends; half a bin of 512 is 0.1 %.
            for value in [16.0, 24.3, 32.0, 47.9] {
                let (got, want) = (filtered.opacity(value), linear.opacity(value));
                assert!((got - want).abs() < 0.01, "{family:?} level {level} at {value}: {got} {want}");
            }
        }
    }
}

#[test]
fn a_constant_volume_keeps_its_function() {
    let tf = curve(&[(0.0, 0.1), (100.0, 0.9)]);
    let constant = volume(Family::Cdf97, [20, 21, 22], |_| 7.0);
    let (grid, coarse) = level_of(&constant, 1);
    let fine = Decoder::new(constant.clone(), 0, &[]);
    for range in [[7.0, 7.0], fine.range().map(f64::from)] {
        let spread = Spread::new(&fine, &coarse, &grid, [1.0; 3], range, BUDGET);
        let (averaged, filtered) =
            (spread.average(&tf, 1.5).unwrap(), spread.filter(&tf, [1.0; 3], None, true).unwrap());
        assert!((averaged.opacity(7.0) - tf.opacity(7.0)).abs() < 1e-4);
        assert!((filtered.opacity(7.0) / tf.opacity(7.0) - 1.0).abs() < 0.01);
    }
}

#[test]
fn what_is_opaque_everywhere_stays_opaque_and_what_is_clear_stays_clear() {
    let halves = volume(Family::Haar, [64, 40, 40], |[x, ..]| if x < 32 { 0.0 } else { 100.0 });
    let step = curve(&[(50.0, 0.0), (50.0, 1.0)]);
    let opaque = curve(&[(0.0, 1.0)]);
    for level in 1..4 {
        let spread = spread_of(&halves, level);
        for length in [0.01, 1.0, 2.0] {
            let filtered = spread.average(&step, length).unwrap();
            assert!(filtered.opacity(100.0) == 1.0 && filtered.opacity(0.0) == 0.0, "level {level} length {length}");
            let filtered = spread.average(&opaque, length).unwrap();
            assert!((0..=100).all(|value| filtered.opacity(f64::from(value)) == 1.0), "level {level} length {length}");
        }
        let shading = Some(&Shading::default());
        let filtered = spread.filter(&step, [0.3, 1.0, 2.0], shading, true).unwrap();
        assert!(filtered.opacity(100.0) == 1.0 && filtered.opacity(0.0) == 0.0, "level {level}");
        let filtered = spread.filter(&opaque, [0.3, 1.0, 2.0], shading, true).unwrap();
        assert!((0..=100).all(|value| filtered.opacity(f64::from(value)) == 1.0), "level {level}");
        // Nothing to be as bright as.
        let clear = curve(&[(0.0, 0.0)]);
        assert_eq!(spread.filter(&clear, [1.0; 3], shading, true).unwrap().opacity(50.0), 0.0);
    }
}

/// Values on a grid, with differences as far as those of a level reach, and its sheets.
struct Field<'a> {
    values: &'a [f64],
    size: [usize; 3],
    reach: usize,
    /// From sheet to sheet, and where one lies; between them values are linear along a line.
    sheet: f64,
    origin: [f64; 3],
}

impl Field<'_> {
    /// Trilinear, or the nearest where it is outside.
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

    /// `|n·v|` along a unit vector; `spacing`: of the samples.
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

    /// Mean over lines aslant to an axis, all over its face, of what is seen along them. At the sides they turn back.
    fn brightness(&self, tf: &TransferFunction, axis: usize, spacing: [f64; 3], shading: Option<&Shading>) -> f64 {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let [n, m] = across.map(|a| self.size[a]);
        let seen = |first: usize| {
            let mut direction = [1.0; 3];
            // Every way across, from neighbouring places.
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
            // A steep function would miss what lies between fewer positions.
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
        // A prime: all columns and all ways.
        let firsts = (0..n * m).step_by(7);
        firsts.clone().map(seen).sum::<f64>() / firsts.count() as f64
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
    let shading = Shading::default();
    for family in LIFTED {
        let volume = volume(family, size, grains);
        // Level 0 is the samples.
        let fine = coarse_values(&volume, 0, 2);
        for level in 1..3 {
            let (grid, coarse) = level_of(&volume, level);
            let finest = Decoder::new(volume.clone(), 0, &[]);
            let range = finest.range().map(f64::from);
            // Rays through the decoded volume, and in bundles.
            let spreads = [BUDGET, 0].map(|budget| Spread::new(&finest, &coarse, &grid, spacing, range, budget));
            let coarse = coarse_values(&volume, level, 2);
            for tf in [curve(&[(10.0, 0.0), (90.0, 0.3)]), curve(&[(60.0, 0.0), (60.0, 0.9)])] {
                for shading in [None, Some(&shading)] {
                    // Two sheets a slice, whose values are two apart.
                    let mean = |tf: &TransferFunction, values: &[f64], per_slice: usize| -> f64 {
                        let origin = if per_slice == 2 { [0.0; 3] } else { grid.origin.map(|x| 2.0 * x) };
                        let field =
                            Field { values, size: between, reach: per_slice, sheet: per_slice as f64 / 2.0, origin };
                        (0..3).map(|axis| field.brightness(tf, axis, spacing.map(|s| s / 2.0), shading)).sum()
                    };
                    let want = mean(&tf, &fine, 2);
                    let plain = mean(&tf, &coarse, 2 << level) / want;
                    let got = [0, 1].map(|k| {
                        let filtered = spreads[k].filter(&tf, spacing, shading, false).unwrap();
                        mean(&filtered, &coarse, 2 << level) / want
                    });
                    let case = format!("{family:?} level {level}, lit {}: {got:?}, plain {plain}", shading.is_some());
                    // The rays are some of all, and what a slope is between samples is a matter of opinion.
                    let most = if shading.is_some() { 0.05 } else { 0.015 };
                    assert!(got.iter().all(|got| (got - 1.0).abs() < most), "{case}");
                    assert!(level == 1 || plain < 0.95, "{case}");
                }
            }
        }
    }
}

/// Volumes thinner than a bundle of rays, and than a difference.
#[test]
fn thin_volumes_have_rays_too() {
    for size in [[2, 2, 2], [3, 40, 2], [2, 17, 33], [90, 3, 4]] {
        for family in LIFTED {
            let volume = volume(family, size, |[x, y, z]| ((x * 7 + y * 5 + z * 3) % 11) as f32);
            let tf = curve(&[(2.0, 0.0), (10.0, 0.5)]);
            let levels = 1..=volume.plan().n_levels().min(3);
            for level in levels.filter(|level| LevelGrid::new(volume.plan(), *level).is_some()) {
                let filtered =
                    spread_of(&volume, level).filter(&tf, [1.0; 3], Some(&Shading::default()), true).unwrap();
                let opacities = (0..=10).map(|value| filtered.opacity(f64::from(value)));
                assert!(opacities.clone().all(|o| (0.0..=1.0).contains(&o)), "{family:?} {size:?}");
                assert!(opacities.clone().any(|o| o > 0.0), "{family:?} {size:?}");
            }
        }
    }
}
