//! Cache of data that is computed from a volume's samples once and kept from frame to frame.

use std::sync::{Arc, Mutex};

use wavesplat_compute::locks::lock;
use wavesplat_core::{Grid, Kernel, TransferFunction, Volume};
use wavesplat_splat::needs_preintegration;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::{Prepared, Slices};

/// Cache of min-max bricks, spline coefficients and filled samples, for every kernel that was used, and of tables of
/// the latest transfer functions.
///
/// It belongs to one set of samples: after they change, take a new one.
#[derive(Default)]
pub struct VolumeCache {
    prepared: Mutex<Vec<(Kernel, Arc<Prepared>)>>,
    pub(crate) visibility: VisibilityCache,
    /// Latest transfer function, and whether it needs pre-integration.
    steep: Mutex<Option<(TransferFunction, bool)>>,
}

impl VolumeCache {
    /// Slices for a kernel; their data is prepared with the first picture and kept.
    pub fn slices<'a>(&self, volume: &Volume<'a>, kernel: Kernel) -> Slices<'a> {
        let mut prepared = lock(&self.prepared);
        let known = prepared.iter().find(|(k, _)| *k == kernel).map(|(_, known)| known.clone());
        let known = known.unwrap_or_else(|| {
            let new = Arc::new(Prepared::new(volume, kernel));
            prepared.push((kernel, new.clone()));
            new
        });
        Slices::with_prepared(volume, known)
    }

    /// Whether a transfer function needs pre-integration; kept until another function is asked for.
    pub(crate) fn needs_preintegration(&self, grid: &Grid, tf: &TransferFunction) -> bool {
        let known = lock(&self.steep);
        if let Some((_, needs_preintegration)) = known.as_ref().filter(|(of, _)| of == tf) {
            return *needs_preintegration;
        }
        drop(known);
        let needs_preintegration = needs_preintegration(grid, tf);
        *lock(&self.steep) = Some((tf.clone(), needs_preintegration));
        needs_preintegration
    }
}
