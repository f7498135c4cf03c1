// Descriptions of pictures in words: for screen readers, titles and announcements.

import { axesOf, dot } from "../input/camera.ts";
import type { Composite, Vec3, ViewerState } from "../state/state.ts";

const SIDES: readonly (readonly [string, Vec3])[] = [
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
  const what = shown.map((layer) => `${layer.name} as ${layer.look.name}`).join(", ") || "nothing";
  const { back } = axesOf(state.camera);
  const sides = SIDES.map(([name, way]) => [name, dot(back, way)] as const)
    .filter(([, share]) => share > NAMED)
    .sort((a, b) => b[1] - a[1])
    .map(([name]) => (name === "above" || name === "below" ? name : `the ${name}`));
  const cut = state.clip.length > 0 ? ", cut open" : "";
  return `${what}, seen from ${sides.join(" and ")}${cut}`;
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
