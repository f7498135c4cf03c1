// Small pictures of presets, drawn one at a time, pictures on the screen first, and only while nothing else is going
// on.

import type { Engine, Problem } from "../../engine/engine.ts";

/** Side of a picture in pixels, twice that on the page, for dense screens. */
const SIZE_PX = 192;
/** Milliseconds without a change before a picture is drawn. */
const STILL_MS = 350;
/** Milliseconds before a new try, after the connection was lost. */
const RETRY_MS = 2000;

export class PresetPictures {
  private readonly urls = new Map<string, string>();
  private readonly reasons = new Map<string, string>();
  /** Names of pictures that show another camera or time than the one now. */
  private readonly stale = new Set<string>();
  private wanted: string[] = [];
  private isBusy = false;
  private drawing: string | null = null;
  private lastChange = -Infinity;
  private isClosed = false;

  constructor(
    private readonly engine: Engine,
    private readonly layer: number,
    private readonly changed: () => void,
  ) {}

  /** Address of a picture; undefined where it is not drawn. */
  get(name: string): string | undefined {
    return this.urls.get(name);
  }

  /** The reason why a picture is missing. */
  reason(name: string): string | undefined {
    return this.reasons.get(name);
  }

  /** Requests a picture, unless it is drawn. */
  want(name: string): void {
    const isKnown = this.urls.has(name) && !this.stale.has(name);
    if (isKnown || this.reasons.has(name) || this.wanted.includes(name) || name === this.drawing) return;
    this.wanted.push(name);
    void this.next();
  }

  /** Cancels a request whose tile has left the screen. */
  leave(name: string): void {
    this.wanted = this.wanted.filter((other) => other !== name);
  }

  /** Pauses for a moment, as something in the picture is being changed. */
  pause(): void {
    this.lastChange = performance.now();
  }

  /** Draws all pictures anew; the old ones stay until then. */
  refresh(): void {
    const known = [...this.urls.keys(), ...this.reasons.keys()];
    this.reasons.clear();
    known.forEach((name) => this.stale.add(name));
    known.forEach((name) => this.want(name));
  }

  close(): void {
    this.isClosed = true;
    this.wanted = [];
    this.urls.forEach((url) => URL.revokeObjectURL(url));
    this.urls.clear();
  }

  private async next(): Promise<void> {
    if (this.isBusy || this.isClosed) return;
    this.isBusy = true;
    for (;;) {
      const wait = this.lastChange + STILL_MS - performance.now();
      if (wait > 0) {
        await new Promise((resolve) => setTimeout(resolve, wait));
        continue;
      }
      const name = this.wanted.shift();
      if (name === undefined || this.isClosed) break;
      this.drawing = name;
      await this.draw(name);
      this.drawing = null;
    }
    this.isBusy = false;
  }

  private async draw(name: string): Promise<void> {
    try {
      const { bytes } = await this.engine.ask("preset_picture", { layer: this.layer, name, size: SIZE_PX });
      if (!this.isClosed) this.take(name, bytes);
    } catch (problem) {
      const { code, message } = problem as Problem;
      if (code === "lost") {
        this.wanted.unshift(name);
        await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
        return;
      }
      this.reasons.set(name, message);
    }
    if (!this.isClosed) this.changed();
  }
  private take(name: string, bytes: Uint8Array<ArrayBuffer>): void {
    const old = this.urls.get(name);
    if (old !== undefined) URL.revokeObjectURL(old);
    this.stale.delete(name);
    this.urls.set(name, URL.createObjectURL(new Blob([bytes], { type: "image/png" })));
  }
}
