// Cameras that stay upright, magnify about the pointer and go from one to another; the cube, and the corner that is cut.

import { describe, expect, test } from "vitest";

import * as cameras from "../src/input/camera.ts";
import { between } from "../src/input/camera_path.ts";
import { leveled, turnedUpright } from "../src/input/turntable.ts";
import type { Camera, Vec3 } from "../src/state/state.ts";
import { CUBE_PLACES } from "../src/view/overlay3d/cube_places.ts";
import { cornerTowards } from "../src/view/overlay3d/box.ts";

const FRONT: Camera = { version: 1, position: [0, 100, 0], focal_point: [0, 0, 0], view_up: [0, 0, 1], parallel_scale: 50 };
const LENS: Camera = cameras.withLens({ ...FRONT, position: [30, 60, 45], focal_point: [3, -4, 5] }, 35);
const Z: Vec3 = [0, 0, 1];
const SIZE = { width: 640, height: 480 };
const near = (a: readonly number[], b: readonly number[], digits = 9): void =>
  a.forEach((value, n) => expect(value).toBeCloseTo(b[n] ?? NaN, digits));

/** Turns along circles of 60 px in steps of 6 degrees. */
function circles(camera: Camera, n: number, turn: (camera: Camera, dx: number, dy: number) => Camera): Camera {
  const at = (step: number): readonly [number, number] => [60 * Math.sin((step * Math.PI) / 30), 60 * Math.cos((step * Math.PI) / 30)];
  for (let step = 0; step < 60 * n; step += 1) {
    const [[x0, y0], [x1, y1]] = [at(step), at(step + 1)];
    camera = turn(camera, x1 - x0, y1 - y0);
  }
  return camera;
}

describe("the turntable", () => {
  const turn = (camera: Camera, dx: number, dy: number): Camera => turnedUpright(camera, dx, dy, SIZE.height, Z);
  test("stays upright in circles, where the trackball rolls", () => {
    near(circles(FRONT, 3, turn).view_up, Z);
    near(circles(FRONT, 3, turn).position, FRONT.position, 6);
    const free = circles(FRONT, 3, (camera, dx, dy) => cameras.turned(camera, dx, dy, SIZE.height));
    expect(cameras.dot(free.view_up, Z)).toBeLessThan(Math.cos(0.3));
  });
  test("keeps the horizon level on any way, and a roll that is there", () => {
    let camera = LENS;
    for (let n = 0; n < 200; n += 1) {
      camera = turn(camera, 17 * Math.sin(n), 23 * Math.cos(1.7 * n));
      const { right, up } = cameras.axesOf(camera);
      expect(Math.abs(cameras.dot(right, Z))).toBeLessThan(1e-9);
      expect(cameras.dot(up, Z)).toBeGreaterThan(-1e-9);
    }
    const rolled = cameras.rolled(FRONT, 0.4);
    near(circles(rolled, 2, turn).view_up, cameras.axesOf(rolled).up, 6);
  });
  test("ends above and below, and turns there about the line of sight", () => {
    const top = turn(FRONT, 0, 1e4);
    near(cameras.axesOf(top).back, Z);
    near(cameras.axesOf(turn(top, 40, 30)).back, Z);
    const below = turn(top, 0, -1e4);
    near(cameras.axesOf(below).back, [0, 0, -1]);
  });
  test("follows the pointer, also upside down", () => {
    for (const camera of [FRONT, cameras.rolled(FRONT, Math.PI)]) {
      const seen = cameras.project(turn(camera, 10, 4), SIZE, [0, 20, 0]);
      expect(seen?.x ?? 0).toBeGreaterThan(SIZE.width / 2);
      expect(seen?.y ?? 0).toBeGreaterThan(SIZE.height / 2);
    }
  });
  test("has its own upright for stacks that are seen along z, row 0 on top", () => {
    const stack: Camera = { ...FRONT, position: [0, 0, -100], view_up: [0, -1, 0] };
    const turned = turnedUpright(stack, 50, 20, SIZE.height, [0, -1, 0]);
    expect(Math.abs(cameras.axesOf(turned).right[1])).toBeLessThan(1e-9);
    expect(cameras.axesOf(turned).back[2]).toBeGreaterThan(-0.95);
  });
  test("is level again after a roll, and end-on by the nearest axis", () => {
    near(leveled(cameras.rolled(FRONT, 1.2), Z).view_up, Z);
    const top = turn(FRONT, 0, 1e4);
    near(leveled(cameras.rolled(top, 0.3), Z).view_up, top.view_up);
    near(leveled(cameras.rolled(top, 1.3), Z).view_up, [1, 0, 0]);
  });
});

test.each([FRONT, LENS])("the wheel magnifies about the pointer", (camera) => {
  for (const factor of [1.15, 3, 0.2]) {
    const zoomed = cameras.zoomedAt(camera, SIZE, factor, 480, 130);
    const { origin, direction } = cameras.ray(camera, SIZE, 480, 130);
    const focal = cameras.length(cameras.sub(camera.position, camera.focal_point));
    // Every point that was seen there, at the depth of the focal point and beyond it.
    for (const away of [focal, 3 * focal]) {
      const place = cameras.project(zoomed, SIZE, cameras.add(origin, cameras.scaled(direction, away)));
      near([place?.x ?? NaN, place?.y ?? NaN], [480, 130], 6);
    }
    const pixel = cameras.unitsPerPixel(camera, SIZE.height) / cameras.unitsPerPixel(zoomed, SIZE.height);
    expect(pixel).toBeCloseTo(factor, 9);
  }
});

describe("between two cameras", () => {
  const left: Camera = { ...FRONT, position: [-90, 10, 7], focal_point: [10, 10, 7], parallel_scale: 20 };
  test("the ends are the ends", () => {
    for (const [a, b] of [[FRONT, left], [LENS, { ...LENS, position: [3, -100, 5] as Vec3 }]] as const) {
      near(between(a, b, 0).position, a.position, 6);
      near(between(a, b, 1 - 1e-12).position, b.position, 6);
      near(between(a, b, 1 - 1e-12).view_up, cameras.axesOf(b).up, 6);
      expect(between(a, b, 1)).toBe(b);
    }
  });
  test("it turns by equal angles, and magnifies by equal factors", () => {
    const middle = between(FRONT, left, 0.5);
    expect(cameras.dot(cameras.axesOf(middle).back, cameras.axesOf(FRONT).back)).toBeCloseTo(Math.SQRT1_2, 9);
    expect(middle.parallel_scale).toBeCloseTo(Math.sqrt(1000), 9);
    near(middle.view_up, Z);
  });
  test("half a turn goes round, not through", () => {
    const back: Camera = { ...FRONT, position: [0, -100, 0] };
    const middle = between(FRONT, back, 0.5);
    expect(cameras.length(middle.position)).toBeCloseTo(100, 6);
    near(middle.view_up, Z);
    near(between(FRONT, FRONT, 0.5).position, FRONT.position);
  });
  test("another kind of lens comes at once", () => expect(between(FRONT, LENS, 0.1)).toBe(LENS));
});

describe("the cube", () => {
  test("has 26 places, whose polygons close it and look outwards", () => {
    expect(CUBE_PLACES.map(({ ends }) => ends.length).sort()).toEqual([...Array(6).fill(1), ...Array(12).fill(2), ...Array(8).fill(3)]);
    expect(new Set(CUBE_PLACES.map(({ ends }) => ends.join())).size).toBe(26);
    const edges = new Map<string, number>();
    for (const { outline, outward } of CUBE_PLACES) {
      outline.forEach((point, n) => {
        expect(cameras.dot(point, outward)).toBeCloseTo(cameras.dot(outline[0] as Vec3, outward), 9);
        expect(cameras.dot(point, outward)).toBeGreaterThan(0.5);
        const ends = [point, outline[(n + 1) % outline.length] as Vec3].map((one) => one.map((x) => x.toFixed(3)).join()).sort();
        edges.set(ends.join("|"), (edges.get(ends.join("|")) ?? 0) + 1);
      });
    }
    // Each edge belongs to two polygons: 24 of faces, and 24 between edges and corners.
    expect(edges.size).toBe(48);
    expect(new Set(edges.values())).toEqual(new Set([2]));
  });
});

test("the corner that is cut out lies on the side from which one looks", () => {
  const box = { lower: [0, 0, 0] as Vec3, upper: [2, 4, 6] as Vec3, space: "world" as const };
  const seen = (position: Vec3, view_up: Vec3 = Z) => cornerTowards(box, { ...FRONT, position, view_up });
  expect(seen([0, 100, 0])).toEqual({ lower: [0, 2, 3], upper: [1, 4, 6], space: "world" });
  expect(seen([0, -100, 0])).toEqual({ lower: [1, 0, 3], upper: [2, 2, 6], space: "world" });
  expect(seen([60, 50, -70])).toEqual({ lower: [1, 2, 0], upper: [2, 4, 3], space: "world" });
  expect(seen([0, 0, -100], [0, -1, 0])).toEqual({ lower: [1, 0, 0], upper: [2, 2, 3], space: "world" });
});
