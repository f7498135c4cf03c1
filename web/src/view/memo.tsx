// Parts of the page that are drawn again only where what they show has changed.

import { Component, type ComponentChildren } from "preact";

import { PANES } from "../state/state.ts";
import type { PartProps } from "./part.ts";

interface MemoProps {
  /** The values that the children show. */
  readonly of: readonly unknown[];
  readonly children: () => ComponentChildren;
}

/** Draws its children when one of the values is another than before. */
export class Memo extends Component<MemoProps> {
  override shouldComponentUpdate(next: MemoProps): boolean {
    return next.of.length !== this.props.of.length || next.of.some((value, n) => !Object.is(value, this.props.of[n]));
  }

  override render(): ComponentChildren {
    return this.props.children();
  }
}

/** The values that panels show: all of the state, but of the camera, which moves with every frame, only lens and last rest. */
export function shownByPanels({ store, ui, welcome }: PartProps): readonly unknown[] {
  const { layers, labels, shading, clip, background, geometry, render, view, camera } = store.state;
  const windows = PANES.map((pane) => ui.frames[pane]?.slice?.window?.join());
  const lens = camera.view_angle;
  return [layers, labels, shading, clip, background, geometry, render, view, lens, ui.restCamera, ...windows, ui.layer, ui.tool, ui.points, welcome];
}

/** The values that slices show. */
export function shownBySlices({ store, ui, welcome }: PartProps): readonly unknown[] {
  const { layers, labels, clip, view } = store.state;
  return [layers, labels, clip, view, ...PANES.map((pane) => ui.frames[pane]), ui.layer, ui.tool, ui.points, welcome];
}

/** The values that the toolbar shows. */
export function shownByToolbar({ store, ui, welcome }: PartProps): readonly unknown[] {
  const { layers, view } = store.state;
  return [layers, view.layout, view.interface, ui.tool, store.canUndo, store.canRedo, welcome];
}
