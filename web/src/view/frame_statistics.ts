// Statistics of frames: frames a second, time from the event to the picture, bytes. Only the latest records are kept.

import type { Frame } from "../engine/engine.ts";

export interface FrameRecord {
  /** Time when the frame was drawn, in ms of `performance.now`. */
  readonly at: number;
  /** Time from the newest event that the frame shows, in ms; null where no event belongs to it. */
  readonly latency: number | null;
  readonly bytes: number;
  readonly frame: Omit<Frame, "bytes">;
}

const MAX_RECORDS = 4000;
const MAX_EVENTS = 1000;

export class FrameStatistics {
  readonly records: FrameRecord[] = [];
  /** Milliseconds that the page took to draw its interface, the latest ones. */
  readonly draws: number[] = [];
  private events: { readonly seq: number; readonly at: number }[] = [];

  /** Records the time of the event that a change came from. */
  event(seq: number, at: number): void {
    this.events.push({ seq, at });
    if (this.events.length > MAX_EVENTS) this.events.shift();
  }

  /** Records that a frame is on the canvas. */
  drawn(frame: Frame, at: number): void {
    const shown = this.events.filter((event) => event.seq <= frame.seq).at(-1);
    if (shown !== undefined) this.events = this.events.filter((event) => event.seq > frame.seq);
    const { bytes, ...header } = frame;
    this.records.push({ at, latency: shown === undefined ? null : at - shown.at, bytes: bytes.length, frame: header });
    if (this.records.length > MAX_RECORDS) this.records.shift();
  }

  /** Records how long the interface took to draw, ms. */
  interfaceDrawn(ms: number): void {
    this.draws.push(ms);
    if (this.draws.length > MAX_RECORDS) this.draws.shift();
  }

  /** Statistics of the moving frames of the last `span` milliseconds. */
  recent(now: number, span = 2000): { framesPerSecond: number; latency: number | null; kilobytes: number } | null {
    const moving = this.records.filter((record) => record.at > now - span && !record.frame.at_rest);
    const first = moving[0];
    const last = moving.at(-1);
    if (first === undefined || last === undefined || moving.length < 3) return null;
    const latencies = moving.flatMap((record) => (record.latency === null ? [] : [record.latency]));
    return {
      framesPerSecond: ((moving.length - 1) * 1000) / Math.max(last.at - first.at, 1),
      latency: median(latencies),
      kilobytes: (median(moving.map((record) => record.bytes)) ?? 0) / 1000,
    };
  }
}

export function median(values: readonly number[]): number | null {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? null;
}
