// Operations between two documents: applied to the first one they give the second one, whatever these are.

import { expect, test } from "vitest";

import { differences } from "../src/state/differences.ts";
import { patched, set } from "../src/state/patch.ts";
import { STATE } from "./session_fake.ts";

test.each([
  [{ a: 1, b: { c: [1, 2], d: null } }, { a: 1, b: { c: [1, 2], d: null } }, 0],
  [{ a: 1, b: { c: [1, 2], d: null } }, { a: 2, b: { c: [1, 3], d: {} } }, 3],
  [{ "a/b": 1, "~": 2 }, { "a/b": 2, x: [] }, 3],
  [{ a: [{ b: 1 }] }, { a: [{ b: 1 }] }, 0],
  [{ a: [{ b: 1 }] }, { a: [{ b: 1, c: 2 }] }, 1],
  [{ a: [1] }, { a: [1, 2] }, 1],
  [{ a: [1, 2] }, { a: [1] }, 1],
  [{ a: [] }, { a: {} }, 1],
  [{ a: null }, { a: 0 }, 1],
])("%j and %j", (before, after, n) => {
  const operations = differences(before, after);
  expect(operations).toHaveLength(n);
  expect(patched(before, operations)).toEqual(after);
});

test("a field of a state is one operation, whatever else there is", () => {
  const copy = JSON.parse(JSON.stringify(STATE)) as typeof STATE;
  const after = patched(copy, [set(20, "camera", "parallel_scale")]);
  expect(differences(STATE, after)).toEqual([{ op: "replace", path: "/camera/parallel_scale", value: 20 }]);
});
