// The legend of the segmentation: names, colours, opacities, and what is shown.

import { useState } from "preact/hooks";
import { set } from "../../state/patch.ts";
import { withoutLabels } from "../open/index.ts";
import type { PartProps } from "../part.ts";
import { Button, Switch, ColorField } from "../fields.tsx";
import { hiddenOf, isSoloLabel, labelRows, shownLabels, toggledLabel } from "./layers.ts";
import { hexColor, namedColor } from "./looks.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.labelsPanel;
/** Largest number of rows: a longer list is filtered, not scrolled. */
const MAX_ROWS = 150;
/** Number of labels from which on there is a filter. */
const FILTERED_FROM = 9;

export function LabelsPanel({ store }: PartProps) {
  const [filter, setFilter] = useState("");
  const labels = store.state.labels;
  if (labels === null) return <p class="dim">{TEXT.none}</p>;
  const all = labelRows(labels.labels);
  const rows = labelRows(labels.labels, filter);
  const show = (isShown: (number: string) => boolean): void =>
    store.change(shownLabels(store.state.labels?.labels ?? {}, isShown, hiddenOf(store)));
  const inRows = new Set(rows.map(({ number }) => number));
  const isOnShown = new Map(all.map(({ number, isShown }) => [number, isShown]));
  const others = (number: string): boolean => isOnShown.get(number) ?? false;
  return (
    <div class="look-panel">
      {all.length >= FILTERED_FROM && (
        <label class="field">
          <span>{TEXT.filter}</span>
          <input
            type="search"
            class="look-grow"
            value={filter}
            onInput={(event) => setFilter(event.currentTarget.value)}
          />
        </label>
      )}
      <div class="row">
        <Button onClick={() => show((number) => inRows.has(number) || others(number))}>{TEXT.showAll}</Button>
        <Button onClick={() => show((number) => !inRows.has(number) && others(number))}>{TEXT.hideAll}</Button>
        <Button label={TEXT.removeAll} onClick={() => store.change(withoutLabels())}>{TEXT.remove}</Button>
        <span class="dim">{TEXT.count(all.filter(({ isShown }) => isShown).length, all.length)}</span>
      </div>
      {rows.length === 0 && <p class="dim">{TEXT.empty}</p>}
      <ul class="look-list look-labels" aria-label={TEXT.list}>
        {rows.slice(0, MAX_ROWS).map(({ number, name, look, opacity, isShown }) => (
          <li key={number} class="look-label">
            <input
              type="checkbox"
              aria-label={TEXT.shown(name)}
              checked={isShown}
              onChange={() => store.change(toggledLabel(store, number))}
            />
            <ColorField
              label={TEXT.color(name)}
              value={hexColor(look.color, namedColor)}
              onColor={(hex) =>
                store.change([set(hex, "labels", "labels", number, "color")], `colour of label ${number}`)
              }
              onSettle={() => store.settle()}
            />
            <input
              type="text"
              class="look-grow look-quiet"
              aria-label={TEXT.name(number)}
              title={`${name} (${number})`}
              value={name}
              maxLength={200}
              onChange={(event) => {
                const next = event.currentTarget.value.trim();
                if (next === "") event.currentTarget.value = name;
                else store.change([set(next, "labels", "labels", number, "name")]);
              }}
              onKeyDown={(event) => event.key === "Enter" && event.currentTarget.blur()}
            />
            <input
              type="range"
              aria-label={TEXT.opacity(name)}
              title={TEXT.opacity(name)}
              min={0}
              max={1}
              step={0.01}
              // A hidden label keeps the opacity that it comes back with.
              value={isShown ? opacity : (hiddenOf(store).get(number)?.opacity ?? opacity)}
              onInput={(event) =>
                store.change([set(event.currentTarget.valueAsNumber, "labels", "labels", number, "opacity")], `opacity of label ${number}`)
              }
              onChange={() => store.settle()}
            />
            <Button
              label={TEXT.soloThis(name)}
              pressed={all.length > 1 && isSoloLabel(all, number)}
              onClick={() => show((other) => isSoloLabel(all, number) || other === number)}
            >
              {TEXT.solo}
            </Button>
          </li>
        ))}
      </ul>
      {rows.length > MAX_ROWS && <p class="dim">{TEXT.more(rows.length - MAX_ROWS)}</p>}
      <Switch
        label={TEXT.smooth}
        on={labels.smooth}
        onToggle={(on) => store.change([set(on, "labels", "smooth")])}
      />
    </div>
  );
}
