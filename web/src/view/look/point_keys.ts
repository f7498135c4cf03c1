// Keys that edit a point of a curve, for both editors: arrows fine (with Shift finer), Page up and down coarse.

import { keyStep } from "./axis.ts";
import type { Range } from "./curves.ts";

type PointKey =
  | { readonly does: "move"; readonly value: number; readonly rise: number }
  | { readonly does: "remove" | "insert" | "type" };

/** The edit that a key stands for; null for other keys. `rise`: how much one press moves up or down. */
export function pointKey(key: string, isShifted: boolean, seen: Range, rise: number): PointKey | null {
  const share = isShifted ? 0.2 : 1;
  const fine = share * keyStep(seen, true);
  const coarse = keyStep(seen, false);
  const steps: Partial<Record<string, readonly [number, number]>> = {
    ArrowLeft: [-fine, 0],
    ArrowRight: [fine, 0],
    ArrowUp: [0, share * rise],
    ArrowDown: [0, -share * rise],
    PageDown: [-coarse, 0],
    PageUp: [coarse, 0],
    Home: [0, -1],
    End: [0, 1],
  };
  const step = steps[key];
  if (step !== undefined) return { does: "move", value: step[0], rise: step[1] };
  if (key === "Delete" || key === "Backspace") return { does: "remove" };
  if (key === "Insert") return { does: "insert" };
  return key === "Enter" ? { does: "type" } : null;
}
