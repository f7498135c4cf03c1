// The timing of playing a series: a set rate, but no step before the frame of the last one is on the screen.

import { PANES, type View, type ViewName } from "../../state/state.ts";

/** The views that a layout shows. */
export function shownViews({ name, main }: View["layout"]): readonly ViewName[] {
  if (name === "single") return [main];
  return name === "3d" ? ["3d"] : ["3d", ...PANES];
}

/** The next time, or null at the end of a series that is not repeated. */
export function nextTime(time: number, count: number, repeats: boolean): number | null {
  if (time + 1 < count) return time + 1;
  return repeats && count > 1 ? 0 : null;
}

/** Milliseconds until the next step is due; null while the picture of the last one has not come. */
export function waitFor(
  now: number,
  last: { readonly at: number; readonly isShown: boolean },
  perSecond: number,
): number | null {
  if (!last.isShown) return null;
  return Math.max(0, last.at + 1000 / perSecond - now);
}
