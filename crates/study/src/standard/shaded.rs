//! Classification and shading of the samples of a slice, before anything is splatted.
//!
//! The colour and the optical depth `τ` per `opacity_unit` belong to the sample's own value; its opacity is the opacity
//! of a slab one slice distance thick, `α = 1 − exp(−τ s)`; the gradient is the central difference of the neighbours,
//! which stops at the faces. What is kept is associated: `(α r, α g, α b, α)`.

use glam::DVec3;
use wavesplat_compute::simd::{LANES, Lanes, Simd, VectorKernel};
use wavesplat_core::RenderOptions;
use wavesplat_splat::optics::classify::one_minus_exp_neg;
use wavesplat_splat::sheet::field_sheets::{FieldPoint, FieldValues};
use wavesplat_splat::source::window::Window;
use wavesplat_splat::view::family::Family;

use super::samples::{Densities, SampleLayer};
use super::{Buffer, FamilyScene, SliceDistance, StandardScene};

/// View of samples: the direction to the eye, and the length of rays through a slab.
pub struct Sight {
    from: EyeDirection,
    /// Length of rays through a slab, in `opacity_unit`s: of all samples, or a factor of it where there is a `depth`.
    thickness: f32,
    /// Linear form on the offset from the eye, along u, v, w: the length is `thickness · |offset| / |depth · offset|`.
    depth: Option<[f32; 3]>,
}

enum EyeDirection {
    /// Unit world vector towards the eye, as a form on index gradients along u, v, w.
    Side([f32; 3]),
    /// The eye along u, v, w, and the index axes in the world, for lengths.
    Eye { eye: [f64; 3], columns: [[f32; 3]; 3] },
}

impl Sight {
    pub(super) fn new(scene: &StandardScene, family: &Family) -> Self {
        let matrix = scene.grid.world_from_index().matrix3;
        let forward = scene.camera.forward();
        let distance = SliceDistance::new(scene.grid, forward);
        let columns = family.axes.map(|a| matrix.col(a));
        let per_unit = scene.opacity_unit.recip();
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let Some(eye) = scene.eye() else {
            let to_eye = scene.grid.index_from_world().transform_vector3(-forward);
            let length = if scene.standard.view_angle_correction { distance.along_view } else { distance.across };
            let from = EyeDirection::Side(single(family.uvw(to_eye)));
            return Self { from, thickness: (length * per_unit) as f32, depth: None };
        };
        // A form on index offsets that is an index vector's transpose is the vector itself.
        let from = EyeDirection::Eye { eye: family.uvw(eye), columns: columns.map(|c| c.as_vec3().to_array()) };
        let (length, depth) = match (scene.standard.view_angle_correction, scene.standard.buffer) {
            (false, Buffer::Axis) => {
                let across = scene.grid.index_from_world().matrix3.transpose().col(family.axes[2]);
                (across.length().recip(), None)
            }
            (false, Buffer::View) => (distance.across, None),
            (true, Buffer::Axis) => (1.0, Some([0.0, 0.0, 1.0])),
            (true, Buffer::View) => (distance.along_view, Some(single(columns.map(|c| forward.dot(c))))),
        };
        Self { from, thickness: (length * per_unit) as f32, depth }
    }

    /// Thickness, and the unit vector towards the eye as a form on gradients, of the samples from `uvw` on along u.
    #[inline(always)]
    fn of<S: Simd>(&self, s: S, uvw: [f64; 3]) -> (S::F, [S::F; 3]) {
        let (eye, columns) = match &self.from {
            EyeDirection::Side([u, v, w]) => return (s.splat(self.thickness), [s.splat(*u), s.splat(*v), s.splat(*w)]),
            EyeDirection::Eye { eye, columns } => (eye, columns),
        };
        let first = (uvw[0] - eye[0]) as f32;
        let mut along_u = [first; LANES];
        for lane in 0..LANES {
            along_u[lane] += lane as f32;
        }
        let offset = [s.load(&along_u), s.splat((uvw[1] - eye[1]) as f32), s.splat((uvw[2] - eye[2]) as f32)];
        let x = dot(s, [columns[0][0], columns[1][0], columns[2][0]], offset);
        let y = dot(s, [columns[0][1], columns[1][1], columns[2][1]], offset);
        let z = dot(s, [columns[0][2], columns[1][2], columns[2][2]], offset);
        let squared = s.add(s.add(s.mul(x, x), s.mul(y, y)), s.mul(z, z));
        let inverse = s.rsqrt(s.max(squared, s.splat(f32::MIN_POSITIVE)));
        let thickness = match self.depth {
            Some(depth) => s.div(s.splat(self.thickness), s.mul(s.abs(dot(s, depth, offset)), inverse)),
            None => s.splat(self.thickness),
        };
        let towards = s.sub(s.splat(0.0), inverse);
        (thickness, [s.mul(offset[0], towards), s.mul(offset[1], towards), s.mul(offset[2], towards)])
    }
}

#[inline(always)]
fn dot<S: Simd>(s: S, form: [f32; 3], x: [S::F; 3]) -> S::F {
    s.add(s.add(s.mul(s.splat(form[0]), x[0]), s.mul(s.splat(form[1]), x[1])), s.mul(s.splat(form[2]), x[2]))
}

/// The visible samples of a layer, classified and shaded: associated colour and opacity.
#[derive(Default)]
pub struct Shaded {
    window: Option<Window>,
    /// Number of zeros on either side of every row.
    padding: usize,
    stride: usize,
    channels: [Vec<f32>; 4],
    /// First and last visible sample of each row, counted from the window's; first above last where there is none.
    spans: Vec<[usize; 2]>,
    bits: Vec<u16>,
}

/// A span without samples.
const NOTHING: [usize; 2] = [1, 0];

impl Shaded {
    /// Classifies and shades the layer; returns the number of visible samples. Rows begin after at least `padding`
    /// zeros.
    pub fn fill(&mut self, family: &FamilyScene, densities: &Densities, layer: &SampleLayer, padding: usize) -> usize {
        let window = layer.window;
        self.window = Some(window);
        self.padding = padding.next_multiple_of(LANES);
        self.stride = 2 * self.padding + window.n_u().next_multiple_of(LANES);
        for channel in &mut self.channels {
            channel.resize(self.stride * window.n_v(), 0.0);
        }
        self.spans.clear();
        self.spans.resize(window.n_v(), NOTHING);
        self.bits.resize(window.n_u().div_ceil(LANES), 0);
        family.scene.level.dispatch(Fill { shaded: self, family, densities, layer })
    }

    /// First and last visible sample of a row of the window, counted from the window's first; `None` where there is
    /// none.
    #[inline(always)]
    pub fn span(&self, row: usize) -> Option<[usize; 2]> {
        let [first, last] = self.spans[row];
        (first <= last).then_some([first, last])
    }

    /// A row of a channel, with its zeros: `padding` of them come before the window's first sample.
    #[inline(always)]
    pub fn row(&self, channel: usize, row: usize) -> &[f32] {
        &self.channels[channel][row * self.stride..(row + 1) * self.stride]
    }

    /// Number of zeros before and after a row.
    #[inline(always)]
    pub fn padding(&self) -> usize {
        self.padding
    }
}

struct Fill<'a, 'b> {
    shaded: &'a mut Shaded,
    family: &'a FamilyScene<'b>,
    densities: &'a Densities,
    layer: &'a SampleLayer,
}

impl VectorKernel for Fill<'_, '_> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> usize {
        let Self { shaded, family, densities, layer } = self;
        let Window { u: [u_lo, u_hi], v: [v_lo, v_hi] } = layer.window;
        let scene = family.scene;
        let [least, most] = scene.classifier.visible_range();
        let (least, most) = (s.splat(least), s.splat(most));
        let has_holes = scene.slices.has_mask();
        let is_cut = is_cut(scene.options) || scene.grid.bounds() != [DVec3::ZERO, scene.grid.last_index()];
        let n_u = (u_hi - u_lo + 1) as usize;
        let mut n_visible = 0;
        for v in v_lo..=v_hi {
            let first = densities.place(layer.slice, u_lo, v);
            let mut any = 0;
            for (chunk, bits) in shaded.bits.iter_mut().enumerate() {
                let density = s.load(densities.at(first + chunk * LANES));
                *bits = s.bits(s.and(s.le(least, density), s.le(density, most)));
                *bits &= u16::MAX >> (LANES - (n_u - chunk * LANES).min(LANES));
                if has_holes && *bits != 0 {
                    *bits &= !densities.holes(first + chunk * LANES);
                }
                any |= *bits;
            }
            if any == 0 {
                continue;
            }
            let row = (v - v_lo) as usize;
            if is_cut {
                cut(&mut shaded.bits, family, [u_lo, v, layer.slice as i64]);
            }
            let begin = row * shaded.stride;
            for channel in &mut shaded.channels {
                channel[begin..begin + shaded.stride].fill(0.0);
            }
            let mut span = NOTHING;
            for chunk in 0..shaded.bits.len() {
                let bits = shaded.bits[chunk];
                if bits == 0 {
                    continue;
                }
                let uvw = [(u_lo + (chunk * LANES) as i64) as f64, v as f64, layer.slice as f64];
                let (rgba, bits) = shade(s, family, densities, first + chunk * LANES, uvw, bits);
                if bits == 0 {
                    continue;
                }
                let out = begin + shaded.padding + chunk * LANES;
                for c in 0..4 {
                    if let Some(to) = shaded.channels[c][out..].first_chunk_mut() {
                        s.store(rgba[c], to);
                    }
                }
                n_visible += bits.count_ones() as usize;
                let last = chunk * LANES + LANES - 1 - bits.leading_zeros() as usize;
                let from = if span == NOTHING { chunk * LANES + bits.trailing_zeros() as usize } else { span[0] };
                span = [from, last];
            }
            shaded.spans[row] = span;
        }
        n_visible
    }
}

/// Whether a crop box or a clip plane cuts the volume.
fn is_cut(options: &RenderOptions) -> bool {
    options.crop.is_some() || !options.clip_planes.is_empty()
}

/// Tolerance of the rounding of samples that lie on a face, in samples.
const ON_A_FACE: f64 = 1e-6;

/// Clears the bits of samples whose centres lie outside the drawn region.
fn cut(bits: &mut [u16], family: &FamilyScene, [u_lo, v, w]: [i64; 3]) {
    let start = family.position([0.0, v as f64, w as f64]);
    let along = family.position([1.0, 0.0, 0.0]);
    let [lo, hi] = family.scene.region.passage(start, along, [f64::NEG_INFINITY, f64::INFINITY]).ends;
    for (chunk, bits) in bits.iter_mut().enumerate() {
        for lane in 0..LANES {
            let u = (u_lo + (chunk * LANES + lane) as i64) as f64;
            if u < lo - ON_A_FACE || u > hi + ON_A_FACE {
                *bits &= !(1 << lane);
            }
        }
    }
}

/// Associated colour and opacity of the samples from a place on, 0 where a bit is not set; and the mask of the visible
/// ones.
#[inline(always)]
fn shade<S: Simd>(
    s: S,
    family: &FamilyScene,
    densities: &Densities,
    place: usize,
    uvw: [f64; 3],
    bits: u16,
) -> ([S::F; 4], u16) {
    let (thickness, to_eye) = family.sight.of(s, uvw);
    let density = s.load(densities.at(place));
    let mut classified = family.scene.classifier.look_up(s, density);
    if family.needs_gradient() {
        let [_, _, n_w] = family.size();
        let (row, plane) = (densities.stride(), densities.plane());
        let slice = uvw[2] as usize;
        // The box has a border beyond the faces of a slice, which repeats the edge, but none beyond the first and the
        // last slice.
        let before = if slice > 0 { place - plane } else { place };
        let after = if slice + 1 < n_w { place + plane } else { place };
        let gradient = [
            difference(s, densities, place - 1, place + 1),
            difference(s, densities, place - row, place + row),
            difference(s, densities, before, after),
        ];
        if let Some(by_gradient) = &family.by_gradient {
            classified =
                by_gradient.classify(s, density, gradient, &FieldPoint::on(&FieldValues::default()), classified);
        }
        if let Some(shader) = &family.shader {
            let [r, g, b, depth] = classified;
            let [r, g, b] = shader.shade(s, [r, g, b], gradient, to_eye);
            classified = [r, g, b, depth];
        }
    }
    let [r, g, b, depth] = classified;
    let mut keep = Lanes::splat(0.0);
    for lane in 0..LANES {
        keep.0[lane] = f32::from(bits >> lane & 1);
    }
    let alpha = s.mul(one_minus_exp_neg(s, s.mul(depth, thickness)), s.load(&keep.0));
    let visible = s.bits(s.lt(s.splat(0.0), alpha));
    ([s.mul(r, alpha), s.mul(g, alpha), s.mul(b, alpha), alpha], visible)
}

/// Half the difference of the samples from two places on.
#[inline(always)]
fn difference<S: Simd>(s: S, densities: &Densities, before: usize, after: usize) -> S::F {
    s.mul(s.splat(0.5), s.sub(s.load(densities.at(after)), s.load(densities.at(before))))
}
