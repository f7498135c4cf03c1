// The engine behind a channel: the session in Python. Changes are merged into one message an animation frame.

import { patched, type Operation } from "../state/patch.ts";
import type { ViewName, ViewerState } from "../state/state.ts";
import type { Stop } from "../state/store.ts";
import type { Channel } from "./channel.ts";
import type { Connection, Engine, Frame, Offered, Problem, Question, Questions, Welcome } from "./engine.ts";
import type { Header, Payload } from "./framing.ts";

export interface RemoteOptions {
  /** Fields of the hello beside the protocol: a token or the key of the session. */
  readonly hello: () => Header;
  /** Called with the key by which the page gets in again. */
  readonly onSession?: (key: string) => void;
  /** Called when the session has other data than before. */
  readonly onOtherData?: () => void;
  /** Calls back in the next animation frame. */
  readonly nextFrame?: (callback: () => void) => void;
  /** Milliseconds after which a hello without an answer is sent again; 0: never, as sockets lose nothing. */
  readonly repeatHelloMs?: number;
}

interface Waiting {
  resolve(answer: unknown): void;
  reject(problem: Problem): void;
  readonly progress: ((part: number) => void) | undefined;
}

/** Milliseconds without an answer after which the kernel, or the line, counts as busy. */
const BUSY_MS = 600;

/** Fields that the page shows by itself: their changes are sent when a gesture ends, or with others. */
const SHOWN_HERE: readonly string[] = ["/view/slices/window"];

const LOST: Problem = { code: "lost", message: "the connection was lost" };

export function remoteEngine(channel: Channel, options: RemoteOptions): Engine {
  const frames = new Set<(frame: Frame) => void>();
  const states = new Set<(operations: readonly Operation[]) => void>();
  const connections = new Set<(connection: Connection) => void>();
  const problems = new Set<(problem: Problem) => void>();
  const waiting = new Map<number, Waiting>();
  const sizes = new Map<ViewName, { readonly width: number; readonly height: number }>();
  const nextFrame = options.nextFrame ?? ((callback) => void requestAnimationFrame(callback));

  let welcomed: (welcome: Welcome) => void = () => undefined;
  let failed: (problem: Problem) => void = () => undefined;
  const welcome = new Promise<Welcome>((resolve, reject) => {
    welcomed = resolve;
    failed = reject;
  });
  welcome.catch(() => undefined);

  let state: ViewerState | null = null;
  let fingerprint: unknown;
  let seq = 0;
  let nextId = 1;
  let outgoing: Operation[] = [];
  let isMoving = false;
  let isScheduled = false;
  let isOpen = false;
  let helloTimer: ReturnType<typeof setInterval> | undefined;
  let busyTimer: ReturnType<typeof setTimeout> | undefined;
  let isBusy = false;

  const tell = (connection: Connection): void => connections.forEach((listener) => listener(connection));

  const heard = (): void => {
    clearTimeout(busyTimer);
    busyTimer = undefined;
    if (isBusy) {
      isBusy = false;
      tell({ kind: "open" });
    }
  };

  const expect = (): void => {
    busyTimer ??= setTimeout(() => {
      busyTimer = undefined;
      if (!isOpen) return;
      isBusy = true;
      tell({ kind: "busy", text: "No answer yet" });
    }, BUSY_MS);
  };

  const flush = (): void => {
    if ((!isScheduled && outgoing.length === 0) || !isOpen) return;
    isScheduled = false;
    channel.send({ type: "patch", seq, operations: outgoing, moving: isMoving });
    if (outgoing.length > 0 && sizes.size > 0) expect();
    outgoing = [];
  };

  const sayHello = (): void => channel.send({ type: "hello", protocol: 1, ...options.hello() });

  /** Nothing is open: the page is asked for a file. */
  const offer = (header: Header): void => {
    clearInterval(helloTimer);
    if (typeof header["session"] === "string") options.onSession?.(header["session"]);
    // The program was started again without the data that are shown here.
    if (state !== null) options.onOtherData?.();
    isOpen = true;
    tell({ kind: "start", offered: header as unknown as Offered });
  };

  const start = (header: Header): void => {
    clearInterval(helloTimer);
    if (typeof header["session"] === "string") options.onSession?.(header["session"]);
    const isFirst = state === null;
    // The program was started again with other data, for which the state shown here is invalid.
    if (!isFirst && header["fingerprint"] !== fingerprint) options.onOtherData?.();
    fingerprint = header["fingerprint"];
    isOpen = true;
    if (isFirst) {
      state = (header as unknown as Welcome).state;
      welcomed(header as unknown as Welcome);
    }
    if (!isFirst && state !== null) {
      // Changes that were made while there was no connection are sent as the whole state.
      outgoing = [{ op: "replace", path: "", value: state }];
      isMoving = false;
      isScheduled = true;
      flush();
    }
    // After the state: a new session frames a first picture, which nobody has turned, for the first view that shows it.
    for (const [view, { width, height }] of sizes) channel.send({ type: "view", view, size: [width, height] });
    tell({ kind: "open" });
  };

  const fail = (header: Header): void => {
    const problem: Problem = {
      code: String(header["code"] ?? "failed"),
      message: String(header["message"] ?? "it failed without a reason"),
      ...(typeof header["field"] === "string" ? { field: header["field"] } : {}),
      ...(typeof header["remedy"] === "string" ? { remedy: header["remedy"] } : {}),
    };
    const id = header["id"];
    if (typeof id === "number") {
      waiting.get(id)?.reject(problem);
      waiting.delete(id);
      return;
    }
    if (state === null) {
      failed(problem);
      tell({ kind: "lost", problem, retries: false });
      return;
    }
    problems.forEach((listener) => listener(problem));
  };

  const receive = (header: Header, payload: Payload): void => {
    heard();
    switch (header["type"]) {
      case "start":
        offer(header);
        return;
      case "welcome":
        start(header);
        return;
      case "progress": {
        const part = typeof header["part"] === "number" ? header["part"] : undefined;
        if (typeof header["id"] === "number") waiting.get(header["id"])?.progress?.(part ?? 0);
        else {
          const text = String(header["text"] ?? "");
          tell(part === undefined ? { kind: "connecting", text } : { kind: "connecting", text, part });
        }
        return;
      }
      case "patch": {
        const operations = header["operations"] as readonly Operation[];
        if (state !== null) state = patched(state, operations);
        states.forEach((listener) => listener(operations));
        return;
      }
      case "frame":
        frames.forEach((listener) => listener({ ...(header as unknown as Frame), bytes: payload }));
        return;
      case "answer": {
        const one = waiting.get(Number(header["id"]));
        waiting.delete(Number(header["id"]));
        // Facts of other data, which were opened here.
        if (typeof header["fingerprint"] === "string") fingerprint = header["fingerprint"];
        one?.resolve(payload.length > 0 ? { ...header, bytes: payload } : header);
        return;
      }
      case "failed":
        fail(header);
        return;
      default:
    }
  };

  channel.onMessage(receive);
  channel.onState((next) => {
    if (next.kind === "open") {
      if (state === null) tell({ kind: "connecting", text: "Opening" });
      sayHello();
      clearInterval(helloTimer);
      if (options.repeatHelloMs) helloTimer = setInterval(sayHello, options.repeatHelloMs);
      return;
    }
    isOpen = false;
    heard();
    clearInterval(helloTimer);
    for (const one of waiting.values()) one.reject(LOST);
    waiting.clear();
    const problem: Problem = next.retries
      ? {
          code: "lost",
          message: "The connection to the program that draws is lost",
          remedy: "If it was stopped, start it again with the same --port; what you changed here is kept.",
        }
      : {
          code: "refused",
          message: next.reason || "The program that draws refused this page",
          remedy: "Open the link that the command printed.",
        };
    if (!next.retries && state === null) failed(problem);
    tell({ kind: "lost", problem, retries: next.retries });
  });

  return {
    welcome,
    patch(operations, moving) {
      if (state !== null) state = patched(state, operations);
      seq += 1;
      outgoing.push(...operations);
      isMoving = moving;
      const waits = moving && operations.length > 0 && operations.every(({ path }) => SHOWN_HERE.includes(path));
      if (!isScheduled && !waits) {
        isScheduled = true;
        nextFrame(flush);
      }
      return seq;
    },
    show(view, size) {
      if (size === null) sizes.delete(view);
      else sizes.set(view, size);
      if (isOpen) channel.send({ type: "view", view, size: size === null ? null : [size.width, size.height] });
    },
    shown(frame) {
      channel.send({ type: "shown", view: frame.view, frame: frame.number });
    },
    onFrame: (listener) => added(frames, listener),
    onState: (listener) => added(states, listener),
    onConnection: (listener) => added(connections, listener),
    onProblem: (listener) => added(problems, listener),
    ask<Q extends Question>(
      name: Q,
      question: Questions[Q]["question"],
      progress?: (part: number) => void,
      signal?: AbortSignal,
      payload?: Payload,
    ) {
      const id = nextId;
      nextId += 1;
      return new Promise<Questions[Q]["answer"]>((resolve, reject) => {
        waiting.set(id, { resolve: resolve as (answer: unknown) => void, reject, progress });
        signal?.addEventListener("abort", () => {
          if (waiting.has(id)) channel.send({ type: "cancel", id });
        });
        if (!isOpen || signal?.aborted) {
          waiting.delete(id);
          reject(isOpen ? { ...LOST, code: "cancelled" } : LOST);
          return;
        }
        // An answer is about what is shown here now.
        flush();
        channel.send({ type: "ask", id, question: name, arguments: question as unknown as Header }, payload);
      });
    },
    retry: () => channel.retry(),
    close() {
      clearInterval(helloTimer);
      clearTimeout(busyTimer);
      channel.close();
    },
  };
}

function added<T>(listeners: Set<T>, listener: T): Stop {
  listeners.add(listener);
  return () => listeners.delete(listener);
}
