// Places of handles in the picture: inside of the view, and so far apart that each one can be grasped. No DOM.

import { add, axesOf, cross, dot, project, scaled, sub, unit, unitsPerPixel } from "../../input/camera.ts";
import type { Box, Camera, Clip, Vec3 } from "../../state/state.ts";
import type { CssSize } from "../part.ts";
import { boxOf, center, faceCenter, FACES, isSeen, placeOfBox, type Face } from "./box.ts";

/** Least distance between two handles, and between a handle and the edge of the view, CSS pixels. */
export const APART_PX = 24;
const EDGE_PX = 14;
/** Distance from the middle of a plane's square to its sides, CSS pixels. */
const ARM_PX = 90;

export interface Place {
  readonly x: number;
  readonly y: number;
}

/** The place, moved into the view where it lies outside of it. */
export function inside({ x, y }: Place, { width, height }: CssSize): Place {
  const clamp = (value: number, side: number): number => Math.min(Math.max(value, Math.min(EDGE_PX, side / 2)), Math.max(side - EDGE_PX, side / 2));
  return { x: clamp(x, width), y: clamp(y, height) };
}

/** The square that is drawn of a plane: its normal, half a side, and two directions along its sides, the first as upright as can be. */
export function squareOf(plane: { readonly point: Vec3; readonly normal: Vec3 }, camera: Camera, size: CssSize) {
  const at = project(camera, size, plane.point);
  if (at === null) return null;
  const normal = unit(plane.normal);
  const { right, up } = axesOf(camera);
  const first = unit(Math.abs(dot(up, normal)) < 0.99 ? sub(up, scaled(normal, dot(up, normal))) : sub(right, scaled(normal, dot(right, normal))));
  const second = cross(normal, first);
  const arm = ARM_PX * unitsPerPixel(camera, size.height, at.depth);
  const ends = [add(plane.point, scaled(first, arm)), add(plane.point, scaled(second, arm))] as const;
  return { at, normal, arm, first, second, ends };
}

/** The name of a handle among those of all clips. */
export const handleName = (clip: number, part: "middle" | Face | number): string =>
  `${clip} ${typeof part === "object" ? `${part.axis}${part.side}` : part}`;

/**
 * The handles of clips that are shown, with their places in the view. Of handles that lie on one another one is shown: what
 * moves a plane before what moves a box, a box before its faces (a face that looks at the eye cannot be dragged), faces that are
 * seen before others, and what tilts a plane last.
 */
export function handlePlaces(clips: readonly Clip[], camera: Camera, size: CssSize): Map<string, Place> {
  const shown = new Map<string, Place>();
  const add = (name: string, point: Vec3): void => {
    const at = project(camera, size, point);
    if (at === null) return;
    const place = inside(at, size);
    const isFree = [...shown.values()].every(({ x, y }) => Math.hypot(x - place.x, y - place.y) >= APART_PX);
    if (isFree) shown.set(name, place);
  };
  const planes = clips.flatMap((clip, n) => ("plane" in clip ? [{ n, plane: clip.plane }] : []));
  const boxes = (["keep", "cut_out"] as const).flatMap((kind): { n: number; box: Box }[] => {
    const n = placeOfBox(clips, kind);
    const clip = clips[n];
    const box = clip === undefined ? null : boxOf(clip);
    return box === null ? [] : [{ n, box }];
  });
  for (const { n, plane } of planes) add(handleName(n, "middle"), plane.point);
  for (const { n, box } of boxes) add(handleName(n, "middle"), center(box));
  for (const wanted of [true, false]) {
    for (const { n, box } of boxes) {
      for (const face of FACES) if (isSeen(box, face, camera) === wanted) add(handleName(n, face), faceCenter(box, face));
    }
  }
  for (const { n, plane } of planes) squareOf(plane, camera, size)?.ends.forEach((end, k) => add(handleName(n, k), end));
  return shown;
}
