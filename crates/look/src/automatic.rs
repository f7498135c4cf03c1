//! The automatic look of a volume, by the kind of its data and its samples.
//!
//! Homogeneous matter, and noise, must not cover what lies behind.

use wavesplat_core::{Composite, Result, TransferFunction};

use crate::channel_windows::{VolumeChannel, window_of_values};
use crate::colors::Rgb;
use crate::evidence::Source;
use crate::facts::{DataKind, KindFacts};
use crate::fields::FilledPart;
use crate::histogram::{otsu, robust_range, without_padding};
use crate::kinds::{FAR, FoundKind};
use crate::look::{LightSettings, Look, light_of};
use crate::projections::{RayOperator, SpreadSamples};
use crate::scans::CurveNodes;
use crate::statistics::{extremes, mean};
use crate::voxels::opaque_after;

/// Light for solid things: ambient occlusion lets depth be seen.
pub const SOLID_LIGHT: LightSettings = &[("ambient_occlusion", 0.3)];
/// Light for translucent things: a highlight on every faint boundary would be noise.
const SOFT_LIGHT: LightSettings = &[("specular", 0.1)];
const CT_LIGHT: LightSettings = &[("specular", 0.15), ("ambient_occlusion", 0.3)];
const ULTRASOUND_LIGHT: LightSettings = &[("ambient_occlusion", 0.4)];
/// Largest distance of white from the low end of the window of the samples, in widths of the window, where fluorescence
/// is projected.
const MAX_WHITE: f64 = 2.0;
/// Hounsfield units in the black of a maximum: every ray through a body meets soft tissue, so that what is below shows
/// nothing but the table, and takes half of the greys from vessels and bone.
const CT_MAXIMUM_BLACK: f64 = -100.0;
const METRES_PER_MM: f64 = 1e-3;
/// Blocks are volumes whose matter goes up to their faces, such as crops and small fields of view.
///
/// Only the six outermost slices of an opaque block can be seen. Matter that goes up to a face is opaque there, so a block
/// is recognised by the share of its faces that is not clear: the least mean of the six faces, and the opacity above
/// which a voxel is not clear. (`studies/looks`: whole bodies, heads and things: 0 to 0.16; crops to 0.3 and 0.5 of the
/// sides of heads, brains and pelves: 0.52 to 0.91; a knee of 10 slices: 0.47.)
const MIN_FACES: f64 = 0.4;
const MIN_OPACITY: f64 = 0.02;
/// Samples of a face that are looked at, about: the standard error of a share is then below 0.01.
const FACE_SAMPLES: f64 = 4096.0;

/// Why a volume has no automatic look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// All samples are equal, so that there is nothing to tell apart.
    Uniform,
    /// The samples are too far apart for numbers of 64 bits.
    TooFarApart,
}

impl Refusal {
    /// The reason why a volume has no look for an operator, if there is one. `range`: smallest and largest finite sample.
    /// `has_missing`: whether samples are missing, so that the others have a shape.
    pub fn of((low, high): (f64, f64), has_missing: bool, operator: Option<RayOperator>) -> Option<Self> {
        let is_over = matches!(operator, None | Some(RayOperator::Over));
        // Uniform matter projects to lengths, which depend on the view, so greys can still be found for it.
        let is_by_view = operator.is_some_and(RayOperator::is_by_view);
        if low < high || is_by_view || (has_missing && is_over) {
            return (!(high - low).is_finite()).then_some(Self::TooFarApart);
        }
        Some(Self::Uniform)
    }
}

/// A stack of slices, as the crate `view` finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SliceFacts {
    /// Whether a volume has but a few slices.
    pub are_few: bool,
    /// The world's axis (0 is x) along which samples are far apart, so that other planes are blurred.
    pub distant_axis: Option<usize>,
    /// Whether a volume is a thin stack.
    pub is_thin: bool,
}

/// A volume whose look is chosen: the kind of its data, its samples that were looked at, and facts.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Facts of its file.
    pub facts: KindFacts<'a>,
    /// Its kind of data.
    pub found: &'a FoundKind,
    /// Its finite samples that were looked at.
    pub values: &'a [f64],
    /// Magnitudes of the differences of neighbours at `values`.
    pub gradients: &'a [f64],
    /// The value of samples without data.
    pub fill: Option<f64>,
    /// Numbers of its samples along z, y and x.
    pub size: [usize; 3],
    /// Its slices.
    pub slices: SliceFacts,
    /// Its channel of a microscope.
    pub channel: VolumeChannel<'a>,
}

/// The automatic look of a volume, as plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct AutomaticLook {
    /// Curves of opacity and colour.
    pub curves: CurveNodes,
    /// Thickness that opacities are for, world units; `None` is a voxel.
    pub opacity_unit: Option<f64>,
    /// Settings of the light that differ from its default; `None` draws the colours as given.
    pub light: Option<LightSettings>,
    /// Operator along a ray.
    pub operator: RayOperator,
    /// Whether it is made for a white background.
    pub is_on_white: bool,
    /// Name of the view that it is made for; `None` is the view that suits the volume.
    pub view: Option<&'static str>,
    /// Whether the corner nearest to the eye is left out.
    pub is_cut_open: bool,
    /// The reason why it was chosen.
    pub reason: String,
}

impl AutomaticLook {
    /// The look to draw with, where it was chosen for no operator: emission and absorption, or a maximum.
    ///
    /// # Errors
    ///
    /// If values are beyond what a transfer function can have.
    pub fn look(self) -> Result<Look> {
        let CurveNodes { opacity, color } = self.curves;
        Ok(Look {
            transfer_function: TransferFunction::new(opacity, color, self.opacity_unit)?,
            shading: self.light.map(light_of),
            composite: if self.operator == RayOperator::Maximum { Composite::Maximum } else { Composite::Over },
            background: self.is_on_white.then_some([1.0; 4]),
            view: self.view,
            is_cut_open: self.is_cut_open,
            name: "auto".to_owned(),
            reason: self.reason,
        })
    }
}

impl Subject<'_> {
    /// The look that suits the kind of data. `operator`: the one that it is for; `None` takes what suits. `color`: of
    /// fluorescence, instead of the channel's own.
    ///
    /// # Errors
    ///
    /// Those of reading samples.
    pub fn look<S: Source>(
        &self,
        operator: Option<RayOperator>,
        color: Option<Rgb>,
        source: &S,
    ) -> std::result::Result<AutomaticLook, S::Error> {
        let kind = self.found.kind;
        let reason = &self.found.reason;
        if operator.is_none() && kind == DataKind::Pet {
            let (low, high) = robust_range(self.values);
            let threshold = otsu(self.values, low, high);
            let curves = self
                .spread(source, |spread| CurveNodes::of_uptake(&spread.pixels(RayOperator::Maximum, 0.0), threshold))?;
            return Ok(AutomaticLook {
                operator: RayOperator::Maximum,
                is_on_white: true,
                ..plain(curves, None, reason.clone())
            });
        }
        if operator.is_none() && self.found.has_few_bright {
            let curves = self
                .spread(source, |spread| CurveNodes::of_few_bright(&spread.pixels(RayOperator::Maximum, 0.0), FAR))?;
            let reason = format!("{reason}; so the largest value along each ray is shown");
            return Ok(AutomaticLook { operator: RayOperator::Maximum, ..plain(curves, None, reason) });
        }
        if let Some(operator) = operator.filter(|operator| operator.is_projection()) {
            let curves = self.spread(source, |spread| self.greys(spread, operator))?;
            return Ok(AutomaticLook { operator, ..plain(curves, None, reason.clone()) });
        }
        // Looks of these kinds are translucent, millimetre by millimetre.
        let is_scan = matches!(kind, DataKind::Ct | DataKind::Mr | DataKind::Ultrasound | DataKind::Scan);
        if operator.is_none() && is_scan && self.slices.are_few {
            let n = self.size.into_iter().min().unwrap_or(0);
            let why = format!("its {n} slices in greys, since so few are too thin for a translucent look");
            return Ok(plain(CurveNodes::of_greys(self.values, kind, true), None, format!("{reason}; {why}")));
        }
        let (curves, light) = self.in_space(color, source)?;
        if operator.is_none() && matches!(kind, DataKind::Mr | DataKind::Scan) {
            let function = TransferFunction::new(curves.opacity.clone(), curves.color.clone(), None);
            let is_block = |spread: &SpreadSamples<'_>| {
                function.is_ok_and(|function| is_block(spread, |value| function.opacity(value)))
            };
            if self.spread(source, is_block)? {
                return Ok(self.cut_open());
            }
        }
        let millimetre = METRES_PER_MM / self.facts.metres.unwrap_or(METRES_PER_MM);
        Ok(AutomaticLook {
            opacity_unit: (kind == DataKind::Ct).then_some(millimetre),
            operator: operator.unwrap_or(RayOperator::Over),
            ..plain(curves, light, reason.clone())
        })
    }

    /// Curves and light of emission and absorption, by the kind of data.
    fn in_space<S: Source>(
        &self,
        color: Option<Rgb>,
        source: &S,
    ) -> std::result::Result<(CurveNodes, Option<LightSettings>), S::Error> {
        let values = self.values;
        let [n_z, n_y, n_x] = self.size;
        let n_voxels = opaque_after([n_x, n_y, n_z], self.facts.spacing);
        let (least, largest) = extremes(values);
        let (own_largest, largest) = (self.facts.range.1, largest.max(self.facts.range.1));
        let part = || self.spread(source, |spread| FilledPart::of(spread.samples, spread.shape, n_z));
        Ok(match self.found.kind {
            DataKind::Ct => (CurveNodes::of_ct(self.facts.offset(values)), Some(CT_LIGHT)),
            DataKind::Mr | DataKind::Pet => (CurveNodes::of_tissue(values), Some(SOLID_LIGHT)),
            DataKind::Dose => (CurveNodes::of_dose(largest, n_voxels), None),
            DataKind::Ultrasound => (CurveNodes::of_ultrasound(values), Some(ULTRASOUND_LIGHT)),
            DataKind::Fluorescence => {
                let light = |spread: &SpreadSamples<'_>| {
                    let matter = without_padding(spread.samples, spread.shape);
                    self.channel.light(own_largest, &matter, n_voxels, color)
                };
                (self.spread(source, light)?, None)
            }
            kind @ DataKind::Em => (CurveNodes::of_greys(values, kind, false), None),
            DataKind::Fa => (CurveNodes::of_anisotropy(own_largest, n_voxels), None),
            DataKind::Probability => (CurveNodes::of_probability(largest, n_voxels), Some(SOFT_LIGHT)),
            DataKind::Map => (CurveNodes::of_map(values, n_voxels), None),
            DataKind::PValues => (CurveNodes::of_p_values(n_voxels), None),
            DataKind::SignedField => (CurveNodes::of_signed_field(values, n_voxels, part()?), Some(SOFT_LIGHT)),
            DataKind::Field => (CurveNodes::of_field(values, self.fill, n_voxels, part()?), Some(SOFT_LIGHT)),
            DataKind::Mask => (CurveNodes::of_mask(least, extremes(values).1), Some(SOLID_LIGHT)),
            DataKind::Labels => (CurveNodes::of_mask(0.0, 1.0), Some(SOLID_LIGHT)),
            DataKind::Scan => {
                (CurveNodes::of_scan(values, self.gradients, self.facts.is_anatomical), Some(SOLID_LIGHT))
            }
        })
    }

    /// Greys of a projection, whose ends depend on the kind of data.
    fn greys(&self, spread: &SpreadSamples<'_>, operator: RayOperator) -> CurveNodes {
        let is_hounsfield = operator == RayOperator::XRay && self.facts.is_hounsfield(&spread.finite());
        let mut curves = CurveNodes::of_projection(spread, operator, is_hounsfield);
        let kind = self.found.kind;
        if operator.is_maximum()
            && (kind == DataKind::Fluorescence || (kind == DataKind::Scan && !self.facts.is_anatomical))
        {
            // A few specks may be many times as bright as all else, and have many pixels.
            let (low, high) = window_of_values(&without_padding(spread.samples, spread.shape));
            curves = curves.not_beyond(low + MAX_WHITE * (high - low));
        }
        if operator.is_maximum() && kind == DataKind::Ct {
            curves = curves.not_before(CT_MAXIMUM_BLACK + self.facts.offset(self.values));
        }
        curves
    }

    /// Matter that fills the volume, so that only its faces would be seen: cut open, in opaque greys.
    fn cut_open(&self) -> AutomaticLook {
        let view = self.slices.distant_axis.map_or("isometric", |axis| ["yz", "xz", "xy"][axis]);
        let reason = format!("{}; matter up to the faces of the volume, shown in greys", self.found.reason);
        AutomaticLook {
            view: (!self.slices.is_thin).then_some(view),
            is_cut_open: true,
            ..plain(CurveNodes::of_greys(self.values, self.found.kind, false), None, reason)
        }
    }

    fn spread<S: Source, R>(
        &self,
        source: &S,
        look: impl FnOnce(&SpreadSamples<'_>) -> R,
    ) -> std::result::Result<R, S::Error> {
        let (size, spacing) = (self.size, self.facts.spacing);
        source.spread(|samples, shape| look(&SpreadSamples { samples, shape, size, spacing }))
    }
}

/// A look of emission and absorption on any background.
fn plain(curves: CurveNodes, light: Option<LightSettings>, reason: String) -> AutomaticLook {
    AutomaticLook {
        curves,
        opacity_unit: None,
        light,
        operator: RayOperator::Over,
        is_on_white: false,
        view: None,
        is_cut_open: false,
        reason,
    }
}

/// Whether a volume looks like a block, with the opacity of each value.
pub fn is_block(spread: &SpreadSamples<'_>, opacity: impl Fn(f64) -> f64) -> bool {
    let [_, n_y, n_x] = spread.shape;
    let (strides, sizes) = ([n_y * n_x, n_x, 1], spread.shape);
    let share = |axis: usize, place: usize| {
        let [one, other] = [[1, 2], [0, 2], [0, 1]][axis];
        let step = (((sizes[one] * sizes[other]) as f64 / FACE_SAMPLES).sqrt() as usize).max(1);
        let (mut n, mut n_seen) = (0_usize, 0_usize);
        for j in (0..sizes[one]).step_by(step) {
            for k in (0..sizes[other]).step_by(step) {
                let value = spread.samples[place * strides[axis] + j * strides[one] + k * strides[other]];
                n += 1;
                n_seen += usize::from(value.is_finite() && opacity(value) > MIN_OPACITY);
            }
        }
        n_seen as f64 / n as f64
    };
    let faces: Vec<f64> = (0..3).flat_map(|axis| [share(axis, 0), share(axis, sizes[axis] - 1)]).collect();
    mean(&faces) >= MIN_FACES
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    struct All(Vec<f64>, [usize; 3]);

    impl Source for All {
        type Error = Infallible;

        fn spread<R>(&self, look: impl FnOnce(&[f64], [usize; 3]) -> R) -> std::result::Result<R, Infallible> {
            Ok(look(&self.0, self.1))
        }

        fn is_whole(&self) -> std::result::Result<bool, Infallible> {
            Ok(false)
        }
    }

    fn look_of(kind: DataKind, all: &All, operator: Option<RayOperator>, slices: SliceFacts) -> AutomaticLook {
        let found = FoundKind { kind, reason: "a test".to_owned(), has_noise: true, has_few_bright: false };
        let gradients = vec![1.0; all.0.len()];
        let range = extremes(&all.0);
        let subject = Subject {
            facts: KindFacts { range, spacing: [1.0; 3], ..KindFacts::default() },
            found: &found,
            values: &all.0,
            gradients: &gradients,
            fill: None,
            size: all.1,
            slices,
            channel: VolumeChannel::default(),
        };
        match subject.look(operator, None, all) {
            Ok(look) => look,
            Err(never) => match never {},
        }
    }

    /// A ball in a box of 12 samples along each axis, or a box that is full of it.
    fn matter(is_full: bool) -> All {
        let away = |k: usize| [k % 12, k / 12 % 12, k / 144].map(|at| (at as f64 - 5.5).powi(2)).iter().sum::<f64>();
        let value = |k: usize| if is_full || away(k) < 16.0 { 90.0 + (k % 9) as f64 } else { (k % 5) as f64 };
        let mut samples: Vec<f64> = (0..12 * 12 * 12).map(value).collect();
        samples[777] = 0.0;
        All(samples, [12; 3])
    }

    #[test]
    fn a_full_box_is_cut_open_and_a_ball_in_it_is_not() {
        let slices = SliceFacts { distant_axis: Some(2), ..SliceFacts::default() };
        let full = look_of(DataKind::Scan, &matter(true), None, slices);
        assert!(full.is_cut_open && full.view == Some("xy") && full.light.is_none());
        assert!(full.reason.ends_with("shown in greys"));
        let ball = look_of(DataKind::Scan, &matter(false), None, slices);
        assert!(!ball.is_cut_open && ball.light == Some(SOLID_LIGHT));
        assert!(!look_of(DataKind::Scan, &matter(true), Some(RayOperator::Over), slices).is_cut_open);
    }

    #[test]
    fn looks_have_the_operator_that_suits_or_was_asked_for() {
        let of = |kind, operator| look_of(kind, &matter(false), operator, SliceFacts::default());
        let pet = of(DataKind::Pet, None);
        assert!(pet.is_on_white && pet.operator == RayOperator::Maximum && pet.curves.color[0].rgb == [1.0; 3]);
        let asked = of(DataKind::Pet, Some(RayOperator::FirstHit));
        assert!(!asked.is_on_white && asked.operator == RayOperator::FirstHit);
        assert_eq!(of(DataKind::Ct, Some(RayOperator::Mean)).operator, RayOperator::Mean);
        assert_eq!(of(DataKind::Ct, None).opacity_unit, Some(1.0));
        let few = SliceFacts { are_few: true, ..SliceFacts::default() };
        assert!(look_of(DataKind::Mr, &matter(false), None, few).reason.contains("its 12 slices in greys"));
        assert!(pet.look().is_ok_and(|look| look.background == Some([1.0; 4])));
    }

    #[test]
    fn uniform_samples_have_no_look_but_for_projections_that_depend_on_the_view() {
        let of = |operator| Refusal::of((3.0, 3.0), false, operator);
        assert_eq!([of(None), of(Some(RayOperator::Maximum))], [Some(Refusal::Uniform); 2]);
        assert_eq!([of(Some(RayOperator::Sum)), Refusal::of((3.0, 3.0), true, None)], [None; 2]);
        assert_eq!(Refusal::of((-1e308, 1e308), false, None), Some(Refusal::TooFarApart));
    }
}
