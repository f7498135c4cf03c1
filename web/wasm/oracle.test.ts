// The module in Node (`make wasm-test`): files, documents and pictures are those of Python's kept answers, and of the same
// code compiled for this processor (`crates/wasm/examples/twin.rs`), to the bit.

import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { crc32 } from "node:zlib";

import { describe, expect, test } from "vitest";

import { ModuleEnded, ModuleError, VolumeModule, type CameraWish, type DocumentKind, type SamplesHead } from "../src/engine/module.ts";

function given(name: string): string {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set; run these tests by make wasm-test`);
  return value;
}

const compiled = await WebAssembly.compile(readFileSync(given("WAVESPLAT_MODULE")));
const lines = (path: string | URL): string[] => readFileSync(path, "utf8").trim().split("\n");

interface Told {
  readonly text?: string;
  readonly error?: string;
  readonly crc32?: number;
}

/** The answers of the twin to calls. */
function twin(calls: readonly object[]): Told[] {
  const input = calls.map((call) => JSON.stringify(call)).join("\n");
  const { stdout, stderr, status } = spawnSync(given("WAVESPLAT_TWIN"), { input, encoding: "utf8", maxBuffer: 1 << 28 });
  if (status !== 0) throw new Error(`the twin ended with ${status}: ${stderr}`);
  return stdout.trim().split("\n").map((line) => JSON.parse(line) as Told);
}

/** The answer of the module in the twin's form. */
function told(ask: () => unknown): Told {
  try {
    const answer = ask();
    return ArrayBuffer.isView(answer)
      ? { crc32: crc32(new Uint8Array(answer.buffer, answer.byteOffset, answer.byteLength)) }
      : { text: JSON.stringify(answer) };
  } catch (error) {
    if (!(error instanceof ModuleError)) throw error;
    return { error: error.message };
  }
}

/** Units in the last place between two numbers. */
function ulps(a: number, b: number): number {
  const places = new BigInt64Array(new Float64Array([a, b]).buffer);
  const [x, y] = [...places].map((bits) => (bits < 0n ? -(bits & 0x7fff_ffff_ffff_ffffn) : bits)) as [bigint, bigint];
  return Number(x > y ? x - y : y - x);
}

/** All numbers in a value, in order. */
function numbersIn(value: unknown): number[] {
  if (typeof value === "number") return [value];
  return value && typeof value === "object" ? Object.values(value).flatMap(numbersIn) : [];
}

interface FileCase {
  readonly file: string;
  readonly bytes: string;
  readonly refused?: string;
  readonly size: number[];
  readonly type: string;
  readonly crc32: number;
  readonly affine: number[][];
  readonly facts: object;
  readonly kind?: [string, string];
  readonly camera?: number[];
  readonly look?: { readonly words: (string | null)[] } | "labels" | null;
}

const CASES = lines(new URL("../../crates/files/tests/cases.jsonl", import.meta.url)).map((line) => JSON.parse(line) as FileCase);
const WISHES: CameraWish[] = [
  { fit: true },
  { fit: true, aspect: 1.5 },
  { view: "left" },
  { orbit: [30, 20], aspect: 0.75, view_angle: 35, zoom: 1.1 },
  { turned: [12.5, -7, 3] },
  { zoomed: 1.7 },
];

describe("files", () => {
  const found = { kept: 0, keptApart: 0, keptMost: 0, twin: 0, twinApart: 0, twinMost: 0 };
  const count = (name: "kept" | "twin", ours: number[], theirs: number[]): void => {
    expect(ours.length).toBe(theirs.length);
    for (const [at, number] of ours.entries()) {
      const apart = ulps(number, theirs[at] as number);
      found[name] += 1;
      found[`${name}Apart`] += apart ? 1 : 0;
      found[`${name}Most`] = Math.max(found[`${name}Most`], apart);
    }
  };

  test("are read, named, looked at and framed as by Python", async () => {
    let [read, looks] = [0, 0];
    for (const kept of CASES) {
      const module = await VolumeModule.of(compiled);
      const open = () => module.open(kept.file, Buffer.from(kept.bytes, "hex"));
      // The module has one file; this header names another.
      if (kept.refused !== undefined || kept.file === "detached.nhdr") {
        expect(open, kept.file).toThrow(kept.refused ?? "in another file, detached.raw");
        expect(open, kept.file).toThrow(ModuleError);
        continue;
      }
      const volume = open();
      read += 1;
      expect([volume.size, volume.type, volume.facts], kept.file).toEqual([kept.size, kept.type, kept.facts]);
      expect(crc32(module.samples()), kept.file).toBe(kept.crc32);
      count("kept", numbersIn(volume.world_from_index), kept.affine.slice(0, 3).flat());
      if (!kept.kind || !kept.camera) continue;
      const { kind, reason } = module.kind();
      expect([kind, reason], kept.file).toEqual(kept.kind);
      if (kept.look && kept.look !== "labels") {
        const look = module.look({ auto: true });
        expect([look.reason, look.is_cut_open], kept.file).toEqual([kept.look.words[4], kept.look.words[3] === "cut open"]);
        expect(look.name, kept.file).toBe("auto");
        looks += 1;
      }
      module.look({ preset: "ct-bone" });
      const { position, focal_point, view_up, parallel_scale } = module.camera({ fit: true });
      count("kept", [...position, ...focal_point, ...view_up, parallel_scale as number], kept.camera);
    }
    expect([read > 50, looks > 40]).toEqual([true, true]);
  });

  test("are what they are natively", async () => {
    for (const kept of CASES) {
      const module = await VolumeModule.of(compiled);
      const ours = [
        told(() => module.open(kept.file, Buffer.from(kept.bytes, "hex"))),
        told(() => module.kind()),
        told(() => module.look({ auto: true })),
        told(() => module.camera({ fit: true })),
        told(() => module.look({ preset: "ct-bone" })),
        ...WISHES.map((wish) => told(() => module.camera(wish))),
      ];
      const looks = [["look", { auto: true }], ["camera", { fit: true }], ["look", { preset: "ct-bone" }]];
      const asked = [["kind", {}], ...looks, ...WISHES.map((wish) => ["camera", wish])];
      const theirs = twin([{ open: kept.file, hex: kept.bytes }, ...asked.map(([ask, asked]) => ({ ask, asked }))]);
      for (const [at, answer] of ours.entries()) {
        expect(answer.error, kept.file).toBe(theirs[at]?.error);
        if (answer.text === undefined) continue;
        const both = [answer.text, theirs[at]?.text as string].map((text) => JSON.parse(text) as unknown);
        count("twin", numbersIn(both[0]), numbersIn(both[1]));
        const texts = both.map((value) => JSON.stringify(value, (_, part: unknown) => (typeof part === "number" ? 0 : part)));
        expect(texts[0], kept.file).toBe(texts[1]);
      }
    }
    console.log(
      `numbers beside Python's kept ones: ${found.keptApart} of ${found.kept} differ, by ${found.keptMost} units in the last place at most; ` +
        `beside this processor's: ${found.twinApart} of ${found.twin}, by ${found.twinMost}`,
    );
    expect(found.twinMost).toBeLessThanOrEqual(1);
  });
});

describe("documents", () => {
  interface Kept {
    readonly reader: string;
    readonly text: string;
    readonly answer: { readonly written?: string; readonly error?: string };
  }
  /** A message without the differences of JSON's values from Python's: quotes, blanks, names of types, order of fields. */
  const plain = (message: string | undefined): string | undefined => {
    const names = { "a dict": "an object", "a str": "a text", "\\x": "\\u00", None: "null", True: "true", False: "false" };
    for (const [python, json] of Object.entries(names)) message = message?.replaceAll(python, json);
    const letters = message?.replace(/[\s'"\\]/g, "");
    return letters?.includes("{") ? [...letters].sort().join("") : letters;
  };
  /** Documents with two faults, of which Python finds the other one first. */
  const OF_TWO_FAULTS = [
    ...["10", "59"].map((number) => `materials: materials of ct, damaged ${number}`),
    ...["13", "50", "53"].map((number) => `scene: everything, damaged ${number}`),
  ];
  const documents = lines(given("WAVESPLAT_DOCUMENTS")).map((line) => JSON.parse(line) as [string, Kept]);

  test("are taken and refused in Python's words", async () => {
    const module = await VolumeModule.of(compiled);
    const calls: object[] = [];
    const answers: Told[] = [];
    let [refused, unread, taken, elsewhere] = [0, 0, 0, 0];
    for (const [name, { reader, text, answer }] of documents) {
      if (reader === "patch") continue;
      const asked = { kind: reader as DocumentKind, text };
      const ours = told(() => module.check(asked.kind, text));
      calls.push({ ask: "check", asked });
      answers.push(ours);
      if (ours.error === undefined) {
        // What the parts of a document make together (nodes in order, files that are there) is for those who make it.
        if (answer.error === undefined) taken += 1;
        else elsewhere += 1;
      } else if (ours.error.startsWith("not JSON")) {
        unread += 1;
        expect(answer.error, name).toBeDefined();
      } else {
        refused += 1;
        if (OF_TWO_FAULTS.includes(name)) expect(answer.error, name).toMatch(/number 1: material 'fat'|: clip/);
        // Python takes reports with a scene in them too.
        else expect(plain(answer.error?.replace(', or a report with one in "scene"', "")), name).toBe(plain(`ArgumentError: ${ours.error}`));
      }
    }
    const value = ({ text, error }: Told): unknown => (text === undefined ? error : JSON.parse(text));
    expect(answers.map(value)).toEqual(twin(calls).map(value));
    console.log(`documents: ${taken} taken, ${refused} refused in Python's words, ${unread} no JSON, ${elsewhere} refused by their makers alone`);
    expect(refused).toBeGreaterThan(350);
  });

  test("are patched as by Python", async () => {
    const module = await VolumeModule.of(compiled);
    let done = 0;
    for (const [name, { reader, text, answer }] of documents) {
      if (reader !== "patch") continue;
      let given: { document?: unknown; operations?: unknown };
      try {
        given = JSON.parse(text) as typeof given;
      } catch {
        continue;
      }
      // Larger whole numbers are others in JavaScript.
      if (!numbersIn(given).every((number) => Math.abs(number) <= Number.MAX_SAFE_INTEGER)) continue;
      if (given === null || typeof given !== "object" || !("document" in given)) given = { document: {}, operations: given };
      const ours = told(() => module.patch(given.document, given.operations ?? null));
      done += 1;
      if (ours.error === undefined) {
        expect(answer.error, name).toBeUndefined();
        expect(JSON.parse(ours.text as string), name).toEqual(JSON.parse(answer.written as string));
      }
      // In texts of Python half of a letter may stand where it is not written.
      else if (ours.error.startsWith("not JSON")) expect(answer.error ?? text, name).toMatch(/\\ud800|:/);
      else expect(plain(answer.error), name).toBe(plain(`ArgumentError: ${ours.error}`));
    }
    expect(done).toBeGreaterThan(150);
  });
});

describe("pictures", () => {
  const N = 40;
  const HEAD: SamplesHead = {
    name: "ball",
    type: "int16",
    size: [N, N, N],
    world_from_index: [[0.9, 0.1, 0, -20], [-0.1, 0.9, 0, 3], [0, 0, 1.5, 7]],
    facts: { unit: "mm", is_anatomical: true, modality: "CT" },
  };
  /** A ball of bone in soft tissue, with waves. */
  const samples = Int16Array.from({ length: N ** 3 }, (_, at) => {
    const [x, y, z] = [at % N, Math.floor(at / N) % N, Math.floor(at / N / N)].map((place) => place - (N - 1) / 2) as [number, number, number];
    const r = Math.hypot(x, y, z);
    return Math.round((r < 8 ? 900 : r < 15 ? 60 : -1000) + 40 * Math.sin(x * 0.7 + y * 0.3));
  });
  const bytes = new Uint8Array(samples.buffer);
  const ramp = { version: 1, transfer_function: { opacity: [[-200, 0], [900, 0.3]], color: [[-200, 0.2, 0.4, 1], [900, 1, 0.9, 0.5]] } };

  /** Powers, exponentials and sines of light's tables have other last places in WebAssembly than in this system's library. */
  const FLOATS_APART = 2e-7;
  const inScratch = (name: string): string => join(given("WAVESPLAT_SCRATCH"), name);

  test("have the bytes of this processor, and its floats to last places", async () => {
    const path = inScratch("ball.raw");
    const module = await VolumeModule.of(compiled);
    const asked: [string, object][] = [];
    for (const look of [{ preset: "ct-bone" }, { preset: "ct-lung" }, { document: ramp }, { document: { ...ramp, composite: "maximum", shading: null } }]) {
      asked.push(["look", look]);
      for (const [wish, quality] of [[{ fit: true }, "normal"], [{ orbit: [40, 25], view_angle: 40 }, "draft"], [{ view: "superior" }, "fine"]] as const) {
        asked.push(["camera", wish], ["draw", { size: [96, 80], quality }], ["floats", {}]);
      }
    }
    // Scenes that Python wrote, those with one volume.
    for (const line of lines(new URL("../../crates/wavesplat/tests/scenes.jsonl", import.meta.url))) {
      const { document } = JSON.parse(line) as { document: { layers: unknown[]; labels?: unknown } };
      // The ball is of a CT, which might have a table.
      if (document.layers.length === 1 && !document.labels) asked.push(["scene", { document: { ...document, keep_table: true } }], ["draw", { size: [48, 40] }], ["floats", {}]);
    }
    const nScenes = asked.filter(([ask]) => ask === "scene").length;
    expect(nScenes).toBeGreaterThan(5);
    const slab = { n_planes: 3, step: [0, 0, 1], reduction: "mean" };
    asked.push(["slice", { origin: [-18, 4, 30], across: [0.5, 0, 0.1], down: [0, 0.5, 0], size: [60, 50], slab }]);
    writeFileSync(path, bytes);
    const theirs = twin([{ samples: HEAD, path }, ...asked.map(([ask, asked], at) => ({ ask, asked, ...(ask === "floats" ? { save: inScratch(`${at}`) } : {}) }))]);
    expect(module.vectors()).toBe("simd128");
    expect(told(() => module.openSamples(HEAD, bytes)).text).toBe(JSON.stringify(JSON.parse(theirs[0]?.text as string)));
    const crcs = new Set<number>();
    let apart = 0;
    for (const [at, [question, wish]] of asked.entries()) {
      const ours = told(() => {
        if (question === "look") return module.look(wish as never);
        if (question === "scene") return module.scene((wish as { document: unknown }).document);
        if (question === "camera") return module.camera(wish as never);
        if (question === "slice") return module.slice(wish as never);
        if (question === "floats") return module.floats();
        const { size, quality } = wish as { size: [number, number]; quality?: "draft" };
        return module.draw(size, quality);
      });
      expect(ours.error).toBeUndefined();
      const their = theirs[at + 1];
      if (ours.crc32 === undefined) {
        expect(JSON.parse(ours.text as string), question).toEqual(JSON.parse(their?.text as string));
        continue;
      }
      crcs.add(ours.crc32);
      if (question !== "floats") {
        expect(ours.crc32, `${question} ${at}`).toBe(their?.crc32);
        continue;
      }
      const native = new Float32Array(readFileSync(inScratch(`${at}`)).buffer);
      const differ = [...module.floats()].map((float, pixel) => Math.abs(float - (native[pixel] as number))).filter((off) => off !== 0);
      apart += differ.length;
      expect(Math.max(0, ...differ)).toBeLessThan(FLOATS_APART);
    }
    expect(crcs.size).toBeGreaterThan(25);
    console.log(`pictures: bytes are equal, ${apart} of ${(12 * 96 * 80 + nScenes * 48 * 40) * 4} floats differ in last places`);
  });
});

describe("an instance", () => {
  test("says what is missing, and goes on", async () => {
    const module = await VolumeModule.of(compiled);
    expect(() => module.kind()).toThrow("no volume is open; open one before 'kind'");
    expect(() => module.open("a.nii", new Uint8Array())).toThrow("the file is empty; copy or export it again: a.nii");
    const file = CASES[0] as FileCase;
    module.open(file.file, Buffer.from(file.bytes, "hex"));
    expect(() => module.draw([8, 8])).toThrow("there is no look yet; ask 'look' before");
    expect(() => module.look({ preset: "none" })).toThrow("none");
    module.look({ preset: "ct-bone" });
    expect(() => module.draw([8, 8])).toThrow("there is no camera yet; ask 'camera' before");
    expect(() => module.camera({ view: "inside" })).toThrow("inside");
    module.camera({ fit: true });
    expect(() => module.draw([0, 8])).toThrow(ModuleError);
    expect(module.draw([8, 8]).length).toBe(256);
    expect(() => module.open(file.file, Buffer.from(file.bytes, "hex"))).toThrow("a volume is open already; the next one needs a new instance");
  });

  test("gives back the memory of what it refuses", async () => {
    const module = await VolumeModule.of(compiled);
    const flat = [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]];
    const samples = new Uint8Array(256 * 256 * 64);
    const head: SamplesHead = { name: "flat", type: "uint8", size: [256, 256, 64], world_from_index: flat };
    const refuse = () => expect(() => module.openSamples(head, samples)).toThrow(ModuleError);
    refuse();
    const before = module.memoryBytes;
    for (let time = 0; time < 8; time += 1) refuse();
    // Texts may lie in the room of the first samples.
    expect(module.memoryBytes - before).toBeLessThan(2 * samples.length);
  });

  test("has ended when memory is refused", async () => {
    const module = await VolumeModule.of(compiled);
    const huge = { length: 2 ** 32 - 2 ** 20 } as Uint8Array;
    expect(() => module.open("huge.nii", huge)).toThrow(/memory is refused: 4293918720 bytes more than the \d+ that are taken/);
    expect(() => module.presets()).toThrow(ModuleEnded);
  });
});
