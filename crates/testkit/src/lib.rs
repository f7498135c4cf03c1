//! Phantoms with known answers and picture comparison.
