//! `wavesplat._native`: converts, releases the interpreter lock, calls, maps errors. No algorithm lives here.

mod arguments;
mod automatic;
mod curves;
mod documents;
mod errors;
mod gpu;
mod kinds;
mod labels;
mod lazy;
mod length_units;
mod look;
mod over_others;
mod progress;
mod reference;
mod rendering;
mod shapes;
mod stream;
mod study;
mod view;
mod volume;
mod wavelet;

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

/// Gives a process made by forking, as by `multiprocessing` on Linux, threads of its own.
#[pyfunction]
fn after_fork() {
    wavesplat::after_fork();
}

/// The compiled half of the Python package; its contract is `_native.pyi`.
#[pymodule]
mod _native {
    use super::{
        Bound, IntoPyDict, PyAnyMethods, PyDict, PyDictMethods, PyImportError, PyModule, PyModuleMethods, PyResult,
        PyTuple, after_fork, wrap_pyfunction,
    };
    #[pymodule_export]
    use crate::arguments::{PyAblation, PyCamera, PyShading, PyTransferFunction};
    #[pymodule_export]
    use crate::automatic::{
        attenuation, automatic_look, channel_window, greys_of_pixels, greys_of_projection, is_block, is_whole_range,
        look_refused,
    };
    #[pymodule_export]
    use crate::curves::{bent, exposed, in_window, lightened, opaque_after, ramp, ramp_of_part, window_of};
    #[pymodule_export]
    use crate::documents::{
        camera_fields, check_material, check_part, check_settings, check_state, check_values, checked_view,
        curves_fields, is_number, is_point, lights_of, look_texts, materials_fields, patched, table_fields,
    };
    #[pymodule_export]
    use crate::gpu::{gpu_adapters, gpu_check, gpu_count, gpu_memory, gpu_settle};
    #[pymodule_export]
    use crate::kinds::{
        kind_of_data, looks_like_hounsfield, otsu, otsu_of_scan, robust_range, step_for, stored_offset,
    };
    #[pymodule_export]
    use crate::labels::PyLabels;
    #[pymodule_export]
    use crate::lazy::{PyLazyVolume, PySurvey, light_step, samples_for};
    #[pymodule_export]
    use crate::length_units::{in_one_unit, reported_unit, unit_factor, unit_guesses, unit_metres, unit_name};
    #[pymodule_export]
    use crate::look::{
        channel_color, distinct_colors, label_color, map_colors, map_is_diverging, map_nodes, plain_name, presets,
        rise_nodes, scale_nodes, slicer_presets,
    };
    #[pymodule_export]
    use crate::over_others::{channel_light, cleared, has_two_signs, map_over};
    #[pymodule_export]
    use crate::reference::{raycast, splat_literal};
    #[pymodule_export]
    use crate::rendering::{encode_png, plane, quality_settings, render, rgb_bytes, straight_bytes};
    #[pymodule_export]
    use crate::shapes::{PyShapes, normals_of_faces};
    #[pymodule_export]
    use crate::stream::{PyBlockState, PyStream, smallest_budget};
    #[pymodule_export]
    use crate::study::{render_standard, splat_ablated};
    #[pymodule_export]
    use crate::view::{
        PyCameraPath, PyFace, PyStack, camera_all_around, camera_axes, camera_in_perspective, camera_project,
        camera_turned, camera_unproject, camera_widened, camera_within, camera_zoomed, cameras_evenly, eye_of,
        eyes_cut, eyes_settled, fit_view, orbit_axes, shown_positions, sin_cos_deg, turn_angles, turn_around,
        turn_in_place, turn_in_view, view_angles,
    };
    #[pymodule_export]
    use crate::volume::PyVolume;
    #[pymodule_export]
    use crate::wavelet::{PyDecodedVolume, PyWaveletVolume};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        if let Ok(name) = std::env::var("WAVESPLAT_SIMD") {
            let wrong = |why: String| PyImportError::new_err(format!("WAVESPLAT_SIMD: {why}; unset it for the widest"));
            wavesplat::use_simd(&name).map_err(wrong)?;
        }
        let os = module.py().import("os")?;
        if os.hasattr("register_at_fork")? {
            let hooks = PyDict::new(module.py());
            hooks.set_item("after_in_child", wrap_pyfunction!(after_fork, module)?)?;
            os.call_method("register_at_fork", (), Some(&hooks))?;
        }
        module.add("SHOWS_THROUGH", wavesplat::SHOWS_THROUGH)?;
        let kinds = wavesplat::look::MODALITIES.map(|(modality, kind)| (modality, kind.name()));
        module.add("KINDS_OF_MODALITIES", kinds.into_py_dict(module.py())?)?;
        module.add("QUANTITIES", PyTuple::new(module.py(), wavesplat::look::quantities::ALL)?)?;
        module.add("HOUNSFIELD_ATTENUATION", wavesplat::look::HOUNSFIELD_ATTENUATION)?;
        module.add("SOLID_LIGHT", wavesplat::look::SOLID_LIGHT.into_py_dict(module.py())?)?;
        module.add("FARTHEST", wavesplat::view::FARTHEST)?;
        module.add("FILLED", wavesplat::view::FILLED)?;
        let most = {
            use wavesplat::look::{HISTOGRAM_SAMPLES, KIND_SAMPLES, UNIT_SAMPLES};
            (HISTOGRAM_SAMPLES, KIND_SAMPLES, UNIT_SAMPLES)
        };
        module.add("N_SAMPLES_MOST", most)?;
        module.add("VIEW_ANGLE", wavesplat::view::VIEW_ANGLE_DEG)?;
        module.add("CHANNEL_COLORS", wavesplat::look::channel_colors::CHANNEL_COLORS.map(<(f64, f64, f64)>::from))?;
        let in_space = wavesplat::look::channel_colors::CHANNEL_COLORS_IN_SPACE.map(<(f64, f64, f64)>::from);
        module.add("CHANNEL_COLORS_IN_SPACE", in_space)?;
        module.add("DARKEST", wavesplat::look::channel_ramp::DARKEST)?;
        module.add("FULL_COLOR", wavesplat::look::channel_ramp::FULL_COLOR)?;
        module.add("MAP_NODES", wavesplat::look::colormaps::N_NODES)?;
        let windows = wavesplat::look::ct_windows::CT_WINDOWS.map(|(name, window)| (name, <(f64, f64)>::from(window)));
        module.add("CT_WINDOWS", windows.into_py_dict(module.py())?)?;
        module.add("PRESET_GROUPS", wavesplat::look::presets::GROUPS.into_py_dict(module.py())?)?;
        module.add("SLICER_PREFIX", wavesplat::look::presets::SLICER_PREFIX)?;
        module.add("SCALES", wavesplat::look::scale::Scale::NAMES.map(|(name, scale)| (name, scale.is_absolute())))?;
        let rises = wavesplat::look::colormaps::Rise::NAMED.map(|(name, _)| name);
        module.add("RISES", rises)?;
        let views = wavesplat::view::VIEWS.map(|(name, azimuth, elevation)| (name, (azimuth, elevation)));
        module.add("VIEWS", views.into_py_dict(module.py())?)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
