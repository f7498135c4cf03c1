// The chosen point of a curve in numbers: its value, its opacity or colour; the points before and after; removing.

import type { ColorPoint, OpacityPoint, TransferFunction } from "../../state/state.ts";
import { hexOf, rgbOf, withMoved, without, type Curve } from "./curves.ts";
import { Button, ColorField, NamedNumber } from "./fields.tsx";
import type { Selected } from "./function_panel.tsx";

const TEXT = {
  none: "Choose a point to type its numbers.",
  opacityPoint: (n: number, of: number) => `Opacity point ${n} of ${of}`,
  colorPoint: (n: number, of: number) => `Colour ${n} of ${of}`,
  value: "Value",
  opacity: "Opacity",
  color: "Colour",
  remove: "Delete",
  before: "Point before",
  after: "Next point",
};

export interface PointFieldsProps {
  readonly curves: TransferFunction;
  readonly selected: Selected | null;
  readonly unit: string;
  onOpacity(curve: Curve<OpacityPoint>, index: number): void;
  onColor(curve: Curve<ColorPoint>, index: number): void;
  onDone(): void;
  onSelect(selected: Selected | null): void;
}

export function PointFields(props: PointFieldsProps) {
  const { curves, selected, unit, onDone } = props;
  const index = selected?.index ?? -1;
  if (selected?.kind === "opacity") {
    const point = curves.opacity[index];
    if (point !== undefined) {
      const move = (value: number, opacity: number): void =>
        props.onOpacity(withMoved(curves.opacity, index, [value, opacity]), index);
      return (
        <Point
          {...props}
          title={TEXT.opacityPoint(index + 1, curves.opacity.length)}
          n={curves.opacity.length}
          onRemove={() => props.onOpacity(without(curves.opacity, index), Math.max(0, index - 1))}
        >
          <NamedNumber
            label={TEXT.value}
            unit={unit}
            value={point[0]}
            onValue={(value) => move(value, point[1])}
            onDone={onDone}
          />
          <NamedNumber
            label={TEXT.opacity}
            value={point[1]}
            min={0}
            max={1}
            step={0.01}
            onValue={(opacity) => move(point[0], opacity)}
            onDone={onDone}
          />
        </Point>
      );
    }
  }
  if (selected?.kind === "color") {
    const point = curves.color[index];
    if (point !== undefined) {
      const move = (moved: ColorPoint): void => props.onColor(withMoved(curves.color, index, moved), index);
      return (
        <Point
          {...props}
          title={TEXT.colorPoint(index + 1, curves.color.length)}
          n={curves.color.length}
          onRemove={() => props.onColor(without(curves.color, index), Math.max(0, index - 1))}
        >
          <NamedNumber
            label={TEXT.value}
            unit={unit}
            value={point[0]}
            onValue={(value) => move([value, point[1], point[2], point[3]])}
            onDone={onDone}
          />
          <ColorField
            label={TEXT.color}
            value={hexOf(point)}
            onColor={(hex) => move([point[0], ...rgbOf(hex)])}
            onDone={onDone}
          />
        </Point>
      );
    }
  }
  return <p class="dim look-small">{TEXT.none}</p>;
}

interface PointProps extends PointFieldsProps {
  readonly title: string;
  readonly n: number;
  readonly children: preact.ComponentChildren;
  onRemove(): void;
}

function Point({ title, n, selected, children, onSelect, onRemove, onDone }: PointProps) {
  const go = (index: number): void => {
    if (selected !== null && index >= 0 && index < n) onSelect({ ...selected, index });
  };
  const index = selected?.index ?? 0;
  return (
    <fieldset class="look-point">
      <legend>{title}</legend>
      <div class="row">{children}</div>
      <div class="row">
        <Button label={TEXT.before} disabled={index === 0} onClick={() => go(index - 1)}>
          ‹
        </Button>
        <Button label={TEXT.after} disabled={index === n - 1} onClick={() => go(index + 1)}>
          ›
        </Button>
        <Button
          disabled={n === 1}
          onClick={() => {
            onRemove();
            onDone();
          }}
        >
          {TEXT.remove}
        </Button>
      </div>
    </fieldset>
  );
}
