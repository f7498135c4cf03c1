// The parts of the page without a page: patches, messages, cameras, gestures, links.

import { readFileSync } from "node:fs";

import { describe, expect, test } from "vitest";

import { bytesOf } from "../src/engine/channel_comm.ts";
import type { Frame } from "../src/engine/engine.ts";
import { packed, unpacked } from "../src/engine/framing.ts";
import * as cameras from "../src/input/camera.ts";
import { Gestures, wheelFactor, type Gesture, type PointerLike } from "../src/input/gestures.ts";
import { actionOf, keyName, KEYS } from "../src/input/keys.ts";
import { turnedUpright } from "../src/input/turntable.ts";
import { fromLink, linkPart } from "../src/state/link.ts";
import { patched, pathOf, set, type Operation } from "../src/state/patch.ts";
import type { Camera, Vec3, ViewerState } from "../src/state/state.ts";
import { instant } from "../src/view/scene_view.tsx";
import { FrameStatistics } from "../src/view/frame_statistics.ts";
import * as slices from "../src/view/slices/geometry.ts";

const read = (name: string): unknown => JSON.parse(readFileSync(new URL(`../schema/${name}`, import.meta.url), "utf8"));

describe("patches", () => {
  const cases = read("patches.json") as Record<"good" | "bad", { before: unknown; operations: Operation[]; after: unknown }[]>;
  test.each(cases.good)("$operations", ({ before, operations, after }) => {
    const kept = JSON.stringify(before);
    expect(JSON.stringify(patched(before, operations))).toBe(JSON.stringify(after));
    expect(JSON.stringify(before)).toBe(kept);
  });
  test.each(cases.bad)("refused: $operations", ({ before, operations }) => {
    if ((operations[0]?.op as string) === "move") return;
    expect(() => patched(before, operations)).toThrow("patch: operations[0]");
  });
  test("share what they do not touch", () => {
    const before = { a: { deep: 1 }, b: [1, 2] };
    const after = patched(before, [set(5, "b", 0)]);
    expect(after.a).toBe(before.a);
    expect(after.b).toEqual([5, 2]);
    expect(pathOf("a/b", 0, "c~d")).toBe("/a~1b/0/c~0d");
  });
});

test("messages go and come", () => {
  for (let n = 0; n < 200; n += 1) {
    const payload = Uint8Array.from({ length: n }, (_, k) => (k * 37 + n) % 256);
    const message = packed({ type: "frame", n, text: "Grüße" }, payload);
    const { header, payload: back } = unpacked(message.buffer);
    expect(header).toEqual({ type: "frame", n, text: "Grüße" });
    expect([...back]).toEqual([...payload]);
  }
  expect(() => unpacked(new ArrayBuffer(2))).toThrow("message");
  expect(() => unpacked(Uint8Array.from([255, 0, 0, 0, 1]).buffer)).toThrow("message");
  expect(() => unpacked(Uint8Array.from([2, 0, 0, 0, 91, 93]).buffer)).toThrow("object");
});

test("buffers of all hosts are bytes", () => {
  const bytes = Uint8Array.from([9, 8, 7, 6]);
  expect([...bytesOf(new DataView(bytes.buffer, 1, 2))]).toEqual([8, 7]);
  expect([...bytesOf(bytes.buffer)]).toEqual([9, 8, 7, 6]);
  expect([...bytesOf("CQgHBg==")]).toEqual([9, 8, 7, 6]);
  expect(() => bytesOf(5)).toThrow(TypeError);
});

const CAMERA: Camera = { version: 1, position: [0, 100, 0], focal_point: [0, 0, 0], view_up: [0, 0, 1], parallel_scale: 50 };
const near = (a: readonly number[], b: readonly number[], digits = 9): void =>
  a.forEach((value, n) => expect(value).toBeCloseTo(b[n] ?? NaN, digits));

describe("cameras", () => {
  const fixtures = read("cameras.json") as { camera: Camera; steps: { what: string; numbers: number[]; camera: Camera }[]; points: { size: [number, number]; point: Vec3; place: number[] }[] }[];
  test.each(fixtures.map((fixture, n) => ({ ...fixture, n })))("$n are those of Python", ({ camera, steps, points }) => {
    for (const { what, numbers, camera: expected } of steps) {
      const [a = 0, b = 0] = numbers;
      const found = what === "upright" ? turnedUpright(camera, a, b, 180, [0, 0, 1])
        : what === "turned" ? cameras.turned(camera, a, b, 180) : what === "zoomed" ? cameras.zoomed(camera, a) : cameras.rolled(camera, (-a * Math.PI) / 180);
      near(found.position, expected.position, 6);
      const [up, wanted] = [cameras.axesOf(found).up, cameras.axesOf(expected).up];
      near(up, wanted, 6);
      if (expected.parallel_scale !== undefined) expect(found.parallel_scale).toBeCloseTo(expected.parallel_scale, 9);
    }
    for (const { size: [width, height], point, place } of points) {
      const found = cameras.project(camera, { width, height }, point);
      near([found?.x ?? NaN, found?.y ?? NaN], place, 6);
    }
  });
  test("rays go through the places of what they hit", () => {
    const size = { width: 300, height: 200 };
    for (const camera of [CAMERA, cameras.withLens(CAMERA, 40)]) {
      const { origin, direction } = cameras.ray(camera, size, 40, 170);
      const at = cameras.project(camera, size, cameras.add(origin, cameras.scaled(direction, 77)));
      near([at?.x ?? NaN, at?.y ?? NaN], [40, 170], 6);
    }
  });
  test("what is dragged stays under the pointer", () => {
    const size = { width: 300, height: 200 };
    const before = cameras.project(CAMERA, size, [0, 0, 0]);
    const after = cameras.project(cameras.panned(CAMERA, 30, -12, size.height), size, [0, 0, 0]);
    near([(after?.x ?? 0) - (before?.x ?? 0), (after?.y ?? 0) - (before?.y ?? 0)], [30, -12]);
    // A point in front of the middle follows the pointer in a turn.
    const turned = cameras.project(cameras.turned(CAMERA, 10, 4, size.height), size, [0, 20, 0]);
    expect(turned?.x ?? 0).toBeGreaterThan(150);
    expect(turned?.y ?? 0).toBeGreaterThan(100);
  });
  test("frames are moved as the next one will be", () => {
    const size = { width: 300, height: 200 };
    const moved = cameras.rolled(cameras.zoomed(cameras.panned(CAMERA, 20, 10, 200), 1.5), 0.3);
    const [a, b, c, d, e, f] = instant({ camera: CAMERA } as unknown as Frame, moved, size).slice(7, -1).split(",").map(Number) as [number, number, number, number, number, number];
    for (const point of [[3, 0, 5], [-20, 7, 11], [0, 0, 0]] as Vec3[]) {
      const [old, now] = [cameras.project(CAMERA, size, point), cameras.project(moved, size, point)];
      near([a * (old?.x ?? 0) + c * (old?.y ?? 0) + e, b * (old?.x ?? 0) + d * (old?.y ?? 0) + f], [now?.x ?? NaN, now?.y ?? NaN], 3);
    }
    expect(instant({ camera: CAMERA } as unknown as Frame, cameras.turned(CAMERA, 5, 0, 200), size)).toBe("");
  });
});

describe("gestures", () => {
  const pointer = (more: Partial<PointerLike> = {}): PointerLike => ({
    pointerId: 1, pointerType: "mouse", button: 0, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, timeStamp: 0, ...more,
  });
  const run = (act: (gestures: Gestures) => void): Gesture[] => {
    const seen: Gesture[] = [];
    act(new Gestures((gesture) => seen.push(gesture)));
    return seen;
  };
  test.each([
    [{}, "main"], [{ shiftKey: true }, "pan"], [{ button: 1 }, "pan"], [{ button: 2 }, "zoom"], [{ ctrlKey: true }, "roll"], [{ altKey: true }, "window"],
  ] as const)("%o drags %s", (more, what) => {
    const seen = run((gestures) => {
      gestures.down(pointer(more), 10, 10);
      gestures.move(pointer(more), 12, 11);
      gestures.move(pointer(more), 20, 10);
      gestures.move(pointer(more), 25, 12);
      gestures.up(pointer(more), 25, 12);
    });
    expect(seen.map((gesture) => "phase" in gesture && gesture.phase)).toEqual(["start", "move", "move", "end"]);
    expect(seen[1]).toMatchObject({ what, dx: 10, dy: 0 });
    expect(seen[2]).toMatchObject({ dx: 5, dy: 2 });
  });
  test("taps, also double ones", () => {
    const seen = run((gestures) => {
      for (const timeStamp of [0, 100, 2000]) {
        gestures.down(pointer({ timeStamp }), 10, 10);
        gestures.up(pointer({ timeStamp }), 11, 10);
      }
    });
    expect(seen.map((gesture) => gesture.kind === "tap" && gesture.double)).toEqual([false, true, false]);
  });
  test("two fingers move, magnify and roll", () => {
    const seen = run((gestures) => {
      gestures.down(pointer({ pointerId: 1, pointerType: "touch" }), 0, 0);
      gestures.down(pointer({ pointerId: 2, pointerType: "touch" }), 10, 0);
      gestures.move(pointer({ pointerId: 2, pointerType: "touch" }), 0, 20);
      gestures.up(pointer({ pointerId: 1 }), 0, 0);
      gestures.up(pointer({ pointerId: 2 }), 0, 20);
    });
    expect(seen[0]).toMatchObject({ kind: "pinch", factor: 2, x: 0, y: 10, dx: -5, dy: 10 });
    expect(seen[0]?.kind === "pinch" && seen[0].angle).toBeCloseTo(Math.PI / 2);
    expect(seen.at(-1)).toMatchObject({ kind: "pinch", phase: "end" });
  });
  test("wheels of all modes", () => {
    expect(wheelFactor(-100, 0)).toBeCloseTo(1.15);
    expect(wheelFactor(3, 1)).toBeLessThan(1);
    expect(wheelFactor(1e9, 0)).toBeCloseTo(1.15 ** -3);
  });
});

test("no key stands for two things", () => {
  const all = KEYS.flatMap(({ keys }) => keys);
  expect(new Set(all).size).toBe(all.length);
  const press = (key: string, more = {}): string => keyName({ key, ctrlKey: false, metaKey: false, shiftKey: false, altKey: false, ...more });
  expect(actionOf(press("ArrowLeft", { shiftKey: true }))).toBe("pan-left");
  expect(actionOf(press("?", { shiftKey: true }))).toBe("help");
  expect(actionOf(press("+", { shiftKey: true }))).toBe("zoom-in");
  expect(actionOf(press("z", { metaKey: true }))).toBe("undo");
  expect(actionOf(press("Z", { ctrlKey: true, shiftKey: true }))).toBe("redo");
  expect(actionOf(press("1", { altKey: true }))).toBeUndefined();
});

const STATE = { camera: CAMERA, layers: [{ opacity: 1 }], render: { kernel: "linear" }, view: { layout: { name: "3d" }, interface: { theme: "dark" } } } as unknown as ViewerState;

test("links hold the state", async () => {
  const part = await linkPart(JSON.stringify({ fingerprint: "sha256:1", state: STATE }));
  expect(part).toMatch(/^[\w-]+$/);
  expect(await fromLink(part ?? "")).toEqual({ fingerprint: "sha256:1", state: STATE });
  let seed = 1;
  const noise = Array.from({ length: 12_000 }, () => {
    seed = (seed * 48271) % 2147483647;
    return String.fromCharCode(33 + (seed % 90));
  }).join("");
  expect(await linkPart(noise)).toBeNull();
  await expect(fromLink("abc")).rejects.toThrow();
});

test("latency is from the newest event that a frame shows", () => {
  const statistics = new FrameStatistics();
  statistics.event(1, 100);
  statistics.event(2, 110);
  statistics.event(3, 150);
  statistics.drawn({ seq: 2, at_rest: false, bytes: new Uint8Array(5) } as unknown as Frame, 140);
  statistics.drawn({ seq: 2, at_rest: true, bytes: new Uint8Array(5) } as unknown as Frame, 145);
  statistics.drawn({ seq: 3, at_rest: false, bytes: new Uint8Array(5) } as unknown as Frame, 160);
  expect(statistics.records.map(({ latency }) => latency)).toEqual([30, null, 10]);
});

describe("slices", () => {
  const geometry = {
    origin: [100, 50, 7], right: [-1, 0, 0], down: [0, -1, 0], normal: [0, 0, 1], pixel: 2, zoom: 1, position: 7, range: [0, 20], letters: null, window: [0, 1], colors: "gray",
  } as const;
  const frame: slices.SliceFrame = { geometry, size: { width: 50, height: 40 }, width: 100, height: 80 };
  test("places are where the pixels are", () => {
    near(slices.worldAt(frame, 0.25, 0.25), [100, 50, 7]);
    near(slices.worldAt(frame, 25, 20), [100 - 2 * 49.5, 50 - 2 * 39.5, 7]);
    const { x, y, away } = slices.placeOf(frame, [1, -29, 10]);
    near([x, y, away], [25, 20, 3]);
  });
  test("planes cut in lines, and are tilted to them", () => {
    const line = slices.lineOf(frame, [1, 0, 0]);
    expect(Math.abs(line?.dy ?? 0)).toBeCloseTo(1);
    expect(slices.lineOf(frame, [0, 0, 1])).toBeNull();
    for (const angle of [0.2, -0.4, 1.2]) {
      const normal = slices.tilted(frame, [1, 0, 0], Math.sin(angle), Math.cos(angle));
      const found = slices.lineOf(frame, normal);
      expect(Math.abs((found?.dx ?? 0) * Math.cos(angle) - (found?.dy ?? 0) * Math.sin(angle))).toBeCloseTo(0, 6);
      expect(cameras.length(normal)).toBeCloseTo(1);
      expect(cameras.dot(normal, geometry.normal)).toBeCloseTo(0);
    }
  });
  test("lengths, angles and bars", () => {
    expect(slices.distance([[0, 0, 0], [3, 4, 12]])).toBe(13);
    expect(slices.angleDeg([[1, 0, 0], [0, 0, 0], [0, 2, 0]])).toBeCloseTo(90);
    expect([0.13, 7, 49, 50, 99].map(slices.barLength)).toEqual([0.1, 5, 20, 50, 50]);
    expect(slices.sampleStep([[0, 2, 0, 0], [3, 0, 0, 0], [0, 0, 5, 0]], [0, 1, 0])).toBe(3);
  });
});
