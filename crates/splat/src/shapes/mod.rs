//! Shapes in the picture: surfaces, lines, points and cards become *fragments* on the rays of a base plane's texels.
//!
//! A ray is cut where it meets a shape: matter in front is composited, then the fragment, then matter behind. So shapes
//! lie at their exact depth in translucent matter, whatever the distance of the sheets. Everything about shapes is
//! decided once, in the plan: [`fragments`] holds them, [`raster`] makes them, band by band.
//!
//! Edges are smooth: a texel has [`samples::N`] places, and a fragment covers some of them. A ray has one opacity per
//! fragment, which is worked out from the places that are still open behind the fragments in front (the A-buffer of
//! Carpenter 1984): two triangles that share an edge leave no gap, and hide what is behind like one.

pub mod canvas;
pub mod cards;
pub mod cover;
pub mod fragments;
pub mod light;
pub mod paint;
pub mod placement;
pub mod raster;
pub mod samples;
pub mod solids;
pub mod strokes;
pub mod triangles;
