// Two windows of one session: each has its own layout, panels and theme; all else is shared.

import { expect, test } from "vitest";

import { set } from "../src/state/patch.ts";
import { createStore, type Store } from "../src/state/store.ts";
import { fakeSession, STATE, type FakeSession } from "./session_fake.ts";

async function opened(): Promise<{ session: FakeSession; store: Store }> {
  const session = fakeSession();
  session.open();
  await session.engine.welcome;
  return { session, store: createStore(session.engine) };
}

const FOUR = { name: "two-by-two", main: "3d" };
const patch = (session: FakeSession, cause: string, ...operations: unknown[]): void => session.say({ type: "patch", operations, seq: 0, cause });

test("another window's layout and panels are its own, and its camera is followed", async () => {
  const { session, store } = await opened();
  const camera = { ...STATE.camera, position: [1, 2, 3] };
  patch(session, "other view", set(FOUR, "view", "layout"), set(["light"], "view", "interface", "panels"), set(camera, "camera"));
  expect(store.state.view.layout).toEqual(STATE.view.layout);
  expect(store.state.view.interface).toEqual(STATE.view.interface);
  expect(store.state.camera).toEqual(camera);
  // This window's own changes hold, whatever else the others do.
  store.change([set(["cut"], "view", "interface", "panels")]);
  patch(session, "other view", { op: "replace", path: "", value: { ...STATE, view: { ...STATE.view, layout: FOUR } } });
  expect(store.state.view.interface.panels).toEqual(["cut"]);
  expect(store.state.view.layout).toEqual(STATE.view.layout);
  // One object as long as nothing changes, by which the page decides what is drawn anew.
  expect(store.state).toBe(store.state);
  store.change([set("gaussian", "render", "kernel")]);
  store.undo();
  expect(store.state.view.interface.panels).toEqual(["cut"]);
});

test("Python's layout is for all windows, but its other changes leave theirs", async () => {
  const { session, store } = await opened();
  patch(session, "other view", set(FOUR, "view", "layout"));
  patch(session, "python", { op: "replace", path: "", value: { ...STATE, view: { ...STATE.view, layout: FOUR }, background: "white" } });
  expect([store.state.view.layout, store.state.background]).toEqual([STATE.view.layout, "white"]);
  const single = { name: "single", main: "z" };
  patch(session, "python", set(single, "view", "layout"));
  expect(store.state.view.layout).toEqual(single);
});

test("a window that follows takes the others' layout", async () => {
  const { session, store } = await opened();
  patch(session, "other view", set(FOUR, "view", "layout"));
  store.follow(true);
  expect(store.state.view.layout).toEqual(FOUR);
  store.follow(false);
  patch(session, "other view", set({ name: "3d", main: "3d" }, "view", "layout"));
  expect(store.state.view.layout).toEqual(FOUR);
});
