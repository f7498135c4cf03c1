// The page: the picture over all of it; the title, tools, rail, sheet and status float over the picture.

import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";

import { actionOf, keyName } from "../input/keys.ts";
import { set } from "../state/patch.ts";
import { PANES, type Pane } from "../state/state.ts";
import { WORDS } from "../words.ts";
import { Icon } from "./icons.tsx";
import { later } from "./later.tsx";
import { Banner, isStale } from "./liveness.tsx";
import { TimeBar } from "./look/index.ts";
import { Memo, shownByPanels, shownBySlices, shownByToolbar } from "./memo.tsx";
import { Openings } from "./open/index.ts";
import type { PageFields } from "./page_state.ts";
import type { PartProps } from "./part.ts";
import { fit, SceneView } from "./scene_view.tsx";
import { openSheet, PANELS, Rail, Sheet, toggled, type PanelName, type SheetName } from "./sheet.tsx";
import { ProblemCard, Status } from "./status.tsx";
import { themeOf } from "./theme.ts";
import { Toolbar } from "./toolbar.tsx";

interface PageProps extends PartProps {
  /** The state of this page alone. */
  readonly page: PageFields;
  readonly onKey: (event: KeyboardEvent) => void;
  readonly onPage: (next: Partial<PageFields>) => void;
}

const Help = later((parts) => parts.Help);
const LooksStrip = later((parts) => parts.LooksStrip);
const Palette = later((parts) => parts.Palette);
const SettingsPanel = later((parts) => parts.SettingsPanel);
const SlicePane = later((parts) => parts.SlicePane);
const BODIES: Readonly<Record<Exclude<SheetName, "settings">, ComponentType<PartProps>>> = {
  about: later((parts) => parts.AboutPanel),
  function: later((parts) => parts.FunctionPanel),
  layers: later((parts) => parts.LayersPanel),
  looks: later((parts) => parts.PresetsPanel),
  labels: later((parts) => parts.LabelsPanel),
  light: later((parts) => parts.LightPanel),
  cut: later((parts) => parts.CutPanel),
  slices: later((parts) => parts.SlicesPanel),
  measure: later((parts) => parts.MeasurePanel),
  share: later((parts) => parts.SharePanel),
};

export function Page({ page, onKey, onPage, ...part }: PageProps) {
  const { store, ui, welcome } = part;
  const { layout, interface: shown } = store.state.view;
  const panels = PANELS.filter((name) => name !== "labels" || store.state.labels !== null);
  const opened = openSheet(shown.panels);
  const open = opened === "labels" && store.state.labels === null ? null : opened;
  const hasStrip = shown.panels.includes("presets");
  const onPanel = (name: PanelName): void => store.change([set(toggled(shown.panels, name), "view", "interface", "panels")]);
  const [isFinding, setFinding] = useState(false);
  useFindKey(ui, () => setFinding(true));
  const theme = themeOf(store.state);
  const slice = (pane: Pane) => <Memo key={pane} of={shownBySlices(part)}>{() => <SlicePane {...part} pane={pane} />}</Memo>;
  const hasTimes = welcome.volumes.some((volume) => volume.n_times > 1);
  return (
    <div
      class="wavesplat"
      data-theme={theme}
      data-sheet={open !== null}
      data-strip={hasStrip}
      data-times={hasTimes}
      onKeyDown={onKey}
    >
      <Memo of={[...shownByToolbar(part), open]}>
        {() => <Toolbar {...part} isAbout={open === "about"} onAbout={() => onPanel("about")} onFit={() => fit(part)} />}
      </Memo>
      <main class="views" data-layout={layout.name} data-stale={isStale(page.connection)}>
        {(layout.name !== "single" || layout.main === "3d") && <SceneView {...part} />}
        {(layout.name === "one-and-three" || layout.name === "two-by-two") && PANES.map(slice)}
        {layout.name === "single" && layout.main !== "3d" && slice(layout.main)}
        <Banner connection={page.connection} engine={part.engine} />
      </main>
      <Rail panels={panels} open={[open ?? "", hasStrip ? "presets" : ""]} onPanel={onPanel}>
        <button class="rail-button" title={WORDS.toolbar.withKey(WORDS.palette.find, "Ctrl K")} onClick={() => setFinding(true)}>
          <Icon name="search" />
          <span>{WORDS.palette.open}</span>
        </button>
        <button class="rail-button" title={theme === "dark" ? WORDS.toolbar.light : WORDS.toolbar.dark} onClick={() => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")])}>
          <Icon name="dark" />
          <span>{WORDS.toolbar.theme_short}</span>
        </button>
        <button class="rail-button" title={WORDS.toolbar.withKey(WORDS.toolbar.help, "?")} onClick={() => onPage({ help: true })}>
          <Icon name="help" />
          <span>{WORDS.toolbar.help_short}</span>
        </button>
      </Rail>
      {open !== null && (
        <Sheet key={open} name={open} onClose={() => onPanel(open)}>
          <Memo of={[...shownByPanels(part), page.figures]}>
            {() => <Body key={welcome.fingerprint} {...part} name={open} figures={page.figures} onFigures={(figures) => onPage({ figures })} />}
          </Memo>
        </Sheet>
      )}
      <footer class="bottom">
        {hasStrip && <Memo of={shownByPanels(part)}>{() => <LooksStrip key={welcome.fingerprint} {...part} onAll={() => onPanel("looks")} />}</Memo>}
        {hasTimes && <TimeBar {...part} />}
        <Status key={welcome.fingerprint} {...part} figures={page.figures} />
      </footer>
      <p class="hidden" role="status" aria-live="polite">{page.said}</p>
      {page.problem !== null && <ProblemCard problem={page.problem} onClose={() => onPage({ problem: null })} />}
      <Openings {...part} />
      {isFinding && <Palette {...part} onClose={() => setFinding(false)} />}
      {page.help && <Help onClose={() => onPage({ help: false })} />}
    </div>
  );
}

function Body({ name, figures, onFigures, ...part }: PartProps & {
  readonly name: SheetName;
  readonly figures: boolean;
  readonly onFigures: (on: boolean) => void;
}) {
  if (name === "settings") return <SettingsPanel {...part} figures={figures} onFigures={onFigures} />;
  const Panel = BODIES[name];
  return <Panel {...part} />;
}

/** Calls back at the key that opens the palette: on a page wherever the focus is, in a notebook inside of the viewer. */
function useFindKey({ root, host }: PartProps["ui"], onFind: () => void): void {
  useEffect(() => {
    const target: EventTarget = host === "page" ? document : root;
    const onKey = (event: Event): void => {
      if (actionOf(keyName(event as KeyboardEvent)) !== "find") return;
      event.preventDefault();
      onFind();
    };
    target.addEventListener("keydown", onKey);
    return () => target.removeEventListener("keydown", onKey);
  }, [root, host]);
}
