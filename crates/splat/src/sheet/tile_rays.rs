//! Rays of a tile: intervals inside the volume, directions, and slab thickness along them (view-angle correction).
//!
//! Positions along rays are `s`: the slice coordinate w with the sign that makes it grow away from the eye.

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_compute::simd::{LANES, Lanes, Level, Simd, Wide};

use crate::sheet::tile_layout::{Chunk, N_STRIPS, TILE_V};
use crate::view::base_plane::BasePlane;
use crate::view::depth_cue::DepthCue;
use crate::view::index_frame::world_gradient_from_index;
use crate::view::part::Part;
use crate::view::region::Region;
use crate::view::silhouette::Silhouette;

/// Rays of the texels of a tile, chunk by chunk.
pub struct Rays {
    /// Interval of s that each ray draws; empty where lo ≥ hi.
    intervals: Vec<[Lanes; 2]>,
    /// Interval of s that all rays of a chunk draw.
    common: Vec<[f32; 2]>,
    /// Largest s at which a ray of a chunk enters the drawn region.
    last_entry: Vec<f32>,
    /// Where each ray begins, where intervals are cut at surfaces; else empty.
    begins: Vec<Lanes>,
    /// Largest s at which a ray of a chunk ends, where they end at surfaces; else empty.
    last_exit: Vec<f32>,
    /// Where each ray enters the drawn region, in s; empty where it begins there, as all rays do without parts.
    entries: Vec<Lanes>,
    /// Entries into matter of the rays that enter the region in another part, infinitely far in front for other rays;
    /// empty without parts.
    outer_entries: Vec<Lanes>,
    /// Rays that draw nothing, as bits.
    missed: Vec<u16>,
    /// Rays that draw nothing of the segment that they are cut to, as bits.
    idle: Vec<u16>,
    /// Directions by chunk; a single entry where rays are parallel.
    directions: Vec<Directions>,
    /// Depth shading along each ray: the factor at s = 0, and its change per s; empty without a depth cue.
    fades: Vec<[Lanes; 2]>,
}

/// Directions of the rays of a chunk.
#[derive(Clone, Copy)]
pub struct Directions {
    /// Length of one slice distance along the ray, `dz / cos θ`, in `opacity_unit`s: the view-angle correction.
    pub thickness: Lanes,
    /// Unit world vectors towards the eye, as forms on index gradients ([`world_gradient_from_index`]).
    pub to_eye: [Lanes; 3],
}

/// Geometry that the rays of all tiles of a base plane share.
pub struct RayGeometry<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    /// The region that is drawn.
    pub region: &'a Region,
    /// The region for rays that miss everything, its walls further out ([`crate::view::silhouette`]).
    pub widened: Region,
    /// The regions of all layers.
    pub silhouette: &'a Silhouette,
    /// The part of space that is drawn of these regions; `None`: all.
    pub part: Option<Part>,
    /// World position of an index position.
    pub world_from_index: DAffine3,
    /// World steps, by column, between the samples whose differences make gradients.
    pub gradient_steps: DMat3,
    /// World length that opacities refer to.
    pub opacity_unit: f64,
    /// Depth shading, where it is wanted.
    pub depth_cue: Option<DepthCue>,
}

impl Rays {
    /// The rays of a tile whose first texel is `(i0, j0)`, and the smallest interval of w that holds all that they
    /// draw.
    pub fn new(geometry: &RayGeometry, level: Level, [i0, j0]: [usize; 2]) -> (Self, [f64; 2]) {
        let plane = geometry.plane;
        let mut rays = Self {
            intervals: vec![[Lanes::splat(0.0); 2]; Chunk::N],
            common: vec![[0.0; 2]; Chunk::N],
            last_entry: vec![f32::NEG_INFINITY; Chunk::N],
            begins: Vec::new(),
            last_exit: Vec::new(),
            entries: if geometry.part.is_some() { vec![Lanes::splat(0.0); Chunk::N] } else { Vec::new() },
            outer_entries: Vec::new(),
            missed: vec![u16::MAX; Chunk::N],
            idle: vec![u16::MAX; Chunk::N],
            directions: Vec::new(),
            fades: Vec::new(),
        };
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        level.run(
            #[inline(always)]
            || {
                for strip in 0..N_STRIPS {
                    for row in 0..TILE_V.min(plane.size[1] - j0) {
                        let i = i0 + strip * LANES;
                        if i < plane.size[0] {
                            let j = j0 + row;
                            let intervals = geometry.intervals(i as f64, j as f64);
                            let chunk = Chunk { strip, row };
                            let Some(part) = &geometry.part else {
                                rays.set(chunk, plane, intervals, plane.size[0] - i, &mut span);
                                continue;
                            };
                            let mut own = intervals;
                            part.narrow(plane, i as f64, j as f64, &mut own);
                            rays.set(chunk, plane, own, plane.size[0] - i, &mut span);
                            rays.set_entries(chunk, plane, intervals);
                        }
                    }
                }
            },
        );
        if plane.eye_w().is_none() {
            rays.directions.push(geometry.directions(i0, j0));
        } else if span[0] < span[1] {
            rays.directions
                .resize(Chunk::N, Directions { thickness: Lanes::splat(0.0), to_eye: [Lanes::splat(0.0); 3] });
            level.run(
                #[inline(always)]
                || {
                    for (index, directions) in rays.directions.iter_mut().enumerate() {
                        if rays.missed[index] != u16::MAX {
                            let [strip, row] = [index / TILE_V, index % TILE_V];
                            *directions = geometry.directions(i0 + strip * LANES, j0 + row);
                        }
                    }
                },
            );
        }
        if let Some(fade) = &geometry.depth_cue {
            for strip in 0..N_STRIPS {
                rays.fades.extend((0..TILE_V).map(|row| fade.along(plane, i0 + strip * LANES, j0 + row)));
            }
        }
        (rays, span)
    }

    /// Sets the intervals of a chunk, and widens `span` by them. `n`: texels of the chunk that belong to the base
    /// plane.
    #[inline(always)]
    fn set(&mut self, chunk: Chunk, plane: &BasePlane, [lo, hi]: [[f64; LANES]; 2], n: usize, span: &mut [f64; 2]) {
        let (mut near, mut far) = (Lanes::splat(0.0), Lanes::splat(0.0));
        let (from, to) = if plane.family.ascending { (lo, hi) } else { (hi.map(|w| -w), lo.map(|w| -w)) };
        // No value is carried from texel to texel, so that the loop becomes vectors.
        let (mut first, mut last) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
        let mut entries = [f64::NEG_INFINITY; LANES];
        let mut missed_bits = [0_u16; LANES];
        for i in 0..LANES {
            let drawn = lo[i] < hi[i] && i < n;
            missed_bits[i] = u16::from(!drawn) << i;
            near.0[i] = if drawn { from[i] as f32 } else { 0.0 };
            far.0[i] = if drawn { to[i] as f32 } else { 0.0 };
            first[i] = if drawn { lo[i] } else { f64::INFINITY };
            last[i] = if drawn { hi[i] } else { f64::NEG_INFINITY };
            entries[i] = if drawn { from[i] } else { f64::NEG_INFINITY };
        }
        let missed = halved(missed_bits, |a, b| a | b);
        *span = [span[0].min(halved(first, f64::min)), span[1].max(halved(last, f64::max))];
        let common = [halved(from, f64::max), halved(to, f64::min)];
        self.intervals[chunk.index()] = [near, far];
        self.common[chunk.index()] = if missed == 0 { common.map(|s| s as f32) } else { [0.0; 2] };
        self.last_entry[chunk.index()] = halved(entries, f64::max) as f32;
        self.missed[chunk.index()] = missed;
        self.idle[chunk.index()] = missed;
    }

    /// Sets where the rays of a chunk enter the drawn region, of which a part is drawn.
    fn set_entries(&mut self, chunk: Chunk, plane: &BasePlane, [lo, hi]: [[f64; LANES]; 2]) {
        let from = if plane.family.ascending { lo } else { hi.map(|w| -w) };
        let missed = self.missed(chunk);
        let mut last = f32::NEG_INFINITY;
        for (i, from) in from.into_iter().enumerate().filter(|(i, _)| missed >> i & 1 == 0) {
            self.entries[chunk.index()].0[i] = from as f32;
            last = last.max(from as f32);
        }
        self.last_entry[chunk.index()] = last;
    }

    /// Interval of s that each ray draws; empty where lo ≥ hi.
    #[inline(always)]
    pub fn lanes(&self, chunk: Chunk) -> &[Lanes; 2] {
        &self.intervals[chunk.index()]
    }

    /// Interval of s that each ray draws; empty where lo ≥ hi.
    #[inline(always)]
    pub fn interval<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> [W::F; 2] {
        let ([lo_a, hi_a], [lo_b, hi_b]) = (self.lanes(chunks[0]), self.lanes(chunks[1]));
        let s = w.one();
        [w.join(s.load(&lo_a.0), s.load(&lo_b.0)), w.join(s.load(&hi_a.0), s.load(&hi_b.0))]
    }

    /// Where each ray begins, before any cut at a surface.
    #[inline(always)]
    pub fn begins<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        if self.begins.is_empty() {
            return self.interval(w, chunks)[0];
        }
        w.load_from(&self.begins, chunks.map(Chunk::index))
    }

    /// Ends the rays of a chunk where they meet something opaque. From now on they may be cut.
    pub fn end_at(&mut self, chunk: Chunk, ends: &Lanes) {
        self.allow_cuts();
        let index = chunk.index();
        let [lo, hi] = &mut self.intervals[index];
        for k in 0..LANES {
            if self.missed[index] >> k & 1 == 1 || ends.0[k] >= hi.0[k] {
                continue;
            }
            hi.0[k] = ends.0[k].max(lo.0[k]);
            self.missed[index] |= u16::from(lo.0[k] >= hi.0[k]) << k;
        }
        self.idle[index] = self.missed[index];
        let least = hi.0.into_iter().fold(f32::INFINITY, f32::min);
        let seen = (0..LANES).filter(|k| self.missed[index] >> k & 1 == 0);
        self.last_exit[index] = seen.map(|k| hi.0[k]).fold(f32::NEG_INFINITY, f32::max);
        let [from, to] = self.common[index];
        self.common[index] = if self.missed[index] == 0 { [from, to.min(least)] } else { [0.0; 2] };
    }

    /// Keeps where rays begin, so that they may be cut.
    fn allow_cuts(&mut self) {
        if self.begins.is_empty() {
            self.begins = self.intervals.iter().map(|[lo, _]| *lo).collect();
            self.last_exit = vec![f32::INFINITY; Chunk::N];
        }
    }

    /// Whether all rays of a chunk have ended at surfaces in front of a place.
    #[inline(always)]
    pub fn have_ended(&self, chunk: Chunk, s: f32) -> bool {
        self.last_exit.get(chunk.index()).is_some_and(|last| *last <= s)
    }

    /// Clips each ray of a chunk to the segment between two places. Returns the state that [`Rays::restore`] needs.
    #[inline(always)]
    pub fn cut(&mut self, chunk: Chunk, [from, to]: [&Lanes; 2]) -> ([Lanes; 2], [f32; 2]) {
        let (interval, common) = (&mut self.intervals[chunk.index()], &mut self.common[chunk.index()]);
        let kept = (*interval, *common);
        let [lo, hi] = interval;
        let mut empty = [0_u16; LANES];
        for k in 0..LANES {
            lo.0[k] = lo.0[k].max(from.0[k]);
            hi.0[k] = hi.0[k].min(to.0[k]).max(lo.0[k]);
            empty[k] = u16::from(lo.0[k] >= hi.0[k]) << k;
        }
        self.idle[chunk.index()] |= halved(empty, |a, b| a | b);
        *common = [f32::INFINITY, f32::NEG_INFINITY];
        kept
    }

    /// Undoes [`Rays::cut`].
    #[inline(always)]
    pub fn restore(&mut self, chunk: Chunk, kept: ([Lanes; 2], [f32; 2])) {
        (self.intervals[chunk.index()], self.common[chunk.index()]) = kept;
        self.idle[chunk.index()] = self.missed[chunk.index()];
    }

    /// Sets the entries into matter of rays that enter the region in another part. `entry`: given a chunk, a lane, where
    /// that ray enters the region, in s, and the thickness of a slice along it.
    pub fn set_outer_entries(&mut self, entry: impl Fn(Chunk, usize, f32, f32) -> f32) {
        let mut outer = vec![Lanes::splat(f32::NEG_INFINITY); self.entries.len()];
        for (index, outer) in outer.iter_mut().enumerate() {
            let chunk = Chunk { strip: index / TILE_V, row: index % TILE_V };
            for i in (0..LANES).filter(|i| self.missed(chunk) >> i & 1 == 0) {
                let entered = self.entries[index].0[i];
                if entered < self.intervals[index][0].0[i] {
                    outer.0[i] = entry(chunk, i, entered, self.directions(chunk).thickness.0[i]);
                }
            }
        }
        self.outer_entries = outer;
    }

    /// Entries into matter of the rays that enter the region in another part, infinitely far in front for other rays;
    /// `None` without parts.
    #[inline(always)]
    pub fn outer_entries<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> Option<W::F> {
        if self.outer_entries.is_empty() {
            return None;
        }
        let [a, b] = chunks.map(|chunk| &self.outer_entries[chunk.index()].0);
        Some(w.join(w.one().load(a), w.one().load(b)))
    }

    /// Thickness of one slice distance, in `opacity_unit`s ([`Directions::thickness`]).
    #[inline(always)]
    pub fn thickness<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        let (a, b) = (self.directions(chunks[0]), self.directions(chunks[1]));
        w.join(w.one().load(&a.thickness.0), w.one().load(&b.thickness.0))
    }

    /// Unit world vectors towards the eye, as forms on index gradients ([`world_gradient_from_index`]).
    #[inline(always)]
    pub fn to_eye<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> [W::F; 3] {
        let [ax, ay, az] = &self.directions(chunks[0]).to_eye;
        let [bx, by, bz] = &self.directions(chunks[1]).to_eye;
        let s = w.one();
        [
            w.join(s.load(&ax.0), s.load(&bx.0)),
            w.join(s.load(&ay.0), s.load(&by.0)),
            w.join(s.load(&az.0), s.load(&bz.0)),
        ]
    }

    /// Whether all rays of a chunk draw the whole way between two positions.
    #[inline(always)]
    pub fn all_draw(&self, chunk: Chunk, from: f32, to: f32) -> bool {
        let [lo, hi] = self.common[chunk.index()];
        lo <= from && to <= hi
    }

    /// Largest s at which a ray of a chunk enters the drawn region.
    #[inline(always)]
    pub fn last_entry(&self, chunk: Chunk) -> f32 {
        self.last_entry[chunk.index()]
    }

    /// Rays that draw nothing, as bits.
    #[inline(always)]
    pub fn missed(&self, chunk: Chunk) -> u16 {
        self.missed[chunk.index()]
    }

    /// Rays that draw nothing, or nothing of the parts that they are cut to ([`Rays::cut`]), as bits.
    #[inline(always)]
    pub fn idle(&self, chunk: Chunk) -> u16 {
        self.idle[chunk.index()]
    }

    /// Whether no ray of a chunk draws anything.
    #[inline(always)]
    pub fn draws_nothing(&self, chunk: Chunk) -> bool {
        self.missed(chunk) == u16::MAX
    }

    /// Depth shading of a chunk's rays: the factor at s = 0, and its change per s. Only where there is a depth cue.
    #[inline(always)]
    pub fn fade(&self, chunk: Chunk) -> &[Lanes; 2] {
        &self.fades[chunk.index()]
    }

    /// Directions of a chunk's rays.
    #[inline(always)]
    pub fn directions(&self, chunk: Chunk) -> &Directions {
        &self.directions[if self.directions.len() == 1 { 0 } else { chunk.index() }]
    }
}

/// Reduces all lanes to one value: combines one half with the other, until one lane is left.
#[inline(always)]
fn halved<T: Copy>(mut lanes: [T; LANES], both: impl Fn(T, T) -> T) -> T {
    let mut n = LANES / 2;
    while n > 0 {
        for i in 0..n {
            lanes[i] = both(lanes[i], lanes[i + n]);
        }
        n /= 2;
    }
    lanes[0]
}

/// Directions of rays, affine in the texel: at texel (0, 0), and the change per texel along u and along v.
pub struct DirectionForms {
    /// World vector along the ray from a slice to the next along w.
    pub to_next: [DVec3; 3],
    /// Vector towards the eye as a form on index gradients, as long as `to_next`, not a unit vector.
    pub to_eye: [DVec3; 3],
}

impl RayGeometry<'_> {
    /// Intervals of w that [`LANES`] texels from `(i, j)` on draw, of all parts; empty where lo ≥ hi.
    #[inline(always)]
    fn intervals(&self, i: f64, j: f64) -> [[f64; LANES]; 2] {
        let mut own = self.region.texel_intervals(self.plane, i, j);
        let missed = self.silhouette.missed(self.plane, &own, i, j);
        if missed.contains(&true) {
            let beyond = self.widened.texel_intervals(self.plane, i, j);
            for k in 0..LANES {
                own[0][k] = if missed[k] { beyond[0][k] } else { own[0][k] };
                own[1][k] = if missed[k] { beyond[1][k] } else { own[1][k] };
            }
        }
        own
    }

    /// Directions of all rays of the base plane.
    pub fn direction_forms(&self) -> DirectionForms {
        let family = &self.plane.family;
        let columns = family.axes.map(|a| self.world_from_index.matrix3.col(a));
        let form = world_gradient_from_index(self.gradient_steps, family).transpose();
        let sign = if family.ascending { 1.0 } else { -1.0 };
        let slope = |i: f64, j: f64| self.plane.ray(i, j).slope;
        let first = slope(0.0, 0.0);
        let [along_u, along_v] = [slope(1.0, 0.0)[0] - first[0], slope(0.0, 1.0)[1] - first[1]];
        let to_next =
            [columns[0] * first[0] + columns[1] * first[1] + columns[2], columns[0] * along_u, columns[1] * along_v];
        DirectionForms { to_next, to_eye: to_next.map(|v| form * (v * -sign)) }
    }

    #[inline(always)]
    fn directions(&self, i: usize, j: usize) -> Directions {
        let family = &self.plane.family;
        let columns = family.axes.map(|a| self.world_from_index.matrix3.col(a));
        let form = world_gradient_from_index(self.gradient_steps, family).transpose();
        let sign = if family.ascending { 1.0 } else { -1.0 };
        // Along a row of texels, the way from slice to slice changes evenly.
        let slope = self.plane.ray(i as f64, j as f64).slope;
        let change = self.plane.ray((i + 1) as f64, j as f64).slope[0] - slope[0];
        let first = columns[0] * slope[0] + columns[1] * slope[1] + columns[2];
        let per_texel = columns[0] * change;
        let [form_of_first, form_per_texel] = [first, per_texel].map(|v| (form * (v * -sign)).to_array());
        let mut directions = Directions { thickness: Lanes::splat(0.0), to_eye: [Lanes::splat(0.0); 3] };
        for k in 0..LANES {
            let length = (first + per_texel * k as f64).length();
            directions.thickness.0[k] = (length / self.opacity_unit) as f32;
            for c in 0..3 {
                directions.to_eye[c].0[k] = ((form_of_first[c] + form_per_texel[c] * k as f64) / length) as f32;
            }
        }
        directions
    }
}
