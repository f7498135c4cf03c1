import { describe, expect, test } from "vitest";

import type { Look, OpacityPoint, TransferFunction } from "../src/state/state.ts";
import {
  at,
  firstGradientCurve,
  hexOf,
  isEditable,
  mapped,
  mirrored,
  outline,
  rgbOf,
  shifted,
  spanOf,
  spanOfFunction,
  surfaceValue,
  widened,
  windowed,
  withMoved,
  without,
  withOpacities,
  withPoint,
  withPointBeside,
  withPointOn,
  type Curve,
} from "../src/view/look/curves.ts";

const RISE: Curve<OpacityPoint> = [
  [0, 0],
  [100, 0.5],
  [300, 1],
];
const STEP: Curve<OpacityPoint> = [
  [0, 0],
  [100, 0],
  [100, 1],
  [200, 1],
];
const FUNCTION: TransferFunction = {
  opacity_unit: 1,
  opacity: RISE,
  color: [
    [-100, 1, 0, 0],
    [300, 0, 0, 1],
  ],
  gradient_opacity: [
    [0, 0],
    [50, 1],
  ],
};
const look = (transfer_function: Look["transfer_function"]): Look => ({
  name: "",
  description: "",
  transfer_function,
  shading: null,
  composite: "over",
  view: null,
  background: null,
});
const values = (curve: Curve): number[] => curve.map(([value]) => value ?? NaN);

describe("a curve is looked up", () => {
  test.each([
    [-10, 0],
    [0, 0],
    [50, 0.25],
    [100, 0.5],
    [200, 0.75],
    [300, 1],
    [1e6, 1],
  ])("at %d it is %d", (value, alpha) => {
    expect(at(RISE, value)).toEqual([alpha]);
  });
  test("a step has its upper side where it is", () => {
    expect([at(STEP, 99.999)[0], at(STEP, 100)[0], at(STEP, 150)[0]]).toEqual([0, 1, 1]);
  });
  test("all colours of a point", () => expect(at(FUNCTION.color, 100)).toEqual([0.5, 0, 0.5]));
  test("of one point it is constant", () => expect([at([[5, 0.3]], -1), at([[5, 0.3]], 9)]).toEqual([[0.3], [0.3]]));
});

describe("points are added", () => {
  test("in order of value", () => {
    expect(withPoint(RISE, [50, 0.9])).toEqual({
      curve: [
        [0, 0],
        [50, 0.9],
        [100, 0.5],
        [300, 1],
      ],
      index: 1,
    });
    expect(withPoint(RISE, [-5, 1]).index).toBe(0);
    expect(withPoint(RISE, [999, 1]).index).toBe(3);
  });
  test("after those of the same value", () => expect(withPoint(STEP, [100, 0.5]).index).toBe(3));
  test("without a change of the curve, wherever", () => {
    for (const value of [-50, 1, 60, 100, 250, 301]) {
      const { curve, index } = withPointOn(RISE, value);
      expect(curve[index]?.[0]).toBe(value);
      for (const seen of [-100, 0, 30, 77, 100, 222, 300, 400])
        expect(at(curve, seen)[0]).toBeCloseTo(at(RISE, seen)[0] ?? NaN, 12);
    }
  });
  test("beside one: towards the next, at the end towards the one before, past equals", () => {
    const value = (index: number, curve = RISE): number | undefined => {
      const added = withPointBeside(curve, index, [0, 1000]);
      return added.curve[added.index]?.[0];
    };
    expect([value(0), value(1), value(2)]).toEqual([50, 200, 200]);
    expect(value(1, STEP)).toBe(50);
    expect(value(0, [[5, 1]])).toBe(105);
  });
});

describe("points are moved", () => {
  test("freely between their neighbours", () =>
    expect(withMoved(RISE, 1, [40, 0.2])).toEqual([
      [0, 0],
      [40, 0.2],
      [300, 1],
    ]));
  test("never beyond them, and to equal values at most", () => {
    expect(values(withMoved(RISE, 1, [-40, 0.2]))).toEqual([0, 0, 300]);
    expect(values(withMoved(RISE, 1, [1000, 0.2]))).toEqual([0, 300, 300]);
  });
  test("the ends as far as they like", () => {
    expect(values(withMoved(RISE, 0, [-1e6, 0]))).toEqual([-1e6, 100, 300]);
    expect(values(withMoved(RISE, 2, [1e6, 0]))).toEqual([0, 100, 1e6]);
  });
  test("opacities and colours stay within 0 and 1", () => {
    expect(withMoved(RISE, 1, [100, 7])[1]).toEqual([100, 1]);
    expect(withMoved(RISE, 1, [100, -7])[1]).toEqual([100, 0]);
    expect(withMoved(FUNCTION.color, 0, [0, 2, -1, 0.5])[0]).toEqual([0, 1, 0, 0.5]);
  });
  test("the others are the same objects", () => expect(withMoved(RISE, 1, [50, 1])[0]).toBe(RISE[0]));
});

test("points are removed, but for the last one", () => {
  expect(without(RISE, 1)).toEqual([
    [0, 0],
    [300, 1],
  ]);
  expect(without([[1, 1]], 0)).toEqual([[1, 1]]);
});

describe("the function as a whole", () => {
  test("its span is that of both curves", () => {
    expect(spanOfFunction(FUNCTION)).toEqual([-100, 300]);
    expect(spanOf(RISE)).toEqual([0, 300]);
  });
  test("is shifted with its colours, not its gradients, and back", () => {
    const there = shifted(FUNCTION, 50);
    expect(values(there.opacity)).toEqual([50, 150, 350]);
    expect(values(there.color)).toEqual([-50, 350]);
    expect(there.gradient_opacity).toBe(FUNCTION.gradient_opacity);
    expect(shifted(there, -50)).toEqual(FUNCTION);
  });
  test("is widened about its middle", () => {
    const wide = widened(FUNCTION, 2);
    expect(spanOfFunction(wide)).toEqual([-300, 500]);
    expect(values(wide.opacity)).toEqual([-100, 100, 500]);
  });
  test("has its opacities scaled up to 1", () => {
    expect(withOpacities(FUNCTION, 1.5).opacity.map(([, alpha]) => alpha)).toEqual([0, 0.75, 1]);
    expect(withOpacities(FUNCTION, 0).opacity.every(([, alpha]) => alpha === 0)).toBe(true);
  });
  test("is mirrored in place, in order, and twice is as before", () => {
    expect(mirrored(RISE)).toEqual([
      [0, 1],
      [200, 0.5],
      [300, 0],
    ]);
    expect(mirrored(mirrored(RISE))).toEqual(RISE);
    expect(values(mirrored(STEP))).toEqual([0, 100, 100, 200]);
    expect(mapped(RISE, -1, 0)[0]?.[0]).toBe(-300);
  });
});

describe("window and level by dragging", () => {
  const range = [-1000, 1000] as const;
  const opacity = (moved: Look): Curve => (moved.transfer_function as TransferFunction).opacity;
  test("nothing without a movement", () => expect(windowed(look(FUNCTION), 0, 0, range)).toEqual(look(FUNCTION)));
  test("to the right is wider about the same middle", () => {
    const wide = windowed(look(FUNCTION), 100, 0, range).transfer_function as TransferFunction;
    const [low, high] = spanOfFunction(wide);
    expect(high - low).toBeGreaterThan(400);
    expect((low + high) / 2).toBeCloseTo(100, 9);
  });
  test("up is higher, by a share of the range", () => {
    expect(opacity(windowed(look(FUNCTION), 0, -50, range))[0]?.[0]).toBeCloseTo(200, 9);
    expect(opacity(windowed(look(FUNCTION), 0, 50, range))[0]?.[0]).toBeCloseTo(-200, 9);
  });
  test("small steps come to the same as one", () => {
    let moved = look(FUNCTION);
    for (let k = 0; k < 10; k++) moved = windowed(moved, 7, 0, range);
    const once = opacity(windowed(look(FUNCTION), 70, 0, range));
    values(opacity(moved)).forEach((value, k) => expect(value).toBeCloseTo(once[k]?.[0] ?? NaN, 6));
  });
  test("never turns round, however far", () => {
    const narrow = windowed(look(FUNCTION), -5000, 0, range).transfer_function as TransferFunction;
    expect(values(narrow.opacity)).toEqual([...values(narrow.opacity)].sort((a, b) => a - b));
  });
  test("a table stays as it is", () => {
    const table = look({ rgba: [], values: [], magnitudes: [] });
    expect(windowed(table, 10, 10, range)).toBe(table);
    expect([isEditable({ rgba: [], values: [], magnitudes: [] }), isEditable(FUNCTION)]).toEqual([false, true]);
  });
});

describe("drawing", () => {
  test("the outline ends where what is seen ends", () => {
    expect(outline(RISE, [50, 200])).toEqual([
      [50, 0.25],
      [100, 0.5],
      [200, 0.75],
    ]);
    expect(outline(RISE, [-50, 400])).toEqual([
      [-50, 0],
      [0, 0],
      [100, 0.5],
      [300, 1],
      [400, 1],
    ]);
  });
  test("more pieces lie on the same lines", () => {
    const fine = outline(RISE, [0, 300], 4);
    expect(fine.length).toBeGreaterThan(8);
    fine.forEach(([value, alpha]) => expect(at(RISE, value)[0]).toBeCloseTo(alpha, 12));
  });
  test("a step stays upright", () => expect(outline(STEP, [0, 200], 4)).toContainEqual([100, 0]));
});

test("colours go to hexadecimal digits and back", () => {
  expect(hexOf([7, 1, 0.5, 0])).toBe("#ff8000");
  expect(rgbOf("#ff0033")).toEqual([1, 0, 0.2]);
  expect(hexOf([0, ...rgbOf("#1a2b3c")])).toBe("#1a2b3c");
});

test("a surface stands out where the opacity reaches half of the largest one", () => {
  expect(surfaceValue(FUNCTION, [0, 1])).toBe(100);
  expect(surfaceValue({ ...FUNCTION, opacity: STEP }, [0, 1])).toBe(100);
  expect(surfaceValue({ ...FUNCTION, opacity: [[0, 0]] }, [0, 8])).toBe(4);
  expect(surfaceValue({ rgba: [], values: [], magnitudes: [] }, [0, 8])).toBe(4);
});

test("a first gradient curve rises from 0", () =>
  expect(firstGradientCurve(10)).toEqual([
    [0, 0],
    [5, 1],
  ]));
