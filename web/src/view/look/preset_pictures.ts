// Small pictures of presets, drawn one at a time, those on the screen first, and only while nothing else is going on.

import type { Engine, Problem } from "../../engine/engine.ts";

/** Pixels of a picture; twice those of the page, for dense screens. */
const SIZE_PX = 192;
/** Pictures wait until nothing has been changed for so long. */
const STILL_MS = 350;

export class PresetPictures {
  private readonly urls = new Map<string, string>();
  private wanted: string[] = [];
  private isBusy = false;
  private lastChange = -Infinity;
  private isClosed = false;

  constructor(
    private readonly engine: Engine,
    private readonly layer: number,
    private readonly changed: () => void,
    private readonly failed: (problem: Problem) => void,
  ) {}

  /** The address of a picture, where there is one. */
  get(name: string): string | undefined {
    return this.urls.get(name);
  }

  /** Asks for a picture, if it is not there. */
  want(name: string): void {
    if (this.urls.has(name) || this.wanted.includes(name)) return;
    this.wanted.push(name);
    void this.next();
  }

  /** It has left the screen before its turn. */
  leave(name: string): void {
    this.wanted = this.wanted.filter((other) => other !== name);
  }

  /** Something in the picture is being changed: no pictures for a moment. */
  pause(): void {
    this.lastChange = performance.now();
  }

  /** All pictures are drawn anew, as they are seen. */
  clear(): string[] {
    const before = [...this.urls.keys()];
    this.urls.forEach((url) => URL.revokeObjectURL(url));
    this.urls.clear();
    return before;
  }

  close(): void {
    this.isClosed = true;
    this.wanted = [];
    this.clear();
  }

  private async next(): Promise<void> {
    if (this.isBusy || this.isClosed) return;
    this.isBusy = true;
    try {
      for (;;) {
        const wait = this.lastChange + STILL_MS - performance.now();
        if (wait > 0) {
          await new Promise((resolve) => setTimeout(resolve, wait));
          continue;
        }
        const name = this.wanted.shift();
        if (name === undefined || this.isClosed) return;
        const { bytes } = await this.engine.ask("preset_picture", { layer: this.layer, name, size: SIZE_PX });
        if (this.isClosed) return;
        this.urls.set(name, URL.createObjectURL(new Blob([bytes], { type: "image/png" })));
        this.changed();
      }
    } catch (problem) {
      // One that fails would fail again: the others of this round are left, and asked for when they are next seen.
      this.wanted = [];
      if (!this.isClosed) this.failed(problem as Problem);
    } finally {
      this.isBusy = false;
    }
  }
}
