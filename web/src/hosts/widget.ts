// The viewer as a widget of a notebook, as anywidget wants it (https://anywidget.dev/en/afm/).

import { commChannel, type WidgetModel } from "../engine/channel_comm.ts";
import { remoteEngine } from "../engine/remote.ts";
import { mountApp } from "../view/app.tsx";

/** Interval of repeated hellos, until one is answered: messages that were sent before the kernel listened are lost. */
const REPEAT_MS = 500;
const HEIGHT_PX = 520;

export function render({ model, el }: { readonly model: WidgetModel; readonly el: HTMLElement }): () => void {
  const page = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16)).join("");
  const box = document.createElement("div");
  box.style.cssText = `display:block;height:${HEIGHT_PX}px;resize:vertical;overflow:hidden`;
  // The viewer takes the keys while it has the focus: JupyterLab reads this attribute; other hosts get only those with Ctrl.
  box.dataset["lmSuppressShortcuts"] = "true";
  box.addEventListener("keydown", (event) => {
    if (!event.ctrlKey && !event.metaKey) event.stopPropagation();
  });
  el.append(box);
  const engine = remoteEngine(commChannel(model, page), { hello: () => ({}), repeatHelloMs: REPEAT_MS });
  const close = mountApp(box, engine, { kind: "widget" });
  return () => {
    close();
    box.remove();
  };
}
