// The parser of states and its twin in Python agree on the fixtures.

import { readdirSync, readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { parseViewerState } from "../src/state/parse.ts";
import { patched, type Operation } from "../src/state/patch.ts";

const SCHEMA = new URL("../schema/", import.meta.url);
const read = (name: string): unknown => JSON.parse(readFileSync(new URL(name, SCHEMA), "utf8"));
const names = (folder: string): string[] => readdirSync(new URL(folder, SCHEMA)).filter((name) => name.endsWith(".json"));
const state = read("state.json") as Record<string, unknown>;

test("the state of Python is one", () => {
  expect(parseViewerState(state)).toBe(state);
});

test.each(names("good/"))("good: %s", (name) => {
  expect(() => parseViewerState({ ...state, ...(read(`good/${name}`) as object) })).not.toThrow();
});

test.each(names("bad/"))("bad: %s", (name) => {
  const { field, operations } = read(`bad/${name}`) as { field: string; operations: Operation[] };
  const told = (): unknown => {
    try {
      return parseViewerState(patched(state, operations));
    } catch (error) {
      return String(error);
    }
  };
  expect(told()).toContain(field);
});

test.each([null, 3, "x", [], {}])("%o is none", (document) => {
  expect(() => parseViewerState(document)).toThrow();
});
