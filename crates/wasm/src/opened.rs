//! A volume, its look, its camera, and its last picture.

use std::sync::Arc;

use serde_json::{Value, json};
use wavesplat::document::{CameraDocument, LensField, LookDocument};
use wavesplat::files::{self, FileVolume};
use wavesplat::glam::{DAffine3, DMat3, DVec3};
use wavesplat::look::FoundKind;
use wavesplat::view::{Fit, InView, Lens, Pose, grid_corners, view_angles};
use wavesplat::{
    AutoLook, Composite, Effort, Facts, FrameOptions, FramedScene, Kernel, Look, Picture, PlacedCamera, Plane, Quality,
    Reduction, SampleBuffer, Samples, Scene, SceneVolume, ThickSlab, Volume, VolumeCache, cut_open, kind_of,
    look_document, straight_bytes,
};

use crate::requests::{counts, number, numbers, text};

/// A volume, its look, its camera, and its last picture.
pub struct OpenedVolume {
    file: &'static FileVolume,
    volume: Volume<'static>,
    /// The scene and the options of its picture, once there is a look.
    scene: Option<(Scene<'static>, FrameOptions)>,
    cache: Arc<VolumeCache>,
    /// The volume without a corner, once a look has asked for it, and the view whose corner it is.
    cut_open: Option<(Option<&'static str>, Volume<'static>)>,
    /// View and operator that the camera is fitted for.
    fitted_for: (Option<String>, Composite),
    pose: Option<Pose>,
    picture: Option<Picture>,
}

/// Any error as its message.
#[allow(clippy::needless_pass_by_value, reason = "map_err gives errors away")]
fn message(error: impl ToString) -> String {
    error.to_string()
}

/// A file's samples, kept for good once they are known to be a volume: they stay as long as the instance.
fn kept(file: FileVolume) -> Result<(&'static FileVolume, Volume<'static>), String> {
    let statistics = file.volume().map_err(message)?.grid().statistics();
    let file: &'static FileVolume = Box::leak(Box::new(file));
    let volume =
        Volume::with_statistics(&file.facts.name, file.samples(), file.size, file.world_from_index, statistics);
    Ok((file, volume.map_err(message)?))
}

impl OpenedVolume {
    /// The volume of a NIfTI or NRRD file.
    ///
    /// # Errors
    ///
    /// The reader's message, or the renderer's for a volume that cannot be drawn.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, String> {
        let other = |file: &str| Err(format!("the samples are in another file, {file}; give a file that holds them"));
        Self::of(files::read(name, bytes, other).map_err(message)?)
    }

    /// The volume of samples. `head`: JSON of `name`, `type` as NumPy names it, `size` along x, y and z,
    /// `world_from_index` as rows of 3 x 4, and `facts`, some of the texts `unit`, `modality`, `value_unit` and
    /// `quantity`, and `is_anatomical`. `bytes`: little-endian, x fastest.
    ///
    /// # Errors
    ///
    /// A message that names the field, or the renderer's.
    pub fn of_samples(head: &Value, bytes: Vec<u8>) -> Result<Self, String> {
        let rows: [[f64; 4]; 3] = {
            let given = &head["world_from_index"];
            let row = |at: usize| numbers(&given[at], "world_from_index");
            [row(0)?, row(1)?, row(2)?]
        };
        let column = |at: usize| DVec3::from_array(rows.map(|row| row[at]));
        let fact = |name: &str| match head["facts"].get(name).filter(|given| !given.is_null()) {
            None => Ok(None),
            Some(given) => given
                .as_str()
                .map(|fact| Some(fact.to_owned()))
                .ok_or_else(|| format!("fact '{name}' is {given}; give a text")),
        };
        let facts = Facts {
            name: text(head, "name", "")?.to_owned(),
            unit: fact("unit")?,
            is_anatomical: head["facts"]["is_anatomical"] == true,
            modality: fact("modality")?,
            value_unit: fact("value_unit")?,
            quantity: fact("quantity")?,
            ..Facts::default()
        };
        Self::of(FileVolume {
            size: counts(&head["size"], "size")?,
            world_from_index: DAffine3::from_mat3_translation(
                DMat3::from_cols(column(0), column(1), column(2)),
                column(3),
            ),
            facts,
            buffer: buffer(text(head, "type", "")?, bytes)?,
        })
    }

    fn of(file: FileVolume) -> Result<Self, String> {
        let (file, volume) = kept(file)?;
        Ok(Self {
            file,
            volume,
            scene: None,
            cache: Arc::default(),
            cut_open: None,
            fitted_for: (None, Composite::Over),
            pose: None,
            picture: None,
        })
    }

    /// Size, type, place, range and facts.
    pub fn described(&self) -> Value {
        let grid = self.volume.grid();
        let columns = self.file.world_from_index.to_cols_array_2d();
        let rows: [[f64; 4]; 3] = std::array::from_fn(|row| columns.map(|column| column[row]));
        let (statistics, facts) = (grid.statistics(), &self.file.facts);
        json!({
            "name": facts.name,
            "size": self.file.size,
            "type": sample_type(self.volume.samples()),
            "world_from_index": rows,
            "range": [statistics.min, statistics.max],
            "n_missing": statistics.n_nonfinite,
            "facts": {
                "unit": facts.unit,
                "is_anatomical": facts.is_anatomical,
                "modality": facts.modality,
                "value_unit": facts.value_unit,
                "quantity": facts.quantity,
                "conventions": facts.conventions,
                "guesses": facts.guesses,
            },
        })
    }

    /// The samples as bytes, x fastest.
    pub fn sample_bytes(&self) -> &'static [u8] {
        match &self.file.buffer {
            SampleBuffer::U8(samples) => samples,
            SampleBuffer::I8(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::U16(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::I16(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::U32(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::I32(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::F32(samples) => bytemuck::cast_slice(samples),
            SampleBuffer::F64(samples) => bytemuck::cast_slice(samples),
        }
    }

    /// The kind of data.
    pub fn kind(&self) -> FoundKind {
        kind_of(&self.volume, &self.file.facts)
    }

    /// Takes the look that suits the volume, `{"auto": true}`, that of a preset, or of a document. The answer has the look's
    /// document, which gives the same look again; null for a look that is cut open.
    ///
    /// # Errors
    ///
    /// An unknown preset, samples that are all equal, or a document that is not valid or has what is not drawn yet.
    pub fn set_look(&mut self, asked: &Value) -> Result<Value, String> {
        if let Some(look) = asked.get("document") {
            let read = LookDocument::read(&look).map_err(message)?;
            let mut fields = look.clone();
            fields.as_object_mut().map(|fields| fields.remove("version"));
            let layer = json!({"volume": {"path": self.file.facts.name}, "look": fields});
            let document = json!({"wavesplat": "scene", "version": 1, "layers": [layer], "keep_table": true});
            let [name, reason, _, view, ..] = read.texts;
            if let Some(view) = &view {
                view_angles(view, self.file.facts.is_anatomical).map_err(message)?;
            }
            let framed = self.framed(&document)?;
            self.show(framed.scene, framed.options, view);
            let [name, reason] = [name, reason].map(Option::unwrap_or_default);
            return Ok(json!({"name": name, "reason": reason, "is_cut_open": false, "document": look}));
        }
        let look = if asked["auto"] == true {
            Look::auto(&self.volume, &self.file.facts)
        } else {
            Look::preset(text(asked, "preset", "")?)
        }
        .map_err(message)?;
        let volume = if look.is_cut_open { self.without_corner(look.view)? } else { self.volume.clone() };
        let scene = Scene::with_look(volume, &look);
        let document = look_document(&look).ok();
        let options = FrameOptions { composite: look.composite, ..FrameOptions::default() };
        self.show(scene, options, look.view.map(str::to_owned));
        let (name, reason, is_cut_open) = (look.name, look.reason, look.is_cut_open);
        Ok(json!({"name": name, "reason": reason, "is_cut_open": is_cut_open, "document": document}))
    }

    fn without_corner(&mut self, view: Option<&'static str>) -> Result<Volume<'static>, String> {
        if let Some((of_view, volume)) = &self.cut_open
            && *of_view == view
        {
            return Ok(volume.clone());
        }
        let (_, volume) = kept(cut_open(&self.volume, &self.file.facts, view).map_err(message)?)?;
        Ok(self.cut_open.insert((view, volume)).1.clone())
    }

    /// Takes the scene of a document, with its camera, if it has one. The answer has the size of its picture.
    ///
    /// # Errors
    ///
    /// A document that is not valid, has what is not drawn yet, or names two volumes.
    pub fn set_scene(&mut self, document: &Value) -> Result<Value, String> {
        let framed = self.framed(document)?;
        if framed.camera.is_some() {
            self.pose = Some(pose_of(&CameraDocument::read(&&document["camera"]).map_err(message)?));
        }
        let size = framed.size_px;
        self.show(framed.scene, framed.options, None);
        Ok(json!({"size": size, "camera": self.pose.as_ref().map(camera_fields)}))
    }

    /// The scene of a document whose layers all show the volume.
    fn framed(&self, document: &Value) -> Result<FramedScene<'static>, String> {
        let mut source = None;
        let framed = Scene::from_document(document, |named| {
            if source.get_or_insert_with(|| named.clone()) != named {
                return Err("an instance holds one volume, and this is another one".into());
            }
            Ok((self.volume.clone(), self.file.facts.clone()))
        });
        framed.map_err(message)
    }

    /// Shows a scene, with what is prepared of the samples. `view`: the name of the view that it is made for.
    fn show(&mut self, mut scene: Scene<'static>, options: FrameOptions, view: Option<String>) {
        for layer in &mut scene.layers {
            // Samples that are cut open have others.
            if let SceneVolume::Samples(volume, cache) = &mut layer.volume
                && volume.grid().statistics() == self.volume.grid().statistics()
            {
                *cache = Arc::clone(&self.cache);
            }
        }
        self.fitted_for = (view, options.composite);
        self.scene = Some((scene, options));
    }

    fn scene(&self) -> Result<&(Scene<'static>, FrameOptions), String> {
        self.scene.as_ref().ok_or_else(|| "there is no look yet; ask 'look' before".to_owned())
    }

    fn pose(&self) -> Result<Pose, String> {
        self.pose.ok_or_else(|| "there is no camera yet; ask 'camera' before".to_owned())
    }

    /// Places the camera: `{"fit": true}` around what the look shows, `{"view": "anterior"}`, `{"orbit": [azimuth,
    /// elevation]}`, each with `aspect`, width over height, the last two with `zoom` and `view_angle` (degrees; orthographic
    /// without); `{"turned": [azimuth, elevation, roll]}`, `{"zoomed": factor}` from where it is; `{"document": {...}}`.
    ///
    /// # Errors
    ///
    /// A number out of range, a view that there is not, or no camera to turn.
    pub fn set_camera(&mut self, asked: &Value) -> Result<Value, String> {
        let aspect = number(asked, "aspect", 1.0)?;
        let corners = grid_corners(self.volume.grid());
        let mut framing = InView::around(&corners).aspect(aspect).zoom(number(asked, "zoom", 1.0)?);
        if asked.get("view_angle").is_some() {
            framing = framing.perspective(number(asked, "view_angle", 0.0)?);
        }
        let pose = if let Some(document) = asked.get("document") {
            pose_of(&CameraDocument::read(&document).map_err(message)?)
        } else if asked.get("view").is_some() {
            framing.view(text(asked, "view", "")?, self.file.facts.is_anatomical).map_err(message)?
        } else if let Some(given) = asked.get("orbit") {
            let [azimuth, elevation] = numbers(given, "orbit")?;
            framing.orbit(azimuth, elevation, Fit::View).map_err(message)?
        } else if let Some(given) = asked.get("turned") {
            let [azimuth, elevation, roll] = numbers(given, "turned")?;
            self.pose()?.turned(azimuth, elevation, roll)
        } else if asked.get("zoomed").is_some() {
            self.pose()?.zoomed(number(asked, "zoomed", 1.0)?).map_err(message)?
        } else if asked["fit"] == true {
            let (view, composite) = &self.fitted_for;
            let shown = (view.as_deref(), *composite);
            Pose::fit_as(&self.scene()?.0, &self.file.facts, shown, aspect).map_err(message)?
        } else {
            return Err("a camera is asked for by one of: fit, view, orbit, turned, zoomed, document".to_owned());
        };
        pose.camera().map_err(message)?;
        self.pose = Some(pose);
        Ok(camera_fields(&pose))
    }

    /// Draws a picture; its bytes are red, green, blue and opacity, straight.
    ///
    /// # Errors
    ///
    /// No look or camera yet, an unknown quality, or the renderer's.
    pub fn draw(&mut self, asked: &Value) -> Result<Vec<u8>, String> {
        let size = counts(&asked["size"], "size")?;
        let (scene, options) = self.scene()?;
        let mut options = FrameOptions { n_threads: Some(1), ..options.clone() };
        if asked.get("quality").is_some() {
            options.effort = Effort::Named(match text(asked, "quality", "")? {
                "draft" => Quality::Draft,
                "normal" => Quality::Normal,
                "fine" => Quality::Fine,
                "high" => Quality::High,
                other => return Err(format!("there is no quality '{other}'; use draft, normal, fine or high")),
            });
        }
        let frame = scene.render(&self.pose()?.camera().map_err(message)?, size, &options).map_err(message)?;
        let bytes = straight_bytes(frame.picture.rgba.as_flattened());
        self.picture = Some(frame.picture);
        Ok(bytes)
    }

    /// The floats of the last picture.
    ///
    /// # Errors
    ///
    /// Nothing is drawn yet.
    pub fn floats(&self) -> Result<Vec<f32>, String> {
        let picture = self.picture.as_ref().ok_or("nothing is drawn yet; ask 'draw' before")?;
        Ok(picture.rgba.as_flattened().to_vec())
    }

    /// Values on a plane: `origin`, the steps `across` and `down` in the world, `size` in pixels; `slab` of `n_planes`, a
    /// `step` and a `reduction`.
    ///
    /// # Errors
    ///
    /// A field that is wrong, or the renderer's.
    pub fn slice(&self, asked: &Value) -> Result<Vec<f32>, String> {
        let vector = |asked: &Value, name: &str| numbers(&asked[name], name).map(DVec3::from_array);
        let [width_px, height_px] = counts(&asked["size"], "size")?;
        let plane = Plane {
            origin: vector(asked, "origin")?,
            across: vector(asked, "across")?,
            down: vector(asked, "down")?,
            width_px,
            height_px,
        };
        let slab = match asked.get("slab") {
            None => ThickSlab { reduction: Reduction::Mean, n_planes: 1, step: DVec3::ZERO },
            Some(slab) => ThickSlab {
                reduction: Reduction::from_name(text(slab, "reduction", "mean")?).map_err(message)?,
                n_planes: counts::<1>(&json!([slab["n_planes"]]), "n_planes")?[0],
                step: vector(slab, "step")?,
            },
        };
        let volume = SceneVolume::Samples(self.volume.clone(), Arc::clone(&self.cache));
        volume.slice(&plane, &slab, Kernel::Linear, Some(1), &()).map_err(message)
    }
}

fn camera_fields(pose: &Pose) -> Value {
    let [position, focal_point, view_up] = [pose.position, pose.focal_point, pose.view_up].map(|v| v.to_array());
    let (lens, value) = match pose.lens {
        Lens::ParallelScale(scale) => ("parallel_scale", scale),
        Lens::ViewAngleDeg(angle) => ("view_angle", angle),
    };
    json!({"version": 1, "position": position, "focal_point": focal_point, "view_up": view_up, lens: value})
}

fn pose_of(document: &CameraDocument) -> Pose {
    let [position, focal_point, view_up] =
        [document.position, document.focal_point, document.view_up].map(DVec3::from_array);
    let lens = match document.lens {
        LensField::ParallelScale(scale) => Lens::ParallelScale(scale),
        LensField::ViewAngle(angle) => Lens::ViewAngleDeg(angle),
    };
    Pose { position, focal_point, view_up, lens }
}

/// NumPy's name of the type of samples.
fn sample_type(samples: &Samples<'_>) -> &'static str {
    match samples {
        Samples::U8(_) => "uint8",
        Samples::I8(_) => "int8",
        Samples::U16(_) => "uint16",
        Samples::I16(_) => "int16",
        Samples::U32(_) => "uint32",
        Samples::I32(_) => "int32",
        Samples::F32(_) => "float32",
        Samples::F64(_) => "float64",
    }
}

/// Bytes as samples of a type.
fn buffer(sample_type: &str, bytes: Vec<u8>) -> Result<SampleBuffer, String> {
    macro_rules! samples {
        ($variant:ident: $t:ty) => {{
            let (parts, rest) = bytes.as_chunks::<{ size_of::<$t>() }>();
            if !rest.is_empty() {
                return Err(format!("{} bytes are no whole number of samples of {sample_type}", bytes.len()));
            }
            Ok(SampleBuffer::$variant(parts.iter().map(|part| <$t>::from_le_bytes(*part)).collect()))
        }};
    }
    match sample_type {
        "uint8" => Ok(SampleBuffer::U8(bytes)),
        "int8" => samples!(I8: i8),
        "uint16" => samples!(U16: u16),
        "int16" => samples!(I16: i16),
        "uint32" => samples!(U32: u32),
        "int32" => samples!(I32: i32),
        "float32" => samples!(F32: f32),
        "float64" => samples!(F64: f64),
        _ => Err(format!("there is no type of samples '{sample_type}'")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: i16 = 20;

    /// A ball with a bright middle, of 8 bits.
    fn ball(modality: Option<&str>) -> OpenedVolume {
        let at = |k: i16| [k % N, k / N % N, k / N / N].map(|at| f64::from(at) - 9.3);
        let away = (0..N * N * N).map(at).map(|[x, y, z]| (x * x + 1.3 * y * y + 0.8 * z * z).sqrt());
        let bytes = away.map(|r| (250.0 * (-0.02 * r * r).exp()) as u8).collect();
        let rows = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];
        let facts = json!({"modality": modality, "unit": "mm", "is_anatomical": modality.is_some()});
        let head =
            json!({"name": "ball", "type": "uint8", "size": [N, N, N], "world_from_index": rows, "facts": facts});
        OpenedVolume::of_samples(&head, bytes).unwrap()
    }

    fn drawn(opened: &mut OpenedVolume) -> (Value, Vec<u8>) {
        let camera = opened.set_camera(&json!({"fit": true})).unwrap();
        (camera, opened.draw(&json!({"size": [24, 20], "quality": "draft"})).unwrap())
    }

    #[test]
    fn the_document_of_a_look_is_the_look() {
        let names: Vec<String> = wavesplat::look::presets::names().collect();
        let mut n_told = 0;
        for (modality, asked) in [(None, json!({"auto": true})), (Some("PT"), json!({"auto": true}))]
            .into_iter()
            .chain(names.iter().map(|name| (None, json!({"preset": name}))))
        {
            let mut opened = ball(modality);
            // Some presets are for the values of a volume.
            let Ok(told) = opened.set_look(&asked) else { continue };
            let before = (opened.scene().unwrap().1.composite, drawn(&mut opened));
            let again = opened.set_look(&json!({"document": told["document"]})).unwrap();
            assert_eq!(again, told, "{asked}");
            assert_eq!((opened.scene().unwrap().1.composite, drawn(&mut opened)), before, "{asked}");
            n_told += 1;
        }
        assert!(n_told > 20, "{n_told}");
        let told = ball(Some("PT")).set_look(&json!({"auto": true})).unwrap();
        assert_eq!([&told["document"]["composite"], &told["document"]["background"]], ["maximum", "#ffffff"]);
    }

    #[test]
    fn a_document_is_seen_from_its_view() {
        let mut opened = ball(Some("MR"));
        let mut document = opened.set_look(&json!({"auto": true})).unwrap()["document"].clone();
        document["view"] = json!("superior");
        opened.set_look(&json!({"document": document})).unwrap();
        let camera = drawn(&mut opened).0;
        let above: [f64; 3] = numbers(&camera["position"], "position").unwrap();
        let middle: [f64; 3] = numbers(&camera["focal_point"], "focal_point").unwrap();
        assert!((above[0] - middle[0]).abs() < 1e-9 && above[2] > middle[2], "{camera}");
        document["view"] = json!("inside");
        let error = opened.set_look(&json!({"document": document})).unwrap_err();
        assert!(error.starts_with("unknown view \"inside\""), "{error}");
    }

    #[test]
    fn each_view_leaves_out_its_own_corner() {
        let mut opened = ball(None);
        let mut missing = |view| {
            let volume = opened.without_corner(Some(view)).unwrap();
            (0..volume.samples().len()).map(|k| volume.samples().get(k).is_nan()).collect::<Vec<_>>()
        };
        let [first, other, again] = ["xy", "yz", "xy"].map(&mut missing);
        assert_ne!(first, other);
        assert_eq!(first, again);
    }
}
