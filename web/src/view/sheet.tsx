// The rail of icons at the side, and the sheet of the panel that is open: one at a time.

import type { ComponentChildren } from "preact";

import { WORDS } from "../words.ts";
import { Icon } from "./icons.tsx";

const TEXT = WORDS.panels;

/** The panels, in the order of the rail. */
export const PANELS = ["presets", "function", "layers", "labels", "light", "cut", "slices", "measure", "share", "settings"] as const;
/** Panels that are opened from elsewhere: the card about the data by the title, all looks from the strip of looks. */
const OTHERS = ["about", "looks"] as const;
export type PanelName = (typeof PANELS)[number] | (typeof OTHERS)[number];
/** The strip of looks lies at the foot, beside the sheet of another panel. */
export type SheetName = Exclude<PanelName, "presets">;

/** The panel whose sheet is shown: the one that was opened last. */
export function openSheet(panels: readonly string[]): SheetName | null {
  const last = panels.filter((name) => name !== "presets").at(-1);
  return [...PANELS, ...OTHERS].filter((name) => name !== "presets").find((name) => name === last) ?? null;
}

/** The open panels after a click on the icon of one: sheets take each other's place, the strip of looks stays. */
export function toggled(panels: readonly string[], name: PanelName): string[] {
  const isStrip = panels.includes("presets");
  const sheet = openSheet(panels);
  if (name === "presets") return [...(isStrip ? [] : ["presets"]), ...(sheet === null ? [] : [sheet])];
  return [...(isStrip ? ["presets"] : []), ...(sheet === name ? [] : [name])];
}

interface RailProps {
  readonly panels: readonly (typeof PANELS)[number][];
  readonly open: readonly string[];
  /** Opens a panel, or closes it. */
  onPanel(name: PanelName): void;
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
          aria-expanded={open.includes(name)}
          title={WORDS.sheets[name]}
          onClick={() => onPanel(name)}
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

/** The sheet of a panel. The focus that is in it goes back to its icon when it is closed. */
export function Sheet({ name, onClose, children }: { readonly name: SheetName; onClose(): void; readonly children: ComponentChildren }) {
  const title = WORDS.sheets[name];
  const close = (event: Event): void => {
    const root = (event.currentTarget as HTMLElement).getRootNode() as ShadowRoot;
    const isInside = root.activeElement?.closest(".sheet") != null;
    onClose();
    if (isInside) root.querySelector<HTMLElement>(`[data-opens="${name}"]`)?.focus();
  };
  return (
    <section class="sheet float" data-panel={name} aria-label={title}>
      <header class="sheet-head">
        <h2>{title}</h2>
        <button class="icon-button" aria-label={TEXT.close(title)} onClick={close}><Icon name="close" /></button>
      </header>
      <div class="body" tabIndex={-1}>{children}</div>
    </section>
  );
}
