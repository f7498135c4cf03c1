// The values under the pointer: those that are shown, read in the page.

import { WORDS } from "../../words.ts";
import { decimalsOf, placeText } from "../descriptions.ts";
import type { PartProps } from "../part.ts";
import { worldAt, type SliceFrame } from "./geometry.ts";
import type { SlicePainter } from "./slice_painter.ts";

/** Values are shown in steps of about a tenth of this part of the volume's range. */
const PARTS = 64;

/** Shows the values, the label and the place under the pointer. `on`: the newest frame, null outside of the slice. */
export function probe({ ui, welcome, store }: PartProps, painter: SlicePainter, on: SliceFrame | null, place: { x: number; y: number } | null): void {
  const shown = painter.frame;
  const slice = shown?.slice;
  if (on === null || place === null || shown === null || slice === undefined || shown !== ui.frames[shown.view]) {
    ui.tell("");
    return;
  }
  const point = worldAt(on, place.x, place.y);
  // The place in the values, which may be of a picture that was moved since.
  const along = (way: readonly number[]): number =>
    Math.round(point.reduce((sum, value, a) => sum + (value - (slice.origin[a] ?? 0)) * (way[a] ?? 0), 0) / slice.pixel);
  const found = painter.at(along(slice.right), along(slice.down));
  if (found === null) {
    ui.tell("");
    return;
  }
  const values = welcome.volumes.flatMap(({ robust_range: [low, high], value_unit }, n) => {
    const value = found.values.get(n);
    if (value === undefined) return [];
    const text = value === null ? WORDS.slices.outside : `${value.toFixed(decimalsOf((high - low) / PARTS))} ${value_unit}`.trim();
    return [welcome.volumes.length === 1 ? text : WORDS.scene.valueOf(store.state.layers[n]?.name ?? "", text)];
  });
  const told = [...values, ...(found.label === null ? [] : [WORDS.slices.label(found.label)])];
  ui.tell(WORDS.slices.at(told.join(", "), placeText(point, welcome)));
}
