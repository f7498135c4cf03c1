// The ramp of colours under the curve, with a handle for each colour point.

import { useId } from "preact/hooks";
import type { ColorPoint } from "../../state/state.ts";
import { numberText, outOfSight, rounded } from "./axis.ts";
import { Fill } from "./curve_plot.tsx";
import { hexOf, withPointOn } from "./curves.ts";
import { MARGIN, useHandles, type PointEditor } from "./use_handles.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.colorStrip;
const RAMP_PX = 16;
const HEIGHT_PX = 44;

export function ColorStrip(props: PointEditor<ColorPoint>) {
  const { seen, unit, curve } = props;
  const fill = useId();
  const round = (value: number): number => rounded(value, seen[1] - seen[0]);
  const { svg, inner, xOf, listeners, handles } = useHandles<ColorPoint>(props, {
    y: () => RAMP_PX + 13,
    color: hexOf,
    label: TEXT.point,
    text: (point) => TEXT.pointAt(hexOf(point), `${numberText(point[0])}${unit && ` ${unit}`}`),
    rise: () => 0,
    added: (value) => withPointOn(curve, round(value)),
    dragged: ([, red, green, blue], value) => [round(value), red, green, blue],
    stepped: ([value, red, green, blue], by) => [value + by, red, green, blue],
  });
  const { below, above } = outOfSight(curve, seen);
  const only = curve[0];
  const isPlain = curve.length === 1 && only !== undefined;
  return (
    <>
      <svg ref={svg} class="look-plot" height={HEIGHT_PX} role="group" aria-label={TEXT.label} {...listeners}>
        <Fill id={fill} colors={curve} xOf={xOf} />
        <rect
          class="look-ramp"
          x={MARGIN.left}
          y={1}
          width={Math.max(0, inner)}
          height={RAMP_PX}
          fill={isPlain ? hexOf(only) : `url(#${fill})`}
        />
        {handles}
      </svg>
      {below + above > 0 && (
        <button type="button" class="button" onClick={() => props.onShowPoints()}>
          {TEXT.hidden(below + above)}
        </button>
      )}
    </>
  );
}
