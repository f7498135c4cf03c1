// The chosen point of a curve in numbers: its value, its opacity or colour; the points before and after; removing.

import type { ComponentChildren } from "preact";
import type { ColorPoint, OpacityPoint, TransferFunction } from "../../state/state.ts";
import { hexOf, rgbOf, withMoved, without, type Curve, type Point as CurvePoint } from "./curves.ts";
import { Button, ColorField, NamedNumber } from "../fields.tsx";
import type { Selected } from "./function_panel.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.pointFields;

interface PointFieldsProps {
  readonly curves: TransferFunction;
  readonly selected: Selected | null;
  readonly unit: string;
  onOpacity(curve: Curve<OpacityPoint>, index: number): void;
  onColor(curve: Curve<ColorPoint>, index: number): void;
  onSettle(): void;
  onSelect(selected: Selected | null): void;
}

export function PointFields(props: PointFieldsProps) {
  const { curves, selected, onSettle } = props;
  const index = selected?.index ?? -1;
  const [node, color] = [curves.opacity[index], curves.color[index]];
  if (selected?.kind === "opacity" && node !== undefined) {
    return (
      <Point {...props} title={TEXT.opacityPoint} curve={curves.opacity} index={index} onCurve={props.onOpacity}>
        {(move) => (
          <NamedNumber
            label={TEXT.opacity}
            value={node[1]}
            min={0}
            max={1}
            step={0.01}
            onInput={(opacity) => move([node[0], opacity])}
            onSettle={onSettle}
          />
        )}
      </Point>
    );
  }
  if (selected?.kind === "color" && color !== undefined) {
    return (
      <Point {...props} title={TEXT.colorPoint} curve={curves.color} index={index} onCurve={props.onColor}>
        {(move) => (
          <ColorField
            label={TEXT.color}
            value={hexOf(color)}
            onColor={(hex) => move([color[0], ...rgbOf(hex)])}
            onSettle={onSettle}
          />
        )}
      </Point>
    );
  }
  return <p class="dim look-small">{TEXT.none}</p>;
}

interface PointProps<P extends CurvePoint> {
  title(n: number, of: number): string;
  readonly unit: string;
  readonly selected: Selected | null;
  readonly curve: Curve<P>;
  readonly index: number;
  onCurve(curve: Curve<P>, index: number): void;
  onSelect(selected: Selected | null): void;
  onSettle(): void;
  /** Fields of the point's other coordinates, opacity or colour. */
  children(move: (point: P) => void): ComponentChildren;
}

function Point<P extends CurvePoint>(props: PointProps<P>) {
  const { title, unit, selected, curve, index, onCurve, onSelect, onSettle, children } = props;
  const point = curve[index];
  if (point === undefined) return null;
  const move = (moved: P): void => onCurve(withMoved(curve, index, moved), index);
  const go = (next: number): void => {
    if (selected !== null) onSelect({ ...selected, index: next });
  };
  return (
    <fieldset class="look-point">
      <legend>{title(index + 1, curve.length)}</legend>
      <div class="row">
        <NamedNumber
          label={TEXT.value}
          unit={unit}
          value={point[0] ?? 0}
          onInput={(value) => move([value, ...point.slice(1)] as CurvePoint as P)}
          onSettle={onSettle}
        />
        {children(move)}
      </div>
      <div class="row">
        <Button label={TEXT.before} disabled={index === 0} onClick={() => go(index - 1)}>
          ‹
        </Button>
        <Button label={TEXT.after} disabled={index === curve.length - 1} onClick={() => go(index + 1)}>
          ›
        </Button>
        <Button
          disabled={curve.length === 1}
          onClick={() => {
            onCurve(without(curve, index), Math.max(0, index - 1));
            onSettle();
          }}
        >
          {TEXT.remove}
        </Button>
      </div>
    </fieldset>
  );
}
