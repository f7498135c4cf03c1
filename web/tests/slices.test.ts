// Slices without a browser: centre, magnification, fingers, texts that fit, colours of values, files of measures.

import { describe, expect, test } from "vitest";

import type { Welcome } from "../src/engine/engine.ts";
import { decodedValues, NOTHING, type SliceValues, type ValueLayer } from "../src/engine/slice_values.ts";
import { patched } from "../src/state/patch.ts";
import type { Vec3, ViewerState } from "../src/state/state.ts";
import { textsThatFit } from "../src/view/slices/fitting.ts";
import { areaOf, newest, placeOf, transformOf, worldAt, type SliceFrame } from "../src/view/slices/geometry.ts";
import { labelsCsv, measuresCsv } from "../src/view/slices/measure_csv.ts";
import { centerOf, fitted, panned, TwoFingers, zoomedAbout, ZOOMS } from "../src/view/slices/moves.ts";
import { colored } from "../src/view/slices/slice_colors.ts";

const WELCOME = { volumes: [{ bounds: [[0, 0, 0], [100, 80, 60]] }], bounds: [[0, 0, 0], [100, 80, 60]] } as unknown as Welcome;
const STATE = { view: { slices: { crosshair: [50, 40, 30], zoom: 1, thickness: 0, slab: "maximum" } } } as unknown as ViewerState;
const FRAME: SliceFrame = {
  geometry: {
    origin: [99.75, 0.25, 30], right: [-1, 0, 0], down: [0, 1, 0], normal: [0, 0, 1], pixel: 0.5, zoom: 1, position: 30, range: [0, 60],
    letters: null, window: [0, 1], colors: "gray",
  },
  size: { width: 200, height: 160 },
  width: 200,
  height: 160,
};

describe("a magnified slice", () => {
  test.each([[1e-9, ZOOMS[0]], [1e9, ZOOMS[1]]])("magnified by %s stops at %s", (factor, most) => {
    const after = patched(STATE, zoomedAbout(STATE, WELCOME, [10, 10, 10], factor));
    expect(after.view.slices.zoom).toBe(most);
    expect(zoomedAbout(after, WELCOME, [10, 10, 10], factor)).toEqual([]);
  });
  test("keeps the point it is magnified about, also in what is on the screen", () => {
    const point = worldAt(FRAME, 150, 30);
    const after = patched(STATE, zoomedAbout(STATE, WELCOME, point, 3));
    expect(after.view.slices.zoom).toBe(3);
    const now = newest(FRAME, after, "z", centerOf(after, WELCOME));
    const { x, y } = placeOf(now, point);
    expect([x, y]).toEqual([expect.closeTo(150, 6), expect.closeTo(30, 6)]);
    const [a, b, c, d, e, f] = transformOf(FRAME, now).slice(7, -1).split(",").map(Number) as [number, number, number, number, number, number];
    expect([a * 150 + c * 30 + e, b * 150 + d * 30 + f]).toEqual([expect.closeTo(150, 6), expect.closeTo(30, 6)]);
    expect(patched(after, fitted(after)).view.slices).toEqual(STATE.view.slices);
  });
  test("moves with the pointer, and its middle stays in the volume", () => {
    const moved = patched(STATE, panned(FRAME, [50, 40, 30], 20, -10, WELCOME));
    expect(moved.view.slices.center).toEqual([60, 45, 30]);
    expect(patched(STATE, panned(FRAME, [50, 40, 30], 9000, 0, WELCOME)).view.slices.center).toEqual([100, 40, 30]);
  });
});

describe("two fingers", () => {
  const total = (moves: readonly (readonly [number, number, number])[]): { steps: number; dx: number; factor: number } => {
    const fingers = new TwoFingers();
    const sum = { steps: 0, dx: 0, factor: 1 };
    for (const [dx, dy, factor] of moves) {
      const told = fingers.moved(dx, dy, factor);
      if (told === null) continue;
      if ("steps" in told) sum.steps += told.steps;
      else {
        sum.dx += told.dx;
        sum.factor *= told.factor;
      }
    }
    return sum;
  };
  test("scroll, move or magnify, one of them from beginning to end, and lose nothing", () => {
    expect(total(Array.from({ length: 15 }, () => [0, 4, 1]))).toEqual({ steps: 4, dx: 0, factor: 1 });
    expect(total(Array.from({ length: 10 }, () => [4, 0, 1]))).toEqual({ steps: 0, dx: 40, factor: 1 });
    expect(total(Array.from({ length: 10 }, () => [0, 0, 1.1])).factor).toBeCloseTo(1.1 ** 10);
  });
});

test("texts give way to each other by the size of the pane", () => {
  const name = ["Coronal", "161.3 mm"];
  const at = (width: number, height: number) => textsThatFit({ width, height }, name, "L 40 W 400");
  expect(at(470, 370)).toEqual({ name, window: "L 40 W 400", sideLetters: true, endLetters: true, scaleBar: true });
  expect(at(210, 61)).toMatchObject({ name: ["Coronal"], sideLetters: false, endLetters: false });
  expect(at(90, 130)).toMatchObject({ window: null, endLetters: false });
  expect(at(300, 20).name).toEqual([]);
});

test("the area of a region does not depend on where it lies or begins", () => {
  const corners: Vec3[] = [[5, 5, 1], [8, 5, 1], [8, 9, 1], [5, 9, 1]];
  expect(areaOf(corners)).toBeCloseTo(12);
  expect(areaOf([...corners.slice(2), ...corners.slice(0, 2)])).toBeCloseTo(12);
  expect(areaOf(corners.map(([x, y]) => [x, y, y]))).toBeCloseTo(12 * Math.SQRT2);
});

describe("colours of values", () => {
  const grey: ValueLayer = { layer: 0, kind: "window", low: -10, step: 0.5, color: [[0, 0, 0, 0], [1, 1, 1, 1]] };
  const of = (layers: ValueLayer[], codes: number[][], labels: SliceValues["header"]["labels"] = null, marks: number[] | null = null): SliceValues => ({
    header: { layers, labels, background: [0, 0, 0] },
    width: codes[0]?.length ?? 0,
    height: 1,
    layers: codes.map((one) => Uint16Array.from(one)),
    labels: marks && Uint16Array.from(marks),
  });
  const reds = (values: SliceValues, opacities: number[], window: [number, number] = [0, 10]): number[] => {
    const out = new Uint8ClampedArray(4 * values.width);
    colored(values, { window, opacities }, out);
    return [...out].filter((_, n) => n % 4 === 0);
  };
  test("a window turns values into greys", () => {
    // Values -10, -5, 0, 5, none.
    expect(reds(of([grey], [[0, 10, 20, 30, NOTHING]]), [1])).toEqual([0, 0, 128, 255, 0]);
    expect(reds(of([grey], [[20]]), [0.5])).toEqual([64]);
  });
  test("a layer lies over it where it shows, with a step at its threshold", () => {
    const red: ValueLayer = { layer: 1, kind: "over", low: 0, step: 1, color: [[0, 1, 0, 0]], opacity: [[2, 0], [2, 1]], lowest: null };
    expect(reds(of([grey, red], [[20, 20, 20], [1, 2, NOTHING]]), [1, 0.5])).toEqual([128, 191, 128]);
  });
  test("light of channels is added, and no more than white", () => {
    const light: ValueLayer = { ...grey, kind: "light", low: 0, step: 1, color: [[0, 0, 0, 0], [10, 1, 1, 1]] };
    expect(reds(of([light, { ...light, layer: 1 }], [[2, 8, NOTHING], [3, 8, 5]]), [1, 1])).toEqual([128, 255, 128]);
  });
  test("labels are faint inside and full along outlines", () => {
    const labels = { colors: [[0, 0, 0, 0], [1, 1, 0, 0]] as const, names: [null, "a"] };
    expect(reds(of([grey], [[0, 0, 0, 0, 0]], labels, [0, 1, 1, 1, 0]), [1])).toEqual([0, 255, 102, 255, 0]);
  });
  test("planes that are too short are refused", async () => {
    const stream = new Blob([new Uint8Array(6)]).stream().pipeThrough(new CompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    await expect(decodedValues({ layers: [grey], labels: null, background: [0, 0, 0] }, 2, 2, bytes)).rejects.toThrow(/2 x 2 pixels/);
    const { layers } = await decodedValues({ layers: [grey], labels: null, background: [0, 0, 0] }, 3, 1, bytes);
    expect([...(layers[0] ?? [])]).toEqual([0, 0, 0]);
  });
});

test("files of measures have a row for each, with units and quoted texts", () => {
  const points: Vec3[] = [[0, 0, 0], [3, 4, 0]];
  const square: Vec3[] = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]];
  const text = measuresCsv(
    [{ kind: "distance", points }, { kind: "area", points: square }],
    [null, { mean: 40.5, sd: 2, min: 30, max: 50 }],
    "mm",
    "HU",
  );
  expect(text.split("\r\n").slice(1)).toEqual([
    "1,distance,5,mm,,,,,,0 0 0; 3 4 0",
    "2,area,4,mm²,40.5,2,30,50,HU,0 0 0; 2 0 0; 2 2 0; 0 2 0",
  ]);
  const label = { number: 2, n_voxels: 10, volume: 20, mean: 1.5, sd: 0, min: 1, max: null };
  expect(labelsCsv([{ ...label, name: 'the "left", =1' }], "mm", "HU").split("\r\n")).toEqual([
    "number,name,voxels,volume (mm³),mean (HU),sd (HU),min (HU),max (HU)",
    '2,"the ""left"", =1",10,20,1.5,0,1,',
  ]);
  expect(labelsCsv([{ ...label, name: "=1+1" }], "mm", "").split("\r\n")[1]).toContain("'=1+1");
});
