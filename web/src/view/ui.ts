// What the parts of a page know and do beside the viewer's state: over the page's own state, frames and views.

import type { Engine } from "../engine/engine.ts";
import { set } from "../state/patch.ts";
import type { Camera } from "../state/state.ts";
import type { Store } from "../state/store.ts";
import { CameraMover } from "./camera_mover.ts";
import type { PageState } from "./page_state.ts";
import type { Ui } from "./part.ts";
import { problemOf } from "./problems.ts";
import { isMeasure } from "./slices/measures.tsx";
import { Views } from "./views.ts";

/** Time after which the address of a download is given up, ms. */
const DOWNLOADED_MS = 10_000;

interface Around extends Pick<Ui, "root" | "host" | "statistics" | "opener"> {
  readonly frames: Partial<Ui["frames"]> & { -readonly [view in keyof Ui["frames"]]: Ui["frames"][view] };
  /** Draws the page anew. */
  readonly schedule: () => void;
}

export function createUi(engine: Engine, store: Store, page: PageState, around: Around): Ui {
  const { root, host, statistics, opener, frames, schedule } = around;
  let restCamera: Camera | null = null;
  return {
    root,
    host,
    statistics,
    opener,
    frames,
    camera: new CameraMover(engine, store, (problem) => page.change({ problem: problemOf(problem) })),
    views: new Views(),
    frameShown(frame) {
      frames[frame.view] = frame;
      if (frame.at_rest && frame.camera !== undefined) restCamera = frame.camera;
      statistics.drawn(frame, performance.now());
      schedule();
    },
    get restCamera() {
      return restCamera;
    },
    get tool() {
      return page.fields.tool;
    },
    setTool: (tool) => page.change({ tool, points: [] }),
    get points() {
      return page.fields.points;
    },
    addPoint(point) {
      const kind = page.fields.tool === "angle" ? "angle" : "distance";
      const points = [...page.fields.points, point];
      // A region has as many corners as it is given, until it is closed.
      const isWhole = page.fields.tool !== "area" && points.length >= (kind === "angle" ? 3 : 2);
      page.change({ points: isWhole ? [] : points });
      if (isWhole && isMeasure(points)) store.change([set({ kind, points }, "view", "measures", "-")]);
    },
    get layer() {
      return Math.min(page.fields.layer, store.state.layers.length - 1);
    },
    setLayer: (layer) => page.change({ layer }),
    get probed() {
      return page.fields.probed;
    },
    probe: (ask) => page.probe(ask),
    tell: (text) => page.tell(text),
    announce: (text) => page.announce(text),
    problem: (problem) => page.change({ problem: problemOf(problem) }),
    download(name, content, type) {
      const url = URL.createObjectURL(new Blob([content], { type }));
      const link = document.createElement("a");
      link.href = url;
      link.download = name;
      link.click();
      setTimeout(() => URL.revokeObjectURL(url), DOWNLOADED_MS);
    },
  };
}
