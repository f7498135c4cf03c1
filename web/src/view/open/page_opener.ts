// The steps of opening a file in the page: sending, reading, a choice among several, and how it is shown.

import type { Engine, Found, How, Offered, Problem, Source } from "../../engine/engine.ts";
import type { Operation } from "../../state/patch.ts";
import { droppedIn, nameOf, send, sizeOf, type Dropped } from "./dropped.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.opening;

export type Step =
  | { readonly kind: "idle" }
  | { readonly kind: "sending"; readonly name: string; readonly part: number }
  | { readonly kind: "reading"; readonly name: string }
  | {
      readonly kind: "several";
      readonly name: string;
      readonly source: Source;
      readonly option: string;
      readonly names: readonly (string | number)[];
      readonly described: readonly string[];
    }
  | {
      readonly kind: "choosing";
      readonly name: string;
      readonly source: Source;
      readonly found: readonly Found[];
      readonly notes: readonly string[];
      readonly opened: number;
    };

/** The page around: its state, and where results go. */
export interface Surroundings {
  readonly engine: Engine;
  /** Whether something is open. */
  readonly hasData: () => boolean;
  /** Width over height of the 3-D view; null without one. */
  readonly aspect: () => number | null;
  readonly change: (operations: readonly Operation[]) => void;
  /** Shows the state of a file. */
  readonly openState: (file: File) => void;
  readonly announce: (text: string) => void;
  readonly problem: (problem: Problem) => void;
  readonly changed: () => void;
}

export class PageOpener {
  step: Step = { kind: "idle" };
  /** Whether the dialog that offers files is shown, and whether files are being dragged over the page. */
  isShown = false;
  isOver = false;
  /** Examples and recent files; null until it is known. */
  offered: Offered | null = null;
  /** The last problem, for the start page. */
  failure: Problem | null = null;
  private abort: AbortController | null = null;

  constructor(private readonly page: Surroundings) {}

  /** Listens to drops on an element; returns what ends that. */
  listen(element: HTMLElement): () => void {
    const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    const over = (event: DragEvent): void => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.setOver(true);
    };
    const leave = (event: DragEvent): void => {
      if (event.relatedTarget === null || !element.contains(event.relatedTarget as Node)) this.setOver(false);
    };
    const drop = (event: DragEvent): void => {
      if (!hasFiles(event) || event.dataTransfer === null) return;
      event.preventDefault();
      this.setOver(false);
      const found = droppedIn(event.dataTransfer);
      void found.then((files) => this.files(files), (problem: unknown) => this.fail(problem));
    };
    element.addEventListener("dragover", over);
    element.addEventListener("dragleave", leave);
    element.addEventListener("drop", drop);
    return () => {
      element.removeEventListener("dragover", over);
      element.removeEventListener("dragleave", leave);
      element.removeEventListener("drop", drop);
    };
  }

  /** Shows or hides the dialog that offers files. */
  show(on: boolean): void {
    this.isShown = on;
    this.failure = null;
    this.page.changed();
    if (on) this.ask("offered");
  }

  clearRecent(): void {
    this.ask("clear_recent");
    this.page.announce(TEXT.cleared);
  }

  setOffered(offered: Offered): void {
    this.offered = offered;
    this.page.changed();
  }

  /** Opens files that were dropped or chosen. */
  async files(files: readonly Dropped[]): Promise<void> {
    const [first] = files;
    if (this.step.kind === "sending" || this.step.kind === "reading") return;
    if (first === undefined) return this.fail({ code: "open", message: TEXT.nothing });
    if (files.length === 1 && first.file.name.toLowerCase().endsWith(".json")) return this.stateFile(first.file);
    const [size, most] = [sizeOf(files), this.offered?.max_bytes ?? Infinity];
    if (size > most) return this.fail({ code: "open", message: TEXT.tooLarge(size, most), remedy: TEXT.tooLargeRemedy });
    const name = nameOf(files);
    const abort = this.begin({ kind: "sending", name, part: 0 });
    try {
      const progress = (part: number): void => {
        if (!abort.signal.aborted) this.go({ kind: "sending", name, part });
      };
      const upload = await send(this.page.engine, files, progress, abort.signal);
      await this.read({ upload }, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }

  /** Opens an example, or a file of the list. */
  async source(source: Source, name: string): Promise<void> {
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.read(source, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }

  /** Takes one of several series or datasets. */
  async pick(value: string | number): Promise<void> {
    if (this.step.kind !== "several") return;
    const { source, name, option } = this.step;
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.read(source, name, abort.signal, { option, value });
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }

  /** Shows what was read. */
  async choose(how: How): Promise<void> {
    if (this.step.kind !== "choosing") return;
    const { opened, name } = this.step;
    const abort = this.begin({ kind: "reading", name });
    try {
      await this.place(opened, how, name, abort.signal);
    } catch (problem) {
      if (!abort.signal.aborted) this.fail(problem);
    }
  }

  /** Gives up what is under way: sending and reading stop, and what was sent or read is removed. */
  cancel(): void {
    this.abort?.abort();
    const { step } = this;
    if (step.kind === "choosing") this.discard({ opened: step.opened });
    else if (step.kind === "several") this.discardUpload(step.source);
    this.go({ kind: "idle" });
  }

  private discard(what: { upload: number } | { opened: number }): void {
    this.page.engine.ask("discard", what).catch(() => undefined);
  }

  private discardUpload(source: Source): void {
    if ("upload" in source) this.discard({ upload: source.upload });
  }

  private async read(source: Source, name: string, signal: AbortSignal, choice?: { option: string; value: string | number }): Promise<void> {
    this.go({ kind: "reading", name });
    const question = { ...source, ...(choice === undefined ? {} : { choice }) };
    const answer = await this.page.engine.ask("open", question, undefined, signal);
    if (signal.aborted) {
      // The answer was on its way.
      if (answer.opened !== undefined) this.discard({ opened: answer.opened });
      else this.discardUpload(source);
      return;
    }
    if (answer.several !== undefined) {
      this.isShown = false;
      return this.go({ kind: "several", name, source, ...answer.several });
    }
    if (answer.shown === true || answer.opened === undefined) return this.done(name);
    const { found = [], notes = [], opened } = answer;
    // Shapes stand beside what is open: there is nothing to choose.
    if (found.every(({ kind }) => kind === "shape")) return this.place(opened, "overlay", name, signal);
    this.isShown = false;
    this.go({ kind: "choosing", name, source, found, notes, opened });
  }

  private async place(opened: number, how: How, name: string, signal: AbortSignal): Promise<void> {
    const aspect = this.page.aspect();
    const question = { opened, how, ...(aspect === null ? {} : { aspect }) };
    const { operations } = await this.page.engine.ask("show", question, undefined, signal);
    if (signal.aborted) return;
    this.page.change(operations);
    this.done(name);
  }

  private stateFile(file: File): void {
    if (this.page.hasData()) this.page.openState(file);
    else this.fail({ code: "open", message: TEXT.stateAlone, remedy: TEXT.stateRemedy });
  }

  private done(name: string): void {
    this.isShown = false;
    this.go({ kind: "idle" });
    this.page.announce(TEXT.shown(name));
  }

  private begin(step: Step): AbortController {
    this.abort?.abort();
    this.abort = new AbortController();
    this.failure = null;
    this.go(step);
    return this.abort;
  }

  private fail(problem: unknown): void {
    const found = problem as Partial<Problem>;
    const shown: Problem = { ...found, code: "open", message: String(found.message ?? problem) };
    this.failure = shown;
    this.go({ kind: "idle" });
    if (this.page.hasData()) {
      this.isShown = false;
      this.page.problem(shown);
    }
  }

  private go(step: Step): void {
    this.step = step;
    this.page.changed();
  }

  private setOver(on: boolean): void {
    if (on === this.isOver) return;
    this.isOver = on;
    this.page.changed();
  }

  private ask(question: "offered" | "clear_recent"): void {
    this.page.engine.ask(question, {}).then((offered) => this.setOffered(offered), () => undefined);
  }
}
