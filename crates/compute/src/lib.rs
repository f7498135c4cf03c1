//! How kernels are run: on vectors ([`simd`]) and on threads ([`parallel`]).
//!
//! Both are chosen at run time, and neither changes a bit of the result.

pub mod made;
pub mod parallel;
pub mod simd;
