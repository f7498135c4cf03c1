// The engine behind a channel and the store above it: one state in the page, which follows the session.

import { describe, expect, test, vi } from "vitest";

import type { Connection, Problem } from "../src/engine/engine.ts";
import type { Header } from "../src/engine/framing.ts";
import { parseAnswer } from "../src/engine/messages.ts";
import { keepSteps, resumeSteps } from "../src/state/kept_steps.ts";
import { patched, set, type Operation } from "../src/state/patch.ts";
import { Replica } from "../src/state/replica.ts";
import { createStore } from "../src/state/store.ts";
import { fakeSession, LOST, STATE, WELCOME } from "./session_fake.ts";

const SAVED = { width: 1, height: 1, shown: "3d", transparent: false, annotated: false } as const;

test("changes hold no -0, which JSON does not have, and others are the objects that were given", () => {
  const replica = new Replica(STATE);
  const up = [-0, -0, 1];
  replica.change([set(up, "camera", "view_up")], 1);
  expect(replica.state.camera.view_up).toEqual([0, 0, 1]);
  const position = [1, 0, 2];
  replica.change([set(position, "camera", "position")], 2);
  expect(replica.state.camera.position).toBe(position);
});

describe("the store", () => {
  const make = () => {
    const session = fakeSession();
    session.open();
    let taken = 0;
    const tell = (operations: Operation[]): void => {
      session.tick();
      taken = Number(session.sent.at(-1)?.["seq"] ?? taken);
      session.say({ type: "patch", operations, seq: taken });
    };
    const sent = (): Header[] => session.sent.filter((header) => header["type"] === "patch");
    return { ...session, store: createStore(session.engine), sent, tell };
  };
  test("a gesture is one step, and undone as one", () => {
    const { store, sent, tick } = make();
    for (const scale of [40, 30, 20]) {
      store.change([set(scale, "camera", "parallel_scale")], "zoom");
      tick();
    }
    store.settle();
    tick();
    store.change([set("gaussian", "render", "kernel")]);
    tick();
    expect(sent().map(({ moving }) => moving)).toEqual([true, true, true, false, false]);
    store.undo();
    expect(store.state.camera.parallel_scale).toBe(20);
    store.undo();
    expect(store.state).toEqual(STATE);
    expect(store.canUndo).toBe(false);
    store.redo();
    expect(store.state.camera.parallel_scale).toBe(20);
    store.redo();
    expect(store.state.render.kernel).toBe("gaussian");
    expect(store.canRedo).toBe(false);
  });
  test("a page that is opened again has the steps of the one before, if its state is the same", () => {
    const before = make();
    before.store.change([set("gaussian", "render", "kernel")]);
    before.store.change([set("bspline3", "render", "kernel")]);
    before.store.undo();
    const room = new Map<string, string>();
    const storage = {
      getItem: (key: string) => room.get(key) ?? null,
      setItem: (key: string, value: string) => {
        if (value.length > 3.5 * JSON.stringify(STATE).length) throw new Error("full");
        room.set(key, value);
      },
      removeItem: (key: string) => void room.delete(key),
    };
    keepSteps(before.store, "data", storage);
    const other = make();
    resumeSteps(other.store, "data", storage);
    expect(other.store.canUndo).toBe(false);
    const same = make();
    same.store.adjust([set("gaussian", "render", "kernel"), set("light", "view", "interface", "theme")]);
    resumeSteps(same.store, "data", storage);
    same.store.redo();
    expect(same.store.state.render.kernel).toBe("bspline3");
    same.store.undo();
    same.store.undo();
    expect(same.store.state.render.kernel).toBe(STATE.render.kernel);
    expect(same.store.state.view.interface.theme).toBe("light");
    // Where there is room for less, the nearest steps stay.
    for (const kernel of ["gaussian", "linear", "bspline3"] as const) before.store.change([set(kernel, "render", "kernel")]);
    keepSteps(before.store, "data", storage);
    const less = make();
    less.store.adjust([set("bspline3", "render", "kernel")]);
    resumeSteps(less.store, "data", storage);
    less.store.undo();
    expect(less.store.state.render.kernel).toBe("linear");
  });
  test("the interface is no step, and stays as it is", () => {
    const { store } = make();
    store.change([set("light", "view", "interface", "theme")]);
    expect(store.canUndo).toBe(false);
    store.change([set("gaussian", "render", "kernel")]);
    store.change([set("dark", "view", "interface", "theme")]);
    store.undo();
    expect(store.state.render.kernel).toBe("linear");
    expect(store.state.view.interface.theme).toBe("dark");
  });
  test("changes by others are no steps", () => {
    const { store, sent, tell } = make();
    tell([set(0.5, "layers", 0, "opacity")]);
    expect(store.state.layers[0]?.opacity).toBe(0.5);
    expect(store.canUndo).toBe(false);
    expect(sent()).toEqual([]);
    store.change([set("gaussian", "render", "kernel")]);
    tell([set(0.25, "layers", 0, "opacity")]);
    store.undo();
    expect(store.state.render.kernel).toBe("linear");
    expect(store.state.layers[0]?.opacity).toBe(0.25);
  });
  test("a refused change is no step", () => {
    const { store, say, tick } = make();
    store.change([set("gaussian", "render", "kernel")]);
    store.change([set("none", "render", "kernel")]);
    tick();
    expect(store.canUndo).toBe(true);
    say({ type: "failed", id: null, seq: store.seq, code: "refused", message: "no such kernel" });
    expect(store.state).toEqual(STATE);
    expect(store.canUndo).toBe(false);
  });
});

describe("the engine behind a channel", () => {
  test("says hello, then what is shown", async () => {
    const all = fakeSession();
    all.engine.show("3d", { width: 10, height: 8 });
    all.open();
    expect(all.sent).toEqual([{ type: "hello", protocol: 1, token: "t" }, { type: "view", view: "3d", size: [10, 8] }]);
    expect((await all.engine.welcome).state).toEqual(STATE);
  });
  test("merges changes: one message in an animation frame, the last number", () => {
    const all = fakeSession();
    all.open();
    all.sent.length = 0;
    all.engine.patch([set(1, "camera", "parallel_scale")], true);
    const seq = all.engine.patch([set(2, "camera", "parallel_scale")], true);
    expect(all.sent).toEqual([]);
    all.tick();
    expect(all.sent).toHaveLength(1);
    expect(all.sent[0]).toMatchObject({ type: "patch", seq, moving: true });
    expect(all.sent[0]?.["operations"]).toHaveLength(2);
  });
  test("what was changed while nobody listened is sent when somebody does, and nothing else", () => {
    const all = fakeSession();
    all.open();
    all.engine.patch([set("light", "view", "interface", "theme")], false);
    all.tick();
    all.say({ type: "confirmed", seq: 1, corrections: [] });
    const seen: Connection[] = [];
    all.engine.onConnection((connection) => seen.push(connection));
    all.state(LOST);
    expect(seen.at(-1)).toMatchObject({ kind: "lost", retries: true });
    all.engine.patch([set(20, "camera", "parallel_scale")], false);
    all.tick();
    all.sent.length = 0;
    // Python changed another field meanwhile.
    all.state({ kind: "open" });
    const theirs = patched(STATE, [set("light", "view", "interface", "theme"), set("gaussian", "render", "kernel")]);
    all.say({ ...WELCOME, state: theirs });
    const [hello, change] = all.sent;
    expect(hello).toMatchObject({ type: "hello" });
    expect(change).toEqual({
      type: "patch", seq: 3, operations: [{ op: "replace", path: "/camera/parallel_scale", value: 20 }], moving: false,
    });
    expect(all.engine.state).toEqual(patched(theirs, [set(20, "camera", "parallel_scale")]));
  });
  test("a connection that comes back sends no state where nothing was changed, and takes what others changed", () => {
    const all = fakeSession();
    all.open();
    const told: unknown[] = [];
    all.engine.onState((operations) => told.push(operations));
    for (const state of [STATE, patched(STATE, [set("gaussian", "render", "kernel")])]) {
      all.state(LOST);
      all.sent.length = 0;
      all.state({ kind: "open" });
      all.say({ ...WELCOME, state });
      // The number alone, by which frames tell what they show.
      expect(all.sent.filter(({ type }) => type === "patch")).toMatchObject([{ operations: [] }]);
      expect(all.engine.state).toEqual(state);
    }
    expect(told).toHaveLength(1);
  });
  test("a change of an object that others removed meanwhile is left out", () => {
    const all = fakeSession();
    const labels = { volume: { path: null, id: 9 }, smooth: false };
    const state = { ...STATE, labels } as unknown as typeof STATE;
    all.state({ kind: "open" });
    all.say({ ...WELCOME, state });
    all.state(LOST);
    all.engine.patch([set(true, "labels", "smooth"), set(20, "camera", "parallel_scale")], false);
    all.sent.length = 0;
    all.state({ kind: "open" });
    all.say({ ...WELCOME, state: STATE });
    expect(all.sent.filter(({ type }) => type === "patch")).toMatchObject([
      { operations: [{ op: "replace", path: "/camera/parallel_scale", value: 20 }] },
    ]);
    expect(all.engine.state.labels).toBeNull();
  });
  test("a session that was started again gets what the page shows", () => {
    const all = fakeSession();
    all.open();
    all.engine.patch([set(20, "camera", "parallel_scale")], false);
    all.tick();
    all.say({ type: "confirmed", seq: 1, corrections: [] });
    all.state(LOST);
    all.sent.length = 0;
    all.state({ kind: "open" });
    all.say({ ...WELCOME, session: "another key" });
    expect(all.sent.filter(({ type }) => type === "patch")).toMatchObject([
      { operations: [{ op: "replace", path: "/camera/parallel_scale", value: 20 }] },
    ]);
    expect(all.engine.state.camera.parallel_scale).toBe(20);
  });
  test("questions are answered, fail, and can be given up", async () => {
    const all = fakeSession();
    all.open();
    const parts: number[] = [];
    const answer = all.engine.ask("code", { as: "python", ...SAVED }, (part) => parts.push(part));
    all.say({ type: "progress", id: 1, part: 0.5, text: "" });
    all.say({ type: "answer", id: 1, text: "x", name: "y" });
    expect(await answer).toMatchObject({ text: "x" });
    expect(parts).toEqual([0.5]);
    all.engine.patch([set("gaussian", "render", "kernel")], false);
    void all.engine.ask("code", { as: "python", ...SAVED }).catch(() => undefined);
    expect(all.sent.slice(-2).map((header) => header["type"])).toEqual(["patch", "ask"]);
    all.tick();
    expect(all.sent.at(-1)?.["type"]).toBe("ask");
    const abort = new AbortController();
    const other = all.engine.ask("pick", { x: 0, y: 0, width: 1, height: 1 }, undefined, abort.signal);
    abort.abort();
    expect(all.sent.at(-1)).toEqual({ type: "cancel", id: 3 });
    all.say({ type: "failed", id: 3, code: "cancelled", message: "it was cancelled" });
    await expect(other).rejects.toMatchObject({ code: "cancelled" });
  });
});

describe("confirmation", () => {
  const kernel = set("gaussian", "render", "kernel");
  const scale = (to: number): Operation => set(to, "camera", "parallel_scale");

  test("a change by others goes before what they had not seen", () => {
    const replica = new Replica(STATE);
    replica.change([scale(1)], 1);
    replica.change([scale(2)], 2);
    // The session had taken the first change alone, so the second one comes after that of the others.
    replica.merge([scale(7), kernel], 1);
    expect(replica.state).toEqual(patched(STATE, [kernel, scale(2)]));
    replica.confirm(2);
    expect(replica.isUnconfirmed(Infinity)).toBe(false);
    replica.merge([scale(9)], 2);
    expect(replica.state.camera.parallel_scale).toBe(9);
  });

  test("a refusal takes back its own message alone", () => {
    const replica = new Replica(STATE);
    replica.change([scale(1)], 1);
    replica.change([set("none", "render", "kernel")], 2);
    replica.change([scale(3)], 3);
    replica.confirm(1);
    replica.refuse(2);
    expect(replica.state).toEqual(patched(STATE, [scale(3)]));
  });

  test("a change of an object that others removed is dropped, as the session does", () => {
    const replica = new Replica(STATE);
    replica.merge([{ op: "add", path: "/view/measures/-", value: { kind: "distance", points: [[0, 0, 0], [1, 0, 0]] } }], 0);
    replica.change([{ op: "replace", path: "/view/measures/0/points/0/0", value: 5 }], 1);
    replica.change([kernel], 2);
    replica.merge([{ op: "remove", path: "/view/measures/0" }], 0);
    expect(replica.state).toEqual(patched(STATE, [kernel]));
  });

  test("page and session agree in whatever order changes meet", () => {
    // A session, a page and others; messages wait in two queues, and are taken in an order that a seed gives.
    for (let seed = 1; seed <= 60; seed += 1) {
      let random = seed;
      const next = (n: number): number => {
        random = (random * 48271) % 2147483647;
        return random % n;
      };
      const replica = new Replica(STATE);
      let session = STATE;
      let taken = 0;
      let seq = 0;
      const toSession: { seq: number; operations: Operation[] }[] = [];
      const toPage: (() => void)[] = [];
      const steps: (() => void)[] = [
        () => {
          seq += 1;
          const operations = [next(2) === 0 ? scale(next(90) + 1) : set(["linear", "bad"][next(2)], "render", "kernel")];
          replica.change(operations, seq);
          toSession.push({ seq, operations });
        },
        () => {
          const message = toSession.shift();
          if (message === undefined) return;
          taken = message.seq;
          const after = patched(session, message.operations);
          const isRefused = (after.render.kernel as string) === "bad";
          session = isRefused ? session : after;
          toPage.push(() => (isRefused ? replica.refuse(message.seq) : replica.confirm(message.seq)));
        },
        () => {
          const operations = [scale(next(90) + 100)];
          session = patched(session, operations);
          const known = taken;
          toPage.push(() => replica.merge(operations, known));
        },
        () => toPage.shift()?.(),
      ];
      for (let n = 0; n < 80; n += 1) steps[next(4)]?.();
      while (toSession.length > 0) steps[1]?.();
      while (toPage.length > 0) steps[3]?.();
      expect(replica.isUnconfirmed(Infinity)).toBe(false);
      expect(replica.state).toEqual(session);
    }
  });

  test("corrections of the session are taken", () => {
    const all = fakeSession();
    all.open();
    const seq = all.engine.patch([scale(5)], false);
    all.tick();
    all.say({ type: "confirmed", seq, corrections: [scale(6)] });
    expect(all.engine.state.camera.parallel_scale).toBe(6);
  });

  test("silence is told after two seconds, and ends with the confirmation", () => {
    vi.useFakeTimers();
    const all = fakeSession();
    const seen: Connection[] = [];
    all.engine.onConnection((connection) => seen.push(connection));
    all.open();
    seen.length = 0;
    const first = all.engine.patch([kernel], false);
    all.tick();
    all.say({ type: "confirmed", seq: first, corrections: [] });
    vi.advanceTimersByTime(20_000);
    expect(seen).toEqual([]);
    const seq = all.engine.patch([scale(3)], false);
    all.tick();
    vi.advanceTimersByTime(2100);
    expect(seen).toMatchObject([{ kind: "silent", problem: { message: "no answer" } }]);
    all.say({ type: "confirmed", seq, corrections: [] });
    expect(seen.at(-1)).toEqual({ kind: "open" });
    vi.useRealTimers();
  });
});

describe("messages", () => {
  test.each<[string, Header, string]>([
    ["an unknown type", { type: "song" }, "type is"],
    ["a patch without a number", { type: "patch", operations: [] }, "'seq' is missing"],
    ["an operation that is none", { type: "patch", seq: 0, operations: [{ op: "move", path: "" }] }, "operations[0].op"],
    ["a frame of an unknown format", { type: "frame", view: "3d", number: 1, seq: 0, width: 1, height: 1, format: "webp" }, "format"],
    ["a welcome of a broken state", { type: "welcome", program: "", state: { ...STATE, render: 3 } }, "state: render"],
  ])("%s is a problem that names the field, and changes nothing", (_, header, field) => {
    const all = fakeSession();
    all.open();
    const problems: Problem[] = [];
    all.engine.onProblem((problem) => problems.push(problem));
    all.say(header);
    expect(problems).toHaveLength(1);
    expect(problems[0]?.message).toContain(field);
    expect(all.engine.state).toEqual(STATE);
  });

  test("an answer of another kind fails the question", async () => {
    expect(() => parseAnswer("pick", { point: [1, 2], values: [] }, new Uint8Array())).toThrow("answer to pick: point is");
    const value = { name: "density", value: "3", unit: "" };
    expect(() => parseAnswer("pick", { point: [1, 2, 3], values: [value] }, new Uint8Array())).toThrow("value is");
    const all = fakeSession();
    all.open();
    const asked = all.engine.ask("code", { as: "state", ...SAVED });
    all.say({ type: "answer", id: 1, text: 5, name: "x" });
    await expect(asked).rejects.toMatchObject({ code: "message" });
  });
});
