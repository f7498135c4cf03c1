// The check of states, which is written from the tables of crates/document, agrees with it and with the session.

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

test("random patches of a state are taken and refused as crates/document does", () => {
  const [first, ...cases] = readFileSync(new URL("random.jsonl", SCHEMA), "utf8")
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line) as { operations: Operation[]; fault: string | null; state?: unknown });
  const rich = first?.state;
  const told = (operations: Operation[]): string | null => {
    try {
      parseViewerState(patched(rich, operations));
      return null;
    } catch (error) {
      return String(error);
    }
  };
  expect(told([])).toBe(null);
  const others = cases.filter(({ operations, fault }) => (told(operations) === null) !== (fault === null));
  expect(others.map((one) => [JSON.stringify(one.operations), one.fault, told(one.operations)])).toEqual([]);
  expect(cases.filter(({ fault }) => fault === null).length).toBeGreaterThan(cases.length / 20);
});
