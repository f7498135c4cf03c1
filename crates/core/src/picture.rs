//! Picture: premultiplied RGBA (associated alpha), depth, and the values of projections.

/// A float picture: red, green, blue associated with (multiplied by) opacity, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// `height · width` associated RGBA pixels.
    pub rgba: Vec<[f32; 4]>,
    /// World distance along the ray at opacity ½, NaN where it is never reached; from the eye, or from the camera's
    /// plane for parallel rays.
    pub depth: Option<Vec<f32>>,
    /// For projections: the projected value, in sample units (`Sum`: times world length), NaN outside the volume.
    pub value: Option<Vec<f32>>,
}

impl Picture {
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
