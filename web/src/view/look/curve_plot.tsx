// A curve of opacities over a histogram, in SVG: points are moved by pointer and keys, the axis is zoomed and dragged.

import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import type { ColorPoint, OpacityPoint } from "../../state/state.ts";
import { numberText, outOfSight, rounded, ticks, within, zoomed } from "./axis.ts";
import {
  clamped,
  hexOf,
  outline,
  withMoved,
  withPoint,
  withPointBeside,
  without,
  type Curve,
  type Point,
  type Range,
} from "./curves.ts";
import { pointKey } from "./point_keys.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.curvePlot;

const KEYS = "Arrows move, Page up and down move far, Delete removes, Insert adds, Enter goes to the number";

/** Margins around the drawing, CSS pixels. */
export const MARGIN = { left: 34, right: 12, top: 12, bottom: 20 };
const DOT_PX = 6;
/** Half the side of the area of a point that pointers and fingers hit. */
const REACH_PX = 13;
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

interface CurvePlotProps {
  readonly label: string;
  /** Name of the second coordinate of a point, beside its value. */
  readonly what: string;
  readonly height: number;
  readonly seen: Range;
  readonly whole: Range;
  readonly unit: string;
  readonly curve: Curve<OpacityPoint>;
  /** Returns the curve as it is now: keys can come more often than the page is drawn. */
  latest(): Curve<OpacityPoint>;
  readonly colors: Curve<ColorPoint> | null;
  readonly histogram: Histogram | null;
  readonly isMagnified: boolean;
  readonly selected: number | null;
  /** Least value of a point. */
  readonly least?: number;
  onSelect(index: number): void;
  onCurve(curve: Curve<OpacityPoint>, index: number | null): void;
  onSettle(): void;
  onSeen(seen: Range): void;
  onShowPoints(): void;
  /** Called when the user wants to type the number of the selected point. */
  onType(): void;
  readonly children?: ComponentChildren;
}

export function CurvePlot(props: CurvePlotProps) {
  const { label, height, seen, whole, unit, curve, colors, histogram, isMagnified, selected } = props;
  const [svg, width] = useWidth<SVGSVGElement>();
  const drag = useRef<{
    readonly index: number | null;
    readonly x: number;
    readonly y: number;
    readonly seen: Range;
  } | null>(null);
  const fill = useId();
  const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  const power = isMagnified ? ROOT : 1;
  const xOf = (value: number): number => MARGIN.left + ((value - seen[0]) / (seen[1] - seen[0])) * inner.width;
  const yOf = (alpha: number): number => MARGIN.top + (1 - alpha ** power) * inner.height;
  const valueAt = (x: number): number => seen[0] + ((x - MARGIN.left) / inner.width) * (seen[1] - seen[0]);
  const alphaAt = (y: number): number => clamped(1 - (y - MARGIN.top) / inner.height, 0, 1) ** (1 / power);
  const inside = (event: MouseEvent): { x: number; y: number } => {
    const box = svg.current?.getBoundingClientRect();
    return { x: event.clientX - (box?.left ?? 0), y: event.clientY - (box?.top ?? 0) };
  };
  const tidy = (value: number, alpha: number): OpacityPoint => [
    Math.max(props.least ?? -Infinity, rounded(value, seen[1] - seen[0])),
    Number(alpha.toPrecision(3)),
  ];
  const move = (index: number, value: number, alpha: number): void =>
    props.onCurve(withMoved(curve, index, tidy(value, alpha)), index);

  const onPlotMove = (event: PointerEvent): void => {
    const begun = drag.current;
    if (begun === null) return;
    const { x, y } = inside(event);
    if (begun.index !== null) {
      move(begun.index, valueAt(x - begun.x), alphaAt(y - begun.y));
      return;
    }
    const shift = ((begun.x - x) / inner.width) * (begun.seen[1] - begun.seen[0]);
    props.onSeen(within([begun.seen[0] + shift, begun.seen[1] + shift], whole));
  };
  const onPlotUp = (): void => {
    if (drag.current?.index != null) props.onSettle();
    drag.current = null;
  };
  const onHandleKey = (event: KeyboardEvent, index: number): void => {
    const latest = props.latest();
    const point = latest[index];
    if (point === undefined) return;
    // On the magnified scale a key press changes an opacity by a share of it, so that the change is seen.
    const rise = isMagnified ? Math.max(0.0005, 0.1 * point[1]) : 0.01;
    const key = pointKey(event.key, event.shiftKey, seen, rise);
    if (key === null || (key.does === "remove" && latest.length === 1)) return;
    if (key.does === "move") {
      const value = Math.max(props.least ?? -Infinity, point[0] + key.value);
      props.onCurve(withMoved(latest, index, [value, Number((point[1] + key.rise).toPrecision(6))]), index);
    } else if (key.does === "type") props.onType();
    else changePoints(props, key.does, index);
    event.preventDefault();
    event.stopPropagation();
  };

  const line = outline(curve, seen, isMagnified ? PIECES : 1).map(
    ([value, alpha]) => `${px(xOf(value))},${px(yOf(alpha))}`,
  );
  const hidden = outOfSight(curve, seen);
  const marks = isMagnified ? [0, 0.01, 0.1, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1];
  // The unit takes the place of the first number.
  const marked = ticks(seen, N_TICKS).filter((value) => unit === "" || xOf(value) > MARGIN.left + 14);
  return (
    <svg
      ref={svg}
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
      onDblClick={(event) => {
        const { x, y } = inside(event);
        const added = withPoint(curve, tidy(valueAt(x), alphaAt(y)));
        props.onCurve(added.curve, added.index);
        props.onSettle();
      }}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        drag.current = { index: null, x: inside(event).x, y: 0, seen };
      }}
      onPointerMove={onPlotMove}
      onLostPointerCapture={onPlotUp}
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
        {histogram !== null && <path class="look-counts" d={barsPath(histogram, xOf, inner.height, seen)} />}
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
      {curve.map((point, index) =>
        point[0] < seen[0] || point[0] > seen[1] ? null : (
          <Handle
            key={index}
            x={xOf(point[0])}
            y={yOf(point[1])}
            isSelected={index === selected}
            color={null}
            label={TEXT.point(index + 1, curve.length)}
            value={point[0]}
            range={seen}
            text={TEXT.pointAt(props.what, numberText(point[1]), `${numberText(point[0])}${unit && ` ${unit}`}`)}
            onSelect={() => props.onSelect(index)}
            onKeyDown={(event) => onHandleKey(event, index)}
            onKeyUp={() => props.onSettle()}
            onGrab={(event) => {
              const { x, y } = inside(event);
              svg.current?.setPointerCapture(event.pointerId);
              drag.current = { index, x: x - xOf(point[0]), y: y - yOf(point[1]), seen };
            }}
          />
        ),
      )}
      {props.children}
    </svg>
  );
}

/** Removes a point, or adds one beside it. */
export function changePoints<P extends Point>(
  { latest, seen, onCurve, onSettle }: EditorOf<P>,
  what: "remove" | "insert",
  index: number,
): void {
  const curve = latest();
  if (what === "remove") onCurve(without(curve, index), Math.min(index, curve.length - 2));
  else {
    const added = withPointBeside(curve, index, seen);
    onCurve(added.curve, added.index);
  }
  onSettle();
}

interface EditorOf<P extends Point> {
  latest(): Curve<P>;
  readonly seen: Range;
  onCurve(curve: Curve<P>, index: number | null): void;
  onSettle(): void;
}

export interface HandleProps {
  readonly x: number;
  readonly y: number;
  readonly isSelected: boolean;
  readonly color: string | null;
  readonly label: string;
  readonly value: number;
  readonly range: Range;
  readonly text: string;
  onSelect(): void;
  onKeyDown(event: KeyboardEvent): void;
  onKeyUp(): void;
  onGrab(event: PointerEvent): void;
}

/** A point that can be focused, moved and removed. */
export function Handle(props: HandleProps) {
  const { x, y, isSelected, color, range, value } = props;
  return (
    <g
      class="look-handle"
      role="slider"
      tabindex={0}
      aria-label={props.label}
      aria-valuemin={Math.min(range[0], value)}
      aria-valuemax={Math.max(range[1], value)}
      aria-valuenow={value}
      aria-valuetext={props.text}
      aria-description={KEYS}
      data-selected={isSelected}
      transform={`translate(${px(x)} ${px(y)})`}
      onFocus={props.onSelect}
      onKeyDown={props.onKeyDown}
      onKeyUp={props.onKeyUp}
      onDblClick={(event) => event.stopPropagation()}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.stopPropagation();
        event.preventDefault();
        event.currentTarget.focus();
        props.onSelect();
        props.onGrab(event);
      }}
    >
      <title>{props.text}</title>
      <circle class="look-reach" r={REACH_PX} />
      {color === null ? (
        <circle class="look-dot" r={DOT_PX} />
      ) : (
        <path class="look-dot" d="M0 -10 L7 -2 V9 H-7 V-2 Z" style={{ fill: color }} />
      )}
    </g>
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

/** The width of an element in CSS pixels, kept up to date. */
export function useWidth<E extends Element>(): [{ current: E | null }, number] {
  const element = useRef<E>(null);
  const [width, setWidth] = useState(310);
  useEffect(() => {
    const seen = element.current;
    if (seen === null) return undefined;
    const observer = new ResizeObserver(([entry]) => {
      if (entry !== undefined && entry.contentRect.width > 0) setWidth(entry.contentRect.width);
    });
    observer.observe(seen);
    return () => observer.disconnect();
  }, []);
  return [element as { current: E | null }, width];
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

function px(value: number): string {
  return value.toFixed(2);
}
