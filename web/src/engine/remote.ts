// The engine behind a channel: the session in Python. Changes are merged into one message an animation frame.

import { differences } from "../state/differences.ts";
import { patched, type Operation } from "../state/patch.ts";
import { Replica } from "../state/replica.ts";
import type { ViewerState, ViewName } from "../state/state.ts";
import type { Stop } from "../state/store.ts";
import { WORDS } from "../words.ts";
import type { Channel } from "./channel.ts";
import type { Cause, Connection, Engine, Frame, Offered, Problem, Question, Questions, Welcome } from "./engine.ts";
import type { Header, Payload } from "./framing.ts";
import { parseAnswer, parseMessage, type Message } from "./messages.ts";

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
  resolve(fields: Header, payload: Payload): void;
  reject(problem: Problem): void;
  readonly progress: ((part: number) => void) | undefined;
}

/** Milliseconds without a message after which changes without a confirmation count as unheard. */
const SILENT_MS = 2000;

/** Fields that the page shows by itself: their changes are sent when a gesture ends, or with others. */
const SHOWN_HERE: readonly string[] = ["/view/slices/window"];

const LOST: Problem = { code: "lost", message: WORDS.connection.broken };

export function remoteEngine(channel: Channel, options: RemoteOptions): Engine {
  const frames = new Set<(frame: Frame) => void>();
  const states = new Set<(operations: readonly Operation[], cause?: Cause) => void>();
  const connections = new Set<(connection: Connection) => void>();
  const problems = new Set<(problem: Problem) => void>();
  const refinings = new Set<(view: ViewName, part: number | null) => void>();
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

  let replica: Replica | null = null;
  let fingerprint = "";
  /** Key of the session of the last welcome: another process gives another one. */
  let lastSession = "";
  let seq = 0;
  /** Number of the newest change that was sent. */
  let sent = 0;
  let nextId = 1;
  let outgoing: Operation[] = [];
  let isMoving = false;
  let isScheduled = false;
  let isOpen = false;
  let helloTimer: ReturnType<typeof setInterval> | undefined;
  let silenceTimer: ReturnType<typeof setTimeout> | undefined;
  let isSilent = false;

  const announce = (connection: Connection): void => connections.forEach((listener) => listener(connection));

  /** Waits anew for the confirmation of what was sent and is unconfirmed. */
  const watch = (): void => {
    clearTimeout(silenceTimer);
    if (replica?.isUnconfirmed(sent) !== true || !isOpen) return;
    silenceTimer = setTimeout(() => {
      isSilent = true;
      announce({ kind: "silent", problem: channel.silence });
    }, SILENT_MS);
  };

  const heard = (): void => {
    watch();
    if (!isSilent) return;
    isSilent = false;
    if (isOpen) announce({ kind: "open" });
  };

  const flush = (): void => {
    if ((!isScheduled && outgoing.length === 0) || !isOpen) return;
    isScheduled = false;
    const wasWaiting = replica?.isUnconfirmed(sent) === true;
    channel.send({ type: "patch", seq, operations: outgoing, moving: isMoving });
    outgoing = [];
    sent = seq;
    if (!wasWaiting) watch();
  };

  const patch = (operations: readonly Operation[], moving: boolean): number => {
    seq += 1;
    replica?.change(operations, seq);
    outgoing.push(...operations);
    isMoving = moving;
    const waits = moving && operations.length > 0 && operations.every(({ path }) => SHOWN_HERE.includes(path));
    if (!isScheduled && !waits) {
      isScheduled = true;
      nextFrame(flush);
    }
    return seq;
  };

  const sayHello = (): void => channel.send({ type: "hello", protocol: 1, ...options.hello() });

  /** Nothing is open: the page is asked for a file. */
  const offer = (offered: Offered, session: string): void => {
    clearInterval(helloTimer);
    options.onSession?.(session);
    // The program was started again without the data that are shown here.
    if (replica !== null) options.onOtherData?.();
    isOpen = true;
    announce({ kind: "start", offered });
  };

  const start = (welcome: Welcome, session: string): void => {
    clearInterval(helloTimer);
    options.onSession?.(session);
    // The program was started again with other data, for which the state shown here is invalid.
    if (replica !== null && welcome.fingerprint !== fingerprint && options.onOtherData !== undefined) {
      // The page is loaded anew: its state belongs to other data.
      options.onOtherData();
      return;
    }
    fingerprint = welcome.fingerprint;
    isOpen = true;
    const before = replica;
    replica = new Replica(welcome.state);
    if (before === null) {
      welcomed(welcome);
    } else {
      // The page's own changes go on top of those that others made meanwhile. A session of another process begins anew,
      // and is sent every difference from its own first state.
      const known = session === lastSession ? before.base : welcome.state;
      outgoing = [];
      patch(differences(known, before.state).filter((one) => isPossible(welcome.state, one)), false);
      flush();
      if (differences(before.state, replica.state).length > 0) {
        states.forEach((listener) => listener([{ op: "replace", path: "", value: welcome.state }]));
      }
    }
    lastSession = session;
    // After the state: a new session frames a first picture, which nobody has turned, for the first view that shows it.
    for (const [view, { width, height }] of sizes) channel.send({ type: "view", view, size: [width, height] });
    announce({ kind: "open" });
  };

  const fail = ({ id, seq: refused, problem }: Message & { type: "failed" }): void => {
    if (id !== null) {
      waiting.get(id)?.reject(problem);
      waiting.delete(id);
      return;
    }
    if (replica === null) {
      failed(problem);
      announce({ kind: "lost", problem, retries: false });
      return;
    }
    if (problem.code === "refused" && refused !== null) {
      replica.refuse(refused);
      states.forEach((listener) => listener([]));
    }
    problems.forEach((listener) => listener(problem));
  };

  const merge = (operations: readonly Operation[], madeUpTo: number, cause?: Cause): void => {
    replica?.merge(operations, madeUpTo);
    states.forEach((listener) => listener(operations, cause));
  };

  const progress = ({ id, view, part, text }: Message & { type: "progress" }): void => {
    if (view !== undefined) refinings.forEach((listener) => listener(view, part));
    else if (id !== null) waiting.get(id)?.progress?.(part ?? 0);
    else announce(part === null ? { kind: "connecting", text } : { kind: "connecting", text, part });
  };

  const handle = (message: Message): void => {
    switch (message.type) {
      case "start":
        offer(message.offered, message.session);
        break;
      case "welcome":
        start(message.welcome, message.session);
        break;
      case "progress":
        progress(message);
        break;
      case "patch":
        merge(message.operations, message.seq, message.cause);
        break;
      case "confirmed":
        if (message.corrections.length > 0) merge(message.corrections, message.seq);
        else replica?.confirm(message.seq);
        break;
      case "frame":
        frames.forEach((listener) => {
          listener(message.frame);
        });
        break;
      case "answer": {
        const one = waiting.get(message.id);
        waiting.delete(message.id);
        // Facts of other data, which were opened here.
        if (typeof message.fields["fingerprint"] === "string") fingerprint = message.fields["fingerprint"];
        one?.resolve(message.fields, message.payload);
        break;
      }
      case "failed":
        fail(message);
        break;
    }
  };

  const receive = (header: Header, payload: Payload): void => {
    try {
      handle(parseMessage(header, payload));
    } catch (error) {
      const problem = { code: "message", message: (error as Error).message, remedy: WORDS.connection.reload };
      if (replica === null) failed(problem);
      problems.forEach((listener) => listener(problem));
    }
    heard();
  };

  channel.onMessage(receive);
  channel.onState((next) => {
    if (next.kind === "open") {
      if (replica === null) announce({ kind: "connecting", text: WORDS.status.opening });
      sayHello();
      clearInterval(helloTimer);
      if (options.repeatHelloMs) helloTimer = setInterval(sayHello, options.repeatHelloMs);
      return;
    }
    isOpen = false;
    isSilent = false;
    clearTimeout(silenceTimer);
    clearInterval(helloTimer);
    for (const one of waiting.values()) one.reject(LOST);
    waiting.clear();
    const { problem, retries } = next;
    if (!retries && replica === null) failed(problem);
    announce({ kind: "lost", problem, retries });
  });

  return {
    welcome,
    get state() {
      if (replica === null) throw new Error("the state is not there before the welcome");
      return replica.state;
    },
    patch,
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
    onRefining: (listener) => added(refinings, listener),
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
        const answered = (fields: Header, bytes: Payload): void => {
          try {
            resolve(parseAnswer(name, fields, bytes));
          } catch (error) {
            reject({ code: "message", message: (error as Error).message });
          }
        };
        waiting.set(id, { resolve: answered, reject, progress });
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
      isOpen = false;
      clearInterval(helloTimer);
      clearTimeout(silenceTimer);
      channel.close();
    },
  };
}

/** Whether an operation can be done: others may have removed the object that it changes. */
function isPossible(state: ViewerState, operation: Operation): boolean {
  try {
    patched(state, [operation]);
    return true;
  } catch {
    return false;
  }
}

function added<T>(listeners: Set<T>, listener: T): Stop {
  listeners.add(listener);
  return () => listeners.delete(listener);
}
