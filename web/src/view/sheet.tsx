// The rail of icons at the side, and the sheet of the panel that is open: one at a time.

import type { ComponentChildren } from "preact";

import { WORDS } from "../words.ts";
import { Icon } from "./icons.tsx";

const TEXT = WORDS.panels;

/** The panels, in the order of the rail. */
export const PANELS = ["presets", "function", "layers", "labels", "light", "cut", "slices", "measure", "share", "settings"] as const;
/** A panel of the rail, or the card about the data, which the title opens. */
export type PanelName = (typeof PANELS)[number] | "about";

/** The panel whose sheet is shown: the one that was opened last. */
export function openPanel(panels: readonly string[]): PanelName | null {
  return [...PANELS, "about" as const].find((name) => name === panels.at(-1)) ?? null;
}

export interface RailProps {
  readonly panels: readonly (typeof PANELS)[number][];
  readonly open: PanelName | null;
  /** Opens a panel, or closes the one that is open. */
  onPanel(name: PanelName | null): void;
  /** Buttons at the foot of the rail. */
  readonly children: ComponentChildren;
}

export function Rail({ panels, open, onPanel, children }: RailProps) {
  return (
    <nav class="rail float" aria-label={TEXT.title}>
      {panels.map((name) => (
        <button
          key={name}
          class="rail-button"
          data-opens={name}
          aria-expanded={name === open}
          title={WORDS.sheets[name]}
          onClick={() => onPanel(name === open ? null : name)}
        >
          <Icon name={name} />
          <span>{TEXT[name]}</span>
        </button>
      ))}
      <span class="spring" />
      {children}
    </nav>
  );
}

/** The sheet of a panel. Escape closes it, and gives the focus back to its icon. */
export function Sheet({ name, onClose, children }: { readonly name: PanelName; onClose(): void; readonly children: ComponentChildren }) {
  const title = WORDS.sheets[name];
  const close = (event: Event): void => {
    const root = (event.currentTarget as HTMLElement).getRootNode() as ShadowRoot;
    onClose();
    root.querySelector<HTMLElement>(`[data-opens="${name}"]`)?.focus();
  };
  return (
    <section
      class="sheet float"
      data-panel={name}
      aria-label={title}
      onKeyDown={(event) => {
        if (event.key !== "Escape" || event.defaultPrevented) return;
        event.preventDefault();
        event.stopPropagation();
        close(event);
      }}
    >
      <header class="sheet-head">
        <h2>{title}</h2>
        <button class="icon-button" aria-label={TEXT.close(title)} onClick={close}><Icon name="close" /></button>
      </header>
      <div class="body" tabIndex={-1}>{children}</div>
    </section>
  );
}
