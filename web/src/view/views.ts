// The views of a page, and the one that keys are for: the view in which something was done last.

import type { ViewName } from "../state/state.ts";

type Receive = (event: KeyboardEvent) => void;

export class Views {
  private readonly shown = new Map<ViewName, Receive>();
  private used: ViewName = "3d";

  /** Adds a view that is shown; returns a function that removes it. */
  add(view: ViewName, receive: Receive): () => void {
    this.shown.set(view, receive);
    return () => this.shown.delete(view);
  }

  /** Notes that something was done in a view. */
  use(view: ViewName): void {
    this.used = view;
  }

  /** The view that was used last. */
  get last(): ViewName {
    return this.used;
  }

  /** Passes a key on to the view that was used last or, where that is gone, to the first one. */
  receive(event: KeyboardEvent): void {
    const receive = this.shown.get(this.used) ?? [...this.shown.values()][0];
    receive?.(event);
  }
}
