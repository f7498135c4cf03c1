//! What a transfer function shows of a volume: the function tabulated, and which ranges of density are seen.
//!
//! Both depend on neither camera nor picture, and one frame after the other asks for the same: the last few are kept with
//! the volume.

use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use wavesplat_core::TransferFunction;

use crate::bricks::{Bricks, Passing};
use crate::classify::Classifier;
use crate::slices::Slices;

/// What a transfer function shows of a volume.
#[derive(Debug)]
pub struct Seen {
    classifier: Classifier,
    /// Ranges that have an opacity, where that was asked for.
    passing: OnceLock<Passing>,
    /// How much changes in slabs of as many thicknesses as were asked for, with these: one, and of a level one of the finest.
    variations: Mutex<Vec<(f64, f32)>>,
}

impl Seen {
    /// That of `slices` by slabs of `slab_thickness`, as of [`Classifier::new`].
    pub fn new(slices: &Slices, tf: &TransferFunction, slab_thickness: f64) -> Arc<Self> {
        let density_from_sample = slices.grid().density_from_sample();
        let mut latest = slices.latest_seen().0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_known = |(of, _): &(Of, Arc<Self>)| {
            (of.density_from_sample, of.slab_thickness) == (density_from_sample, slab_thickness) && of.tf == *tf
        };
        if let Some(k) = latest.iter().position(is_known) {
            latest[..=k].rotate_right(1);
            return latest[0].1.clone();
        }
        let classifier = Classifier::new(tf, density_from_sample, slices.range(), slab_thickness);
        let seen = Arc::new(Self { classifier, passing: OnceLock::new(), variations: Mutex::default() });
        latest.insert(0, (Of { tf: tf.clone(), density_from_sample, slab_thickness }, seen.clone()));
        latest.truncate(N_LATEST);
        seen
    }

    /// As [`Classifier::variation`].
    pub fn variation(&self, slab_thickness: f64) -> f32 {
        let mut variations = self.variations.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, variation)) = variations.iter().find(|(of, _)| *of == slab_thickness) {
            return *variation;
        }
        let variation = self.classifier.variation(slab_thickness);
        variations.push((slab_thickness, variation));
        variation
    }

    /// Which ranges of density have an opacity somewhere, by the bricks of the same slices.
    pub fn passing(&self, bricks: &Bricks) -> &Passing {
        self.passing.get_or_init(|| bricks.passing(|[lo, hi]| self.classifier.any_opacity(lo, hi)))
    }
}

impl Deref for Seen {
    type Target = Classifier;

    fn deref(&self) -> &Classifier {
        &self.classifier
    }
}

/// What was asked for last of a volume, the latest first.
#[derive(Debug, Default)]
pub struct Latest(Mutex<Vec<(Of, Arc<Seen>)>>);

/// What is tabulated, beside the volume's own range.
#[derive(Debug)]
struct Of {
    tf: TransferFunction,
    density_from_sample: (f64, f64),
    slab_thickness: f64,
}

/// As many are kept: those of a picture that is drawn in some passes, and of another beside it.
const N_LATEST: usize = 8;

#[cfg(test)]
mod tests {
    use wavesplat_core::Kernel;
    use wavesplat_testkit::{Phantom, opacity_ramp};

    use super::*;

    #[test]
    fn what_was_asked_for_last_is_kept() {
        let phantom = Phantom::sample([9, 9, 9], glam::DAffine3::IDENTITY, |p| p.x);
        let slices = Slices::new(&phantom.volume(), Kernel::Linear);
        let step = |at: f64| opacity_ramp(&[(at, 0.0), (at + 1.0, 1.0)], None);
        let first = Seen::new(&slices, &step(3.0), 1.0);
        for (at, thickness) in [(3.0, 0.5), (4.0, 1.0), (2.0, 1.0)] {
            let other = Seen::new(&slices, &step(at), thickness);
            assert!(!Arc::ptr_eq(&first, &other));
            assert!(Arc::ptr_eq(&other, &Seen::new(&slices, &step(at), thickness)));
            // Asked for again and again, it stays.
            assert!(Arc::ptr_eq(&first, &Seen::new(&slices, &step(3.0), 1.0)));
        }
        (5..13).for_each(|at| drop(Seen::new(&slices, &step(f64::from(at)), 1.0)));
        let again = Seen::new(&slices, &step(3.0), 1.0);
        assert!(!Arc::ptr_eq(&first, &again));
        let passing = again.passing(slices.bricks());
        assert_eq!(*passing, slices.bricks().passing(|[lo, hi]| again.any_opacity(lo, hi)));
        for thickness in [1.0, 0.25, 1.0] {
            assert_eq!(again.variation(thickness), again.classifier.variation(thickness));
        }
        assert_eq!(again.variations.lock().unwrap().len(), 2);
        assert_eq!(again.visible_range(), first.visible_range());
    }
}
