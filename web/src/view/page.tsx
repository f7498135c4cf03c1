// The page: the picture over all of it; the title, tools, rail, sheet and status float over the picture.

import type { ComponentType } from "preact";

import type { Connection, Problem } from "../engine/engine.ts";
import { set } from "../state/patch.ts";
import { PANES } from "../state/state.ts";
import { WORDS } from "../words.ts";
import { AboutPanel } from "./about_panel.tsx";
import { CutPanel } from "./cut_panel.tsx";
import { Help } from "./help.tsx";
import { Icon } from "./icons.tsx";
import { FunctionPanel, LabelsPanel, LayersPanel, LightPanel, PresetsPanel, TimeBar } from "./look/index.ts";
import { MeasurePanel } from "./measure_panel.tsx";
import type { PartProps } from "./part.ts";
import { fit, SceneView } from "./scene_view.tsx";
import { SettingsPanel } from "./settings_panel.tsx";
import { openState, SharePanel } from "./share.tsx";
import { openPanel, PANELS, Rail, Sheet, type PanelName } from "./sheet.tsx";
import { SlicePane } from "./slices/slice_pane.tsx";
import { SlicesPanel } from "./slices_panel.tsx";
import { ProblemCard, Status } from "./status.tsx";
import { themeOf } from "./theme.ts";
import { Toolbar } from "./toolbar.tsx";

/** What the page shows beside the state of the viewer, and what it does with it. */
export interface Shown {
  readonly connection: Connection;
  readonly problem: Problem | null;
  readonly help: boolean;
  readonly figures: boolean;
  readonly said: string;
  readonly onKey: (event: KeyboardEvent) => void;
  readonly onHelp: (on: boolean) => void;
  readonly onFigures: (on: boolean) => void;
  readonly onProblemClosed: () => void;
}

type PageProps = PartProps & { readonly app: Shown };

const BODIES: Readonly<Record<Exclude<PanelName, "settings">, ComponentType<PartProps>>> = {
  about: AboutPanel,
  presets: PresetsPanel,
  function: FunctionPanel,
  layers: LayersPanel,
  labels: LabelsPanel,
  light: LightPanel,
  cut: CutPanel,
  slices: SlicesPanel,
  measure: MeasurePanel,
  share: SharePanel,
};

export function Page({ app, ...part }: PageProps) {
  const { store, ui, welcome } = part;
  const { layout, interface: shown } = store.state.view;
  const panels = PANELS.filter((name) => name !== "labels" || store.state.labels !== null);
  const opened = openPanel(shown.panels);
  const open = opened === "labels" && store.state.labels === null ? null : opened;
  const onPanel = (name: PanelName | null): void => store.change([set(name === null ? [] : [name], "view", "interface", "panels")]);
  const theme = themeOf(store.state);
  const hasTimes = welcome.volumes.some((volume) => volume.n_times > 1);
  return (
    <div
      class="wavesplat"
      data-theme={theme}
      data-sheet={open !== null}
      data-times={hasTimes}
      onKeyDown={app.onKey}
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        const file = event.dataTransfer?.files[0];
        if (file !== undefined) void openState(part, file);
      }}
    >
      <Toolbar {...part} isAbout={open === "about"} onAbout={() => onPanel(open === "about" ? null : "about")} onFit={() => void fit(part, ui.frames["3d"] ?? { width: 4, height: 3 })} />
      <main class="views" data-layout={layout.name}>
        {(layout.name !== "single" || layout.main === "3d") && <SceneView {...part} />}
        {(layout.name === "one-and-three" || layout.name === "two-by-two") &&
          PANES.map((pane) => <SlicePane key={pane} {...part} pane={pane} />)}
        {layout.name === "single" && layout.main !== "3d" && <SlicePane key={layout.main} {...part} pane={layout.main} />}
      </main>
      <Rail panels={panels} open={open} onPanel={onPanel}>
        <button class="rail-button" title={theme === "dark" ? WORDS.toolbar.light : WORDS.toolbar.dark} onClick={() => store.change([set(theme === "dark" ? "light" : "dark", "view", "interface", "theme")])}>
          <Icon name="dark" />
          <span>{WORDS.toolbar.theme_short}</span>
        </button>
        <button class="rail-button" title={`${WORDS.toolbar.help} (?)`} onClick={() => app.onHelp(true)}>
          <Icon name="help" />
          <span>{WORDS.toolbar.help_short}</span>
        </button>
      </Rail>
      {open !== null && (
        <Sheet key={open} name={open} onClose={() => onPanel(null)}>
          <Body {...part} app={app} name={open} />
        </Sheet>
      )}
      <footer class="bottom">
        {hasTimes && <TimeBar {...part} />}
        <Status {...part} connection={app.connection} figures={app.figures} />
      </footer>
      <p class="hidden" role="status" aria-live="polite">{app.said}</p>
      {app.problem !== null && <ProblemCard problem={app.problem} onClose={app.onProblemClosed} />}
      {app.help && <Help onClose={() => app.onHelp(false)} />}
    </div>
  );
}

function Body({ app, name, ...part }: PageProps & { readonly name: PanelName }) {
  if (name === "settings") return <SettingsPanel {...part} figures={app.figures} onFigures={app.onFigures} />;
  const Panel = BODIES[name];
  return <Panel {...part} />;
}
