// The user's own presets: looks under names, with a picture, kept by the browser.

import type { Composite, Look } from "../../state/state.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.ownPresets;
export interface OwnPreset {
  readonly name: string;
  readonly look: Look;
  /** The operator with its parameters, where it is not the look's. */
  readonly composite?: Composite;
  /** A data URL, or "" where there was no picture. */
  readonly picture: string;
}

/** The part of `localStorage` that is used. */
export interface Keeper {
  getItem(key: string): string | null;
  setItem(key: string, value: string): void;
}

const KEY = "wavesplat.presets";

/** The browser's storage; null where it keeps nothing for this page. */
export function keeper(): Keeper | null {
  try {
    return globalThis.localStorage ?? null;
  } catch {
    return null;
  }
}

export function ownPresets(kept: Keeper | null = keeper()): readonly OwnPreset[] {
  try {
    const found: unknown = JSON.parse(kept?.getItem(KEY) ?? "[]");
    return Array.isArray(found) ? found.filter(isPreset) : [];
  } catch {
    return [];
  }
}

export function ownPreset(name: string, kept: Keeper | null = keeper()): OwnPreset | undefined {
  return ownPresets(kept).find((preset) => preset.name === name);
}

/** Keeps a preset, in place of an older one of that name. Throws where the browser does not keep it. */
export function keepPreset(preset: OwnPreset, kept: Keeper | null = keeper()): readonly OwnPreset[] {
  return write([...ownPresets(kept).filter(({ name }) => name !== preset.name), preset], kept);
}

export function dropPreset(name: string, kept: Keeper | null = keeper()): readonly OwnPreset[] {
  return write(
    ownPresets(kept).filter((preset) => preset.name !== name),
    kept,
  );
}

export function renamePreset(from: string, to: string, kept: Keeper | null = keeper()): readonly OwnPreset[] {
  const renamed = ownPresets(kept)
    .filter(({ name }) => name !== to || name === from)
    .map((preset) => (preset.name === from ? { ...preset, name: to, look: { ...preset.look, name: to } } : preset));
  return write(renamed, kept);
}

/** A sentence on why a name cannot be taken, or null. */
export function nameProblem(name: string, taken: readonly string[]): string | null {
  if (name === "") return TEXT.noName;
  if (name.length > 100) return TEXT.longName;
  const same = taken.find((one) => one.toLowerCase() === name.toLowerCase());
  return same === undefined ? null : TEXT.takenName(same);
}

function write(presets: readonly OwnPreset[], kept: Keeper | null): readonly OwnPreset[] {
  if (kept === null) throw new Error(TEXT.noStorage);
  kept.setItem(KEY, JSON.stringify(presets));
  return presets;
}

function isPreset(found: unknown): found is OwnPreset {
  if (typeof found !== "object" || found === null) return false;
  const { name, look, picture } = found as Record<string, unknown>;
  return typeof name === "string" && typeof picture === "string" && typeof look === "object" && look !== null;
}
