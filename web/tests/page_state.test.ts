// The state of a page beside the viewer's, and the timers of viewers that share a document.

import { afterEach, beforeEach, expect, test, vi } from "vitest";

import type { Engine } from "../src/engine/engine.ts";
import { patched, set, type Operation } from "../src/state/patch.ts";
import type { ViewerState } from "../src/state/state.ts";
import { createStore } from "../src/state/store.ts";
import { PageState } from "../src/view/page_state.ts";
import { settleSoon } from "../src/view/scene_view.tsx";
import { Views } from "../src/view/views.ts";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const STATE = { camera: { parallel_scale: 50 }, view: { layout: {}, interface: {} } } as unknown as ViewerState;
const make = () => {
  const sent: { operations: readonly Operation[]; moving: boolean }[] = [];
  let state = STATE;
  const engine = {
    get state() {
      return state;
    },
    patch(operations: readonly Operation[], moving: boolean) {
      state = patched(state, operations);
      return sent.push({ operations, moving });
    },
    onState: () => () => undefined,
  } as unknown as Engine;
  return { store: createStore(engine), sent };
};

test("the wheel in two viewers within 100 ms: both come to rest", () => {
  const viewers = [make(), make()];
  for (const { store } of viewers) {
    store.change([set(40, "camera", "parallel_scale")], "wheel");
    settleSoon(store);
    vi.advanceTimersByTime(80);
  }
  vi.advanceTimersByTime(1000);
  for (const { sent } of viewers) expect(sent.map(({ moving }) => moving)).toEqual([true, false]);
});

test("what the page mends by itself is no step of undo", () => {
  const { store, sent } = make();
  store.change([set(40, "camera", "parallel_scale")]);
  store.adjust([set(44, "camera", "parallel_scale")]);
  expect(store.state.camera.parallel_scale).toBe(44);
  expect(sent.at(-1)).toEqual({ operations: [set(44, "camera", "parallel_scale")], moving: false });
  store.undo();
  expect(store.state.camera.parallel_scale).toBe(50);
  expect(store.canUndo).toBe(false);
});

test("listeners hear of changes alone, and the newest place is asked for", async () => {
  const page = new PageState();
  const heard = vi.fn();
  page.subscribe(heard);
  page.change({ tool: "turn" });
  expect(heard).not.toHaveBeenCalled();
  page.change({ tool: "angle", points: [[1, 2, 3]] });
  expect(heard).toHaveBeenCalledTimes(1);
  const [old, newest] = [vi.fn(async () => "old"), vi.fn(async () => "newest")];
  page.probe(old);
  vi.advanceTimersByTime(20);
  page.probe(newest);
  await vi.advanceTimersByTimeAsync(100);
  expect(old).not.toHaveBeenCalled();
  expect(page.fields.probed).toBe("newest");
  page.probe(null);
  expect(page.fields.probed).toBe("");
});

test("texts are said a second apart at least, the newest one", () => {
  const page = new PageState();
  vi.advanceTimersByTime(2000);
  page.announce("first");
  vi.advanceTimersByTime(10);
  expect(page.fields.said).toBe("first");
  page.announce("second");
  page.announce("third");
  vi.advanceTimersByTime(500);
  expect(page.fields.said).toBe("first");
  vi.advanceTimersByTime(600);
  expect(page.fields.said).toBe("third");
});

test("keys go to the view that was used last, and to another one when that has gone", () => {
  const views = new Views();
  const got: string[] = [];
  views.add("3d", () => got.push("3d"));
  const remove = views.add("z", () => got.push("z"));
  const key = {} as KeyboardEvent;
  views.receive(key);
  views.use("z");
  views.receive(key);
  remove();
  views.receive(key);
  expect(got).toEqual(["3d", "z", "3d"]);
});
