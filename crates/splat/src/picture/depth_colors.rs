//! Hues of a projection by the place of its extreme, after the warp.
//!
//! A pixel becomes `b · hue(t)` with opacity `b`: `t` is the place of its extreme, 0 at the nearest (or lowest) and 1 at
//! the farthest (or highest) point of what is drawn, and `b` its lightness in the transfer function, as a share of the
//! lightest colour there. So dark matter is clear, and the picture reads the same on black and on white.

use glam::DVec3;
use wavesplat_core::{Camera, DepthColors, Grid, Picture, TransferFunction};

use crate::view::depth_cue::extent;

/// Colours by depth with the way that they are spread over.
#[derive(Clone, Debug)]
pub struct PlacedDepthColors {
    colors: DepthColors,
    /// Unit vector along which places are measured.
    direction: DVec3,
    /// Places of the first and of the last colour along it: world lengths from the camera's position, or world
    /// coordinates along an axis.
    pub range: [f64; 2],
}

impl PlacedDepthColors {
    /// Spreads colours over the box `[lo, hi]`, index positions.
    pub fn new(colors: &DepthColors, camera: &Camera, grid: &Grid, corners: [DVec3; 2]) -> Self {
        let direction = colors.axis.map_or(camera.forward(), DVec3::normalize);
        let mut range = extent(direction, camera, grid, corners);
        if colors.axis.is_some() {
            // From distances to coordinates.
            range = range.map(|place| place + direction.dot(camera.position()));
        }
        Self { colors: colors.clone(), direction, range }
    }

    /// Colours a projection whose depth is in parameters of the rays.
    pub fn color(&self, picture: &mut Picture, camera: &Camera, tf: &TransferFunction) {
        let Some(depth) = &picture.depth else { return };
        let size = [picture.width_px, picture.height_px];
        let lightest = tf.color_nodes().iter().map(|node| lightness(node.rgb)).fold(f64::MIN_POSITIVE, f64::max);
        let origin = if self.colors.axis.is_some() { DVec3::ZERO } else { camera.position() };
        let length = (self.range[1] - self.range[0]).max(f64::MIN_POSITIVE);
        for (i, rgba) in picture.rgba.iter_mut().enumerate() {
            let [r, g, b, alpha] = rgba.map(f64::from);
            if alpha <= 0.0 {
                continue;
            }
            let [x, y] = [i % size[0], i / size[0]];
            let ray = camera.ray(x as f64 + 0.5, y as f64 + 0.5, size[0], size[1]);
            let parameter = place_near(depth, size, [x, y]);
            let position = ray.origin + f64::from(parameter) * ray.direction;
            let share = (self.direction.dot(position - origin) - self.range[0]) / length;
            let bright = (lightness([r, g, b]) / lightest).min(1.0) as f32;
            // A pixel of which no neighbour has a place is nearer than all others.
            let hue = self.colors.at(if share.is_nan() { 0.0 } else { share });
            *rgba = [hue[0] * bright, hue[1] * bright, hue[2] * bright, bright];
        }
    }
}

/// Weight of a colour's light in the eye (ITU-R BT.709).
fn lightness([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The depth of a pixel, or the mean of those around it that have one: pixels at the rim are covered in part, and their
/// middle can miss the volume.
fn place_near(depth: &[f32], [n_x, n_y]: [usize; 2], [x, y]: [usize; 2]) -> f32 {
    let own = depth[y * n_x + x];
    if !own.is_nan() {
        return own;
    }
    let (mut sum, mut n) = (0.0, 0.0);
    for row in y.saturating_sub(1)..(y + 2).min(n_y) {
        for near in &depth[row * n_x + x.saturating_sub(1)..row * n_x + (x + 2).min(n_x)] {
            if !near.is_nan() {
                (sum, n) = (sum + near, n + 1.0);
            }
        }
    }
    sum / n
}
