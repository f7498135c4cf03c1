// The interface of an engine, which draws the pictures. There is one so far, `remoteEngine`; one in the page may follow.

import type { Operation } from "../state/patch.ts";
import type { Camera, Look, SliceColors, Vec3, View, ViewName, ViewerState } from "../state/state.ts";
import type { SliceValuesHeader } from "./slice_values.ts";
import type { Stop } from "../state/store.ts";

/** The field that gives a layer its colours, which the page shows and does not change. */
export interface ColorFieldInfo {
  readonly name: string;
  /** Unit of its values; "" where unknown. */
  readonly value_unit: string;
  /** Nodes of its colours: value, red, green, blue; colours 0..1. */
  readonly color: readonly (readonly [number, number, number, number])[];
}

/** A value at a picked place; null outside of the samples, and where it is missing. */
export interface PickedValue {
  /** The layer's, or its values'; "" of a layer alone. */
  readonly name: string;
  readonly value: number | null;
  readonly unit: string;
}

export interface VolumeInfo {
  readonly name: string;
  /** Samples along x, y, z. */
  readonly shape: Vec3;
  readonly spacing: Vec3;
  /** Unit of lengths: "mm", "µm", ...; null where the file has no unit. */
  readonly unit: string | null;
  /** Unit of values: "HU", ...; "" where unknown. */
  readonly value_unit: string;
  readonly kind: string;
  /** Type of the samples, as NumPy names it; "wavelets" where there are coefficients in place of samples. */
  readonly dtype: string;
  /** Directions of the axes of the samples, such as "RAS"; null where they are no patient's. */
  readonly orientation: string | null;
  /** Sentences on what was guessed of the data, and what is missing. */
  readonly notes: readonly string[];
  /** Smallest and largest value; `robust_range`: the values that count as smallest and largest. */
  readonly range: readonly [number, number];
  readonly robust_range: readonly [number, number];
  /** World box: lower and upper corner. */
  readonly bounds: readonly [Vec3, Vec3];
  /** Whether the axes have directions of a body, so that letters (R, L, ...) may be shown. */
  readonly is_anatomical: boolean;
  readonly n_times: number;
  /** Texts of the times, such as "30 s"; none where their unit is not known. */
  readonly times?: readonly string[];
  /** 4 x 4, rows: index (x, y, z) to world. */
  readonly affine: readonly (readonly number[])[];
  /** The field that gives the layer its colours; null where these are of its own values. */
  readonly color_field: ColorFieldInfo | null;
}

export interface PresetInfo {
  readonly name: string;
  readonly description: string;
  /** Kind of data, by which `wavesplat presets` groups the presets. */
  readonly kind: string;
  /** The layers whose kind of data it is for. */
  readonly layers: readonly number[];
}

/** Facts of what is open, which change when something else is opened. */
export interface Data {
  readonly volumes: readonly VolumeInfo[];
  /** World box around all layers. */
  readonly bounds: readonly [Vec3, Vec3];
  readonly presets: readonly PresetInfo[];
  readonly composites: readonly string[];
  readonly kernels: readonly string[];
  readonly window_names: Readonly<Record<string, readonly [number, number]>>;
  /** Cameras of "front", "back", "left", "right", "top", "bottom", fitted. */
  readonly standard_views: Readonly<Record<string, Camera>>;
  /** The axis of the world, a unit vector, that is upright in the first picture. */
  readonly upright: Vec3;
  /** Six letters or words at the ends of -x, +x, -y, +y, -z, +z. */
  readonly axis_ends: readonly string[];
  /** Fingerprint of the data, for links. */
  readonly fingerprint: string;
}

export interface Welcome extends Data {
  readonly protocol: 1;
  readonly program: string;
  readonly state: ViewerState;
}

/** Examples and recent files that can be opened; `recent` is null where there is no command that keeps a list. */
export interface Offered {
  readonly examples: readonly { readonly name: string; readonly title: string }[];
  readonly recent: readonly { readonly name: string; readonly folder: string; readonly is_there: boolean }[] | null;
  /** Largest number of bytes that a page can send at once. */
  readonly max_bytes: number;
}

/** The source of what is opened: files that were sent, an example, or a file of the list. */
export type Source =
  | { readonly upload: number }
  | { readonly example: string }
  | { readonly recent: number; readonly name: string };

export interface Found {
  readonly kind: "volume" | "labels" | "shape";
  readonly name: string;
}

/** How something that was opened is shown: instead of what is open, over it, or as the segmentation of its first volume. */
export type How = "replace" | "overlay" | "labels";

/** Position of the pixels of a slice in the world: `origin` is the centre of the first one. */
export interface SliceGeometry {
  readonly origin: Vec3;
  readonly right: Vec3;
  readonly down: Vec3;
  readonly normal: Vec3;
  readonly pixel: number;
  /** Magnification that `pixel` is for. */
  readonly zoom: number;
  readonly position: number;
  /** Range of the crosshair along `normal`, world units from the origin of the world. */
  readonly range: readonly [number, number];
  readonly letters: { readonly left: string; readonly right: string; readonly top: string; readonly bottom: string } | null;
  /** Default [level, width]; null for channels, which have windows of their own. */
  readonly window: readonly [number, number] | null;
  /** Colour map of the first layer; null of channels. */
  readonly colors: SliceColors | null;
}

export interface Frame {
  readonly view: ViewName;
  readonly number: number;
  /** The last change of this page that the picture shows. */
  readonly seq: number;
  readonly width: number;
  readonly height: number;
  /** Of slices at rest: their values, to which the page gives colours. */
  readonly format: "jpeg" | "png" | "values";
  readonly values?: SliceValuesHeader;
  /** Whether it is the picture at rest. */
  readonly at_rest: boolean;
  readonly camera?: Camera;
  readonly slice?: SliceGeometry;
  /** World units per pixel of the picture; in perspective at the focal point. */
  readonly pixel: number;
  readonly settings: Readonly<Record<string, unknown>>;
  /** Expected PSNR against the picture at rest, dB; null where nothing is promised. */
  readonly expected_psnr_db: number | null;
  readonly ms: { readonly wait: number; readonly render: number; readonly encode: number };
  readonly notes: readonly string[];
  readonly bytes: Uint8Array<ArrayBuffer>;
}

export interface Problem {
  readonly code: string;
  readonly message: string;
  readonly field?: string;
  /** Advice on how to mend it. */
  readonly remedy?: string;
}

export type Connection =
  | { readonly kind: "connecting"; readonly text: string; readonly part?: number }
  | { readonly kind: "start"; readonly offered: Offered }
  | { readonly kind: "open" }
  /** Changes stay without an answer: what is shown is old. */
  | { readonly kind: "silent"; readonly problem: Problem }
  | { readonly kind: "lost"; readonly problem: Problem; readonly retries: boolean };

/** Statistics of a label. */
export interface LabelFacts {
  readonly number: number;
  readonly name: string;
  readonly n_voxels: number;
  readonly volume: number;
  readonly mean: number | null;
  readonly sd: number | null;
  readonly min: number | null;
  readonly max: number | null;
}

/** The settings of a layer that its row in the list shows; decided by the session. */
export interface LayerRow {
  /** The look is of a colour map, of a channel's one colour, any other one with a window, or a table, which has none. */
  readonly kind: "map" | "channel" | "look" | "table";
  /** Name of the colour map, or #rrggbb of a channel; "" of other looks. */
  readonly colors: string;
  /** Values of the first and the last colour; on slices of the first layer, of black and white. */
  readonly window: readonly [number, number] | null;
  /** Least value that shows; null: by the look. */
  readonly threshold: number | null;
  readonly gamma: number;
  /** Whether the window is the one that the data suggest. */
  readonly is_automatic: boolean;
}

/** Fields of a row to be set; a window of numbers or percentiles, such as "1%", or null, which leaves an end as it is. */
export interface LayerChange {
  readonly colors?: string;
  readonly window?: readonly [number | string | null, number | string | null];
  readonly threshold?: number | null;
  readonly gamma?: number;
  /** Sets the window and gamma that the data suggest. */
  readonly auto?: true;
}

/** The view, size and quality of a saved picture. */
export interface Saved {
  /** Pixels of the whole picture. */
  readonly width: number;
  readonly height: number;
  /** One view, or all four, two by two. */
  readonly shown: ViewName | "all";
  /** Named quality; absent: as at rest. */
  readonly quality?: string;
  readonly transparent: boolean;
  /** With measures and the overlays that are switched on. */
  readonly annotated: boolean;
  /** Of the picture in space; absent: the state's. */
  readonly camera?: Camera;
}

/** Questions and their answers; files come as bytes. */
export interface Questions {
  /** Facts of what is open now. */
  data: { question: Readonly<Record<string, never>>; answer: Data };
  offered: { question: Readonly<Record<string, never>>; answer: Offered };
  clear_recent: { question: Readonly<Record<string, never>>; answer: Offered };
  /** The first picture of an example; JPEG. */
  example_picture: { question: { name: string }; answer: { bytes: Uint8Array<ArrayBuffer> } };
  upload_begin: { question: { files: number; bytes: number }; answer: { upload: number } };
  /** The payload is the next piece of a file. */
  upload: { question: { upload: number; path: string; offset: number }; answer: { received: number } };
  /** Forgets an upload, or what "open" has read and is not shown. */
  discard: { question: { upload: number } | { opened: number }; answer: Readonly<Record<string, never>> };
  /** Reads something; where the file holds several series or datasets, the answer is a question of its own. */
  open: {
    question: Source & { choice?: { option: string; value: string | number } };
    answer: {
      found?: readonly Found[];
      notes?: readonly string[];
      /** Whether it is shown already, as nothing was open. */
      shown?: boolean;
      opened?: number;
      several?: { option: string; names: readonly (string | number)[]; described: readonly string[] };
    };
  };
  /** The changes that show what was opened; `aspect` of the 3-D view is width over height. */
  show: { question: { opened: number; how: How; aspect?: number }; answer: { operations: readonly Operation[] } };
  histogram: {
    question: { layer: number; bins: number; low: number; high: number };
    answer: { counts: number[]; low: number; high: number };
  };
  /** Statistics of the values of each layer in a plane region with corners in the world; null for a layer without values there. */
  region: {
    question: { points: readonly Vec3[] };
    answer: { layers: ({ mean: number; sd: number; min: number; max: number } | null)[] };
  };
  /** Every label: voxels, volume in cubed world units, and values of the first layer, null where none is finite. */
  label_statistics: {
    question: Readonly<Record<string, never>>;
    answer: { labels: LabelFacts[] };
  };
  /** The world point that is seen at a pixel of the 3-D view (fractions 0..1 from the top left), or null. */
  pick: { question: { x: number; y: number; width: number; height: number }; answer: { point: Vec3 | null; values: readonly PickedValue[]; label: string | null } };
  /** The shape that is seen at a pixel of the 3-D view (fractions as for `pick`), or null; `text` is for people. */
  shape: {
    question: { x: number; y: number; width: number; height: number };
    answer: {
      shape: {
        kind: string;
        name: string;
        /** Number of the point, path or triangle, from 0. */
        part: number | null;
        label: string;
        value: number | null;
        point: Vec3;
        text: string;
      } | null;
    };
  };
  /** The rows of all layers, and the colour maps that are offered. */
  layer_rows: { question: Readonly<Record<string, never>>; answer: { rows: readonly LayerRow[]; maps: readonly string[] } };
  /** The changes of the state that set fields of a row. */
  layer_change: { question: { layer: number } & LayerChange; answer: { operations: readonly Operation[] } };
  preset: { question: { layer: number; name: string }; answer: { look: Look } };
  /** A small picture of a layer with a preset, from the direction of the camera; PNG. */
  preset_picture: { question: { layer: number; name: string; size: number }; answer: { bytes: Uint8Array<ArrayBuffer> } };
  /** A camera with the direction and lens of another one that frames what is seen, in a picture of that shape. */
  framed: { question: { camera: Camera; width: number; height: number }; answer: { camera: Camera } };
  /** The camera of the first picture, in a picture of that shape. */
  first_view: { question: { width: number; height: number }; answer: { camera: Camera } };
  /** A camera, in a picture of that shape, that shows all that another one shows at an aspect (width over height). */
  kept_in_view: {
    question: { camera: Camera; aspect: number; width: number; height: number };
    answer: { camera: Camera };
  };
  /** A picture of what is shown, PNG, and the name of its file. */
  picture: { question: Saved; answer: { bytes: Uint8Array<ArrayBuffer>; notes: string[]; name: string } };
  /**
   * Text and the name of its file: a Python program or a shell command that draws the picture of the same question, a command
   * that makes a movie of a turn, the
   * file for `--state`, the short state for a link, or a page.
   */
  code: { question: Saved & { window?: Pick<View, "layout" | "interface">; as: "python" | "command" | "movie" | "state" | "link" | "html" }; answer: { text: string; name: string } };
  /** A token that lets one page in, for a link; asked of the server, so not in notebooks. */
  token: { question: Readonly<Record<string, never>>; answer: { token: string } };
  /** Takes the text of a state file; the answer is the state, with the volumes that are open. */
  open_state: { question: { text: string }; answer: { state: ViewerState } };
}

export type Question = keyof Questions;

/** The maker of a change: Python, or another window; absent: the session's correction of ours. */
export type Cause = "python" | "other view";

export interface Engine {
  /** Resolves when the volume is open. */
  readonly welcome: Promise<Welcome>;
  /** The newest state: changes made here are in it at once, and taken back where they are refused. After `welcome`. */
  readonly state: ViewerState;
  /** Sends a change; `moving`: more follow at once. Gives its number. */
  patch(operations: readonly Operation[], moving: boolean): number;
  /** Sets the size of a view in device pixels; null: it is not shown. Every change of the state redraws a view. */
  show(view: ViewName, size: { readonly width: number; readonly height: number } | null): void;
  /** Reports that a frame is on the screen, so that the next one may be sent. */
  shown(frame: Frame): void;
  onFrame(listener: (frame: Frame) => void): Stop;
  /** Calls back after changes by others (Python, another window) and after refusals of ours, which have no operations. */
  onState(listener: (operations: readonly Operation[], cause?: Cause) => void): Stop;
  /** Calls back with the share of the picture at rest of a view that is drawn, where that takes long; null: it is done. */
  onRefining(listener: (view: ViewName, part: number | null) => void): Stop;
  onConnection(listener: (connection: Connection) => void): Stop;
  onProblem(listener: (problem: Problem) => void): Stop;
  ask<Q extends Question>(
    name: Q,
    question: Questions[Q]["question"],
    progress?: (part: number) => void,
    signal?: AbortSignal,
    payload?: Uint8Array<ArrayBuffer>,
  ): Promise<Questions[Q]["answer"]>;
  /** Tries to connect again, now. */
  retry(): void;
  close(): void;
}
