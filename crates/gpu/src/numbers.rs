//! A base plane of a plan as numbers that the shaders read. No decision is taken here; every number is the plan's.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_core::Composite;
use wavesplat_core::Gradient;
use wavesplat_splat::kernel::footprint::group_base;
use wavesplat_splat::kernel::smoothed::width_of;
use wavesplat_splat::optics::classify::TransferTables;
use wavesplat_splat::optics::gradient_opacity::GradientTables;
use wavesplat_splat::optics::shade::Shader;
use wavesplat_splat::render::plan::{FamilyLayer, FamilyPlan, LayerPlan, Operator, Plan};
use wavesplat_splat::render::plan_arrays::BasePlaneArrays;
use wavesplat_splat::source::geometry::SheetGeometry;

use crate::band::{Band, n_mask_words};
use crate::layout::{GpuFrame, GpuLayer, GpuLighting, GpuSource};

/// Stand-in for infinity: shaders may be compiled as if there were no infinities.
const HUGE: f32 = 3e38;

/// A base plane as the numbers that the shaders read.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// Parameters that all layers share.
    pub frame: GpuFrame,
    /// Parameters of each layer.
    pub layers: Vec<GpuLayer>,
    /// Parameters of each source.
    pub sources: Vec<GpuSource>,
    /// Tables of colours, segments, gradients and lights.
    pub tables: Vec<[f32; 4]>,
    /// Positions of texels among samples, and s of the sheets.
    pub words: Vec<u32>,
}

impl Numbers {
    /// Numbers of a base plane of a plan. `fields`: field of each source behind the layers, the first of four where
    /// they are stored side by side.
    pub(crate) fn new(plan: &Plan, family: &FamilyPlan, arrays: &BasePlaneArrays, fields: &[usize]) -> Self {
        let mut numbers = Self {
            frame: frame_of(plan, family, arrays),
            layers: Vec::new(),
            sources: Vec::new(),
            tables: Vec::new(),
            words: Vec::new(),
        };
        for (k, (layer, of_family)) in plan.layers.iter().zip(&family.layers).enumerate() {
            let to_eye = arrays.direction_forms(k).to_eye.map(|form| four(form.as_vec3().to_array()));
            let layer = numbers.layer(layer, of_family, to_eye);
            numbers.layers.push(layer);
        }
        if let Some(shader) = family.layers.first().and_then(|layer| layer.modifiers.label_shader.as_ref()) {
            numbers.frame.label_lighting = numbers.lighting(shader);
        }
        numbers.frame.slabs[3] = numbers.words.len() as u32;
        let sheets = SheetPositions::new(family);
        numbers.words.extend(sheets.s.iter().map(|s| s.to_bits()));
        let of_layers = (0..plan.layers.len()).map(|k| arrays.layer(k));
        for geometry in of_layers.chain(fields.iter().map(|k| arrays.field(*k))) {
            let source = numbers.source(&sheets.w, geometry);
            numbers.sources.push(source);
        }
        numbers
    }

    /// Frame of a band, and the words of its blocks, which follow the words of the base plane; `per_row`: workgroups in
    /// a row of the dispatch.
    pub(crate) fn of_band(&self, family: &FamilyPlan, band: &Band, per_row: usize) -> (GpuFrame, Vec<u32>) {
        let mut frame = self.frame;
        frame.blocks = [self.words.len(), band.blocks.len(), per_row, n_mask_words(family)].map(|n| n as u32);
        let words = band.blocks.iter().map(|[strip, row]| (strip | row << 16) as u32);
        (frame, words.collect())
    }

    /// The parameters of a dispatch as bytes.
    pub(crate) fn parameters(&self, frame: &GpuFrame) -> Vec<u8> {
        let mut bytes = bytemuck::bytes_of(frame).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&self.layers));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.sources));
        bytes
    }

    fn layer(&mut self, layer: &LayerPlan, of_family: &FamilyLayer, to_eye: [[f32; 4]; 3]) -> GpuLayer {
        let mut gpu = self.transfer_function(&layer.tables.arrays(), layer.opacity_unit);
        gpu.to_eye = to_eye;
        if let Some(by_gradient) = &of_family.modifiers.by_gradient {
            let (metric, tables) = by_gradient.arrays();
            gpu.joint_metric = eight(metric);
            match tables {
                GradientTables::Factor { table, per_magnitude } => {
                    gpu.tables[2] = self.table(table);
                    gpu.joint_size[0] = table.len() as u32;
                    gpu.joint[3] = per_magnitude;
                }
                GradientTables::Both { entries, along } => {
                    gpu.tables[2] = self.table(entries);
                    let per_step = |step: f64| if step == 0.0 { 0.0 } else { 1.0 / step as f32 };
                    let [(n, first, step), (n_magnitudes, least, step_magnitude)] = along;
                    gpu.joint_size = [n as u32, n_magnitudes as u32, 0, 0];
                    gpu.joint = [first as f32, per_step(step), least as f32, per_step(step_magnitude)];
                }
            }
        }
        if let Some(shader) = &of_family.shader {
            gpu.lighting = self.lighting(shader);
        }
        gpu
    }

    /// Adds the tables of a transfer function; returns a layer that reads them.
    pub fn transfer_function(&mut self, tables: &TransferTables, opacity_unit: f64) -> GpuLayer {
        let [lo, hi] = tables.visible_range.map(|density| density.clamp(-HUGE, HUGE));
        let [opaque_lo, opaque_hi] = tables.opaque_ends.map(|density| density.clamp(-HUGE, HUGE));
        GpuLayer {
            tables: [self.table(tables.colors), self.table(tables.segments), 0, tables.colors.len() as u32],
            domain: [tables.first, tables.per_density, tables.last, (1.0 / opacity_unit) as f32],
            visible: [lo, hi, opaque_lo, opaque_hi],
            only: tables.only_color.map_or([0.0; 4], |[r, g, b]| [r, g, b, 1.0]),
            ..GpuLayer::default()
        }
    }

    /// Adds a table; returns its offset.
    pub fn table(&mut self, entries: &[[f32; 4]]) -> u32 {
        let place = self.tables.len() as u32;
        self.tables.extend_from_slice(entries);
        place
    }

    /// Adds the lights of a shader; returns its lighting.
    pub fn lighting(&mut self, shader: &Shader) -> GpuLighting {
        let numbers = shader.numbers();
        let [ambient, diffuse, specular] = numbers.ambient_diffuse_specular;
        let place = self.tables.len() as u32;
        for light in &numbers.lights {
            let [u, v, w] = light.on_gradient;
            self.tables.push([u, v, w, f32::from(u8::from(light.is_at_eye))]);
            self.tables.push(four(light.on_view));
            self.tables.push(four(light.rgb));
        }
        GpuLighting {
            coefficients: [ambient, diffuse, specular, numbers.specular_power],
            limits: [numbers.unoriented, numbers.vanishing, numbers.even_cuts, 0.0],
            metric: eight(numbers.metric),
            lights: [place, numbers.lights.len() as u32, 0, 0],
        }
    }

    /// Adds the positions of a source among its samples: on every sheet, of each group of texels along u and v, and of
    /// the sheet along w. `sheets`: positions of the sheets along w, in the order in which rays meet them.
    pub fn source(&mut self, sheets: &[f64], geometry: &SheetGeometry) -> GpuSource {
        let n_groups = geometry.plane.size.map(|n| n.div_ceil(LANES));
        let [last_u, last_v, last_w] = [0, 1, 2].map(|a| geometry.axes[a].last());
        let per_sheet = 2 * (n_groups[0] + n_groups[1]) + 4;
        let mut all_words = vec![0_u32; per_sheet * sheets.len()];
        parallel::for_each_chunk(&mut all_words, per_sheet, |k, words| {
            let ([(u, du), (v, dv)], own_w) = geometry.sheet(sheets[k]);
            let groups = [([u, du], n_groups[0], last_u), ([v, dv], n_groups[1], last_v)];
            let mut words = words.iter_mut();
            let mut push = |word: u32| {
                if let Some(place) = words.next() {
                    *place = word;
                }
            };
            for (positions, n, last) in groups {
                for group in 0..n {
                    let (base, start) = group_base(positions, group, last);
                    push(base as i32 as u32);
                    push(start.to_bits());
                }
            }
            let inside = own_w.clamp(0.0, last_w);
            push(inside.floor() as i32 as u32);
            push(((inside - inside.floor()) as f32).to_bits());
            push((du as f32).to_bits());
            push((dv as f32).to_bits());
        });
        // Table by table, as the shaders read them.
        let first = self.words.len();
        let (n_u, n_v) = (2 * n_groups[0], 2 * n_groups[1]);
        for part in [0..n_u, n_u..n_u + n_v, n_u + n_v..per_sheet] {
            for sheet in all_words.chunks_exact(per_sheet) {
                self.words.extend_from_slice(&sheet[part.clone()]);
            }
        }
        let n = sheets.len();
        let mut last = [0, 0, 0, n_groups[1] as i32];
        for (a, axis) in geometry.plane.family.axes.into_iter().enumerate() {
            last[axis] = geometry.axes[a].n_samples as i32 - 1;
        }
        let axis = &geometry.axes[0];
        let (offset, per_width) = match axis.gradient {
            None => (0.0, 0.0),
            Some(Gradient::Difference(offset)) => (offset as f32, 0.0),
            Some(Gradient::Smoothed(deviation)) => (0.0, 1.0 / width_of(axis.kernel, deviation) as f32),
        };
        GpuSource {
            place: [first, first + n * n_u, first + n * (n_u + n_v), n_groups[0]].map(|n| n as u32),
            last,
            texel: [0.0, 0.0, offset, per_width],
            ..GpuSource::default()
        }
    }
}

/// Positions of the sheets, in the order in which rays meet them.
struct SheetPositions {
    w: Vec<f64>,
    /// `w` with the sign that makes it grow along rays.
    s: Vec<f32>,
}

impl SheetPositions {
    fn new(family: &FamilyPlan) -> Self {
        let mut w = family.sheet_positions();
        if !family.plane.family.ascending {
            w.reverse();
        }
        let s = w.iter().map(|w| family.sign() * *w as f32).collect();
        Self { w, s }
    }
}

fn frame_of(plan: &Plan, family: &FamilyPlan, arrays: &BasePlaneArrays) -> GpuFrame {
    let mut frame = GpuFrame {
        slabs: [0, 0, family.spacing.n_slabs as u32, 0],
        axes: [family.plane.family.axes[2] as u32, 0, 0, 0],
        to_next: arrays.direction_forms(0).to_next.map(|v| four(v.as_vec3().to_array())),
        ..GpuFrame::default()
    };
    frame.number = match plan.operator {
        Operator::Over { opaque, .. } => [opaque, 0.0, 0.0, 0.0],
        Operator::FirstHit { iso } => [iso, 0.0, 0.0, 0.0],
        Operator::LocalMaximum { threshold } => [threshold, 0.0, 0.0, 0.0],
        Operator::Project { composite, levels: [first, second] } => {
            let rate = if let Composite::AttenuatedMaximum { attenuation, .. } = composite { attenuation } else { 0.0 };
            [first, second, rate as f32, 0.0]
        }
    };
    if let Operator::FirstHit { iso } = plan.operator {
        let [r, g, b, _] = plan.layers[0].tables.look_up_one(iso);
        frame.color = [r, g, b, 0.0];
    }
    if let Some(cue) = &plan.depth_cue {
        frame.fade = cue.forms(&family.plane).map(|form| four(DVec3::from_array(form).as_vec3().to_array()));
    }
    if let Some(light) = plan.fields.light {
        let strength = |term: Option<(usize, f32)>| term.map_or(0.0, |(_, strength)| strength);
        frame.light = [strength(light.openness), strength(light.shadow), 0.0, 0.0];
    }
    frame
}

/// Whether a projection's texels are means: the integral divided by the length of the way.
pub(crate) fn is_mean(operator: Operator) -> bool {
    matches!(operator, Operator::Project { composite: Composite::Mean, .. })
}

fn four([a, b, c]: [f32; 3]) -> [f32; 4] {
    [a, b, c, 0.0]
}

fn eight([uu, vv, ww, uv, uw, vw]: [f32; 6]) -> [[f32; 4]; 2] {
    [[uu, vv, ww, uv], [uw, vw, 0.0, 0.0]]
}
