// Moves of the camera that no pointer leads: to standard views, to fit, to level; and the camera of a view that is resized.

import type { Engine, Problem } from "../engine/engine.ts";
import { between } from "../input/camera_path.ts";
import { set } from "../state/patch.ts";
import type { Camera, ViewerState } from "../state/state.ts";
import type { Store } from "../state/store.ts";
import type { PixelSize } from "./viewport.tsx";

/** Duration of a move, ms, and smallest change of width over height that counts as one. */
const EASE_MS = 200;
const SAME_ASPECT = 1e-3;
/** Largest change of width over height at which a picture has the shape of a view, whose sides are whole pixels. */
const LIKE_ASPECT = 1e-2;

/** The camera and the shape of the 3-D view when the camera was last chosen. */
interface Seen {
  readonly camera: Camera;
  readonly aspect: number;
  /** The camera that shows it in the view as it is now. */
  readonly kept: Camera;
}

/** The part of a state that says how much room the 3-D view has. */
const roomOf = ({ view }: ViewerState): string => JSON.stringify([view.layout, view.interface.panels]);

/** Moves the camera of one viewer: one move at a time, which the next one, or a gesture, ends. */
export class CameraMover {
  private number = 0;
  private frame = 0;
  private aspect = 0;
  private size: PixelSize = { width: 4, height: 3 };
  private seen: Seen | null = null;
  /** A camera that came with another layout, by a link, a file or undo: the change of size that follows leaves it as it is. */
  private given: Camera | null = null;

  constructor(
    private readonly engine: Engine,
    private readonly store: Store,
    private readonly fail: (problem: Problem) => void,
  ) {
    let last = store.state;
    store.subscribe(() => {
      const { state } = store;
      if (state.camera !== last.camera && roomOf(state) !== roomOf(last)) this.given = state.camera;
      last = state;
    });
  }

  /** Shows what is seen from the direction of a camera, with its lens: all of it, with the margin of first pictures. */
  async show(camera: Camera): Promise<void> {
    await this.ask(() => this.engine.ask("framed", { camera, ...this.size }));
  }

  /** Goes back to the view of the first picture. */
  async showFirst(): Promise<void> {
    await this.ask(() => this.engine.ask("first_view", this.size));
  }

  /** Moves to a camera: in 200 ms, or at once for those who want less motion, and in windows that are not seen. */
  to(target: Camera): void {
    this.stop();
    const from = this.store.state.camera;
    const isAtOnce = document.hidden || matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (isAtOnce) {
      this.store.change([set(target, "camera")]);
      return;
    }
    const begun = performance.now();
    let last = from;
    const step = (): void => {
      // Somebody else has moved it.
      if (this.store.state.camera !== last) {
        this.store.settle();
        return;
      }
      const t = Math.min(1, (performance.now() - begun) / EASE_MS);
      this.store.change([set(between(from, target, t * t * (3 - 2 * t)), "camera")], "ease");
      last = this.store.state.camera;
      if (t < 1) this.frame = requestAnimationFrame(step);
      else this.store.settle();
    };
    this.frame = requestAnimationFrame(step);
  }

  /** Ends a move where it is, as a gesture begins. */
  stop(): void {
    this.number += 1;
    cancelAnimationFrame(this.frame);
  }

  /** Keeps in view what was in view, as the 3-D view gets another size. */
  async resized(size: PixelSize): Promise<void> {
    const before = this.aspect;
    this.size = size;
    this.aspect = size.width / size.height;
    // The session frames the first picture itself.
    if (before === 0 || Math.abs(this.aspect / before - 1) < SAME_ASPECT) return;
    const { camera } = this.store.state;
    if (camera === this.given) {
      this.given = null;
      return;
    }
    if (this.seen?.kept !== camera) this.seen = { camera, aspect: before, kept: camera };
    const { seen, aspect } = this;
    try {
      const asked = { camera: seen.camera, aspect: seen.aspect, ...size };
      const answer = await this.engine.ask("kept_in_view", asked);
      if (this.store.state.camera !== camera || this.aspect !== aspect) return;
      this.store.adjust([set(answer.camera, "camera")]);
      this.seen = { ...seen, kept: this.store.state.camera };
    } catch (problem) {
      this.fail(problem as Problem);
    }
  }

  /**
   * The camera of a picture with the shape that the 3-D view had when its camera was chosen: the view may have become narrower
   * since, beside a sheet, and its camera with it.
   */
  cameraFor(aspect: number): Camera {
    const { camera } = this.store.state;
    const { seen } = this;
    return seen?.kept === camera && Math.abs(seen.aspect / aspect - 1) < LIKE_ASPECT ? seen.camera : camera;
  }

  private async ask(question: () => Promise<{ camera: Camera }>): Promise<void> {
    this.stop();
    const { number } = this;
    try {
      const { camera } = await question();
      if (number === this.number) this.to(camera);
    } catch (problem) {
      this.fail(problem as Problem);
    }
  }
}
