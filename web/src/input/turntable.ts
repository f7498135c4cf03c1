// Turning about an upright axis, and levelling: the horizon stays where it is, however the pointer goes.
// `Camera.turned` of Python is the same about +z; `cameras.json` holds both to it.

import type { Camera, Vec3 } from "../state/state.ts";
import { add, axesOf, cross, dot, length, scaled, sub, turnedAbout, TURN_DEG, unit } from "./camera.ts";

/** Sine of the angle between the line of sight and the upright below which the upright has no place in the picture. */
const END_ON = 1e-3;
const WORLD_AXES: readonly Vec3[] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/**
 * The camera turned as if the object stood on a turntable that follows the pointer: sideways about the `upright`, a unit
 * vector of the world, and up or down about the picture's horizontal until the eye is above or below.
 *
 * The turns about both axes add up, whatever their order: closed ways of the pointer end where they began.
 */
export function turnedUpright(camera: Camera, dx: number, dy: number, height: number, upright: Vec3): Camera {
  const radians = (TURN_DEG * Math.PI) / 180 / height;
  const { right, up, back } = axesOf(camera);
  const across = dot(up, upright);
  // In a picture that is upside down, the near side moves the other way.
  const azimuth = -dx * radians * (across < -END_ON ? -1 : 1);
  const elevation = Math.atan2(dot(back, upright), across);
  const most = Math.PI / 2;
  const wanted = elevation + dy * radians;
  const next = Math.abs(elevation) > most + END_ON ? wanted : Math.min(Math.max(wanted, -most), most);
  const about = (vector: Vec3): Vec3 => turnedAbout(turnedAbout(vector, right, elevation - next), upright, azimuth);
  return {
    ...camera,
    position: add(camera.focal_point, about(sub(camera.position, camera.focal_point))),
    view_up: about(up),
  };
}

/** The camera rolled so that the `upright` is vertical in the picture; end-on, so that an axis of the world is. */
export function leveled(camera: Camera, upright: Vec3): Camera {
  const { up, back } = axesOf(camera);
  if (length(cross(upright, back)) > END_ON) return { ...camera, view_up: inPicture(upright, back) };
  const flat = WORLD_AXES.filter((axis) => length(cross(axis, back)) > 0.5).map((axis) => inPicture(axis, back));
  return { ...camera, view_up: flat.reduce((best, axis) => (dot(axis, up) > dot(best, up) ? axis : best), flat[0] as Vec3) };
}

/** The part of a direction that lies in the plane of the picture, as a unit vector. */
const inPicture = (direction: Vec3, back: Vec3): Vec3 => unit(sub(direction, scaled(back, dot(direction, back))));
