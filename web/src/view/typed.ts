// Commands that are typed with numbers, such as "go to 12, 40, -30", "width 400 level 40" and "slice coronal 20". Words decide which
// number is which; a text with a word that is not known is no command.

import { set } from "../state/patch.ts";
import { PANES, type Vec3 } from "../state/state.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import type { Command } from "./deeds.ts";
import { axisName, placeText } from "./descriptions.ts";
import type { PartProps } from "./part.ts";
import { crosshairAt } from "./slices/moves.ts";
import { numberedSlice, sliceAt } from "./slices/numbers.ts";
import { nameOf } from "./slices/panes.ts";

const TEXT = PANEL_WORDS.deeds;
/** Words, and the number behind them. */
const PART = /([^-+.\d]*)([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?![.\d])/giy;
const OF_LEVEL = ["level", "l", "wc", "center", "centre"];
const OF_WIDTH = ["width", "w", "ww"];
const OF_BOTH = ["window", "wl"];

interface Said {
  readonly words: readonly string[];
  readonly value: number;
}

/** The command that a text with numbers is; none for other texts. */
export function typedCommand(part: PartProps, text: string): Command[] {
  const units = part.welcome.volumes.flatMap(({ unit, value_unit }) => [unit, value_unit]);
  const goal = /^\s*go\s?to\b(.*)$/i.exec(text)?.[1];
  if (goal !== undefined) {
    const point = pointOf(saidIn(goal, 3, units), part.welcome);
    return point === null ? [] : [goTo(part, text, point)];
  }
  return [...windowed(part, saidIn(text.replace(/\bw\s*\/\s*l\b/i, "wl"), 2, units)), ...sliced(part, saidIn(text, 1, []))];
}

/** The numbers of a text with the words before them; null where there are more or fewer, or where anything but a unit follows. */
function saidIn(text: string, count: number, units: readonly (string | null)[]): Said[] | null {
  const plain = text.replaceAll("−", "-").replace(/[()[\];:=]/g, " ");
  const isUnit = (word: string): boolean => units.some((unit) => unit?.toLowerCase() === word);
  const wordsOf = (words: string): string[] => words.toLowerCase().split(/\s+/).filter((word) => word !== "" && !isUnit(word));
  // A comma between digits is a decimal one where the text has as many numbers as it should have.
  for (const one of [plain.replace(/(\d),(?=\d)/g, "$1."), plain]) {
    const clear = one.replaceAll(",", " ");
    const parts = [...clear.matchAll(PART)];
    const rest = clear.slice(parts.reduce((end, [all]) => end + all.length, 0));
    const said = parts.map(([, words = "", value]) => ({ words: wordsOf(words), value: Number(value) }));
    if (said.length === count && wordsOf(rest).length === 0 && said.every(({ value }) => Number.isFinite(value))) return said;
  }
  return null;
}

/** The world point of three numbers, in order, or each behind the name of its axis or side as `placeText` writes it; else null. */
export function pointOf(said: readonly Said[] | null, welcome: PartProps["welcome"]): Vec3 | null {
  if (said === null) return null;
  if (said.every(({ words }) => words.length === 0)) return said.map(({ value }) => value) as unknown as Vec3;
  const point: (number | undefined)[] = [undefined, undefined, undefined];
  for (const { words, value } of said) {
    const [word = "", ...others] = words.filter((one) => one !== "at");
    for (const axis of [0, 1, 2]) {
      const isNamed = (sign: number): boolean => axisName(axis, sign, welcome).toLowerCase() === word;
      if (others.length > 0 || point[axis] !== undefined) continue;
      if (isNamed(1) || "xyz"[axis] === word) point[axis] = value;
      else if (isNamed(-1)) point[axis] = -value;
    }
  }
  return point.every((value) => value !== undefined) ? (point as unknown as Vec3) : null;
}

/** Moves the crosshair to a point; where that is outside of the volume, says so, and the text stays. */
function goTo({ store, welcome }: PartProps, text: string, point: Vec3): Command {
  const [lower, upper] = welcome.volumes[0]?.bounds ?? welcome.bounds;
  const name = placeText(point, welcome);
  if (point.every((value, axis) => value >= (lower[axis] ?? 0) && value <= (upper[axis] ?? 0))) {
    return { text: TEXT.goToPoint(name), hint: TEXT.typed, run: () => store.change(crosshairAt(store.state, point)) };
  }
  return { text: TEXT.outside(name), hint: TEXT.reaches(placeText(lower, welcome), placeText(upper, welcome)), fill: text, run: () => undefined };
}

/** Sets level and width of slices, in this order where no word says another one. */
function windowed({ store }: PartProps, said: readonly Said[] | null): Command[] {
  const [first, second] = said ?? [];
  if (first === undefined || second === undefined || first.words.length === 0) return [];
  const meaning = ({ words }: Said): "level" | "width" | "open" | "unknown" => {
    const [own, ...others] = words.filter((word) => !OF_BOTH.includes(word));
    if (own === undefined) return "open";
    if (others.length > 0) return "unknown";
    return OF_LEVEL.includes(own) ? "level" : OF_WIDTH.includes(own) ? "width" : "unknown";
  };
  const [one, other] = [meaning(first), meaning(second)];
  const isUnclear = one === "open" && other === "open" && second.words.length > 0;
  if (one === "unknown" || other === "unknown" || isUnclear || (one === other && one !== "open")) return [];
  const isTurned = one === "width" || other === "level";
  const [level, width] = isTurned ? [second.value, first.value] : [first.value, second.value];
  if (!(width > 0)) return [];
  return [{ text: TEXT.windowOf(level, width), hint: TEXT.typed, run: () => store.change([set([level, width], "view", "slices", "window")]) }];
}

/** Goes to a slice of the plane that is named, else of the pane that was used last. */
function sliced(part: PartProps, said: readonly Said[] | null): Command[] {
  const { store, ui } = part;
  const [number] = said ?? [];
  if (number === undefined || !number.words.includes("slice")) return [];
  const [plane, ...others] = number.words.filter((word) => word !== "slice");
  const named = PANES.find((one) => plane === one || plane === nameOf(part, one).toLowerCase());
  if (others.length > 0 || (plane !== undefined && named === undefined)) return [];
  const pane = named ?? PANES.find((one) => one === ui.views.last) ?? PANES.find((one) => ui.frames[one] !== undefined) ?? "z";
  const at = sliceAt(part, pane, number.value);
  const now = numberedSlice(part, pane);
  if (at === null || now === null) return [];
  return [{ text: TEXT.sliceOf(nameOf(part, pane), number.value, now.count), hint: TEXT.typed, run: () => store.change(crosshairAt(store.state, at)) }];
}
