// Operators along a ray: the numbers that some of them have.

import type { Composite } from "../../state/state.ts";
import { compositeName } from "../descriptions.ts";

/** Default strength of dimming, the same as in `wavesplat.DepthShadedMaximum`. */
export const DIMMING = 0.6;

/** The operators that shade surfaces. */
export const SHADED: readonly string[] = ["over", "first-hit"];

/** A parameter of an operator; null where the program chooses it. */
export function numberOf(composite: Composite, field: string): number | null {
  return typeof composite === "string" ? null : (composite[compositeName(composite)]?.[field] ?? null);
}

/** The operator with a parameter set. */
export function withNumber(composite: Composite, field: string, value: number | null): Composite {
  const name = compositeName(composite);
  const before = typeof composite === "string" ? {} : (composite[name] ?? {});
  return { [name]: { ...before, [field]: value } };
}

/** The operator of a name, with default parameters; only the isosurface needs one, its value. */
export function compositeNamed(name: string, isoValue: number): Composite {
  return name === "first-hit" ? { "first-hit": { iso_value: isoValue } } : name;
}
