// A look shown in the main picture while the pointer rests on its tile, without a step of undo. Leaving takes it back.

import type { Engine, Problem } from "../../engine/engine.ts";
import { set, type Operation } from "../../state/patch.ts";
import type { Composite, Look, ViewerState } from "../../state/state.ts";
import type { Store } from "../../state/store.ts";
import { chosen } from "./looks.ts";

/** Milliseconds for which the pointer must rest on a tile. */
const REST_MS = 150;

export class LookPreview {
  private readonly looks = new Map<string, Look>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private asked = 0;
  private shown: { readonly look: Look; readonly before: readonly Operation[]; readonly name: string } | null = null;

  constructor(
    private readonly store: Store,
    private readonly engine: Engine,
    private readonly layer: number,
    private readonly onProblem: (problem: Problem) => void,
  ) {}

  /** The name of the look that was chosen, whatever is shown in its place. */
  get chosenName(): string {
    return this.shown?.name ?? this.store.state.layers[this.layer]?.look.name ?? "";
  }

  /** Shows a look after a moment, unless the pointer goes on before. */
  rest(name: string): void {
    clearTimeout(this.timer);
    this.asked += 1;
    this.timer = setTimeout(() => void this.show(name), REST_MS);
  }

  /** Takes back what is shown. */
  leave(): void {
    clearTimeout(this.timer);
    this.asked += 1;
    const { shown } = this;
    this.shown = null;
    // Where undo, Python or another page has set another look since, that one stays.
    if (shown === null || JSON.stringify(lookIn(this.store.state, this.layer)) !== JSON.stringify(shown.look)) return;
    this.store.adjust(shown.before);
  }

  /** Chooses a look for good: one step of undo from what was there before the preview. */
  keep(look: Look, composite?: Composite): void {
    this.leave();
    this.store.change(chosen(this.store.state, this.layer, look, composite));
  }

  /** The look of a preset; each is asked for once. */
  async lookOf(name: string): Promise<Look> {
    const known = this.looks.get(name);
    if (known !== undefined) return known;
    const { look } = await this.engine.ask("preset", { layer: this.layer, name });
    this.looks.set(name, look);
    return look;
  }

  private async show(name: string): Promise<void> {
    const number = this.asked;
    try {
      const look = await this.lookOf(name);
      if (number !== this.asked) return;
      this.leave();
      const { state } = this.store;
      const before = restored(state, this.layer);
      this.shown = { look, before, name: lookIn(state, this.layer)?.name ?? "" };
      this.store.adjust(chosen(state, this.layer, look));
    } catch (problem) {
      this.onProblem(problem as Problem);
    }
  }
}

function lookIn(state: ViewerState, layer: number): Look | undefined {
  return state.layers[layer]?.look;
}

/** Operations that set all that choosing a look may change to what it is now. */
function restored(state: ViewerState, layer: number): Operation[] {
  return [
    set(lookIn(state, layer), "layers", layer, "look"),
    set(state.shading, "shading"),
    set(state.render.composite, "render", "composite"),
    set(state.background, "background"),
  ];
}
