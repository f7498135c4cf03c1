// The commands that the palette finds: keys, looks, layouts, panels, windows of slices, labels.

import { KEYS, type Key } from "../input/keys.ts";
import { set } from "../state/patch.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { WORDS } from "../words.ts";
import { deedsOf, type Command } from "./deeds.ts";
import { labelRows, toggledLabel } from "./look/layers.ts";
import { chosen } from "./look/looks.ts";
import { titleOf } from "./look/preset_kinds.ts";
import type { PartProps } from "./part.ts";
import { problemOf } from "./problems.ts";
import { PANELS, toggled } from "./sheet.tsx";
import { chooseWindow, namedWindows } from "./slices/window_menu.tsx";
import { typedCommand } from "./typed.ts";

const TEXT = WORDS.palette;
const LAYOUTS = ["3d", "one-and-three", "two-by-two", "single"] as const;
const THEMES = ["dark", "light", "system"] as const;

/** The commands; of a text with numbers, the one that it is comes first. */
export function commandsOf(part: PartProps, typed = ""): Command[] {
  const { store, ui, welcome } = part;
  const view = store.state.view;
  return [
    ...typedCommand(part, typed).map((command) => ({ ...command, words: typed })),
    ...LAYOUTS.map((name) => ({
      text: WORDS.layouts[name],
      hint: TEXT.layout,
      run: () => store.change([set({ name, main: name === "single" ? (view.layout.main === "3d" ? "z" : view.layout.main) : "3d" }, "view", "layout")]),
    })),
    ...([...PANELS, "about"] as const).map((name) => ({
      text: WORDS.sheets[name],
      hint: TEXT.panel,
      run: () => store.change([set(toggled(view.interface.panels.filter((one) => one !== name), name), "view", "interface", "panels")]),
    })),
    ...["auto", ...welcome.presets.filter(({ layers }) => layers.includes(ui.layer)).map(({ name }) => name)].map((name) => ({
      text: titleOf(name) === name ? name : `${titleOf(name)} (${name})`,
      hint: TEXT.look,
      run: () => void take(part, name),
    })),
    ...namedWindows(part).map(([name]) => ({ text: name, hint: TEXT.window, run: () => chooseWindow(part, name) })),
    ...THEMES.map((name) => ({ text: PANEL_WORDS.settings.themes[name], hint: TEXT.theme, run: () => store.change([set(name, "view", "interface", "theme")]) })),
    ...deedsOf(part),
    ...labelCommands(part),
    // Last, as the list is at first: whoever looks for commands knows what arrows do.
    ...KEYS.filter(({ action }) => action !== "find").map((key) => ({ text: key.text, hint: key.shown, run: () => press(ui, key) })),
  ];
}

/** The commands that have all words of a text: those first that begin with it, then those with all of them in their own text. */
export function found<C extends Pick<Command, "text" | "hint" | "words">>(commands: readonly C[], text: string): C[] {
  const words = text.toLowerCase().split(/\s+/).filter((word) => word !== "");
  const start = text.trim().toLowerCase();
  const has = (all: string): boolean => words.every((word) => all.toLowerCase().includes(word));
  const hits = commands.filter(({ text: name, hint, words: other = "" }) => has(`${name} ${hint} ${other}`));
  const isWhole = ({ words: other = "" }: C): boolean => other.toLowerCase().split(" ").includes(start) || (start !== "" && other === text);
  const rank = (one: C): number => {
    if (start === "") return 0;
    if (one.text.toLowerCase().startsWith(start)) return 0;
    if (isWhole(one)) return 1;
    return has(`${one.text} ${one.hint}`) ? 2 : 3;
  };
  return hits.map((one) => [rank(one), one] as const).sort(([a], [b]) => a - b).map(([, one]) => one);
}

function labelCommands({ store }: PartProps): Command[] {
  return labelRows(store.state.labels?.labels ?? {}).map(({ number, name, isShown }) => ({
    text: isShown ? TEXT.hide(name) : TEXT.show(name),
    hint: TEXT.label,
    run: () => store.change(toggledLabel(store, number)),
  }));
}

async function take({ store, engine, ui }: PartProps, name: string): Promise<void> {
  try {
    const { look } = await engine.ask("preset", { layer: ui.layer, name });
    store.change(chosen(store.state, ui.layer, look));
  } catch (problem) {
    ui.problem(problemOf(problem));
  }
}

/** Presses a key in the view that was used last, of slices in one of them, so that a command does what its key does. */
function press({ root, views }: PartProps["ui"], { keys, action }: Key): void {
  const isOfSlices = action === "slice-back" || action === "slice-on";
  const all = [...root.querySelectorAll<HTMLElement>("[data-view]")];
  const fitting = isOfSlices ? all.filter((view) => view.dataset["view"] !== "3d") : all;
  const view = fitting.find((one) => one.dataset["view"] === views.last) ?? fitting[0];
  const parts = (keys[0] ?? "").split("+");
  // The key "+" itself has no name before it.
  const key = parts.at(-1) === "" ? "+" : (parts.at(-1) ?? "");
  const how = { key, ctrlKey: parts.includes("Ctrl"), shiftKey: parts.includes("Shift"), bubbles: true, composed: true, cancelable: true };
  view?.focus();
  view?.dispatchEvent(new KeyboardEvent("keydown", how));
  view?.dispatchEvent(new KeyboardEvent("keyup", how));
}
