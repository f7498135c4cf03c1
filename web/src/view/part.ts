// The properties that every part of the interface is given.

import type { Engine, Frame, Problem, Welcome } from "../engine/engine.ts";
import type { CameraMover } from "./camera_mover.ts";
import type { FrameStatistics } from "./frame_statistics.ts";
import type { PageOpener } from "./open/page_opener.ts";
import type { Views } from "./views.ts";
import type { Camera, Vec3, ViewName } from "../state/state.ts";
import type { Store } from "../state/store.ts";

/** The tool of a drag with the left button in the views. */
export type Tool = "turn" | "distance" | "angle" | "window";

/** State and actions of this page alone, which are no part of the viewer's state. */
export interface Ui {
  readonly root: ShadowRoot | HTMLElement;
  readonly host: "page" | "widget";
  readonly statistics: FrameStatistics;
  /** Opens files in the page. */
  readonly opener: PageOpener;
  /** Moves the camera where no pointer leads it. */
  readonly camera: CameraMover;
  /** The views that are shown, and the one that keys are for. */
  readonly views: Views;
  /** Reports that a frame is on the screen. */
  frameShown(frame: Frame): void;
  /** The frames that are on the screen now. */
  readonly frames: Readonly<Partial<Record<ViewName, Frame>>>;
  /** The camera of the newest 3-D picture at rest. */
  readonly restCamera: Camera | null;
  readonly tool: Tool;
  setTool(tool: Tool): void;
  /** The layer that the panels of the look are about. */
  readonly layer: number;
  setLayer(layer: number): void;
  /** Value and place, or shape, under the pointer; "" where nothing is known. */
  readonly probed: string;
  /** Finds out what is under the pointer, for its newest place alone. */
  probe(ask: (() => Promise<string>) | null): void;
  /** Adds a point to the measure under way, which its last point completes. */
  addPoint(point: Vec3): void;
  readonly points: readonly Vec3[];
  /** Announces a text to screen readers, politely. */
  announce(text: string): void;
  /** Shows a problem: what failed, why, and what the user can do. */
  problem(problem: Problem): void;
  download(name: string, content: Uint8Array<ArrayBuffer> | string, type: string): void;
}

export interface PartProps {
  readonly store: Store;
  readonly engine: Engine;
  readonly welcome: Welcome;
  readonly ui: Ui;
}

export interface CssSize {
  readonly width: number;
  readonly height: number;
}
