// Undo and redo over the state that the engine holds.

import type { Engine } from "../engine/engine.ts";
import { differences } from "./differences.ts";
import { patched, type Operation } from "./patch.ts";
import type { View, ViewerState } from "./state.ts";

export type Stop = () => void;

export interface Store {
  /** The newest state: changes made here are in it at once. */
  readonly state: ViewerState;
  /** The number of the newest change, as frames carry it. */
  readonly seq: number;
  /** Changes the state. Changes of one `gesture` up to `settle` are one step of undo, and are drawn as moving pictures. */
  change(operations: readonly Operation[], gesture?: string): void;
  /** Changes the state as no step of undo: for what the page mends by itself, such as the camera of a resized view. */
  adjust(operations: readonly Operation[]): void;
  /** Whether layout, panels and theme are those that another window chose last. */
  readonly isFollowing: boolean;
  /** Follows other windows in layout, panels and theme, or keeps its own. */
  follow(on: boolean): void;
  /** Ends the gesture under way: the picture at rest follows. */
  settle(): void;
  undo(): void;
  redo(): void;
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  /** The steps that can be undone and redone, for a page that is opened again. */
  readonly steps: Steps;
  /** Takes the steps of an earlier page, if its state is the one that is shown now. */
  resume(steps: Steps): void;
  subscribe(listener: () => void): Stop;
}

/** Steps of undo: the state that they belong to, and the states before and after it. */
export interface Steps {
  readonly now: ViewerState;
  readonly past: readonly ViewerState[];
  readonly future: readonly ViewerState[];
}

/** Largest number of steps that can be undone. */
const MAX_STEPS = 200;

/** Fields of the state whose changes are no steps of undo: the look of the page itself. */
const INTERFACE = ["/view/interface", "/view/layout"];

/** The part of a state that each window has for itself. */
type Own = Pick<View, "layout" | "interface">;

const ownOf = ({ view }: ViewerState): Own => ({ layout: view.layout, interface: view.interface });
const withOwn = (state: ViewerState, own: Own): ViewerState => ({ ...state, view: { ...state.view, ...own } });

export function createStore(engine: Engine): Store {
  /** Layout and panels of this window, once another window has chosen others; null: the session's. */
  let own: Own | null = null;
  let isFollowing = false;
  let shown: { readonly of: ViewerState; readonly own: Own; readonly state: ViewerState } | null = null;
  /** The session's state with the layout and panels of this window: one object until either is another one. */
  const current = (): ViewerState => {
    const of = engine.state;
    if (own === null) return of;
    if (shown?.of !== of || shown.own !== own) shown = { of, own, state: withOwn(of, own) };
    return shown.state;
  };
  /** The layout of this window, and that of the session, at the last change. */
  let last = ownOf(engine.state);
  let ofSession = "";
  const note = (): void => {
    last = ownOf(current());
    ofSession = JSON.stringify(ownOf(engine.state));
  };
  note();
  /** Sends a change, and makes it in what this window has for itself. */
  const send = (operations: readonly Operation[], moving: boolean): number => {
    const isOwn = own !== null && operations.some(({ path }) => "/view".startsWith(path) || INTERFACE.some((start) => path.startsWith(start)));
    const after = isOwn ? ownOf(patched(current(), operations)) : own;
    const number = engine.patch(operations, moving);
    own = after;
    note();
    return number;
  };
  let seq = 0;
  let gesture: string | null = null;
  let past: ViewerState[] = [];
  let future: ViewerState[] = [];
  const listeners = new Set<() => void>();
  const notify = (): void => listeners.forEach((listener) => listener());

  const remember = (before: ViewerState): void => {
    past = [...past.slice(1 - MAX_STEPS), before];
    future = [];
  };

  /** Goes to another state of the past or future; the interface stays as it is. */
  const go = (target: ViewerState): void => {
    gesture = null;
    seq = send([{ op: "replace", path: "", value: withOwn(target, ownOf(current())) }], false);
    notify();
  };

  engine.onState((operations, cause) => {
    if (JSON.stringify(ownOf(engine.state)) !== ofSession && !isFollowing) {
      if (cause === "other view") own ??= last;
      else if (own !== null) own = cause === "python" ? null : ownOf(engine.state);
    }
    note();
    // A change by others is no step of undo, and our steps do not undo it.
    const also = (before: ViewerState): ViewerState => {
      try {
        return operations.some(({ path }) => path === "") ? before : patched(before, operations);
      } catch {
        return before;
      }
    };
    past = past.map(also);
    future = future.map(also);
    // Nor are changes that were refused: the state is again the one before the first of them.
    const refused = past.lastIndexOf(engine.state);
    if (refused >= 0) past = past.slice(0, refused);
    notify();
  });

  return {
    get state() {
      return current();
    },
    get isFollowing() {
      return isFollowing;
    },
    follow(on) {
      isFollowing = on;
      own = on ? null : ownOf(current());
      notify();
    },
    get seq() {
      return seq;
    },
    change(operations, name) {
      const before = engine.state;
      const isStep = operations.some(({ path }) => !INTERFACE.some((start) => path.startsWith(start)));
      if (isStep && (name === undefined || name !== gesture)) remember(before);
      if (isStep) gesture = name ?? null;
      seq = send(operations, name !== undefined);
      notify();
    },
    adjust(operations) {
      seq = send(operations, false);
      notify();
    },
    settle() {
      if (gesture === null) return;
      gesture = null;
      seq = engine.patch([], false);
    },
    undo() {
      const target = past.at(-1);
      if (target === undefined) return;
      past = past.slice(0, -1);
      future = [...future, engine.state];
      go(target);
    },
    redo() {
      const target = future.at(-1);
      if (target === undefined) return;
      future = future.slice(0, -1);
      past = [...past, engine.state];
      go(target);
    },
    get canUndo() {
      return past.length > 0;
    },
    get canRedo() {
      return future.length > 0;
    },
    get steps() {
      return { now: engine.state, past, future };
    },
    resume(steps) {
      const changed = differences(steps.now, engine.state).filter(({ path }) => !INTERFACE.some((start) => path.startsWith(start)));
      if (changed.length > 0) return;
      [past, future] = [[...steps.past], [...steps.future]];
      notify();
    },
    subscribe(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
  };
}
