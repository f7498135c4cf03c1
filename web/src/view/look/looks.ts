// Looks of layers: choosing one, the path of its light in the state, and the look as it was when it was chosen.

import type { Engine, Welcome } from "../../engine/engine.ts";
import { set, type Operation } from "../../state/patch.ts";
import type { Color, Composite, Light, Look, Shading, ViewerState } from "../../state/state.ts";
import { ownPreset } from "./own_presets.ts";

/** Default shading, the same as `wavesplat.Shading()`. */
export const DEFAULT_SHADING: Shading = {
  ambient: 0.22,
  diffuse: 1,
  specular: 0.25,
  specular_power: 16,
  gradient_smoothing: 0.8,
  gradient_offset: 1,
  unoriented: 0.5,
  even_cuts: 1,
  shoulder: 0.75,
  exposure: 1,
  lights: [],
  ambient_occlusion: 0,
  occlusion_radius: null,
  shadow: 0,
};

/** Lights that an empty list of lights stands for: a key light and a fill light. */
export const DEFAULT_LIGHTS: readonly Light[] = [
  { direction: [-0.55, 0.65, 1], color: [1, 1, 1], frame: "camera" },
  { direction: [0, 0, 1], color: [0.3, 0.3, 0.3], frame: "camera" },
];

const DEFAULT_BACKGROUND = "black";

/**
 * Operations that choose a look: they set the look, light and, with a single layer, the operator; the background too if
 * it was the background of the old look. One step of undo. `composite`: the operator with its numbers, which a look
 * does not hold.
 */
export function chosen(state: ViewerState, layer: number, look: Look, composite?: Composite): Operation[] {
  const before = state.layers[layer]?.look;
  const operations: Operation[] = [set(look, "layers", layer, "look")];
  if (state.shading !== "look" && state.layers.length === 1) operations.push(set("look", "shading"));
  // The isosurface needs a value, so its name alone is no operator.
  const named = look.composite === "first-hit" ? "over" : look.composite;
  if (state.layers.length === 1) operations.push(set(composite ?? named, "render", "composite"));
  const [old, now] = [before?.background ?? DEFAULT_BACKGROUND, look.background ?? DEFAULT_BACKGROUND];
  if (layer === 0 && state.background === old && old !== now) operations.push(set(now, "background"));
  return operations;
}

/** The light of a layer, and its path in the state. */
export function shadingOf(state: ViewerState, layer: number): { shading: Shading | null; path: (string | number)[] } {
  if (state.shading !== "look") return { shading: state.shading, path: ["shading"] };
  return { shading: state.layers[layer]?.look.shading ?? null, path: ["layers", layer, "look", "shading"] };
}

/** The preset of this name, the user's own or one that is offered; for other names the look that the layer had at first. */
export async function lookAsChosen(
  engine: Engine,
  welcome: Welcome,
  layer: number,
  name: string,
): Promise<Look | null> {
  const own = ownPreset(name);
  if (own !== undefined) return own.look;
  if (name === "auto" || welcome.presets.some((preset) => preset.name === name)) {
    return (await engine.ask("preset", { layer, name })).look;
  }
  return welcome.state.layers[layer]?.look ?? null;
}

/** The JSON text that `wavesplat.Look.load` reads. */
export function lookText(look: Look): string {
  return `${JSON.stringify({ version: 1, ...look }, null, 2)}\n`;
}

/** A look from the JSON text of `lookText`. The server checks it closely. */
export function lookFromText(text: string): Look {
  const found: unknown = JSON.parse(text);
  if (typeof found !== "object" || found === null || !("transfer_function" in found)) {
    throw new Error("it has no field 'transfer_function'; choose a file that was exported here or by Look.save");
  }
  const { version: _, kind: __, ...look } = found as Record<string, unknown>;
  const empty = {
    name: "",
    description: "",
    shading: DEFAULT_SHADING,
    composite: "over",
    view: null,
    background: null,
  };
  return { ...empty, ...look } as unknown as Look;
}

/** Azimuth and elevation in degrees: 0, 0 is from the viewer, positive is from the right and from above. */
export function anglesOf([x, y, z]: readonly [number, number, number]): [number, number] {
  const degrees = 180 / Math.PI;
  const length = Math.hypot(x, y, z) || 1;
  return [degrees * Math.atan2(x, z), degrees * Math.asin(y / length)];
}

export function directionOf([azimuth, elevation]: readonly [number, number]): [number, number, number] {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  return [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
}

/** #rrggbb of a colour: a name, hexadecimal digits, or three numbers 0..1. `named` knows the names. */
export function hexColor(color: Color | null, named: (name: string) => string): string {
  if (color === null) return "#000000";
  if (typeof color !== "string") {
    const byte = (share: number): string =>
      Math.round(255 * Math.min(1, Math.max(0, share)))
        .toString(16)
        .padStart(2, "0");
    return `#${color.slice(0, 3).map(byte).join("")}`;
  }
  const digits = /^#([0-9a-f]{3,8})$/i.exec(color)?.[1];
  if (digits === undefined) return named(color);
  const six = digits.length < 6 ? digits.slice(0, 3).replace(/./g, "$&$&") : digits.slice(0, 6);
  return `#${six.toLowerCase()}`;
}

/** The browser's colours by name. */
export function namedColor(name: string): string {
  const context = document.createElement("canvas").getContext("2d");
  if (context === null) return "#000000";
  context.fillStyle = "#000000";
  context.fillStyle = name;
  return /^#[0-9a-f]{6}$/.test(context.fillStyle) ? context.fillStyle : "#000000";
}
