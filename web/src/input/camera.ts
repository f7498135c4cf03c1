// The camera in the page: turning, panning, zooming, projecting. World units; pixels of CSS, from the top left.
// Same conventions as `python/wavesplat/_model/camera/camera.py`: `parallel_scale` is half the height of the picture.

import type { Camera, Vec3 } from "../state/state.ts";
import type { CssSize } from "../view/part.ts";

/** Degrees that a drag across the height of the view turns by. */
export const TURN_DEG = 180;
const MIN_ANGLE_DEG = 0.01;
const MAX_ANGLE_DEG = 170;

/** The vector whose component along each axis a function gives. */
export const vector = (of: (axis: 0 | 1 | 2) => number): Vec3 => [of(0), of(1), of(2)];
/** The vector with one component replaced. */
export const withComponent = (a: Vec3, axis: number, value: number): Vec3 => vector((b) => (b === axis ? value : a[b]));
export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a: Vec3, factor: number): Vec3 => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const unit = (a: Vec3): Vec3 => scaled(a, 1 / length(a));

/** Unit vectors of the picture: to the right, up, and towards the eye. */
export function axesOf(camera: Camera): { right: Vec3; up: Vec3; back: Vec3 } {
  const back = unit(sub(camera.position, camera.focal_point));
  const right = unit(cross(camera.view_up, back));
  return { right, up: cross(back, right), back };
}

/** A vector turned about a unit axis, by the right-hand rule (Rodrigues' formula). */
export function turnedAbout(vector: Vec3, axis: Vec3, angle: number): Vec3 {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return add(
    add(scaled(vector, cos), scaled(cross(axis, vector), sin)),
    scaled(axis, dot(axis, vector) * (1 - cos)),
  );
}

/**
 * The camera turned freely, as if the object were a ball under the pointer: a drag to the right shows more of its left side.
 * Nothing is upright: closed ways of the pointer leave a roll. See `turnedUpright` for a turntable.
 */
export function turned(camera: Camera, dx: number, dy: number, height: number): Camera {
  const radians = (TURN_DEG * Math.PI) / 180 / height;
  const { right, up } = axesOf(camera);
  const about = (vector: Vec3): Vec3 => turnedAbout(turnedAbout(vector, up, -dx * radians), right, -dy * radians);
  return {
    ...camera,
    position: add(camera.focal_point, about(sub(camera.position, camera.focal_point))),
    view_up: about(up),
  };
}

/** The camera turned about the line of sight; `angle` in radians, the picture turns clockwise. */
export function rolled(camera: Camera, angle: number): Camera {
  const { back, up } = axesOf(camera);
  return { ...camera, view_up: turnedAbout(up, back, angle) };
}

/** World units per pixel at a distance before the eye; in parallel projection everywhere. */
export function unitsPerPixel(camera: Camera, height: number, distance?: number): number {
  if (camera.parallel_scale !== undefined) return (2 * camera.parallel_scale) / height;
  const away = distance ?? length(sub(camera.position, camera.focal_point));
  return (2 * away * Math.tan((((camera.view_angle ?? 30) / 2) * Math.PI) / 180)) / height;
}

/** The camera moved so that the object at the focal point follows the pointer. */
export function panned(camera: Camera, dx: number, dy: number, height: number): Camera {
  const { right, up } = axesOf(camera);
  const pixel = unitsPerPixel(camera, height);
  const way = add(scaled(right, -dx * pixel), scaled(up, dy * pixel));
  return { ...camera, position: add(camera.position, way), focal_point: add(camera.focal_point, way) };
}

/** The camera with a view magnified by a factor: by the scale, or in perspective by coming nearer. */
export function zoomed(camera: Camera, factor: number): Camera {
  if (camera.parallel_scale !== undefined) return { ...camera, parallel_scale: camera.parallel_scale / factor };
  const away = sub(camera.position, camera.focal_point);
  return { ...camera, position: add(camera.focal_point, scaled(away, 1 / factor)) };
}

/** The camera with a view magnified by a factor about a place of the view, in pixels: what is seen there stays there. */
export function zoomedAt(camera: Camera, size: CssSize, factor: number, x: number, y: number): Camera {
  const { right, up } = axesOf(camera);
  const pixel = unitsPerPixel(camera, size.height);
  const aside = add(scaled(right, (x - size.width / 2) * pixel), scaled(up, (size.height / 2 - y) * pixel));
  // Everything shrinks towards the point under the pointer; its ray stays the same line.
  const way = scaled(aside, 1 - 1 / factor);
  const { position, focal_point, ...lens } = zoomed(camera, factor);
  return { ...lens, position: add(position, way), focal_point: add(focal_point, way) };
}

/** The same view with another lens: a view angle in degrees, or undefined for parallel projection. */
export function withLens(camera: Camera, angle: number | undefined): Camera {
  const { parallel_scale: _scale, view_angle: _angle, ...place } = camera;
  const { back } = axesOf(camera);
  const half = unitsPerPixel(camera, 2);
  if (angle === undefined) return { ...place, parallel_scale: half };
  const bounded = Math.min(Math.max(angle, MIN_ANGLE_DEG), MAX_ANGLE_DEG);
  const away = half / Math.tan(((bounded / 2) * Math.PI) / 180);
  return { ...place, position: add(camera.focal_point, scaled(back, away)), view_angle: bounded };
}

/** Position of a world point in the view, and its depth before the eye; null for a point behind the eye, in perspective. */
export function project(camera: Camera, size: CssSize, point: Vec3): { x: number; y: number; depth: number } | null {
  const { right, up, back } = axesOf(camera);
  const away = sub(point, camera.position);
  const depth = -dot(away, back);
  if (camera.parallel_scale === undefined && depth <= 0) return null;
  const pixel = unitsPerPixel(camera, size.height, depth);
  return { x: size.width / 2 + dot(away, right) / pixel, y: size.height / 2 - dot(away, up) / pixel, depth };
}

/** The ray through a place of the view; `direction` is a unit vector. */
export function ray(camera: Camera, size: CssSize, x: number, y: number): { origin: Vec3; direction: Vec3 } {
  const { right, up, back } = axesOf(camera);
  const pixel = unitsPerPixel(camera, size.height, 1);
  const aside = add(scaled(right, (x - size.width / 2) * pixel), scaled(up, (size.height / 2 - y) * pixel));
  if (camera.parallel_scale !== undefined) return { origin: add(camera.position, aside), direction: scaled(back, -1) };
  return { origin: camera.position, direction: unit(sub(aside, back)) };
}

/** The camera at a direction (unit, from the focal point to the eye), at the same distance and scale. */
export function seenFrom(camera: Camera, direction: Vec3, viewUp: Vec3): Camera {
  const away = length(sub(camera.position, camera.focal_point));
  return { ...camera, position: add(camera.focal_point, scaled(direction, away)), view_up: viewUp };
}
