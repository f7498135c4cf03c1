// The camera between two others, for moves that the eye can follow.

import type { Camera, Vec3 } from "../state/state.ts";
import { add, axesOf, cross, dot, length, scaled, sub, turnedAbout, unit } from "./camera.ts";

/**
 * The camera at a share `t` (0..1) of the way from one to another of the same kind of lens: it turns about one axis by the
 * smaller angle, the focal point goes straight, and distance and scale change by factors.
 */
export function between(from: Camera, to: Camera, t: number): Camera {
  if (t >= 1 || (from.parallel_scale === undefined) !== (to.parallel_scale === undefined)) return to;
  const { axis, angle } = rotation(from, to);
  const { up, back } = axesOf(from);
  const focal = add(from.focal_point, scaled(sub(to.focal_point, from.focal_point), t));
  const away = byFactors(length(sub(from.position, from.focal_point)), length(sub(to.position, to.focal_point)), t);
  const place = {
    version: 1 as const,
    position: add(focal, scaled(turnedAbout(back, axis, angle * t), away)),
    focal_point: focal,
    view_up: turnedAbout(up, axis, angle * t),
  };
  if (from.parallel_scale !== undefined && to.parallel_scale !== undefined) {
    return { ...place, parallel_scale: byFactors(from.parallel_scale, to.parallel_scale, t) };
  }
  return { ...place, view_angle: byFactors(from.view_angle ?? 30, to.view_angle ?? 30, t) };
}

const byFactors = (a: number, b: number, t: number): number => a * (b / a) ** t;

/** The rotation R that turns the axes a of one camera into the axes of another: sum of a x Ra is 2 sin(angle) axis. */
function rotation(from: Camera, to: Camera): { axis: Vec3; angle: number } {
  const [a, b] = [axesOf(from), axesOf(to)];
  const pairs: readonly (readonly [Vec3, Vec3])[] = [[a.up, b.up], [a.right, b.right], [a.back, b.back]];
  const sines = pairs.reduce<Vec3>((sum, [one, other]) => add(sum, cross(one, other)), [0, 0, 0]);
  const cosines = pairs.reduce((sum, [one, other]) => sum + dot(one, other), 0);
  const angle = Math.atan2(length(sines), cosines - 1);
  if (length(sines) > 1e-6) return { axis: unit(sines), angle };
  if (cosines > 0) return { axis: a.up, angle: 0 };
  // Half a turn: a + Ra points along the axis, where it is not zero.
  const sums = pairs.map(([one, other]) => add(one, other));
  return { axis: unit(sums.reduce((best, sum) => (length(sum) > length(best) ? sum : best))), angle: Math.PI };
}
