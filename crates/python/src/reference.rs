//! Bindings of the slow reference renderers that the fast one is compared with.

use numpy::PyArray3;
use pyo3::prelude::*;
use wavesplat::Kernel;
use wavesplat_study::RenderOptions;
use wavesplat_study::reference;
use wavesplat_study::reference::color_field::CastColor;
use wavesplat_study::reference::raycast::{CastLayer, RaycastOptions, raycast_layers};

use crate::arguments::{PyCamera, PyShading, PyTransferFunction, Triple};
use crate::errors::to_py;
use crate::labels::PyLabels;
use crate::progress::PyProgress;
use crate::rendering::{Corners, clip_planes, crop, image};
use crate::shapes::PyShapes;
use crate::volume::{PyVolume, with_samples_of_all};

/// A field that colours a layer, and its transfer function.
type PyCastColor<'py> = (PyRef<'py, PyVolume>, PyRef<'py, PyTransferFunction>);

/// A volume, its transfer function, its shading, and the field that colours it.
type PyCastLayer<'py> =
    (PyRef<'py, PyVolume>, PyRef<'py, PyTransferFunction>, Option<PyRef<'py, PyShading>>, Option<PyCastColor<'py>>);

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (layers, camera, *, labels, width, height, kernel, step, rays_per_pixel,
    crop_index, crop_world, clip_planes, shapes, threads))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands layers over by value")]
pub fn raycast<'py>(
    py: Python<'py>,
    layers: Vec<PyCastLayer<'py>>,
    camera: &PyCamera,
    labels: Option<&PyLabels>,
    width: usize,
    height: usize,
    kernel: &str,
    step: f64,
    rays_per_pixel: usize,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    shapes: Option<&PyShapes>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        crop: crop(crop_index, crop_world),
        clip_planes: self::clip_planes(clip_planes),
        shapes: shapes.map(|shapes| shapes.0.clone()).unwrap_or_default(),
        n_threads: threads,
        ..RenderOptions::default()
    };
    let sampling = RaycastOptions { kernel: Kernel::from_name(kernel).map_err(to_py)?, step, rays_per_pixel };
    let colors = layers.iter().filter_map(|(.., color)| color.as_ref()).map(|(volume, _)| &**volume);
    let volumes: Vec<&PyVolume> = layers.iter().map(|(volume, ..)| &**volume).chain(colors).collect();
    let picture = with_samples_of_all(py, &volumes, &mut |volumes| {
        // Behind the layers' volumes are the volumes of the fields that colour layers.
        let (volumes, of_colors) = volumes.split_at(layers.len());
        let mut of_colors = of_colors.iter();
        let cast: Vec<CastLayer> = volumes
            .iter()
            .zip(&layers)
            .enumerate()
            .map(|(k, (volume, (_, tf, shading, color)))| CastLayer {
                volume,
                transfer_function: &tf.0,
                shading: shading.as_ref().map(|shading| &shading.0),
                labels: labels.filter(|_| k == 0).map(|labels| &*labels.0),
                color: color.as_ref().and_then(|(_, tf)| {
                    let volume = of_colors.next()?;
                    Some(CastColor { volume, transfer_function: &tf.0 })
                }),
            })
            .collect();
        let progress = PyProgress::new(None);
        let camera = &camera.0;
        progress.watch(py, || raycast_layers(&cast, camera, &options, sampling, &progress))?.map_err(to_py)
    })?;
    image(py, picture)
}

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, width, height, kernel, shading, sheets_per_slice, threads))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
pub fn splat_literal<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    width: usize,
    height: usize,
    kernel: &str,
    shading: Option<&PyShading>,
    sheets_per_slice: f64,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let kernel = Kernel::from_name(kernel).map_err(to_py)?;
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        shading: shading.map(|s| s.0.clone()),
        sheets_per_slice,
        oversampling: 1.0,
        n_threads: threads,
        ..RenderOptions::default()
    };
    let picture = volume.with_volume(py, |v| {
        let (tf, camera) = (&transfer_function.0, &camera.0);
        let progress = PyProgress::new(None);
        let draw = || reference::original::image(v, kernel, tf, camera, &options, &progress);
        progress.watch(py, draw)?.map_err(to_py)
    })?;
    image(py, picture)
}
