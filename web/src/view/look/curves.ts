// Operations on the curves of a transfer function. A curve is a list of points, [value, ...rest], in order of value;
// it is straight between them, and constant beyond its ends. Two points at one value make a step. No curve becomes empty.

import type { ColorPoint, Look, OpacityPoint, TransferFunction, TransferFunction2D } from "../../state/state.ts";

export type Point = readonly number[];
export type Curve<P extends Point = Point> = readonly P[];
export type Range = readonly [number, number];

/** A curve, and the index of the point that was added or moved. */
export interface Edited<P extends Point> {
  readonly curve: Curve<P>;
  readonly index: number;
}

/** Pixels of a drag that widens by a factor of e, and of one that moves by the whole range. */
const WIDTH_PX = 250;
const LEVEL_PX = 500;

export function isEditable(curves: TransferFunction | TransferFunction2D): curves is TransferFunction {
  return !("rgba" in curves);
}

/** The curve at a value, without the value itself: opacity or colour. At a step, the upper side counts. */
export function at(curve: Curve, value: number): number[] {
  const next = curve.findIndex((point) => valueAt(point) > value);
  const right = next < 0 ? curve.length - 1 : next;
  const [a, b] = [curve[next < 0 ? right : Math.max(0, right - 1)], curve[right]];
  if (a === undefined || b === undefined) return [];
  const width = valueAt(b) - valueAt(a);
  const share = width > 0 ? clamped((value - valueAt(a)) / width, 0, 1) : 0;
  return a.slice(1).map((start, k) => start + share * ((b[k + 1] ?? start) - start));
}

/** The curve with a point added, after points of the same value. */
export function withPoint<P extends Point>(curve: Curve<P>, point: P): Edited<P> {
  const next = curve.findIndex((other) => valueAt(other) > valueAt(point));
  const index = next < 0 ? curve.length : next;
  return { curve: [...curve.slice(0, index), point, ...curve.slice(index)], index };
}

/** The curve with a point added on it, so that its form does not change. */
export function withPointOn<P extends Point>(curve: Curve<P>, value: number): Edited<P> {
  return withPoint(curve, [value, ...at(curve, value)] as Point as P);
}

/** The curve with a point added in the middle between a point and the next one, or at the end the one before. */
export function withPointBeside<P extends Point>(curve: Curve<P>, index: number, span: Range): Edited<P> {
  const here = valueAt(curve[index] ?? [middle(span)]);
  const [next, before] = [curve[index + 1], curve[index - 1]];
  if (next !== undefined && valueAt(next) > here) return withPointOn(curve, (here + valueAt(next)) / 2);
  if (before !== undefined && valueAt(before) < here) return withPointOn(curve, (here + valueAt(before)) / 2);
  return withPointOn(curve, here + 0.1 * (span[1] - span[0]));
}

/** The curve with a point moved: never beyond its neighbours, and all but the value kept within 0..1. */
export function withMoved<P extends Point>(curve: Curve<P>, index: number, point: P): Curve<P> {
  const least = index > 0 ? valueAt(curve[index - 1] ?? []) : -Infinity;
  const most = index < curve.length - 1 ? valueAt(curve[index + 1] ?? []) : Infinity;
  const moved = [clamped(valueAt(point), least, most), ...point.slice(1).map((share) => clamped(share, 0, 1))];
  return curve.map((other, k) => (k === index ? (moved as Point as P) : other));
}

/** The curve without a point; the only point of a curve stays. */
export function without<P extends Point>(curve: Curve<P>, index: number): Curve<P> {
  return curve.length > 1 ? curve.filter((_, k) => k !== index) : curve;
}

/** Smallest and largest value of the points. */
export function spanOf(...curves: readonly Curve[]): Range {
  const values = curves.flat().map(valueAt);
  return [Math.min(...values), Math.max(...values)];
}

/** Smallest and largest value of all points of a transfer function of the value. */
export function spanOfFunction(curves: TransferFunction): Range {
  return spanOf(curves.opacity, curves.color);
}

/** The curve with each value v replaced by centre + factor * (v - centre) + shift; a negative factor reverses the order. */
export function mapped<P extends Point>(curve: Curve<P>, factor: number, centre: number, shift = 0): Curve<P> {
  const points = curve.map((point) => {
    const value = centre + factor * (valueAt(point) - centre) + shift;
    return [value, ...point.slice(1)] as Point as P;
  });
  return factor < 0 ? points.reverse() : points;
}

export function shifted(curves: TransferFunction, shift: number): TransferFunction {
  return onValues(curves, 1, 0, shift);
}

/** The curves with all values further from their middle by a factor, or nearer to it. */
export function widened(curves: TransferFunction, factor: number): TransferFunction {
  return onValues(curves, factor, middle(spanOfFunction(curves)), 0);
}

/** The curves with all opacities times a factor, and at most 1. */
export function withOpacities(curves: TransferFunction, factor: number): TransferFunction {
  const opacity = curves.opacity.map(([value, alpha]): OpacityPoint => [value, clamped(factor * alpha, 0, 1)]);
  return { ...curves, opacity };
}

/** The curve mirrored about the middle of its values. */
export function mirrored<P extends Point>(curve: Curve<P>): Curve<P> {
  return mapped(curve, -1, middle(spanOf(curve)));
}

/** The look with level and width changed by a drag, in pixels: right is wider, up is higher. Tables stay as they are. */
export function windowed(look: Look, dx: number, dy: number, range: Range): Look {
  const curves = look.transfer_function;
  if (!isEditable(curves)) return look;
  const wide = widened(curves, Math.exp(dx / WIDTH_PX));
  return { ...look, transfer_function: shifted(wide, (-dy / LEVEL_PX) * (range[1] - range[0])) };
}

/** A gradient curve to begin with: boundaries stay, even matter fades. `scale`: a strong gradient of this volume. */
export function firstGradientCurve(scale: number): Curve<OpacityPoint> {
  return [
    [0, 0],
    [0.5 * scale, 1],
  ];
}

/** A value for an isosurface: the first at which the opacity reaches half of its maximum. */
export function surfaceValue(curves: TransferFunction | TransferFunction2D, range: Range): number {
  if (!isEditable(curves)) return middle(range);
  const half = Math.max(...curves.opacity.map(([, alpha]) => alpha)) / 2;
  const next = curves.opacity.findIndex(([, alpha]) => alpha >= half);
  const [a, b] = [curves.opacity[Math.max(0, next - 1)], curves.opacity[next]];
  if (half <= 0 || a === undefined || b === undefined) return middle(range);
  const rise = b[1] - a[1];
  return rise > 0 ? a[0] + ((half - a[1]) / rise) * (b[0] - a[0]) : b[0];
}

/** Points for drawing a curve from `low` to `high`; with more than one piece between points, for scales that bend. */
export function outline(curve: Curve<OpacityPoint>, [low, high]: Range, pieces = 1): OpacityPoint[] {
  const ends = [low, high].map((value): OpacityPoint => [value, at(curve, value)[0] ?? 0]);
  const inside = curve.filter(([value]) => value > low && value < high);
  const [first, last] = ends as [OpacityPoint, OpacityPoint];
  const corners = [first, ...inside, last];
  return corners.flatMap((to, k): OpacityPoint[] => {
    const from = corners[k - 1];
    if (from === undefined || pieces === 1 || from[0] === to[0] || from[1] === to[1]) return [to];
    return Array.from({ length: pieces }, (_, n) => between(from, to, (n + 1) / pieces));
  });
}

export function hexOf([, red, green, blue]: ColorPoint): string {
  const byte = (share: number): string =>
    Math.round(255 * clamped(share, 0, 1))
      .toString(16)
      .padStart(2, "0");
  return `#${byte(red)}${byte(green)}${byte(blue)}`;
}

export function rgbOf(hex: string): [number, number, number] {
  const byte = (start: number): number => parseInt(hex.slice(start, start + 2), 16) / 255;
  return [byte(1), byte(3), byte(5)];
}

export function clamped(value: number, least: number, most: number): number {
  return Math.min(most, Math.max(least, value));
}

export function middle([low, high]: Range): number {
  return (low + high) / 2;
}

function between(a: OpacityPoint, b: OpacityPoint, share: number): OpacityPoint {
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

function onValues(curves: TransferFunction, factor: number, centre: number, shift: number): TransferFunction {
  return {
    ...curves,
    opacity: mapped(curves.opacity, factor, centre, shift),
    color: mapped(curves.color, factor, centre, shift),
  };
}

function valueAt(point: Point): number {
  return point[0] ?? 0;
}
