// The interface as a whole: it draws itself anew from the state and the frames, from the top.

import { render } from "preact";

import type { Engine, Frame, Welcome } from "../engine/engine.ts";
import { actionOf, keyName } from "../input/keys.ts";
import { TypedText } from "../input/typed_text.ts";
import { fromLink } from "../state/link.ts";
import type { Operation } from "../state/patch.ts";
import type { ViewName } from "../state/state.ts";
import { keepSteps, resumeSteps } from "../state/kept_steps.ts";
import { createStore, type Store } from "../state/store.ts";
import { WORDS } from "../words.ts";
import { FrameStatistics } from "./frame_statistics.ts";
import { loadAhead } from "./later.tsx";
import { css as livenessCss } from "./liveness.tsx";
import { css as lookCss } from "./look/index.ts";
import { css as openCss, DataFollower, PageOpener, StartPage } from "./open/index.ts";
import cubeCss from "./overlay3d/cube.css";
import { Page } from "./page.tsx";
import { PageState } from "./page_state.ts";
import type { PartProps, Ui } from "./part.ts";
import { openState } from "./open_state.ts";
import { problemOf } from "./problems.ts";
import { Opening } from "./status.tsx";
import style from "./style.css";
import { onThemeChange, surrounding } from "./theme.ts";
import { createUi } from "./ui.ts";

export interface Host {
  readonly kind: "page" | "widget";
  /** The part of a link that says what to show. */
  readonly link?: string | undefined;
  /** Called with the names of the volumes, when others are open than before. */
  readonly onVolumes?: ((names: readonly string[]) => void) | undefined;
}

/** Shows the viewer in an element, and returns a function that removes it. */
export function mountApp(parent: HTMLElement, engine: Engine, host: Host): () => void {
  const root = parent.shadowRoot ?? parent.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync([style, lookCss, cubeCss, openCss, livenessCss].join("\n"));
  root.adoptedStyleSheets = [sheet];
  const mount = document.createElement("div");
  mount.className = "mount";
  root.append(mount);
  const app = new App(engine, host, root, mount);
  return () => {
    app.close();
    render(null, mount);
    mount.remove();
    engine.close();
  };
}

/** The viewer's page, and the loop that draws it when something has changed. */
class App {
  private store: Store | null = null;
  private welcome: Welcome | null = null;
  private ui: Ui | null = null;
  private readonly page = new PageState();
  private readonly frames: Partial<Record<ViewName, Frame>> = {};
  private readonly statistics = new FrameStatistics();
  private isScheduled = false;
  private readonly stops: (() => void)[] = [];
  private readonly opener: PageOpener;
  private readonly typed: TypedText;

  constructor(
    private readonly engine: Engine,
    private readonly host: Host,
    private readonly root: ShadowRoot,
    private readonly mount: HTMLElement,
  ) {
    this.typed = new TypedText(root);
    this.opener = new PageOpener({
      engine,
      hasData: () => this.store !== null,
      aspect: () => {
        const frame = this.frames["3d"];
        return frame === undefined ? null : frame.width / frame.height;
      },
      change: (operations) => this.showOpened(operations),
      openState: (file) => this.openState(file),
      announce: (text) => this.page.announce(text),
      problem: (problem) => this.page.change({ problem }),
      changed: () => this.schedule(),
    });
    this.stops.push(
      this.opener.listen(mount),
      this.page.subscribe(() => this.schedule()),
      engine.onConnection((connection) => {
        this.page.change({ connection });
        if (connection.kind === "start") this.opener.setOffered(connection.offered);
      }),
      engine.onProblem((problem) => this.page.change({ problem })),
      onThemeChange(() => this.schedule()),
    );
    engine.welcome.then(
      (welcome) => void this.begin(welcome),
      (problem: unknown) => this.page.change({ failure: problemOf(problem) }),
    );
    this.draw();
  }

  close(): void {
    this.page.close();
    this.stops.forEach((stop) => stop());
  }

  /** Makes the changes that show what was opened. A further layer is the one that the panels are about from then on. */
  private showOpened(operations: readonly Operation[]): void {
    if (this.store === null) return;
    const before = this.store.state.layers.length;
    this.store.change(operations);
    const after = this.store.state.layers.length;
    if (after > before) this.page.change({ layer: after - 1 });
  }

  private async begin(welcome: Welcome): Promise<void> {
    const store = createStore(this.engine);
    [this.welcome, this.store] = [welcome, store];
    this.ui = createUi(this.engine, store, this.page, {
      root: this.root,
      host: this.host.kind,
      frames: this.frames,
      statistics: this.statistics,
      opener: this.opener,
      schedule: () => this.schedule(),
    });
    const follower = new DataFollower(this.engine, () => store.state, (data) => {
      this.welcome = { ...welcome, ...data };
      this.host.onVolumes?.(data.volumes.map(({ name }) => name));
      this.expose();
      this.schedule();
    });
    this.stops.push(
      store.subscribe(() => {
        follower.check();
        this.schedule();
      }),
    );
    this.host.onVolumes?.(welcome.volumes.map(({ name }) => name));
    // On a page of its own keys are for the viewer, wherever the focus is; in a notebook only while it has the focus.
    if (this.host.kind === "page") {
      const stop = new AbortController();
      document.addEventListener("keydown", this.onKey, { signal: stop.signal });
      // The end of a gesture by keys, whose presses are one step of undo.
      document.addEventListener("keyup", () => store.settle(), { signal: stop.signal });
      resumeSteps(store, welcome.fingerprint, sessionStorage);
      window.addEventListener("pagehide", () => keepSteps(store, welcome.fingerprint, sessionStorage), { signal: stop.signal });
      this.stops.push(() => stop.abort());
    }
    this.expose();
    this.schedule();
    loadAhead();
    if (this.host.link === undefined) return;
    try {
      const { fingerprint, state } = await fromLink(this.host.link);
      if (fingerprint !== welcome.fingerprint) throw new Error(WORDS.opening.otherData);
      const { state: checked } = await this.engine.ask("open_state", { text: JSON.stringify(state) });
      store.change([{ op: "replace", path: "", value: checked }]);
    } catch (problem) {
      this.page.change({ problem: problemOf(problem) });
    }
  }

  private openState(file: File): void {
    const { store, welcome, ui } = this;
    if (store !== null && welcome !== null && ui !== null) void openState({ store, welcome, engine: this.engine, ui }, file);
  }

  /** For tests and benchmarks, and whoever looks at the console. */
  private expose(): void {
    (this.root.host as HTMLElement & { wavesplat?: unknown }).wavesplat = {
      store: this.store,
      statistics: this.statistics,
      frames: this.frames,
      welcome: this.welcome,
    };
  }

  private schedule(): void {
    if (this.isScheduled) return;
    this.isScheduled = true;
    requestAnimationFrame(() => {
      this.isScheduled = false;
      const begun = performance.now();
      this.draw();
      this.statistics.interfaceDrawn(performance.now() - begun);
    });
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    const target = event.composedPath()[0];
    const isField = target instanceof HTMLElement && target.matches("input, select, textarea, [contenteditable]");
    const action = actionOf(keyName(event));
    const { store, ui, page } = this;
    // A field has no use for Escape, nor for undo and redo while nothing that is typed waits in it.
    const isForField = isField && action !== "leave" && (this.typed.isWaiting || !(action === "undo" || action === "redo"));
    if (event.defaultPrevented || store === null || ui === null || isForField) return;
    if (action === "undo") store.undo();
    else if (action === "redo") store.redo();
    else if (action === "help") page.change({ help: true });
    else if (action === "leave") {
      if (!this.leave(ui)) return;
    } else if (action === "play" && !isOfControl(target, event.key)) this.root.querySelector<HTMLElement>(".look-play")?.click();
    else if (event.currentTarget === document && !page.fields.help && !isOfControl(target, event.key)) {
      ui.views.receive(event);
      return;
    } else return;
    event.preventDefault();
    event.stopPropagation();
    this.schedule();
  };

  /** Takes back the nearest thing: a message, what was typed, a tool, a sheet; returns whether there was one. Dialogs close themselves. */
  private leave(ui: Ui): boolean {
    const { page, root } = this;
    if (root.querySelector(":modal") !== null) return false;
    const sheet = root.querySelector<HTMLElement>(".sheet-head button");
    if (page.fields.problem !== null) page.change({ problem: null });
    else if (this.typed.takeBack()) return true;
    else if (ui.tool !== "turn" || ui.points.length > 0) ui.setTool("turn");
    else if (sheet !== null) sheet.click();
    else return false;
    return true;
  }

  private draw(): void {
    const { store, welcome, ui, page } = this;
    if (store === null || welcome === null || ui === null) {
      render(
        <div class="wavesplat" data-theme={surrounding()}>
          {page.fields.connection.kind === "start" ? (
            <StartPage opener={this.opener} engine={this.engine} host={this.host.kind} />
          ) : (
            <Opening connection={page.fields.connection} problem={page.fields.failure} />
          )}
        </div>,
        this.mount,
      );
      return;
    }
    const part: PartProps = { store, engine: this.engine, welcome, ui };
    render(<Page {...part} page={page.fields} onKey={this.onKey} onPage={(next) => page.change(next)} />, this.mount);
  }
}

/** Whether a key belongs to the control that has the focus: arrows scroll panels and go through lists. */
function isOfControl(target: EventTarget | undefined, key: string): boolean {
  return target instanceof Element && target.matches("a, button, summary, [tabindex]:not(.viewport), dialog *") && /^(Arrow|Page|Home|End|Enter$| $)/.test(key);
}
