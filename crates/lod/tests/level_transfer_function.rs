//! Transfer functions of coarser levels: mean opacities, colours, and trimming of rare values.

mod pyramid;

use pyramid::{BUDGET, LIFTED, coarse_values, curve, histogram_of, level_of, volume};
use wavesplat_core::{ColorNode, OpacityNode, Shading, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_wavelet::{CoefficientDecoder, WaveletFamily};

/// Mean opacity of a length over positions with these values.
fn mean_opacity(tf: &TransferFunction, values: &[f64], length: f64) -> f64 {
    let opacity = |value: &f64| -(length * (-tf.opacity(*value)).ln_1p()).exp_m1();
    values.iter().map(opacity).sum::<f64>() / values.len() as f64
}

/// Walls one sample thin, with values of 80 to 120, in a space of 0 to 8: no value is frequent enough to dominate its
/// bin.
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
        let fine: Vec<f64> =
            CoefficientDecoder::new(volume.clone(), 0, &[]).unwrap().all().into_iter().map(f64::from).collect();
        for level in 1..4 {
            let (histogram, coarse) = (histogram_of(&volume, level), coarse_values(&volume, level, 1));
            for tf in [&hard, &soft] {
                for length in [0.5, 1.0, 2.0] {
                    let want = mean_opacity(tf, &fine, length);
                    let filtered = histogram.average(tf, length).unwrap();
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
    let volume = volume(WaveletFamily::Cdf53, [80, 40, 40], walls);
    let filtered = histogram_of(&volume, 2).average(&curve(&[(60.0, 0.0), (60.0, 0.6)]), 1.0).unwrap();
    let seen: Vec<f64> = coarse_values(&volume, 2, 1).into_iter().filter(|d| filtered.opacity(*d) > 0.01).collect();
    let n_low = seen.iter().filter(|d| **d < 30.0).count();
    assert!(n_low > 1000, "values that are blue themselves stand for red walls: {n_low}");
    // Next to an empty bin, a colour is mixed with the colour of the value itself.
    let n_mixed = seen.iter().filter(|d| filtered.color(**d)[0] < 0.99).count();
    assert!(n_mixed < seen.len() / 100, "{n_mixed} of {}", seen.len());
}

/// A few samples whose coarse values many others share are no reason to draw all of these, unless there is nothing
/// else.
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
                let (histogram, coarse) = (histogram_of(&volume, level), coarse_values(&volume, level, 1));
                let of_grains = coarse.iter().filter(|d| **d < 50.0);
                [histogram.average(&step, 1.0), histogram.filter(&step, [1.0; 3], None, true)].map(|tf| {
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

/// Bars with sharp edges lose highlights on a level, where the edges are rounder.
#[test]
fn what_is_opaque_gets_lost_light_back_as_color() {
    let is_bar = |[x, y, z]: [usize; 3]| (x % 16 < 8) ^ (y % 16 < 8) ^ (z % 16 < 8);
    let volume = volume(WaveletFamily::Cdf97, [64; 3], |at| if is_bar(at) { 200.0 } else { 0.0 });
    let opacity = [(99.0, 0.0), (100.0, 1.0)].map(|(value, opacity)| OpacityNode { value, opacity }).to_vec();
    let color = vec![ColorNode { value: 0.0, rgb: [0.5, 0.995, 0.0] }];
    let step = TransferFunction::new(opacity, color, Some(1.0)).unwrap();
    let shiny = Shading { ambient: 0.1, diffuse: 0.7, specular: 0.2, ..Shading::headlight() };
    let histogram = histogram_of(&volume, 1);
    let colors = |shading| histogram.filter(&step, [1.0; 3], shading, true).unwrap().color(200.0);
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
            let histogram = histogram_of(&ramp, level);
            let filtered = histogram.average(&linear, 2.0).unwrap();
            // Away from the mirrored ends; half a bin of 512 is 0.1 %.
            for value in [16.0, 24.3, 32.0, 47.9] {
                let (got, want) = (filtered.opacity(value), linear.opacity(value));
                assert!((got - want).abs() < 0.01, "{family:?} level {level} at {value}: {got} {want}");
            }
        }
    }
}

/// A peak thinner than a bin has the weight of its width on a level, wherever it lies in its bin.
#[test]
fn peaks_thinner_than_a_bin_keep_their_weight() {
    let even = volume(WaveletFamily::Haar, [64, 40, 40], |[x, y, z]| x as f32 + y as f32 / 40.0 + z as f32 / 1600.0);
    let histogram = histogram_of(&even, 1);
    for (k, half_width) in [0.03, 0.01, 0.002].into_iter().cycle().take(12).enumerate() {
        let at = 30.0 + 0.0171 * k as f64;
        let tf = curve(&[(at - half_width, 0.0), (at, 0.8), (at + half_width, 0.0)]);
        let filtered = histogram.average(&tf, 1.0).unwrap();
        let nodes = filtered.opacity_nodes();
        let weight: f64 =
            nodes.windows(2).map(|n| 0.5 * (n[0].opacity + n[1].opacity) * (n[1].value - n[0].value)).sum();
        assert!((weight / (0.8 * half_width) - 1.0).abs() < 0.1, "{at} {half_width}: {weight}");
    }
}

#[test]
fn a_constant_volume_keeps_its_function() {
    let tf = curve(&[(0.0, 0.1), (100.0, 0.9)]);
    let constant = volume(WaveletFamily::Cdf97, [20, 21, 22], |_| 7.0);
    let (grid, coarse) = level_of(&constant, 1);
    let fine = CoefficientDecoder::new(constant.clone(), 0, &[]).unwrap();
    for range in [[7.0, 7.0], fine.range().map(f64::from)] {
        let histogram = LevelHistogram::new(&fine, &coarse, &grid, [1.0; 3], range, BUDGET);
        let (averaged, filtered) =
            (histogram.average(&tf, 1.5).unwrap(), histogram.filter(&tf, [1.0; 3], None, true).unwrap());
        assert!((averaged.opacity(7.0) - tf.opacity(7.0)).abs() < 1e-4);
        assert!((filtered.opacity(7.0) / tf.opacity(7.0) - 1.0).abs() < 0.01);
    }
}

#[test]
fn what_is_opaque_everywhere_stays_opaque_and_what_is_clear_stays_clear() {
    let halves = volume(WaveletFamily::Haar, [64, 40, 40], |[x, ..]| if x < 32 { 0.0 } else { 100.0 });
    let step = curve(&[(50.0, 0.0), (50.0, 1.0)]);
    let opaque = curve(&[(0.0, 1.0)]);
    for level in 1..4 {
        let histogram = histogram_of(&halves, level);
        for length in [0.01, 1.0, 2.0] {
            let filtered = histogram.average(&step, length).unwrap();
            assert!(filtered.opacity(100.0) == 1.0 && filtered.opacity(0.0) == 0.0, "level {level} length {length}");
            let filtered = histogram.average(&opaque, length).unwrap();
            assert!((0..=100).all(|value| filtered.opacity(f64::from(value)) == 1.0), "level {level} length {length}");
        }
        let shading = Some(&Shading::headlight());
        let filtered = histogram.filter(&step, [0.3, 1.0, 2.0], shading, true).unwrap();
        assert!(filtered.opacity(100.0) == 1.0 && filtered.opacity(0.0) == 0.0, "level {level}");
        let filtered = histogram.filter(&opaque, [0.3, 1.0, 2.0], shading, true).unwrap();
        assert!((0..=100).all(|value| filtered.opacity(f64::from(value)) == 1.0), "level {level}");
        // A clear function has no brightness to match.
        let clear = curve(&[(0.0, 0.0)]);
        assert_eq!(histogram.filter(&clear, [1.0; 3], shading, true).unwrap().opacity(50.0), 0.0);
    }
}
