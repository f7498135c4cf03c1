// The state of one page that is no part of the viewer's state: the tool in use, open panels, announcements.

import type { Connection, Problem } from "../engine/engine.ts";
import type { Vec3 } from "../state/state.ts";
import type { Stop } from "../state/store.ts";
import type { Tool } from "./part.ts";

export interface PageFields {
  readonly connection: Connection;
  /** The problem that is shown until it is closed, and the problem because of which nothing could be opened. */
  readonly problem: Problem | null;
  readonly failure: Problem | null;
  readonly tool: Tool;
  /** Points of the measure under way. */
  readonly points: readonly Vec3[];
  /** The layer that the panels of the look are about. */
  readonly layer: number;
  /** Value and place, or shape, under the pointer; "" where nothing is known. */
  readonly probed: string;
  /** Whether the table of keys, and the figures of frames, are shown. */
  readonly help: boolean;
  readonly figures: boolean;
  /** The text that screen readers say. */
  readonly said: string;
}

const FIRST: PageFields = {
  connection: { kind: "connecting", text: "" },
  problem: null,
  failure: null,
  tool: "turn",
  points: [],
  layer: 0,
  probed: "",
  help: false,
  figures: false,
  said: "",
};

/** Least time between announcements, and between questions for what is under the pointer, ms. */
const ANNOUNCED_MS = 1000;
const PROBE_MS = 40;

/** The fields of one page, and its timers. */
export class PageState {
  private now: PageFields = FIRST;
  private readonly listeners = new Set<() => void>();
  private probeTimer: ReturnType<typeof setTimeout> | undefined;
  private sayTimer: ReturnType<typeof setTimeout> | undefined;
  private lastSaid = 0;

  get fields(): PageFields {
    return this.now;
  }

  change(next: Partial<PageFields>): void {
    const isSame = (Object.keys(next) as (keyof PageFields)[]).every((name) => next[name] === this.now[name]);
    if (isSame) return;
    this.now = { ...this.now, ...next };
    this.listeners.forEach((listener) => listener());
  }

  subscribe(listener: () => void): Stop {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** Asks for what is under the pointer, at most every 40 ms, and for its newest place alone; null where it has left. */
  probe(ask: (() => Promise<string>) | null): void {
    clearTimeout(this.probeTimer);
    const timer = setTimeout(() => {
      // An answer for an older place comes too late.
      ask?.().then((probed) => this.probeTimer === timer && this.change({ probed }), () => undefined);
    }, PROBE_MS);
    this.probeTimer = timer;
    if (ask === null) this.change({ probed: "" });
  }

  /** Shows what is under the pointer, where it is known at once. */
  tell(probed: string): void {
    clearTimeout(this.probeTimer);
    this.change({ probed });
  }

  /** Announces a text to screen readers, at most once a second: the newest one. */
  announce(text: string): void {
    clearTimeout(this.sayTimer);
    const wait = Math.max(0, this.lastSaid + ANNOUNCED_MS - performance.now());
    this.sayTimer = setTimeout(() => {
      this.lastSaid = performance.now();
      this.change({ said: text });
    }, wait);
  }

  close(): void {
    clearTimeout(this.probeTimer);
    clearTimeout(this.sayTimer);
    this.listeners.clear();
  }
}
