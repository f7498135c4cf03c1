// Operations that move what slices show: the crosshair, the place in their middle, and their magnification. No DOM.

import { add, scaled, sub } from "../../input/camera.ts";
import type { Welcome } from "../../engine/engine.ts";
import { set, type Operation } from "../../state/patch.ts";
import type { Vec3, ViewerState } from "../../state/state.ts";
import { worldAt, type SliceFrame } from "./geometry.ts";

/** Least and largest magnification of slices. */
export const ZOOMS = [0.1, 100] as const;

/** The world position in the middle of all panes. */
export function centerOf(state: ViewerState, welcome: Welcome): Vec3 {
  const { center } = state.view.slices;
  if (center !== undefined) return center;
  const [lower, upper] = welcome.volumes[0]?.bounds ?? welcome.bounds;
  return scaled(add(lower, upper), 0.5);
}

/** Magnifies about a world point, which stays where it is in every pane. */
export function zoomedAbout(state: ViewerState, welcome: Welcome, point: Vec3, factor: number): Operation[] {
  const { zoom } = state.view.slices;
  const next = Math.min(Math.max(zoom * factor, ZOOMS[0]), ZOOMS[1]);
  if (next === zoom) return [];
  const center = add(point, scaled(sub(centerOf(state, welcome), point), zoom / next));
  return [set(next, "view", "slices", "zoom"), set(center, "view", "slices", "center")];
}

/**
 * Moves the picture by pixels. `center`: the place in the middle before; `on`: the frame before.
 * What is in the middle stays within the volume's box, so that the slice cannot be lost.
 */
export function panned(on: SliceFrame, center: Vec3, dx: number, dy: number, welcome: Welcome): Operation[] {
  const [lower, upper] = welcome.volumes[0]?.bounds ?? welcome.bounds;
  const way = sub(worldAt(on, dx, dy), worldAt(on, 0, 0));
  const next = vec3((a) => Math.min(Math.max(center[a] - way[a], lower[a]), upper[a]));
  return [set(next, "view", "slices", "center")];
}

const vec3 = (of: (axis: 0 | 1 | 2) => number): Vec3 => [of(0), of(1), of(2)];

/** Shows all of the slice. */
export function fitted(state: ViewerState): Operation[] {
  const ops: Operation[] = state.view.slices.center === undefined ? [] : [{ op: "remove", path: "/view/slices/center" }];
  return [set(1, "view", "slices", "zoom"), ...ops];
}

/** Puts the crosshair at a world point; magnified slices follow, so that it is in view. */
export function crosshairAt(state: ViewerState, point: Vec3): Operation[] {
  const follows = state.view.slices.zoom > 1 || state.view.slices.center !== undefined;
  return [set(point, "view", "slices", "crosshair"), ...(follows ? [set(point, "view", "slices", "center")] : [])];
}

/** Movement of two fingers, pixels, after which their gesture counts as scrolling, or as moving and magnifying; and pixels per slice. */
const DECIDED_PX = 12;
const PINCHED = 0.12;
const TOUCH_STEP_PX = 14;

/** Recognises the gesture of two fingers: up and down together scroll through slices; else they move the picture and magnify it. */
export class TwoFingers {
  private mode: "undecided" | "scroll" | "move" = "undecided";
  private dx = 0;
  private dy = 0;
  private log = 0;
  private steps = 0;

  /** Takes a movement; returns the number of slices to scroll by, or what to move and magnify by, or null for neither yet. */
  moved(dx: number, dy: number, factor: number): { steps: number } | { dx: number; dy: number; factor: number } | null {
    this.dx += dx;
    this.dy += dy;
    this.log += Math.log(factor);
    if (this.mode === "move") return { dx, dy, factor };
    if (this.mode === "undecided") {
      const isPinch = Math.abs(this.log) > PINCHED;
      if (!isPinch && Math.hypot(this.dx, this.dy) < DECIDED_PX) return null;
      this.mode = !isPinch && Math.abs(this.dy) > 2 * Math.abs(this.dx) ? "scroll" : "move";
      if (this.mode === "move") return { dx: this.dx, dy: this.dy, factor: Math.exp(this.log) };
    }
    const steps = Math.trunc(this.dy / TOUCH_STEP_PX);
    const more = steps - this.steps;
    this.steps = steps;
    return more === 0 ? null : { steps: more };
  }

  end(): void {
    this.mode = "undecided";
    this.dx = this.dy = this.log = this.steps = 0;
  }
}
