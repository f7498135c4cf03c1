// Deeds of the page that the palette finds beside keys and names: its buttons and tools, with other words for them.

import { withLens } from "../input/camera.ts";
import { set } from "../state/patch.ts";
import { OVERLAYS } from "../state/state.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { WORDS } from "../words.ts";
import type { PartProps, Tool } from "./part.ts";
import { toggled, type PanelName } from "./sheet.tsx";

const TEXT = PANEL_WORDS.deeds;
const TOOLS: readonly Tool[] = ["distance", "angle", "area", "window", "turn"];
const FIRST_ANGLE = 30;
/** Frames within which a sheet that was opened has its buttons. */
const OPENED_FRAMES = 60;

export interface Command {
  readonly text: string;
  /** The group that the command belongs to, or its key. */
  readonly hint: string;
  /** Other words that find it. */
  readonly words?: string;
  /** Text that the palette goes on with, in place of a deed. */
  readonly fill?: string;
  readonly run: () => void;
}

export function deedsOf(part: PartProps): Command[] {
  const { store, ui, welcome } = part;
  const { view, camera, layers } = store.state;
  const words = TEXT.deedWords;
  const button = (sheet: PanelName, text: string, other: string): Command => ({
    text, hint: WORDS.sheets[sheet as keyof typeof WORDS.sheets] ?? TEXT.button, words: other, run: () => press(part, sheet, text),
  });
  const { share } = PANEL_WORDS;
  return [
    button("share", share.save, words.save),
    button("share", share.copy, words.copy),
    ...(ui.host === "page" ? [button("share", share.link, words.link)] : []),
    button("share", share.python, words.python),
    button("share", share.command, words.command),
    button("share", share.movie, words.movie),
    button("share", share.saveState, words.saveState),
    button("share", share.saveHtml, words.saveHtml),
    { text: WORDS.opening.open, hint: TEXT.button, words: words.open, run: () => ui.opener.show(true) },
    ...TOOLS.map((tool) => ({ text: WORDS.toolbar[tool], hint: TEXT.tool, words: words[tool], run: () => ui.setTool(tool) })),
    button("cut", WORDS.cut.crop, words.crop),
    button("cut", WORDS.cut.cut, words.cut),
    button("cut", WORDS.cut.add, words.plane),
    { text: PANEL_WORDS.lightPanel.background, hint: WORDS.sheets.light, words: words.background, run: () => press(part, "light", PANEL_WORDS.lightPanel.background) },
    {
      text: PANEL_WORDS.settings.perspective, hint: WORDS.sheets.settings, words: words.perspective,
      run: () => store.change([set(withLens(camera, camera.view_angle === undefined ? FIRST_ANGLE : undefined), "camera")]),
    },
    { text: TEXT.fullScreen, hint: TEXT.button, words: words.fullScreen, run: () => void fullScreen(ui) },
    { text: TEXT.goTo, hint: TEXT.example("go to 12, 40, -30"), words: words.goTo, fill: "go to ", run: () => undefined },
    { text: TEXT.setWindow, hint: TEXT.example("window 40 400"), words: words.setWindow, fill: "window ", run: () => undefined },
    { text: TEXT.goToSlice, hint: TEXT.example("slice 56"), words: words.goToSlice, fill: "slice ", run: () => undefined },
    ...OVERLAYS.map((name) => {
      const title = PANEL_WORDS.settings.overlays[name];
      const on = view.overlays[name];
      return { text: on ? WORDS.palette.hide(title) : WORDS.palette.show(title), hint: PANEL_WORDS.settings.over, run: () => store.change([set(!on, "view", "overlays", name)]) };
    }),
    ...(layers.length < 2 ? [] : layers).map(({ name, visible }, n) => ({
      text: visible ? WORDS.palette.hide(name) : WORDS.palette.show(name), hint: WORDS.sheets.layers, run: () => store.change([set(!visible, "layers", n, "visible")]),
    })),
    ...(welcome.volumes.some(({ n_times }) => n_times > 1)
      ? [{ text: WORDS.timeBar.play, hint: WORDS.timeBar.title, words: words.play, run: () => pressed(ui, ".look-time button", WORDS.timeBar.play) }]
      : []),
  ];
}

/** Presses a button of a sheet, or gives a field of it the focus, after opening the sheet. */
function press(part: PartProps, sheet: PanelName, text: string): void {
  const { store, ui } = part;
  const { panels } = store.state.view.interface;
  if (!panels.includes(sheet)) store.change([set(toggled(panels, sheet), "view", "interface", "panels")]);
  let frames = 0;
  const wait = (): void => {
    if (pressed(ui, ".sheet button, .sheet input", text)) return;
    frames += 1;
    if (frames < OPENED_FRAMES) requestAnimationFrame(wait);
  };
  requestAnimationFrame(wait);
}

/** Presses the button with a text, or gives a field of that name the focus; whether there is one. */
function pressed({ root }: PartProps["ui"], selector: string, text: string): boolean {
  const all = [...root.querySelectorAll<HTMLElement>(selector)];
  const found = all.find((one) => one.textContent?.trim() === text || one.getAttribute("aria-label") === text);
  found?.focus();
  if (found?.matches("button")) found.click();
  return found !== undefined;
}

/** Shows the viewer alone on the screen, or in its window again. */
async function fullScreen({ root, problem }: PartProps["ui"]): Promise<void> {
  const host = root instanceof ShadowRoot ? root.host : root;
  try {
    if (document.fullscreenElement === null) await host.requestFullscreen();
    else await document.exitFullscreen();
  } catch (error) {
    problem({ code: "full screen", message: `${TEXT.noFullScreen}: ${(error as Error).message}` });
  }
}

