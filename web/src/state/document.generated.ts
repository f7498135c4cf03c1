// Written by `make schema` from the tables of crates/document: types of the viewer's state, and its check.

import * as check from "./checks.ts";

export type Vec3 = readonly [number, number, number];
export const COMPOSITES = ["over", "maximum", "depth-shaded-maximum", "depth-colored-maximum", "attenuated-maximum", "local-maximum", "minimum", "mean", "sum", "x-ray", "first-hit"] as const;
export const QUALITIES = ["draft", "normal", "fine", "high"] as const;
export const KERNELS = ["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"] as const;
export const PANES = ["z", "y", "x"] as const;
export const SLICE_COLORS = ["gray", "gray_r", "hot", "viridis", "coolwarm"] as const;
export const OVERLAYS = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"] as const;
export const TURNINGS = ["turntable", "trackball"] as const;
/** Largest number of corners of a region. */
export const MAX_REGION_POINTS = 200;

export interface Box {
  readonly lower: Vec3;
  readonly upper: Vec3;
  readonly space?: "world" | "index";
}

export interface Plane {
  readonly point: Vec3;
  readonly normal: Vec3;
}

/** A camera, world units: with `parallel_scale` (half the picture's height) or, in perspective, `view_angle` in degrees. */
export interface Camera {
  readonly version: 1;
  readonly position: Vec3;
  readonly focal_point: Vec3;
  readonly view_up: Vec3;
  readonly parallel_scale?: number;
  readonly view_angle?: number;
}

export interface TransferFunction {
  readonly opacity: readonly (readonly [number, number])[];
  readonly color: readonly (readonly [number, number, number, number])[];
  readonly opacity_unit: number | null;
  readonly opacity_unit_share?: number | null;
  readonly gradient_opacity?: readonly (readonly [number, number])[];
  readonly values?: "samples" | "hounsfield" | "fraction" | "object" | "signed" | "maximum" | "log";
  readonly name?: unknown;
  readonly description?: unknown;
  readonly version?: 1;
}

/** A function of value and gradient magnitude, or of a second field: a table. */
export interface TransferFunction2D {
  readonly rgba: unknown;
  readonly values: unknown;
  readonly magnitudes: unknown;
  readonly rows?: "gradient" | "field";
  readonly opacity_unit?: number | null;
  readonly name?: unknown;
  readonly description?: unknown;
  readonly version?: 1;
}

export interface Light {
  readonly direction: Vec3;
  readonly color?: readonly number[];
  readonly frame?: "camera" | "world";
}

/** Phong coefficients, lights, occlusion and shadows. */
export interface Shading {
  readonly ambient: number;
  readonly diffuse: number;
  readonly specular: number;
  readonly specular_power: number;
  readonly gradient_smoothing: number;
  readonly gradient_offset: number;
  readonly unoriented: number;
  readonly even_cuts: number;
  readonly shoulder: number;
  readonly exposure: number;
  readonly lights: readonly Light[];
  readonly ambient_occlusion: number;
  readonly occlusion_radius: number | null;
  readonly shadow: number;
}

/** The look of a layer. States have every look in full. */
export interface Look {
  readonly transfer_function: TransferFunction | TransferFunction2D;
  readonly name: string;
  readonly description: string;
  readonly kind?: string | null;
  readonly shading: null | Shading;
  readonly composite: string;
  readonly view: string | null;
  readonly background: string | null;
  readonly part?: string | null;
  readonly version?: 1;
}

/** A volume by the number under which it is open; the page can neither name files nor change this. */
export interface OpenVolume {
  readonly path: null;
  readonly name: string;
  readonly id?: number;
}

export interface Layer {
  readonly volume: OpenVolume;
  readonly name: string;
  readonly look: Look;
  readonly visible: boolean;
  readonly opacity: number;
  readonly time: number;
}

export interface LabelLook {
  readonly color: string | Vec3;
  readonly opacity?: number;
  readonly name?: string;
  readonly scan?: number;
  readonly tint?: number;
}

export interface Labels {
  readonly volume: OpenVolume;
  readonly labels: Readonly<Record<string, LabelLook>>;
  readonly smooth: boolean;
}

/** A shape in space, with the number of its triangles, paths or points. */
export interface Shape {
  readonly kind: string;
  readonly name: string;
  readonly count: number;
  /** The only field that the page can change. */
  readonly visible: boolean;
  /** Number under which it is open. */
  readonly id?: number;
}

export interface Sampling {
  readonly sheets_per_slice?: number | null;
  readonly oversampling?: number | null;
  readonly quality?: (typeof QUALITIES)[number];
}

/** Settings of the picture at rest; its size is the view's. */
export interface Render {
  readonly size?: unknown;
  readonly quality: (typeof QUALITIES)[number] | Sampling;
  readonly kernel: (typeof KERNELS)[number];
  readonly composite: string | Readonly<Record<string, Readonly<Record<string, number | null>>>>;
}

export interface Layout {
  readonly name: "3d" | "one-and-three" | "two-by-two" | "single";
  readonly main: "3d" | "z" | "y" | "x";
}

export interface Normals {
  readonly z?: Vec3;
  readonly y?: Vec3;
  readonly x?: Vec3;
}

export interface Slices {
  /** World position where the three planes meet. */
  readonly crosshair: Vec3;
  readonly slab: "maximum" | "minimum" | "mean";
  /** Thickness of the slab, world units; 0 is a plane. */
  readonly thickness: number;
  readonly zoom: number;
  /** World position in the middle of all panes; absent: the middle of the first volume's box. */
  readonly center?: Vec3;
  /** Colour map of the first layer; absent: grey, of PET inverted. */
  readonly colors?: (typeof SLICE_COLORS)[number];
  /** [level, width]; absent: the default of the kind of data. */
  readonly window?: readonly [number, number];
  /** Unit normals of planes that were tilted; the others are at right angles to the world's axes. */
  readonly normals?: Normals;
}

/** A measure by world points: two for a distance; three for an angle, whose vertex is the second; corners of a region. */
export interface Measure {
  readonly kind: "distance" | "angle" | "area";
  readonly points: readonly Vec3[];
}

export interface ViewQuality {
  /** While moving: "smooth" holds the frame rate, "balanced" a better picture, "exact" never draws less than at rest. */
  readonly moving: "smooth" | "balanced" | "exact";
}

export interface Interface {
  readonly theme: "system" | "dark" | "light";
  /** Turning by a drag: about an upright axis, or freely. */
  readonly turning: "turntable" | "trackball";
  readonly panels: readonly string[];
}

/** Parts that the viewer alone has: layout, slices, measures, overlays. */
export interface View {
  readonly layout: Layout;
  readonly overlays: Readonly<Record<(typeof OVERLAYS)[number], boolean>>;
  readonly quality: ViewQuality;
  readonly interface: Interface;
  readonly slices: Slices;
  readonly measures: readonly Measure[];
}

/** The state of the viewer: a scene whose volumes and shapes are open, with the field `view`. */
export interface ViewerState {
  readonly wavesplat: "scene";
  readonly version: 1;
  readonly layers: readonly Layer[];
  readonly labels: null | Labels;
  readonly shading: "look" | null | Shading;
  readonly clip: readonly ({ readonly keep: Box } | { readonly plane: Plane } | { readonly cut_out: Box })[];
  readonly background: null | string | readonly number[];
  readonly geometry: readonly Shape[];
  readonly camera: Camera;
  readonly render: Render;
  readonly view: View;
}

// Checks, each after those that it is made of.

const isBox = check.fields({
  lower: check.point,
  upper: check.point,
  "space?": check.oneOf("world", "index"),
});
const isPlane = check.fields({
  point: check.point,
  normal: check.direction,
});
const isCamera = check.oneGiven(["parallel_scale", "view_angle"], check.fields({
  version: check.oneOf(1),
  position: check.point,
  focal_point: check.point,
  view_up: check.point,
  "parallel_scale?": check.anyOf(check.oneOf(null), check.number(Number.MIN_VALUE)),
  "view_angle?": check.anyOf(check.oneOf(null), check.number(Number.MIN_VALUE, 179.99999999999997)),
}));
const isTransferFunction = check.fields({
  opacity: check.list(check.tuple(check.number(), check.share), 1),
  color: check.list(check.tuple(check.number(), check.share, check.share, check.share), 1),
  "opacity_unit?": check.anyOf(check.number(Number.MIN_VALUE), check.oneOf(null)),
  "opacity_unit_share?": check.anyOf(check.number(Number.MIN_VALUE), check.oneOf(null)),
  "gradient_opacity?": check.list(check.tuple(check.number(0), check.share)),
  "values?": check.oneOf("samples", "hounsfield", "fraction", "object", "signed", "maximum", "log"),
  "name?": check.any,
  "description?": check.any,
  "version?": check.oneOf(1),
});
const isTransferFunction2D = check.fields({
  rgba: check.any,
  values: check.any,
  magnitudes: check.any,
  "rows?": check.oneOf("gradient", "field"),
  "opacity_unit?": check.anyOf(check.number(Number.MIN_VALUE), check.oneOf(null)),
  "name?": check.any,
  "description?": check.any,
  "version?": check.oneOf(1),
});
const isLight = check.fields({
  direction: check.direction,
  "color?": check.list(check.number(0), 3, 3),
  "frame?": check.oneOf("camera", "world"),
});
const isShading = check.fields({
  "ambient?": check.number(0),
  "diffuse?": check.number(0),
  "specular?": check.number(0),
  "specular_power?": check.number(1, 1000),
  "gradient_smoothing?": check.number(0, 1.25),
  "gradient_offset?": check.number(0.01, 4),
  "unoriented?": check.share,
  "even_cuts?": check.share,
  "shoulder?": check.share,
  "exposure?": check.number(0),
  "lights?": check.list(isLight),
  "ambient_occlusion?": check.share,
  "occlusion_radius?": check.anyOf(check.number(Number.MIN_VALUE), check.oneOf(null)),
  "shadow?": check.share,
});
const isLook = check.fields({
  transfer_function: check.by("rgba", isTransferFunction2D, isTransferFunction),
  "name?": check.anyOf(check.oneOf(null), check.text),
  "description?": check.anyOf(check.oneOf(null), check.text),
  "kind?": check.anyOf(check.text, check.oneOf(null)),
  "shading?": check.anyOf(check.oneOf(null), isShading),
  "composite?": check.anyOf(check.oneOf(null), check.oneOf(...COMPOSITES)),
  "view?": check.anyOf(check.text, check.oneOf(null)),
  "background?": check.anyOf(check.text, check.oneOf(null)),
  "part?": check.anyOf(check.text, check.oneOf(null)),
  "version?": check.oneOf(1),
});
const isOpenVolume = check.fields({
  path: check.oneOf(null),
  "name?": check.text,
  "id?": check.integer(1),
});
const isLayer = check.fields({
  volume: isOpenVolume,
  "name?": check.text,
  look: isLook,
  "visible?": check.flag,
  "opacity?": check.anyOf(check.oneOf(null), check.share),
  "time?": check.integer(),
});
const isLabelLook = check.fields({
  color: check.anyOf(check.text, check.point),
  "opacity?": check.share,
  "name?": check.text,
  "scan?": check.share,
  "tint?": check.share,
});
const isLabels = check.fields({
  volume: isOpenVolume,
  "labels?": check.anyOf(check.oneOf(null), check.byNumber(isLabelLook)),
  "smooth?": check.flag,
});
const isShape = check.fields({
  kind: check.text,
  name: check.text,
  count: check.number(),
  visible: check.flag,
  "id?": check.integer(1),
});
const isSampling = check.fields({
  "sheets_per_slice?": check.anyOf(check.number(), check.oneOf(null)),
  "oversampling?": check.anyOf(check.number(), check.oneOf(null)),
  "quality?": check.oneOf(...QUALITIES),
});
const isRender = check.fields({
  "size?": check.any,
  quality: check.anyOf(check.oneOf(...QUALITIES), isSampling),
  "kernel?": check.oneOf(...KERNELS),
  "composite?": check.anyOf(check.oneOf(null), check.anyOf(check.oneOf(...COMPOSITES.slice(0, 10)), check.oneField({ "first-hit": check.fields({ iso_value: check.number() }), "local-maximum": check.fields({ "threshold?": check.anyOf(check.number(), check.oneOf(null)) }), "depth-shaded-maximum": check.fields({ "strength?": check.share }), "depth-colored-maximum": check.fields({ "cmap?": check.text, "axis?": check.anyOf(check.oneOf("x", "y", "z"), check.oneOf(null)) }), "attenuated-maximum": check.fields({ "attenuation?": check.number(0) }), "x-ray": check.fields({ "clear?": check.anyOf(check.number(), check.oneOf(null)), "attenuation?": check.anyOf(check.number(Number.MIN_VALUE), check.oneOf(null)) }) }))),
});
const isLayout = check.fields({
  "name?": check.oneOf("3d", "one-and-three", "two-by-two", "single"),
  "main?": check.oneOf("3d", "z", "y", "x"),
});
const isNormals = check.fields({
  "z?": check.direction,
  "y?": check.direction,
  "x?": check.direction,
});
const isSlices = check.fields({
  "crosshair?": check.point,
  "slab?": check.oneOf("maximum", "minimum", "mean"),
  "thickness?": check.number(0),
  "zoom?": check.number(0.01, 1000),
  "center?": check.point,
  "colors?": check.oneOf(...SLICE_COLORS),
  "window?": check.tuple(check.number(), check.number(Number.MIN_VALUE)),
  "normals?": isNormals,
});
const isMeasure = check.fields({
  kind: check.oneOf("distance", "angle", "area"),
  points: check.list(check.point, 2, 200),
});
const isViewQuality = check.fields({
  "moving?": check.oneOf("smooth", "balanced", "exact"),
});
const isInterface = check.fields({
  "theme?": check.oneOf("system", "dark", "light"),
  "turning?": check.oneOf("turntable", "trackball"),
  "panels?": check.list(check.text, 0, 100),
});
const isView = check.fields({
  "layout?": isLayout,
  "overlays?": check.byName(OVERLAYS, check.flag),
  "quality?": isViewQuality,
  "interface?": isInterface,
  "slices?": isSlices,
  "measures?": check.list(check.measure(isMeasure), 0, 1000),
});
export const isViewerState = check.fields({
  wavesplat: check.oneOf("scene"),
  version: check.oneOf(1),
  layers: check.list(isLayer, 1, 8),
  labels: check.anyOf(check.oneOf(null), isLabels),
  shading: check.anyOf(check.oneOf("look"), check.oneOf(null), isShading),
  clip: check.list(check.oneField({ keep: isBox, plane: isPlane, cut_out: isBox }), 0, 256),
  background: check.anyOf(check.oneOf(null), check.anyOf(check.text, check.list(check.number(), 3, 4))),
  geometry: check.list(isShape),
  camera: isCamera,
  render: isRender,
  view: isView,
});
