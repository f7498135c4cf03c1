//! Named views, orbits, fits, turns and paths of cameras, eyes and panoramas; see `_native.pyi`.

use glam::{DAffine3, DMat3, DVec3};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use wavesplat::view::{
    self, Axes, CameraPath, Eye, Face, Fit, InView, Lens, N_TURNS, Pose, SomeSamples, Stack, Turn, TwoEyes,
};

use crate::arguments::{PyTransferFunction, Triple, rows, vector};
use crate::errors::to_py;

/// Position, focal point and up, then `parallel_scale` or `view_angle`.
type Fields = (Triple, Triple, Triple, Option<f64>, Option<f64>);
type PointArray<'py> = PyReadonlyArray2<'py, f64>;

fn triple(v: DVec3) -> Triple {
    v.into()
}

fn pose((position, focal_point, view_up, parallel_scale, view_angle): Fields) -> Pose {
    let lens = match view_angle {
        Some(angle) => Lens::ViewAngleDeg(angle),
        None => Lens::ParallelScale(parallel_scale.unwrap_or(0.0)),
    };
    Pose { position: vector(position), focal_point: vector(focal_point), view_up: vector(view_up), lens }
}

fn fields(pose: &Pose) -> Fields {
    let (parallel_scale, view_angle) = match pose.lens {
        Lens::ParallelScale(scale) => (Some(scale), None),
        Lens::ViewAngleDeg(angle) => (None, Some(angle)),
    };
    (triple(pose.position), triple(pose.focal_point), triple(pose.view_up), parallel_scale, view_angle)
}

fn points(rows: &PointArray<'_>) -> Vec<DVec3> {
    rows.as_array().rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect()
}

fn axes(rows: &PointArray<'_>) -> Axes {
    let [right, up, back] = points(rows)[..] else { unreachable!("three rows") };
    Axes { right, up, back }
}

fn rows_of_axes(py: Python<'_>, Axes { right, up, back }: Axes) -> Bound<'_, PyArray2<f64>> {
    rows(py, &[right, up, back].map(|v| v.to_array()))
}

#[pyfunction]
pub fn sin_cos_deg(angle: f64) -> (f64, f64) {
    view::sin_cos_deg(angle)
}

#[pyfunction]
pub fn view_angles(name: &str, is_anatomical: bool) -> PyResult<(f64, f64)> {
    view::view_angles(name, is_anatomical).map_err(to_py)
}

#[pyfunction]
pub fn orbit_axes(py: Python<'_>, azimuth: f64, elevation: f64) -> Bound<'_, PyArray2<f64>> {
    rows_of_axes(py, view::orbit_axes(azimuth, elevation))
}

#[pyfunction]
pub fn camera_axes(py: Python<'_>, camera: Fields) -> Bound<'_, PyArray2<f64>> {
    rows_of_axes(py, pose(camera).axes())
}

#[pyfunction]
pub fn camera_turned(camera: Fields, azimuth: f64, elevation: f64, roll: f64) -> Fields {
    fields(&pose(camera).turned(azimuth, elevation, roll))
}

#[pyfunction]
pub fn camera_zoomed(camera: Fields, factor: f64) -> PyResult<Fields> {
    pose(camera).zoomed(factor).map(|pose| fields(&pose)).map_err(to_py)
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn camera_widened(camera: Fields, shown: PointArray<'_>, zoom: f64, aspect: f64) -> Fields {
    fields(&pose(camera).widened(&points(&shown), zoom, aspect))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn camera_project<'py>(
    py: Python<'py>,
    camera: Fields,
    shown: PointArray<'py>,
    size: [usize; 2],
) -> (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>) {
    let (places, depths) = pose(camera).project(&points(&shown), size);
    (rows(py, &places), PyArray1::from_vec(py, depths))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn camera_unproject<'py>(
    py: Python<'py>,
    camera: Fields,
    places: PointArray<'py>,
    depths: PyReadonlyArray1<'py, f64>,
    size: [usize; 2],
) -> Bound<'py, PyArray2<f64>> {
    let places: Vec<[f64; 2]> = places.as_array().rows().into_iter().map(|row| [row[0], row[1]]).collect();
    let found = pose(camera).unproject(&places, &depths.as_array().to_vec(), size);
    rows(py, &found.into_iter().map(|point| point.to_array()).collect::<Vec<_>>())
}

fn framing<'a>(
    corners: &'a [DVec3],
    points: Option<&'a [DVec3]>,
    zoom: f64,
    view_angle: Option<f64>,
    aspect: f64,
) -> InView<'a> {
    let mut framing = InView::around(corners).zoom(zoom).aspect(aspect);
    if let Some(points) = points {
        framing = framing.points(points);
    }
    view_angle.map_or(framing, |angle| framing.perspective(angle))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn fit_view(
    seen_from: PointArray<'_>,
    corners: PointArray<'_>,
    shown: Option<PointArray<'_>>,
    zoom: f64,
    view_angle: Option<f64>,
    aspect: f64,
    is_turn: bool,
) -> PyResult<Fields> {
    let (corners, shown) = (points(&corners), shown.as_ref().map(points));
    let fit = if is_turn { Fit::Turn } else { Fit::View };
    let framing = framing(&corners, shown.as_deref(), zoom, view_angle, aspect);
    framing.place(&axes(&seen_from), fit).map(|pose| fields(&pose)).map_err(to_py)
}

#[pyfunction]
pub fn camera_in_perspective(camera: Fields) -> Fields {
    fields(&pose(camera).in_perspective())
}

#[pyfunction]
pub fn camera_all_around(camera: Fields) -> Fields {
    fields(&pose(camera).all_around())
}

#[pyfunction]
pub fn camera_within(camera: Fields, is_level: bool) -> Fields {
    fields(&pose(camera).within(is_level))
}

fn side(is_right: bool) -> Eye {
    if is_right { Eye::Right } else { Eye::Left }
}

fn two_eyes((distance, convergence): (f64, f64)) -> TwoEyes {
    TwoEyes { distance, convergence }
}

#[pyfunction]
pub fn eyes_settled(camera: Fields, distance: Option<f64>, convergence: Option<f64>) -> (f64, f64) {
    let eyes = TwoEyes::of(&pose(camera), distance, convergence);
    (eyes.distance, eyes.convergence)
}

#[pyfunction]
pub fn eyes_cut(eyes: (f64, f64), camera: Fields, height: usize) -> (usize, Option<f64>) {
    let (eyes, pose) = (two_eyes(eyes), pose(camera));
    (eyes.columns_cut(&pose, height), eyes.convergence_seen(&pose, height))
}

#[pyfunction]
pub fn eye_of(eyes: (f64, f64), camera: Fields, is_right: bool) -> Fields {
    fields(&two_eyes(eyes).eye(side(is_right), &pose(camera)))
}

#[pyclass(name = "Face", frozen)]
pub struct PyFace(Face);

type PlaceArrays<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl PyFace {
    #[staticmethod]
    fn of_cube() -> Vec<Self> {
        Face::of_cube().map(Self).into()
    }

    #[staticmethod]
    #[pyo3(signature = (n = N_TURNS))]
    fn of_turns(n: usize) -> Vec<Self> {
        Face::of_turns(n).into_iter().map(Self).collect()
    }

    fn camera(&self, camera: Fields, panorama: [usize; 2], eye: Option<(bool, f64)>) -> (Fields, [usize; 2]) {
        let eye = eye.map(|(is_right, distance)| (side(is_right), distance));
        (fields(&self.0.pose(&pose(camera), panorama, eye)), self.0.size(panorama))
    }

    fn places<'py>(&self, py: Python<'py>, panorama: [usize; 2]) -> PlaceArrays<'py> {
        let places = py.detach(|| self.0.places(panorama));
        let at: Vec<[f64; 2]> = places.iter().map(|place| place.at).collect();
        (
            PyArray1::from_iter(py, places.iter().map(|place| place.pixel)),
            PyArray1::from_iter(py, places.iter().map(|place| place.weight)),
            rows(py, &at),
        )
    }
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn shown_positions<'py>(
    py: Python<'py>,
    index: PointArray<'py>,
    values: PyReadonlyArray1<'py, f64>,
    step: f64,
    within: [Triple; 2],
    look: Option<(PyRef<'py, PyTransferFunction>, bool)>,
    is_whole: bool,
) -> Bound<'py, PyArray2<f64>> {
    let (index, values) = (points(&index), values.as_array().to_vec());
    let some = SomeSamples { index: &index, values: &values, step, within: within.map(vector) };
    let look = look.as_ref().map(|(function, is_opaque)| (&function.0, *is_opaque));
    let shown = some.shown(look, is_whole);
    rows(py, &shown.into_iter().map(|at| at.to_array()).collect::<Vec<_>>())
}

#[pyclass(name = "Stack", frozen)]
pub struct PyStack(Stack);

#[pymethods]
impl PyStack {
    #[new]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(size: [usize; 3], world_from_index: PointArray<'_>, spacing: Triple, sides: Triple) -> Self {
        let matrix = world_from_index.as_array();
        let column = |k| DVec3::new(matrix[[0, k]], matrix[[1, k]], matrix[[2, k]]);
        let world_from_index =
            DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) };
        Self(Stack { size, world_from_index, spacing: vector(spacing), sides: vector(sides) })
    }

    #[getter]
    fn is_thin(&self) -> bool {
        self.0.is_thin()
    }

    #[getter]
    fn is_placed_by_default(&self) -> bool {
        self.0.is_placed_by_default()
    }

    #[getter]
    fn axis_of_few_slices(&self) -> Option<usize> {
        self.0.axis_of_few_slices()
    }

    #[getter]
    fn axis_of_distant_slices(&self) -> Option<usize> {
        self.0.axis_of_distant_slices()
    }

    fn natural_view(
        &self,
        is_anatomical: bool,
        is_upright: &Bound<'_, PyAny>,
        is_of_patient: &Bound<'_, PyAny>,
    ) -> PyResult<(f64, f64)> {
        let ask = |question: &Bound<'_, PyAny>| question.call0()?.extract::<bool>();
        self.0.natural_view(is_anatomical, || ask(is_upright), || ask(is_of_patient))
    }
}

/// Axis, angle in degrees, and number of frames.
type TurnFields = (Triple, f64, usize);

fn turn((axis, degrees, frames): TurnFields) -> PyResult<Turn> {
    Turn::new(vector(axis), degrees, frames).map_err(to_py)
}

fn all_fields(poses: &[Pose]) -> Vec<Fields> {
    poses.iter().map(fields).collect()
}

#[pyfunction]
pub fn turn_angles(turned: TurnFields) -> PyResult<Vec<f64>> {
    turn(turned).map(|turn| turn.angles())
}

#[pyfunction]
pub fn turn_around(turned: TurnFields, first: Fields) -> PyResult<Vec<Fields>> {
    turn(turned).map(|turn| all_fields(&turn.around(&pose(first))))
}

#[pyfunction]
pub fn turn_in_place(turned: TurnFields, camera: Fields) -> PyResult<Vec<Fields>> {
    turn(turned).map(|turn| all_fields(&turn.in_place(&pose(camera))))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
#[expect(clippy::too_many_arguments, reason = "the fields of a view, and a turn")]
pub fn turn_in_view(
    turned: TurnFields,
    azimuth: f64,
    elevation: f64,
    corners: PointArray<'_>,
    shown: Option<PointArray<'_>>,
    zoom: f64,
    view_angle: Option<f64>,
    aspect: f64,
) -> PyResult<Vec<Fields>> {
    let (corners, shown) = (points(&corners), shown.as_ref().map(points));
    let framing = framing(&corners, shown.as_deref(), zoom, view_angle, aspect);
    framing.turn(azimuth, elevation, &turn(turned)?).map(|poses| all_fields(&poses)).map_err(to_py)
}

#[pyclass(name = "CameraPath", frozen)]
pub struct PyCameraPath(CameraPath);

#[pymethods]
impl PyCameraPath {
    #[new]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn new(keys: Vec<Fields>, times: Vec<f64>) -> PyResult<Self> {
        let keys: Vec<Pose> = keys.into_iter().map(pose).collect();
        CameraPath::new(&keys, &times).map(Self).map_err(to_py)
    }

    fn at(&self, time: f64) -> Fields {
        fields(&self.0.at(time))
    }
}

#[pyfunction]
pub fn cameras_evenly(keys: Vec<Fields>, n: usize, is_closed: bool) -> PyResult<Vec<Fields>> {
    let keys: Vec<Pose> = keys.into_iter().map(pose).collect();
    CameraPath::evenly(&keys, n, is_closed).map(|poses| all_fields(&poses)).map_err(to_py)
}
