// Window and level of a layer's transfer function by dragging in the 3-D view.

import { set } from "../../state/patch.ts";
import type { PartProps } from "../part.ts";
import { isEditable, windowed } from "./curves.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.windowDrag;

/** Applies one step of such a drag, in pixels since the last step. The caller settles the store when the drag ends. */
export function windowDrag({ store, ui, welcome }: PartProps, dx: number, dy: number): void {
  const layer = store.state.layers[ui.layer];
  const range = welcome.volumes[ui.layer]?.robust_range;
  if (layer === undefined || range === undefined || (dx === 0 && dy === 0)) return;
  if (!isEditable(layer.look.transfer_function)) {
    ui.announce(TEXT.table);
    return;
  }
  const { transfer_function } = windowed(layer.look, dx, dy, range);
  store.change([set(transfer_function, "layers", ui.layer, "look", "transfer_function")], "window of the function");
}
