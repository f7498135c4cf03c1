// The check that a document is a state of the viewer. What only the renderer can say, such as whether the points of a
// curve are in order, is left to it.

import { isViewerState, type ViewerState } from "./document.generated.ts";

/** Returns a document as a state, or throws an error that names the field. */
export function parseViewerState(document: unknown): ViewerState {
  isViewerState(document, "");
  return document as ViewerState;
}
