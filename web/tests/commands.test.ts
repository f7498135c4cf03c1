import { expect, test } from "vitest";

import { found } from "../src/view/commands.ts";

const COMMANDS = [
  { text: "Turn to the left", hint: "←" },
  { text: "From the left", hint: "3" },
  { text: "Bone (ct-bone)", hint: "Look" },
  { text: "bone", hint: "Window of slices" },
];
const texts = (text: string): string[] => found(COMMANDS, text).map(({ text: name }) => name);

test.each([
  ["", COMMANDS.map(({ text }) => text)],
  ["left", ["Turn to the left", "From the left"]],
  ["from", ["From the left"]],
  ["bone look", ["Bone (ct-bone)"]],
  ["slices bone", ["bone"]],
  ["BONE", ["Bone (ct-bone)", "bone"]],
  ["nothing of this", []],
])("%j finds %j", (text, names) => {
  expect(texts(text)).toEqual(names);
});

test("those that begin with the text come first", () => {
  expect(found([{ text: "ct-bone", hint: "" }, { text: "bone", hint: "" }], "bone").map(({ text }) => text)).toEqual(["bone", "ct-bone"]);
});
