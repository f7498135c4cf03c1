//! The GPU's pictures are the CPU's.

mod scenes;

use scenes::{Case, difference, gpu};

#[test]
fn first() {
    let Some(gpu) = gpu() else { return };
    let case = Case::default();
    let (got, want) = (case.draw(Some(gpu)), case.draw(None));
    let d = difference(&got.picture, &want.picture);
    println!("{d:?} {:?}", got.report);
    assert!(d.within_one == 1.0);
}
