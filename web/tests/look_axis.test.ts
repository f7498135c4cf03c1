import { describe, expect, test } from "vitest";

import {
  around,
  fieldText,
  heights,
  keyStep,
  numberText,
  outOfSight,
  rounded,
  roundStep,
  ticks,
  wholeOf,
  within,
  zoomed,
} from "../src/view/look/axis.ts";
import {
  chosen,
  anglesOf,
  directionOf,
  hexColor,
  lookFromText,
  lookText,
  shadingOf,
  DEFAULT_SHADING,
} from "../src/view/look/looks.ts";
import { compositeName } from "../src/view/descriptions.ts";
import { compositeNamed, numberOf, withNumber } from "../src/view/look/composites.ts";
import type { Layer, Look, ViewerState } from "../src/state/state.ts";
import { patched } from "../src/state/patch.ts";
import { pointKey } from "../src/view/look/use_handles.tsx";
import { matching } from "../src/view/look/preset_search.ts";

describe("what is seen of the axis", () => {
  test("the whole has all values and all points in it", () => {
    const [low, high] = wholeOf([0, 100], [-50, 60]);
    expect(low).toBeLessThan(-50);
    expect(high).toBeGreaterThan(100);
    expect(wholeOf([3, 3], [3, 3])[1]).toBeGreaterThan(3);
  });
  test("zooming keeps the value under the pointer in its place", () => {
    const [low, high] = zoomed([0, 100], 2, 25, [0, 100]);
    expect(high - low).toBeCloseTo(50, 12);
    expect((25 - low) / (high - low)).toBeCloseTo(0.25, 12);
  });
  test("zooming out ends at the whole, zooming in somewhere", () => {
    expect(zoomed([20, 80], 0.01, 50, [0, 100])).toEqual([0, 100]);
    const [low, high] = zoomed([20, 80], 1e12, 50, [0, 100]);
    expect(high - low).toBeCloseTo(0.01, 9);
  });
  test("moving ends at the ends", () => {
    expect(within([-50, 0], [0, 100])).toEqual([0, 50]);
    expect(within([90, 140], [0, 100])).toEqual([50, 100]);
    expect(within([-10, 400], [0, 100])).toEqual([0, 100]);
  });
  test("around points there is room on both sides", () => {
    const [low, high] = around([40, 60], [0, 100]);
    expect([low < 40, high > 60]).toEqual([true, true]);
    expect(around([40, 40], [0, 100])).toEqual([35, 45]);
  });
  test("points out of sight are counted", () => {
    expect(outOfSight([[0], [10], [20], [30]], [5, 15])).toEqual({ below: 1, above: 2 });
    expect(outOfSight([[5], [15]], [5, 15])).toEqual({ below: 0, above: 0 });
  });
});

describe("numbers", () => {
  test("ticks are round and inside", () => {
    expect(ticks([-1023, 781], 4)).toEqual([-1000, -500, 0, 500]);
    expect(ticks([0, 0.3], 3)).toEqual([0, 0.1, 0.2, 0.3]);
  });
  test("steps are 1, 2 or 5 times a power of ten", () => {
    expect([0.7, 1.5, 3, 7, 0.011, 200].map(roundStep)).toEqual([1, 2, 5, 10, 0.02, 200]);
    expect(roundStep(0)).toBe(1);
  });
  test("fine is finer than coarse", () =>
    expect([keyStep([0, 1000], true), keyStep([0, 1000], false)]).toEqual([5, 50]));
  test("a value has no more digits than can be seen", () => {
    expect(rounded(123.4567, 2000)).toBe(123);
    expect(rounded(0.123456, 1)).toBe(0.123);
    expect(rounded(-0.4, 2000)).toBe(0);
  });
  test("numbers are written as people do", () => {
    expect([0, -1024, 0.1 + 0.2, 123456.789, 5e-9, 3e12].map(numberText)).toEqual([
      "0",
      "-1024",
      "0.3",
      "123457",
      "5e-9",
      "3e+12",
    ]);
  });
  test("bars are between 0 and 1, in logarithms the small ones are seen", () => {
    expect(heights([0, 1, 100], false)).toEqual([0, 0.01, 1]);
    const [none, small, large] = heights([0, 1, 100], true);
    expect([none, large]).toEqual([0, 1]);
    expect(small).toBeGreaterThan(0.1);
    expect(heights([0, 0], true)).toEqual([0, 0]);
  });
});

const look = (name: string, more: Partial<Look> = {}): Look => ({
  name,
  description: "",
  transfer_function: { opacity_unit: 1, opacity: [[0, 1]], color: [[0, 1, 1, 1]] },
  shading: DEFAULT_SHADING,
  composite: "over",
  view: null,
  background: null,
  ...more,
});
const layer = (one: Look): Layer => ({
  volume: { path: null, name: "a" },
  name: "a",
  look: one,
  visible: true,
  opacity: 1,
  time: 0,
});
const state = (layers: Layer[], more: object = {}): ViewerState =>
  ({
    layers,
    shading: "look",
    background: "black",
    render: { quality: "normal", kernel: "linear", composite: "over" },
    ...more,
  }) as unknown as ViewerState;

describe("choosing a look", () => {
  test("takes its operator, light and background with it", () => {
    const before = state([layer(look("a"))], { shading: null });
    const after = patched(before, chosen(before, 0, look("mip", { composite: "maximum", background: "white" })));
    expect([after.layers[0]?.look.name, after.render.composite, after.background, after.shading]).toEqual([
      "mip",
      "maximum",
      "white",
      "look",
    ]);
  });
  test("goes back to black, but leaves a background that was chosen", () => {
    const white = state([layer(look("a", { background: "white" }))], { background: "white" });
    expect(patched(white, chosen(white, 0, look("b"))).background).toBe("black");
    const own = state([layer(look("a"))], { background: "#123456" });
    expect(patched(own, chosen(own, 0, look("b", { background: "white" }))).background).toBe("#123456");
  });
  test("an operator with numbers comes with it where they are known", () => {
    const before = state([layer(look("a"))]);
    const hit = { "first-hit": { iso_value: 3 } };
    expect(patched(before, chosen(before, 0, look("b"), hit)).render.composite).toEqual(hit);
    expect(patched(before, chosen(before, 0, look("b", { composite: "first-hit" }))).render.composite).toBe("over");
  });
  test("of one of several layers leaves the operator of all", () => {
    const before = state([layer(look("a")), layer(look("b"))]);
    const after = patched(before, chosen(before, 1, look("mip", { composite: "maximum" })));
    expect([after.layers[1]?.look.name, after.layers[0]?.look.name, after.render.composite]).toEqual([
      "mip",
      "a",
      "over",
    ]);
  });
  test("the light is that of the look, or of the scene", () => {
    const own = state([layer(look("a"))]);
    expect(shadingOf(own, 0)).toEqual({ shading: DEFAULT_SHADING, path: ["layers", 0, "look", "shading"] });
    expect(shadingOf({ ...own, shading: null }, 0)).toEqual({ shading: null, path: ["shading"] });
  });
  test("a look goes to a file and back", () => {
    expect(lookFromText(lookText(look("a")))).toEqual(look("a"));
    expect(JSON.parse(lookText(look("a"))).version).toBe(1);
    expect(() => lookFromText("{}")).toThrow("transfer_function");
    expect(() => lookFromText("no")).toThrow();
  });
});

describe("light", () => {
  test.each([
    [0, 0],
    [-30, 40],
    [90, 0],
    [170, -20],
  ])("angles %d, %d are a direction and back", (azimuth, elevation) => {
    const [a, e] = anglesOf(directionOf([azimuth, elevation]));
    expect([a, e].map((angle) => Math.round(angle * 1e6) / 1e6 + 0)).toEqual([azimuth, elevation]);
  });
  test("right is +x, above is +y, the viewer is +z", () => {
    expect(anglesOf([1, 0, 0])).toEqual([90, 0]);
    expect(anglesOf([0, 2, 0])[1]).toBeCloseTo(90, 9);
    expect(anglesOf([0, 0, 3])).toEqual([0, 0]);
  });
});

describe("operators", () => {
  test("have a name, with or without numbers", () => {
    expect([compositeName("mean"), compositeName({ "first-hit": { iso_value: 3 } })]).toEqual(["mean", "first-hit"]);
    expect([numberOf("x-ray", "clear"), numberOf({ "x-ray": { clear: -1000 } }, "clear")]).toEqual([null, -1000]);
  });
  test("keep their other numbers", () => {
    expect(withNumber({ "x-ray": { clear: -1000 } }, "attenuation", 2e-5)).toEqual({
      "x-ray": { clear: -1000, attenuation: 2e-5 },
    });
    expect(withNumber("x-ray", "clear", 0)).toEqual({ "x-ray": { clear: 0 } });
  });
  test("only the isosurface begins with a number", () => {
    expect([compositeNamed("first-hit", 300), compositeNamed("x-ray", 300)]).toEqual([
      { "first-hit": { iso_value: 300 } },
      "x-ray",
    ]);
  });
});

test("colours become hexadecimal digits", () => {
  const named = (): string => "#00ff00";
  expect([[1, 0.5, 0, 1], "#ABC", "#aabbccdd", "lime", null].map((color) => hexColor(color, named))).toEqual([
    "#ff8000",
    "#aabbcc",
    "#aabbcc",
    "#00ff00",
    "#000000",
  ]);
});

test("a search finds all words in any order, names before descriptions", () => {
  const presets = [
    { name: "grey", description: "for CT and bone" },
    { name: "CT-Bone", description: "skeleton" },
    { name: "mr", description: "head" },
  ];
  expect(matching(presets, "bone ct").map(({ name }) => name)).toEqual(["CT-Bone", "grey"]);
  expect(matching(presets, " ").length).toBe(3);
  expect(matching(presets, "pet")).toEqual([]);
});

describe("keys at a point", () => {
  const seen = [0, 1000] as const;
  test("arrows move finely, with Shift finer, Page up and down far", () => {
    expect(pointKey("ArrowRight", false, seen, 0.01)).toEqual({ does: "move", value: 5, rise: 0 });
    expect(pointKey("ArrowLeft", true, seen, 0.01)).toEqual({ does: "move", value: -1, rise: 0 });
    expect(pointKey("PageUp", false, seen, 0.01)).toEqual({ does: "move", value: 50, rise: 0 });
    expect(pointKey("ArrowDown", false, seen, 0.01)).toEqual({ does: "move", value: 0, rise: -0.01 });
  });
  test("others remove, add, go to the number, or are for others", () => {
    const does = (key: string): string | undefined => pointKey(key, false, seen, 0.01)?.does;
    expect(["Delete", "Backspace", "Insert", "Enter", "z", "Tab"].map(does)).toEqual([
      "remove",
      "remove",
      "insert",
      "type",
      undefined,
      undefined,
    ]);
  });
});

test.each([
  [-177.956, 1, "-178"],
  [-177.956, 2, "-177.96"],
  [0.25, 2, "0.25"],
  [0.000123457, undefined, "1.2346e-4"],
  [-0.000123457, undefined, "-1.235e-4"],
  [-123456.789, undefined, "-123457"],
  [-1.23456e-12, undefined, "-1.23e-12"],
  [0.00001, 2, "1e-5"],
  [5500000, 0, "5500000"],
])("the text of %d with %s decimals in a field is %s", (value, decimals, text) => {
  expect(fieldText(value, decimals)).toBe(text);
});
