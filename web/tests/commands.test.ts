import { expect, test } from "vitest";

import { commandsOf, found } from "../src/view/commands.ts";
import type { PartProps } from "../src/view/part.ts";
import { typedCommand } from "../src/view/typed.ts";

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
  ui: { host: "page", layer: 0, views: { last: "z" }, frames: { z: { slice: { range: [0, 111 * 3] } }, y: { slice: { range: [0, 49 * 3] } } } },
  welcome: {
    presets: [], window_names: {}, axis_ends: ["L", "R", "P", "A", "I", "S"],
    volumes: [{ value_unit: "HU", n_times: 1, is_anatomical: true, unit: "mm", bounds: [[-200, -200, -50], [200, 200, 333]], affine: [[3, 0, 0, 0], [0, 3, 0, 0], [0, 0, 3, 0], [0, 0, 0, 1]] }],
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
  ["go to 12, 40, -30", "Go to R 12.0 A 40.0 I 30.0 mm", [12, 40, -30]],
  // As the page prints a place, in any order, and by x, y, z.
  ["go to L 34.2 A 164.8 S 260.8 mm", "Go to L 34.2 A 164.8 S 260.8 mm", [-34.2, 164.8, 260.8]],
  ["goto s 2 mm, p 3 mm, r 4 mm", "Go to R 4.0 P 3.0 S 2.0 mm", [4, -3, 2]],
  ["go to z=2 x=-3 y=4", "Go to L 3.0 A 4.0 S 2.0 mm", [-3, 4, 2]],
  ["go to 12,5 140 -.5", "Go to R 12.5 A 140.0 I 0.5 mm", [12.5, 140, -0.5]],
  ["go to 12,5,1e2", "Go to R 12.0 A 5.0 S 100.0 mm", [12, 5, 100]],
  ["go to .5, -.25, +2e1", "Go to R 0.5 P 0.3 S 20.0 mm", [0.5, -0.25, 20]],
  ["window 40 400", "Level 40, width 400", [40, 400]],
  ["window 1e3 2E-3", "Level 1000, width 0.002", [1000, 0.002]],
  ["w/l 40,5 400", "Level 40.5, width 400", [40.5, 400]],
  ["window width 400 level 40", "Level 40, width 400", [40, 400]],
  ["level -60 window 300 HU", "Level -60, width 300", [-60, 300]],
  ["window 300 level 60", "Level 60, width 300", [60, 300]],
  ["level 60 width 300", "Level 60, width 300", [60, 300]],
  ["W 400 L 40", "Level 40, width 400", [40, 400]],
  ["L 40 W 400", "Level 40, width 400", [40, 400]],
  ["slice 56", "Axial: slice 56 of 112", [1, 2, 165]],
  ["slice coronal 21", "Coronal: slice 21 of 50", [1, 60, 3]],
  ["slice y 21", "Coronal: slice 21 of 50", [1, 60, 3]],
])("%j is a command that Enter does", (text, name, value) => {
  changes.length = 0;
  const command = found(commandsOf(PART, text), text)[0];
  expect(command?.text).toBe(name);
  command?.run();
  expect(changes).toEqual([[expect.objectContaining({ value })]]);
});

test.each([
  "slice 400", "slice sagittal 20", "slice oblique 20", "slice 5.5", "go to L 3 R 4 S 5", "go to L 3 4 5", "go to Q 3 A 4 S 5", "go to 1 2", "go to 1, 2",
  "window 1 2 3", "window 1 1e999",  "go to 1.2.3 4 5", "window 40 -400", "window level 40 level 400", "window nose 40 400", "40 400",
])("%j is no command", (text) => {
  expect(typedCommand(PART, text)).toEqual([]);
});

test("a place outside of the volume is said to be one, and the text stays", () => {
  changes.length = 0;
  const [command] = found(commandsOf(PART, "go to L 201 A 0 S 0"), "go to L 201 A 0 S 0");
  command?.run();
  expect(changes).toEqual([]);
  expect(command).toMatchObject({
    text: "L 201.0 A 0.0 S 0.0 mm is outside of the volume", hint: "it reaches from L 200.0 P 200.0 I 50.0 mm to R 200.0 A 200.0 S 333.0 mm",
    fill: "go to L 201 A 0 S 0",
  });
});
