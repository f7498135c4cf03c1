// The keys, as data: their actions, and their texts in the table that is shown by `?`.

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
  | "fit" | "first-view" | "level" | "slice-back" | "slice-on" | "undo" | "redo" | "find" | "help" | "leave";

export const KEYS: readonly Key[] = [
  { keys: ["ArrowLeft"], action: "turn-left", shown: "←", text: "Turn to the left" },
  { keys: ["ArrowRight"], action: "turn-right", shown: "→", text: "Turn to the right" },
  { keys: ["ArrowUp"], action: "turn-up", shown: "↑", text: "Turn upwards" },
  { keys: ["ArrowDown"], action: "turn-down", shown: "↓", text: "Turn downwards" },
  { keys: ["Shift+ArrowLeft"], action: "pan-left", shown: "Shift ←", text: "Move to the left" },
  { keys: ["Shift+ArrowRight"], action: "pan-right", shown: "Shift →", text: "Move to the right" },
  { keys: ["Shift+ArrowUp"], action: "pan-up", shown: "Shift ↑", text: "Move up" },
  { keys: ["Shift+ArrowDown"], action: "pan-down", shown: "Shift ↓", text: "Move down" },
  { keys: ["+", "="], action: "zoom-in", shown: "+", text: "Magnify" },
  { keys: ["-", "_"], action: "zoom-out", shown: "−", text: "Make smaller" },
  { keys: [","], action: "roll-left", shown: ",", text: "Roll to the left" },
  { keys: ["."], action: "roll-right", shown: ".", text: "Roll to the right" },
  { keys: ["1"], action: "view-front", shown: "1", text: "From the front" },
  { keys: ["2"], action: "view-back", shown: "2", text: "From the back" },
  { keys: ["3"], action: "view-left", shown: "3", text: "From the left" },
  { keys: ["4"], action: "view-right", shown: "4", text: "From the right" },
  { keys: ["5"], action: "view-top", shown: "5", text: "From above" },
  { keys: ["6"], action: "view-bottom", shown: "6", text: "From below" },
  { keys: ["0"], action: "first-view", shown: "0", text: "The view of the first picture" },
  { keys: ["f"], action: "fit", shown: "F", text: "Fit all into view" },
  { keys: ["l"], action: "level", shown: "L", text: "Level: upright again" },
  { keys: ["["], action: "slice-back", shown: "[", text: "Slice back" },
  { keys: ["]"], action: "slice-on", shown: "]", text: "Next slice" },
  { keys: ["Ctrl+z"], action: "undo", shown: "Ctrl Z", text: "Undo" },
  { keys: ["Ctrl+Shift+Z", "Ctrl+y"], action: "redo", shown: "Ctrl Shift Z", text: "Redo" },
  { keys: ["Ctrl+k"], action: "find", shown: "Ctrl K", text: "Find a command" },
  { keys: ["?"], action: "help", shown: "?", text: "Show this table" },
  { keys: ["Escape"], action: "leave", shown: "Esc", text: "Leave the tool, or close the sheet" },
];

/** Gestures of mouse and fingers and their effects, for the table. */
export const GESTURES: readonly (readonly [string, string])[] = [
  ["Drag", "Turn; freely with the trackball of the settings"],
  ["Shift drag, middle button", "Move"],
  ["Wheel", "Magnify about the pointer"],
  ["Right button", "Magnify"],
  ["Ctrl drag", "Roll"],
  ["Alt drag", "Window and level: of slices, in space of the opacities and colours"],
  ["Ctrl click", "Crosshair to what is seen"],
  ["Wheel on a slice; with Ctrl", "Next slices; magnify about the pointer"],
  ["Double click on a slice", "It fills the page, or goes back"],
  ["Two fingers on a slice", "Up and down: next slices; sideways: move; apart: magnify"],
  ["One finger, two fingers", "Turn; move and magnify, with the trackball also roll"],
];

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
