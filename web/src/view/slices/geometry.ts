// Slices in the page: from pixels to the world and back, lines where planes meet, tilting. No DOM.

import type { SliceGeometry } from "../../engine/engine.ts";
import { add, cross, dot, length, scaled, sub, turnedAbout, unit, vector } from "../../input/camera.ts";
import { PANES, type Pane, type Vec3, type ViewerState } from "../../state/state.ts";
import type { CssSize } from "../part.ts";

/** Pixels of the frame per CSS pixel. */
export interface SliceFrame {
  readonly geometry: SliceGeometry;
  /** CSS pixels. */
  readonly size: CssSize;
  /** Pixels of the frame. */
  readonly width: number;
  readonly height: number;
}

const AXES: Readonly<Record<Pane, Vec3>> = { z: [0, 0, 1], y: [0, 1, 0], x: [1, 0, 0] };

/** The unit normal of a pane's plane. */
export function normalOf(state: ViewerState, pane: Pane): Vec3 {
  const tilted = state.view.slices.normals?.[pane];
  return tilted === undefined ? AXES[pane] : unit(tilted);
}

/** The world point at a place of the view, in CSS pixels. */
export function worldAt({ geometry, size, width, height }: SliceFrame, x: number, y: number): Vec3 {
  // The first pixel's centre is half a pixel inside.
  const [column, row] = [(x / size.width) * width - 0.5, (y / size.height) * height - 0.5];
  const across = scaled(geometry.right, column * geometry.pixel);
  return add(geometry.origin, add(across, scaled(geometry.down, row * geometry.pixel)));
}

/** Position of a world point in the view, in CSS pixels, and its distance from the plane, `away`, in world units. */
export function placeOf(frame: SliceFrame, point: Vec3): { x: number; y: number; away: number } {
  const { geometry, size, width, height } = frame;
  const from = sub(point, geometry.origin);
  const column = dot(from, geometry.right) / geometry.pixel;
  const row = dot(from, geometry.down) / geometry.pixel;
  return {
    x: ((column + 0.5) / width) * size.width,
    y: ((row + 0.5) / height) * size.height,
    away: Math.abs(dot(from, unit(geometry.normal))),
  };
}

/**
 * A frame as the newest state has it: its magnification, its middle (world) and its plane, before the next frame comes.
 * Planes that were tilted since stay as the frame shows them.
 */
export function newest(frame: SliceFrame, state: ViewerState, pane: Pane, middle: Vec3): SliceFrame {
  const { geometry, width, height } = frame;
  const { right, down, range } = geometry;
  const normal = unit(geometry.normal);
  if (dot(normal, normalOf(state, pane)) < 1 - 1e-9) return frame;
  const pixel = (geometry.pixel * geometry.zoom) / state.view.slices.zoom;
  const along = Math.min(Math.max(dot(state.view.slices.crosshair, normal), range[0]), range[1]);
  const column = dot(middle, right) - ((width - 1) / 2) * pixel;
  const row = dot(middle, down) - ((height - 1) / 2) * pixel;
  const origin = add(add(scaled(right, column), scaled(down, row)), scaled(normal, along));
  return { ...frame, geometry: { ...geometry, origin, pixel, zoom: state.view.slices.zoom, position: along } };
}

/** CSS transform of the picture of one frame to its place in another one of the same plane. */
export function transformOf(from: SliceFrame, to: SliceFrame): string {
  const scale = from.geometry.pixel / to.geometry.pixel;
  const { x, y } = placeOf(to, worldAt(from, 0, 0));
  const isSame = Math.abs(scale - 1) < 1e-6 && Math.hypot(x, y) < 0.01;
  return isSame ? "" : `matrix(${scale}, 0, 0, ${scale}, ${x}, ${y})`;
}

/** The direction, in CSS pixels, of the line in which another plane cuts the slice; null where they are parallel. */
export function lineOf(frame: SliceFrame, other: Vec3): { dx: number; dy: number } | null {
  const along = cross(frame.geometry.normal, other);
  if (length(along) < 1e-6) return null;
  const [dx, dy] = [dot(along, frame.geometry.right), dot(along, frame.geometry.down)];
  const norm = Math.hypot(dx, dy);
  return norm < 1e-9 ? null : { dx: dx / norm, dy: dy / norm };
}

/** Another plane's normal, turned so that its line in the slice has the direction (dx, dy), in CSS pixels. */
export function tilted(frame: SliceFrame, other: Vec3, dx: number, dy: number): Vec3 {
  const before = lineOf(frame, other);
  if (before === null || (dx === 0 && dy === 0)) return other;
  const { right, down, normal } = frame.geometry;
  let angle = Math.atan2(dy, dx) - Math.atan2(before.dy, before.dx);
  // A line runs both ways, so the smaller of both turns is taken.
  if (angle > Math.PI / 2) angle -= Math.PI;
  if (angle < -Math.PI / 2) angle += Math.PI;
  // Angles grow clockwise in the picture: a right-handed turn about the cross product of right and down.
  const axis = unit(cross(right, down));
  const sign = Math.sign(dot(axis, normal)) || 1;
  return unit(turnedAbout(other, scaled(normal, sign), angle * (Math.sign(dot(axis, scaled(normal, sign))) || 1)));
}

/** The crosshair moved along a pane's normal by a distance, and kept within the range. */
export function stepped(state: ViewerState, pane: Pane, distance: number, range: readonly [number, number]): Vec3 {
  const normal = normalOf(state, pane);
  const { crosshair } = state.view.slices;
  const now = dot(normal, crosshair);
  const next = Math.min(Math.max(now + distance, range[0]), range[1]);
  return add(crosshair, scaled(normal, next - now));
}

/** Distance of sample planes along a direction, by the index axis nearest to it, in world units: the step of a slice. */
export function sampleStep(affine: readonly (readonly number[])[], direction: Vec3): number {
  const column = (axis: number): Vec3 => vector((row) => affine[row]?.[axis] ?? 0);
  const shares = [0, 1, 2].map((axis) => {
    const step = column(axis);
    const size = length(step);
    return { size, share: Math.abs(dot(step, direction)) / size };
  });
  const best = shares.reduce((a, b) => (b.share > a.share ? b : a));
  return best.size * best.share;
}

/** A round length for a scale bar: the largest of 1, 2 and 5 times powers of ten that is at most `longest`. */
export function barLength(longest: number): number {
  const power = 10 ** Math.floor(Math.log10(longest));
  const lead = longest / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

/** The other two panes. */
export const othersOf = (pane: Pane): readonly Pane[] => PANES.filter((one) => one !== pane);

/** The angle at the second of three points, degrees. */
export function angleDeg(points: readonly Vec3[]): number {
  const [a, b, c] = points as readonly [Vec3, Vec3, Vec3];
  const [from, to] = [sub(a, b), sub(c, b)];
  const cos = dot(from, to) / (length(from) * length(to));
  return (Math.acos(Math.min(1, Math.max(-1, cos))) * 180) / Math.PI;
}

export const distance = (points: readonly Vec3[]): number => length(sub(points[1] as Vec3, points[0] as Vec3));

/** Area of a plane polygon by its corners, in squared world units: half the length of the sum of their cross products. */
export function areaOf(points: readonly Vec3[]): number {
  const first = points[0] as Vec3;
  const sum = points.reduce<Vec3>(
    (total, point, n) => add(total, cross(sub(point, first), sub(points[(n + 1) % points.length] as Vec3, first))),
    [0, 0, 0],
  );
  return length(sum) / 2;
}
