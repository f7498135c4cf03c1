// The places of a bevelled cube: six faces, twelve edges, eight corners, each a direction from which one can look. No DOM.

import { unit, vector } from "../../input/camera.ts";
import type { Vec3 } from "../../state/state.ts";

/** Width of the bevel, in half edges of the cube. */
const BEVEL = 0.3;

export interface CubePlace {
  /** Unit vector from the cube's middle to the eye. */
  readonly outward: Vec3;
  /** Ends of the world's axes that meet there, as indices of `axis_ends`: -x, +x, -y, +y, -z, +z. */
  readonly ends: readonly number[];
  /** Corners of its polygon, in half edges of the cube, in order around it. */
  readonly outline: readonly Vec3[];
}

/** The 26 places: directions with coordinates -1, 0 and 1 of which not all are 0. */
export const CUBE_PLACES: readonly CubePlace[] = [-1, 0, 1]
  .flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z): Vec3 => [x, y, z])))
  .filter((direction) => direction.some((part) => part !== 0))
  .map((direction) => ({
    outward: unit(direction),
    ends: direction.flatMap((part, axis) => (part === 0 ? [] : [2 * axis + (part > 0 ? 1 : 0)])),
    outline: outlineOf(direction),
  }));

/**
 * Faces are squares, edges rectangles between two faces, corners triangles between three. On a face at the end of an axis
 * lie the points of which that coordinate is 1 and the others are at most 1 less the bevel.
 */
function outlineOf(direction: Vec3): readonly Vec3[] {
  const inner = 1 - BEVEL;
  const used = [0, 1, 2].filter((axis) => direction[axis] !== 0);
  const free = [0, 1, 2].filter((axis) => direction[axis] === 0);
  const point = (on: number, signs: readonly number[]): Vec3 =>
    vector((axis) =>
      axis === on ? direction[axis] : inner * (direction[axis] || (signs[free.indexOf(axis)] ?? 0)),
    );
  const [a = 0, b = 0] = used;
  if (used.length === 3) return used.map((axis) => point(axis, []));
  if (used.length === 2) return [point(a, [1]), point(b, [1]), point(b, [-1]), point(a, [-1])];
  return [point(a, [1, 1]), point(a, [1, -1]), point(a, [-1, -1]), point(a, [-1, 1])];
}
