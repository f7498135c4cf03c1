// Operations that show one layer alone.

import { set, type Operation } from "../../state/patch.ts";
import type { Layer } from "../../state/state.ts";
import type { Store } from "../../state/store.ts";
import { hiddenOf, labelRows, shownLabels } from "./layers.ts";

/** Whether a layer is the only one that is shown. */
export function isSolo(layers: readonly Layer[], index: number): boolean {
  return layers.every((layer, k) => layer.visible === (k === index));
}

/** Labels that were hidden with the first layer, by the store whose state has them. */
const leftOutOfStores = new WeakMap<object, Set<string>>();

/** Shows one layer alone, or all if it is alone already; labels with the first layer, on which they lie. */
export function soloLayer(store: Pick<Store, "state">, index: number): Operation[] {
  const { layers, labels } = store.state;
  const all = isSolo(layers, index);
  const shown = layers.map((_, k) => set(all || k === index, "layers", k, "visible"));
  if (labels === null) return shown;
  // Labels that were hidden one by one stay hidden.
  const leftOut = leftOutOfStores.get(store) ?? new Set();
  leftOutOfStores.set(store, leftOut);
  const now = labelRows(labels.labels).filter(({ isShown }) => isShown).map(({ number }) => number);
  const wanted = new Set(all || index === 0 ? [...now, ...leftOut] : []);
  for (const number of now) leftOut.add(number);
  if (all || index === 0) leftOut.clear();
  return [...shown, ...shownLabels(labels.labels, (number) => wanted.has(number), hiddenOf(store))];
}
