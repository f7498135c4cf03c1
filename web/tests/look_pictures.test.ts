import { afterEach, beforeEach, expect, test, vi } from "vitest";

import type { Engine } from "../src/engine/engine.ts";
import { PresetPictures } from "../src/view/look/preset_pictures.ts";

interface Asked {
  readonly name: string;
  answer(): void;
  fail(code: string): void;
}

let asked: Asked[] = [];
const engine = {
  ask: (_: string, { name }: { name: string }) =>
    new Promise((resolve, reject) => {
      asked.push({
        name,
        answer: () => resolve({ bytes: new Uint8Array(1) }),
        fail: (code) => reject({ code, message: `no ${name}` }),
      });
    }),
} as unknown as Engine;
const names = (): string[] => asked.map(({ name }) => name);
const settle = (): Promise<unknown> => vi.advanceTimersByTimeAsync(0);

beforeEach(() => {
  asked = [];
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

test("one at a time, in the order in which they are wanted, each once", async () => {
  const changed = vi.fn();
  const pictures = new PresetPictures(engine, 0, changed);
  ["a", "b", "a"].forEach((name) => pictures.want(name));
  await settle();
  expect(names()).toEqual(["a"]);
  asked[0]?.answer();
  await settle();
  expect(names()).toEqual(["a", "b"]);
  asked[1]?.answer();
  await settle();
  expect(pictures.get("a")).toMatch(/^blob:/);
  pictures.want("a");
  await settle();
  expect(names().length).toBe(2);
  expect(changed).toHaveBeenCalledTimes(2);
});

test("what left the screen before its turn is not drawn", async () => {
  const pictures = new PresetPictures(engine, 0, () => {});
  ["a", "b", "c"].forEach((name) => pictures.want(name));
  pictures.leave("b");
  await settle();
  asked[0]?.answer();
  await settle();
  expect(names()).toEqual(["a", "c"]);
});

test("while something is changed it waits", async () => {
  const pictures = new PresetPictures(engine, 0, () => {});
  pictures.pause();
  pictures.want("a");
  await vi.advanceTimersByTimeAsync(300);
  pictures.pause();
  await vi.advanceTimersByTimeAsync(300);
  expect(names()).toEqual([]);
  await vi.advanceTimersByTimeAsync(100);
  expect(names()).toEqual(["a"]);
});

test("one that fails keeps its reason, and the next one comes", async () => {
  const pictures = new PresetPictures(engine, 0, () => {});
  ["a", "b"].forEach((name) => pictures.want(name));
  await settle();
  asked[0]?.fail("argument");
  await settle();
  expect([pictures.reason("a"), pictures.get("a"), ...names()]).toEqual(["no a", undefined, "a", "b"]);
  asked[1]?.answer();
  await settle();
  pictures.want("a");
  await settle();
  expect(names().length).toBe(2);
  const before = pictures.get("a");
  pictures.refresh();
  await settle();
  expect(pictures.get("a")).toBe(before);
  expect(names().length).toBe(3);
});

test("after the connection was lost it is tried again", async () => {
  const pictures = new PresetPictures(engine, 0, () => {});
  pictures.want("a");
  await settle();
  asked[0]?.fail("lost");
  await vi.advanceTimersByTimeAsync(100);
  expect(names()).toEqual(["a"]);
  await vi.advanceTimersByTimeAsync(3000);
  expect([pictures.reason("a"), ...names()]).toEqual([undefined, "a", "a"]);
  pictures.close();
  asked[1]?.answer();
  await settle();
  expect(pictures.get("a")).toBeUndefined();
});
