// Groups of tools that float over the picture: title, layout, standard views, history, the tool of a drag.

import type { ComponentChildren } from "preact";

import { set } from "../state/patch.ts";
import { PANES, type View } from "../state/state.ts";
import { WORDS } from "../words.ts";
import { Icon, type IconName } from "./icons.tsx";
import type { PartProps, Tool } from "./part.ts";
import { showFrom } from "./scene_view.tsx";
import { nameOf } from "./slices/panes.ts";

const TEXT = WORDS.toolbar;
const LAYOUTS: readonly View["layout"]["name"][] = ["3d", "one-and-three", "two-by-two", "single"];
const VIEWS = ["front", "back", "left", "right", "top", "bottom"] as const;
const TOOLS: readonly Tool[] = ["turn", "window", "distance", "angle", "area"];

export function Toolbar(props: PartProps & { readonly isAbout: boolean; onAbout(): void; onFit(): void }) {
  const { store, welcome, ui, isAbout, onAbout, onFit } = props;
  const { layout } = store.state.view;
  const names = store.state.layers.map(({ name }) => name).join(", ");
  const setLayout = (name: View["layout"]["name"]): void => {
    const main = name === "single" ? (layout.main === "3d" ? "z" : layout.main) : "3d";
    store.change([set({ name, main }, "view", "layout")]);
  };
  const hasScene = layout.name !== "single" || layout.main === "3d";
  return (
    <header class="toolbar">
      <div class="group float"><IconButton icon="open" label={WORDS.opening.open} onClick={() => ui.opener.show(true)} /></div>
      <h1 class="group float title-group">
        <button class="title" data-opens="about" aria-expanded={isAbout} aria-label={WORDS.toolbar.about(names)} title={names} onClick={onAbout}>{names}</button>
      </h1>
      <div class="group float">
        <Radios label={WORDS.layouts.title} names={LAYOUTS} value={layout.name} textOf={(name) => WORDS.layouts[name]} iconOf={(name) => name} onChoice={setLayout} />
        {layout.name === "single" && (
          <label>
            <span class="hidden">{WORDS.layouts.slice}</span>
            <select value={layout.main} onChange={(event) => store.change([set(event.currentTarget.value, "view", "layout", "main")])}>
              {PANES.map((pane) => <option key={pane} value={pane} selected={pane === layout.main}>{nameOf({ welcome }, pane)}</option>)}
            </select>
          </label>
        )}
      </div>
      <Group label={TEXT.history}>
        <IconButton icon="undo" label={TEXT.undo} shortcut="Ctrl Z" disabled={!store.canUndo} onClick={() => store.undo()} />
        <IconButton icon="redo" label={TEXT.redo} shortcut="Ctrl Shift Z" disabled={!store.canRedo} onClick={() => store.redo()} />
      </Group>
      <div class="group float">
        <Radios label={TEXT.tools} names={TOOLS} value={ui.tool} textOf={(tool) => TEXT[tool]} iconOf={(tool) => tool} onChoice={(tool) => ui.setTool(tool)} />
      </div>
      {hasScene && (
        <Group label={TEXT.views} more="standard-views">
          {VIEWS.map((view, n) => (
            <button
              key={view}
              class="icon-button"
              title={TEXT.withKey(TEXT.from(WORDS.views[view]), String(n + 1))}
              aria-label={TEXT.lettered(letterOf(view, welcome.axis_ends), WORDS.views[view])}
              onClick={() => {
                const camera = welcome.standard_views[view];
                if (camera !== undefined) showFrom(props, camera);
              }}
            >
              {letterOf(view, welcome.axis_ends)}
            </button>
          ))}
          <IconButton icon="fit" label={TEXT.fit} shortcut="F" onClick={onFit} />
        </Group>
      )}
    </header>
  );
}

function Group({ label, more = "", children }: { readonly label: string; readonly more?: string; readonly children: ComponentChildren }) {
  return <div class={`group float ${more}`} role="group" aria-label={label}>{children}</div>;
}

interface IconButtonProps {
  readonly icon: IconName;
  readonly label: string;
  /** The key that does the same, for the tooltip. */
  readonly shortcut?: string;
  /** Whether there is nothing to do now; the button keeps the focus. */
  readonly disabled?: boolean;
  onClick(): void;
}

function IconButton({ icon, label, shortcut, disabled = false, onClick }: IconButtonProps) {
  const title = shortcut === undefined ? label : TEXT.withKey(label, shortcut);
  return (
    <button class="icon-button" title={title} aria-label={label} aria-disabled={disabled} onClick={() => onClick()}>
      <Icon name={icon} />
    </button>
  );
}

interface RadiosProps<Name extends string> {
  readonly label: string;
  readonly names: readonly Name[];
  readonly value: Name;
  textOf(name: Name): string;
  iconOf(name: Name): IconName;
  onChoice(name: Name): void;
}

/** A choice of one of several icons; arrows go from one to the next. */
function Radios<Name extends string>({ label, names, value, textOf, iconOf, onChoice }: RadiosProps<Name>) {
  const onKeyDown = (event: KeyboardEvent): void => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const next = names[(names.indexOf(value) + step + names.length) % names.length];
    if (next === undefined) return;
    onChoice(next);
    (event.currentTarget as HTMLElement).querySelector<HTMLElement>(`[data-name="${next}"]`)?.focus();
  };
  return (
    <div class="radios" role="radiogroup" aria-label={label} onKeyDown={onKeyDown}>
      {names.map((name) => (
        <button
          key={name}
          class="icon-button"
          role="radio"
          data-name={name}
          tabIndex={name === value ? 0 : -1}
          aria-checked={name === value}
          aria-label={textOf(name)}
          title={textOf(name)}
          onClick={() => onChoice(name)}
        >
          <Icon name={iconOf(name)} />
        </button>
      ))}
    </div>
  );
}

/** The name of the direction that a view is from. */
function letterOf(view: (typeof VIEWS)[number], ends: readonly string[]): string {
  const place = { left: 0, right: 1, back: 2, front: 3, bottom: 4, top: 5 }[view];
  return ends[place] ?? WORDS.views[view];
}
