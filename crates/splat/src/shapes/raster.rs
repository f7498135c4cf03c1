//! From shapes to fragments: which shapes reach which rows of texels, then band by band, on all threads.

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{ShapeStyle, Shapes};

use crate::shapes::canvas::{Canvas, OnPlane, RowRange};
use crate::shapes::cards::CardOnPlane;
use crate::shapes::fragments::{FragmentBand, Fragments, resolve};
use crate::shapes::light::ShapeLight;
use crate::shapes::placement::PlaneView;
use crate::shapes::solids::{BallsOnPlane, TubesOnPlane};
use crate::shapes::strokes::{DiscsOnPlane, StrokesOnPlane};
use crate::shapes::triangles::MeshOnPlane;
use crate::view::region::Region;

/// Rows of texels of a band.
const BAND_ROWS: usize = 8;

/// Fragments of shapes on a base plane. `region`: space left by clip planes and crop.
pub fn fragments_of(simd: Level, view: &PlaneView, shapes: &Shapes, region: &Region, light: &ShapeLight) -> Fragments {
    let placed = on_plane(shapes, view);
    let [n_u, n_v] = view.plane.size;
    let bands = Bands::new(&placed, view, n_v.div_ceil(BAND_ROWS));
    let drawn = parallel::map(bands.len(), |band| {
        let rows = band * BAND_ROWS..((band + 1) * BAND_ROWS).min(n_v);
        let n_texels = rows.len() * n_u;
        let elements = bands.of(band);
        if elements.is_empty() {
            return FragmentBand { counts: vec![0; n_texels], all: Vec::new(), n_joined: 0 };
        }
        let mut canvas = Canvas::new(view, rows.clone(), region);
        simd.run(
            #[inline(always)]
            || {
                for [shape, element] in elements {
                    placed[*shape as usize].draw(*element as usize, &mut canvas);
                }
            },
        );
        resolve(&canvas.meetings, n_texels, |seen| {
            if !seen.is_lit() {
                return seen.rgb;
            }
            let [i, j] = [seen.texel as usize % n_u, seen.texel as usize / n_u + rows.start];
            let to_eye = -view.way(i as f64, j as f64);
            light.shade(seen.rgb, seen.normal, to_eye.as_vec3(), view.index_at([i as f32, j as f32, seen.s]))
        })
    });
    Fragments::new([n_u, n_v], drawn)
}

/// Shapes that can be seen, as they lie on a base plane.
fn on_plane<'a>(shapes: &'a Shapes, view: &PlaneView) -> Vec<Shape<'a>> {
    let mut placed = Vec::new();
    let is_seen = |style: &ShapeStyle| style.opacity > 0.0;
    for mesh in shapes.meshes().iter().filter(|mesh| is_seen(&mesh.style)) {
        placed.push(Shape::Mesh(MeshOnPlane::new(mesh, view)));
    }
    let mut n_solids = 0;
    for paths in shapes.paths().iter().filter(|paths| is_seen(&paths.style)) {
        placed.push(match paths.thickness {
            wavesplat_core::Thickness::Radius(radius) => Shape::Tubes(TubesOnPlane::new(paths, radius, n_solids, view)),
            wavesplat_core::Thickness::WidthPx(width) => {
                Shape::Strokes(StrokesOnPlane::new(paths, width, n_solids, view))
            }
        });
        n_solids += paths.starts.len() as u32;
    }
    for points in shapes.points().iter().filter(|points| is_seen(&points.style)) {
        placed.push(match &points.sizes {
            wavesplat_core::Sizes::Radii(radii) => Shape::Balls(BallsOnPlane::new(points, radii, view)),
            wavesplat_core::Sizes::DiametersPx(sizes) => Shape::Discs(DiscsOnPlane::new(points, sizes, view)),
        });
    }
    for card in shapes.cards().iter().filter(|card| is_seen(&card.style)) {
        placed.push(Shape::Card(CardOnPlane::new(card, view)));
    }
    placed
}

/// A shape on a base plane.
enum Shape<'a> {
    Mesh(MeshOnPlane<'a>),
    Tubes(TubesOnPlane<'a>),
    Strokes(StrokesOnPlane<'a>),
    Balls(BallsOnPlane<'a>),
    Discs(DiscsOnPlane<'a>),
    Card(CardOnPlane<'a>),
}

impl Shape<'_> {
    fn n_elements(&self) -> usize {
        match self {
            Self::Mesh(own) => own.n_elements(),
            Self::Tubes(own) => own.n_elements(),
            Self::Strokes(own) => own.n_elements(),
            Self::Balls(own) => own.n_elements(),
            Self::Discs(own) => own.n_elements(),
            Self::Card(own) => own.n_elements(),
        }
    }

    fn rows(&self, element: usize, view: &PlaneView) -> RowRange {
        match self {
            Self::Mesh(own) => own.rows(element, view),
            Self::Tubes(own) => own.rows(element, view),
            Self::Strokes(own) => own.rows(element, view),
            Self::Balls(own) => own.rows(element, view),
            Self::Discs(own) => own.rows(element, view),
            Self::Card(own) => own.rows(element, view),
        }
    }

    #[inline(always)]
    fn draw(&self, element: usize, canvas: &mut Canvas) {
        match self {
            Self::Mesh(own) => own.draw(element, canvas),
            Self::Tubes(own) => own.draw(element, canvas),
            Self::Strokes(own) => own.draw(element, canvas),
            Self::Balls(own) => own.draw(element, canvas),
            Self::Discs(own) => own.draw(element, canvas),
            Self::Card(own) => own.draw(element, canvas),
        }
    }
}

/// Elements of shapes by the bands of rows that they reach.
struct Bands {
    starts: Vec<usize>,
    /// Numbers of the shape and of its element, band after band.
    elements: Vec<[u32; 2]>,
}

impl Bands {
    fn new(shapes: &[Shape], view: &PlaneView, n_bands: usize) -> Self {
        const SOME: usize = 4096;
        assert!(u16::try_from(n_bands).is_ok(), "a base plane of more than half a million rows");
        // The first band of each element and the one after its last: of millions, every byte counts.
        let reached: Vec<Vec<[u16; 2]>> = shapes
            .iter()
            .map(|shape| {
                let mut reached = vec![[0; 2]; shape.n_elements()];
                parallel::for_each_chunk(&mut reached, SOME, |k, some| {
                    for (element, bands) in some.iter_mut().enumerate() {
                        if let Some([first, last]) = shape.rows(k * SOME + element, view) {
                            *bands =
                                [first as usize / BAND_ROWS, last as usize / BAND_ROWS + 1].map(|band| band as u16);
                        }
                    }
                });
                reached
            })
            .collect();
        let bands_of = |[first, end]: [u16; 2]| usize::from(first)..usize::from(end);
        let mut starts = vec![0; n_bands + 1];
        for bands in reached.iter().flatten() {
            bands_of(*bands).for_each(|band| starts[band + 1] += 1);
        }
        for band in 0..n_bands {
            starts[band + 1] += starts[band];
        }
        let mut next = starts.clone();
        let mut elements = vec![[0; 2]; starts[n_bands]];
        for (shape, reached) in reached.iter().enumerate() {
            for (element, bands) in reached.iter().enumerate() {
                for band in bands_of(*bands) {
                    elements[next[band]] = [shape as u32, element as u32];
                    next[band] += 1;
                }
            }
        }
        Self { starts, elements }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn of(&self, band: usize) -> &[[u32; 2]] {
        &self.elements[self.starts[band]..self.starts[band + 1]]
    }
}
