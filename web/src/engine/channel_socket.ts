// A channel through a WebSocket. When it breaks it is opened again, at ever longer intervals.

import type { Channel, ChannelState } from "./channel.ts";
import { packed, unpacked, type Header, type Payload } from "./framing.ts";

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 8000;
/** The server's own close codes for a page that it refuses. */
const REFUSED = [4400, 4401];

export function socketChannel(url: string): Channel {
  const messages = new Set<(header: Header, payload: Payload) => void>();
  const states = new Set<(state: ChannelState) => void>();
  let socket: WebSocket | null = null;
  let wait = FIRST_WAIT_MS;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let isClosed = false;

  const open = (): void => {
    clearTimeout(timer);
    const opened = new WebSocket(url);
    opened.binaryType = "arraybuffer";
    socket = opened;
    opened.onopen = () => {
      states.forEach((listener) => listener({ kind: "open" }));
    };
    opened.onmessage = (event: MessageEvent<ArrayBuffer>) => {
      wait = FIRST_WAIT_MS;
      const { header, payload } = unpacked(event.data);
      messages.forEach((listener) => listener(header, payload));
    };
    opened.onclose = (event) => {
      if (isClosed || socket !== opened) return;
      const retries = !REFUSED.includes(event.code);
      states.forEach((listener) => listener({ kind: "closed", reason: event.reason, retries }));
      if (!retries) return;
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };
  // Opened later, so that the caller can add its listeners first.
  queueMicrotask(open);

  return {
    send(header, payload) {
      if (socket?.readyState === WebSocket.OPEN) socket.send(packed(header, payload));
    },
    onMessage(listener) {
      messages.add(listener);
      return () => messages.delete(listener);
    },
    onState(listener) {
      states.add(listener);
      return () => states.delete(listener);
    },
    retry() {
      wait = FIRST_WAIT_MS;
      if (socket?.readyState !== WebSocket.OPEN) open();
    },
    close() {
      isClosed = true;
      clearTimeout(timer);
      socket?.close();
    },
  };
}
