//! Cameras placed by what they show.

use glam::DVec3;
use wavesplat_core::{Camera, Composite, Facts, Result, Volume};
use wavesplat_look::{DataKind, FoundKind, HISTOGRAM_SAMPLES, Look, step_for};
use wavesplat_view::{FILLED, Fit, InView, Pose, SomeSamples, grid_corners, view_angles};

use crate::kind::{kind_of, natural_angles};
use crate::scene::{Scene, SceneLayer, SceneVolume};

/// Largest number of samples that are looked at to find what a look shows.
const N_SAMPLES_MAX: usize = 500_000;

/// Orthographic cameras around volumes and scenes, and their [`Pose`]s, which can be turned and written down; for
/// perspective and more see [`InView`].
///
/// ```
/// use wavesplat::glam::DAffine3;
/// use wavesplat::{Camera, ColorNode, Facts, OpacityNode, PlacedCamera, Samples, Scene, TransferFunction, Volume};
///
/// # fn main() -> wavesplat::Result<()> {
/// let samples: Vec<u8> = (0..20 * 20 * 20).map(|k| if k % 20 < 5 { 200 } else { 0 }).collect();
/// let volume = Volume::new("slab", Samples::U8(&samples), [20; 3], DAffine3::IDENTITY)?;
/// let from_the_left = Camera::orbit(&volume, 90.0, 0.0, 4.0 / 3.0)?;
/// assert!(from_the_left.position().x < 0.0);
///
/// let opacity = [(0.0, 0.0), (200.0, 0.5)].map(|(value, opacity)| OpacityNode { value, opacity });
/// let look = TransferFunction::new(opacity.to_vec(), vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None)?;
/// let around_the_slab = Camera::fit(&Scene::new(volume, look), &Facts::default(), 4.0 / 3.0)?;
/// # assert!(around_the_slab.projection() != from_the_left.projection());
/// # Ok(())
/// # }
/// ```
pub trait PlacedCamera: Sized {
    /// The camera on the orbit around a volume, degrees, as near as all of its box is in view in a picture of that
    /// ratio of width to height.
    ///
    /// # Errors
    ///
    /// If a number is not finite, or the ratio is out of range.
    fn orbit(volume: &Volume<'_>, azimuth_deg: f64, elevation_deg: f64, aspect: f64) -> Result<Self>;

    /// The camera of the view that suits a scene's first volume, as near as all that looks show fits into a picture of
    /// that ratio of width to height: the camera of pictures without one in Python and on the command line.
    ///
    /// `facts`: of the first volume; a patient is seen from the front. Volumes that are not in memory are in view as a
    /// whole.
    ///
    /// # Errors
    ///
    /// If the ratio is out of range.
    fn fit(scene: &Scene<'_>, facts: &Facts, aspect: f64) -> Result<Self> {
        Self::fit_as(scene, facts, (None, Composite::Over), aspect)
    }

    /// The same for a look: from its view, where it has one, and around what its operator shows.
    ///
    /// # Errors
    ///
    /// If there is no view of that name, or the ratio is out of range.
    fn fit_for(scene: &Scene<'_>, facts: &Facts, look: &Look, aspect: f64) -> Result<Self> {
        Self::fit_as(scene, facts, (look.view, look.composite), aspect)
    }

    /// The same for the name of a view, see [`VIEWS`](wavesplat_view::VIEWS), or `None` for the one that suits the volume,
    /// and an operator: a projection shows what its colours show, where it has no opacities.
    ///
    /// # Errors
    ///
    /// If there is no view of that name, or the ratio is out of range.
    fn fit_as(scene: &Scene<'_>, facts: &Facts, shown: (Option<&str>, Composite), aspect: f64) -> Result<Self>;
}

impl PlacedCamera for Camera {
    fn orbit(volume: &Volume<'_>, azimuth_deg: f64, elevation_deg: f64, aspect: f64) -> Result<Self> {
        Pose::orbit(volume, azimuth_deg, elevation_deg, aspect)?.camera()
    }

    fn fit_as(scene: &Scene<'_>, facts: &Facts, shown: (Option<&str>, Composite), aspect: f64) -> Result<Self> {
        Pose::fit_as(scene, facts, shown, aspect)?.camera()
    }
}

impl PlacedCamera for Pose {
    fn orbit(volume: &Volume<'_>, azimuth_deg: f64, elevation_deg: f64, aspect: f64) -> Result<Self> {
        let corners = grid_corners(volume.grid());
        InView::around(&corners).aspect(aspect).orbit(azimuth_deg, elevation_deg, Fit::View)
    }

    fn fit_as(
        scene: &Scene<'_>,
        facts: &Facts,
        (view, composite): (Option<&str>, Composite),
        aspect: f64,
    ) -> Result<Self> {
        let first = &scene.layers[0].volume;
        let found = || match first {
            SceneVolume::Samples(volume, _) => kind_of(volume, facts),
            // A kind that is neither calculated nor in doubt to be a patient's.
            _ => FoundKind { kind: DataKind::Ct, reason: String::new(), has_noise: true, has_few_bright: false },
        };
        let (azimuth, elevation) = match view {
            Some(name) => view_angles(name, facts.is_anatomical)?,
            None => natural_angles(first.grid(), facts, found),
        };
        let corners: Vec<DVec3> = scene.layers.iter().flat_map(|layer| grid_corners(layer.volume.grid())).collect();
        let points: Vec<DVec3> = scene.layers.iter().flat_map(|layer| shown_of(layer, composite)).collect();
        InView::around(&corners).points(&points).zoom(FILLED).aspect(aspect).orbit(azimuth, elevation, Fit::View)
    }
}

/// World positions around what the look of a layer shows.
fn shown_of(layer: &SceneLayer<'_>, composite: Composite) -> Vec<DVec3> {
    let grid = layer.volume.grid();
    let SceneVolume::Samples(volume, _) = &layer.volume else { return grid_corners(grid).to_vec() };
    let size = grid.size();
    // Every n-th sample, and of these every m-th from both ends to the middle, so that volumes that are stored the other
    // way round have the same places. Two steps, as other questions about a volume share the samples of the first.
    let fine = step_for(size.iter().product(), HISTOGRAM_SAMPLES);
    let thinned = size.map(|n| n.div_ceil(fine));
    let coarse = step_for(thinned.iter().product(), N_SAMPLES_MAX);
    let kept = |n: usize| (0..n).filter(|&k| k.min(n - 1 - k) % coarse == 0).map(|k| k * fine).collect::<Vec<_>>();
    let [xs, ys, zs] = thinned.map(kept);
    let (mut index, mut values) = (Vec::new(), Vec::new());
    for &z in &zs {
        for (&y, &x) in ys.iter().flat_map(|y| xs.iter().map(move |x| (y, x))) {
            let value = volume.samples().get((z * size[1] + y) * size[0] + x);
            if value.is_finite() {
                index.push(DVec3::new(x as f64, y as f64, z as f64));
                values.push(value);
            }
        }
    }
    let within = [DVec3::ZERO, grid.last_index()];
    let some = SomeSamples { index: &index, values: &values, step: (fine * coarse) as f64, within };
    let is_whole = grid.statistics().n_nonfinite == 0;
    let has_one_dimension = layer.transfer_function.function_2d().is_none();
    let shown =
        some.shown(has_one_dimension.then_some((&layer.transfer_function, composite.is_projection())), is_whole);
    shown.into_iter().map(|at| grid.world_from_index().transform_point3(at)).collect()
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use wavesplat_core::{ColorNode, OpacityNode, Projection, Samples, TransferFunction};

    use super::*;

    #[test]
    fn a_fit_frames_what_the_look_shows_and_an_orbit_the_whole_box() {
        let n = 40;
        let place = |k: usize| DVec3::new((k % n) as f64, (k / n % n) as f64, (k / (n * n)) as f64);
        let middle = DVec3::new(25.0, 20.0, 20.0);
        let samples: Vec<u8> = (0..n * n * n).map(|k| if place(k).distance(middle) < 6.5 { 200 } else { 0 }).collect();
        let volume = Volume::new("ball", Samples::U8(&samples), [n; 3], DAffine3::IDENTITY).unwrap();
        let opacity = [(0.0, 0.0), (200.0, 0.5)].map(|(value, opacity)| OpacityNode { value, opacity });
        let look =
            TransferFunction::new(opacity.to_vec(), vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None).unwrap();
        let half = |camera: &Camera| match camera.projection() {
            Projection::Orthographic { parallel_scale } => parallel_scale,
            Projection::Perspective { .. } => f64::NAN,
        };
        let whole = Camera::orbit(&volume, 0.0, 0.0, 1.0).unwrap();
        assert!((half(&whole) - 19.5).abs() < 1e-9);
        let ball = Camera::fit(&Scene::new(volume, look), &Facts::default(), 1.0).unwrap();
        assert!((6.0..9.5).contains(&(half(&ball) * FILLED)), "{}", half(&ball));
        let ray = ball.ray(32.0, 32.0, 64, 64);
        let ahead = (ray.origin - middle).cross(ray.direction.normalize());
        assert!(ahead.length() < 1e-9, "the ball is in the middle of the picture");
    }
}
