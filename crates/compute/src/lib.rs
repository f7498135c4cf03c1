//! Execution of kernels: on vectors ([`simd`]) and on threads ([`parallel`]), into arrays filled as they go
//! ([`filled`]), in large pages ([`pages`]); ranges of arrays ([`extent`]); locks ([`locks`]).
//!
//! Vectors and threads are chosen at run time, and neither changes a bit of the result.

pub mod extent;
pub mod filled;
pub mod locks;
pub mod pages;
pub mod parallel;
pub mod simd;
