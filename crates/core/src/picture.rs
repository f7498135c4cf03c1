//! Picture: premultiplied RGBA (associated alpha), depth, and the values of projections.

use crate::options::Shading;

/// A float picture: red, green, blue associated with (multiplied by) opacity, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// `height · width` associated RGBA pixels.
    pub rgba: Vec<[f32; 4]>,
    /// World distance along the ray at opacity ½, or at the extreme of a projection, NaN where there is none; from the
    /// eye, or from the camera's plane for parallel rays.
    pub depth: Option<Vec<f32>>,
    /// For projections: the projected value, in sample units (`Sum`: times world length), NaN outside the volume.
    pub value: Option<Vec<f32>>,
}

impl Picture {
    /// Finishes a picture of rays: compresses highlights from the shading's shoulder on, then puts the background
    /// behind. `shading`: `None` leaves colours as they are.
    pub fn finish(&mut self, shading: Option<&Shading>, background: Option<[f32; 4]>) {
        if let Some(shading) = shading.filter(|shading| shading.shoulder < 1.0) {
            self.compress_highlights(shading.shoulder);
        }
        if let Some(background) = background {
            self.over_background(background);
        }
    }

    /// Compresses highlights: a colour `x` brighter than the shoulder `s` becomes `s + (x − s) / (1 + (x − s) / (1 −
    /// s))`, which approaches 1 and has no kink, so that highlights keep their form. `x` is unassociated: the colour of
    /// the covered part of the pixel, without the background.
    fn compress_highlights(&mut self, shoulder: f32) {
        for [r, g, b, alpha] in &mut self.rgba {
            let (first, room) = (shoulder * *alpha, ((1.0 - shoulder) * *alpha).max(f32::MIN_POSITIVE));
            for color in [r, g, b] {
                let above = *color - first;
                if above > 0.0 {
                    *color = first + above / (1.0 + above / room);
                }
            }
        }
    }

    /// Puts an unassociated `background` behind the picture (Porter & Duff 1984, over).
    pub fn over_background(&mut self, background: [f32; 4]) {
        let [r, g, b, a] = background;
        let back = [r * a, g * a, b * a, a];
        for pixel in &mut self.rgba {
            let transmittance = 1.0 - pixel[3];
            for (front, back) in pixel.iter_mut().zip(back) {
                *front += transmittance * back;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finished(pixel: [f32; 4], shading: Option<&Shading>) -> [f32; 4] {
        let mut picture = Picture { width_px: 1, height_px: 1, rgba: vec![pixel], depth: None, value: None };
        picture.finish(shading, None);
        picture.rgba[0]
    }

    #[test]
    fn the_shoulder_compresses_what_is_bright_and_nothing_else() {
        let shading = Shading { shoulder: 0.75, ..Shading::headlight() };
        let of = |x: f32| finished([x, 0.0, 0.0, 1.0], Some(&shading))[0];
        assert_eq!([of(0.2), of(0.75)], [0.2, 0.75]);
        assert!((of(1.0) - 0.875).abs() < 1e-6, "half of the room where twice as much is above");
        let bright: Vec<f32> = (0..200).map(|n| of(0.1 * n as f32)).collect();
        assert!(bright.is_sorted() && bright[199] < 1.0);
        // A veil is compressed like an opaque pixel, and colours that are not shaded stay as they were.
        assert!((finished([0.5, 0.0, 0.0, 0.5], Some(&shading))[0] - 0.4375).abs() < 1e-6);
        assert_eq!(finished([1.0, 0.9, 0.0, 1.0], None), [1.0, 0.9, 0.0, 1.0]);
        assert_eq!(finished([1.3, 0.9, 0.0, 1.0], Some(&Shading::headlight())), [1.3, 0.9, 0.0, 1.0]);
        assert_eq!(finished([0.0; 4], Some(&shading)), [0.0; 4]);
    }
}
