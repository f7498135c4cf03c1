//! Sheets of fields: scalar quantities beside the density, such as how much light gets to a texel, or how much of it is
//! a label.
//!
//! A field has samples of its own, on the volume's grid or an evenly coarser one along the same axes, and is
//! reconstructed in sheets at the same texels, so that it costs a fraction of what a gather at every texel would.

use wavesplat_compute::simd::{Lanes, Wide};

use crate::sheet::buffer::Sheet;
use crate::sheet::tile_layout::{BlockMask, Chunk};
use crate::source::geometry::SheetGeometry;
use crate::source::transposed::TransposedSlices;

/// The sheets of all fields at one place, each made when it is first read.
#[derive(Default)]
pub struct FieldSheets {
    sheets: Vec<Sheet>,
    /// Which of the sheets are made.
    made: Vec<bool>,
    /// Position of the sheets, first texel of the tile, and blocks that may be read.
    place: (f64, [usize; 2], BlockMask),
}

/// The samples of all fields that a run of sheets needs.
pub struct FieldSlices(Vec<TransposedSlices>);

impl FieldSlices {
    /// Samples of `n_fields` fields, none loaded yet.
    pub fn new(n_fields: usize) -> Self {
        Self((0..n_fields).map(|_| TransposedSlices::default()).collect())
    }

    /// Calls [`TransposedSlices::cover`] for every field.
    pub fn cover(
        &mut self,
        geometries: &[SheetGeometry],
        w: [f64; 2],
        ends: [f64; 2],
        texels: impl Fn(&dyn Fn(f64) -> bool) -> [[usize; 2]; 2],
    ) {
        for (transposed, geometry) in self.0.iter_mut().zip(geometries) {
            transposed.cover(geometry, w, ends, &texels);
        }
    }
}

impl FieldSheets {
    /// Moves the sheets to `w`, to be made anew; `blocks` of the tile whose first texel is `first` may then be read.
    pub fn place(&mut self, n_fields: usize, w: f64, first: [usize; 2], blocks: BlockMask) {
        self.place = (w, first, blocks);
        self.sheets.resize_with(n_fields, Sheet::default);
        self.made.clear();
        self.made.resize(n_fields, false);
    }

    /// Combines the slices of a field at the place of the sheets.
    #[inline(never)]
    fn make(&mut self, (geometries, transposed): (&[SheetGeometry], &FieldSlices), field: usize) {
        self.made[field] = true;
        let (w, first, blocks) = self.place;
        let (before, rest) = self.sheets.split_at_mut(field);
        let Some((sheet, _)) = rest.split_first_mut() else { return };
        // Most fields have the same grid, and so the same weights.
        let alike = (0..field).find(|&k| self.made[k] && geometries[k].has_weights_of(&geometries[field]));
        let weights = alike.map(|k| &before[k]);
        sheet.combine_with(&geometries[field], &transposed.0[field], weights, w, first, blocks);
    }

    /// Reads the value of a field at one chunk or two. After [`FieldSheets::place`] with their block.
    #[inline(always)]
    pub fn read<W: Wide>(
        &mut self,
        w: W,
        from: (&[SheetGeometry], &FieldSlices),
        field: usize,
        chunks: [Chunk; 2],
        out: &mut FieldValues,
    ) {
        if !self.made[field] {
            self.make(from, field);
        }
        let sheet = &mut self.sheets[field];
        sheet.prepare(&from.0[field], chunks[0].block().mask());
        out.values.resize(self.made.len(), Default::default());
        w.store_to(sheet.density(w, chunks), &mut out.values[field], [0, 1]);
        if from.0[field].slices.has_mask() {
            out.missing.resize(self.made.len(), Default::default());
            w.store_to(sheet.missing(w, chunks), &mut out.missing[field], [0, 1]);
        }
    }

    /// Reads the gradient of a field whose value has been read.
    #[inline(always)]
    pub fn read_gradient<W: Wide>(
        &mut self,
        w: W,
        (geometries, transposed): (&[SheetGeometry], &FieldSlices),
        field: usize,
        chunks: [Chunk; 2],
        out: &mut FieldValues,
    ) {
        let sheet = &mut self.sheets[field];
        sheet.prepare_gradient(&geometries[field], &transposed.0[field], chunks[0].block());
        let gradient = sheet.gradient(w, chunks);
        for c in 0..3 {
            w.store_to(gradient[c], &mut out.gradient[c], [0, 1]);
        }
    }
}

/// Values of fields at one chunk or two: in memory, since there may be any number of fields.
#[derive(Default)]
pub struct FieldValues {
    values: Vec<[Lanes; 2]>,
    /// Missing shares, of fields with missing samples.
    missing: Vec<[Lanes; 2]>,
    gradient: [[Lanes; 2]; 3],
}

impl FieldValues {
    /// Value of a field.
    #[inline(always)]
    pub fn value<W: Wide>(&self, w: W, field: usize) -> W::F {
        w.load_from(&self.values[field], [0, 1])
    }

    /// Missing share of a field with missing samples.
    #[inline(always)]
    fn missing<W: Wide>(&self, w: W, field: usize) -> W::F {
        w.load_from(&self.missing[field], [0, 1])
    }

    /// The gradient that was read, along u, v, w per index step of the field.
    #[inline(always)]
    pub fn gradient<W: Wide>(&self, w: W) -> [W::F; 3] {
        let [u, v, n] = &self.gradient;
        [w.load_from(u, [0, 1]), w.load_from(v, [0, 1]), w.load_from(n, [0, 1])]
    }
}

/// A place to read fields at: on a sheet, or part of the way to the next one.
pub struct FieldPoint<'a, W: Wide> {
    front: &'a FieldValues,
    back: Option<(&'a FieldValues, W::F)>,
}

impl<'a, W: Wide> FieldPoint<'a, W> {
    /// A place on a sheet.
    #[inline(always)]
    pub fn on(sheet: &'a FieldValues) -> Self {
        Self { front: sheet, back: None }
    }

    /// A place at a fraction of the way from one sheet to the next.
    #[inline(always)]
    pub fn between([front, back]: &'a [FieldValues; 2], share: W::F) -> Self {
        Self { front, back: Some((back, share)) }
    }

    /// Value of a field at this place.
    #[inline(always)]
    pub fn value(&self, w: W, field: usize) -> W::F {
        let front = self.front.value(w, field);
        match self.back {
            Some((back, share)) => w.add_mul(front, share, w.sub(back.value(w, field), front)),
            None => front,
        }
    }

    /// Missing share at this place of a field with missing samples.
    #[inline(always)]
    pub fn missing(&self, w: W, field: usize) -> W::F {
        let front = self.front.missing(w, field);
        match self.back {
            Some((back, share)) => w.add_mul(front, share, w.sub(back.missing(w, field), front)),
            None => front,
        }
    }

    /// The gradient that was read, at this place.
    #[inline(always)]
    pub fn gradient(&self, w: W) -> [W::F; 3] {
        let mut gradient = self.front.gradient(w);
        if let Some((back, share)) = self.back {
            let back = back.gradient(w);
            for c in 0..3 {
                gradient[c] = w.add_mul(gradient[c], share, w.sub(back[c], gradient[c]));
            }
        }
        gradient
    }
}
