//! How kernels are run: on vectors ([`simd`]) and on threads ([`parallel`]), some into arrays that they fill themselves
//! ([`filled`]), in large pages ([`pages`]); and what all crates ask of numbers ([`extent`]).
//!
//! Vectors and threads are chosen at run time, and neither changes a bit of the result.

pub mod extent;
pub mod filled;
pub mod pages;
pub mod parallel;
pub mod simd;
