// The card about the data: what is known of each volume, what was guessed, and what was noted of the picture.

import type { VolumeInfo } from "../engine/engine.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { decimalsOf, shortNumber } from "./descriptions.ts";
import { noteForPage } from "./notes.ts";
import { numberText } from "./look/axis.ts";
import type { PartProps } from "./part.ts";

const TEXT = PANEL_WORDS.about;

export function AboutPanel({ welcome, store, ui }: PartProps) {
  const notes = [...new Set(Object.values(ui.frames).flatMap((frame) => frame.notes))];
  return (
    <>
      {welcome.volumes.map((volume, n) => (
        <section key={n} class="about">
          <h3>{store.state.layers[n]?.name ?? volume.name}</h3>
          <dl>{facts(volume).map(([name, text]) => [<dt key={name}>{name}</dt>, <dd key={text}>{text}</dd>])}</dl>
          <h4>{TEXT.notes}</h4>
          <Notes of={volume.notes} />
        </section>
      ))}
      {notes.length > 0 && (
        <section class="about">
          <h3>{TEXT.picture}</h3>
          <Notes of={notes} />
        </section>
      )}
    </>
  );
}

function Notes({ of }: { readonly of: readonly string[] }) {
  return <ul>{of.map((note) => <li key={note}>{noteForPage(note)}</li>)}</ul>;
}

function facts(volume: VolumeInfo): readonly (readonly [string, string])[] {
  const { shape, spacing, bounds, range, unit, value_unit, orientation } = volume;
  const size = [0, 1, 2].map((a) => (bounds[1][a] ?? 0) - (bounds[0][a] ?? 0));
  const length = (all: readonly number[], decimals: number): string =>
    `${all.map((one) => String(Number(one.toFixed(decimals)))).join(" × ")} ${unit ?? ""}`.trim();
  const decimals = decimalsOf(Math.min(...spacing));
  const isEven = spacing.every((one) => Math.abs(one - spacing[0]) < 1e-6 * spacing[0]);
  return [
    [TEXT.kind, TEXT.kinds[volume.kind] ?? volume.kind],
    [TEXT.samples, `${shape.join(" × ")}, ${volume.dtype}`],
    [TEXT.spacing, isEven ? `${shortNumber(spacing[0], 4)} ${unit ?? ""}`.trim() : length(spacing, decimals + 2)],
    [TEXT.size, length(size, decimals)],
    [TEXT.values, TEXT.range(numberText(range[0]), numberText(range[1]), value_unit)],
    [TEXT.axes, orientation === null ? TEXT.noAxes : TEXT.axesOf(orientation)],
    ...(volume.n_times > 1 ? [[TEXT.times, String(volume.n_times)] as const] : []),
  ];
}
