// A channel through a WebSocket. When it breaks it is opened again, at ever longer intervals.

import { WORDS } from "../words.ts";
import type { Channel, ChannelState } from "./channel.ts";
import type { Problem } from "./engine.ts";
import { packed, unpacked, type Header, type Payload } from "./framing.ts";

const TEXT = WORDS.connection;

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 8000;
/** The server's own close codes for a page that it refuses. */
const BROKEN = 4400;
const UNKNOWN = 4401;

/** The program has ended, or cannot be reached. */
const LOST: Problem = {
  code: "lost",
  message: TEXT.lost,
  remedy: TEXT.lostRemedy,
};
const SILENCE: Problem = {
  code: "silent",
  message: TEXT.silent,
  remedy: TEXT.silentRemedy,
};

/** The problem of a page that the server refuses, by the code of the close. */
function refusal(code: number, reason: string): Problem {
  return {
    code: "refused",
    message: reason || TEXT.refused,
    remedy: code === UNKNOWN ? TEXT.usedLink : TEXT.reload,
  };
}

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
      const retries = event.code !== BROKEN && event.code !== UNKNOWN;
      const problem = retries ? LOST : refusal(event.code, event.reason);
      states.forEach((listener) => listener({ kind: "closed", problem, retries }));
      if (!retries) return;
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };
  // Opened later, so that the caller can add its listeners first.
  queueMicrotask(open);

  return {
    silence: SILENCE,
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
