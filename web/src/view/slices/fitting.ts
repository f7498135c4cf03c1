// Which texts a slice has room for: small panes leave out those that the fewest need, so that none lie over others.

import type { CssSize } from "../part.ts";

/** Pixels: height of a line in a pill with its padding, least distance of texts, width of a letter at 12 px. */
const LINE = 17;
const PADDING = 8;
const APART = 6;
const LETTER = 7;

export interface Texts {
  /** Lines of the name and position, from the top left. */
  readonly name: readonly string[];
  /** Text of the window, at the top right; null: no room. */
  readonly window: string | null;
  readonly sideLetters: boolean;
  readonly endLetters: boolean;
  readonly scaleBar: boolean;
}

const widthOf = (lines: readonly string[]): number => Math.max(0, ...lines.map((line) => line.length)) * LETTER + 2 * PADDING;
const heightOf = (lines: readonly string[]): number => lines.length * LINE + PADDING;

/** The texts that fit into a pane. `name`: lines, the most important first; `window`: text of the window, if there is one. */
export function textsThatFit({ width, height }: CssSize, name: readonly string[], window: string | null): Texts {
  const isLow = height < 120;
  // Where one text has room, it is the name of the plane; where none has, nothing is shown.
  const lines = height < LINE + PADDING + 4 ? [] : isLow ? name.slice(0, 1) : name;
  // At the top: the name, the letter in the middle, the window.
  const [left, right] = [widthOf(lines) + APART, window === null ? 0 : widthOf([window]) + 14 + APART];
  const shown = left + right + APART <= width ? window : null;
  const half = width / 2 - 1.5 * LETTER - APART;
  const top = heightOf(lines) + APART;
  const bar = 2 * LINE + PADDING;
  const scaleBar = height >= top + bar;
  // The bar is at most 30 % of the width, and its text about ten letters long.
  const barWidth = Math.max(0.3 * width, 10 * LETTER) + 12;
  return {
    name: lines,
    window: shown,
    sideLetters: height / 2 - LINE >= Math.max(top, bar) + APART,
    endLetters: !isLow && half >= Math.max(left, shown === null ? 0 : right, barWidth),
    scaleBar,
  };
}
