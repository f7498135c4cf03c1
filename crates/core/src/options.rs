//! Render options: kernel, shading, lights, crop, clip planes, and the meaning of a named quality.

use std::sync::Arc;

use glam::DVec3;

use crate::composite::Composite;
use crate::depth_colors::DepthColors;
use crate::error::{Error, Result};
use crate::shapes::Shapes;

/// Reconstruction kernel, separable; the same along all three axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Trilinear, radius 1.
    Linear,
    /// Catmull-Rom cubic, interpolating, radius 2.
    CatmullRom,
    /// Quadratic B-spline with the prefilter that makes it interpolate, radius 1.5.
    Bspline2,
    /// Cubic B-spline with the prefilter that makes it interpolate, radius 2.
    Bspline3,
    /// Westover's Gaussian, radius 2; smooths, does not interpolate.
    Gaussian,
}

impl Kernel {
    /// All kernels with their public names.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("linear", Self::Linear),
        ("catmull-rom", Self::CatmullRom),
        ("bspline2", Self::Bspline2),
        ("bspline3", Self::Bspline3),
        ("gaussian", Self::Gaussian),
    ];

    /// Kernel of a public name.
    pub fn from_name(name: &str) -> Result<Self> {
        find("kernel", name, &Self::NAMES)
    }
}

/// Value of a public name.
pub(crate) fn find<T: Copy>(what: &'static str, name: &str, known: &[(&'static str, T)]) -> Result<T> {
    known.iter().find(|(n, _)| *n == name).map(|&(_, value)| value).ok_or_else(|| Error::UnknownName {
        what,
        name: name.to_owned(),
        known: known.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(", "),
    })
}

/// Frame of a light's direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightFrame {
    /// x right, y up, z towards the viewer: the light turns with the camera.
    Camera,
    /// World axes: the light stays with the volume.
    World,
}

/// A directional light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Frame of `to_light`.
    pub frame: LightFrame,
    /// Direction from the scene to the light; any length but 0.
    pub to_light: DVec3,
    /// Red, green, blue of the diffuse and specular terms.
    pub rgb: [f32; 3],
}

impl Light {
    /// White light along the view direction.
    pub const HEADLIGHT: Self = Self { frame: LightFrame::Camera, to_light: DVec3::Z, rgb: [1.0; 3] };
    /// White light from the upper left of the eye.
    pub const KEY: Self = Self { frame: LightFrame::Camera, to_light: DVec3::new(-0.55, 0.65, 1.0), rgb: [1.0; 3] };
    /// Weaker light at the eye, which shows the form of surfaces that the key light does not reach.
    pub const FILL: Self = Self { rgb: [0.3; 3], ..Self::HEADLIGHT };
}

/// Estimator of the gradient that surfaces are lit by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gradient {
    /// Central differences of the reconstruction, from points this far off on either side, voxels, `0.01..=4`;
    /// one-sided at the faces. Other renderers have 1, which shows the steps of voxels as rings on smooth surfaces.
    Difference(f64),
    /// The derivative of the samples smoothed by a cubic B-spline of this standard deviation, voxels, `0.5..=1.25`.
    Smoothed(f64),
}

/// Phong shading with the reflection vector, two-sided.
///
/// `colour · (ambient + diffuse · |n·l|) + specular · max(0, r·v)^power`; where the gradient vanishes `|n·l|` is
/// [`Shading::unoriented`], and on cut faces [`Shading::even_cuts`] decides. Colours of the picture brighter than
/// [`Shading::shoulder`] are compressed to less than 1, so that highlights keep their form.
///
/// The default is made for looking at pictures: a key light from the upper left, a fill light at the eye, smoothed
/// gradients. [`Shading::headlight`] is the light of VTK's volume mappers, for comparisons.
#[derive(Clone, Debug, PartialEq)]
pub struct Shading {
    /// Weight of the colour in ambient light.
    pub ambient: f32,
    /// Weight of the diffuse term.
    pub diffuse: f32,
    /// Weight of the specular term, which has the light's colour.
    pub specular: f32,
    /// Exponent of the specular term.
    pub specular_power: f32,
    /// Estimator of the gradient that normals are taken from.
    pub gradient: Gradient,
    /// Diffuse light where there is no gradient, as on cut faces of even matter, relative to a surface that faces the
    /// light, `0..=1`: one half is the mean over all normals.
    pub unoriented: f32,
    /// How evenly matter just behind a cut is lit, `0..=1`: with 1 like matter without a gradient, so that a cut face
    /// shows its values and not the relief of its noise; with 0 by its gradient. Cuts are crops, clip planes, missing
    /// samples and the walls of the volume.
    pub even_cuts: f32,
    /// Brightness above which colours of the picture are compressed ([`crate::Picture::finish`]), `0..=1`; 1: no
    /// compression.
    pub shoulder: f32,
    /// Lights, at least one.
    pub lights: Vec<Light>,
    /// Strength of the darkening of hollows, `0..=1`.
    pub ambient_occlusion: f32,
    /// Radius within which the volume occludes, world units; `None`: a tenth of its longest side.
    pub occlusion_radius: Option<f64>,
    /// Strength of the shadow of the first light, `0..=1`.
    pub shadow: f32,
}

impl Default for Shading {
    fn default() -> Self {
        Self {
            ambient: 0.22,
            diffuse: 1.0,
            specular: 0.25,
            specular_power: 16.0,
            gradient: Gradient::Smoothed(0.8),
            unoriented: 0.5,
            even_cuts: 1.0,
            shoulder: 0.75,
            lights: vec![Light::KEY, Light::FILL],
            ..Self::headlight()
        }
    }
}

/// Largest offset of the gradient's differences, voxels.
pub const MAX_GRADIENT_OFFSET: f64 = 4.0;

impl Shading {
    /// Shading as in VTK's volume mappers: one headlight, gradients by central differences, no shoulder.
    pub fn headlight() -> Self {
        Self {
            ambient: 0.1,
            diffuse: 0.7,
            specular: 0.2,
            specular_power: 10.0,
            gradient: Gradient::Difference(1.0),
            unoriented: 0.0,
            even_cuts: 0.0,
            shoulder: 1.0,
            lights: vec![Light::HEADLIGHT],
            ambient_occlusion: 0.0,
            occlusion_radius: None,
            shadow: 0.0,
        }
    }

    /// Checks ranges.
    pub fn validate(&self) -> Result<()> {
        let terms = [("ambient", self.ambient), ("diffuse", self.diffuse), ("specular", self.specular)];
        for (name, value) in terms {
            if !(value.is_finite() && value >= 0.0) {
                let mend = "pass 0 to switch the term off";
                return Err(Error::out_of_range(format!("shading: {name}"), value, "0 or more", mend));
            }
        }
        if !(self.specular_power >= 1.0 && self.specular_power <= 1000.0) {
            let mend = "pass 10 for a soft highlight, 50 for a sharp one";
            return Err(Error::out_of_range(
                "shading: specular_power",
                self.specular_power,
                "between 1 and 1000",
                mend,
            ));
        }
        match self.gradient {
            Gradient::Difference(offset) if !(0.01..=MAX_GRADIENT_OFFSET).contains(&offset) => {
                let mend = "pass 1 for the usual central differences";
                let what = "shading: gradient_offset (voxels)";
                return Err(Error::out_of_range(what, offset, "between 0.01 and 4", mend));
            }
            Gradient::Smoothed(deviation) if !(0.5..=1.25).contains(&deviation) => {
                let mend = "pass 0.8 for smooth surfaces, 0 for central differences";
                let what = "shading: gradient_smoothing (voxels)";
                return Err(Error::out_of_range(what, deviation, "0, or between 0.5 and 1.25", mend));
            }
            _ => {}
        }
        let shares = [
            ("ambient_occlusion", self.ambient_occlusion),
            ("shadow", self.shadow),
            ("shoulder", self.shoulder),
            ("unoriented", self.unoriented),
            ("even_cuts", self.even_cuts),
        ];
        for (name, strength) in shares {
            if !(0.0..=1.0).contains(&strength) {
                let mend = "pass 0 for none and 1 for all of it";
                return Err(Error::out_of_range(format!("shading: {name}"), strength, "between 0 and 1", mend));
            }
        }
        if let Some(radius) = self.occlusion_radius
            && !(radius.is_finite() && radius > 0.0)
        {
            let mend = "pass a length in world units, or nothing for a tenth of the volume";
            return Err(Error::out_of_range("shading: occlusion_radius", radius, "a positive number", mend));
        }
        for (index, light) in self.lights.iter().enumerate() {
            let what = format!("shading: light {index}");
            if light.to_light.try_normalize().is_none() {
                let value = format!("{:?}", light.to_light.to_array());
                let mend = "pass a direction (x, y, z) to the light that is not zero";
                return Err(Error::out_of_range(what, value, "a direction", mend));
            }
            if light.rgb.iter().any(|c| !(c.is_finite() && *c >= 0.0)) {
                let mend = "pass red, green and blue of 0 or more";
                return Err(Error::out_of_range(what, format!("{:?}", light.rgb), "a colour", mend));
            }
        }
        Ok(())
    }
}

/// The box of the volume that is drawn; clean at sub-voxel positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crop {
    /// Corners in index units `(x, y, z)`.
    Index {
        /// Lower corner.
        lo: DVec3,
        /// Upper corner.
        hi: DVec3,
    },
    /// Corners in world units, sides along the world axes.
    World {
        /// Lower corner.
        lo: DVec3,
        /// Upper corner.
        hi: DVec3,
    },
}

impl Crop {
    /// Lower and upper corner, in the units of the variant.
    pub fn corners(&self) -> (DVec3, DVec3) {
        let (Self::Index { lo, hi } | Self::World { lo, hi }) = *self;
        (lo, hi)
    }
}

/// A clip plane: keeps the side that the normal points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipPlane {
    /// A point of the plane, world units.
    pub origin: DVec3,
    /// Normal towards the side that is kept; any length but 0.
    pub normal: DVec3,
}

/// All inputs of a picture but volume, transfer function and camera.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Picture width, pixels.
    pub width_px: usize,
    /// Picture height, pixels.
    pub height_px: usize,
    /// Composite operator.
    pub composite: Composite,
    /// Shading; `None` draws colours as they are.
    pub shading: Option<Shading>,
    /// Sheets per slice distance, `> 0`.
    pub sheets_per_slice: f64,
    /// Texels of the base plane per pixel along each axis, on average in perspective. A pixel is the mean of this
    /// number of reads along each axis, rounded up.
    pub oversampling: f64,
    /// Pre-integration of the slabs between sheets where the transfer function is steep; off: plain sheets, as in the
    /// original method.
    pub pre_integration: bool,
    /// Early ray termination: a ray stops where at most 1e-4 of the light behind comes through; off: 2e-6.
    pub early_ray_termination: bool,
    /// Box that is drawn.
    pub crop: Option<Crop>,
    /// Clip planes; all of them apply.
    pub clip_planes: Vec<ClipPlane>,
    /// Unassociated colour and opacity behind the volume; `None` is transparent.
    pub background: Option<[f32; 4]>,
    /// Whether the picture has depth.
    pub with_depth: bool,
    /// Hues by the place of the extreme, for projections that have one.
    pub depth_colors: Option<DepthColors>,
    /// Surfaces, lines and points in the picture, at their depth.
    pub shapes: Arc<Shapes>,
    /// Worker threads; `None` uses all processors.
    pub n_threads: Option<usize>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        let (sheets_per_slice, oversampling) = QUALITIES[1].1[0];
        Self {
            width_px: 512,
            height_px: 512,
            composite: Composite::Over,
            shading: Some(Shading::default()),
            sheets_per_slice,
            oversampling,
            pre_integration: true,
            early_ray_termination: true,
            crop: None,
            clip_planes: Vec::new(),
            background: None,
            with_depth: false,
            depth_colors: None,
            shapes: Arc::default(),
            n_threads: None,
        }
    }
}

/// Largest side of a picture, pixels: a 16-bit PNG of that side squared is 2 GiB.
pub const MAX_SIDE_PX: usize = 16_384;

impl RenderOptions {
    /// Checks ranges that need no volume.
    pub fn validate(&self) -> Result<()> {
        for (what, side) in [("picture width", self.width_px), ("picture height", self.height_px)] {
            if side == 0 || side > MAX_SIDE_PX {
                let mend = "pass a size of at most 16384 pixels a side";
                return Err(Error::out_of_range(what, side, "between 1 and 16384 pixels", mend));
            }
        }
        if !(self.sheets_per_slice >= 0.05 && self.sheets_per_slice <= 64.0) {
            let mend = "pass 1 for a sheet on every slice, more for finer steps";
            return Err(Error::out_of_range("sheets_per_slice", self.sheets_per_slice, "between 0.05 and 64", mend));
        }
        if !(self.oversampling >= MIN_OVERSAMPLING && self.oversampling <= 8.0) {
            let mend = "pass 1 for one texel a pixel, 2 for four";
            return Err(Error::out_of_range("oversampling", self.oversampling, "between 0.02 and 8", mend));
        }
        if self.n_threads.is_some_and(|n| n == 0 || n > 1024) {
            let value = self.n_threads.unwrap_or(0);
            return Err(Error::out_of_range(
                "threads",
                value,
                "between 1 and 1024",
                "pass nothing to use all processors",
            ));
        }
        self.composite.validate()?;
        self.depth_colors.as_ref().map_or(Ok(()), |colors| colors.validate(self.composite))?;
        for (index, plane) in self.clip_planes.iter().enumerate() {
            if !plane.origin.is_finite() || plane.normal.try_normalize().is_none() {
                let value = format!("{:?}, {:?}", plane.origin.to_array(), plane.normal.to_array());
                let mend = "pass (point, normal), both (x, y, z), the normal not zero";
                return Err(Error::out_of_range(format!("clip plane {index}"), value, "a point and a normal", mend));
            }
        }
        if let Some(rgba) = self.background
            && rgba.iter().any(|c| !(0.0..=1.0).contains(c))
        {
            let mend = "pass red, green, blue (and opacity) between 0 and 1";
            return Err(Error::out_of_range("background", format!("{rgba:?}"), "a colour", mend));
        }
        self.shading.as_ref().map_or(Ok(()), Shading::validate)
    }
}

/// Sheets per slice and oversampling of each named quality, for smooth transfer functions, for steep ones, and for
/// steep ones on a coarser level, where the error of linear slabs is less than the error of the level itself.
/// `studies/quality` and `studies/lod` measure the errors. Settings of the first two kinds are rungs of [`LADDER`].
const QUALITIES: [(&str, [(f64, f64); 3]); 4] = [
    ("draft", [(2.0, 0.5), (2.0, 0.5), (1.0, 0.5)]),
    ("normal", [(2.0, 1.0), (2.0, 1.0), (1.0, 1.0)]),
    ("fine", [(4.0, 1.2), (4.0, 2.0), (4.0, 2.0)]),
    ("high", [(4.0, 1.5), (6.0, 3.0), (6.0, 3.0)]),
];

/// Sheets per slice and oversampling from which a picture of a wanted PSNR is chosen, in order of cost. The last one is
/// too dear for a picture: others are compared with it.
pub const LADDER: [(f64, f64); 13] = [
    (1.0, 0.5),
    (2.0, 0.5),
    (2.0, 0.7),
    (2.0, 1.0),
    (3.0, 1.0),
    (3.0, 1.2),
    (4.0, 1.2),
    (4.0, 1.5),
    (4.0, 2.0),
    (6.0, 2.0),
    (6.0, 3.0),
    (8.0, 3.0),
    (12.0, 4.0),
];

/// `(sheets_per_slice, oversampling)` of quality `draft`, `normal`, `fine` or `high`. `needs_preintegration`: whether
/// the transfer function can change opacity or colour by a visible amount within a voxel, or has thin peaks.
/// `coarseness` and `samples_per_pixel`: see [`oversampling_of_level`].
pub fn quality_settings(
    name: &str,
    needs_preintegration: bool,
    coarseness: f64,
    samples_per_pixel: f64,
) -> Result<(f64, f64)> {
    let kind = usize::from(needs_preintegration) + usize::from(needs_preintegration && coarseness > 1.0);
    let (sheets_per_slice, oversampling) = find("quality", name, &QUALITIES)?[kind];
    Ok((sheets_per_slice, oversampling_of_level(oversampling, coarseness, samples_per_pixel)))
}

/// Texels per pixel on a level of a `coarseness`, see [`crate::Grid::coarseness`]. Texels grow with the samples of a
/// coarser level, so that its picture is the finer one's at a lower resolution, but not beyond a sample, of which a
/// pixel holds `samples_per_pixel`.
pub fn oversampling_of_level(oversampling: f64, coarseness: f64, samples_per_pixel: f64) -> f64 {
    let least = samples_per_pixel.clamp(MIN_OVERSAMPLING, oversampling);
    (oversampling / coarseness).max(least)
}

/// Minimum of texels per pixel along an axis.
const MIN_OVERSAMPLING: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_unknown_ones_list_the_known() {
        for (name, kernel) in Kernel::NAMES {
            assert_eq!(Kernel::from_name(name), Ok(kernel));
        }
        let oversampling = |coarseness, per_pixel| quality_settings("normal", false, coarseness, per_pixel).unwrap().1;
        assert_eq!([oversampling(1.0, 9.0), oversampling(2.0, 0.7), oversampling(2.0, 0.4)], [1.0, 0.7, 0.5]);
        assert_eq!([oversampling(4.0, 0.1), oversampling(8.0, 0.05), oversampling(4.0, 0.5)], [0.25, 0.125, 0.5]);
        assert_eq!(oversampling(64.0, 1e-9), MIN_OVERSAMPLING);
        let sheets = |name, needs_preintegration, coarseness| {
            quality_settings(name, needs_preintegration, coarseness, 0.5).unwrap().0
        };
        assert_eq!(
            [sheets("normal", true, 1.0), sheets("normal", true, 2.0), sheets("normal", false, 2.0)],
            [2.0, 1.0, 2.0]
        );
        assert_eq!([sheets("high", true, 1.0), sheets("high", true, 2.0), sheets("draft", true, 2.0)], [6.0, 6.0, 1.0]);
        let message = Kernel::from_name("cubic").unwrap_err().to_string();
        assert!(message.contains("catmull-rom") && message.contains("cubic"), "{message}");
        assert!(
            quality_settings("best", false, 1.0, 1.0).unwrap_err().to_string().contains("draft, normal, fine, high")
        );
    }

    #[test]
    fn named_qualities_are_rungs_of_the_ladder_and_each_is_finer_than_the_one_before() {
        for kind in 0..2 {
            let rungs = QUALITIES.map(|(name, settings)| {
                LADDER.iter().position(|rung| *rung == settings[kind]).unwrap_or_else(|| panic!("{name}, {kind}"))
            });
            assert!(rungs.is_sorted_by(|a, b| a < b), "{rungs:?}");
        }
    }

    #[test]
    fn bad_options_are_refused() {
        let check = |change: fn(&mut RenderOptions)| {
            let mut options = RenderOptions::default();
            change(&mut options);
            assert!(options.validate().is_err());
        };
        assert!(RenderOptions::default().validate().is_ok());
        check(|o| o.width_px = 0);
        check(|o| o.height_px = 1_000_000);
        check(|o| o.sheets_per_slice = f64::NAN);
        check(|o| o.oversampling = 0.0);
        check(|o| o.n_threads = Some(0));
        check(|o| o.composite = Composite::FirstHit { iso_value: f64::NAN });
        check(|o| o.clip_planes = vec![ClipPlane { origin: DVec3::ZERO, normal: DVec3::ZERO }]);
        check(|o| o.background = Some([2.0, 0.0, 0.0, 1.0]));
        check(|o| o.shading = Some(Shading { specular_power: 0.0, ..Shading::default() }));
        check(|o| o.shading = Some(Shading { ambient: -1.0, ..Shading::default() }));
        check(|o| o.shading = Some(Shading { shadow: 1.5, ..Shading::default() }));
        check(|o| o.shading = Some(Shading { occlusion_radius: Some(0.0), ..Shading::default() }));
    }
}
