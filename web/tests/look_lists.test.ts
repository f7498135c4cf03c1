import { describe, expect, test } from "vitest";

import { patched } from "../src/state/patch.ts";
import type { LabelLook, Layer, View, ViewerState } from "../src/state/state.ts";
import { chosenRows } from "../src/view/legend_rows.ts";
import { isSoloLabel, labelRows, shownLabels, toggledLabel, type Hidden } from "../src/view/look/layers.ts";
import {
  dropPreset,
  keepPreset,
  nameProblem,
  ownPreset,
  ownPresets,
  renamePreset,
  type Keeper,
  type OwnPreset,
} from "../src/view/look/own_presets.ts";
import { isSolo, soloLayer } from "../src/view/look/solo.ts";
import { nextTime, shownViews, waitFor } from "../src/view/look/time_steps.ts";

test("a legend with room for few rows has those that are shown, and those that were just clicked, in their order", () => {
  const rows = [..."abcdefgh"].map((key) => ({ key, isShown: "cfh".includes(key) }));
  const keys = (most: number, ...touched: string[]): string => chosenRows(rows, most, new Set(touched)).map(({ key }) => key).join("");
  expect(keys(4)).toBe("acfh");
  expect(keys(2)).toBe("cf");
  expect(keys(3, "g")).toBe("cfg");
});

describe("layers", () => {
  const scene = (...visible: boolean[]) => ({ layers: visible.map((one) => ({ visible: one }) as Layer) });
  const shown = (before: ReturnType<typeof scene>, index: number): boolean[] =>
    patched(before, soloLayer({ state: { ...before, labels: null } as unknown as ViewerState }, index)).layers.map(({ visible }) => visible);
  test("one alone, and all again", () => {
    expect(shown(scene(true, true, false), 1)).toEqual([false, true, false]);
    expect(shown(scene(false, true, false), 1)).toEqual([true, true, true]);
    expect(shown(scene(false, true, false), 0)).toEqual([true, false, false]);
  });
  test("labels lie on the first layer, and are hidden with it; those that were hidden before stay so", () => {
    const labels = { 1: { color: "red", opacity: 0.5 }, 2: { color: "blue", opacity: 0, scan: 1 } };
    const store = { state: { ...scene(true, true, true), labels: { labels } } as unknown as ViewerState };
    const seen = (index: number): string[] => {
      store.state = patched(store.state, soloLayer(store, index));
      return labelRows(store.state.labels?.labels ?? {}).filter(({ isShown }) => isShown).map(({ number, opacity }) => `${number}: ${opacity}`);
    };
    expect([seen(1), seen(2), seen(2)]).toEqual([[], [], ["1: 0.5"]]);
    expect([seen(1), seen(0), seen(0)]).toEqual([[], ["1: 0.5"], ["1: 0.5"]]);
  });
  test("alone is alone", () => {
    expect(isSolo(scene(false, true).layers, 1)).toBe(true);
    expect(isSolo(scene(true, true).layers, 1)).toBe(false);
  });
});

describe("labels", () => {
  const labels: Record<string, LabelLook> = {
    "10": { color: "red", name: "Liver" },
    "2": { color: "blue", opacity: 0.3 },
    "3": { color: "green", opacity: 0, tint: 0.7, name: "Bones" },
    "4": { color: "grey", opacity: 0, scan: 0, name: "Table" },
  };
  const scene = { labels: { labels } };
  const names = (filter: string): string[] => labelRows(labels, filter).map(({ name }) => name);

  test("are in order of their numbers and have names", () =>
    expect(names("")).toEqual(["Label 2", "Bones", "Table", "Liver"]));
  test("are found by name and by number", () => {
    expect([names("BO"), names("10"), names("x")]).toEqual([["Bones"], ["Liver"], []]);
    expect(names("2")).toEqual(["Label 2"]);
  });
  test("are shown if they have matter or tint", () => {
    expect(labelRows(labels).map(({ isShown }) => isShown)).toEqual([true, true, false, true]);
  });
  test("come back as they were", () => {
    const hidden: Hidden = new Map();
    const none = patched(
      scene,
      shownLabels(labels, () => false, hidden),
    );
    expect(labelRows(none.labels.labels).some(({ isShown }) => isShown)).toBe(false);
    const again = patched(
      none,
      shownLabels(none.labels.labels, (number) => number !== "4", hidden),
    );
    expect(again.labels.labels["2"]?.opacity).toBe(0.3);
    expect(again.labels.labels["3"]?.opacity).toBe(0);
    expect(again.labels.labels["3"]?.tint).toBe(0.7);
    expect(again.labels.labels["10"]?.opacity).toBe(0.8);
    expect(["2", "3", "10"].map((number) => again.labels.labels[number]?.scan)).toEqual([0, undefined, 0]);
  });
  test("leave no hole in the scan where they are hidden", () => {
    const none = patched(
      scene,
      shownLabels(labels, () => false, new Map()),
    );
    // The table was hidden on purpose, with the scan in it.
    const scans = labelRows(none.labels.labels).map(({ look }) => look.scan);
    expect(scans).toEqual([1, undefined, 0, 1]);
  });
  test("what is so already is not touched", () =>
    expect(shownLabels(labels, (number) => number !== "4", new Map())).toEqual([]));
  test("one is hidden and shown again as it was, and the others stay", () => {
    const store = { state: scene as unknown as ViewerState };
    store.state = patched(store.state, toggledLabel(store, "2"));
    expect(labelRows(store.state.labels?.labels ?? {}).map(({ isShown }) => isShown)).toEqual([false, true, false, true]);
    store.state = patched(store.state, toggledLabel(store, "2"));
    expect(store.state.labels?.labels["2"]).toMatchObject(labels["2"] as LabelLook);
    expect(store.state.labels?.labels["10"]).toEqual(labels["10"]);
  });
  test("alone is alone", () => {
    const alone = patched(
      scene,
      shownLabels(labels, (number) => number === "2", new Map()),
    );
    expect(isSoloLabel(labelRows(alone.labels.labels), "2")).toBe(true);
    expect(isSoloLabel(labelRows(labels), "2")).toBe(false);
  });
});

describe("presets of one's own", () => {
  const keeper = (text: string | null = null): Keeper & { text: string | null } => ({
    text,
    getItem() {
      return this.text;
    },
    setItem(_, value) {
      this.text = value;
    },
  });
  const preset = (name: string): OwnPreset => ({ name, picture: "", look: { name } as OwnPreset["look"] });

  test("are kept, replaced, renamed and dropped", () => {
    const kept = keeper();
    keepPreset(preset("a"), kept);
    keepPreset(preset("b"), kept);
    keepPreset({ ...preset("a"), picture: "data:" }, kept);
    expect(ownPresets(kept).map(({ name }) => name)).toEqual(["b", "a"]);
    expect(ownPreset("a", kept)?.picture).toBe("data:");
    renamePreset("a", "c", kept);
    expect(ownPreset("c", kept)?.look.name).toBe("c");
    expect(ownPreset("a", kept)).toBeUndefined();
    renamePreset("c", "b", kept);
    expect(ownPresets(kept).length).toBe(1);
    expect(dropPreset("b", kept)).toEqual([]);
  });
  test("what is no preset is left out", () => {
    expect(ownPresets(keeper("{"))).toEqual([]);
    expect(ownPresets(keeper("null"))).toEqual([]);
    expect(ownPresets(keeper('[1, null, {"name": "x"}, {"name": "y", "picture": "", "look": {}}]')).length).toBe(1);
  });
  test("where nothing can be kept it is said", () => {
    expect(() => keepPreset(preset("a"), null)).toThrow("export the look");
    expect(ownPresets(null)).toEqual([]);
  });
  test("names of others are refused", () => {
    expect(nameProblem("CT-BONE", ["ct-bone"])).toContain("ct-bone");
    expect([nameProblem("mine", ["ct-bone"]), nameProblem("", [])]).toEqual([null, "Give the preset a name."]);
  });
});

describe("playing", () => {
  test("goes on, and round if it is to", () => {
    expect([nextTime(0, 3, false), nextTime(2, 3, true), nextTime(2, 3, false), nextTime(0, 1, true)]).toEqual([
      1,
      0,
      null,
      null,
    ]);
  });
  test("waits for the picture before, and for the rate", () => {
    expect(waitFor(1000, { at: 0, isShown: false }, 10)).toBeNull();
    expect(waitFor(1000, { at: 950, isShown: true }, 10)).toBe(50);
    expect(waitFor(1000, { at: 100, isShown: true }, 10)).toBe(0);
  });
  test("only views that are shown are waited for", () => {
    const layout = (name: View["layout"]["name"]): View["layout"] => ({ name, main: "z" });
    expect([shownViews(layout("3d")), shownViews(layout("single")), shownViews(layout("two-by-two")).length]).toEqual([
      ["3d"],
      ["z"],
      4,
    ]);
  });
});
