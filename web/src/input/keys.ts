// The keys, as data: their actions, and their texts in the table that is shown by `?`.

import { WORDS } from "../words.ts";

export interface Key {
  /** Names of key presses, as `keyName` gives them. */
  readonly keys: readonly string[];
  readonly action: Action;
  /** The key as the table shows it. */
  readonly shown: string;
  readonly text: string;
}

export type Action =
  | "turn-left" | "turn-right" | "turn-up" | "turn-down"
  | "pan-left" | "pan-right" | "pan-up" | "pan-down"
  | "zoom-in" | "zoom-out" | "roll-left" | "roll-right"
  | "view-front" | "view-back" | "view-left" | "view-right" | "view-top" | "view-bottom"
  | "fit" | "first-view" | "level" | "slice-back" | "slice-on" | "play" | "undo" | "redo" | "find" | "help" | "leave";

const BOUND: readonly Omit<Key, "text">[] = [
  { keys: ["ArrowLeft"], action: "turn-left", shown: "←" },
  { keys: ["ArrowRight"], action: "turn-right", shown: "→" },
  { keys: ["ArrowUp"], action: "turn-up", shown: "↑" },
  { keys: ["ArrowDown"], action: "turn-down", shown: "↓" },
  { keys: ["Shift+ArrowLeft"], action: "pan-left", shown: "Shift ←" },
  { keys: ["Shift+ArrowRight"], action: "pan-right", shown: "Shift →" },
  { keys: ["Shift+ArrowUp"], action: "pan-up", shown: "Shift ↑" },
  { keys: ["Shift+ArrowDown"], action: "pan-down", shown: "Shift ↓" },
  { keys: ["+", "="], action: "zoom-in", shown: "+" },
  { keys: ["-", "_"], action: "zoom-out", shown: "−" },
  { keys: [","], action: "roll-left", shown: "," },
  { keys: ["."], action: "roll-right", shown: "." },
  { keys: ["1"], action: "view-front", shown: "1" },
  { keys: ["2"], action: "view-back", shown: "2" },
  { keys: ["3"], action: "view-left", shown: "3" },
  { keys: ["4"], action: "view-right", shown: "4" },
  { keys: ["5"], action: "view-top", shown: "5" },
  { keys: ["6"], action: "view-bottom", shown: "6" },
  { keys: ["0"], action: "first-view", shown: "0" },
  { keys: ["f"], action: "fit", shown: "F" },
  { keys: ["l"], action: "level", shown: "L" },
  { keys: ["["], action: "slice-back", shown: "[" },
  { keys: ["]"], action: "slice-on", shown: "]" },
  { keys: [" "], action: "play", shown: "Space" },
  { keys: ["Ctrl+z"], action: "undo", shown: "Ctrl Z" },
  { keys: ["Ctrl+Shift+Z", "Ctrl+y"], action: "redo", shown: "Ctrl Shift Z" },
  { keys: ["Ctrl+k"], action: "find", shown: "Ctrl K" },
  { keys: ["?"], action: "help", shown: "?" },
  { keys: ["Escape"], action: "leave", shown: "Esc" },
];

export const KEYS: readonly Key[] = BOUND.map((key) => ({ ...key, text: WORDS.keys[key.action] }));

/** The name of a key press, modifiers in front. */
export function keyName(event: Pick<KeyboardEvent, "key" | "ctrlKey" | "metaKey" | "shiftKey" | "altKey">): string {
  if (event.altKey) return "";
  const isLetter = event.key.length > 1 || /[a-z]/i.test(event.key);
  const shift = event.shiftKey && isLetter ? "Shift+" : "";
  return `${event.ctrlKey || event.metaKey ? "Ctrl+" : ""}${shift}${event.key}`;
}

export function actionOf(name: string): Action | undefined {
  return KEYS.find(({ keys }) => keys.includes(name))?.action;
}
