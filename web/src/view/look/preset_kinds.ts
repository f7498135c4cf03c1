// Presets by kind of data: which ones are offered for a volume, and their names for people.

import type { PresetInfo, VolumeInfo } from "../../engine/engine.ts";
import { WORDS } from "../../words.ts";

/** Groups of presets for each kind of data; all that fit are offered for kinds that are not here. */
const GROUPS: Readonly<Record<string, readonly string[]>> = {
  CT: ["ct", "any"],
  MR: ["mr", "any"],
  PET: ["pet", "any"],
  fluorescence: ["microscopy", "any"],
  EM: ["microscopy", "any"],
  field: ["simulation", "any"],
  "signed field": ["simulation", "any"],
  dose: ["simulation", "any"],
};

/** Whether a preset is for the kind of data of a layer. */
export function isOffered(preset: PresetInfo, layer: number, volume: VolumeInfo | undefined): boolean {
  const groups = GROUPS[volume?.kind ?? ""];
  return preset.layers.includes(layer) && (groups === undefined || groups.includes(preset.kind));
}

/** The name of a preset for people. */
export function titleOf(name: string): string {
  const known = WORDS.looks[name];
  if (known !== undefined) return known;
  // Presets of 3D Slicer: "slicer-CT-Bone", "CT-Coronary-Arteries-2".
  return /^(slicer-)?(CT|MR|DTI|US|uCT)-/.test(name) ? name.replace(/^slicer-/, "").replaceAll("-", " ") : name;
}
