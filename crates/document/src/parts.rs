//! Tables of the parts of documents: scenes, and the viewer's state. The schema and the page's types are written from them.

use Form::{
    Absent, Any, By, Direction, Either, List, Made, Named, Never, Null, OneField, OneOf, Operator, Point, Said,
};
use Form::{Switch, Text, Tuple, Version, Whole};

use crate::form::{DocumentPart, FieldForm, Form, NOT_NEGATIVE, NUMBER, Names, POSITIVE, Range, SHARE, UNBOUND};

const fn must(name: &'static str, form: Form) -> FieldForm {
    FieldForm { name, form, is_needed: true, is_sent: true, about: "" }
}

const fn within(least: f64, most: f64) -> Form {
    Form::Number(Range { least: Some(least), most: Some(most), ..UNBOUND })
}

const fn may(name: &'static str, form: Form) -> FieldForm {
    FieldForm { name, form, is_needed: false, is_sent: false, about: "" }
}

const NO_FIELDS: DocumentPart =
    DocumentPart { name: "", about: "", fields: &[], either: &[], one_of: &[], is_open: false, words: None };

const fn one(name: &'static str, about: &'static str, fields: &'static [FieldForm]) -> DocumentPart {
    DocumentPart { name, about, fields, ..NO_FIELDS }
}

pub(crate) fn part(name: &str) -> &'static DocumentPart {
    PARTS.iter().find(|part| part.name == name).unwrap_or(&NO_FIELDS)
}

/// The kinds of which an object of one field names one.
pub(crate) fn kinds(of: &str) -> &'static [&'static str] {
    KINDS.iter().find(|(name, _)| *name == of).map_or(&[], |(_, kinds)| kinds)
}

/// Most layers of a scene.
const MAX_LAYERS: usize = 8;
/// Most clips of a scene: each is looked at for every sheet.
const MAX_CLIPS: usize = 256;
/// Most pixels along a side of a picture.
const MAX_SIDE_PX: i64 = 16384;
/// Largest numbers of measures and panels of a viewer's state, so that it stays small.
const MAX_MEASURES: usize = 1000;
const MAX_PANELS: usize = 100;
/// Most corners of a region.
pub(crate) const MAX_REGION_POINTS: usize = 200;

pub(crate) const QUALITIES: [&str; 4] = ["draft", "normal", "fine", "high"];
pub(crate) const KERNELS: [&str; 5] = ["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"];
/// Operators along a ray, in the order in which they are offered.
pub(crate) const COMPOSITES: [&str; 11] = [
    "over",
    "maximum",
    "depth-shaded-maximum",
    "depth-colored-maximum",
    "attenuated-maximum",
    "local-maximum",
    "minimum",
    "mean",
    "sum",
    "x-ray",
    "first-hit",
];
/// Operators that a name alone says.
pub(crate) const BY_NAME: &[&str] = COMPOSITES.split_at(COMPOSITES.len() - 1).0;
/// Other names of operators, which documents may have too, and the names.
pub const COMPOSITE_SYNONYMS: [(&str, &str); 3] = [("mip", "maximum"), ("minip", "minimum"), ("average", "mean")];
const EYES: [&str; 5] = ["side-by-side", "top-bottom", "anaglyph", "left", "right"];
pub(crate) const VIEWS: [&str; 4] = ["3d", "z", "y", "x"];
/// Slices by the world's axis across them.
pub(crate) const PANES: [&str; 3] = ["z", "y", "x"];
pub(crate) const MEASURES: [&str; 3] = ["distance", "angle", "area"];
/// Turning by a drag: about an upright axis, or freely.
pub(crate) const TURNINGS: [&str; 2] = ["turntable", "trackball"];
/// Colour maps of slices.
pub(crate) const SLICE_COLORS: [&str; 5] = ["gray", "gray_r", "hot", "viridis", "coolwarm"];
pub(crate) const OVERLAYS: [&str; 7] = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"];

const TEXT_OR_NULL: Form = Either(&[Text, Null]);
const NUMBER_OR_NULL: Form = Either(&[NUMBER, Null]);
const POSITIVE_OR_NULL: Form = Either(&[POSITIVE, Null]);
const COLOR: Form = Either(&[Text, List(&NUMBER, 3, 4)]);
const BACKGROUND: Form = Said(&Either(&[Null, COLOR]), "it must be a colour or null");
const TWO_ENDS: Form = List(&Either(&[NUMBER, Text]), 2, 2);
const ENDS: Form = Form::Def("ends", &TWO_ENDS, "The values of both ends of the colour map.");
const POSITIONS: Form = Form::Def("positions", &List(&Point, 1, usize::MAX), "World positions (x, y, z).");
const COLORS: Form = Form::Def(
    "colors",
    &Either(&[Text, List(&NUMBER, 0, usize::MAX), List(&List(&SHARE, 3, 4), 0, usize::MAX)]),
    "A colour for all, or one for each vertex, position or point.",
);
const VALUES: Form = Form::Def("values", &List(&NUMBER_OR_NULL, 0, usize::MAX), "A value each; null is not drawn.");
const SIZES: Form = Form::Def("sizes", &Either(&[POSITIVE, List(&POSITIVE, 0, usize::MAX)]), "");
const FACE: Form = List(&Whole(0, i64::MAX), 3, 3);
const LOOK: Form = Said(
    &Either(&[Text, Null, By("map", &Form::Part("mapped_look"), &Made("look"))]),
    "it must be an object, a name or null",
);
/// Scales of the values of curves: samples, or places in a volume's own range of values.
pub(crate) const SCALES: [&str; 7] = ["samples", "hounsfield", "fraction", "object", "signed", "maximum", "log"];
const OPACITY_POINT: Form = Form::Def(
    "opacity_point",
    &Tuple(&[NUMBER, SHARE]),
    "Point of an opacity curve, [value, opacity 0..1]; values ascend.",
);
const COLOR_POINT: Form = Form::Def(
    "color_point",
    &Tuple(&[NUMBER, SHARE, SHARE, SHARE]),
    "Point of a colour curve, [value, red, green, blue], colours 0..1; values ascend.",
);
const SHADING: Form = Either(&[OneOf(&["look"]), Null, Made("shading")]);
const COMPOSITE: Form = Either(&[Operator, Null, OneField("operator", "a name, or ")]);
const QUALITY: Form = Either(&[OneOf(&QUALITIES), Form::Part("quality")]);
const LABEL_LOOKS: Form =
    Said(&Absent(&Named(Names::Whole, &Form::Part("label"))), "it must be an object of objects, by number");
const VOLUME: Form = Form::Part("volume");
const STEPS: Form = List(&OneField("step", ""), 0, usize::MAX);
const PATH: Form = Said(&Either(&[Text, Null, List(&Text, 0, usize::MAX)]), "it must be the name of a file");
const FILE: FieldForm = may("file", Form::Part("shape_file"));
const CMAP: FieldForm = may("cmap", TEXT_OR_NULL);
const CLIM: FieldForm = may("clim", ENDS);
const QUANTITY: FieldForm = may("quantity", TEXT_OR_NULL);
const VALUE_UNIT: FieldForm = may("value_unit", TEXT_OR_NULL);
const OPACITY: FieldForm = may("opacity", SHARE);
const LIT: FieldForm = may("lit", Switch);
const CLIPPED: FieldForm = may("clipped", Switch);
const VISIBLE: FieldForm = may("visible", Switch);
const NAME: FieldForm = may("name", TEXT_OR_NULL);
const BOX: [FieldForm; 3] = [must("lower", Point), must("upper", Point), may("space", OneOf(&["world", "index"]))];

/// Kinds of which an object of one field is: the field names one.
const KINDS: [(&str, &[&str]); 4] = [
    ("clip", &["keep", "plane", "cut_out"]),
    ("shape", &["surface", "lines", "points", "slice_plane", "frame"]),
    ("step", &["smoothed", "largest_body", "moved", "wavelets", "level", "bands", "to_volume", "times"]),
    (
        "operator",
        &["first-hit", "local-maximum", "depth-shaded-maximum", "depth-colored-maximum", "attenuated-maximum", "x-ray"],
    ),
];

/// A step of processing a volume; the function that does it knows its arguments.
const fn step(name: &'static str) -> DocumentPart {
    DocumentPart { is_open: true, ..one(name, "", &[]) }
}

#[rustfmt::skip]
pub(crate) static PARTS: &[DocumentPart] = &[
    one("scene", "What is shown, and, in the documents of reports and PNG files, from where and how it was drawn. \
        Relative paths start from the document's folder.", &[
        must("wavesplat", OneOf(&["scene"])),
        must("version", Version),
        must("layers", List(&Form::Part("layer"), 1, MAX_LAYERS)),
        may("labels", Either(&[Null, Form::Part("labels")])),
        may("shading", SHADING),
        may("clip", List(&OneField("clip", ""), 0, MAX_CLIPS)),
        may("background", BACKGROUND).about("A name, #rrggbb, or three or four numbers 0..1; null is that of the first look."),
        may("keep_table", Switch).about("Draw the table below a patient in a CT."),
        may("geometry", List(&OneField("shape", ""), 0, usize::MAX)).about("Shapes in space."),
        may("camera", Absent(&Made("camera"))),
        may("render", Absent(&Form::Part("render"))),
        may("figure", Absent(&Form::Part("figure"))),
        may("view", Absent(&Made("view"))),
    ]),
    DocumentPart {
        is_open: true,
        either: &[&["example"], &["path"]],
        words: Some("it must be an object with the path of a file"),
        ..one("volume", "A file or address and the options of wavesplat.open, or an example with its arguments; then steps.", &[
            may("path", PATH).about("In the folder of the document, or an address of a web server, or a file by its content: \
                \"content:\", its size and a digest. Null: it came from no file. A list: files of one time each."),
            may("series_of_times", Switch).about("Opened by wavesplat.open_series."),
            may("example", OneOf(&["ct_pelvis", "mri_head", "ripples"])),
            may("then", STEPS),
        ])
    },
    one("layer", "", &[
        must("volume", VOLUME),
        NAME,
        may("look", LOOK).about("As Look.to_json writes it, the name of a preset, a colour map over a window, or null: by \
            the kind of data."),
        VISIBLE,
        may("opacity", Absent(&SHARE)),
        may("time", Whole(i64::MIN, i64::MAX)),
        may("color_from", Absent(&Form::Part("color_field"))),
    ]),
    one("color_field", "A field whose values give a layer its colours, by the colours of the look.", &[
        must("volume", VOLUME), NAME, may("look", LOOK),
    ]),
    one("look", "The look of a layer. States have every look in full.", &[
        must("transfer_function", By("rgba", &Form::Part("transfer_function_2d"), &Form::Part("transfer_function"))),
        may("name", Absent(&Text)).sent(), may("description", Absent(&Text)).sent(), may("kind", TEXT_OR_NULL),
        may("shading", Either(&[Null, Made("shading")])).sent(),
        may("composite", Absent(&OneOf(&COMPOSITES))).sent(), may("view", TEXT_OR_NULL).sent(),
        may("background", TEXT_OR_NULL).sent(), may("part", TEXT_OR_NULL), may("version", Version),
    ]),
    one("transfer_function", "", &[
        must("opacity", List(&OPACITY_POINT, 1, usize::MAX)), must("color", List(&COLOR_POINT, 1, usize::MAX)),
        may("opacity_unit", POSITIVE_OR_NULL).sent(), may("opacity_unit_share", POSITIVE_OR_NULL),
        may("gradient_opacity", List(&Tuple(&[NOT_NEGATIVE, SHARE]), 0, usize::MAX)), may("values", OneOf(&SCALES)),
        may("name", Any), may("description", Any), may("version", Version),
    ]),
    one("transfer_function_2d", "A function of value and gradient magnitude, or of a second field: a table.", &[
        must("rgba", Any), must("values", Any), must("magnitudes", Any), may("rows", OneOf(&["gradient", "field"])),
        may("opacity_unit", POSITIVE_OR_NULL), may("name", Any), may("description", Any), may("version", Version),
    ]),
    one("light", "", &[
        must("direction", Direction), may("color", List(&NOT_NEGATIVE, 3, 3)), may("frame", OneOf(&["camera", "world"])),
    ]),
    one("shading", "Phong coefficients, lights, occlusion and shadows.", &[
        may("ambient", NOT_NEGATIVE).sent(), may("diffuse", NOT_NEGATIVE).sent(), may("specular", NOT_NEGATIVE).sent(),
        may("specular_power", within(1.0, 1000.0)).sent(), may("gradient_smoothing", within(0.0, 1.25)).sent(),
        may("gradient_offset", within(0.01, 4.0)).sent(), may("unoriented", SHARE).sent(), may("even_cuts", SHARE).sent(),
        may("shoulder", SHARE).sent(), may("exposure", NOT_NEGATIVE).sent(),
        may("lights", List(&Form::Part("light"), 0, usize::MAX)).sent(), may("ambient_occlusion", SHARE).sent(),
        may("occlusion_radius", POSITIVE_OR_NULL).sent(), may("shadow", SHARE).sent(),
    ]),
    one("state", "The state of the viewer: a scene whose volumes and shapes are open, with the field `view`.", &[
        must("wavesplat", OneOf(&["scene"])),
        must("version", Version),
        must("layers", List(&Form::Part("state_layer"), 1, MAX_LAYERS)),
        must("labels", Either(&[Null, Form::Part("state_labels")])),
        must("shading", SHADING),
        must("clip", List(&OneField("clip", ""), 0, MAX_CLIPS)),
        must("background", BACKGROUND),
        must("geometry", List(&Form::Part("state_shape"), 0, usize::MAX)),
        must("camera", Made("camera")),
        must("render", Form::Part("state_render")),
        must("view", Made("view")),
    ]),
    one("state_volume", "A volume by the number under which it is open; the page can neither name files nor change this.", &[
        must("path", Null), may("name", Text).sent(), may("id", Whole(1, i64::MAX)),
    ]),
    one("state_layer", "", &[
        must("volume", Form::Part("state_volume")), may("name", Text).sent(), must("look", Made("look")), VISIBLE.sent(),
        may("opacity", Absent(&SHARE)).sent(), may("time", Whole(i64::MIN, i64::MAX)).sent(),
    ]),
    one("state_labels", "", &[
        must("volume", Form::Part("state_volume")), may("labels", LABEL_LOOKS).sent(), may("smooth", Switch).sent(),
    ]),
    one("state_shape", "A shape in space, with the number of its triangles, paths or points.", &[
        must("kind", Text), must("name", Text), must("count", NUMBER),
        must("visible", Switch).about("The only field that the page can change."),
        may("id", Whole(1, i64::MAX)).about("Number under which it is open."),
    ]),
    one("state_render", "Settings of the picture at rest; its size is the view's.", &[
        may("size", Any), must("quality", QUALITY), may("kernel", OneOf(&KERNELS)).sent(), may("composite", Absent(&Either(&[OneOf(BY_NAME), OneField("operator", "a name, or ")]))).sent(),
    ]),
    one("mapped_look", "The colours of a map over a window of values, clear up to its low end, as Layer.overlay makes it.", &[
        must("map", Said(&Text, "it must be the name of a colour map")),
        may("window", Said(&TWO_ENDS, "it must be [low, high]")),
    ]),
    one("labels", "", &[
        must("volume", VOLUME),
        may("labels", LABEL_LOOKS).about("Looks by number."),
        may("smooth", Switch),
    ]),
    one("label", "", &[
        must("color", Either(&[Text, Point])), OPACITY, may("name", Text), may("scan", SHARE), may("tint", SHARE),
    ]),
    one("plane", "", &[must("point", Point), must("normal", Direction)]),
    one("keep", "", &BOX),
    one("cut_out", "", &BOX),
    one("shape_file", "A file, and the options of wavesplat.open_geometry. Null: it came from no file.", &[
        must("path", Said(&TEXT_OR_NULL, "it must be the name of a file")),
        may("kind", OneOf(&["surface", "lines", "points"])),
        may("values", Text), may("unit", Text), may("world_unit", Text),
    ]),
    DocumentPart { either: &[&["file"], &["vertices", "faces"]], ..one("surface", "", &[
        FILE, may("vertices", POSITIONS), may("faces", List(&FACE, 1, usize::MAX)), may("color", COLORS),
        may("values", VALUES), CMAP, CLIM, QUANTITY, VALUE_UNIT, OPACITY,
        may("normals", Either(&[OneOf(&["smooth", "flat"]), POSITIONS])), LIT, CLIPPED, VISIBLE, NAME,
    ])},
    DocumentPart { either: &[&["file"], &["paths"]], ..one("lines", "", &[
        FILE, may("paths", List(&POSITIONS, 1, usize::MAX)), may("color", COLORS), may("values", VALUES), CMAP, CLIM,
        QUANTITY, VALUE_UNIT, may("radius", POSITIVE).about("World units."), may("width", POSITIVE).about("Pixels."),
        OPACITY, LIT, CLIPPED, VISIBLE, NAME,
    ])},
    DocumentPart { either: &[&["file"], &["positions"]], ..one("points", "", &[
        FILE, may("positions", POSITIONS), may("color", COLORS), may("values", VALUES), CMAP, CLIM, QUANTITY, VALUE_UNIT,
        may("radius", SIZES), may("size", SIZES), may("labels", List(&Text, 0, usize::MAX)), OPACITY, LIT, CLIPPED, VISIBLE,
        NAME,
    ])},
    one("slice_plane", "", &[
        may("file", Never("a slice_plane comes from no file")),
        may("volume", Either(&[Null, VOLUME])).about("Null, or left out: that of the first layer."),
        may("plane", Either(&[
            OneOf(&["axial", "coronal", "sagittal", "xy", "xz", "yz", "cuts"]), Form::Part("plane"),
        ])),
        may("position", NUMBER), may("index", Whole(i64::MIN, i64::MAX)), may("window", Either(&[Text, ENDS])), CLIM,
        may("cmap", Text), OPACITY, CLIPPED, VISIBLE, NAME,
    ]),
    one("frame", "", &[
        may("file", Never("a frame comes from no file")),
        may("box", List(&Point, 2, 2)), may("ticks", Switch), may("units", Switch), may("grid", Switch),
        may("color", COLORS), may("width", POSITIVE), OPACITY, VISIBLE, NAME,
    ]),
    DocumentPart { one_of: &["parallel_scale", "view_angle"], ..one("camera", "A camera, world units: with `parallel_scale` \
        (half the picture's height) or, in perspective, `view_angle` in degrees.", &[
        must("version", Version), must("position", Point), must("focal_point", Point), must("view_up", Point),
        may("parallel_scale", Absent(&POSITIVE)),
        may("view_angle", Absent(&Form::Number(Range { above: Some(0.0), below: Some(180.0), ..UNBOUND }))),
    ])},
    one("render", "", &[
        may("size", Absent(&Said(&List(&Whole(1, MAX_SIDE_PX), 2, 2), "it must be [width, height], 1 to 16384 pixels each"))),
        may("quality", Absent(&QUALITY)),
        may("psnr", NUMBER_OR_NULL),
        may("kernel", Absent(&OneOf(&KERNELS))),
        may("composite", COMPOSITE),
        may("depth", Absent(&Switch)),
        may("stereo", Either(&[Null, OneOf(&EYES), Form::Part("stereo")])),
        may("panorama", Absent(&Switch)).about("All around the camera: longitudes and latitudes."),
    ]),
    one("quality", "", &[
        may("sheets_per_slice", NUMBER_OR_NULL), may("oversampling", NUMBER_OR_NULL), may("quality", OneOf(&QUALITIES)),
    ]),
    one("stereo", "", &[
        may("layout", OneOf(&EYES)), may("eye_distance", POSITIVE_OR_NULL), may("convergence", POSITIVE_OR_NULL),
    ]),
    one("first-hit", "", &[must("iso_value", NUMBER)]),
    one("local-maximum", "", &[may("threshold", NUMBER_OR_NULL)]),
    one("depth-shaded-maximum", "", &[may("strength", SHARE)]),
    one("depth-colored-maximum", "", &[may("cmap", Text), may("axis", Either(&[OneOf(&["x", "y", "z"]), Null]))]),
    one("attenuated-maximum", "", &[may("attenuation", NOT_NEGATIVE)]),
    one("x-ray", "", &[may("clear", NUMBER_OR_NULL), may("attenuation", POSITIVE_OR_NULL)]),
    one("figure", "What is drawn on the picture: arguments of Picture.annotated.", &[
        may("scale_bar", Either(&[Switch, NUMBER, Text])),
        may("orientation", Either(&[OneOf(&["letters", "cube", "axes"]), Null])),
        may("colorbar", Either(&[Switch, Text, List(&Text, 0, usize::MAX)])),
        may("legend", Either(&[Switch, List(&Text, 0, usize::MAX)])),
        may("title", TEXT_OR_NULL), may("unit", TEXT_OR_NULL), may("values", TEXT_OR_NULL), may("dpi", NUMBER_OR_NULL),
        may("font_size", NUMBER_OR_NULL), may("color", Either(&[TEXT_OR_NULL, List(&NUMBER, 0, usize::MAX)])),
        may("font", TEXT_OR_NULL), may("scale_bar_at", Text), may("orientation_at", Text), may("colorbar_at", Text),
        may("legend_at", Text),
    ]),
    step("smoothed"), step("largest_body"), step("moved"), step("wavelets"), step("level"), step("bands"),
    step("to_volume"), step("times"),
    one("view", "Parts that the viewer alone has: layout, slices, measures, overlays.", &[
        may("layout", Form::Part("view_layout")).sent(),
        may("overlays", Named(Names::OneOf(&OVERLAYS), &Switch)).sent(),
        may("quality", Form::Part("view_quality")).sent(),
        may("interface", Form::Part("interface")).sent(),
        may("slices", Form::Part("slices")).sent(),
        may("measures", List(&Form::Measure, 0, MAX_MEASURES)).sent(),
    ]),
    one("view_layout", "", &[
        may("name", OneOf(&["3d", "one-and-three", "two-by-two", "single"])).sent(),
        may("main", OneOf(&VIEWS)).sent(),
    ]),
    one("view_quality", "", &[may("moving", OneOf(&["smooth", "balanced", "exact"])).sent()
            .about("While moving: \"smooth\" holds the frame rate, \"balanced\" a better picture, \"exact\" never draws less than at rest.")]),
    one("interface", "", &[
        may("theme", OneOf(&["system", "dark", "light"])).sent(),
        may("turning", OneOf(&TURNINGS)).sent().about("Turning by a drag: about an upright axis, or freely."),
        may("panels", List(&Said(&Text, "it must be a name"), 0, MAX_PANELS)).sent(),
    ]),
    one("slices", "", &[
        may("crosshair", Point).sent().about("World position where the three planes meet."),
        may("slab", OneOf(&["maximum", "minimum", "mean"])).sent(),
        may("thickness", Said(&NOT_NEGATIVE, "it must be 0 or a length")).sent()
            .about("Thickness of the slab, world units; 0 is a plane."),
        may("zoom", within(0.01, 1000.0)).sent(),
        may("center", Point)
            .about("World position in the middle of all panes; absent: the middle of the first volume's box."),
        may("colors", OneOf(&SLICE_COLORS)).about("Colour map of the first layer; absent: grey, of PET inverted."),
        may("window", Said(&Tuple(&[NUMBER, POSITIVE]), "it must be [level, width]"))
            .about("[level, width]; absent: the default of the kind of data."),
        may("normals", Form::Part("normals"))
            .about("Unit normals of planes that were tilted; the others are at right angles to the world's axes."),
    ]),
    one("normals", "", &[may("z", Direction), may("y", Direction), may("x", Direction)]),
    one("measure", "A measure by world points: two for a distance; three for an angle, whose vertex is the second; corners of a region.", &[
        must("kind", OneOf(&MEASURES)), must("points", List(&Point, 2, MAX_REGION_POINTS)),
    ]),
];
