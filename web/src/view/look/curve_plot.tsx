// A curve of opacities over a histogram, in SVG: points are moved by pointer and keys, the axis is zoomed and dragged.

import { useId, useRef } from "preact/hooks";
import type { ColorPoint, OpacityPoint } from "../../state/state.ts";
import { numberText, outOfSight, rounded, ticks, within, zoomed } from "./axis.ts";
import { clamped, hexOf, outline, withPoint, type Curve, type Range } from "./curves.ts";
import { MARGIN, px, useHandles, type PointEditor } from "./use_handles.tsx";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.curvePlot;

/** Exponent of the magnified scale: heights are opacities to this power, so that low ones are seen. */
const ROOT = 1 / 3;
/** Number of straight pieces in which a line is drawn that the scale bends. */
const PIECES = 16;
const WHEEL_ZOOM = 1.2;
const N_TICKS = 5;

export interface Histogram {
  readonly heights: readonly number[];
  readonly range: Range;
}

interface CurvePlotProps extends PointEditor<OpacityPoint> {
  readonly label: string;
  /** Name of the second coordinate of a point, beside its value. */
  readonly what: string;
  readonly height: number;
  readonly whole: Range;
  readonly colors: Curve<ColorPoint> | null;
  readonly histogram: Histogram | null;
  readonly isMagnified: boolean;
  /** Least value of a point. */
  readonly least?: number;
  onSeen(seen: Range): void;
}

export function CurvePlot(props: CurvePlotProps) {
  const { label, height, seen, whole, unit, curve, colors, histogram, isMagnified, least = -Infinity } = props;
  const pan = useRef<{ readonly x: number; readonly seen: Range } | null>(null);
  const fill = useId();
  const innerHeight = height - MARGIN.top - MARGIN.bottom;
  const power = isMagnified ? ROOT : 1;
  const yOf = (alpha: number): number => MARGIN.top + (1 - alpha ** power) * innerHeight;
  const alphaAt = (y: number): number => clamped(1 - (y - MARGIN.top) / innerHeight, 0, 1) ** (1 / power);
  const placed = (value: number, y: number): OpacityPoint => [
    Math.max(least, rounded(value, seen[1] - seen[0])),
    Number(alphaAt(y).toPrecision(3)),
  ];
  const points = useHandles<OpacityPoint>(props, {
    y: ([, alpha]) => yOf(alpha),
    color: () => null,
    label: TEXT.point,
    text: ([value, alpha]) =>
      TEXT.pointAt(props.what, numberText(alpha), `${numberText(value)}${unit && ` ${unit}`}`),
    // On the magnified scale a key press changes an opacity by a share of it, so that the change is seen.
    rise: ([, alpha]) => (isMagnified ? Math.max(0.0005, 0.1 * alpha) : 0.01),
    added: (value, y) => withPoint(curve, placed(value, y)),
    dragged: (_, value, y) => placed(value, y),
    stepped: ([value, alpha], by, rise) => [Math.max(least, value + by), Number((alpha + rise).toPrecision(6))],
  });
  const { width, inner, xOf, valueAt, inside, listeners } = points;

  const line = outline(curve, seen, isMagnified ? PIECES : 1).map(
    ([value, alpha]) => `${px(xOf(value))},${px(yOf(alpha))}`,
  );
  const hidden = outOfSight(curve, seen);
  const marks = isMagnified ? [0, 0.01, 0.1, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1];
  // The unit takes the place of the first number.
  const marked = ticks(seen, N_TICKS).filter((value) => unit === "" || xOf(value) > MARGIN.left + 14);
  return (
    <svg
      ref={points.svg}
      class="look-plot"
      height={height}
      role="group"
      aria-label={label}
      onWheel={(event) => {
        const root = event.currentTarget.getRootNode() as Document | ShadowRoot;
        if (!event.ctrlKey && !event.currentTarget.contains(root.activeElement)) return;
        event.preventDefault();
        props.onSeen(zoomed(seen, event.deltaY < 0 ? WHEEL_ZOOM : 1 / WHEEL_ZOOM, valueAt(inside(event).x), whole));
      }}
      onDblClick={listeners.onDblClick}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        pan.current = { x: inside(event).x, seen };
      }}
      onPointerMove={(event) => {
        listeners.onPointerMove(event);
        if (pan.current === null) return;
        const [low, high] = pan.current.seen;
        const shift = ((pan.current.x - inside(event).x) / inner) * (high - low);
        props.onSeen(within([low + shift, high + shift], whole));
      }}
      onLostPointerCapture={() => {
        listeners.onLostPointerCapture();
        pan.current = null;
      }}
    >
      <Fill id={fill} colors={colors} xOf={xOf} />
      <g aria-hidden="true">
        {marks.map((alpha) => (
          <g key={alpha}>
            <line class="look-grid" x1={MARGIN.left} x2={width - MARGIN.right} y1={yOf(alpha)} y2={yOf(alpha)} />
            <text class="look-tick" x={MARGIN.left - 4} y={yOf(alpha) + 4} text-anchor="end">
              {alpha}
            </text>
          </g>
        ))}
        {marked.map((value) => (
          <g key={value}>
            <line class="look-grid" x1={xOf(value)} x2={xOf(value)} y1={MARGIN.top} y2={height - MARGIN.bottom + 3} />
            <text class="look-tick" x={Math.min(xOf(value), width - 20)} y={height - 5} text-anchor="middle">
              {numberText(value)}
            </text>
          </g>
        ))}
        <text class="look-tick" x={MARGIN.left - 4} y={height - 5} text-anchor="end">
          {unit}
        </text>
        <polygon
          points={`${line.join(" ")} ${px(xOf(seen[1]))},${yOf(0)} ${px(xOf(seen[0]))},${yOf(0)}`}
          fill={colors === null ? "var(--accent)" : `url(#${fill})`}
          fill-opacity={0.7}
        />
        {histogram !== null && <path class="look-counts" d={barsPath(histogram, xOf, innerHeight, seen)} />}
        <polyline class="look-line-under" points={line.join(" ")} />
        <polyline class="look-line" points={line.join(" ")} />
      </g>
      {hidden.below > 0 && (
        <Mark side="left" x={MARGIN.left} y={height / 2} text={TEXT.below(hidden.below)} onClick={props.onShowPoints} />
      )}
      {hidden.above > 0 && (
        <Mark
          side="right"
          x={width - MARGIN.right}
          y={height / 2}
          text={TEXT.above(hidden.above)}
          onClick={props.onShowPoints}
        />
      )}
      {points.handles}
    </svg>
  );
}

function Mark(props: { side: "left" | "right"; x: number; y: number; text: string; onClick(): void }) {
  const { side, x, y, text, onClick } = props;
  const stop = (event: Event): void => event.stopPropagation();
  return (
    <g
      class="look-mark"
      role="button"
      tabindex={0}
      aria-label={text}
      transform={`translate(${x} ${y})${side === "left" ? "" : " scale(-1 1)"}`}
      onPointerDown={stop}
      onDblClick={stop}
      onClick={onClick}
      onKeyDown={(event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        event.stopPropagation();
        onClick();
      }}
    >
      <title>{text}</title>
      <rect class="look-reach" x={-6} y={-14} width={28} height={28} />
      <path d="M1 0 L13 -8 V8 Z" />
    </g>
  );
}

/** Colours of the values as a gradient along x, for the area under the curve and the ramp. */
export function Fill({
  id,
  colors,
  xOf,
}: {
  id: string;
  colors: Curve<ColorPoint> | null;
  xOf(value: number): number;
}) {
  const [first, last] = [colors?.[0], colors?.at(-1)];
  if (colors === null || first === undefined || last === undefined) return null;
  // A gradient of no width paints nothing.
  const width = last[0] - first[0] || 1;
  return (
    <defs>
      <linearGradient
        id={id}
        gradientUnits="userSpaceOnUse"
        x1={xOf(first[0])}
        x2={xOf(first[0] + width)}
        y1={0}
        y2={0}
      >
        {colors.map((point, index) => (
          <stop key={index} offset={(point[0] - first[0]) / width} stop-color={hexOf(point)} />
        ))}
      </linearGradient>
    </defs>
  );
}

function barsPath({ heights, range }: Histogram, xOf: (value: number) => number, height: number, seen: Range): string {
  const bin = (range[1] - range[0]) / heights.length;
  const [left, right] = [xOf(seen[0]), xOf(seen[1])];
  const bottom = MARGIN.top + height;
  const steps = heights.flatMap((share, k) => {
    const [a, b] = [xOf(range[0] + k * bin), xOf(range[0] + (k + 1) * bin)];
    if (b < left || a > right) return [];
    return [
      `L${px(Math.max(a, left))} ${px(bottom - share * height)}`,
      `L${px(Math.min(b, right))} ${px(bottom - share * height)}`,
    ];
  });
  const first = clamped(xOf(range[0]), left, right);
  const last = clamped(xOf(range[1]), left, right);
  return `M${px(first)} ${bottom} ${steps.join(" ")} L${px(last)} ${bottom} Z`;
}
