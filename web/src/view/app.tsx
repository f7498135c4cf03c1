// The interface as a whole: it draws itself anew from the state and the frames, from the top.

import { render } from "preact";

import type { Connection, Engine, Frame, Problem, Welcome } from "../engine/engine.ts";
import { actionOf, keyName } from "../input/keys.ts";
import { fromLink } from "../state/link.ts";
import { parseViewerState } from "../state/parse.ts";
import { set } from "../state/patch.ts";
import type { Vec3, ViewName } from "../state/state.ts";
import { createStore, type Store } from "../state/store.ts";
import { FrameStatistics } from "./frame_statistics.ts";
import { css as lookCss } from "./look/index.ts";
import { Page, type Shown } from "./page.tsx";
import type { PartProps, Tool, Ui } from "./part.ts";
import { problemOf } from "./share.tsx";
import { isMeasure } from "./slices/measures.tsx";
import { Opening } from "./status.tsx";
import style from "./style.css";
import { onThemeChange, surrounding } from "./theme.ts";

export interface Host {
  readonly kind: "page" | "widget";
  /** The part of a link that says what to show. */
  readonly link?: string | undefined;
}

/** Least time between announcements, ms. */
const ANNOUNCED_MS = 1000;
/** Least time between questions for what is under the pointer, ms. */
const PROBE_MS = 40;

/** Shows the viewer in an element, and returns a function that removes it. */
export function mountApp(parent: HTMLElement, engine: Engine, host: Host): () => void {
  const root = parent.shadowRoot ?? parent.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync([style, lookCss].join("\n"));
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

/** The viewer's page: its state outside of the document (connection, problems, frames), and the loop that draws it. */
class App {
  private store: Store | null = null;
  private welcome: Welcome | null = null;
  private connection: Connection = { kind: "connecting", text: "" };
  private problem: Problem | null = null;
  private failure: Problem | null = null;
  private readonly frames: Partial<Record<ViewName, Frame>> = {};
  private readonly statistics = new FrameStatistics();
  private tool: Tool = "turn";
  private points: Vec3[] = [];
  private layer = 0;
  private probed = "";
  private probeTimer: ReturnType<typeof setTimeout> | undefined;
  private help = false;
  private figures = false;
  private said = "";
  private lastSaid = 0;
  private sayTimer: ReturnType<typeof setTimeout> | undefined;
  private isScheduled = false;
  private readonly stops: (() => void)[] = [];

  constructor(
    private readonly engine: Engine,
    private readonly host: Host,
    private readonly root: ShadowRoot,
    private readonly mount: HTMLElement,
  ) {
    this.stops.push(
      engine.onConnection((connection) => {
        this.connection = connection;
        this.schedule();
      }),
      engine.onProblem((problem) => {
        this.problem = problem;
        this.schedule();
      }),
      onThemeChange(() => this.schedule()),
    );
    engine.welcome.then(
      (welcome) => void this.begin(welcome),
      (problem: unknown) => {
        this.failure = problemOf(problem);
        this.schedule();
      },
    );
    this.draw();
  }

  close(): void {
    this.stops.forEach((stop) => stop());
  }

  private async begin(welcome: Welcome): Promise<void> {
    this.welcome = welcome;
    this.store = createStore(welcome.state, this.engine);
    this.stops.push(this.store.subscribe(() => this.schedule()));
    this.expose();
    this.schedule();
    if (this.host.link === undefined) return;
    try {
      const { fingerprint, state } = await fromLink(this.host.link);
      if (fingerprint !== welcome.fingerprint) throw new Error("The link is of other data than is open here");
      const text = JSON.stringify(parseViewerState(state));
      const { state: checked } = await this.engine.ask("open_state", { text });
      this.store.change([{ op: "replace", path: "", value: checked }]);
    } catch (problem) {
      this.problem = problemOf(problem);
      this.schedule();
    }
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
      this.draw();
    });
  }

  private readonly ui = ((app: App): Ui => ({
    get root() {
      return app.root;
    },
    get host() {
      return app.host.kind;
    },
    statistics: app.statistics,
    frames: app.frames,
    frameShown(frame) {
      app.frames[frame.view] = frame;
      app.statistics.drawn(frame, performance.now());
      app.schedule();
    },
    get tool() {
      return app.tool;
    },
    setTool(tool) {
      app.tool = tool;
      app.points = [];
      app.schedule();
    },
    get points() {
      return app.points;
    },
    addPoint(point) {
      app.addPoint(point);
    },
    get layer() {
      return Math.min(app.layer, (app.store?.state.layers.length ?? 1) - 1);
    },
    setLayer(layer) {
      app.layer = layer;
      app.schedule();
    },
    get probed() {
      return app.probed;
    },
    probe(ask) {
      clearTimeout(app.probeTimer);
      const tell = (text: string): void => {
        if (app.probed !== text) app.schedule();
        app.probed = text;
      };
      const timer = setTimeout(() => {
        // An answer for an older place comes too late.
        ask?.().then((text) => app.probeTimer === timer && tell(text), () => undefined);
      }, PROBE_MS);
      app.probeTimer = timer;
      if (ask === null) tell("");
    },
    announce(text) {
      app.announce(text);
    },
    problem(problem) {
      app.problem = problemOf(problem);
      app.schedule();
    },
    download(name, content, type) {
      const url = URL.createObjectURL(new Blob([content], { type }));
      const link = document.createElement("a");
      link.href = url;
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(url), 10_000);
    },
  }))(this);

  private addPoint(point: Vec3): void {
    const kind = this.tool === "angle" ? "angle" : "distance";
    const points = [...this.points, point];
    if (points.length < (kind === "angle" ? 3 : 2)) {
      this.points = points;
    } else {
      this.points = [];
      if (isMeasure(points)) this.store?.change([set({ kind, points }, "view", "measures", "-")]);
    }
    this.schedule();
  }

  private announce(text: string): void {
    clearTimeout(this.sayTimer);
    const wait = Math.max(0, this.lastSaid + ANNOUNCED_MS - performance.now());
    this.sayTimer = setTimeout(() => {
      this.said = text;
      this.lastSaid = performance.now();
      this.schedule();
    }, wait);
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    const target = event.composedPath()[0];
    const isField = target instanceof HTMLElement && target.matches("input, select, textarea, [contenteditable]");
    const action = actionOf(keyName(event));
    if (event.defaultPrevented || this.store === null || (isField && action !== "leave")) return;
    if (action === "undo") this.store.undo();
    else if (action === "redo") this.store.redo();
    else if (action === "help") this.help = true;
    else if (action === "leave" && (this.tool !== "turn" || this.points.length > 0)) this.ui.setTool("turn");
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.schedule();
  };

  private draw(): void {
    const { store, welcome } = this;
    if (store === null || welcome === null) {
      render(
        <div class="wavesplat" data-theme={surrounding()}>
          <Opening connection={this.connection} problem={this.failure} />
        </div>,
        this.mount,
      );
      return;
    }
    const part: PartProps = { store, engine: this.engine, welcome, ui: this.ui };
    render(<Page {...part} app={this.shown()} />, this.mount);
  }

  private shown(): Shown {
    return {
      connection: this.connection,
      problem: this.problem,
      help: this.help,
      figures: this.figures,
      said: this.said,
      onKey: this.onKey,
      onHelp: (on) => {
        this.help = on;
        this.schedule();
      },
      onFigures: (on) => {
        this.figures = on;
        this.schedule();
      },
      onProblemClosed: () => {
        this.problem = null;
        this.schedule();
      },
    };
  }
}
