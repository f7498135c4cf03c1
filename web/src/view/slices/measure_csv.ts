// Measures and statistics of labels as CSV files (RFC 4180).

import type { LabelFacts } from "../../engine/engine.ts";
import type { Measure } from "../../state/state.ts";
import { angleDeg, areaOf, distance } from "./geometry.ts";
import type { RegionFacts } from "./region_text.tsx";

/** Measures, a row each: values of regions come from the first layer. `facts`: of each measure, null for all but regions. */
export function measuresCsv(
  measures: readonly Measure[],
  facts: readonly (RegionFacts | null)[],
  unit: string,
  valueUnit: string,
): string {
  const rows = measures.map((measure, n) => {
    const { kind, points } = measure;
    const [value, of] =
      kind === "area" ? [areaOf(points), `${unit}²`] : kind === "angle" ? [angleDeg(points), "degree"] : [distance(points), unit];
    const region = facts[n] ?? null;
    const values = region === null ? ["", "", "", "", ""] : [region.mean, region.sd, region.min, region.max, valueUnit];
    return [n + 1, kind, value, of, ...values, points.map((point) => point.join(" ")).join("; ")];
  });
  return csv(["number", "kind", "value", "unit", "mean", "sd", "min", "max", "value unit", "points (x y z)"], rows);
}

/** Statistics of labels, a row each. */
export function labelsCsv(labels: readonly LabelFacts[], unit: string, valueUnit: string): string {
  const header = ["number", "name", "voxels", `volume (${unit}³)`, ...["mean", "sd", "min", "max"].map((name) => `${name} (${valueUnit || "value"})`)];
  return csv(header, labels.map(({ number, name, n_voxels, volume, mean, sd, min, max }) => [number, name, n_voxels, volume, mean, sd, min, max]));
}

type Cell = string | number | null;

function csv(header: readonly string[], rows: readonly (readonly Cell[])[]): string {
  return [header, ...rows].map((row) => row.map(cell).join(",")).join("\r\n");
}

/** A cell; texts that a spreadsheet would take for formulas begin with an apostrophe. */
function cell(value: Cell): string {
  if (value === null) return "";
  if (typeof value === "number") return String(value);
  const text = /^[=+\-@]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
