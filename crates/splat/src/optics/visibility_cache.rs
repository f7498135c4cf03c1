//! Visibility of a volume: a transfer function tabulated, and the ranges of density that it makes visible.
//!
//! Neither depends on the camera or the picture, and frame after frame asks for the same: a [`VisibilityCache`] keeps
//! the last few.

use std::ops::Deref;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use wavesplat_core::{Grid, Result, TransferFunction};

use crate::optics::classify::Classifier;
use crate::optics::slab_variation::{has_thin_parts, slab_of_the_finest, varies};
use crate::source::field::Field;
use crate::source::min_max_bricks::{Bricks, VisibleRanges};
use crate::source::slices::Slices;
use wavesplat_compute::locks::lock;

/// Key of an openness field: its radius, and the numbers of the other layers.
type OpennessKey = (f64, Vec<u64>);

/// A tabulated transfer function, and the ranges of a volume that it makes visible.
pub struct TabulatedFunction {
    classifier: Classifier,
    /// Visible ranges, once they have been asked for.
    visible_ranges: OnceLock<VisibleRanges>,
    /// Results of `varies` by slab thickness: of this level, and of the finest level if this one is coarser.
    varying: Mutex<Vec<(f64, bool)>>,
    /// Whether there are peaks or gaps that sheets can miss, once that has been asked for.
    has_thin_parts: OnceLock<bool>,
    /// The openness field that was asked for last, with its key.
    openness: Mutex<Option<(OpennessKey, Field<'static>)>>,
    /// Unique number of this table.
    id: u64,
}

static NEXT_ID: AtomicU64 = AtomicU64::new(0);

impl TabulatedFunction {
    /// Tabulates `tf` for `slices` and slabs of `slab_thickness`, in `opacity_unit`s ([`Classifier::new`]).
    pub fn new(slices: &Slices, tf: &TransferFunction, slab_thickness: f64) -> Self {
        let classifier = Classifier::new(tf, slices.grid().density_from_sample(), slices.range(), slab_thickness);
        Self {
            classifier,
            visible_ranges: OnceLock::new(),
            varying: Mutex::default(),
            has_thin_parts: OnceLock::new(),
            openness: Mutex::default(),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
        }
    }

    /// Unique number of this table.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Whether slabs of a thickness, in `opacity_unit`s, need pre-integration: they vary visibly (on a coarser level,
    /// slabs of the finest too), or sheets can miss thin parts. `grid`: of the slices; `tf`: of this table.
    pub fn needs_preintegration(&self, grid: &Grid, tf: &TransferFunction, slab_thickness: f64) -> bool {
        (self.varies(slab_thickness) && (grid.coarseness() <= 1.0 || self.varies(slab_of_the_finest(grid, tf))))
            || *self.has_thin_parts.get_or_init(|| has_thin_parts(&self.classifier, grid, tf))
    }

    fn varies(&self, slab_thickness: f64) -> bool {
        let mut known = lock(&self.varying);
        if let Some((_, varies)) = known.iter().find(|(of, _)| *of == slab_thickness) {
            return *varies;
        }
        let varies = varies(&self.classifier, slab_thickness);
        known.push((slab_thickness, varies));
        varies
    }

    /// The openness field of a radius, beside other layers (their numbers): kept from the last call, or made by `make`.
    pub fn openness(
        &self,
        radius: f64,
        others: Vec<u64>,
        make: impl FnOnce() -> Result<Field<'static>>,
    ) -> Result<Field<'static>> {
        let mut kept = lock(&self.openness);
        let key = (radius, others);
        match &*kept {
            Some((of, field)) if *of == key => Ok(field.clone()),
            _ => {
                let field = make()?;
                *kept = Some((key, field.clone()));
                Ok(field)
            }
        }
    }

    /// Visible ranges of density, by the bricks of the same slices.
    pub fn visible_ranges(&self, bricks: &Bricks) -> &VisibleRanges {
        self.visible_ranges.get_or_init(|| bricks.visible_ranges(|[lo, hi]| self.classifier.any_opacity(lo, hi)))
    }
}

impl Deref for TabulatedFunction {
    type Target = Classifier;

    fn deref(&self) -> &Classifier {
        &self.classifier
    }
}

/// The tables that were asked for last, the latest first.
#[derive(Default)]
pub struct VisibilityCache(Mutex<Vec<(Key, Arc<TabulatedFunction>)>>);

/// Key of a table: the arguments that it depends on.
#[derive(Debug, PartialEq)]
struct Key {
    slices: u64,
    tf: TransferFunction,
    density_from_sample: (f64, f64),
    slab_thickness: f64,
}

/// Number of tables that are kept: enough for a picture, its pilot tiles, and other pictures beside it.
const N_LATEST: usize = 8;

impl VisibilityCache {
    /// Like [`TabulatedFunction::new`], but returns a kept table where the arguments are the same.
    pub fn get(&self, slices: &Slices, tf: &TransferFunction, slab_thickness: f64) -> Arc<TabulatedFunction> {
        let density_from_sample = slices.grid().density_from_sample();
        let is_known = |key: &Key| {
            (key.slices, key.density_from_sample, key.slab_thickness)
                == (slices.id(), density_from_sample, slab_thickness)
                && key.tf == *tf
        };
        let mut latest = lock(&self.0);
        if let Some(k) = latest.iter().position(|(key, _)| is_known(key)) {
            latest[..=k].rotate_right(1);
            return latest[0].1.clone();
        }
        let visibility = Arc::new(TabulatedFunction::new(slices, tf, slab_thickness));
        let key = Key { slices: slices.id(), tf: tf.clone(), density_from_sample, slab_thickness };
        latest.insert(0, (key, visibility.clone()));
        latest.truncate(N_LATEST);
        visibility
    }
}

#[cfg(test)]
mod tests {
    use wavesplat_core::Kernel;
    use wavesplat_testkit::{Phantom, opacity_ramp};

    use super::*;

    #[test]
    fn what_was_asked_for_last_is_kept() {
        let phantom = Phantom::sample([9, 9, 9], glam::DAffine3::IDENTITY, |p| p.x);
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let cache = VisibilityCache::default();
        let step = |at: f64| opacity_ramp(&[(at, 0.0), (at + 1.0, 1.0)], None);
        let first = cache.get(&slices, &step(3.0), 1.0);
        for (at, thickness) in [(3.0, 0.5), (4.0, 1.0), (2.0, 1.0)] {
            let other = cache.get(&slices, &step(at), thickness);
            assert!(!Arc::ptr_eq(&first, &other));
            assert!(Arc::ptr_eq(&other, &cache.get(&slices, &step(at), thickness)));
            // Asked for again and again, it stays.
            assert!(Arc::ptr_eq(&first, &cache.get(&slices, &step(3.0), 1.0)));
        }
        (5..13).for_each(|at| drop(cache.get(&slices, &step(f64::from(at)), 1.0)));
        let again = cache.get(&slices, &step(3.0), 1.0);
        assert!(!Arc::ptr_eq(&first, &again));
        let visible_ranges = again.visible_ranges(slices.bricks().unwrap());
        assert_eq!(*visible_ranges, slices.bricks().unwrap().visible_ranges(|[lo, hi]| again.any_opacity(lo, hi)));
        for thickness in [1.0, 0.25, 1.0] {
            assert_eq!(again.varies(thickness), varies(&again.classifier, thickness));
        }
        assert_eq!(again.varying.lock().unwrap().len(), 2);
        assert_eq!(again.visible_range(), first.visible_range());
    }
}
