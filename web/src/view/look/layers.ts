// Operations that show and hide labels.

import { set, type Operation } from "../../state/patch.ts";
import { WORDS } from "../../words.ts";
import type { LabelLook } from "../../state/state.ts";
import type { Store } from "../../state/store.ts";

/** Default opacity of a label, the same as in `wavesplat.Label`. */
const LABEL_OPACITY = 0.8;

interface LabelRow {
  readonly number: string;
  readonly name: string;
  readonly look: LabelLook;
  readonly opacity: number;
  readonly isShown: boolean;
}

/** Rows of the labels in order of their numbers; with a filter, those whose name contains it or whose number it is. */
export function labelRows(labels: Readonly<Record<string, LabelLook>>, filter = ""): LabelRow[] {
  const wanted = filter.trim().toLowerCase();
  return Object.entries(labels)
    .sort(([a], [b]) => Number(a) - Number(b))
    .map(([number, look]) => {
      const opacity = look.opacity ?? LABEL_OPACITY;
      return {
        number,
        look,
        name: look.name || WORDS.legend.unnamed(number),
        opacity,
        isShown: opacity > 0 || (look.tint ?? 0) > 0,
      };
    })
    .filter(({ number, name }) => wanted === "" || number === wanted || name.toLowerCase().includes(wanted));
}

interface Matter {
  readonly opacity: number;
  readonly tint: number;
  /** Share of the scan that is left inside of the label. */
  readonly scan: number;
}

/** Opacity, tint and scan of the labels that the page hid, by number, as they were before. */
export type Hidden = Map<string, Matter>;

const hiddenOfStores = new WeakMap<object, Hidden>();

/** The labels that the page hid, which every part that hides and shows labels shares. */
export function hiddenOf(store: object): Hidden {
  const known = hiddenOfStores.get(store) ?? new Map();
  hiddenOfStores.set(store, known);
  return known;
}

/** Settings of a hidden label: the scan is drawn as if there were no label. */
const NOTHING: Matter = { opacity: 0, tint: 0, scan: 1 };
const USUAL: Matter = { opacity: LABEL_OPACITY, tint: 0, scan: 0 };

/** The operations that show or hide one label of a store's state, and leave the others. */
export function toggledLabel(store: Pick<Store, "state">, number: string): Operation[] {
  const labels = store.state.labels?.labels ?? {};
  const shown = new Map(labelRows(labels).map((row) => [row.number, row.isShown]));
  return shownLabels(labels, (other) => shown.get(other) !== (other === number), hiddenOf(store));
}

/** Shows and hides labels. Hiding loses what a label had; `hidden` remembers it for showing it again. */
export function shownLabels(
  labels: Readonly<Record<string, LabelLook>>,
  isShown: (number: string) => boolean,
  hidden: Hidden,
): Operation[] {
  return labelRows(labels).flatMap(({ number, look, opacity, isShown: before }) => {
    if (before === isShown(number)) return [];
    const now: Matter = { opacity, tint: look.tint ?? 0, scan: look.scan ?? (opacity > 0 ? 0 : 1) };
    const next = before ? NOTHING : (hidden.get(number) ?? USUAL);
    if (before) hidden.set(number, now);
    const fields = ["opacity", "tint", "scan"] as const;
    return fields.flatMap((field) =>
      now[field] === next[field] ? [] : [set(next[field], "labels", "labels", number, field)],
    );
  });
}

export function isSoloLabel(rows: readonly LabelRow[], number: string): boolean {
  return rows.every((row) => row.isShown === (row.number === number));
}
