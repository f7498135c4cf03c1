//! Fold of ray segments, front to back: states that several machines composited on their own become one.
//!
//! Each segment starts with nothing seen and stops by its own opacity. *over* with associated colour is associative
//! (Porter & Duff 1984), except for rounding and for where rays stop. So the order of the fold, from front to back, and
//! the places where segments are cut are part of the definition of the picture, which then does not depend on which
//! machine drew which segment, or when. Everything behind a ray that is done is ignored. Extremes, integrals and first
//! hits are exact in any grouping.

use wavesplat_compute::simd::{LANES, Lanes, Plain};
use wavesplat_core::Composite;

use crate::ray::project::{absorbed_of, dimmed};
use crate::ray::state::TileState;
use crate::render::plan::{Operator, Plan};

/// Whether segments of a plan can be folded: not if its operator must know the matter in front of a segment, as it
/// must where surfaces of shapes are counted from the eye.
pub fn can_fold(plan: &Plan) -> bool {
    match plan.operator {
        Operator::Over { .. } => !plan.with_depth && plan.shapes.is_none(),
        Operator::LocalMaximum { .. } => false,
        Operator::FirstHit { .. } => plan.shapes.is_none(),
        Operator::Project { .. } => true,
    }
}

/// State of a tile's rays after a front segment and the segment behind it; `None`: nothing is seen.
pub fn fold(operator: Operator, front: Option<TileState>, back: Option<TileState>) -> Option<TileState> {
    let (mut front, back) = match (front, back) {
        (Some(front), Some(back)) => (front, back),
        (front, back) => return front.or(back),
    };
    match operator {
        Operator::Over { opaque, .. } => {
            for (near, far) in front.rgba.iter_mut().zip(&back.rgba) {
                over(near, far, opaque);
            }
            for (k, done) in front.done.iter_mut().enumerate() {
                *done |= back.done[k] || front.rgba[k][3].0.iter().all(|alpha| *alpha >= opaque);
            }
        }
        Operator::FirstHit { .. } => {
            for k in 0..front.found.len() {
                let new = back.found[k] & !front.found[k];
                for i in (0..LANES).filter(|i| new >> i & 1 == 1) {
                    for c in 0..4 {
                        front.rgba[k][c].0[i] = back.rgba[k][c].0[i];
                    }
                    front.s_half[k].0[i] = back.s_half[k].0[i];
                }
                front.found[k] |= new;
                front.done[k] |= back.done[k];
            }
        }
        Operator::Project { composite, levels } => {
            for k in 0..front.value.len() {
                // By our own exponential, which has the same bits on every machine.
                let absorbed = front.absorbed.get(k).map_or([0.0; LANES], |depth| absorbed_of(Plain, &depth.0));
                for (i, far) in back.value[k].0.into_iter().enumerate() {
                    let near = &mut front.value[k].0[i];
                    let before = *near;
                    *near = match composite {
                        Composite::Maximum | Composite::DepthShadedMaximum { .. } => near.max(far),
                        Composite::AttenuatedMaximum { .. } => near.max(dimmed(far, levels[0], 1.0 - absorbed[i])),
                        Composite::Minimum => near.min(far),
                        _ => *near + far,
                    };
                    if let Some(place) = front.s_half.get_mut(k).filter(|_| *near != before) {
                        place.0[i] = back.s_half[k].0[i];
                    }
                }
            }
            let sums = [(&mut front.length, &back.length), (&mut front.absorbed, &back.absorbed)];
            for (near, far) in sums.into_iter().flat_map(|(near, far)| near.iter_mut().zip(far)) {
                near.0.iter_mut().zip(far.0).for_each(|(near, far)| *near += far);
            }
        }
        // Refused before anything is drawn.
        Operator::LocalMaximum { .. } => {}
    }
    Some(front)
}

/// Composites `far` behind `near` where the front ray is not done: `C += (1 − A) C'`, `A += (1 − A) A'`.
fn over(near: &mut [Lanes; 4], far: &[Lanes; 4], opaque: f32) {
    for i in 0..LANES {
        let alpha = near[3].0[i];
        if alpha < opaque {
            for c in 0..4 {
                near[c].0[i] += (1.0 - alpha) * far[c].0[i];
            }
        }
    }
}
