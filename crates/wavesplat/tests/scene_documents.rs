//! Documents of scenes that Python wrote: the pictures are Python's, to the byte, and the documents are written again.

use serde_json::{Value, json};
use wavesplat::glam::DAffine3;
use wavesplat::{Composite, DocumentError, Facts, FramedScene, Samples, Scene, Volume};

const SHAPE: [usize; 3] = [12, 10, 8];

/// The samples of `python/tests/shared/rust_scenes.py`.
fn samples<T>(value: impl Fn([i32; 3]) -> T) -> Vec<T> {
    let [nx, ny, nz] = SHAPE.map(|n| i32::try_from(n).unwrap());
    (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z]))).map(value).collect()
}

struct Files {
    a: Vec<u8>,
    b: Vec<i16>,
    /// A segmentation.
    c: Vec<u8>,
}

impl Files {
    fn new() -> Self {
        let a = samples(|[x, y, z]| u8::try_from((7 * x * x + 5 * y * y + 3 * z * z + x * y * z) % 256).unwrap());
        let c = samples(|[x, y, z]| u8::from(x > 3 && y > 2) + u8::from(x > 6 && y > 5 && z > 2));
        Self { a, c, b: samples(|[x, y, z]| i16::try_from(40 * x + 30 * y * z - 600).unwrap()) }
    }

    fn read(&self, document: &Value) -> Result<FramedScene<'_>, DocumentError> {
        self.read_as(document, &Facts::default())
    }

    /// The same of files that state facts.
    fn read_as(&self, document: &Value, facts: &Facts) -> Result<FramedScene<'_>, DocumentError> {
        Scene::from_document(document, |source| {
            let samples = match source["path"].as_str() {
                Some("a.npy") => Samples::U8(&self.a),
                Some("b.npy") => Samples::I16(&self.b),
                Some("c.npy") => Samples::U8(&self.c),
                _ => return Err("no such file".into()),
            };
            Ok((Volume::new("a", samples, SHAPE, DAffine3::IDENTITY)?, facts.clone()))
        })
    }
}

/// Facts of a PET, whose automatic look is the maximum on white.
fn of_pet() -> Facts {
    Facts { is_anatomical: true, unit: Some("mm".to_owned()), modality: Some("PT".to_owned()), ..Facts::default() }
}

fn sum_of(frame: &wavesplat::Frame) -> String {
    let bytes = frame.picture.rgba.iter().flatten().flat_map(|channel| channel.to_le_bytes());
    let sum =
        bytes.fold(0xcbf2_9ce4_8422_2325, |sum: u64, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{sum:016x}")
}

#[test]
fn documents_of_python_are_drawn_and_written_as_there() {
    let files = Files::new();
    for line in include_str!("scenes.jsonl").lines() {
        let case: Value = line.parse().unwrap();
        let framed = files.read(&case["document"]).unwrap_or_else(|error| panic!("{}: {error}", case["name"]));
        assert_eq!(sum_of(&framed.render().unwrap()), case["sum"], "{}", case["name"]);
        assert_eq!(framed.document().unwrap(), case["document"], "{}", case["name"]);
    }
}

fn simple() -> Value {
    json!({
        "wavesplat": "scene", "version": 1,
        "layers": [{"volume": {"path": "a.npy"}, "name": "mine", "look": {"name": "own", "transfer_function": {
            "opacity": [[40, 0], [255, 0.9]], "color": [[40, 1, 0, 0], [255, 1, 1, 1]]}}}],
        "camera": {"version": 1, "position": [30, 70, 20], "focal_point": [5, 4, 3], "view_up": [0, 0, 1],
            "parallel_scale": 9},
        "render": {"size": [16, 12], "quality": "draft"},
    })
}

#[test]
fn what_changed_is_written_and_drawn_again() {
    let files = Files::new();
    let mut framed = files.read(&simple()).unwrap();
    framed.scene.background = Some([0.5, 0.25, 0.125, 1.0]);
    framed.scene.layers[0].shading = None;
    framed.options.kernel = wavesplat::Kernel::Bspline3;
    framed.options.composite = Composite::FirstHit { iso_value: 150.0 };
    framed.size_px = Some([20, 14]);
    let plane = wavesplat::ClipPlane { origin: [5.0, 4.0, 3.0].into(), normal: [0.0, 1.0, 0.0].into() };
    framed.scene.clip_planes.push(plane);
    let document = framed.document().unwrap();
    assert_eq!(document["layers"][0]["name"], "mine");
    assert_eq!(document["layers"][0]["look"]["name"], "own");
    assert_eq!(document["camera"], simple()["camera"]);
    let again = files.read(&document).unwrap();
    assert_eq!(sum_of(&again.render().unwrap()), sum_of(&framed.render().unwrap()));
    assert_eq!(again.document().unwrap(), document);

    // A scene that comes from no document.
    let alone = framed.scene.document(&[json!({"path": "a.npy"})]).unwrap();
    let of_alone = files.read(&alone).unwrap();
    assert_eq!(of_alone.scene.document(&[json!({"path": "a.npy"})]).unwrap(), alone);
    let drawn =
        |scene: &Scene<'_>| sum_of(&scene.render(framed.camera.as_ref().unwrap(), [20, 14], &framed.options).unwrap());
    assert_eq!(drawn(&of_alone.scene), drawn(&framed.scene));
    assert!(framed.scene.document(&[]).is_err());
}

#[test]
fn a_layer_whose_light_changed_is_faded_once() {
    let files = Files::new();
    let mut document = simple();
    document["layers"][0]["opacity"] = json!(0.5);
    let mut framed = files.read(&document).unwrap();
    framed.scene.layers[0].shading = None;
    let written = framed.document().unwrap();
    let again = files.read(&written).unwrap();
    assert_eq!(again.scene.layers[0].transfer_function.opacity_nodes()[1].opacity, 0.45, "{written}");
    assert_eq!(sum_of(&again.render().unwrap()), sum_of(&framed.render().unwrap()));
}

#[test]
fn a_changed_automatic_look_keeps_its_operator_and_background() {
    let files = Files::new();
    for look in [Value::Null, json!("Auto")] {
        let mut document = simple();
        document["layers"][0]["look"] = look;
        let mut framed = files.read_as(&document, &of_pet()).unwrap();
        assert_eq!(framed.document().unwrap(), document, "what was not changed stays");
        assert_eq!(framed.options.composite, Composite::Maximum);
        assert_eq!(framed.scene.background, Some([1.0; 4]));
        framed.scene.layers[0].shading = Some(wavesplat::Shading::default());
        let written = framed.document().unwrap();
        let again = files.read_as(&written, &of_pet()).unwrap();
        assert_eq!(
            (again.options.composite, again.scene.background),
            (Composite::Maximum, Some([1.0; 4])),
            "{written}"
        );
        assert_eq!(sum_of(&again.render().unwrap()), sum_of(&framed.render().unwrap()));
    }
}

#[test]
fn a_changed_look_of_a_name_keeps_the_name() {
    let files = Files::new();
    let mut document = simple();
    document["layers"][0]["look"] = json!("ct-bone");
    let mut framed = files.read(&document).unwrap();
    framed.scene.layers[0].shading = None;
    let written = framed.document().unwrap();
    assert_eq!(written["layers"][0]["look"]["name"], "ct-bone");
    assert_eq!(sum_of(&files.read(&written).unwrap().render().unwrap()), sum_of(&framed.render().unwrap()));
}

#[test]
fn operators_have_synonyms_beside_automatic_looks_too() {
    let files = Files::new();
    let mut document = simple();
    document["layers"][0]["look"] = Value::Null;
    for (name, is_its_own) in [("maximum", true), ("mip", true), ("minip", false)] {
        document["render"]["composite"] = json!(name);
        let read = files.read_as(&document, &of_pet()).map(|framed| framed.options.composite);
        assert_eq!(read.is_ok_and(|operator| operator == Composite::Maximum), is_its_own, "{name}");
    }
}

#[test]
fn what_is_not_drawn_yet_is_said() {
    let files = Files::new();
    let text = |shape| json!([{"frame": shape}]);
    for (path, value, said) in [
        ("/labels", json!({"volume": {"path": "d.npy"}}), "labels.volume: no such file"),
        (
            "/labels",
            json!({"volume": {"path": "c.npy"}, "labels": {"1": {"color": "transparent"}}}),
            "labels[1].color: colour of a label is \"transparent\", which is not a colour; set its opacity to 0",
        ),
        ("/labels", json!({"volume": {"path": "c.npy"}, "labels": {"9": {"color": "red"}}}), "labels: label is 9"),
        ("/geometry", text(json!({"grid": true})), "geometry: shapes"),
        ("/figure", json!({"title": "t"}), "figure: marks"),
        ("/clip", json!([{"cut_out": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}]), "clip[0]: a box that is taken out"),
        (
            "/layers/-",
            json!({"volume": {"path": "b.npy"}}),
            "layers[1].look: the look that suits the data of one of several layers, which this crate cannot draw yet; \
             write a look, or draw it with the Python package",
        ),
        ("/layers/-", json!({"volume": {"path": "b.npy"}, "look": "Auto"}), "layers[1].look: the look that suits the"),
        ("/layers/0/look", json!({"map": "hot"}), "layers[0].look: a colour map"),
        ("/layers/0/look", json!("mr-head"), "layers[0].look: "),
        ("/layers/0/look/part", json!("body"), "layers[0].look.part: a part"),
        ("/layers/0/look/transfer_function/values", json!("fraction"), "transfer_function: values that are relative"),
        ("/layers/0/time", json!(1), "layers[0].time: another time"),
        ("/layers/0/color_from", json!({"volume": {"path": "b.npy"}}), "layers[0].color_from: a field"),
        ("/layers/0/visible", json!(false), "layers: no layer that is visible"),
        ("/layers/0/volume/path", json!("d.npy"), "layers[0].volume: no such file"),
        (
            "/background",
            json!("skyblue"),
            "background: the colour \"skyblue\", which this crate cannot draw yet; write numbers or #rrggbb, or draw it with \
             the Python package",
        ),
        ("/background", json!("#+f+f+f"), "background: the colour \"#+f+f+f\""),
        ("/render/stereo", json!("left"), "render.stereo: two eyes"),
        ("/render/psnr", json!(40), "render.psnr: a wanted PSNR"),
        ("/render/composite", json!({"x-ray": {}}), "render.composite: the operator {\"x-ray\":{}}"),
        ("/render/quality", json!({"oversampling": 2}), "render.quality: one of both"),
        // Faults.
        ("/layers/0/opacity", json!(2), "scene: layers[0]: field 'opacity' is 2; it must be a number, 0 to 1"),
        ("/camera/view_up", json!([1]), "scene: camera: field 'view_up' is a list; it must be three numbers"),
        ("/camera/position", json!([5, 4, 3]), "scene: camera: camera"),
        (
            "/layers/0/look/transfer_function/color",
            json!([[0, 1, 1]]),
            "layers[0].look: transfer function: color node 0",
        ),
        ("/layers/0/look/transfer_function/opacity", json!([[9, 0], [0, 1]]), "layers[0].look.transfer_function: "),
        ("/shading", json!({"glow": 1}), "shading has no 'glow'"),
        ("/view", json!({"layout": {"name": "four"}}), "scene: view.layout.name is \"four\""),
    ] {
        let document = wavesplat::document::patched(&simple(), &json!([{"op": "add", "path": path, "value": value}]));
        let error = files.read(&document.unwrap()).err().unwrap_or_else(|| panic!("{path} is taken")).to_string();
        assert!(error.contains(said), "{path}: {error}");
    }
    let mut automatic = simple();
    automatic["layers"][0]["look"]["name"] = json!("auto");
    automatic["render"]["composite"] = json!("mean");
    assert!(files.read(&automatic).is_ok());
    automatic["background"] = json!("white");
    let error = files.read(&automatic).err().unwrap().to_string();
    assert!(error.starts_with("scene: layers[0].look.name: \"auto\" of a projection on a background"), "{error}");

    let mut scan = simple();
    scan["layers"][0]["volume"]["path"] = json!("b.npy");
    let of_patient =
        Facts { is_anatomical: true, unit: Some("mm".to_owned()), modality: Some("CT".to_owned()), ..Facts::default() };
    let read = |document: &Value| {
        let volume = Volume::new("ct", Samples::I16(&files.b), SHAPE, DAffine3::IDENTITY);
        Scene::from_document(document, |_| Ok((volume.clone()?, of_patient.clone()))).map(|_| ())
    };
    assert!(read(&scan).unwrap_err().to_string().contains("keep_table: false with a CT, in which a table may lie"));
    scan["keep_table"] = json!(true);
    assert!(read(&scan).is_ok());
}
