// The check that a document is a state of the viewer: the twin of `python/wavesplat/_viewer/session/state.py`, and for
// its field `view` of `crates/document/src/view.rs`. Both are held to the fixtures in `web/schema`. Checks that only the
// renderer can make, such as the order of points, are left to it.

import { any, either, fields, flag, list, number, oneOf, point, refuse, share, text, whole, type Check } from "./checks.ts";
import { COMPOSITES } from "./composites.ts";
import { MAX_REGION_POINTS, OVERLAYS, PANES, QUALITIES, SLICE_COLORS, TURNINGS, type ViewerState } from "./state.ts";

const color: Check = (value, where) => (typeof value === "string" ? undefined : list(share, 3, 4)(value, where));
const box = fields({ lower: point, upper: point, "space?": oneOf("world", "index") });
const nodes = (...columns: readonly Check[]): Check =>
  list((node, where) => {
    list(any, columns.length, columns.length)(node, where);
    columns.forEach((check, n) => check((node as unknown[])[n], where));
  }, 1);
const id: Check = (value, where) => (Number.isInteger(value) && Number(value) > 0 ? undefined : refuse(value, where, "a whole number from 1"));
const volume = fields({ path: oneOf(null), "name?": text, "id?": id });
const shading = fields({ ...Object.fromEntries(["ambient", "diffuse", "specular", "specular_power"].map((name) => [`${name}?`, number(0)])), "*": any });
const curves: Check = (value, where) => {
  // A table of two dimensions is checked where it is drawn.
  if (Object.hasOwn(Object(value), "rgba")) return;
  fields({
    "opacity_unit?": either(null, number(0)),
    opacity: nodes(number(), share),
    color: nodes(number(), share, share, share),
    "gradient_opacity?": nodes(number(0), share),
  })(value, where);
};
const composite: Check = (value, where) => {
  if (value === null || typeof value === "string") oneOf(null, ...COMPOSITES)(value, where);
  else fields(Object.fromEntries(COMPOSITES.map((name) => [`${name}?`, fields({ "*": either(null, any) })])))(value, where);
};
const clip: Check = (value, where) => {
  fields({ "keep?": box, "cut_out?": box, "plane?": fields({ point, normal: point }) })(value, where);
  if (Object.keys(value as object).length !== 1) refuse(value, where, "an object of one field: keep, plane or cut_out");
};
const state = fields({
  wavesplat: oneOf("scene"),
  version: oneOf(1),
  layers: list(
    fields({
      volume,
      "name?": text,
      look: fields({ transfer_function: curves, "shading?": either(null, shading), "*": either(null, text) }),
      "visible?": flag,
      "opacity?": share,
      "time?": whole,
    }),
    1,
    8,
  ),
  labels: either(null, fields({ volume, "labels?": fields({ "*": fields({ color, "name?": text, "*": share }) }), "smooth?": flag })),
  shading: either("look", either(null, shading)),
  clip: list(clip),
  background: either(null, color),
  geometry: list(fields({ kind: text, name: text, count: number(), visible: flag, "id?": id })),
  camera: fields({
    version: oneOf(1),
    position: point,
    focal_point: point,
    view_up: point,
    "parallel_scale?": number(Number.MIN_VALUE),
    "view_angle?": number(Number.MIN_VALUE, 180),
  }),
  render: fields({
    "size?": list(number(1), 2, 2),
    quality: (value, where) =>
      typeof value === "string" ? oneOf(...QUALITIES)(value, where) : fields({ "*": either(null, any) })(value, where),
    "kernel?": text,
    "composite?": composite,
  }),
  view: fields({
    "layout?": fields({ "name?": oneOf("3d", "one-and-three", "two-by-two", "single"), "main?": oneOf("3d", ...PANES) }),
    "slices?": fields({
      "crosshair?": point,
      "window?": (value, where) => {
        list(number(), 2, 2)(value, where);
        number(Number.MIN_VALUE)((value as number[])[1], where);
      },
      "thickness?": number(0),
      "slab?": oneOf("maximum", "minimum", "mean"),
      "zoom?": number(0.01, 1000),
      "center?": point,
      "colors?": oneOf(...SLICE_COLORS),
      "normals?": fields(
        Object.fromEntries(
          PANES.map((pane): [string, Check] => [
            `${pane}?`,
            (value, where) => {
              point(value, where);
              if (!(value as number[]).some((one) => one !== 0)) refuse(value, where, "a direction");
            },
          ]),
        ),
      ),
    }),
    "measures?": list((value, where) => {
      fields({ kind: oneOf("distance", "angle", "area"), points: list(point) })(value, where);
      const { kind: what, points } = value as { kind: string; points: unknown[] };
      list(any, what === "distance" ? 2 : 3, { distance: 2, angle: 3 }[what] ?? MAX_REGION_POINTS)(points, `${where}.points`);
    }, 0, 1000),
    "overlays?": fields(Object.fromEntries(OVERLAYS.map((name) => [`${name}?`, flag]))),
    "quality?": fields({ "moving?": oneOf("smooth", "balanced", "exact") }),
    "interface?": fields({ "theme?": oneOf("system", "dark", "light"), "panels?": list(text, 0, 100), "turning?": oneOf(...TURNINGS) }),
  }),
});

/** Returns a document as a state, or throws an error that names the field. */
export function parseViewerState(document: unknown): ViewerState {
  state(document, "");
  return document as ViewerState;
}
