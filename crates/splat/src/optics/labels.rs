//! Segmentation labels beside the scan, each with a colour and opacity of its own.
//!
//! Label numbers are never interpolated: what is reconstructed is the coverage `c_l(x)`, the interpolated indicator of
//! each label. All that is needed of it is linear, so a handful of fields serve any number of labels:
//!
//! - `Σ c_l f_l`, what is left of the scan's optical depth (`f_l` its factor in label `l`);
//! - `Σ c_l f_l t_l` and `Σ c_l f_l t_l rgb_l`, the tinted part of it (`t_l` the share of the tint);
//! - `Σ c_l τ_l` and `Σ c_l τ_l rgb_l`, the optical depth and colour of the label medium.
//!
//! A segmentation is a staircase of samples; the linear kernel keeps the stairs, a blurring one smooths them.

use std::sync::Arc;

use wavesplat_core::{Decoder, Gradient, Grid, Kernel, LabelLook, Result, Statistics};

use crate::source::field::Field;
use crate::source::slices::Slices;

/// Label of every sample, as a place in the list of looks.
#[derive(Clone, Debug)]
pub enum Codes {
    /// Up to 256 looks.
    U8(Arc<[u8]>),
    /// More than 256 looks.
    U16(Arc<[u16]>),
}

impl Codes {
    /// The code of a sample.
    pub fn get(&self, i: usize) -> usize {
        match self {
            Self::U8(codes) => usize::from(codes[i]),
            Self::U16(codes) => usize::from(codes[i]),
        }
    }
}

/// Optical depth that stands for opacity 1: 1 % coverage of it is faint, and a unit of it lets 1e-7 through.
const OPAQUE_LABEL_DEPTH: f64 = 16.0;

/// Half distances of the differences for the label medium's gradient, voxels: as a rule, and where stairs are to be
/// smoothed, wide enough for the normals to see several of them.
const GRADIENT_OFFSET: f64 = 1.0;
const SMOOTH_GRADIENT_OFFSET: f64 = 2.5;

/// Labels of a volume, their looks, and the fields made of them.
pub struct Labels {
    /// Label of every sample, `[z][y][x]`.
    pub codes: Codes,
    /// Looks by code.
    pub looks: Vec<LabelLook>,
    /// Reconstruction of coverages.
    pub kernel: Kernel,
    channels: Vec<Slices<'static>>,
    terms: LabelFields,
}

/// Places of the label fields; `None` where no label needs one.
#[derive(Clone, Copy, Debug, Default)]
pub struct LabelFields {
    /// Share of the scan's optical depth that is left.
    pub scan: Option<usize>,
    /// Tinted share of the scan's optical depth; red, green and blue follow.
    pub tint: Option<usize>,
    /// Optical depth of the label medium; red, green and blue follow.
    pub medium: Option<usize>,
}

impl LabelFields {
    /// The places after `n_fields` other fields.
    #[must_use]
    pub fn after(self, n_fields: usize) -> Self {
        let later = |field: Option<usize>| field.map(|field| field + n_fields);
        Self { scan: later(self.scan), tint: later(self.tint), medium: later(self.medium) }
    }
}

/// Optical depth per `opacity_unit` of a label medium.
pub fn own_depth(look: &LabelLook) -> f64 {
    (-(-look.opacity).ln_1p()).min(OPAQUE_LABEL_DEPTH)
}

impl Labels {
    /// Labels of the volume on `grid`. `kernel`: non-negative weights. At most about `budget_bytes` of fields are kept.
    pub fn new(codes: Codes, looks: Vec<LabelLook>, grid: &Grid, kernel: Kernel, budget_bytes: usize) -> Result<Self> {
        let mut tables: Vec<Vec<f32>> = Vec::new();
        let mut add = |of: &dyn Fn(&LabelLook) -> f64| tables.push(looks.iter().map(|look| of(look) as f32).collect());
        let mut terms = LabelFields::default();
        let mut n = 0;
        let mut take = |count: usize| {
            n += count;
            Some(n - count)
        };
        if looks.iter().any(|look| look.scan != 1.0) || looks.iter().any(|look| look.tint > 0.0) {
            terms.scan = take(1);
            add(&|look| look.scan);
        }
        if looks.iter().any(|look| look.tint > 0.0) {
            terms.tint = take(4);
            add(&|look| look.scan * look.tint);
            (0..3).for_each(|c| add(&|look| look.scan * look.tint * look.rgb[c]));
        }
        if looks.iter().any(|look| look.opacity > 0.0) {
            terms.medium = take(4);
            add(&own_depth);
            (0..3).for_each(|c| add(&|look| own_depth(look) * look.rgb[c]));
        }
        let budget_bytes = budget_bytes / tables.len().max(1);
        let channel = |table: Vec<f32>| {
            let (min, max) = table.iter().fold((0.0_f32, 0.0_f32), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
            let statistics = Statistics { min: f64::from(min), max: f64::from(max), n_nonfinite: 0 };
            // Values as they are.
            let grid = Grid::new("labels", grid.size(), grid.world_from_index(), statistics, true)?;
            let decoder = Channel { codes: codes.clone(), size: grid.size(), table };
            Ok(Slices::of_decoder(Arc::new(decoder), &grid, kernel, budget_bytes))
        };
        let channels = tables.into_iter().map(channel).collect::<Result<_>>()?;
        Ok(Self { codes, looks, kernel, channels, terms })
    }

    /// Places of the fields among [`Labels::fields`].
    pub fn terms(&self) -> LabelFields {
        self.terms
    }

    /// Half distance of the differences for the gradient of the label medium, voxels.
    pub fn gradient_offset(&self) -> f64 {
        if self.kernel == Kernel::Linear { GRADIENT_OFFSET } else { SMOOTH_GRADIENT_OFFSET }
    }

    /// The fields, at the places of [`Labels::terms`].
    pub fn fields(&self) -> Vec<Field<'static>> {
        let field = |(i, channel): (usize, &Slices<'static>)| {
            let gradient = (self.terms.medium == Some(i)).then(|| Gradient::Difference(self.gradient_offset()));
            Field { slices: channel.clone(), from_index: [(0.0, 1.0); 3], gradient }
        };
        self.channels.iter().enumerate().map(field).collect()
    }
}

/// Decoder that replaces the label of every sample by a number.
struct Channel {
    codes: Codes,
    size: [usize; 3],
    table: Vec<f32>,
}

impl Decoder for Channel {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let [nx, ny, _] = self.size;
        let row = hi[0] - lo[0];
        for (r, out) in out.chunks_exact_mut(row).enumerate() {
            let (y, z) = (lo[1] + r % (hi[1] - lo[1]), lo[2] + r / (hi[1] - lo[1]));
            let first = (z * ny + y) * nx + lo[0];
            for (i, out) in out.iter_mut().enumerate() {
                *out = self.table[self.codes.get(first + i)];
            }
        }
    }
}
