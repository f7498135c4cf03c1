// Opening files in the page, without a browser: names and sending of files, the steps, and what is taken out again.

import { readFileSync } from "node:fs";

import { describe, expect, test, vi } from "vitest";

import type { Data, Engine, Problem } from "../src/engine/engine.ts";
import { patched, type Operation } from "../src/state/patch.ts";
import type { ViewerState } from "../src/state/state.ts";
import { DataFollower } from "../src/view/open/data_follower.ts";
import { nameOf, send, type Dropped } from "../src/view/open/dropped.ts";
import { PageOpener, type Surroundings } from "../src/view/open/page_opener.ts";
import { withoutLabels, withoutLayer, withoutShape } from "../src/view/open/remove.ts";

const STATE = JSON.parse(readFileSync(new URL("../schema/state.json", import.meta.url), "utf8")) as ViewerState;

const file = (path: string, content: string | Uint8Array<ArrayBuffer>): Dropped => ({ path, file: new File([content], path.split("/").at(-1) ?? "") });

type Asked = [question: string, fields: Record<string, unknown>, bytes: number];

/** An engine that answers by a table, and notes what it was asked. */
function engineOf(answers: Record<string, (fields: Record<string, unknown>, payload?: Uint8Array) => unknown>): { engine: Engine; asked: Asked[] } {
  const asked: Asked[] = [];
  const ask = (question: string, fields: Record<string, unknown>, _progress?: unknown, _signal?: unknown, payload?: Uint8Array): Promise<unknown> => {
    asked.push([question, fields, payload?.length ?? 0]);
    try {
      return Promise.resolve(answers[question]?.(fields, payload) ?? {});
    } catch (problem) {
      return Promise.reject(problem);
    }
  };
  return { engine: { ask } as unknown as Engine, asked };
}

describe("files that are sent", () => {
  test("have the name of their folder, or of the first one", () => {
    expect(nameOf([file("a.nii", "x")])).toBe("a.nii");
    expect(nameOf([file("s/1", "x"), file("s/2", "x")])).toBe("s");
    expect(nameOf([file("a.mhd", "x"), file("a.raw", "x")])).toBe("a.mhd and 1 more");
  });

  test("go in pieces, each after the one before, an empty file too", async () => {
    let received = 0;
    const { engine, asked } = engineOf({
      upload_begin: () => ({ upload: 7 }),
      upload: (_, payload) => {
        received += payload?.length ?? 0;
        return { received };
      },
    });
    const parts: number[] = [];
    const files = [file("s/a", new Uint8Array(1_200_000)), file("s/b", "")];
    expect(await send(engine, files, (part) => parts.push(part), new AbortController().signal)).toBe(7);
    expect(asked[0]).toEqual(["upload_begin", { files: 2, bytes: 1_200_000 }, 0]);
    expect(asked.slice(1).map(([, fields, bytes]) => [fields["path"], fields["offset"], bytes])).toEqual([
      ["s/a", 0, 524_288], ["s/a", 524_288, 524_288], ["s/a", 1_048_576, 151_424], ["s/b", 0, 0],
    ]);
    expect(parts.at(-1)).toBe(1);
  });

  test("are discarded where a piece is refused, or it is cancelled", async () => {
    const refusal = { code: "open", message: "the disk is full" };
    const refusing = engineOf({ upload_begin: () => ({ upload: 1 }), upload: () => { throw refusal; } });
    await expect(send(refusing.engine, [file("a", "abc")], () => undefined, new AbortController().signal)).rejects.toBe(refusal);
    expect(refusing.asked.at(-1)?.[0]).toBe("discard");
    const abort = new AbortController();
    const upload = () => {
      abort.abort();
      return { received: 1 };
    };
    const slow = engineOf({ upload_begin: () => ({ upload: 2 }), upload });
    await expect(send(slow.engine, [file("a", "abc"), file("b", "abc")], () => undefined, abort.signal)).rejects.toThrow();
    expect(slow.asked.at(-1)).toEqual(["discard", { upload: 2 }, 0]);
  });
});

describe("the steps of opening", () => {
  const around = (engine: Engine, hasData: boolean) => {
    const changes: (readonly Operation[])[] = [];
    const problems: Problem[] = [];
    const page: Surroundings = {
      engine,
      hasData: () => hasData,
      aspect: () => 1.5,
      change: (operations) => changes.push(operations),
      openState: vi.fn(),
      announce: () => undefined,
      problem: (problem) => problems.push(problem),
      changed: () => undefined,
    };
    return { opener: new PageOpener(page), page, changes, problems };
  };
  const uploading = { upload_begin: () => ({ upload: 3 }), upload: () => ({ received: 3 }) };
  const operations = [{ op: "remove", path: "/layers/1" }];

  test("ask how a second volume is shown, and make its changes", async () => {
    const { engine, asked } = engineOf({ ...uploading, open: () => ({ found: [{ kind: "volume", name: "b.nii" }], opened: 9 }), show: () => ({ operations }) });
    const { opener, changes } = around(engine, true);
    await opener.files([file("b.nii", "abc")]);
    expect(opener.step).toMatchObject({ kind: "choosing", name: "b.nii", opened: 9 });
    await opener.choose("overlay");
    expect(asked.at(-1)).toEqual(["show", { opened: 9, how: "overlay", aspect: 1.5 }, 0]);
    expect(changes).toEqual([operations]);
    expect(opener.step.kind).toBe("idle");
  });

  test("ask nothing for shapes, nor where nothing is open", async () => {
    const shape = engineOf({ ...uploading, open: () => ({ found: [{ kind: "shape", name: "a.stl" }], opened: 1 }), show: () => ({ operations }) });
    const second = around(shape.engine, true);
    await second.opener.files([file("a.stl", "abc")]);
    expect(second.changes).toEqual([operations]);
    const first = around(engineOf({ open: () => ({ found: [], shown: true }) }).engine, false);
    await first.opener.source({ example: "ripples" }, "Ripples");
    expect(first.opener.step.kind).toBe("idle");
    expect(first.changes).toEqual([]);
  });

  test("ask which of several series is meant", async () => {
    const several = { option: "series", names: ["1.2", "1.3"], described: ["CT", "MR"] };
    const { engine, asked } = engineOf({ ...uploading, open: (fields) => (fields["choice"] === undefined ? { several } : { found: [{ kind: "volume" }], opened: 2 }) });
    const { opener } = around(engine, true);
    await opener.files([file("s/1", "a"), file("s/2", "b")]);
    expect(opener.step).toMatchObject({ kind: "several", names: several.names });
    await opener.pick("1.3");
    expect(asked.at(-1)?.[1]).toEqual({ upload: 3, choice: { option: "series", value: "1.3" } });
    expect(opener.step.kind).toBe("choosing");
    opener.cancel();
    expect(asked.at(-1)).toEqual(["discard", { opened: 2 }, 0]);
    expect(opener.step.kind).toBe("idle");
  });

  test("are cancelled in the session too, whatever it is doing", async () => {
    const signals: (AbortSignal | undefined)[] = [];
    let answer: (told: unknown) => void = () => undefined;
    const { engine, asked } = engineOf({ ...uploading, open: () => new Promise((resolve) => (answer = resolve)) });
    const { ask } = engine;
    engine.ask = ((name: never, question: never, progress: never, signal?: AbortSignal, payload?: never) => {
      if (name === "open") signals.push(signal);
      return ask(name, question, progress, signal, payload);
    }) as typeof ask;
    const { opener, problems } = around(engine, true);
    const opening = opener.files([file("b.nii", "abc")]);
    await vi.waitFor(() => expect(opener.step.kind).toBe("reading"));
    await vi.waitFor(() => expect(signals).toHaveLength(1));
    opener.cancel();
    expect(signals[0]?.aborted).toBe(true);
    expect(opener.step.kind).toBe("idle");
    // An answer that was on its way is taken back.
    answer({ found: [{ kind: "volume", name: "b.nii" }], opened: 9 });
    await opening;
    expect(asked.at(-1)).toEqual(["discard", { opened: 9 }, 0]);
    expect(opener.step.kind).toBe("idle");
    expect(problems).toEqual([]);
  });

  test("refuse what is too large before a byte is sent, and a state on its own", async () => {
    const { engine, asked } = engineOf({});
    const { opener, problems, page } = around(engine, true);
    opener.setOffered({ examples: [], recent: null, max_bytes: 2 });
    await opener.files([file("a.nii", "abc")]);
    expect(problems[0]?.message).toContain("a page sends up to");
    await opener.files([file("view.json", "{}")]);
    expect(page.openState).toHaveBeenCalledOnce();
    expect(asked).toEqual([]);
    const start = around(engine, false);
    await start.opener.files([file("view.json", "{}")]);
    expect(start.opener.failure?.remedy).toContain("--state");
  });

  test("tell what the reader says", async () => {
    const { engine } = engineOf({ ...uploading, open: () => { throw { code: "open", message: "a.nii is no volume" }; } });
    const { opener, problems } = around(engine, true);
    await opener.files([file("a.nii", "abc")]);
    expect(problems).toEqual([{ code: "open", message: "a.nii is no volume" }]);
    expect(opener.step.kind).toBe("idle");
  });
});

describe("what is taken out", () => {
  const layer = STATE.layers[0];
  const box = { lower: [0, 0, 0], upper: [1, 1, 1] } as const;
  const state = {
    ...STATE,
    layers: [layer, layer],
    labels: { volume: { path: null }, labels: {}, smooth: true },
    clip: [{ keep: { ...box, space: "index" } }, { cut_out: { ...box, space: "world" } }, { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }],
    geometry: [{ kind: "frame", name: "frame 1", count: 1, visible: true }],
  } as unknown as ViewerState;

  test("is the layer alone, or with the first what lies on its samples", () => {
    expect(withoutLayer(state, 1)).toEqual([{ op: "remove", path: "/layers/1" }]);
    const after = patched(state, withoutLayer(state, 0));
    expect([after.layers.length, after.labels, after.clip]).toEqual([1, null, state.clip.slice(1)]);
    expect(patched(state, withoutShape(0)).geometry).toEqual([]);
    expect(patched(state, withoutLabels()).labels).toBe(null);
  });
});

test("facts of what is open are asked for when the state names other volumes, and not for other changes", async () => {
  const { engine, asked } = engineOf({ data: () => ({ fingerprint: String(asked.length) }) });
  let state = STATE;
  const got: Data[] = [];
  const follower = new DataFollower(engine, () => state, (data) => got.push(data));
  state = { ...STATE, background: "white" };
  follower.check();
  expect(asked).toEqual([]);
  state = { ...STATE, layers: STATE.layers.map((one) => ({ ...one, volume: { ...one.volume, id: 8 } })) };
  follower.check();
  follower.check();
  await vi.waitFor(() => expect(got).toEqual([{ fingerprint: "1" }]));
  follower.check();
  expect(asked.length).toBe(1);
});
