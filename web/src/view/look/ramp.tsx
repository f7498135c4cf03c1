// The colours of a layer as a chip.

import type { Layer } from "../../state/state.ts";
import { hexOf, isEditable, spanOf } from "./curves.ts";

/** The colours of a layer, from its lowest to its highest value. */
export function Ramp({ layer }: { readonly layer: Layer }) {
  const curves = layer.look.transfer_function;
  if (!isEditable(curves)) return <span class="chip" />;
  const [low, high] = spanOf(curves.color);
  const stops = curves.color.map((point) => `${hexOf(point)} ${(100 * (point[0] - low)) / (high - low || 1)}%`);
  const first = curves.color[0];
  const background = stops.length > 1 ? `linear-gradient(90deg, ${stops.join(", ")})` : first && hexOf(first);
  return <span class="chip look-chip" style={{ background }} />;
}
