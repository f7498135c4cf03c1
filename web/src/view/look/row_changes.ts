// Changes of a layer's row: what is typed, and the questions to the session, which decides what a field makes of the look.

import type { LayerChange, Problem } from "../../engine/engine.ts";
import { PANEL_WORDS } from "../../panel_words.ts";
import type { PartProps } from "../part.ts";

const TEXT = PANEL_WORDS.layersPanel;

/** A change that waits for its turn, of a gesture or alone; null: the gesture before has ended. */
type Wish = { readonly wanted: LayerChange; readonly gesture: string | undefined } | null;

/** Changes of a row that wait for the session's answer to the one before. */
export interface ChangeQueue {
  waiting: Wish[];
  isBusy: boolean;
}

/** Sets fields of a row, one question after the other; of a gesture the newest wish is the only one that waits. */
export async function changeRow(
  { engine, store, ui }: Pick<PartProps, "engine" | "store" | "ui">, layer: number, queue: ChangeQueue, wanted: LayerChange | null, gesture?: string,
): Promise<void> {
  const last = queue.waiting.at(-1);
  if (gesture !== undefined && last?.gesture === gesture) queue.waiting.pop();
  queue.waiting.push(wanted === null ? null : { wanted, gesture });
  if (queue.isBusy) return;
  queue.isBusy = true;
  // Answers name layers by number: where another volume has the number meanwhile, they are for none.
  const volume = (): unknown => store.state.layers[layer]?.volume.id;
  const asked = volume();
  for (let wish = queue.waiting.shift(); wish !== undefined; wish = queue.waiting.shift()) {
    if (wish === null) {
      store.settle();
      continue;
    }
    if (volume() !== asked) continue;
    try {
      const { operations } = await engine.ask("layer_change", { layer, ...wish.wanted });
      if (operations.length > 0 && volume() === asked) store.change(operations, wish.gesture);
    } catch (problem) {
      ui.problem(problem as Problem);
    }
  }
  queue.isBusy = false;
}

/** The value, or the percentile, that a text of a field is; null of an empty one that may be. */
export function typedValue(typed: string, label: string, isOptional: boolean): number | string | null {
  const text = typed.trim();
  if (text === "" && isOptional) return null;
  if (text !== "" && Number.isFinite(Number(text))) return Number(text);
  if (!isOptional && /^\d+(\.\d+)?\s*%$/.test(text)) return text;
  throw new Error(TEXT.noValue(label, text, isOptional));
}
