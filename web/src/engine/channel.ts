// The transport of messages to the session and back: a WebSocket, or the comm of a notebook's widget.

import type { Stop } from "../state/store.ts";
import type { Problem } from "./engine.ts";
import type { Header, Payload } from "./framing.ts";

export type ChannelState =
  | { readonly kind: "open" }
  | { readonly kind: "closed"; readonly problem: Problem; readonly retries: boolean };

export interface Channel {
  send(header: Header, payload?: Payload): void;
  onMessage(listener: (header: Header, payload: Payload) => void): Stop;
  /** Calls back when the state changes: with `open` each time that a hello is due. */
  onState(listener: (state: ChannelState) => void): Stop;
  /** Tries to connect again now. */
  retry(): void;
  close(): void;
  /** The problem to show where messages stay without an answer: the only sign of some ends. */
  readonly silence: Problem;
}
