// One pane that fills the page, and the layout before, to which another double click goes back.

import { set } from "../../state/patch.ts";
import type { View, ViewName } from "../../state/state.ts";
import type { Store } from "../../state/store.ts";

const before = new WeakMap<Store, View["layout"]>();

/** Lets a view fill the page, or goes back to the layout before. */
export function toggleMaximised(store: Store, view: ViewName): void {
  const { layout } = store.state.view;
  if (layout.name === "single") {
    const back: View["layout"] = before.get(store) ?? { name: "two-by-two", main: "3d" };
    store.change([set(back, "view", "layout")]);
    return;
  }
  before.set(store, layout);
  store.change([set({ name: "single", main: view }, "view", "layout")]);
}
