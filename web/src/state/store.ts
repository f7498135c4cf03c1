// The state in the page, what was undone, and the road to the engine.

import type { Operation } from "./patch.ts";
import type { ViewerState } from "./state.ts";

export type Stop = () => void;

export interface Store {
  /** The newest state: what was changed here is in it at once. */
  readonly state: ViewerState;
  /** Changes the state. All changes with one `gesture` name until `settle` are one step of undo. */
  change(operations: readonly Operation[], gesture?: string): void;
  /** Ends the gesture under way: the picture at rest follows. */
  settle(): void;
  undo(): void;
  redo(): void;
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  subscribe(listener: () => void): Stop;
}
