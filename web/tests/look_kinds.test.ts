import { expect, test } from "vitest";

import type { PresetInfo, VolumeInfo } from "../src/engine/engine.ts";
import { isOffered, titleOf } from "../src/view/look/preset_kinds.ts";

const preset = (name: string, kind: string): PresetInfo => ({ name, kind, description: "", layers: [0] });
const volume = (kind: string) => ({ kind }) as VolumeInfo;
const PET = preset("pet", "pet");
const BRAIN = preset("mr-brain", "mr");
const GREY = preset("grey", "any");

test.each([
  ["MR", PET, false],
  ["MR", BRAIN, true],
  ["PET", BRAIN, false],
  ["PET", PET, true],
  ["MR", GREY, true],
  // Of a scan of no fixed scale nothing is known: all that fit are offered.
  ["scan", BRAIN, true],
])("for %s the preset %o is offered: %s", (kind, one, isOne) => {
  expect(isOffered(one, 0, volume(kind))).toBe(isOne);
});

test("a preset that does not fit the layer is not offered", () => {
  expect(isOffered({ ...GREY, layers: [1] }, 0, volume("MR"))).toBe(false);
});

test.each([
  ["ct-bone", "Bone"],
  ["slicer-CT-Bone", "CT Bone"],
  ["CT-Coronary-Arteries-2", "CT Coronary Arteries 2"],
  ["my own-look", "my own-look"],
])("%s is called %s", (name, title) => {
  expect(titleOf(name)).toBe(title);
});
