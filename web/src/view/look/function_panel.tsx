// The transfer function of the chosen layer: three knobs, and behind them an editor over the histogram.

import { useEffect, useRef, useState } from "preact/hooks";
import type { Problem, VolumeInfo } from "../../engine/engine.ts";
import { set } from "../../state/patch.ts";
import type { Look, TransferFunction } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { around, heights, rounded, wholeOf, within, zoomed } from "./axis.ts";
import { ColorStrip } from "./color_strip.tsx";
import { CurvePlot, type Histogram } from "./curve_plot.tsx";
import {
  isEditable,
  middle,
  mirrored,
  spanOf,
  spanOfFunction,
  withOpacities,
  type Curve,
  type Point,
  type Range,
} from "./curves.ts";
import { Button, Switch, NamedNumber, RelativeSlider, NumberField } from "../fields.tsx";
import { GradientEditor } from "./gradient_editor.tsx";
import { KnobFields } from "./knob_fields.tsx";
import { LayerChoice } from "./layer_choice.tsx";
import { lookAsChosen } from "./looks.ts";
import { titleOf } from "./preset_kinds.ts";
import { PointFields } from "./point_fields.tsx";
import { changePoints, type PointEditor } from "./use_handles.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.functionPanel;
const BINS = 256;
const PLOT_PX = 190;
/** Milliseconds for which the axis must be still before its histogram is asked for. */
const STILL_MS = 120;
/** Factor of opacity at the end of the slider. */
const MAX_OPACITY = 10;

export interface Selected {
  readonly kind: "opacity" | "color" | "gradient";
  readonly index: number;
}

export function FunctionPanel(props: PartProps) {
  const { store, ui, welcome } = props;
  const layer = store.state.layers[ui.layer];
  const volume = welcome.volumes[ui.layer];
  if (layer === undefined || volume === undefined) return null;
  const curves = layer.look.transfer_function;
  return (
    <div class="look-panel">
      <LayerChoice {...props} />
      {isEditable(curves) ? (
        <Editor key={ui.layer} {...props} curves={curves} look={layer.look} volume={volume} />
      ) : (
        <>
          <p>{TEXT.table}</p>
          <GlobalOpacity {...props} />
        </>
      )}
    </div>
  );
}

interface EditorProps extends PartProps {
  readonly curves: TransferFunction;
  readonly look: Look;
  readonly volume: VolumeInfo;
}

/** The knobs, and the curve behind them. */
function Editor(props: EditorProps) {
  const { store, engine, ui, welcome, curves, look, volume } = props;
  const [isOpen, setOpen] = useState(false);
  const reset = async (): Promise<void> => {
    try {
      const first = await lookAsChosen(engine, welcome, ui.layer, look.name);
      if (first === null) ui.announce(TEXT.gone);
      else store.change([set(first.transfer_function, "layers", ui.layer, "look", "transfer_function")]);
    } catch (problem) {
      ui.problem(problem as Problem);
    }
  };
  return (
    <>
      <KnobFields {...props} curves={curves} usual={volume.robust_range} />
      <GlobalOpacity {...props} />
      <div class="row">
        <Button onClick={() => void reset()}>{TEXT.reset(titleOf(look.name))}</Button>
      </div>
      <details class="look-details" open={isOpen} onToggle={(event) => setOpen(event.currentTarget.open)}>
        <summary>{TEXT.edit}</summary>
        {isOpen && <CurveEditor {...props} />}
      </details>
    </>
  );
}

function CurveEditor(props: EditorProps) {
  const { store, ui, curves, volume } = props;
  const span = spanOfFunction(curves);
  const whole = wholeOf(volume.range, span);
  const usual = wholeOf(volume.robust_range, span);
  const [zoom, setZoom] = useState<Range>(usual);
  const [selected, setSelected] = useState<Selected | null>(null);
  const [isLog, setLog] = useState(true);
  const [isMagnified, setMagnified] = useState(false);
  const base = useRef<TransferFunction | null>(null);
  const value = useRef<HTMLDivElement>(null);
  const seen = within(zoom, whole);
  const histogram = useHistogram(props, seen, isLog);
  const unit = volume.value_unit;
  const path = ["layers", ui.layer, "look", "transfer_function"] as const;
  const done = (): void => {
    base.current = null;
    store.settle();
  };
  const latest = (): TransferFunction => {
    const now = store.state.layers[ui.layer]?.look.transfer_function;
    return now !== undefined && isEditable(now) ? now : curves;
  };
  const setAll = (change: (before: TransferFunction) => TransferFunction, gesture: string): void => {
    base.current ??= latest();
    store.change([set(change(base.current), ...path)], gesture);
  };
  const once = (change: (before: TransferFunction) => TransferFunction): void => {
    store.change([set(change(latest()), ...path)]);
  };
  const showPoints = (): void => setZoom(around(spanOf(curves.opacity, curves.color), whole));
  const typeValue = (): void => value.current?.querySelector<HTMLInputElement>("input[type=number]")?.select();
  const editorOf = <P extends Point>(
    kind: "opacity" | "color",
    curveOf: (functions: TransferFunction) => Curve<P>,
    gesture: string,
  ): PointEditor<P> => ({
    seen,
    unit,
    curve: curveOf(curves),
    latest: () => curveOf(latest()),
    selected: selected?.kind === kind && selected.index < curveOf(curves).length ? selected.index : null,
    onSelect: (index) => setSelected({ kind, index }),
    onCurve: (curve, index) => {
      store.change([set(curve, ...path, kind)], gesture);
      if (index !== null) setSelected({ kind, index });
    },
    onSettle: done,
    onShowPoints: showPoints,
    onType: typeValue,
  });
  const opacity = editorOf("opacity", (functions) => functions.opacity, "opacity curve");
  const color = editorOf("color", (functions) => functions.color, "colours");
  const addPoint = <P extends Point>(editor: PointEditor<P>): void =>
    changePoints(editor, "insert", editor.selected ?? widestGap(editor.curve));

  return (
    <>
      <CurvePlot
        {...opacity}
        label={TEXT.curve}
        what={TEXT.opacity}
        height={PLOT_PX}
        whole={whole}
        colors={curves.color}
        histogram={histogram}
        isMagnified={isMagnified}
        onSeen={setZoom}
      />
      <ColorStrip {...color} />
      <div ref={value}>
        <PointFields
          curves={curves}
          selected={selected}
          unit={unit}
          onOpacity={opacity.onCurve}
          onColor={color.onCurve}
          onSettle={done}
          onSelect={setSelected}
        />
      </div>
      <div class="row">
        <Button onClick={() => addPoint(opacity)}>{TEXT.addOpacity}</Button>
        <Button onClick={() => addPoint(color)}>{TEXT.addColor}</Button>
      </div>
      <div class="row">
        <NamedNumber
          shown={TEXT.seen}
          label={TEXT.from}
          value={rounded(seen[0], seen[1] - seen[0])}
          onInput={(low) => low < seen[1] && setZoom([low, seen[1]])}
          onSettle={() => {}}
        />
        <NamedNumber
          shown="–"
          label={TEXT.to}
          unit={unit}
          value={rounded(seen[1], seen[1] - seen[0])}
          onInput={(high) => high > seen[0] && setZoom([seen[0], high])}
          onSettle={() => {}}
        />
        <Button label={TEXT.nearer} onClick={() => setZoom(zoomed(seen, 1.5, middle(seen), whole))}>
          +
        </Button>
        <Button label={TEXT.farther} onClick={() => setZoom(zoomed(seen, 1 / 1.5, middle(seen), whole))}>
          −
        </Button>
      </div>
      <div class="row">
        <Button onClick={() => setZoom(usual)}>{TEXT.usual}</Button>
        <Button onClick={() => setZoom(whole)}>{TEXT.all}</Button>
        <Button onClick={showPoints}>{TEXT.points}</Button>
      </div>
      <div class="row">
        <Switch label={TEXT.log} on={isLog} onToggle={setLog} />
        <Switch label={TEXT.magnified} on={isMagnified} onToggle={setMagnified} />
      </div>
      <p class="dim look-small">{TEXT.hint}</p>
      <RelativeSlider
        label={TEXT.opacities}
        neutral={1}
        amount={(position) => MAX_OPACITY ** position}
        position={(amount) => Math.log(amount) / Math.log(MAX_OPACITY)}
        onAmount={(amount) => amount >= 0 && setAll((before) => withOpacities(before, amount), "opacities")}
        onSettle={done}
      />
      <div class="row">
        <Button onClick={() => once((before) => ({ ...before, opacity: mirrored(before.opacity) }))}>
          {TEXT.mirrorOpacity}
        </Button>
        <Button onClick={() => once((before) => ({ ...before, color: mirrored(before.color) }))}>
          {TEXT.mirrorColor}
        </Button>
      </div>
      <GradientEditor {...props} latest={() => latest().gradient_opacity ?? []} />
    </>
  );
}

function GlobalOpacity({ store, ui }: PartProps) {
  const opacity = store.state.layers[ui.layer]?.opacity ?? 1;
  return (
    <NumberField
      isBounded
      label={TEXT.global}
      min={0}
      max={1}
      step={0.01}
      value={opacity}
      onInput={(value) => store.change([set(value, "layers", ui.layer, "opacity")], "layer opacity")}
      onSettle={() => store.settle()}
    />
  );
}

/** The histogram of the visible range; while it is on its way the old one stays, in its place. */
function useHistogram({ engine, store, ui }: PartProps, seen: Range, isLog: boolean): Histogram | null {
  const [found, setFound] = useState<{ readonly counts: readonly number[]; readonly range: Range } | null>(null);
  const time = store.state.layers[ui.layer]?.time;
  useEffect(() => {
    let isStale = false;
    const timer = setTimeout(() => {
      const [low, high] = seen;
      engine.ask("histogram", { layer: ui.layer, bins: BINS, low, high }).then(
        (answer) => {
          if (!isStale) setFound({ counts: answer.counts, range: [answer.low, answer.high] });
        },
        (problem: Problem) => {
          if (!isStale) ui.problem(problem);
        },
      );
    }, STILL_MS);
    return () => {
      isStale = true;
      clearTimeout(timer);
    };
  }, [engine, ui.layer, time, seen[0], seen[1]]);
  return found === null ? null : { heights: heights(found.counts, isLog), range: found.range };
}

/** Index of the point before the widest gap. */
function widestGap(curve: Curve): number {
  const gaps = curve.slice(1).map((point, k) => (point[0] ?? 0) - (curve[k]?.[0] ?? 0));
  return gaps.length === 0 ? 0 : gaps.indexOf(Math.max(...gaps));
}
