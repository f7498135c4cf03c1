// Layout, standard views, undo, tools, sharing, help, theme.

import { set } from "../state/patch.ts";
import { PANES, type View } from "../state/state.ts";
import { Icon, type IconName } from "./icons.tsx";
import type { PartProps, Tool } from "./part.ts";
import { showFrom } from "./scene_view.tsx";
import { nameOf } from "./slices/slice_pane.tsx";
import { themeOf } from "./theme.ts";

const LAYOUTS: readonly (readonly [View["layout"]["name"], string])[] = [
  ["3d", "Space"],
  ["one-and-three", "Space and three slices"],
  ["two-by-two", "Two by two"],
  ["single", "One slice"],
];
const VIEWS = ["front", "back", "left", "right", "top", "bottom"] as const;
const TOOLS: readonly (readonly [Tool, string, IconName])[] = [
  ["turn", "Turn", "turn"],
  ["window", "Window and level", "window"],
  ["distance", "Measure a distance", "distance"],
  ["angle", "Measure an angle", "angle"],
];

export function Toolbar(props: PartProps & { readonly onHelp: () => void; readonly onFit: () => void; readonly panels: boolean; readonly onPanels: () => void }) {
  const { store, welcome, ui, onHelp, onFit } = props;
  const { layout } = store.state.view;
  const theme = themeOf(store.state);
  const tools = (event: KeyboardEvent): void => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const now = TOOLS.findIndex(([tool]) => tool === ui.tool);
    const next = TOOLS[(now + step + TOOLS.length) % TOOLS.length]?.[0];
    if (next === undefined) return;
    ui.setTool(next);
    const box = event.currentTarget as HTMLElement;
    box.querySelector<HTMLElement>(`[data-tool="${next}"]`)?.focus();
  };
  return (
    <header class="toolbar">
      <h1 class="title" title={store.state.layers.map(({ name }) => name).join(", ")}>
        {store.state.layers.map(({ name }) => name).join(", ")}
      </h1>
      <label>
        <span class="hidden">Layout</span>
        <select
          value={layout.name}
          onChange={(event) => {
            const name = event.currentTarget.value as View["layout"]["name"];
            const main = name === "single" && layout.main === "3d" ? "z" : layout.main;
            store.change([set({ name, main: name === "single" ? main : "3d" }, "view", "layout")]);
          }}
        >
          {LAYOUTS.map(([name, text]) => (
            <option key={name} value={name} selected={name === layout.name}>{text}</option>
          ))}
        </select>
      </label>
      {layout.name === "single" && (
        <label>
          <span class="hidden">Slice</span>
          <select value={layout.main} onChange={(event) => store.change([set(event.currentTarget.value, "view", "layout", "main")])}>
            {PANES.map((pane) => <option key={pane} value={pane} selected={pane === layout.main}>{nameOf({ welcome }, pane)}</option>)}
          </select>
        </label>
      )}
      <div class="group" role="group" aria-label="Standard views">
        {VIEWS.map((view, n) => (
          <button
            key={view}
            class="icon-button"
            title={`From the ${view} (${n + 1})`}
            aria-label={`${letterOf(view, welcome.axis_ends)}, from the ${view}`}
            onClick={() => {
              const camera = welcome.standard_views[view];
              if (camera !== undefined) showFrom(props, camera);
            }}
          >
            {letterOf(view, welcome.axis_ends)}
          </button>
        ))}
      </div>
      <button class="icon-button" title="Fit (0)" aria-label="Fit all into view" onClick={onFit}><Icon name="fit" /></button>
      <div class="group" role="group" aria-label="History">
        <button class="icon-button" title="Undo (Ctrl Z)" aria-label="Undo" disabled={!store.canUndo} onClick={() => store.undo()}><Icon name="undo" /></button>
        <button class="icon-button" title="Redo (Ctrl Shift Z)" aria-label="Redo" disabled={!store.canRedo} onClick={() => store.redo()}><Icon name="redo" /></button>
      </div>
      <div class="group" role="radiogroup" aria-label="Dragging" onKeyDown={tools}>
        {TOOLS.map(([tool, text, icon]) => (
          <button
            key={tool}
            class="icon-button"
            role="radio"
            data-tool={tool}
            tabIndex={tool === ui.tool ? 0 : -1}
            aria-checked={tool === ui.tool}
            aria-label={text}
            title={text}
            onClick={() => ui.setTool(tool)}
          >
            <Icon name={icon} />
          </button>
        ))}
      </div>
      <span class="spring" />
      <button
        class="icon-button"
        title={theme === "dark" ? "Light colours" : "Dark colours"}
        aria-label={theme === "dark" ? "Light colours" : "Dark colours"}
        onClick={() => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")])}
      >
        <Icon name={theme === "dark" ? "light" : "dark"} />
      </button>
      <button class="icon-button" title="Keys and gestures (?)" aria-label="Keys and gestures" onClick={onHelp}><Icon name="help" /></button>
      <button class="icon-button" title="Panels" aria-label="Panels" aria-pressed={props.panels} onClick={props.onPanels}><Icon name="panels" /></button>
    </header>
  );
}

/** The name of the direction that a view is from. */
function letterOf(view: (typeof VIEWS)[number], ends: readonly string[]): string {
  const place = { left: 0, right: 1, back: 2, front: 3, bottom: 4, top: 5 }[view];
  return ends[place] ?? view;
}
