// Descriptions of pictures in words: for screen readers, titles and announcements.

import { axesOf, dot } from "../input/camera.ts";
import type { Welcome } from "../engine/engine.ts";
import { WORDS } from "../words.ts";
import type { Composite, Vec3, ViewerState } from "../state/state.ts";

const SIDES: readonly (readonly [keyof typeof WORDS.scene.sides, Vec3])[] = [
  ["front", [0, 1, 0]],
  ["back", [0, -1, 0]],
  ["left", [-1, 0, 0]],
  ["right", [1, 0, 0]],
  ["above", [0, 0, 1]],
  ["below", [0, 0, -1]],
];
/** Least cosine between a side's direction and the eye's for the side to be named. */
const NAMED = 0.35;

export function sceneLabel(state: ViewerState): string {
  const shown = state.layers.filter((layer) => layer.visible);
  const what = shown.map((layer) => WORDS.scene.layer(layer.name, layer.look.name)).join(", ") || WORDS.scene.nothing;
  const { back } = axesOf(state.camera);
  const sides = SIDES.map(([name, way]) => [name, dot(back, way)] as const)
    .filter(([, share]) => share > NAMED)
    .sort((a, b) => b[1] - a[1])
    .map(([name]) => WORDS.scene.sides[name]);
  return WORDS.scene.seenFrom(what, sides, state.clip.length > 0);
}

/** The name of an operator, whatever its numbers. */
export function compositeName(composite: Composite): string {
  return typeof composite === "string" ? composite : (Object.keys(composite)[0] ?? "over");
}

/** A number for people, with at most three significant digits. */
export function shortNumber(value: number, digits = 3): string {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 7) return value.toExponential(digits - 1);
  const places = Math.max(0, digits - 1 - size);
  return String(Number(value.toFixed(Math.min(places, 8))));
}

/** Decimals of a length in data of a spacing: enough for steps of about a tenth of the spacing. */
export function decimalsOf(spacing: number): number {
  return spacing > 0 ? Math.min(9, Math.max(0, Math.floor(1.5 - Math.log10(spacing)))) : 3;
}

/** The name of an axis in a place's text: in a patient the side that a value of its sign lies on, else x, y or z. */
export function axisName(axis: number, value: number, { volumes, axis_ends }: Pick<Welcome, "volumes" | "axis_ends">): string {
  return (volumes[0]?.is_anatomical ? axis_ends[2 * axis + (value < 0 ? 0 : 1)] : "xyz"[axis]) ?? "";
}

/** A world point for people: "R 3.5 A 176.3 S 274.2 mm" in a patient, else "x 3.5 y 176.3 z 274.2 µm". */
export function placeText(point: Vec3, welcome: Pick<Welcome, "volumes" | "axis_ends">): string {
  const volume = welcome.volumes[0];
  const decimals = decimalsOf(Math.min(...(volume?.spacing ?? [1])));
  const parts = point.map((value, axis) => {
    const rounded = value.toFixed(decimals);
    return `${axisName(axis, value, welcome)} ${volume?.is_anatomical ? rounded.replace("-", "") : rounded}`;
  });
  return [...parts, volume?.unit ?? ""].join(" ").trim();
}
