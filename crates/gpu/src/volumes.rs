//! Volumes on a GPU: whole, or in pages where they do not fit; an LRU cache within the budget.

use std::sync::{Arc, Mutex, MutexGuard};

use wavesplat_compute::locks::lock;
use wavesplat_splat::source::slices::Slices;

use crate::device::OpenDevice;
use crate::failure::{Failure, GpuResult};
use crate::pages::{Pages, n_pages, page_bytes, page_textures};
use crate::permutation::{Permutation, SourceKind};
use crate::samples::{Apron, SampleTexture, TexelBox, hole_texture, upload, upload_holes};
use crate::scene_kind::{SourceSamples, apron_of};

/// Cache key of an uploaded volume.
#[derive(Clone, Copy, PartialEq, Eq)]
struct VolumeKey {
    id: u64,
    apron: Apron,
    /// Number of page slots, and the layer, as each layer has pages of its own; `None`: the volume is whole.
    slots: Option<(usize, usize)>,
    /// Whether this is a field of light or labels, which is made anew as the light turns.
    is_field: bool,
}

/// The samples of a source.
pub(crate) struct GpuVolume {
    pub samples: SampleTexture,
    pub holes: Option<SampleTexture>,
    pub apron: Apron,
    pub pages: Option<Mutex<Pages>>,
}

impl GpuVolume {
    /// Bytes of its textures.
    pub fn n_bytes(&self) -> usize {
        self.samples.n_bytes + self.holes.as_ref().map_or(0, |holes| holes.n_bytes)
    }

    /// Page table, if the volume is in pages.
    pub fn pages(&self) -> Option<MutexGuard<'_, Pages>> {
        self.pages.as_ref().map(|pages| lock(pages))
    }
}

/// Uploaded volumes, the least recently used first.
#[derive(Default)]
pub(crate) struct Volumes(Vec<(VolumeKey, Arc<GpuVolume>)>);

impl Volumes {
    /// Uploads the samples of all sources, in pages where they do not fit; evicts the least recently used volumes.
    pub fn place_all(
        &mut self,
        device: &OpenDevice,
        permutation: &Permutation,
        sources: &[SourceSamples],
        n_layers: usize,
        budget_bytes: usize,
        is_paged: bool,
    ) -> GpuResult<Vec<Arc<GpuVolume>>> {
        let megabytes = |n: usize| n as f64 / 1e6;
        let whole: Vec<usize> =
            sources.iter().zip(&permutation.sources).map(|(source, kind)| whole_bytes(source.first(), kind)).collect();
        let (of_layers, of_fields): (usize, usize) = (whole[..n_layers].iter().sum(), whole[n_layers..].iter().sum());
        let fits = |k: usize| {
            let size = TexelBox::whole(sources[k].first().grid().size(), apron_of(&permutation.sources[k])).size;
            let [side, deep] = [device.limits.max_texture_dimension_2d, device.limits.max_texture_array_layers];
            size[0].max(size[1]) <= side as usize && size[2] <= deep as usize
        };
        let is_paged = is_paged || of_layers + of_fields > budget_bytes || !(0..n_layers).all(fits);
        let mut keys = Vec::new();
        for (k, (source, kind)) in sources.iter().zip(&permutation.sources).enumerate() {
            let (slices, apron) = (source.first(), apron_of(kind));
            let mut slots = None;
            if is_paged && k < n_layers {
                let share = whole[k] as f64 / of_layers as f64;
                let room = (budget_bytes.saturating_sub(of_fields) as f64 * share) as usize;
                let n = (room / page_bytes(kind, apron)).min(n_pages(slices.grid().size()).iter().product());
                if n == 0 {
                    return Err(Failure::Memory(format!(
                        "{:.1} MB are allowed on the GPU, not enough for a page of the samples, of {:.1} MB",
                        megabytes(budget_bytes),
                        megabytes(page_bytes(kind, apron))
                    )));
                }
                slots = Some((n, k));
            }
            keys.push(VolumeKey { id: slices.id(), apron, slots, is_field: k >= n_layers });
        }
        if of_fields > budget_bytes {
            return Err(Failure::Memory(format!(
                "labels and light take {:.1} MB on the GPU, and {:.1} MB are allowed",
                megabytes(of_fields),
                megabytes(budget_bytes)
            )));
        }
        self.0.retain(|(key, _)| !key.is_field || keys.contains(key));
        // Volumes that this frame does not need are evicted, the least recently used first.
        let bytes_of = |k: usize| match keys[k].slots {
            Some((n, _)) => n * page_bytes(&permutation.sources[k], keys[k].apron),
            None => whole[k],
        };
        let mut kept: usize = self.0.iter().map(|(_, volume)| volume.n_bytes()).sum();
        let is_there = |key: &VolumeKey| self.0.iter().any(|(own, _)| own == key);
        let missing: usize = (0..keys.len()).filter(|k| !is_there(&keys[*k])).map(bytes_of).sum();
        while kept + missing > budget_bytes {
            let Some(oldest) = self.0.iter().position(|(key, _)| !keys.contains(key)) else { break };
            kept -= self.0.remove(oldest).1.n_bytes();
        }
        let mut volumes = Vec::new();
        for ((source, kind), key) in sources.iter().zip(&permutation.sources).zip(&keys) {
            let found = self.0.iter().position(|(own, _)| own == key);
            let (key, volume) = match found {
                Some(place) => self.0.remove(place),
                None => (
                    *key,
                    Arc::new(device.guarded(|| uploaded(device, &source.slices, kind, key.slots.map(|(n, _)| n)))?),
                ),
            };
            volumes.push(volume.clone());
            self.0.push((key, volume));
        }
        Ok(volumes)
    }
}

/// Uploads the samples of a source, or makes empty textures of `slots` pages.
pub(crate) fn uploaded(
    device: &OpenDevice,
    slices: &[&Slices],
    kind: &SourceKind,
    slots: Option<usize>,
) -> GpuResult<GpuVolume> {
    let (size, apron) = (slices[0].grid().size(), apron_of(kind));
    if let Some(n) = slots {
        let pages = Pages::new(device, size, apron, n);
        let (samples, holes) = page_textures(device, kind, &pages)?;
        return Ok(GpuVolume { samples, holes, apron, pages: Some(Mutex::new(pages)) });
    }
    let part = TexelBox::whole(size, apron);
    let samples = SampleTexture::new(device, part.size, kind.format)?;
    upload(device, slices, &samples, part, [0; 3])?;
    let mut holes = None;
    if kind.has_holes {
        let texture = hole_texture(device, part.size)?;
        upload_holes(device, slices[0], &texture, part, [0; 3])?;
        holes = Some(texture);
    }
    Ok(GpuVolume { samples, holes, apron, pages: None })
}

/// Bytes of all samples of a source, with its apron.
fn whole_bytes(slices: &Slices, kind: &SourceKind) -> usize {
    let part = TexelBox::whole(slices.grid().size(), apron_of(kind));
    part.size.iter().product::<usize>() * (kind.format.n_bytes() + usize::from(kind.has_holes))
}
