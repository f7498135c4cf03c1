//! The sheet of one tile: densities, and their gradient, at every texel of a plane parallel to the slices.
//!
//! Separable: slices are combined along w at sample resolution, then rows along u, then columns along v, so a tricubic
//! kernel costs 4 + 4 + 4 taps per texel at most, and less where texels are denser than samples. The gradient comes
//! from difference footprints along each axis; through the sheet it needs no neighbouring sheet.
//!
//! A tile is cut into strips of [`LANES`] texels along u; a strip's row is what kernels work on at once, a *chunk*.
//! Chunks are reconstructed when they are first asked for, their gradient only where something is seen.

use std::ops::Range;
use wavesplat_compute::simd::{Kernel, LANES, Lanes, Level, Math, Simd, Wide};

use wavesplat_core::Variant;

use crate::base_plane::BasePlane;
use crate::fields::Field;
use crate::footprint::{
    Axis, AxisFootprints, Difference, Footprint, Group, MAX_DIFFERENCE_TAPS, SliceTaps, Span, bits,
};
use crate::noise::{NoisySheet, noisy_entries, sheet_number};
use crate::panel::Panel;
use crate::slices::Slices;
use crate::weights::Weights;
use crate::window::Window;

/// Strips of a tile.
pub const N_STRIPS: usize = 4;

/// Texels of a tile along u.
pub const TILE_U: usize = N_STRIPS * LANES;

/// Texels of a tile along v.
pub const TILE_V: usize = 32;

/// Rows of a block: a strip's rows are looked at, and left out, in blocks.
pub const BLOCK_V: usize = 8;

/// Blocks of a tile, strip by strip, as bits.
pub type BlockMask = u16;

/// Blocks along v.
pub const N_BLOCKS_V: usize = TILE_V / BLOCK_V;

/// A strip's row.
#[derive(Clone, Copy, Debug)]
pub struct Chunk {
    /// Strip of the tile.
    pub strip: usize,
    /// Row of the tile.
    pub row: usize,
}

impl Chunk {
    /// Chunks of a tile.
    pub const N: usize = N_STRIPS * TILE_V;

    /// The block that it belongs to.
    #[inline(always)]
    pub fn block(self) -> Block {
        Block { strip: self.strip, row: self.row / BLOCK_V * BLOCK_V }
    }

    /// Place among the chunks of a tile.
    #[inline(always)]
    pub fn index(self) -> usize {
        self.strip * TILE_V + self.row
    }
}

/// Rows of a strip that are looked at together.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Strip of the tile.
    pub strip: usize,
    /// First row of the tile.
    pub row: usize,
}

impl Block {
    /// A block by its place among the blocks of a tile.
    pub fn new(place: usize) -> Self {
        Self { strip: place / N_BLOCKS_V, row: place % N_BLOCKS_V * BLOCK_V }
    }

    /// Place among the blocks of a tile.
    #[inline(always)]
    pub fn place(self) -> usize {
        self.strip * N_BLOCKS_V + self.row / BLOCK_V
    }

    /// It alone, as a mask.
    #[inline(always)]
    pub fn mask(self) -> BlockMask {
        1 << self.place()
    }

    /// Its chunks.
    #[inline(always)]
    pub fn chunks(self) -> impl Iterator<Item = Chunk> {
        (self.row..self.row + BLOCK_V).map(move |row| Chunk { strip: self.strip, row })
    }

    /// Its chunks, two by two.
    #[inline(always)]
    pub fn pairs(self) -> impl Iterator<Item = [Chunk; 2]> {
        let chunk = move |row| Chunk { strip: self.strip, row };
        (self.row..self.row + BLOCK_V).step_by(2).map(move |row| [chunk(row), chunk(row + 1)])
    }

    #[inline(always)]
    fn rows(self) -> Range<usize> {
        self.row..self.row + BLOCK_V
    }
}

/// Sheet-wide facts of one base plane.
pub struct SheetGeometry<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    /// Samples.
    pub slices: &'a Slices<'a>,
    /// Axes u, v, w with kernel and gradient offset.
    pub axes: [Axis; 3],
    /// Entries per sample distance of a footprint table with noise on the samples, where there is one.
    pub noisy_entries: Option<u32>,
    /// Vectors to use.
    pub level: Level,
    /// Position among the samples of index position 0, along u, v, w, and per index step: fields may be coarser.
    from_index: [(f64, f64); 3],
}

impl<'a> SheetGeometry<'a> {
    /// `gradient_offset`: half distance of differences, voxels; `None` where no gradient is wanted. `sheet_step`: slice
    /// distances between sheets.
    pub fn new(
        level: Level,
        plane: &'a BasePlane,
        slices: &'a Slices<'a>,
        size: [usize; 3],
        gradient_offset: Option<f64>,
        variant: &Variant,
        sheet_step: f64,
    ) -> Self {
        let [u, v, w] = plane.family.axes;
        let axis = |a: usize, weights, difference: &dyn Fn(f64) -> Difference| Axis {
            kernel: slices.kernel(),
            n_samples: size[a],
            difference: gradient_offset.map(difference),
            weights,
        };
        let within = |a: usize| axis(a, Weights::within(variant), &|d| Difference::within(variant.gradient, d));
        let across = |d| Difference::across(variant.gradient, d, sheet_step);
        let axes = [within(u), within(v), axis(w, Weights::across(variant), &across)];
        Self { plane, slices, axes, noisy_entries: noisy_entries(variant), level, from_index: [(0.0, 1.0); 3] }
    }

    /// The same texels over the samples of a field, which has no variants.
    pub fn of_field(level: Level, plane: &'a BasePlane, field: &'a Field<'a>) -> Self {
        let size = field.slices.grid().size();
        let from_index = plane.family.axes.map(|a| field.from_index[a]);
        let own = Self::new(level, plane, &field.slices, size, field.gradient_offset, &Variant::default(), 1.0);
        Self { from_index, ..own }
    }

    /// Whether its sheets have the same weights as those of another geometry of the same base plane, or more.
    pub fn has_weights_of(&self, other: &Self) -> bool {
        let is_alike = |a: &Axis, b: &Axis| {
            (a.kernel, a.n_samples, a.weights) == (b.kernel, b.n_samples, b.weights)
                && (b.difference.is_none() || a.difference == b.difference)
        };
        self.from_index == other.from_index && self.axes.iter().zip(&other.axes).all(|(a, b)| is_alike(a, b))
    }

    /// Whether index positions are those of the samples.
    pub fn is_own_grid(&self) -> bool {
        self.from_index == [(0.0, 1.0); 3]
    }

    /// Where the texels of the sheet at an index position w lie among the samples: position of texel 0 and change per
    /// texel, along u and v, and position along w.
    fn sheet(&self, w: f64) -> ([(f64, f64); 2], f64) {
        let [u, v] = self.plane.sheet(w);
        let [of_u, of_v, (origin_w, per_w)] = self.from_index;
        let inside = |(x, dx): (f64, f64), (origin, per_index): (f64, f64)| (origin + per_index * x, per_index * dx);
        ([inside(u, of_u), inside(v, of_v)], origin_w + per_w * w)
    }

    /// The first slice that the rays meet behind some.
    fn slice_behind(&self, slices: &SliceTaps) -> Option<usize> {
        let (_, per_w) = self.from_index[2];
        let slices = slices.iter().map(|(slice, _)| *slice);
        if self.plane.family.ascending == (per_w > 0.0) {
            slices.max().map(|last| last + 1).filter(|slice| *slice < self.axes[2].n_samples)
        } else {
            slices.min()?.checked_sub(1)
        }
    }
}

/// Numbers that combined slices are padded with, so that whole vectors can be read from any sample on.
const PADDING: usize = LANES + 12;

/// Work space and result of one tile's sheet. Made once per tile, reused for all its sheets.
#[derive(Default)]
pub struct Sheet {
    w: f64,
    u: AxisFootprints,
    v: AxisFootprints,
    /// The part of the tile's samples that is combined.
    part: Option<Part>,
    stride: usize,
    n_v: usize,
    /// Rows of a strip that are upsampled along u: one per sample row.
    n_rows: usize,
    /// Position of the tile's first texel and distance to the next, samples; only with noise.
    first_texel: [f64; 2],
    texel_step: [f64; 2],
    /// Combined slices at sample resolution: density, derivative through the sheet, holes.
    density: Vec<f32>,
    through: Vec<f32>,
    holes: Vec<f32>,
    has_through: bool,
    /// The same upsampled along u, strip by strip: density, derivative along u, derivative through the sheet, holes.
    density_u: Vec<Lanes>,
    along_u: Vec<Lanes>,
    through_u: Vec<Lanes>,
    holes_u: Vec<Lanes>,
    /// Which of those rows every row of texels is made of, for values and for differences along v.
    rows: Vec<RowTaps>,
    difference_rows: Vec<RowTaps>,
    /// Sample rows that have been upsampled: densities, derivatives.
    has_density_u: Vec<bool>,
    has_gradient_u: Vec<bool>,
    /// Blocks that it is made for.
    blocks: BlockMask,
    /// Blocks whose sample rows have been upsampled.
    has_density: BlockMask,
    has_gradient: BlockMask,
}

/// The footprint of a row of texels, as blending reads it: in one place.
#[derive(Clone, Copy, Default)]
struct RowTaps {
    first: usize,
    weights: [f32; MAX_DIFFERENCE_TAPS],
}

impl RowTaps {
    /// Those of the rows of blocks.
    fn fill(rows: &mut Vec<Self>, footprint: &Footprint, blocks: BlockMask) {
        rows.resize(TILE_V, Self::default());
        for b in block_rows(blocks) {
            for row in b * BLOCK_V..(b + 1) * BLOCK_V {
                let RowTaps { first, weights } = &mut rows[row];
                *first = footprint.first(row);
                (0..footprint.n_taps).for_each(|t| weights[t] = footprint.weight(row, t));
            }
        }
    }
}

/// Rows and columns of combined slices, counted from the tile's first sample.
#[derive(Clone)]
struct Part {
    u: Range<usize>,
    v: Range<usize>,
}

impl Sheet {
    /// Combines the slices that reach the sheet at `w` for those `blocks` of the tile whose first texel is `first`.
    pub fn combine(&mut self, geometry: &SheetGeometry, panel: &Panel, w: f64, first: [usize; 2], blocks: BlockMask) {
        self.combine_with(geometry, panel, None, w, first, blocks);
    }

    /// As [`Sheet::combine`], with the weights of a sheet at the same place ([`SheetGeometry::has_weights_of`]).
    pub fn combine_with(
        &mut self,
        geometry: &SheetGeometry,
        panel: &Panel,
        weights: Option<&Self>,
        w: f64,
        [i0, j0]: [usize; 2],
        blocks: BlockMask,
    ) {
        self.has_density = 0;
        self.has_gradient = 0;
        let ([(u0, du), (v0, dv)], w) = geometry.sheet(w);
        self.w = w;
        let [axis_u, axis_v, axis_w] = &geometry.axes;
        let strips = (0..N_STRIPS).filter(|s| blocks >> (s * N_BLOCKS_V) & ((1 << N_BLOCKS_V) - 1) != 0);
        let rows = block_rows(blocks);
        match weights {
            Some(weights) => {
                self.u.copy(axis_u, &weights.u);
                self.v.copy(axis_v, &weights.v);
            }
            None => geometry.level.run(
                #[inline(always)]
                || {
                    let groups_v = rows.clone().fold(0, |all, b| all | 1 << (b * BLOCK_V / LANES));
                    let groups_u = strips.clone().fold(0, |all, s| all | 1 << s);
                    self.u.build(axis_u, [u0 + du * i0 as f64, du], N_STRIPS, groups_u);
                    self.v.build(axis_v, [v0 + dv * j0 as f64, dv], TILE_V / LANES, groups_v);
                },
            ),
        }
        let n_u = (self.u.window[1] - self.u.window[0] + 1) as usize;
        self.n_v = (self.v.window[1] - self.v.window[0] + 1) as usize;
        self.stride = n_u.next_multiple_of(LANES) + PADDING.next_multiple_of(LANES);
        // With noise: a row per texel row, of values, and another, of derivatives along v.
        self.n_rows = if geometry.noisy_entries.is_some() { 2 * TILE_V } else { self.n_v };
        for rows in [&mut self.density_u, &mut self.along_u, &mut self.through_u] {
            rows.resize(N_STRIPS * self.n_rows, Lanes::default());
        }
        for flags in [&mut self.has_density_u, &mut self.has_gradient_u] {
            flags.clear();
            flags.resize(N_STRIPS * self.n_rows, false);
        }
        self.density.resize(self.stride * self.n_v, 0.0);
        self.has_through = false;
        // Positions rise or fall with the texel.
        let columns = strips.flat_map(|s| [s * LANES, s * LANES + LANES - 1]);
        let rows = rows.flat_map(|b| [b * BLOCK_V, b * BLOCK_V + BLOCK_V - 1]);
        let part = Part { u: reached(&self.u, columns), v: reached(&self.v, rows) };
        let taps = axis_w.slice_taps(w);
        let axes = geometry.plane.family.axes;
        let (first, window) = self.place(&part);
        let density = &mut self.density[first..];
        if !panel.combine(geometry, &taps, window, density, self.stride) {
            let soon = geometry.slice_behind(&taps);
            geometry.slices.combine(geometry.level, axes, &taps, soon, window, density, self.stride);
        }
        if geometry.slices.has_mask() {
            self.holes.resize(self.stride * self.n_v, 0.0);
            self.holes_u.resize(N_STRIPS * self.n_rows, Lanes::default());
            // A hole counts wherever it has a weight, of either sign.
            let taps = taps.magnitudes();
            geometry.slices.combine_mask(geometry.level, axes, &taps, window, &mut self.holes[first..], self.stride);
        }
        self.part = Some(part);
        if geometry.noisy_entries.is_some() {
            self.u.make_difference();
            self.v.make_difference();
            // Texels are splatted one by one, and stand where their sample rows would.
            self.first_texel = [u0 + du * i0 as f64, v0 + dv * j0 as f64];
            self.texel_step = [du, dv];
            self.v.value.make_one_to_one(TILE_V / LANES, 0);
            self.v.difference.make_one_to_one(TILE_V / LANES, TILE_V);
        }
        self.blocks = blocks;
        RowTaps::fill(&mut self.rows, &self.v.value, blocks);
    }

    /// First number and samples of a part.
    fn place(&self, part: &Part) -> (usize, Window) {
        let window = |axis: &AxisFootprints, range: &Range<usize>| {
            [axis.window[0] + range.start as i64, axis.window[0] + range.end as i64 - 1]
        };
        let first = part.v.start * self.stride + part.u.start;
        (first, Window { u: window(&self.u, &part.u), v: window(&self.v, &part.v) })
    }

    /// Makes the densities of blocks ready. After [`Sheet::combine`] for them.
    pub fn prepare(&mut self, geometry: &SheetGeometry, blocks: BlockMask) {
        let blocks = blocks & !self.has_density;
        if blocks == 0 {
            return;
        }
        self.has_density |= blocks;
        if let Some(per_sample) = geometry.noisy_entries {
            bits(blocks).for_each(|place| self.splat_density(geometry, per_sample, Block::new(place)));
            return;
        }
        geometry.level.dispatch(Upsample::<false> { sheet: self, geometry, blocks });
    }

    /// Makes the gradient of a block ready. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn prepare_gradient(&mut self, geometry: &SheetGeometry, panel: &Panel, block: Block) {
        if self.has_gradient & block.mask() == 0 {
            self.make_gradient(geometry, panel, block);
        }
    }

    /// By itself, so that compositing stays small: compilers keep more of what it works on in registers.
    #[inline(never)]
    fn make_gradient(&mut self, geometry: &SheetGeometry, panel: &Panel, block: Block) {
        let blocks = block.mask();
        self.has_gradient |= blocks;
        if !self.has_through {
            self.combine_through(geometry, panel);
            geometry.level.run(
                #[inline(always)]
                || {
                    self.u.make_difference();
                    self.v.make_difference();
                },
            );
            RowTaps::fill(&mut self.difference_rows, &self.v.difference, self.blocks);
        }
        if let Some(per_sample) = geometry.noisy_entries {
            return self.splat_gradient(geometry, per_sample, block);
        }
        geometry.level.dispatch(Upsample::<true> { sheet: self, geometry, blocks });
    }

    /// What noisy texels are splatted by.
    fn noisy<'g>(&self, geometry: &'g SheetGeometry, per_sample: u32) -> NoisySheet<'g> {
        let [u, v, _] = &geometry.axes;
        let first = [self.u.window[0], self.v.window[0]];
        NoisySheet { axes: [u, v], per_sample, sheet: sheet_number(self.w), first, stride: self.stride }
    }

    /// Rows of a block with noise, the place of each and the positions of its texels.
    fn texels(&self, block: Block) -> impl Iterator<Item = (usize, [[f64; 2]; LANES])> + use<> {
        let ([u, v], [du, dv]) = (self.first_texel, self.texel_step);
        let (strip, n_rows) = (block.strip, self.n_rows);
        block.rows().map(move |row| {
            let at = |lane: usize| [u + du * (strip * LANES + lane) as f64, v + dv * row as f64];
            (strip * n_rows + row, std::array::from_fn(at))
        })
    }

    /// Densities of a block with noise.
    #[inline(never)]
    fn splat_density(&mut self, geometry: &SheetGeometry, per_sample: u32, block: Block) {
        let noisy = self.noisy(geometry, per_sample);
        for (place, texels) in self.texels(block) {
            self.density_u[place] = Lanes(texels.map(|at| noisy.value(&self.density, at) as f32));
            if geometry.slices.has_mask() {
                self.holes_u[place] = Lanes(texels.map(|at| f32::from(u8::from(noisy.reaches(&self.holes, at)))));
            }
        }
    }

    /// Gradient of a block with noise.
    #[inline(never)]
    fn splat_gradient(&mut self, geometry: &SheetGeometry, per_sample: u32, block: Block) {
        let noisy = self.noisy(geometry, per_sample);
        let [du, dv] = self.texel_step;
        let [u, v, _] = &geometry.axes;
        let (Some(along_u), Some(along_v)) = (u.difference, v.difference) else { return };
        let (along_u, along_v) = (along_u.of_step(du), along_v.of_step(dv));
        for (place, texels) in self.texels(block) {
            let derivative =
                |axis, difference| Lanes(texels.map(|at| noisy.derivative(&self.density, at, axis, difference) as f32));
            let (along_u, along_v) = (derivative(0, along_u), derivative(1, along_v));
            self.along_u[place] = along_u;
            self.density_u[place + TILE_V] = along_v;
            self.through_u[place] = Lanes(texels.map(|at| noisy.value(&self.through, at) as f32));
        }
    }

    /// Densities of one chunk or two. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn density<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        blend_rows(w, &self.density_u[chunks[0].strip * self.n_rows..], (&self.rows, self.v.value.n_taps), chunks)
    }

    /// Where chunks reach a hole. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn hole<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::M {
        let s = w.one();
        let [mut first, mut second] = [s.splat(0.0); 2];
        let rows = &self.holes_u[chunks[0].strip * self.n_rows..];
        for t in 0..self.v.value.n_taps {
            for (sum, chunk) in [(&mut first, chunks[0]), (&mut second, chunks[1])] {
                let weight = s.splat(self.v.value.weight(chunk.row, t).abs());
                *sum = s.add_mul(*sum, weight, s.load(&rows[self.v.value.first(chunk.row) + t].0));
            }
        }
        w.lt(w.splat(0.0), w.join(first, second))
    }

    /// Derivatives of one chunk or two along u, v, w per index step, where the geometry has a gradient offset. After
    /// [`Sheet::prepare_gradient`].
    #[inline(always)]
    pub fn gradient<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> [W::F; 3] {
        let first = chunks[0].strip * self.n_rows;
        let of_value = (&self.rows[..], self.v.value.n_taps);
        let of_difference = (&self.difference_rows[..], self.v.difference.n_taps);
        [
            blend_rows(w, &self.along_u[first..], of_value, chunks),
            blend_rows(w, &self.density_u[first..], of_difference, chunks),
            blend_rows(w, &self.through_u[first..], of_value, chunks),
        ]
    }

    /// The derivative through the sheet at sample resolution.
    fn combine_through(&mut self, geometry: &SheetGeometry, panel: &Panel) {
        let Some(part) = self.part.clone() else { return };
        self.has_through = true;
        self.through.resize(self.stride * self.n_v, 0.0);
        let taps = geometry.axes[2].slice_difference_taps(self.w);
        let axes = geometry.plane.family.axes;
        let (first, window) = self.place(&part);
        let through = &mut self.through[first..];
        if !panel.combine(geometry, &taps, window, through, self.stride) {
            let soon = geometry.slice_behind(&taps);
            geometry.slices.combine(geometry.level, axes, &taps, soon, window, through, self.stride);
        }
    }
}

/// Rows of blocks that have any of a mask.
fn block_rows(blocks: BlockMask) -> impl Iterator<Item = usize> + Clone {
    (0..N_BLOCKS_V).filter(move |b| blocks & (rows_mask() << b) != 0)
}

/// The first block row of every strip.
pub const fn rows_mask() -> BlockMask {
    let mut mask = 0;
    let mut strip = 0;
    while strip < N_STRIPS {
        mask |= 1 << (strip * N_BLOCKS_V);
        strip += 1;
    }
    mask
}

/// Samples that the value and the difference of any of the positions reach.
fn reached(axis: &AxisFootprints, positions: impl Iterator<Item = usize>) -> Range<usize> {
    let (mut start, mut end) = (usize::MAX, 0);
    for i in positions {
        let reached = axis.reached(i);
        (start, end) = (start.min(reached.start), end.max(reached.end));
    }
    start.min(end)..end
}

/// Upsamples the sample rows of blocks along u, where that is not done yet: densities and holes, or what gradients need.
struct Upsample<'a, const GRADIENT: bool> {
    sheet: &'a mut Sheet,
    geometry: &'a SheetGeometry<'a>,
    blocks: BlockMask,
}

impl<const GRADIENT: bool> Kernel for Upsample<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { sheet, geometry, blocks } = self;
        for block in bits(blocks).map(Block::new) {
            let footprints = &sheet.u;
            let span = footprints.value.group(block.strip).span;
            let is_alike = !GRADIENT || footprints.difference.group(block.strip).span == span;
            // One loop per span, so that nothing is asked per tap.
            match span {
                Span::One if is_alike => sheet.upsample::<S, 1, GRADIENT>(s, geometry, block),
                Span::Two if is_alike => sheet.upsample::<S, 2, GRADIENT>(s, geometry, block),
                _ => sheet.upsample::<S, 0, GRADIENT>(s, geometry, block),
            }
        }
    }
}

impl Sheet {
    /// `N_VECTORS`: of samples that hold those of a tap for a chunk; 0 if more than two.
    #[inline(always)]
    fn upsample<S: Simd, const N_VECTORS: usize, const GRADIENT: bool>(
        &mut self,
        s: S,
        geometry: &SheetGeometry,
        block: Block,
    ) {
        let strip = block.strip;
        let of_value = self.u.value.group(strip);
        let mut rows = reached_by(&self.v.value, block.rows());
        if GRADIENT {
            let of_difference = self.u.difference.group(strip);
            for r in rows {
                let place = strip * self.n_rows + r;
                if !self.has_gradient_u[place] {
                    self.has_gradient_u[place] = true;
                    let samples = r * self.stride..(r + 1) * self.stride;
                    let along = upsample::<S, N_VECTORS>(s, &self.density[samples.clone()], &of_difference);
                    let through = upsample::<S, N_VECTORS>(s, &self.through[samples], &of_value);
                    s.store(along, &mut self.along_u[place].0);
                    s.store(through, &mut self.through_u[place].0);
                }
            }
            // The derivative along v reaches further than the density did.
            rows = reached_by(&self.v.difference, block.rows());
        }
        for r in rows {
            let place = strip * self.n_rows + r;
            if !self.has_density_u[place] {
                self.has_density_u[place] = true;
                let samples = r * self.stride..(r + 1) * self.stride;
                let density = upsample::<S, N_VECTORS>(s, &self.density[samples.clone()], &of_value);
                s.store(density, &mut self.density_u[place].0);
                if geometry.slices.has_mask() {
                    let holes = upsample_magnitude(s, &self.holes[samples], &of_value);
                    s.store(holes, &mut self.holes_u[place].0);
                }
            }
        }
    }
}

/// A row of samples becomes a chunk.
#[inline(always)]
fn upsample<S: Simd, const N_VECTORS: usize>(s: S, samples: &[f32], group: &Group) -> S::F {
    let mut sum = s.splat(0.0);
    for (t, weights) in group.weights.iter().enumerate() {
        let samples = &samples[group.base + t..];
        let taken = match N_VECTORS {
            1 => take_near(s, samples, group),
            2 => take_near_or_far(s, samples, group),
            _ => take_one_by_one(s, samples, group),
        };
        sum = s.add_mul(sum, s.load(&weights.0), taken);
    }
    sum
}

/// The same with the weights' magnitudes.
#[inline(always)]
fn upsample_magnitude<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    let mut sum = s.splat(0.0);
    for (t, weights) in group.weights.iter().enumerate() {
        let samples = take_one_by_one(s, &samples[group.base + t..], group);
        sum = s.add_mul(sum, s.abs(s.load(&weights.0)), samples);
    }
    sum
}

/// `samples[index]` where all are in one vector. Rows are padded, so that they always hold two vectors more.
#[inline(always)]
fn take_near<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    s.take(samples.first_chunk().unwrap_or(&[0.0; LANES]), group.index)
}

/// `samples[index]` where all are in two vectors.
#[inline(always)]
fn take_near_or_far<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    let (near, far) = samples.split_at(LANES.min(samples.len()));
    // Indices are taken modulo the lanes.
    let is_far = s.lt(s.splat(0.0), s.load(&group.far.0));
    s.select(is_far, take_near(s, far, group), take_near(s, near, group))
}

/// `samples[index]` anywhere.
#[inline(always)]
fn take_one_by_one<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    let mut out = [0.0; LANES];
    for i in 0..LANES {
        out[i] = samples[group.index.0[i] as usize];
    }
    s.load(&out)
}

/// Sample rows that the texel rows reach.
#[inline(always)]
fn reached_by(footprint: &Footprint, rows: Range<usize>) -> Range<usize> {
    // Positions rise or fall with the row.
    let (a, b) = (footprint.first(rows.start), footprint.first(rows.end - 1));
    a.min(b)..a.max(b) + footprint.n_taps
}

/// One chunk or two out of the sample rows that reach them. `taps`: of every row of texels, and how many of them count.
#[inline(always)]
fn blend_rows<W: Wide>(w: W, rows: &[Lanes], taps: (&[RowTaps], usize), chunks: [Chunk; 2]) -> W::F {
    let first = blend_row(w.one(), rows, taps, chunks[0].row);
    let second = if W::N == 2 { blend_row(w.one(), rows, taps, chunks[1].row) } else { first };
    w.join(first, second)
}

#[inline(always)]
fn blend_row<S: Simd>(s: S, rows: &[Lanes], (taps, n_taps): (&[RowTaps], usize), row: usize) -> S::F {
    let RowTaps { first, weights } = &taps[row];
    let rows = &rows[*first..];
    // The usual numbers of taps, unrolled.
    match n_taps {
        2 => blend_taps::<S, 2>(s, rows, weights),
        4 => blend_taps::<S, 4>(s, rows, weights),
        6 => blend_taps::<S, 6>(s, rows, weights),
        _ => {
            let mut sum = s.splat(0.0);
            for (samples, weight) in rows.iter().zip(&weights[..n_taps]) {
                sum = s.add_mul(sum, s.splat(*weight), s.load(&samples.0));
            }
            sum
        }
    }
}

#[inline(always)]
fn blend_taps<S: Simd, const N: usize>(s: S, rows: &[Lanes], weights: &[f32; MAX_DIFFERENCE_TAPS]) -> S::F {
    let mut sum = s.splat(0.0);
    if let Some(rows) = rows.first_chunk::<N>() {
        for t in 0..N {
            sum = s.add_mul(sum, s.splat(weights[t]), s.load(&rows[t].0));
        }
    }
    sum
}
