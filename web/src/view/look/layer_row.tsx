// The row of a layer: colours, the window over a small histogram, what is hidden, gamma, opacity. The session decides what each of
// them makes of the look.

import { useEffect, useRef, useState } from "preact/hooks";

import type { LayerChange, LayerRow, Problem } from "../../engine/engine.ts";
import { set } from "../../state/patch.ts";
import type { Layer } from "../../state/state.ts";
import { PANEL_WORDS } from "../../panel_words.ts";
import { Button, ColorField } from "../fields.tsx";
import { Icon } from "../icons.tsx";
import { withoutLayer } from "../open/index.ts";
import type { PartProps } from "../part.ts";
import { heights, numberText, roundStep } from "./axis.ts";
import type { Range } from "./curves.ts";
import { titleOf } from "./preset_kinds.ts";
import { Ramp } from "./ramp.tsx";
import { changeRow, typedValue, type ChangeQueue } from "./row_changes.ts";
import { isSolo, soloLayer } from "./solo.ts";

const TEXT = PANEL_WORDS.layersPanel;
const BINS = 96;
const BARS_PX = 22;
const MAX_GAMMA = 3;

export interface Rows {
  readonly rows: readonly LayerRow[];
  readonly maps: readonly string[];
}

/** The rows of all layers, asked for anew when a look or the window of slices is another one; the last ones until they come. */
export function useRows({ engine, store, ui, welcome }: PartProps): Rows | null {
  const [rows, setRows] = useState<Rows | null>(null);
  const { layers, view } = store.state;
  const { window, colors } = view.slices;
  useEffect(() => {
    let isStale = false;
    engine.ask("layer_rows", {}).then(
      (found) => !isStale && setRows(found),
      (problem: Problem) => !isStale && ui.problem(problem),
    );
    return () => {
      isStale = true;
    };
  }, [welcome.fingerprint, ...layers.map(({ look }) => look), layers.length, window, colors]);
  return rows !== null && rows.rows.length === layers.length ? rows : null;
}

/** The function that sets fields of a row. */
function useChange(part: PartProps, layer: number): (wanted: LayerChange | null, gesture?: string) => void {
  const queue = useRef<ChangeQueue>({ waiting: [], isBusy: false });
  return (wanted, gesture) => void changeRow(part, layer, queue.current, wanted, gesture);
}

interface RowProps extends PartProps {
  readonly index: number;
  readonly layer: Layer;
  readonly rows: Rows | null;
}

export function LayerListRow(props: RowProps) {
  const { store, ui, welcome, index, layer, rows } = props;
  const { layers } = store.state;
  const change = useChange(props, index);
  const row = rows?.rows[index];
  const isChannels = rows?.rows[0]?.kind === "channel" && layers.length > 1;
  const setOpacity = (value: number): void => store.change([set(value, "layers", index, "opacity")], `opacity of layer ${index}`);
  return (
    <li class="look-layer" data-chosen={index === ui.layer && layers.length > 1} onFocusCapture={() => ui.setLayer(index)} onPointerDown={() => ui.setLayer(index)}>
      <div class="row look-nowrap">
        <input
          type="checkbox"
          aria-label={TEXT.shown(layer.name)}
          title={TEXT.shown(layer.name)}
          checked={layer.visible}
          onChange={(event) => store.change([set(event.currentTarget.checked, "layers", index, "visible")])}
        />
        <Ramp layer={layer} />
        <input
          type="text"
          class="look-grow"
          aria-label={TEXT.name(index)}
          title={layer.name}
          value={layer.name}
          maxLength={200}
          onChange={(event) => {
            const name = event.currentTarget.value.trim();
            if (name === "") event.currentTarget.value = layer.name;
            else store.change([set(name, "layers", index, "name")]);
          }}
        />
        <Button label={TEXT.autoThis(layer.name)} pressed={row?.is_automatic === true && row.gamma === 1} onClick={() => change({ auto: true })}>{TEXT.auto}</Button>
        {layers.length > 1 && (
          <>
            <Button label={TEXT.soloThis(layer.name)} pressed={isSolo(layers, index)} onClick={() => store.change(soloLayer(store, index))}>{TEXT.solo}</Button>
            <button class="icon-button" aria-label={TEXT.removeThis(layer.name)} title={TEXT.removeThis(layer.name)} onClick={() => store.change(withoutLayer(store.state, index))}>
              <Icon name="close" />
            </button>
          </>
        )}
      </div>
      {row?.window && (
        <WindowSlider
          {...props}
          window={row.window}
          unit={welcome.volumes[index]?.value_unit ?? ""}
          onWindow={(window) => change({ window }, `window of layer ${index}`)}
          onSettle={() => change(null)}
        />
      )}
      {row?.window && (
        <div class="row look-ends">
          <ValueField ui={ui} label={TEXT.from} name={layer.name} value={row.window[0]} onValue={(low) => change({ window: [low, null] })} />
          <ValueField ui={ui} label={TEXT.to} name={layer.name} value={row.window[1]} onValue={(high) => change({ window: [null, high] })} />
          {row.kind !== "channel" && (row.kind === "map" || index > 0) && (
            <ValueField ui={ui} label={TEXT.below} name={layer.name} value={row.threshold} isOptional onValue={(threshold) => change({ threshold: threshold as number | null })} />
          )}
          <Colors {...props} row={row} maps={rows?.maps ?? []} hasColor={isChannels || index > 0 || row.kind === "channel"} change={change} />
        </div>
      )}
      <div class="look-pair">
        {(row?.kind === "map" || row?.kind === "channel") && (
          <SmallSlider
            label={TEXT.gamma}
            name={layer.name}
            value={row.gamma}
            min={0.2}
            max={MAX_GAMMA}
            onInput={(gamma) => change({ gamma }, `gamma of layer ${index}`)}
            onSettle={() => change(null)}
          />
        )}
        <SmallSlider label={TEXT.opacity} name={layers.length > 1 ? layer.name : ""} value={layer.opacity} min={0} max={1} onInput={setOpacity} onSettle={() => store.settle()} />
      </div>
    </li>
  );
}

interface ColorsProps extends RowProps {
  readonly row: LayerRow;
  readonly maps: readonly string[];
  /** Whether the layer may have one colour, as channels have. */
  readonly hasColor: boolean;
  change(wanted: LayerChange | null, gesture?: string): void;
}

/** The choice of a colour map or of one colour. */
function Colors({ row, maps, index, layer, hasColor, change }: ColorsProps) {
  return (
    <span class="row look-nowrap look-colors">
      <select
        class="look-grow"
        aria-label={TEXT.field(TEXT.colors, layer.name)}
        title={TEXT.colors}
        value={row.kind === "map" ? row.colors : ""}
        onChange={(event) => event.currentTarget.value !== "" && change({ colors: event.currentTarget.value })}
      >
        {row.kind !== "map" && <option value="" selected>{row.kind === "channel" ? TEXT.ownColor : TEXT.look(titleOf(layer.look.name))}</option>}
        {[...new Set([...(row.kind === "map" ? [row.colors] : []), ...maps])].map((name) => (
          <option key={name} value={name} selected={row.kind === "map" && name === row.colors}>{name}</option>
        ))}
      </select>
      {hasColor && (
        <ColorField
          label={TEXT.field(TEXT.ownColor, layer.name)}
          value={row.kind === "channel" ? row.colors : "#808080"}
          onColor={(colors) => change({ colors }, `colour of layer ${index}`)}
          onSettle={() => change(null)}
        />
      )}
    </span>
  );
}

interface SmallSliderProps {
  readonly label: string;
  readonly name: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  onInput(value: number): void;
  onSettle(): void;
}

/** A slider and its value in half of a row. */
function SmallSlider({ label, name, value, min, max, onInput, onSettle }: SmallSliderProps) {
  return (
    <label class="look-half">
      <span class="dim">{label}</span>
      <input
        type="range"
        aria-label={name === "" ? label : TEXT.field(label, name)}
        min={min}
        max={max}
        step={0.01}
        value={value}
        onInput={(event) => onInput(event.currentTarget.valueAsNumber)}
        onChange={onSettle}
      />
      <output>{value.toFixed(2)}</output>
    </label>
  );
}

interface ValueFieldProps {
  readonly ui: PartProps["ui"];
  readonly label: string;
  readonly name: string;
  readonly value: number | null;
  /** Whether the field may be empty. */
  readonly isOptional?: boolean;
  onValue(value: number | string | null): void;
}

/** A value that is typed, or a percentile. */
function ValueField({ ui, label, name, value, isOptional = false, onValue }: ValueFieldProps) {
  // The text stays as typed until the field is left, whatever is drawn meanwhile.
  const [typed, setTyped] = useState<string | null>(null);
  const shown = value === null ? "" : numberText(Number(value.toPrecision(5)));
  return (
    <label>
      <span class="dim">{label}</span>
      <input
        type="text"
        inputMode="decimal"
        aria-label={TEXT.field(label, name)}
        title={isOptional ? label : TEXT.percent}
        placeholder={isOptional ? "–" : ""}
        value={typed ?? shown}
        onInput={(event) => setTyped(event.currentTarget.value)}
        onChange={(event) => {
          setTyped(null);
          try {
            onValue(typedValue(event.currentTarget.value, label, isOptional));
          } catch (error) {
            ui.problem({ code: "value", message: (error as Error).message });
          }
        }}
        onBlur={() => setTyped(null)}
        onKeyDown={(event) => event.key === "Enter" && event.currentTarget.blur()}
      />
    </label>
  );
}

interface WindowSliderProps extends RowProps {
  readonly window: Range;
  readonly unit: string;
  onWindow(window: Range): void;
  onSettle(): void;
}

/** A slider with two ends under the histogram of a layer's values. */
function WindowSlider(props: WindowSliderProps) {
  const { welcome, index, layer, window, unit, onWindow, onSettle } = props;
  const usual = welcome.volumes[index]?.robust_range ?? window;
  // The ends of the slider stay while it is dragged.
  const held = useRef<Range | null>(null);
  const moved = useRef<Range | null>(null);
  const [low, high] = held.current ?? [Math.min(usual[0], window[0]), Math.max(usual[1], window[1])];
  const bars = useBars(props, [Math.min(usual[0], low), Math.max(usual[1], high)]);
  const step = roundStep((high - low) / 1000);
  const share = (value: number): number => ((value - low) / (high - low)) * 100;
  const now = moved.current ?? window;
  const input = (end: 0 | 1, value: number): void => {
    held.current ??= [low, high];
    const before = moved.current ?? window;
    const next: Range = end === 0 ? [Math.min(value, before[1] - step), before[1]] : [before[0], Math.max(value, before[0] + step)];
    moved.current = next;
    onWindow(next);
  };
  const settle = (): void => {
    held.current = moved.current = null;
    onSettle();
  };
  return (
    <div class="look-window">
      <svg viewBox={`0 0 ${BINS} ${BARS_PX}`} preserveAspectRatio="none" aria-hidden="true">
        {bars.map((height, k) => <rect key={k} class="look-counts" x={k} y={BARS_PX * (1 - height)} width="1" height={BARS_PX * height} />)}
        <rect class="look-inside" x={(share(now[0]) / 100) * BINS} width={(Math.max(0, share(now[1]) - share(now[0])) / 100) * BINS} y="0" height={BARS_PX} />
      </svg>
      {([0, 1] as const).map((end) => (
        <input
          key={end}
          type="range"
          aria-label={TEXT.field(end === 0 ? TEXT.from : TEXT.to, layer.name)}
          aria-valuetext={`${numberText(now[end])} ${unit}`.trim()}
          min={low}
          max={high}
          step={step}
          value={now[end]}
          onInput={(event) => input(end, event.currentTarget.valueAsNumber)}
          onChange={settle}
        />
      ))}
    </div>
  );
}

/** Heights of a small histogram over a range. */
function useBars({ engine, ui, index, layer }: RowProps, [low, high]: Range): readonly number[] {
  const [bars, setBars] = useState<readonly number[]>([]);
  useEffect(() => {
    let isStale = false;
    if (!(low < high)) return undefined;
    engine.ask("histogram", { layer: index, bins: BINS, low, high }).then(
      ({ counts }) => !isStale && setBars(heights(counts, true)),
      (problem: Problem) => !isStale && ui.problem(problem),
    );
    return () => {
      isStale = true;
    };
  }, [engine, index, layer.volume, layer.time, low, high]);
  return bars;
}
