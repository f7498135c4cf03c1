// The curve that makes opacity depend on how steep the values are: boundaries stand out, even matter fades.

import { useState } from "preact/hooks";
import type { VolumeInfo } from "../../engine/engine.ts";
import { set } from "../../state/patch.ts";
import type { OpacityPoint, TransferFunction } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { around, rounded, within } from "./axis.ts";
import { CurvePlot } from "./curve_plot.tsx";
import { firstGradientCurve, spanOf, withMoved, type Curve, type Range } from "./curves.ts";
import { Button, NamedNumber } from "../fields.tsx";
import { changePoints, type PointEditor } from "./use_handles.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.gradientEditor;
const PLOT_PX = 130;

interface GradientEditorProps extends PartProps {
  readonly curves: TransferFunction;
  readonly volume: VolumeInfo;
  latest(): Curve<OpacityPoint>;
}

export function GradientEditor({ store, ui, curves, volume, latest }: GradientEditorProps) {
  const curve = curves.gradient_opacity ?? [];
  const scale = strongGradient(volume);
  const least = spanOf([[0], [scale]], curve);
  const whole: Range = [0, 1.1 * least[1]];
  const [zoom, setZoom] = useState<Range | null>(null);
  const [chosen, setChosen] = useState<number>(0);
  const path = ["layers", ui.layer, "look", "transfer_function", "gradient_opacity"] as const;
  const index = Math.min(chosen, curve.length - 1);
  const point = curve[index];
  const change = (next: Curve<OpacityPoint>, at: number | null): void => {
    store.change([set(next, ...path)], "gradient opacity");
    if (at !== null) setChosen(at);
  };
  const done = (): void => store.settle();
  const unit = [volume.value_unit, volume.unit].every((one) => one) ? `${volume.value_unit}/${volume.unit}` : "";
  if (point === undefined) {
    return (
      <details class="look-details">
        <summary>{TEXT.title}</summary>
        <p class="dim">{TEXT.none}</p>
        <Button onClick={() => store.change([set(firstGradientCurve(rounded(scale, 10 * scale)), ...path)])}>
          {TEXT.add}
        </Button>
      </details>
    );
  }
  const editor: PointEditor<OpacityPoint> = {
    seen: within(zoom ?? whole, whole),
    unit,
    curve,
    latest,
    selected: index,
    onSelect: setChosen,
    onCurve: change,
    onSettle: done,
    onShowPoints: () => setZoom(around(spanOf(curve), whole)),
    onType: () => {},
  };
  return (
    <details class="look-details" open>
      <summary>{TEXT.title}</summary>
      <CurvePlot
        {...editor}
        label={TEXT.label}
        what={TEXT.what}
        height={PLOT_PX}
        whole={whole}
        least={0}
        colors={null}
        histogram={null}
        isMagnified={false}
        onSeen={setZoom}
      />
      <div class="row">
        <NamedNumber
          label={TEXT.gradient}
          unit={unit}
          min={0}
          value={point[0]}
          onInput={(value) => change(withMoved(curve, index, [value, point[1]]), index)}
          onSettle={done}
        />
        <NamedNumber
          label={TEXT.factor}
          min={0}
          max={1}
          step={0.01}
          value={point[1]}
          onInput={(factor) => change(withMoved(curve, index, [point[0], factor]), index)}
          onSettle={done}
        />
      </div>
      <div class="row">
        <Button onClick={() => changePoints({ ...editor, seen: whole }, "insert", index)}>{TEXT.addPoint}</Button>
        <Button disabled={curve.length === 1} onClick={() => changePoints(editor, "remove", index)}>
          {TEXT.delete}
        </Button>
        <Button onClick={() => store.change([{ op: "remove", path: `/${path.join("/")}` }])}>{TEXT.remove}</Button>
      </div>
    </details>
  );
}

/** A gradient that is strong in this volume: half of the usual values within one voxel. */
function strongGradient(volume: VolumeInfo): number {
  const [low, high] = volume.robust_range;
  return (0.5 * (high - low || 1)) / Math.min(...volume.spacing);
}
