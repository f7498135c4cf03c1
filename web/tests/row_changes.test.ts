import { expect, test } from "vitest";

import type { LayerChange, Problem } from "../src/engine/engine.ts";
import type { PartProps } from "../src/view/part.ts";
import { changeRow, typedValue } from "../src/view/look/row_changes.ts";

test.each([
  ["2.5", false, 2.5], [" -1e-3 ", true, -0.001], ["5 %", false, "5 %"], ["", true, null],
] as const)("%j is a value", (text, isOptional, value) => {
  expect(typedValue(text, "From", isOptional)).toBe(value);
});

test.each([["abc", false], ["", false], ["5 %", true], ["1e999", true], ["1,5", false]] as const)("%j is told to be none", (text, isOptional) => {
  expect(() => typedValue(text, "Hide below", isOptional)).toThrow(/Hide below: .* is no value; type a number/);
});

/** A row whose session answers when the test says so. */
function row() {
  const asked: { layer: number; give: (operations: unknown[]) => void }[] = [];
  const changes: unknown[] = [];
  const problems: Problem[] = [];
  const state = { layers: [{ volume: { id: "a" } }, { volume: { id: "b" } }, { volume: { id: "c" } }] };
  const part = {
    engine: {
      ask: (_: string, { layer }: { layer: number }) =>
        new Promise((resolve) => asked.push({ layer, give: (operations) => resolve({ operations }) })),
    },
    store: { state, change: (operations: unknown) => changes.push(operations), settle: () => changes.push("settled") },
    ui: { problem: (problem: Problem) => problems.push(problem) },
  } as unknown as PartProps;
  const queue = { waiting: [], isBusy: false };
  return { asked, changes, problems, state, change: (wanted: LayerChange | null, gesture?: string) => changeRow(part, 1, queue, wanted, gesture) };
}

test("of a gesture the newest wish alone waits, and its end comes after it", async () => {
  const { asked, changes, change } = row();
  const done = change({ gamma: 1.1 }, "gamma");
  for (const gamma of [1.2, 1.3]) void change({ gamma }, "gamma");
  void change(null);
  asked[0]?.give([1]);
  await expect.poll(() => asked.length).toBe(2);
  asked[1]?.give([3]);
  await done;
  expect(changes).toEqual([[1], [3], "settled"]);
});

test("an answer for a layer that was removed meanwhile changes no other one", async () => {
  const { asked, changes, problems, state, change } = row();
  const done = change({ gamma: 2 });
  void change({ gamma: 3 });
  state.layers.splice(0, 1);
  asked[0]?.give([{ op: "add", path: "/layers/1/look", value: {} }]);
  await done;
  expect([asked.length, changes, problems]).toEqual([1, [], []]);
});
