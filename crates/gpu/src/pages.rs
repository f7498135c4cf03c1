//! Pages: blocks of samples in one texture array, for volumes that do not fit; only visible pages are uploaded.
//!
//! A page has its own samples and an apron of the samples around it that reconstruction reaches, so that no seam can
//! show: a texel is made of the page that holds the sample below it. The plan says which blocks of texels show
//! something, and so which pages are needed.

use std::collections::HashMap;

use wavesplat_core::{Gradient, Kernel};
use wavesplat_splat::render::plan::FamilyPlan;
use wavesplat_splat::source::geometry::SheetGeometry;
use wavesplat_splat::source::slices::Slices;

use crate::band::Band;
use crate::device::OpenDevice;
use crate::failure::GpuResult;
use crate::layout::BLOCK;
use crate::permutation::SourceKind;
use crate::samples::{Apron, SampleTexture, TexelBox, hole_texture, upload, upload_holes};

/// Samples of a page along each axis, without the apron; 6 bits in `shaders/samples.wgsl`.
pub(crate) const PAGE: usize = 64;

/// Bytes that are staged before a wait for the device.
const STAGED_BYTES: usize = 16 << 20;

/// Pages along each axis of a volume.
pub(crate) fn n_pages(size: [usize; 3]) -> [usize; 3] {
    size.map(|n| n.div_ceil(PAGE))
}

/// Texels of a page along each axis.
pub(crate) fn page_side(apron: Apron) -> usize {
    PAGE + apron.low + apron.high
}

/// Bytes of a page.
pub(crate) fn page_bytes(kind: &SourceKind, apron: Apron) -> usize {
    page_side(apron).pow(3) * (kind.format.n_bytes() + usize::from(kind.has_holes))
}

/// Page table of a volume: slot of each resident page, and when it was last used.
pub(crate) struct Pages {
    /// Slots of the texture along x, y, z.
    slots: [usize; 3],
    side: usize,
    /// Pages of the volume along x, y, z.
    grid: [usize; 3],
    /// Slot of each resident page.
    place: HashMap<usize, usize>,
    /// Page in each slot, and when it was last used.
    held: Vec<(Option<usize>, u64)>,
    now: u64,
}

impl Pages {
    /// An empty page table with at most `most` slots.
    pub fn new(device: &OpenDevice, size: [usize; 3], apron: Apron, most: usize) -> Self {
        let (side, grid) = (page_side(apron), n_pages(size));
        let most = most.min(grid.iter().product()).max(1);
        let across = (device.limits.max_texture_dimension_2d as usize / side).max(1);
        let deep = (device.limits.max_texture_array_layers as usize / side).max(1);
        let x = most.min(across);
        let y = (most / x).clamp(1, across);
        let slots = [x, y, (most / (x * y)).clamp(1, deep)];
        let held = vec![(None, 0); slots.iter().product()];
        Self { slots, side, grid, place: HashMap::new(), held, now: 0 }
    }

    /// Number of slots.
    pub fn n_slots(&self) -> usize {
        self.held.len()
    }

    /// Texels of the texture along x, y, z.
    pub fn texture_size(&self) -> [usize; 3] {
        self.slots.map(|n| n * self.side)
    }

    /// Makes pages resident, at most [`Pages::n_slots`] of them. Returns the bytes that were uploaded.
    pub fn hold(
        &mut self,
        device: &OpenDevice,
        (slices, apron): (&Slices, Apron),
        (samples, holes): (&SampleTexture, Option<&SampleTexture>),
        wanted: &[usize],
    ) -> GpuResult<u64> {
        self.now += 1;
        for page in wanted {
            if let Some(slot) = self.place.get(page) {
                self.held[*slot].1 = self.now;
            }
        }
        let missing: Vec<usize> = wanted.iter().copied().filter(|page| !self.place.contains_key(page)).collect();
        // Pages that are wanted now carry this call's time, so that none of them is among the slots that may be
        // evicted.
        // The least recently used pages are evicted first.
        let mut free: Vec<usize> = (0..self.held.len()).filter(|slot| self.held[*slot].1 != self.now).collect();
        free.sort_by_key(|slot| self.held[*slot].1);
        let (mut staged, mut n_bytes) = (0, 0);
        for (page, slot) in missing.into_iter().zip(free) {
            if let Some(old) = self.held[slot].0.replace(page) {
                self.place.remove(&old);
            }
            self.held[slot].1 = self.now;
            self.place.insert(page, slot);
            let at = self.page(page);
            let part = TexelBox { lo: at.map(|i| (i * PAGE) as i64 - apron.low as i64), size: [self.side; 3] };
            let to = self.corner(slot).map(|i| i * self.side);
            upload(device, &[slices], samples, part, to)?;
            if let Some(holes) = holes {
                upload_holes(device, slices, holes, part, to)?;
            }
            let own = self.side.pow(3) * (samples.n_bytes_sample + usize::from(holes.is_some()));
            staged += own;
            n_bytes += own as u64;
            if staged > STAGED_BYTES {
                staged = 0;
                device.queue.submit([]);
                device.wait()?;
            }
        }
        Ok(n_bytes)
    }

    fn page(&self, page: usize) -> [usize; 3] {
        let [nx, ny, _] = self.grid;
        [page % nx, page / nx % ny, page / nx / ny]
    }

    fn corner(&self, slot: usize) -> [usize; 3] {
        let [nx, ny, _] = self.slots;
        [slot % nx, slot / nx % ny, slot / nx / ny]
    }

    /// Slots of all pages, as the shaders read them; 0 for pages that are not resident.
    pub fn table(&self) -> Vec<u32> {
        let mut table = vec![0; self.grid.iter().product()];
        for (page, slot) in &self.place {
            let [x, y, z] = self.corner(*slot);
            table[*page] = (x | y << 10 | z << 20) as u32;
        }
        table
    }
}

/// Textures of all slots: samples, and the hole mask where there is one.
pub(crate) fn page_textures(
    device: &OpenDevice,
    kind: &SourceKind,
    pages: &Pages,
) -> GpuResult<(SampleTexture, Option<SampleTexture>)> {
    let samples = SampleTexture::new(device, pages.texture_size(), kind.format)?;
    let holes = kind.has_holes.then(|| hole_texture(device, pages.texture_size())).transpose()?;
    Ok((samples, holes))
}

/// Pages of a layer that blocks of a band reach in each slab, as sorted lists: every sample read there lies in them.
pub(crate) fn pages_by_slab(
    family: &FamilyPlan,
    geometry: &SheetGeometry,
    band: &Band,
    layer: usize,
    size: [usize; 3],
) -> Vec<Vec<usize>> {
    let n_slabs = family.spacing.n_slabs;
    let n = n_pages(size);
    // Differences read values this far off; the quadratic B-spline stands around the nearest sample, not the one below;
    // and positions are rounded to f32.
    let offset = match geometry.axes[0].gradient {
        Some(Gradient::Difference(offset)) => offset,
        _ => 0.0,
    };
    let nearest = if geometry.axes[0].kernel == Kernel::Bspline2 { 0.5 } else { 0.0 };
    let margin = offset + nearest + 0.01;
    let ascending = family.plane.family.ascending;
    let axes = family.plane.family.axes;
    let sheet = |k: usize| geometry.sheet(family.spacing.w(if ascending { k } else { n_slabs - k }));
    let sheets: Vec<_> = (0..=n_slabs).map(sheet).collect();
    let last = [0, 1, 2].map(|a| geometry.axes[a].last());
    let page = |x: f64, a: usize| x.clamp(0.0, last[a]) as usize / PAGE;
    (0..n_slabs)
        .map(|slab| {
            let ends = [&sheets[slab], &sheets[slab + 1]];
            let w = ends.map(|(_, w)| *w);
            let along_w = [page(w[0].min(w[1]) - margin, 2), page(w[0].max(w[1]) + margin, 2)];
            let mut pages = std::collections::BTreeSet::new();
            let mut before = None;
            for (k, block) in band.blocks.iter().enumerate() {
                if !band.is_occupied(layer, k, slab) {
                    continue;
                }
                let reached = [0, 1].map(|a| {
                    let texels = [block[a] * BLOCK[a], (block[a] + 1) * BLOCK[a] - 1];
                    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
                    for (places, _) in ends {
                        for i in texels {
                            let x = places[a].0 + places[a].1 * i as f64;
                            (lo, hi) = (lo.min(x), hi.max(x));
                        }
                    }
                    [page(lo - margin, a), page(hi + margin, a)]
                });
                // Neighbouring blocks mostly reach the same pages.
                if before.replace(reached) == Some(reached) {
                    continue;
                }
                for u in reached[0][0]..=reached[0][1] {
                    for v in reached[1][0]..=reached[1][1] {
                        for w in along_w[0]..=along_w[1] {
                            let mut at = [0; 3];
                            (at[axes[0]], at[axes[1]], at[axes[2]]) = (u, v, w);
                            pages.insert(at[0] + n[0] * (at[1] + n[1] * at[2]));
                        }
                    }
                }
            }
            pages.into_iter().collect()
        })
        .collect()
}

/// Range of slabs that are drawn with the same pages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PagedRange {
    /// End of the range: one past its last slab.
    pub end: usize,
    /// The pages of each layer.
    pub pages: Vec<Vec<usize>>,
}

/// Ranges of slabs whose pages fit into the `slots` of each layer; `None` where the pages of a single slab do not.
/// `by_slab`: pages per layer and slab.
pub(crate) fn ranges(
    by_slab: &[Vec<Vec<usize>>],
    [first, end]: [usize; 2],
    slots: &[usize],
) -> Option<Vec<PagedRange>> {
    use std::collections::BTreeSet;
    let of = |layer: usize, slab: usize| by_slab[layer].get(slab).into_iter().flatten().copied();
    let mut ranges = Vec::new();
    let mut from = first;
    while from < end {
        // The first sheet of a range may stand for half of the slab before it, whose pages it then reads.
        let start = from.saturating_sub(1);
        let mut held: Vec<BTreeSet<usize>> =
            (0..slots.len()).map(|layer| of(layer, start).collect::<BTreeSet<_>>()).collect();
        let mut to = from;
        while to < end {
            let next: Vec<BTreeSet<usize>> = held
                .iter()
                .enumerate()
                .map(|(layer, held)| held.iter().copied().chain(of(layer, to)).collect())
                .collect();
            if next.iter().zip(slots).any(|(pages, slots)| pages.len() > *slots) {
                break;
            }
            held = next;
            to += 1;
        }
        if to == from {
            return None;
        }
        ranges.push(PagedRange { end: to, pages: held.into_iter().map(|pages| pages.into_iter().collect()).collect() });
        from = to;
    }
    Some(ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_what_their_slabs_reach_and_no_more_than_fits() {
        let by_slab = vec![vec![vec![0, 1], vec![1, 2], vec![2, 3], vec![3], vec![], vec![7, 8]]];
        let found = ranges(&by_slab, [0, 6], &[3]).unwrap();
        assert_eq!(found.last().unwrap().end, 6);
        let mut from = 0;
        for range in &found {
            assert!(range.pages[0].len() <= 3);
            for slab in from.max(1) - 1..range.end {
                assert!(by_slab[0][slab].iter().all(|page| range.pages[0].contains(page)), "slab {slab} of {found:?}");
            }
            from = range.end;
        }
        assert!(found.len() > 1 && ranges(&by_slab, [0, 6], &[2]).is_none());
        assert_eq!(ranges(&by_slab, [0, 6], &[9]).unwrap().len(), 1);
    }
}
