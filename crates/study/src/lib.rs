//! Renderers that the product is compared with, in tests and studies.
//!
//! [`reference`](mod@reference) has the literal, slow twins in double precision, and the method without one of its
//! parts; [`standard`] is standard splatting, the older technique. Both take from `wavesplat_splat` how samples are
//! read, which rays a picture has and how a base plane is warped, so that pictures differ by the method alone; the
//! reference shares no inner loop with the renderer. No crate that draws for users depends on this one: the bindings of
//! Python offer it beside them.

pub mod reference;
pub mod standard;

pub use wavesplat_core::RenderOptions;
