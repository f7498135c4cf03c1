// The three knobs of a transfer function: what they do to its curves.
//
// Reveal moves the curves along the values, so that more or less matter is seen. Soften widens them. See-through fades
// low values first: the opacity α(v) becomes α(v) · 10^(−D · s · (1 − t)), where s, 0..1, is the knob, and t, 0..1, the
// place of the value between the first and the last point of the curves. So the densest matter keeps its opacity, and
// skin goes before muscle, muscle before bone; a common factor would make all of them fainter alike.

import type { OpacityPoint, TransferFunction } from "../../state/state.ts";
import { at, clamped, shifted, spanOfFunction, widened, type Range } from "./curves.ts";

export interface Knobs {
  /** -1..1: less or more matter is seen. */
  readonly reveal: number;
  /** -1..1: borders are harder or softer. */
  readonly soften: number;
  /** 0..1. */
  readonly through: number;
}

export const STILL: Knobs = { reveal: 0, soften: 0, through: 0 };

/** Decades by which the lowest value fades where the knob is at its end. (Muscle of a CT, t = 0.7, by a factor of 120.) */
const DECADES = 7;
/** Pieces between the first and the last value in which the exponential is followed by straight lines. */
const PIECES = 32;
const MAX_WIDTH = 4;

/** The curves with the knobs turned. `usual`: the range of the values that count. */
export function turned(curves: TransferFunction, { reveal, soften, through }: Knobs, usual: Range): TransferFunction {
  // Squared, so that small turns are fine: values near a border differ by little.
  const shift = -0.5 * reveal * Math.abs(reveal) * (usual[1] - usual[0]);
  const wide = soften === 0 ? curves : widened(curves, MAX_WIDTH ** soften);
  return seenThrough(shift === 0 ? wide : shifted(wide, shift), through);
}

function seenThrough(curves: TransferFunction, through: number): TransferFunction {
  const [low, high] = spanOfFunction(curves);
  if (through === 0 || low === high) return curves;
  const between = Array.from({ length: PIECES + 1 }, (_, k) => low + (k / PIECES) * (high - low));
  const values = [...curves.opacity.map(([value]) => value), ...between].sort((a, b) => a - b);
  const opacity = values
    .filter((value, k) => value !== values[k - 1])
    .map((value): OpacityPoint => {
      const place = clamped((value - low) / (high - low), 0, 1);
      const alpha = (at(curves.opacity, value)[0] ?? 0) * 10 ** (-DECADES * through * (1 - place));
      return [value, alpha < 1e-6 ? 0 : Number(alpha.toPrecision(4))];
    });
  return { ...curves, opacity };
}
