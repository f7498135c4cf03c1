// Volumes of labels and the values in them, as a table that is saved as CSV.

import { useState } from "preact/hooks";

import type { LabelFacts, Problem } from "../engine/engine.ts";
import { WORDS } from "../words.ts";
import { shortNumber } from "./descriptions.ts";
import type { PartProps } from "./part.ts";
import { labelsCsv } from "./slices/measure_csv.ts";

const TEXT = WORDS.measures;
/** Cubic millimetres in a millilitre, the unit of volumes in bodies. */
const MM3_PER_ML = 1000;

export function LabelStatistics({ engine, ui, welcome }: PartProps) {
  const [labels, setLabels] = useState<readonly LabelFacts[] | null>(null);
  const [isAsked, setAsked] = useState(false);
  const unit = welcome.volumes[0]?.unit ?? WORDS.slices.units;
  const valueUnit = welcome.volumes[0]?.value_unit ?? "";
  const ask = async (): Promise<void> => {
    setAsked(true);
    try {
      setLabels((await engine.ask("label_statistics", {})).labels);
    } catch (problem) {
      ui.problem(problem as Problem);
    }
    setAsked(false);
  };
  const volumeOf = (volume: number): string =>
    unit === "mm" ? `${shortNumber(volume / MM3_PER_ML, 4)} ml` : `${shortNumber(volume, 4)} ${unit}³`;
  const textOf = (value: number | null): string => (value === null ? "–" : shortNumber(value, 4));
  return (
    <section class="label-statistics">
      <div class="row">
        <button class="button" disabled={isAsked} onClick={() => void ask()}>{TEXT.labels}</button>
        {labels !== null && (
          <button class="button" onClick={() => ui.download("labels.csv", labelsCsv(labels, unit, valueUnit), "text/csv")}>
            {TEXT.labelsCsv}
          </button>
        )}
      </div>
      {labels !== null && (
        <table>
          <thead>
            <tr>{TEXT.columns(valueUnit).map((name) => <th key={name} scope="col">{name}</th>)}</tr>
          </thead>
          <tbody>
            {labels.map(({ number, name, volume, mean, min, max }) => (
              <tr key={number}>
                <th scope="row">{name}</th>
                <td>{volumeOf(volume)}</td>
                <td>{textOf(mean)}</td>
                <td>{textOf(min)}</td>
                <td>{textOf(max)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </section>
  );
}
