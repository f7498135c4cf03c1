//! Picture comparison.

/// Peak signal-to-noise ratio in dB of the colours, peak 1.
pub fn psnr_db(got: &[[f32; 4]], want: &[[f32; 4]]) -> f64 {
    assert_eq!(got.len(), want.len(), "pictures differ in size");
    let squared = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
    let sum: f64 = got.iter().zip(want).map(squared).sum();
    -10.0 * (sum / (3 * got.len()) as f64).log10()
}

/// Largest difference of any channel; infinite where one is not a number.
pub fn max_difference(got: &[[f32; 4]], want: &[[f32; 4]]) -> f32 {
    assert_eq!(got.len(), want.len(), "pictures differ in size");
    let pairs = got.as_flattened().iter().zip(want.as_flattened());
    pairs.map(|(a, b)| if (a - b).is_nan() { f32::INFINITY } else { (a - b).abs() }).fold(0.0, f32::max)
}

/// Mean of red, green and blue over the picture.
pub fn mean_brightness(rgba: &[[f32; 4]]) -> f64 {
    let sum: f64 = rgba.iter().map(|p| f64::from(p[0] + p[1] + p[2])).sum();
    sum / (3 * rgba.len()) as f64
}
