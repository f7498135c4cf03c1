// A channel through a widget's own comm, as Jupyter, VS Code, Colab and marimo have it: no second port.

import { WORDS } from "../words.ts";
import type { Stop } from "../state/store.ts";
import type { Channel, ChannelState } from "./channel.ts";
import type { Problem } from "./engine.ts";
import type { Header, Payload } from "./framing.ts";

const TEXT = WORDS.connection;

/** The part of anywidget's model that is needed (https://anywidget.dev/en/afm/). */
export interface WidgetModel {
  send(content: unknown, callbacks?: unknown, buffers?: ArrayBuffer[] | ArrayBufferView[]): void;
  on(event: "msg:custom", listener: (content: unknown, buffers: unknown[]) => void): void;
  on(event: "comm_live_update", listener: (model: unknown) => void): void;
  off(event: "msg:custom", listener: (content: unknown, buffers: unknown[]) => void): void;
  off(event: "comm_live_update", listener: (model: unknown) => void): void;
  get(name: string): unknown;
}

/** The kernel was restarted or has ended: the viewer of its Python is gone. */
const ENDED: Problem = {
  code: "lost",
  message: TEXT.kernelEnded,
  remedy: TEXT.kernelEndedRemedy,
};
/** Kernels that are busy and kernels that were restarted are both silent, and not all hosts say which it is. */
const SILENCE: Problem = {
  code: "silent",
  message: TEXT.kernelSilent,
  remedy: TEXT.kernelSilentRemedy,
};

/** Bytes of a buffer, which hosts give as a view, as an array buffer or, some, as base64. */
export function bytesOf(buffer: unknown): Uint8Array<ArrayBuffer> {
  if (buffer instanceof ArrayBuffer) return new Uint8Array(buffer);
  if (ArrayBuffer.isView(buffer)) {
    return new Uint8Array(new Uint8Array(buffer.buffer, buffer.byteOffset, buffer.byteLength));
  }
  if (typeof buffer === "string") {
    const text = atob(buffer);
    return Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  }
  throw new TypeError("the host gave a buffer of an unknown kind");
}

/** A channel through a widget's comm. `page` distinguishes this page's messages from other pages' of the widget. */
export function commChannel(model: WidgetModel, page: string): Channel {
  const listeners = new Set<(header: Header, payload: Payload) => void>();
  const states = new Set<(state: ChannelState) => void>();
  const open = (): void => states.forEach((listener) => listener({ kind: "open" }));
  const receive = (content: unknown, buffers: unknown[]): void => {
    if (typeof content !== "object" || content === null) return;
    const header = content as Header;
    if (header["page"] !== page) return;
    const first = buffers?.[0];
    const payload = first === undefined ? new Uint8Array() : bytesOf(first);
    for (const listener of listeners) listener(header, payload);
  };
  // Of ipywidgets in JupyterLab and Notebook: the comm of the model has gone with the kernel.
  const lived = (shown: unknown): void => {
    if ((shown as { comm_live?: unknown } | null)?.comm_live !== false) return;
    states.forEach((listener) => listener({ kind: "closed", problem: ENDED, retries: false }));
  };
  model.on("msg:custom", receive);
  model.on("comm_live_update", lived);
  // Opened later, so that the caller can add its listeners first.
  queueMicrotask(open);
  return {
    silence: SILENCE,
    send(header, payload) {
      model.send({ ...header, page }, undefined, payload === undefined ? [] : [payload]);
    },
    onMessage(listener): Stop {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    onState(listener): Stop {
      states.add(listener);
      return () => states.delete(listener);
    },
    retry: open,
    close() {
      model.send({ type: "bye", page }, undefined, []);
      model.off("msg:custom", receive);
      model.off("comm_live_update", lived);
      listeners.clear();
    },
  };
}
