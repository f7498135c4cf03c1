// Numbers of slices, from 1 at the lower end of the axis across a pane. No DOM.

import { add, dot, scaled } from "../../input/camera.ts";
import type { Pane, Vec3 } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { normalOf, sampleStep } from "./geometry.ts";

interface Numbered {
  readonly number: number;
  readonly count: number;
}

/** Positions of the first slice along the normal, the distance between two, and their count; null where planes are tilted. */
function slicesOf({ store, ui, welcome }: PartProps, pane: Pane): { first: number; step: number; count: number; normal: Vec3 } | null {
  const range = ui.frames[pane]?.slice?.range;
  if (range === undefined || store.state.view.slices.normals?.[pane] !== undefined) return null;
  const normal = normalOf(store.state, pane);
  const step = sampleStep(welcome.volumes[0]?.affine ?? [], normal);
  const count = (range[1] - range[0]) / step + 1;
  // Of samples that lie askew to the plane there are no numbers.
  return Math.abs(count - Math.round(count)) < 0.01 && count >= 2 ? { first: range[0], step, count: Math.round(count), normal } : null;
}

/** The number of the slice that a pane shows, and of how many. */
export function numberedSlice(part: PartProps, pane: Pane): Numbered | null {
  const slices = slicesOf(part, pane);
  if (slices === null) return null;
  const along = dot(slices.normal, part.store.state.view.slices.crosshair);
  const number = Math.round((along - slices.first) / slices.step) + 1;
  return { number: Math.min(Math.max(number, 1), slices.count), count: slices.count };
}

/** The crosshair moved to the slice of a number; null where there is none. */
export function sliceAt(part: PartProps, pane: Pane, number: number): Vec3 | null {
  const slices = slicesOf(part, pane);
  if (slices === null || !Number.isInteger(number) || number < 1 || number > slices.count) return null;
  const { crosshair } = part.store.state.view.slices;
  const way = slices.first + (number - 1) * slices.step - dot(slices.normal, crosshair);
  return add(crosshair, scaled(slices.normal, way));
}
