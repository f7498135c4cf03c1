// The state of the viewer: one JSON document, a scene as `wavesplat.Scene.save` writes it with one field more, `view`.
// `python/wavesplat/_viewer/session/state.py` is the twin of `parse.ts`; both agree on the fixtures in `web/schema`.

export type Vec3 = readonly [number, number, number];
export type Color = string | readonly number[];

/** Point of an opacity curve, [value, opacity 0..1]; values ascend. */
export type OpacityPoint = readonly [number, number];
/** Point of a colour curve, [value, red, green, blue], colours 0..1; values ascend. */
export type ColorPoint = readonly [number, number, number, number];
/** Point of a gradient curve, [gradient magnitude, factor 0..1]. */
type GradientPoint = readonly [number, number];

export interface TransferFunction {
  readonly opacity_unit: number | null;
  readonly opacity: readonly OpacityPoint[];
  readonly color: readonly ColorPoint[];
  readonly gradient_opacity?: readonly GradientPoint[];
}

/** A function of value and gradient magnitude: a table, which the page shows but cannot edit. */
export interface TransferFunction2D {
  readonly rgba: unknown;
  readonly [field: string]: unknown;
}

export interface Light {
  readonly direction: Vec3;
  readonly [field: string]: unknown;
}

/** Phong coefficients, lights, occlusion and shadows; null in place of it where nothing is shaded. */
export interface Shading {
  readonly ambient: number;
  readonly diffuse: number;
  readonly specular: number;
  readonly specular_power: number;
  readonly gradient_smoothing: number;
  readonly gradient_offset: number;
  readonly unoriented: number;
  readonly even_cuts: number;
  readonly shoulder: number | null;
  readonly exposure: number;
  readonly lights: readonly Light[];
  readonly ambient_occlusion: number;
  readonly occlusion_radius: number | null;
  readonly shadow: number;
}

/** The look of a layer. The state has every look in full; the server resolves presets by name. */
export interface Look {
  readonly name: string;
  readonly description: string;
  readonly transfer_function: TransferFunction | TransferFunction2D;
  readonly shading: Shading | null;
  readonly composite: string;
  readonly view: string | null;
  readonly background: string | null;
}

export interface Layer {
  /** The volume of the layer, by the number under which it is open; the page can neither name files nor change this. */
  readonly volume: { readonly path: null; readonly name: string; readonly id?: number };
  readonly name: string;
  readonly look: Look;
  readonly visible: boolean;
  readonly opacity: number;
  readonly time: number;
}

export interface LabelLook {
  readonly color: Color;
  readonly opacity?: number;
  readonly name?: string;
  readonly scan?: number;
  readonly tint?: number;
}

export interface Labels {
  readonly volume: { readonly path: null; readonly name?: string; readonly id?: number };
  readonly labels: Readonly<Record<string, LabelLook>>;
  readonly smooth: boolean;
}

/** A shape in space: surface, lines, points, slice plane or frame, and the number of its triangles, paths or points. */
interface Shape {
  readonly kind: string;
  readonly name: string;
  readonly count: number;
  /** Number under which it is open. */
  readonly id?: number;
  /** The only field that the page can change. */
  readonly visible: boolean;
}

export interface Box {
  readonly lower: Vec3;
  readonly upper: Vec3;
  readonly space?: "world" | "index";
}

export type Clip =
  | { readonly keep: Box }
  | { readonly cut_out: Box }
  | { readonly plane: { readonly point: Vec3; readonly normal: Vec3 } };

/** A camera, world units: with `parallel_scale` (half the picture's height) or, in perspective, `view_angle` in degrees. */
export interface Camera {
  readonly version: 1;
  readonly position: Vec3;
  readonly focal_point: Vec3;
  readonly view_up: Vec3;
  readonly parallel_scale?: number;
  readonly view_angle?: number;
}

export type Composite = string | Readonly<Record<string, Readonly<Record<string, number | null>>>>;

/** The named qualities, cheapest first. */
export const QUALITIES = ["draft", "normal", "fine", "high"] as const;

/** Settings of the picture at rest; its size is the view's. */
interface Render {
  readonly quality: (typeof QUALITIES)[number];
  readonly kernel: string;
  readonly composite: Composite;
}

/** Slices by the world's axis across them. */
export const PANES = ["z", "y", "x"] as const;
export type Pane = (typeof PANES)[number];
export type ViewName = "3d" | Pane;

/** Colour maps of slices. */
export const SLICE_COLORS = ["gray", "gray_r", "hot", "viridis", "coolwarm"] as const;
export type SliceColors = (typeof SLICE_COLORS)[number];

/** The part of the state that scenes do not have: layout, slices, measures, overlays, interface. */
export interface View {
  readonly layout: { readonly name: "3d" | "one-and-three" | "two-by-two" | "single"; readonly main: ViewName };
  readonly slices: {
    /** World position where the three planes meet. */
    readonly crosshair: Vec3;
    /** Unit normals of planes that were tilted; the others are at right angles to the world's axes. */
    readonly normals?: Readonly<Partial<Record<Pane, Vec3>>>;
    /** [level, width]; absent: the default of the kind of data. */
    readonly window?: readonly [number, number];
    /** Colour map of the first layer; absent: grey, of PET inverted. */
    readonly colors?: SliceColors;
    /** Thickness of the slab, world units; 0 is a plane. */
    readonly thickness: number;
    readonly slab: "maximum" | "minimum" | "mean";
    readonly zoom: number;
    /** World position in the middle of all panes; absent: the middle of the first volume's box. */
    readonly center?: Vec3;
  };
  readonly measures: readonly Measure[];
  readonly overlays: Readonly<Record<Overlay, boolean>>;
  /** While moving: "smooth" holds the frame rate, "balanced" a better picture, "exact" never draws less than at rest. */
  readonly quality: { readonly moving: "smooth" | "balanced" | "exact" };
  readonly interface: {
    readonly theme: "system" | "dark" | "light";
    readonly panels: readonly string[];
    /** Turning by a drag: about an upright axis, or freely. */
    readonly turning: (typeof TURNINGS)[number];
  };
}

export const TURNINGS = ["turntable", "trackball"] as const;

export const OVERLAYS = ["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"] as const;
export type Overlay = (typeof OVERLAYS)[number];

/** Largest number of corners of a region. */
export const MAX_REGION_POINTS = 200;

/** A measure by world points: two for a distance; three for an angle, whose vertex is the second; corners of a region. */
export interface Measure {
  readonly kind: "distance" | "angle" | "area";
  readonly points: readonly Vec3[];
}

export interface ViewerState {
  readonly wavesplat: "scene";
  readonly version: 1;
  readonly layers: readonly Layer[];
  readonly labels: Labels | null;
  readonly shading: "look" | null | Shading;
  readonly clip: readonly Clip[];
  readonly background: Color | null;
  readonly geometry: readonly Shape[];
  readonly camera: Camera;
  readonly render: Render;
  readonly view: View;
}
