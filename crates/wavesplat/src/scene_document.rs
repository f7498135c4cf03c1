//! Scenes from documents, and documents of scenes.

use std::error::Error as AnyError;
use std::sync::Arc;

use serde_json::{Value, json};
use wavesplat_core::{Camera, ClipPlane, Composite, Crop, Error, Facts, Kernel, Shading, TransferFunction, Volume};
use wavesplat_document::{VERSION, check_document};
use wavesplat_look::{DataKind, Look};
use wavesplat_splat::optics::labels::Labels;
use wavesplat_splat::quality::ladder::Sampling;

use crate::automatic::AutoLook;
use crate::document_labels::labels_of;
use crate::document_values::{
    DocumentError, DocumentResult, camera_fields, camera_of, clips, clips_of, color_of, composite_fields, curves,
    exact, faded, fields_of_look, look_of, made, not_drawn, operator, quality, shading,
};
use crate::frame::{Frame, FrameOptions};
use crate::kind::kind_of;
use crate::quality::Effort;
use crate::scene::{Scene, SceneLayer, SceneVolume};

/// A scene with the camera and the options of its picture, as a document says them.
///
/// [`Scene::from_document`] reads one. [`FramedScene::document`] writes it again: what was not changed stands there as it
/// was read, with names, files of volumes, and whatever else no picture shows.
///
/// ```
/// use wavesplat::glam::DAffine3;
/// use wavesplat::{Facts, Samples, Scene, Volume};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = r#"{"wavesplat": "scene", "version": 1,
///     "layers": [{"volume": {"path": "ball.npy"}, "look": {"shading": null, "transfer_function": {
///         "opacity": [[50, 0], [200, 0.8]], "color": [[50, 1, 0, 0], [200, 1, 1, 1]]}}}],
///     "background": "black", "clip": [{"plane": {"point": [8, 8, 8], "normal": [1, 0, 0]}}],
///     "camera": {"version": 1, "position": [8, 90, 8], "focal_point": [8, 8, 8], "view_up": [0, 0, 1],
///                "parallel_scale": 9},
///     "render": {"size": [48, 48], "quality": "draft"}}"#;
/// let samples: Vec<u8> = (0..16 * 16 * 16).map(|k| (k % 256) as u8).collect();
/// let framed = Scene::from_document(&text.parse()?, |source| {
///     assert_eq!(source["path"], "ball.npy");
///     Ok((Volume::new("ball", Samples::U8(&samples), [16; 3], DAffine3::IDENTITY)?, Facts::default()))
/// })?;
/// let frame = framed.render()?;
/// assert_eq!(frame.picture.rgba.len(), 48 * 48);
/// assert_eq!(framed.document()?, text.parse::<serde_json::Value>()?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct FramedScene<'a> {
    /// The layers that are visible, and all that is drawn of them.
    pub scene: Scene<'a>,
    /// The camera; `None` if the document has none.
    pub camera: Option<Camera>,
    /// Width and height of the picture, pixels; `None` if the document does not say.
    pub size_px: Option<[usize; 2]>,
    /// Options of the picture.
    pub options: FrameOptions,
    source: Value,
    /// The same with looks written out that it has by name, or leaves open.
    settled: Value,
    /// The labels of the document.
    labels: Option<Arc<Labels>>,
}

/// Volume and facts that a document's source names, or why there are none.
type Named<'a> = Result<(Volume<'a>, Facts), Box<dyn AnyError + Send + Sync>>;

impl<'a> Scene<'a> {
    /// The scene that a document describes, as Python and the viewer write it, with its camera and picture.
    ///
    /// `volume`: gives the samples of a source, such as `{"path": "ct.nii.gz"}`, with the facts of their file; the crate
    /// opens nothing. Layers that are hidden are not asked for. Nothing that the document says is left out silently.
    ///
    /// # Errors
    ///
    /// If a field is wrong, a volume cannot be had, or the document has something that this crate does not draw yet;
    /// the message names the field.
    pub fn from_document(
        document: &Value,
        mut volume: impl FnMut(&Value) -> Named<'a>,
    ) -> DocumentResult<FramedScene<'a>> {
        check_document(&document, "scene")?;
        let mut named = |layer: &Value, number: usize| {
            let failed = |error| DocumentError::Volume { place: format!("layers[{number}].volume"), error };
            volume(&layer["volume"]).map_err(failed)
        };
        let (mut settled, mut opened) = (document.clone(), None);
        let shown = shown_layers(document);
        for &(number, layer) in &shown {
            let place = format!("layers[{number}].look");
            if !is_automatic(&layer["look"]) {
                if let Some(name) = layer["look"].as_str() {
                    let look = Look::preset(name).map_err(|error| made(&place, error))?;
                    settled["layers"][number]["look"] = fields_of_look(&look)?;
                }
            } else if shown.len() == 1 {
                let (samples, facts) = named(layer, number)?;
                settled["layers"][number]["look"] =
                    automatic(&samples, &facts, &document["render"]["composite"], &place)?;
                opened = Some((samples, facts));
            } else {
                return Err(DocumentError::NotDrawn {
                    field: place,
                    what: "the look that suits the data of one of several layers".to_owned(),
                    mend: "write a look, or draw it with the Python package",
                });
            }
        }
        let said = SaidScene::of(&settled)?;
        let mut layers = Vec::new();
        for layer in &said.layers {
            let (samples, facts) = match opened.take() {
                Some(found) => found,
                None => named(&document["layers"][layer.number], layer.number)?,
            };
            if !said.keeps_table && said.options.composite != Composite::Minimum && may_have_table(&samples, &facts) {
                return Err(not_drawn("keep_table", "false with a CT, in which a table may lie below a patient"));
            }
            let volume = SceneVolume::Samples(samples, Arc::default());
            let (transfer_function, shading) = (layer.transfer_function.clone(), layer.shading.clone());
            layers.push(SceneLayer { volume, transfer_function, shading, color: None });
        }
        let labels = match &document["labels"] {
            Value::Null => None,
            fields => {
                let failed = |error| DocumentError::Volume { place: "labels.volume".to_owned(), error };
                let (segmentation, _) = volume(&fields["volume"]).map_err(failed)?;
                Some(labels_of(fields, &segmentation, layers[0].volume.grid())?)
            }
        };
        let scene = Scene {
            labels: labels.clone(),
            crop: said.crop,
            clip_planes: said.clip_planes,
            background: said.background,
            ..Scene::of(layers)
        };
        let (camera, size_px, options) = (said.camera, said.size_px, said.options);
        Ok(FramedScene { scene, camera, size_px, options, source: document.clone(), settled, labels })
    }

    /// The document of the scene; `sources` name the volumes of its layers, such as `{"path": "ct.nii.gz"}`.
    ///
    /// # Errors
    ///
    /// If there is not one source for each layer, or the scene has what documents cannot say: labels, shapes, and fields
    /// that colour layers, whose sources nobody names.
    pub fn document(&self, sources: &[Value]) -> DocumentResult<Value> {
        if sources.len() != self.layers.len() {
            return Err(DocumentError::NotWritten(format!(
                "{} layers and {} sources",
                self.layers.len(),
                sources.len()
            )));
        }
        let layers = self.layers.iter().zip(sources);
        let layers: Vec<Value> =
            layers.map(|(layer, source)| json!({"volume": source, "look": look_of(layer)})).collect();
        let source = json!({
            "wavesplat": "scene", "version": VERSION, "layers": layers, "labels": null, "shading": "look", "clip": [],
            "background": null, "keep_table": true,
        });
        let options = FrameOptions::default();
        let settled = source.clone();
        FramedScene { scene: self.clone(), camera: None, size_px: None, options, source, settled, labels: None }
            .document()
    }
}

impl FramedScene<'_> {
    /// Draws the picture.
    ///
    /// # Errors
    ///
    /// [`Error`] as of [`Scene::render`]; without a camera or a size too: see [`PlacedCamera`](crate::PlacedCamera).
    pub fn render(&self) -> Result<Frame, Error> {
        let missing = |what: &str, mend| Error::out_of_range(what, "missing in the document", "there", mend);
        let camera = self.camera.as_ref().ok_or_else(|| missing("camera", "set FramedScene::camera"))?;
        let size = self.size_px.ok_or_else(|| missing("size of the picture", "set FramedScene::size_px"))?;
        self.scene.render(camera, size, &self.options)
    }

    /// The document: as it was read, but for what has changed since.
    ///
    /// # Errors
    ///
    /// If the scene has what documents cannot say, or other layers than the document.
    pub fn document(&self) -> DocumentResult<Value> {
        let (said, scene) = (SaidScene::of(&self.settled)?, &self.scene);
        let has = |what: &str| Err(DocumentError::NotWritten(what.to_owned()));
        let is_known = |labels: &Arc<Labels>| self.labels.as_ref().is_some_and(|known| Arc::ptr_eq(known, labels));
        if scene.labels.as_ref().is_some_and(|labels| !is_known(labels)) {
            return has("labels");
        }
        if *scene.shapes != wavesplat_core::Shapes::default() {
            return has("shapes");
        }
        if scene.layers.len() != said.layers.len() {
            return has("other layers than the document that it was read from");
        }
        let mut document = self.source.clone();
        if scene.labels.is_none() && self.labels.is_some() {
            document["labels"] = Value::Null;
        }
        let is_lit_alike = scene.layers.iter().zip(&said.layers).all(|(layer, before)| layer.shading == before.shading);
        if !is_lit_alike {
            document["shading"] = json!("look");
        }
        for (layer, before) in scene.layers.iter().zip(&said.layers) {
            if layer.color.is_some() {
                return has("a field that colours a layer");
            }
            if layer.transfer_function != before.transfer_function || !is_lit_alike {
                let (place, mut look) = (&mut document["layers"][before.number], look_of(layer));
                let fields = self.settled["layers"][before.number]["look"].as_object();
                let is_kept = |name: &String| !["transfer_function", "shading"].contains(&name.as_str());
                for (name, value) in fields.into_iter().flatten().filter(|(name, _)| is_kept(name)) {
                    look[name] = value.clone();
                }
                place["look"] = look;
                // The opacity of the layer is in its transfer function.
                place["opacity"] = json!(1.0);
            }
        }
        if (scene.crop, &scene.clip_planes) != (said.crop, &said.clip_planes) {
            document["clip"] = clips_of(scene);
        }
        if scene.background != said.background {
            document["background"] = json!(scene.background.map(|color| color.map(exact)));
        }
        if self.camera != said.camera {
            document["camera"] = self.camera.as_ref().map_or(Value::Null, camera_fields);
        }
        if self.size_px != said.size_px {
            document["render"]["size"] = json!(self.size_px);
        }
        let (options, before) = (&self.options, &said.options);
        if options.kernel != before.kernel {
            document["render"]["kernel"] =
                json!(Kernel::NAMES.iter().find(|(_, kernel)| *kernel == options.kernel).map(|(name, _)| name));
        }
        if options.composite != before.composite {
            document["render"]["composite"] = composite_fields(options.composite)?;
        }
        if options.effort != before.effort {
            document["render"]["quality"] = match options.effort {
                Effort::Named(quality) => json!(quality.name()),
                Effort::Fixed(sampling) => {
                    json!({"sheets_per_slice": sampling.sheets_per_slice, "oversampling": sampling.oversampling})
                }
                Effort::Psnr(_) => return has("a wanted PSNR"),
            };
        }
        if options.with_depth != before.with_depth {
            document["render"]["depth"] = json!(options.with_depth);
        }
        Ok(document)
    }
}

/// Whether a look is the one that suits the data.
fn is_automatic(look: &Value) -> bool {
    look.is_null() || look.as_str().is_some_and(|name| name.eq_ignore_ascii_case("auto"))
}

/// The automatic look of the only layer, written out.
fn automatic(samples: &Volume<'_>, facts: &Facts, composite: &Value, place: &str) -> DocumentResult<Value> {
    let look = Look::auto(samples, facts).map_err(|error| made(place, error))?;
    let is_of_view = [Composite::Minimum, Composite::Mean, Composite::Sum].contains(&look.composite);
    let fields = fields_of_look(&look).ok().filter(|_| !is_of_view);
    let Some(fields) = fields.filter(|_| kind_of(samples, facts).kind != DataKind::Labels) else {
        return Err(not_drawn(place, "the automatic look of such data"));
    };
    if !composite.is_null() && composite.as_str().and_then(operator) != Some(look.composite) {
        return Err(not_drawn(place, "the automatic look for another operator than its own"));
    }
    Ok(fields)
}

/// The layers that are visible, with their numbers.
fn shown_layers(document: &Value) -> Vec<(usize, &Value)> {
    let is_shown = |layer: &Value| layer["visible"] != json!(false) && layer["opacity"].as_f64() != Some(0.0);
    document["layers"].as_array().into_iter().flatten().enumerate().filter(|(_, layer)| is_shown(layer)).collect()
}

/// Whether a volume may be a CT of a patient, who may lie on a table.
fn may_have_table(volume: &Volume<'_>, facts: &Facts) -> bool {
    facts.is_anatomical
        && facts.unit.as_deref() == Some("mm")
        && facts.modality.as_deref().map_or_else(|| kind_of(volume, facts).kind == DataKind::Ct, |name| name == "CT")
}

/// The picture that a document describes, but for the samples.
struct SaidScene {
    layers: Vec<SaidLayer>,
    crop: Option<Crop>,
    clip_planes: Vec<ClipPlane>,
    background: Option<[f32; 4]>,
    keeps_table: bool,
    camera: Option<Camera>,
    size_px: Option<[usize; 2]>,
    options: FrameOptions,
}

/// A visible layer, by its number in the document.
struct SaidLayer {
    number: usize,
    transfer_function: TransferFunction,
    shading: Option<Shading>,
    composite: String,
    background: Option<[f32; 4]>,
    /// Whether its look is an automatic one that leaves the background open: projections of such follow the background.
    is_auto: bool,
}

impl SaidScene {
    fn of(document: &Value) -> DocumentResult<Self> {
        check_document(&document, "scene")?;
        for (field, what) in [("geometry", "shapes"), ("figure", "marks on the picture")] {
            if !is_empty(&document[field]) {
                return Err(not_drawn(field, what));
            }
        }
        let layers = shown_layers(document)
            .into_iter()
            .map(|(number, layer)| SaidLayer::of(layer, number, document.get("shading")));
        let layers = layers.collect::<DocumentResult<Vec<SaidLayer>>>()?;
        let Some(first) = layers.first() else { return Err(not_drawn("layers", "no layer that is visible")) };
        let (crop, clip_planes) = clips(&document["clip"])?;
        if layers.len() > 1 && matches!(crop, Some(Crop::Index { .. })) {
            return Err(not_drawn("clip", "a box in samples of one of several layers"));
        }
        let background = match &document["background"] {
            Value::Null => first.background,
            color => color_of(color, "background")?,
        };
        let camera = match &document["camera"] {
            Value::Null => None,
            camera => Some(camera_of(camera)?),
        };
        let render = &document["render"];
        let size_px = render["size"].as_array().map(|size| {
            [0, 1].map(|side| size[side].as_u64().and_then(|side| usize::try_from(side).ok()).unwrap_or_default())
        });
        let options = options_of(render, &layers)?;
        if layers.len() == 1 && first.is_auto && options.composite.is_projection() && background.is_some() {
            return Err(not_drawn(
                format!("layers[{}].look.name", first.number),
                "\"auto\" of a projection on a background",
            ));
        }
        if !document["labels"].is_null() && (first.number > 0 || options.composite != Composite::Over) {
            return Err(not_drawn("labels", "labels of a hidden layer, or with another operator than over"));
        }
        let keeps_table = document["keep_table"] == json!(true);
        Ok(Self { layers, crop, clip_planes, background, keeps_table, camera, size_px, options })
    }
}

fn is_empty(value: &Value) -> bool {
    value.is_null()
        || value.as_array().is_some_and(Vec::is_empty)
        || value.as_object().is_some_and(serde_json::Map::is_empty)
}

impl SaidLayer {
    /// `layer`: with its look written out. `light`: of the scene, which comes before that of the look.
    fn of(layer: &Value, number: usize, light: Option<&Value>) -> DocumentResult<Self> {
        let place = format!("layers[{number}]");
        let not_drawn = |field: &str, what: &str| Err(not_drawn(format!("{place}.{field}"), what));
        if !layer["color_from"].is_null() {
            return not_drawn("color_from", "a field that colours a layer");
        }
        if layer["time"].as_i64().unwrap_or(0) != 0 {
            return not_drawn("time", "another time than the first");
        }
        let look = &layer["look"];
        if !look["map"].is_null() {
            return not_drawn("look", "a colour map over a window");
        }
        if !is_empty(&look["part"]) {
            return not_drawn("look.part", "a part of the volume");
        }
        let mut transfer_function = curves(&look["transfer_function"], &format!("{place}.look"))?;
        // A look that says nothing of light has the usual one.
        let own = match look.get("shading") {
            Some(light) => shading(light, &format!("{place}.look"))?,
            None => Some(Shading::default()),
        };
        let background = color_of(&look["background"], &format!("{place}.look.background"))?;
        let composite = look["composite"].as_str().unwrap_or("over").to_owned();
        let opacity = layer["opacity"].as_f64().unwrap_or(1.0);
        if opacity != 1.0 {
            if composite != "over" || transfer_function.function_2d().is_some() {
                return not_drawn("opacity", "opacity of a projection, or of a table");
            }
            transfer_function = faded(&transfer_function, opacity).map_err(|error| made(&place, error))?;
        }
        let shading = match light {
            None => own,
            Some(name) if name.is_string() => own,
            Some(light) => shading(light, "shading")?,
        };
        let is_auto = look["name"] == "auto" && background.is_none();
        Ok(Self { number, transfer_function, shading, composite, background, is_auto })
    }
}

fn options_of(render: &Value, layers: &[SaidLayer]) -> DocumentResult<FrameOptions> {
    let not_drawn = |field: &str, what: &str| Err(not_drawn(format!("render.{field}"), what));
    for (field, what) in [("psnr", "a wanted PSNR"), ("stereo", "two eyes")] {
        if !render[field].is_null() {
            return not_drawn(field, what);
        }
    }
    if render["panorama"] == json!(true) {
        return not_drawn("panorama", "a panorama");
    }
    let first = &layers[0];
    if layers.iter().any(|layer| layer.composite != first.composite) && render["composite"].is_null() {
        return not_drawn("composite", "looks of several operators, of which it says none");
    }
    let composite = match &render["composite"] {
        Value::Null => operator(&first.composite),
        Value::String(name) => operator(name),
        given => given["first-hit"]["iso_value"].as_f64().map(|iso_value| Composite::FirstHit { iso_value }),
    };
    let Some(composite) = composite else {
        let given = if render["composite"].is_null() { json!(first.composite) } else { render["composite"].clone() };
        return not_drawn("composite", &format!("the operator {given}"));
    };
    if layers.len() > 1 && composite != Composite::Over {
        return not_drawn("composite", "a projection of several layers");
    }
    let effort = match &render["quality"] {
        Value::Object(numbers) => {
            let number = |name: &str| numbers.get(name).and_then(Value::as_f64);
            let name = numbers.get("quality").and_then(Value::as_str);
            match (number("sheets_per_slice"), number("oversampling")) {
                (Some(sheets_per_slice), Some(oversampling)) => {
                    Effort::Fixed(Sampling { sheets_per_slice, oversampling })
                }
                (None, None) => Effort::Named(quality(name)),
                _ => return not_drawn("quality", "one of both numbers alone"),
            }
        }
        given => Effort::Named(quality(given.as_str())),
    };
    let kernel = Kernel::from_name(render["kernel"].as_str().unwrap_or("linear"));
    Ok(FrameOptions {
        kernel: kernel.map_err(|error| made("render.kernel", error))?,
        composite,
        effort,
        with_depth: render["depth"] == json!(true),
        ..FrameOptions::default()
    })
}
