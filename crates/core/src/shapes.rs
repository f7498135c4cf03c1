//! Shapes that stand in space with the volumes: surfaces, lines, points, and cards (pictures on parallelograms).
//!
//! All positions are in world coordinates. A shape is a surface: a ray that meets it is dimmed there by its opacity,
//! whatever the angle, and lies in matter before and behind. Shapes are validated when they are made.

use glam::DVec3;

use crate::error::{Error, Result};

/// Shapes of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    meshes: Vec<Mesh>,
    paths: Vec<Paths>,
    points: Vec<Points>,
    cards: Vec<Card>,
    bounds: Option<[DVec3; 2]>,
}

/// Triangles that share vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Positions of the vertices.
    pub vertices: Vec<[f64; 3]>,
    /// Vertices of each triangle, by number.
    pub faces: Vec<[u32; 3]>,
    /// Normal of each vertex, of any length but 0; empty: each triangle has its own.
    pub normals: Vec<[f32; 3]>,
    /// Colours of the vertices.
    pub paint: Paint,
    /// Look.
    pub style: ShapeStyle,
}

/// Lines through points, each a chain of straight pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Paths {
    /// Positions, path after path.
    pub positions: Vec<[f64; 3]>,
    /// Number of the first position of each path, then the number of all positions.
    pub starts: Vec<u32>,
    /// Thickness of the lines.
    pub thickness: Thickness,
    /// Colours of the positions.
    pub paint: Paint,
    /// Look.
    pub style: ShapeStyle,
}

/// Balls, or discs that face the eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Positions of the centres.
    pub centers: Vec<[f64; 3]>,
    /// Size of each point.
    pub sizes: Sizes,
    /// Colours of the points.
    pub paint: Paint,
    /// Look.
    pub style: ShapeStyle,
}

/// A picture on a parallelogram, shown as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// Outer corner of the first pixel of the first row.
    pub corner: [f64; 3],
    /// Way from there along all columns.
    pub along_x: [f64; 3],
    /// Way from there along all rows.
    pub along_y: [f64; 3],
    /// Columns and rows of the picture.
    pub size: [usize; 2],
    /// Straight RGBA, row by row.
    pub rgba: Vec<[f32; 4]>,
    /// Look; cards are not lit.
    pub style: ShapeStyle,
}

/// Thickness of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Tubes of this radius, in world units.
    Radius(f64),
    /// Strokes of this width, in pixels.
    WidthPx(f64),
}

/// Size of each point of a set.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizes {
    /// Balls of these radii, in world units.
    Radii(Vec<f64>),
    /// Discs of these diameters, in pixels.
    DiametersPx(Vec<f64>),
}

/// Colours of vertices, positions or points. Between them, values and colours are linear.
#[derive(Clone, Debug, PartialEq)]
pub enum Paint {
    /// One colour: red, green, blue.
    Even([f32; 3]),
    /// Straight RGBA each.
    Each(Vec<[f32; 4]>),
    /// A value each, coloured by a table; a value that is not a number is not drawn.
    Mapped {
        /// The values.
        values: Vec<f32>,
        /// Values of the first and the last entry of the table; those beyond have the colours of the ends.
        limits: [f32; 2],
        /// Straight RGBA.
        table: Vec<[f32; 4]>,
    },
}

/// Look of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeStyle {
    /// Opacity, `0..=1`, times the opacity of the colours.
    pub opacity: f32,
    /// Whether the scene's lights shine on it, and matter casts its shadow on it; else colours are shown as they are.
    pub is_lit: bool,
    /// Whether clip planes and crop cut it.
    pub is_clipped: bool,
}

impl Default for ShapeStyle {
    fn default() -> Self {
        Self { opacity: 1.0, is_lit: true, is_clipped: false }
    }
}

/// Largest number of vertices, positions or points of a shape.
const MAX_PLACES: usize = 1 << 28;

impl Shapes {
    /// Checks shapes and takes them over.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] names the shape and what is wrong: a position that is not finite, a vertex that does not
    /// exist, a colour or opacity outside of `0..=1`, a size that is not positive, an array of another length.
    pub fn new(meshes: Vec<Mesh>, paths: Vec<Paths>, points: Vec<Points>, cards: Vec<Card>) -> Result<Self> {
        for (k, mesh) in meshes.iter().enumerate() {
            mesh.check(&format!("surface {k}"))?;
        }
        for (k, paths) in paths.iter().enumerate() {
            paths.check(&format!("lines {k}"))?;
        }
        for (k, points) in points.iter().enumerate() {
            points.check(&format!("points {k}"))?;
        }
        for (k, card) in cards.iter().enumerate() {
            card.check(&format!("card {k}"))?;
        }
        let mut shapes = Self { meshes, paths, points, cards, bounds: None };
        shapes.bounds = shapes.find_bounds();
        Ok(shapes)
    }

    /// Surfaces.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// Sets of lines.
    pub fn paths(&self) -> &[Paths] {
        &self.paths
    }

    /// Sets of points.
    pub fn points(&self) -> &[Points] {
        &self.points
    }

    /// Cards.
    pub fn cards(&self) -> &[Card] {
        &self.cards
    }

    /// Whether nothing can be seen: there are no shapes, or all are clear.
    pub fn is_empty(&self) -> bool {
        let is_clear = |style: &ShapeStyle| style.opacity == 0.0;
        self.meshes.iter().all(|mesh| mesh.faces.is_empty() || is_clear(&mesh.style))
            && self.paths.iter().all(|paths| paths.positions.is_empty() || is_clear(&paths.style))
            && self.points.iter().all(|points| points.centers.is_empty() || is_clear(&points.style))
            && self.cards.iter().all(|card| is_clear(&card.style))
    }

    /// Largest radius of discs and half width of strokes, in pixels; 0 without any.
    pub fn max_half_px(&self) -> f64 {
        let widths = self.paths.iter().map(|paths| match paths.thickness {
            Thickness::WidthPx(width) => width,
            Thickness::Radius(_) => 0.0,
        });
        let diameters = self.points.iter().map(|points| match &points.sizes {
            Sizes::DiametersPx(diameters) => diameters.iter().copied().fold(0.0, f64::max),
            Sizes::Radii(_) => 0.0,
        });
        0.5 * widths.chain(diameters).fold(0.0, f64::max)
    }

    /// Corners of the smallest box along the world axes that holds all shapes; sizes in pixels count as none. `None`
    /// without shapes.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }

    fn find_bounds(&self) -> Option<[DVec3; 2]> {
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut hold = |at: [f64; 3], reach: f64| {
            let at = DVec3::from_array(at);
            bounds = [bounds[0].min(at - reach), bounds[1].max(at + reach)];
        };
        for mesh in &self.meshes {
            mesh.faces.as_flattened().iter().for_each(|k| hold(mesh.vertices[*k as usize], 0.0));
        }
        for paths in &self.paths {
            let reach = if let Thickness::Radius(radius) = paths.thickness { radius } else { 0.0 };
            paths.positions.iter().for_each(|at| hold(*at, reach));
        }
        for points in &self.points {
            for (k, at) in points.centers.iter().enumerate() {
                hold(*at, if let Sizes::Radii(radii) = &points.sizes { radii[k] } else { 0.0 });
            }
        }
        for card in &self.cards {
            let [corner, x, y] = [card.corner, card.along_x, card.along_y].map(DVec3::from_array);
            for at in [corner, corner + x, corner + y, corner + x + y] {
                hold(at.to_array(), 0.0);
            }
        }
        (bounds[0].x <= bounds[1].x).then_some(bounds)
    }
}

impl Mesh {
    fn check(&self, name: &str) -> Result<()> {
        check_positions(&self.vertices, name, "vertex")?;
        let n = self.vertices.len();
        if let Some((k, face)) = self.faces.iter().enumerate().find(|(_, face)| face.iter().any(|v| *v as usize >= n)) {
            let what = format!("{name}: face {k}");
            let mend = "number vertices from 0; check that vertices and faces belong together";
            return Err(Error::out_of_range(what, format!("{face:?} of {n} vertices"), "three vertices", mend));
        }
        if !self.normals.is_empty() {
            check_count(self.normals.len(), n, &format!("{name}: normals"))?;
        }
        if let Some(k) = self.normals.iter().position(|normal| normal.iter().any(|x| !x.is_finite())) {
            let what = format!("{name}: normal {k}");
            let mend = "leave normals out to have them computed";
            return Err(Error::out_of_range(what, format!("{:?}", self.normals[k]), "finite", mend));
        }
        self.paint.check(n, name)?;
        self.style.check(name)
    }
}

impl Paths {
    fn check(&self, name: &str) -> Result<()> {
        check_positions(&self.positions, name, "position")?;
        let n = self.positions.len();
        let is_ascending = self.starts.is_sorted() && self.starts.first() == Some(&0);
        if !is_ascending || self.starts.last().map(|last| *last as usize) != Some(n) {
            let mend = "pass the number of the first position of each path, then the number of all positions";
            let value = format!("{:?} for {n} positions", self.starts.iter().take(8).collect::<Vec<_>>());
            return Err(Error::out_of_range(format!("{name}: starts"), value, "ascending from 0 to the end", mend));
        }
        let (Thickness::Radius(size) | Thickness::WidthPx(size)) = self.thickness;
        check_size(size, &format!("{name}: radius or width"))?;
        self.paint.check(n, name)?;
        self.style.check(name)
    }
}

impl Points {
    fn check(&self, name: &str) -> Result<()> {
        check_positions(&self.centers, name, "point")?;
        let n = self.centers.len();
        let (Sizes::Radii(sizes) | Sizes::DiametersPx(sizes)) = &self.sizes;
        check_count(sizes.len(), n, &format!("{name}: radii or sizes"))?;
        for (k, size) in sizes.iter().enumerate() {
            check_size(*size, &format!("{name}: radius or size of point {k}"))?;
        }
        self.paint.check(n, name)?;
        self.style.check(name)
    }
}

impl Card {
    fn check(&self, name: &str) -> Result<()> {
        let [x, y] = [self.along_x, self.along_y].map(DVec3::from_array);
        let corner = DVec3::from_array(self.corner);
        if !(corner.is_finite() && x.is_finite() && y.is_finite() && x.cross(y).length() > 0.0) {
            let value = format!("{:?}, {:?}, {:?}", self.corner, self.along_x, self.along_y);
            let mend = "pass a corner and two directions that are not parallel";
            return Err(Error::out_of_range(name, value, "a parallelogram", mend));
        }
        check_count(self.rgba.len(), self.size[0] * self.size[1], &format!("{name}: pixels"))?;
        if self.rgba.is_empty() {
            return Err(Error::out_of_range(name, "empty", "a picture", "pass at least one pixel"));
        }
        check_colors(&self.rgba, name)?;
        self.style.check(name)
    }
}

impl Paint {
    /// Whether all its colours are opaque.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        match self {
            Self::Even(_) => true,
            Self::Each(colors) | Self::Mapped { table: colors, .. } => colors.iter().all(|rgba| rgba[3] >= 1.0),
        }
    }

    fn check(&self, n: usize, name: &str) -> Result<()> {
        match self {
            Self::Even([r, g, b]) => check_colors(&[[*r, *g, *b, 1.0]], name),
            Self::Each(colors) => {
                check_count(colors.len(), n, &format!("{name}: colours"))?;
                check_colors(colors, name)
            }
            Self::Mapped { values, limits, table } => {
                check_count(values.len(), n, &format!("{name}: values"))?;
                if table.is_empty() {
                    return Err(Error::out_of_range(
                        name,
                        "no entry",
                        "a table of colours",
                        "pass at least one colour",
                    ));
                }
                if !(limits[0].is_finite() && limits[1].is_finite() && limits[0] < limits[1]) {
                    let mend = "pass (lowest, highest) value of the colour map";
                    let what = format!("{name}: limits of the colour map");
                    return Err(Error::out_of_range(what, format!("{limits:?}"), "ascending", mend));
                }
                check_colors(table, name)
            }
        }
    }
}

impl ShapeStyle {
    fn check(self, name: &str) -> Result<()> {
        if (0.0..=1.0).contains(&self.opacity) {
            return Ok(());
        }
        let mend = "pass 1 for opaque, 0 for invisible";
        Err(Error::out_of_range(format!("{name}: opacity"), self.opacity, "between 0 and 1", mend))
    }
}

fn check_positions(positions: &[[f64; 3]], name: &str, each: &str) -> Result<()> {
    if positions.len() > MAX_PLACES {
        let what = format!("{name}: number of positions");
        return Err(Error::out_of_range(
            what,
            positions.len(),
            "at most 268435456",
            "thin it out, or draw parts of it",
        ));
    }
    let Some(k) = positions.iter().position(|at| at.iter().any(|x| !x.is_finite())) else { return Ok(()) };
    let mend = "leave it out, or repair the file";
    Err(Error::out_of_range(format!("{name}: {each} {k}"), format!("{:?}", positions[k]), "a finite position", mend))
}

fn check_count(n: usize, wanted: usize, what: &str) -> Result<()> {
    if n == wanted {
        return Ok(());
    }
    Err(Error::out_of_range(format!("number of {what}"), format!("{n}, not {wanted}"), "one each", "pass one each"))
}

fn check_size(size: f64, what: &str) -> Result<()> {
    if size.is_finite() && size > 0.0 {
        return Ok(());
    }
    Err(Error::out_of_range(what, size, "a positive number", "leave it out for a size that is chosen"))
}

fn check_colors(colors: &[[f32; 4]], name: &str) -> Result<()> {
    let Some(k) = colors.iter().position(|rgba| rgba.iter().any(|c| !(0.0..=1.0).contains(c))) else { return Ok(()) };
    let mend = "pass red, green, blue (and opacity) between 0 and 1";
    Err(Error::out_of_range(format!("{name}: colour {k}"), format!("{:?}", colors[k]), "between 0 and 1", mend))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            faces: vec![[0, 1, 2]],
            normals: Vec::new(),
            paint: Paint::Even([1.0, 0.0, 0.0]),
            style: ShapeStyle::default(),
        }
    }

    fn points() -> Points {
        Points {
            centers: vec![[5.0, 0.0, 0.0], [1.0, 2.0, 3.0]],
            sizes: Sizes::Radii(vec![1.0, 2.0]),
            paint: Paint::Each(vec![[0.5; 4]; 2]),
            style: ShapeStyle::default(),
        }
    }

    #[test]
    fn bounds_hold_all_shapes_with_their_radii() {
        let shapes = Shapes::new(vec![triangle()], Vec::new(), vec![points()], Vec::new()).unwrap();
        assert_eq!(shapes.bounds(), Some([DVec3::new(-1.0, -1.0, -1.0), DVec3::new(6.0, 4.0, 5.0)]));
        assert!(!shapes.is_empty() && Shapes::default().is_empty() && Shapes::default().bounds().is_none());
    }

    #[test]
    fn faults_are_named() {
        let of_mesh = |change: &dyn Fn(&mut Mesh)| {
            let mut mesh = triangle();
            change(&mut mesh);
            Shapes::new(vec![mesh], Vec::new(), Vec::new(), Vec::new()).unwrap_err().to_string()
        };
        assert!(of_mesh(&|mesh| mesh.faces[0][1] = 3).starts_with("surface 0: face 0 is [0, 3, 2] of 3 vertices"));
        assert!(of_mesh(&|mesh| mesh.vertices[1][2] = f64::NAN).contains("surface 0: vertex 1 is [1.0, 0.0, NaN]"));
        assert!(of_mesh(&|mesh| mesh.normals = vec![[0.0; 3]]).contains("normals is 1, not 3"));
        assert!(of_mesh(&|mesh| mesh.style.opacity = 1.5).contains("opacity is 1.5"));
        assert!(of_mesh(&|mesh| mesh.paint = Paint::Even([2.0, 0.0, 0.0])).contains("colour 0"));
        let of_points = |change: &dyn Fn(&mut Points)| {
            let mut points = points();
            change(&mut points);
            Shapes::new(Vec::new(), Vec::new(), vec![points], Vec::new()).unwrap_err().to_string()
        };
        assert!(of_points(&|points| points.sizes = Sizes::Radii(vec![1.0, 0.0])).contains("of point 1 is 0"));
        assert!(of_points(&|points| points.paint = Paint::Each(vec![[0.5; 4]])).contains("colours is 1, not 2"));
        let line = |starts: Vec<u32>| {
            let paths = Paths {
                positions: vec![[0.0; 3]; 3],
                starts,
                thickness: Thickness::WidthPx(2.0),
                paint: Paint::Mapped { values: vec![0.0; 3], limits: [0.0, 1.0], table: vec![[1.0; 4]] },
                style: ShapeStyle::default(),
            };
            Shapes::new(Vec::new(), vec![paths], Vec::new(), Vec::new())
        };
        assert!(line(vec![0, 1, 3]).is_ok());
        assert!(line(vec![0, 2]).unwrap_err().to_string().contains("starts"));
        assert!(line(vec![0, 2, 1, 3]).is_err() && line(Vec::new()).is_err());
    }
}
