import { expect, test } from "vitest";

import { commandsOf, found } from "../src/view/commands.ts";
import type { PartProps } from "../src/view/part.ts";

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

/** A page with one volume, as far as the list of commands reads it. */
const changes: unknown[] = [];
const PART = {
  store: {
    state: {
      layers: [{ name: "CT", visible: true, look: {} }], labels: null, camera: {},
      view: {
        layout: { name: "two-by-two", main: "3d" }, overlays: { scale_bar: true }, interface: { panels: [], theme: "dark" },
        slices: { crosshair: [1, 2, 3], zoom: 1 },
      },
    },
    change: (operations: unknown) => changes.push(operations),
  },
  ui: { host: "page", layer: 0, views: { last: "z" }, frames: { z: { slice: { range: [0, 111 * 3] } } } },
  welcome: {
    presets: [], window_names: {}, axis_ends: ["L", "R", "P", "A", "I", "S"],
    volumes: [{ value_unit: "HU", n_times: 1, is_anatomical: true, affine: [[3, 0, 0, 0], [0, 3, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]] }],
  },
} as unknown as PartProps;

test.each([
  ["save", "Save picture"], ["export", "Save picture"], ["screenshot", "Save picture"], ["link", "Copy link"], ["movie", "Copy as movie command"],
  ["turntable", "Copy as movie command"], ["video", "Copy as movie command"], ["compare", "Open"], ["distance", "Measure a distance"], ["ruler", "Measure a distance"],
  ["angle", "Measure an angle"], ["crop", "Crop"], ["background", "Background"], ["perspective", "Perspective"], ["full screen", "Full screen"],
  ["value", "Go to a position"], ["goto", "Go to a position"], ["undo", "Undo"], ["scale bar", "Hide Scale bar"], ["roi", "Measure a region"],
])("%j finds the deed %j first", (word, deed) => {
  expect(found(commandsOf(PART, word), word)[0]?.text).toBe(deed);
});

test.each([
  ["go to 12, 40, -30", "Go to 12, 40, -30", [12, 40, -30]],
  ["go to .5, -.25, +2e1", "Go to 0.5, -0.25, 20", [0.5, -0.25, 20]],
  ["window 40 400", "Level 40, width 400", [40, 400]],
  ["window 1e3 2E-3", "Level 1000, width 0.002", [1000, 0.002]],
  ["slice 56", "Axial: slice 56 of 112", [1, 2, 165]],
])("%j is a command that Enter does", (text, name, value) => {
  changes.length = 0;
  const command = found(commandsOf(PART, text), text)[0];
  expect(command?.text).toBe(name);
  command?.run();
  expect(changes).toEqual([[expect.objectContaining({ value })]]);
});

test.each(["go to 1, 2", "window 1 2 3", "window 1 1e999"])("%j, with other numbers, is no command", (text) => {
  expect(found(commandsOf(PART, text), text).map(({ text: name }) => name)).toEqual([]);
});

test("a slice that is not there is no command", () => {
  expect(found(commandsOf(PART, "slice 400"), "slice 400").map(({ text }) => text)).toEqual([]);
});
