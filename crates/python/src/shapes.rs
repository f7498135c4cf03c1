//! Shapes as Python passes them.

use std::sync::Arc;

use numpy::{
    IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use wavesplat::{Card, Mesh, Paint, Paths, Points, ShapeStyle, Shapes, Sizes, Thickness};

use crate::arguments::Triple;
use crate::errors::to_py;

/// See `_native.pyi`.
#[pyclass(name = "Shapes", frozen, module = "wavesplat._native")]
pub struct PyShapes(pub Arc<Shapes>);

/// Colours: one of the three.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PyPaint<'py> {
    rgb: Option<[f32; 3]>,
    rgba: Option<PyReadonlyArray2<'py, f32>>,
    mapped: Option<(PyReadonlyArray1<'py, f32>, [f32; 2], PyReadonlyArray2<'py, f32>)>,
}

/// Opacity, whether lit, whether clipped.
type PyStyle = (f32, bool, bool);

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PyMesh<'py> {
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    paint: PyPaint<'py>,
    style: PyStyle,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PyPaths<'py> {
    positions: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, u32>,
    radius: Option<f64>,
    width_px: Option<f64>,
    paint: PyPaint<'py>,
    style: PyStyle,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PyPoints<'py> {
    centers: PyReadonlyArray2<'py, f64>,
    radii: Option<PyReadonlyArray1<'py, f64>>,
    diameters_px: Option<PyReadonlyArray1<'py, f64>>,
    paint: PyPaint<'py>,
    style: PyStyle,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PyCard<'py> {
    corner: Triple,
    along_x: Triple,
    along_y: Triple,
    rgba: PyReadonlyArray3<'py, f32>,
    style: PyStyle,
}

#[pymethods]
impl PyShapes {
    #[new]
    #[pyo3(signature = (*, meshes, paths, points, cards))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(
        py: Python<'_>,
        meshes: Vec<PyMesh<'_>>,
        paths: Vec<PyPaths<'_>>,
        points: Vec<PyPoints<'_>>,
        cards: Vec<PyCard<'_>>,
    ) -> PyResult<Self> {
        let meshes = meshes.iter().map(mesh).collect::<PyResult<Vec<_>>>()?;
        let paths = paths.iter().map(path_set).collect::<PyResult<Vec<_>>>()?;
        let points = points.iter().map(point_set).collect::<PyResult<Vec<_>>>()?;
        let cards = cards.iter().map(card).collect::<PyResult<Vec<_>>>()?;
        let shapes = py.detach(|| Shapes::new(meshes, paths, points, cards));
        shapes.map(|shapes| Self(Arc::new(shapes))).map_err(to_py)
    }

    /// See `_native.pyi`.
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.0.bounds().map(|[lo, hi]| (lo.to_array(), hi.to_array()))
    }
}

/// See `_native.pyi`.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn normals_of_faces<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (vertices, faces) = (rows_in(&vertices)?, rows_in(&faces)?);
    let normals = py.detach(|| wavesplat::normals_of_faces(vertices, faces)).map_err(to_py)?;
    let n = normals.len();
    normals.into_flattened().into_pyarray(py).reshape([n, 3])
}

fn mesh(of: &PyMesh<'_>) -> PyResult<Mesh> {
    Ok(Mesh {
        vertices: rows(&of.vertices)?,
        faces: rows(&of.faces)?,
        normals: of.normals.as_ref().map_or(Ok(Vec::new()), rows)?,
        paint: paint(&of.paint)?,
        style: style(of.style),
    })
}

fn path_set(of: &PyPaths<'_>) -> PyResult<Paths> {
    Ok(Paths {
        positions: rows(&of.positions)?,
        starts: of.starts.as_slice()?.to_vec(),
        thickness: match (of.radius, of.width_px) {
            (Some(radius), None) => Thickness::Radius(radius),
            (None, Some(width)) => Thickness::WidthPx(width),
            _ => return Err(PyTypeError::new_err("lines need either radius or width_px")),
        },
        paint: paint(&of.paint)?,
        style: style(of.style),
    })
}

fn point_set(of: &PyPoints<'_>) -> PyResult<Points> {
    Ok(Points {
        centers: rows(&of.centers)?,
        sizes: match (&of.radii, &of.diameters_px) {
            (Some(radii), None) => Sizes::Radii(radii.as_slice()?.to_vec()),
            (None, Some(diameters)) => Sizes::DiametersPx(diameters.as_slice()?.to_vec()),
            _ => return Err(PyTypeError::new_err("points need either radii or diameters_px")),
        },
        paint: paint(&of.paint)?,
        style: style(of.style),
    })
}

fn card(of: &PyCard<'_>) -> PyResult<Card> {
    let [height, width, 4] = *of.rgba.shape() else {
        return Err(PyTypeError::new_err("a card's rgba must have the shape [height, width, 4]"));
    };
    let array = |(x, y, z): Triple| [x, y, z];
    Ok(Card {
        corner: array(of.corner),
        along_x: array(of.along_x),
        along_y: array(of.along_y),
        size: [width, height],
        rgba: of.rgba.as_slice()?.as_chunks().0.to_vec(),
        style: style(of.style),
    })
}

fn paint(of: &PyPaint<'_>) -> PyResult<Paint> {
    match (&of.rgb, &of.rgba, &of.mapped) {
        (Some(rgb), None, None) => Ok(Paint::Even(*rgb)),
        (None, Some(rgba), None) => Ok(Paint::Each(rows(rgba)?)),
        (None, None, Some((values, limits, table))) => {
            Ok(Paint::Mapped { values: values.as_slice()?.to_vec(), limits: *limits, table: rows(table)? })
        }
        _ => Err(PyTypeError::new_err("a paint needs one of rgb, rgba and mapped")),
    }
}

fn style((opacity, is_lit, is_clipped): PyStyle) -> ShapeStyle {
    ShapeStyle { opacity, is_lit, is_clipped }
}

/// Rows of an array of N columns, copied.
fn rows<T: numpy::Element + Copy, const N: usize>(array: &PyReadonlyArray2<'_, T>) -> PyResult<Vec<[T; N]>> {
    rows_in(array).map(<[_]>::to_vec)
}

/// Rows of an array of N columns.
fn rows_in<'a, T: numpy::Element + Copy, const N: usize>(array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [[T; N]]> {
    let [_, n] = *array.shape() else { return Err(PyTypeError::new_err("an array must have two axes")) };
    if n != N {
        return Err(PyTypeError::new_err(format!("an array has {n} columns, not {N}")));
    }
    Ok(array.as_slice()?.as_chunks().0)
}
