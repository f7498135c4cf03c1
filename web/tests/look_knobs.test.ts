import { expect, test } from "vitest";

import type { TransferFunction } from "../src/state/state.ts";
import { at } from "../src/view/look/curves.ts";
import { STILL, turned } from "../src/view/look/knobs.ts";

const SKIN: TransferFunction = {
  opacity_unit: 1,
  opacity: [[-550, 0], [-350, 0.2], [-150, 0.7], [50, 0.9], [200, 0.95]],
  color: [[-500, 0.8, 0.5, 0.4], [300, 0.95, 0.86, 0.72]],
};
const USUAL = [-1000, 1000] as const;
const alphaOf = (curves: TransferFunction, value: number): number => at(curves.opacity, value)[0] ?? NaN;

test("knobs at rest change nothing", () => {
  expect(turned(SKIN, STILL, USUAL)).toEqual(SKIN);
});

test("see-through fades the lowest values most, and the highest not at all", () => {
  const half = turned(SKIN, { ...STILL, through: 0.5 }, USUAL);
  for (const value of [-350, -150, 50, 200, 300]) {
    const place = (value + 550) / 850;
    expect(alphaOf(half, value)).toBeCloseTo(alphaOf(SKIN, value) * 10 ** (-3.5 * (1 - place)), 4);
  }
  expect(alphaOf(half, 300)).toBe(0.95);
  const values = half.opacity.map(([value]) => value);
  expect(values).toEqual([...values].sort((a, b) => a - b));
  expect(new Set(values).size).toBe(values.length);
});

test("see-through stays within 0.03 of its formula between the points", () => {
  const full = turned(SKIN, { ...STILL, through: 1 }, USUAL);
  for (let value = -550; value <= 300; value += 7) {
    const want = alphaOf(SKIN, value) * 10 ** (-7 * (1 - (value + 550) / 850));
    expect(Math.abs(alphaOf(full, value) - want)).toBeLessThan(0.03);
  }
});

test("reveal moves the curves to lower values, finely at first, and soften widens them", () => {
  const little = turned(SKIN, { ...STILL, reveal: 0.1 }, USUAL);
  expect(little.opacity[0]?.[0]).toBeCloseTo(-560);
  expect(turned(SKIN, { ...STILL, reveal: -1 }, USUAL).color[0]?.[0]).toBeCloseTo(500);
  const soft = turned(SKIN, { ...STILL, soften: 0.5 }, USUAL);
  expect((soft.opacity.at(-1)?.[0] ?? 0) - (soft.opacity[0]?.[0] ?? 0)).toBeCloseTo(2 * 750);
});
