// What is done to the curves of a transfer function. A curve is a list of points, [value, ...rest], in order of value;
// straight between them, constant beyond its ends. Two points at one value make a step. No curve becomes empty.

import type { ColorPoint, Look, OpacityPoint, TransferFunction, TransferFunction2D } from "../../state/state.ts";

export type Point = readonly number[];
export type Curve<P extends Point = Point> = readonly P[];
export type Range = readonly [number, number];

/** A curve, and where in it the point stands that was added or moved. */
export interface Edited<P extends Point> {
  readonly curve: Curve<P>;
  readonly index: number;
}

/** Pixels of a drag that widen by e, and that move by the whole range. */
const WIDTH_PX = 250;
const LEVEL_PX = 500;

export function isEditable(curves: TransferFunction | TransferFunction2D): curves is TransferFunction {
  return !("rgba" in curves);
}

/** All but the value, where a curve is looked up. Of a step, what lies above it. */
export function at(curve: Curve, value: number): number[] {
  const next = curve.findIndex((point) => valueOf(point) > value);
  const right = next < 0 ? curve.length - 1 : next;
  const [a, b] = [curve[next < 0 ? right : Math.max(0, right - 1)], curve[right]];
  if (a === undefined || b === undefined) return [];
  const width = valueOf(b) - valueOf(a);
  const share = width > 0 ? clamped((value - valueOf(a)) / width, 0, 1) : 0;
  return a.slice(1).map((start, k) => start + share * ((b[k + 1] ?? start) - start));
}

/** The curve with one point more, after those of the same value. */
export function withPoint<P extends Point>(curve: Curve<P>, point: P): Edited<P> {
  const next = curve.findIndex((other) => valueOf(other) > valueOf(point));
  const index = next < 0 ? curve.length : next;
  return { curve: [...curve.slice(0, index), point, ...curve.slice(index)], index };
}

/** One point more that changes nothing of the curve's form. */
export function withPointOn<P extends Point>(curve: Curve<P>, value: number): Edited<P> {
  return withPoint(curve, [value, ...at(curve, value)] as Point as P);
}

/** One point more in the middle between a point and the next one, or the one before at the end. */
export function withPointBeside<P extends Point>(curve: Curve<P>, index: number, span: Range): Edited<P> {
  const here = valueOf(curve[index] ?? [middle(span)]);
  const [next, before] = [curve[index + 1], curve[index - 1]];
  if (next !== undefined && valueOf(next) > here) return withPointOn(curve, (here + valueOf(next)) / 2);
  if (before !== undefined && valueOf(before) < here) return withPointOn(curve, (here + valueOf(before)) / 2);
  return withPointOn(curve, here + 0.1 * (span[1] - span[0]));
}

/** A point elsewhere: never beyond its neighbours, all but the value within 0..1. */
export function withMoved<P extends Point>(curve: Curve<P>, index: number, point: P): Curve<P> {
  const least = index > 0 ? valueOf(curve[index - 1] ?? []) : -Infinity;
  const most = index < curve.length - 1 ? valueOf(curve[index + 1] ?? []) : Infinity;
  const moved = [clamped(valueOf(point), least, most), ...point.slice(1).map((share) => clamped(share, 0, 1))];
  return curve.map((other, k) => (k === index ? (moved as Point as P) : other));
}

/** Without a point; the last one stays. */
export function without<P extends Point>(curve: Curve<P>, index: number): Curve<P> {
  return curve.length > 1 ? curve.filter((_, k) => k !== index) : curve;
}

/** Smallest and largest value of the points. */
export function spanOf(...curves: readonly Curve[]): Range {
  const values = curves.flat().map(valueOf);
  return [Math.min(...values), Math.max(...values)];
}

/** Smallest and largest value of all points of a function of the value. */
export function spanOfFunction(curves: TransferFunction): Range {
  return spanOf(curves.opacity, curves.color);
}

/** Values v become centre + factor * (v - centre) + shift; a negative factor turns the order round. */
export function mapped<P extends Point>(curve: Curve<P>, factor: number, centre: number, shift = 0): Curve<P> {
  const points = curve.map((point) => {
    const value = centre + factor * (valueOf(point) - centre) + shift;
    return [value, ...point.slice(1)] as Point as P;
  });
  return factor < 0 ? points.reverse() : points;
}

export function shifted(curves: TransferFunction, shift: number): TransferFunction {
  return onValues(curves, 1, 0, shift);
}

/** All values further from their middle, or nearer to it. */
export function widened(curves: TransferFunction, factor: number): TransferFunction {
  return onValues(curves, factor, middle(spanOfFunction(curves)), 0);
}

/** All opacities by a factor; none above 1. */
export function withOpacities(curves: TransferFunction, factor: number): TransferFunction {
  const opacity = curves.opacity.map(([value, alpha]): OpacityPoint => [value, clamped(factor * alpha, 0, 1)]);
  return { ...curves, opacity };
}

/** Turned round: what was at the smallest value is at the largest one. */
export function mirrored<P extends Point>(curve: Curve<P>): Curve<P> {
  return mapped(curve, -1, middle(spanOf(curve)));
}

/** Level and width by a drag, in pixels: to the right wider, up higher. A function of two dimensions stays as it is. */
export function windowed(look: Look, dx: number, dy: number, range: Range): Look {
  const curves = look.transfer_function;
  if (!isEditable(curves)) return look;
  const wide = widened(curves, Math.exp(dx / WIDTH_PX));
  return { ...look, transfer_function: shifted(wide, (-dy / LEVEL_PX) * (range[1] - range[0])) };
}

/** A gradient curve to begin with: boundaries count, even matter fades. `scale`: a gradient that is strong here. */
export function firstGradientCurve(scale: number): Curve<OpacityPoint> {
  return [
    [0, 0],
    [0.5 * scale, 1],
  ];
}

/** The value from which on a surface stands out: where the opacity reaches half of its largest one. */
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

function valueOf(point: Point): number {
  return point[0] ?? 0;
}
