// The axis of values under a histogram: its visible range, its ticks, and numbers for people.

import { clamped, type Curve, type Range } from "./curves.ts";

/** Least width of the visible range, as a share of the whole. */
const CLOSEST = 1e-4;

/** The whole axis: all values of the data, and all points of the curves, with a little room. */
export function wholeOf(data: Range, points: Range): Range {
  const [low, high] = [Math.min(data[0], points[0]), Math.max(data[1], points[1])];
  const room = 0.02 * (high > low ? high - low : Math.abs(low) || 1);
  return [low - room, high + room];
}

/** The visible range zoomed (in for a factor above 1), with the value `centre` in its place; never beyond the whole. */
export function zoomed(seen: Range, factor: number, centre: number, whole: Range): Range {
  const most = whole[1] - whole[0];
  const width = clamped((seen[1] - seen[0]) / factor, CLOSEST * most, most);
  const share = clamped((centre - seen[0]) / (seen[1] - seen[0]), 0, 1);
  return within([centre - share * width, centre + (1 - share) * width], whole);
}

/** The range moved into the whole, its width kept or cut to the width of the whole. */
export function within([low, high]: Range, whole: Range): Range {
  const width = Math.min(high - low, whole[1] - whole[0]);
  const start = clamped(low, whole[0], whole[1] - width);
  return [start, start + width];
}

/** Round values along a range, about `n` of them. */
export function ticks([low, high]: Range, n = 5): number[] {
  const step = roundStep((high - low) / n);
  // Quotients that rounding leaves a hair beside a whole number count as whole.
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(0, Math.min(count, 50)) }, (_, k) => tidy((first + k) * step, step));
}

/** The value rounded for people where a range of width `span` is visible: to a power of ten, at most a thousandth of it. */
export function rounded(value: number, span: number): number {
  const step = 10 ** Math.floor(Math.log10(Math.max(Math.abs(span), Number.MIN_VALUE) / 1000));
  return Number.isFinite(step) && step > 0 ? tidy(Math.round(value / step) * step, step) : value;
}

/** Text of a number, with at most six digits, and an exponent only for very large and very small ones. */
export function numberText(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(2).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(6)));
}

/** Most characters that a number field shows, of 96 pixels. */
const FIELD_LENGTH = 9;

/** Text of a number in a field: rounded to decimals, where they are given, and short enough that nothing is cut. */
export function fieldText(value: number, decimals?: number): string {
  const whole = decimals === undefined ? value : Number(value.toFixed(Math.min(decimals, 20)));
  const text = numberText(whole === 0 && value !== 0 ? value : whole);
  if (text.length <= FIELD_LENGTH) return text;
  for (let digits = 5; digits > 1; digits -= 1) {
    const shorter = [String(Number(value.toPrecision(digits))), value.toExponential(digits - 1)].find((one) => one.length <= FIELD_LENGTH);
    if (shorter !== undefined) return shorter;
  }
  return value.toExponential(0);
}

/** Decimals of a number that is set in steps: one more than the step has. */
export function decimalsOfStep(step: number): number {
  return Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(step) + 1e-9)));
}

/** Counts of points below and above the visible range. */
export function outOfSight(curve: Curve, [low, high]: Range): { readonly below: number; readonly above: number } {
  const values = curve.map(([value]) => value ?? 0);
  return { below: values.filter((value) => value < low).length, above: values.filter((value) => value > high).length };
}

/** A range around the points, with room to move them. */
export function around(points: Range, whole: Range): Range {
  const width = points[1] - points[0];
  const room = width > 0 ? 0.15 * width : 0.05 * (whole[1] - whole[0]);
  return within([points[0] - room, points[1] + room], whole);
}

/** Heights 0..1 of the bars of a histogram. */
export function heights(counts: readonly number[], isLog: boolean): number[] {
  const most = Math.max(1, ...counts);
  return counts.map((count) => (isLog ? Math.log1p(count) / Math.log1p(most) : count / most));
}

/** A round step for keys: if `fine` about a two-hundredth of the visible range, else about a twentieth. */
export function keyStep([low, high]: Range, fine: boolean): number {
  return roundStep((high - low) / (fine ? 200 : 20));
}

/** The smallest of 1, 2 and 5 times powers of ten that is not less than `least`. */
export function roundStep(least: number): number {
  if (!(least > 0) || !Number.isFinite(least)) return 1;
  const power = 10 ** Math.floor(Math.log10(least));
  const factor = [1, 2, 5, 10].find((one) => one * power >= least * (1 - 1e-9)) ?? 10;
  return factor * power;
}

/** The value without the rounding errors that multiplying by a step leaves. */
function tidy(value: number, step: number): number {
  const places = Math.max(0, Math.min(12, 1 - Math.floor(Math.log10(step))));
  return Number(value.toFixed(places)) + 0;
}
