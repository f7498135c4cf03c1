//! Pictures of floats as bytes, for files and screens.

/// Number 0..1 as one of 256 levels; halves are rounded up.
#[inline(always)]
fn level(share: f32) -> u8 {
    let scaled = share * 255.0;
    // Adding a half and truncating would round up numbers a little below a half; the difference from an integer is
    // exact.
    let whole = scaled as u8;
    whole + u8::from(scaled - f32::from(whole) >= 0.5)
}

/// Premultiplied RGBA as straight bytes: colours not multiplied by opacity, and opacity. Colours are used as given.
pub fn straight_bytes(rgba: &[f32]) -> Vec<u8> {
    let mut bytes = vec![0; rgba.len()];
    for (pixel, out) in rgba.chunks_exact(4).zip(bytes.chunks_exact_mut(4)) {
        let alpha = pixel[3].clamp(0.0, 1.0);
        let divisor = if alpha > 0.0 { alpha } else { f32::INFINITY };
        for c in 0..3 {
            out[c] = level((pixel[c] / divisor).clamp(0.0, 1.0));
        }
        out[3] = level(alpha);
    }
    bytes
}

/// Premultiplied RGBA over an opaque colour, as bytes of red, green and blue.
pub fn rgb_bytes(rgba: &[f32], paper: [f32; 3]) -> Vec<u8> {
    let mut bytes = vec![0; rgba.len() / 4 * 3];
    for (pixel, out) in rgba.chunks_exact(4).zip(bytes.chunks_exact_mut(3)) {
        let clear = 1.0 - pixel[3].clamp(0.0, 1.0);
        for c in 0..3 {
            out[c] = level((pixel[c] + clear * paper[c]).clamp(0.0, 1.0));
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_up_and_what_is_less_does_not() {
        assert_eq!([0.5 / 255.0, 1.5 / 255.0, 1.0, 0.0].map(level), [1, 2, 255, 0]);
        assert_eq!(level(0.499_999_97 / 255.0), 0);
        for n in 0..=255_u8 {
            assert_eq!(level(f32::from(n) / 255.0), n);
        }
    }

    #[test]
    fn alpha_becomes_straight_and_colours_stay_as_given() {
        let rgba = [0.25, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.5, f32::NAN, 1.0];
        assert_eq!(straight_bytes(&rgba), [128, 0, 255, 128, 0, 0, 0, 0, 255, 255, 255, 255, 255, 128, 0, 255]);
    }

    #[test]
    fn paper_shows_where_a_picture_is_clear() {
        let rgba = [0.25, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0];
        assert_eq!(rgb_bytes(&rgba, [1.0, 0.5, 0.0]), [191, 64, 128, 255, 128, 0, 255, 0, 0]);
    }
}
