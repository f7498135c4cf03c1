// Boxes in space: corners, edges, faces, and dragging a handle along an axis. No DOM.

import { add, axesOf, dot, project, ray, scaled, sub, vector, withComponent } from "../../input/camera.ts";
import type { Box, Camera, Clip, Vec3 } from "../../state/state.ts";
import type { CssSize } from "../part.ts";

export interface Face {
  readonly axis: 0 | 1 | 2;
  readonly side: "lower" | "upper";
}

export const FACES: readonly Face[] = ([0, 1, 2] as const).flatMap((axis) => [
  { axis, side: "lower" as const },
  { axis, side: "upper" as const },
]);

/** The eight corners; bit a of a corner's index is set where it lies at the upper end of axis a. */
export function corners(box: Box): Vec3[] {
  return [...Array(8).keys()].map(
    (bits) => vector((axis) => ((bits >> axis) & 1 ? box.upper : box.lower)[axis]),
  );
}

/** Pairs of corners, and the axis along which the edge runs. */
export const EDGES: readonly { readonly a: number; readonly b: number; readonly axis: number }[] = [0, 1, 2].flatMap(
  (axis) =>
    [...Array(8).keys()].filter((bits) => !((bits >> axis) & 1)).map((bits) => ({ a: bits, b: bits | (1 << axis), axis })),
);

export function faceCenter(box: Box, { axis, side }: Face): Vec3 {
  return withComponent(center(box), axis, box[side][axis]);
}

export const center = (box: Box): Vec3 => scaled(add(box.lower, box.upper), 0.5);

/** Whether a face looks towards the eye. */
export function isSeen(box: Box, face: Face, camera: Camera): boolean {
  const outward = withComponent([0, 0, 0], face.axis, face.side === "upper" ? 1 : -1);
  const toEye =
    camera.parallel_scale === undefined ? sub(camera.position, faceCenter(box, face)) : axesOf(camera).back;
  return dot(outward, toEye) > 0;
}

/** Whether an edge lies between two faces that look away. */
export function isHidden(box: Box, edge: (typeof EDGES)[number], camera: Camera): boolean {
  return [0, 1, 2]
    .filter((axis) => axis !== edge.axis)
    .every((axis) => {
      const side = (edge.a >> axis) & 1 ? "upper" : "lower";
      return !isSeen(box, { axis: axis as 0 | 1 | 2, side }, camera);
    });
}

/** Distance, in world units, to move a point along an axis so that its picture comes nearest to a move by (dx, dy). */
export function alongAxis(camera: Camera, size: CssSize, from: Vec3, axis: Vec3, dx: number, dy: number): number {
  const here = project(camera, size, from);
  const there = project(camera, size, add(from, axis));
  if (here === null || there === null) return 0;
  const [ux, uy] = [there.x - here.x, there.y - here.y];
  const square = ux * ux + uy * uy;
  // An axis that is seen end-on has no length in the picture.
  return square < 1e-6 ? 0 : (dx * ux + dy * uy) / square;
}

/** The box with a face moved: at least `least` thick, and inside the bounds. */
export function withFace(box: Box, face: Face, to: number, bounds: readonly [Vec3, Vec3], least: number): Box {
  const { axis, side } = face;
  const [low, high] = [bounds[0][axis], bounds[1][axis]];
  const inside =
    side === "lower"
      ? Math.max(low, Math.min(to, box.upper[axis] - least))
      : Math.min(high, Math.max(to, box.lower[axis] + least));
  return { ...box, [side]: withComponent(box[side], axis, inside) };
}

/** The box moved as a whole, within the bounds. */
export function movedBy(box: Box, by: Vec3, bounds: readonly [Vec3, Vec3]): Box {
  const clamped = vector((a) => Math.min(Math.max(by[a], bounds[0][a] - box.lower[a]), bounds[1][a] - box.upper[a]));
  return { ...box, lower: add(box.lower, clamped), upper: add(box.upper, clamped) };
}

/** World vector, parallel to the plane of the picture, by which a point moves with the pointer. */
export function inPicture(camera: Camera, size: CssSize, from: Vec3, dx: number, dy: number): Vec3 {
  const here = project(camera, size, from);
  if (here === null) return [0, 0, 0];
  const moved = ray(camera, size, here.x + dx, here.y + dy);
  const { back } = axesOf(camera);
  const depth = -dot(sub(from, moved.origin), back) / -dot(moved.direction, back);
  return sub(add(moved.origin, scaled(moved.direction, depth)), from);
}

/** Shares of the picture's upward and right direction in the way to a corner, which choose where the eye looks along an axis. */
const UPWARD = 0.3;
const RIGHTWARD = 0.2;

/** The eighth of a box whose corner is nearest to the eye: of several, that at the top right. */
export function cornerTowards(box: Box, camera: Camera): Box {
  const { right, up, back } = axesOf(camera);
  const way = add(back, add(scaled(up, UPWARD), scaled(right, RIGHTWARD)));
  const middle = center(box);
  const pick = (isLower: boolean): Vec3 =>
    vector((axis) => (way[axis] > 0 === isLower ? middle : isLower ? box.lower : box.upper)[axis]);
  return { ...box, lower: pick(true), upper: pick(false) };
}

/** Index of the box that is kept, or of the one that is cut out, in the list of clips; -1 if there is none. */
export const placeOfBox = (clips: readonly Clip[], kind: "keep" | "cut_out"): number =>
  clips.findIndex((clip) => kind in clip && !isIndexed(boxOf(clip)));

export function boxOf(clip: Clip): Box | null {
  return "keep" in clip ? clip.keep : "cut_out" in clip ? clip.cut_out : null;
}

const isIndexed = (box: Box | null): boolean => box?.space === "index";
