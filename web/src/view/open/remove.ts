// Changes that take layers, the segmentation and shapes out of the state; what is open stays open, for undo.

import { set, type Operation } from "../../state/patch.ts";
import type { ViewerState } from "../../state/state.ts";

/** Takes a layer out. With the first go the segmentation of its samples and boxes in them. */
export function withoutLayer(state: ViewerState, index: number): Operation[] {
  const operations: Operation[] = [{ op: "remove", path: `/layers/${index}` }];
  if (index > 0) return operations;
  const inWorld = state.clip.filter((clip) => {
    const box = "keep" in clip ? clip.keep : "cut_out" in clip ? clip.cut_out : null;
    return box?.space !== "index";
  });
  return [
    ...(state.labels === null ? [] : [set(null, "labels")]),
    ...(inWorld.length === state.clip.length ? [] : [set(inWorld, "clip")]),
    ...operations,
  ];
}

export const withoutShape = (index: number): Operation[] => [{ op: "remove", path: `/geometry/${index}` }];

export const withoutLabels = (): Operation[] => [set(null, "labels")];
