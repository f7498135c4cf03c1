// Notes of the renderer on a picture, for people who have the page and no command line.

/** A note without its advice on options: "the table is left out; --keep-table draws it" -> "The table is left out". */
export function noteForPage(note: string): string {
  const parts = note
    .replaceAll(/ ?\((?:--[\w-]+(?:, )?)+\)/g, "")
    .split("; ")
    .filter((part) => !part.includes("--"));
  const text = parts.join("; ");
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Milliseconds for which a note is shown. */
export const NOTED_MS = 10_000;

/** Notes that are shown for a while, once: a picture that comes to rest again has nothing new to say. */
export class FreshNotes {
  private readonly seen = new Map<string, number>();

  /** The notes of these that were first there less than ten seconds before. `now`: milliseconds. */
  of(notes: readonly string[], now: number): readonly string[] {
    notes.forEach((note) => this.seen.has(note) || this.seen.set(note, now));
    return notes.filter((note) => now - (this.seen.get(note) ?? now) < NOTED_MS);
  }
}
