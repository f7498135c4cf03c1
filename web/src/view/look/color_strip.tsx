// The ramp of colours under the curve, with a handle for each colour point.

import { useId, useRef } from "preact/hooks";
import type { ColorPoint } from "../../state/state.ts";
import { numberText, outOfSight, rounded } from "./axis.ts";
import { changePoints, Fill, Handle, MARGIN, useWidth } from "./curve_plot.tsx";
import { hexOf, withMoved, withPointOn, type Curve, type Range } from "./curves.ts";
import { pointKey } from "./point_keys.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.colorStrip;
const RAMP_PX = 16;
const HEIGHT_PX = 44;

interface ColorStripProps {
  readonly seen: Range;
  readonly unit: string;
  readonly curve: Curve<ColorPoint>;
  /** Returns the curve as it is now: keys can come more often than the page is drawn. */
  latest(): Curve<ColorPoint>;
  readonly selected: number | null;
  onSelect(index: number): void;
  onCurve(curve: Curve<ColorPoint>, index: number | null): void;
  onSettle(): void;
  onType(): void;
  onShowPoints(): void;
}

export function ColorStrip(props: ColorStripProps) {
  const { seen, unit, curve, selected } = props;
  const [svg, width] = useWidth<SVGSVGElement>();
  const drag = useRef<{ readonly index: number; readonly x: number } | null>(null);
  const fill = useId();
  const inner = width - MARGIN.left - MARGIN.right;
  const xOf = (value: number): number => MARGIN.left + ((value - seen[0]) / (seen[1] - seen[0])) * inner;
  const valueAt = (x: number): number => seen[0] + ((x - MARGIN.left) / inner) * (seen[1] - seen[0]);
  const inside = (event: MouseEvent): number => event.clientX - (svg.current?.getBoundingClientRect().left ?? 0);
  const move = (index: number, value: number): void => {
    const latest = props.latest();
    const point = latest[index];
    if (point !== undefined) props.onCurve(withMoved(latest, index, [value, point[1], point[2], point[3]]), index);
  };
  const onUp = (): void => {
    if (drag.current !== null) props.onSettle();
    drag.current = null;
  };
  const onKeyDown = (event: KeyboardEvent, index: number): void => {
    const key = pointKey(event.key, event.shiftKey, seen, 0);
    if (key === null || (key.does === "remove" && curve.length === 1)) return;
    if (key.does === "move") move(index, (props.latest()[index]?.[0] ?? 0) + key.value);
    else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };
  const { below, above } = outOfSight(curve, seen);
  const only = curve[0];
  const isPlain = curve.length === 1 && only !== undefined;
  return (
    <>
      <svg
        ref={svg}
        class="look-plot"
        height={HEIGHT_PX}
        role="group"
        aria-label={TEXT.label}
        onDblClick={(event) => {
          const added = withPointOn(curve, rounded(valueAt(inside(event)), seen[1] - seen[0]));
          props.onCurve(added.curve, added.index);
          props.onSettle();
        }}
        onPointerMove={(event) => {
          const begun = drag.current;
          if (begun !== null) move(begun.index, rounded(valueAt(inside(event) - begun.x), seen[1] - seen[0]));
        }}
        onLostPointerCapture={onUp}
      >
        <Fill id={fill} colors={curve} xOf={xOf} />
        <rect
          class="look-ramp"
          x={MARGIN.left}
          y={1}
          width={Math.max(0, inner)}
          height={RAMP_PX}
          fill={isPlain ? hexOf(only) : `url(#${fill})`}
        />
        {curve.map((point, index) =>
          point[0] < seen[0] || point[0] > seen[1] ? null : (
            <Handle
              key={index}
              x={xOf(point[0])}
              y={RAMP_PX + 13}
              isSelected={index === selected}
              color={hexOf(point)}
              label={TEXT.point(index + 1, curve.length)}
              value={point[0]}
              range={seen}
              text={TEXT.pointAt(hexOf(point), `${numberText(point[0])}${unit && ` ${unit}`}`)}
              onSelect={() => props.onSelect(index)}
              onKeyDown={(event) => onKeyDown(event, index)}
              onKeyUp={() => props.onSettle()}
              onGrab={(event) => {
                svg.current?.setPointerCapture(event.pointerId);
                drag.current = { index, x: inside(event) - xOf(point[0]) };
              }}
            />
          ),
        )}
      </svg>
      {below + above > 0 && (
        <button type="button" class="button" onClick={() => props.onShowPoints()}>
          {TEXT.hidden(below + above)}
        </button>
      )}
    </>
  );
}
