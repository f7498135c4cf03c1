// Handles of the points of a curve along an axis of values: dragged by the pointer, edited by keys.

import { useEffect, useRef, useState } from "preact/hooks";
import { take } from "../handle.tsx";
import { keyStep } from "./axis.ts";
import { withMoved, withPointBeside, without, type Curve, type Edited, type Point, type Range } from "./curves.ts";

const KEYS = "Arrows move, Page up and down move far, Delete removes, Insert adds, Enter goes to the number";

/** Margins around the drawing, CSS pixels. */
export const MARGIN = { left: 34, right: 12, top: 12, bottom: 20 };
const DOT_PX = 6;
/** Half the side of the area of a point that pointers and fingers hit. */
const REACH_PX = 13;

/** A curve that is edited, and the editor's answers. */
export interface PointEditor<P extends Point> {
  readonly seen: Range;
  readonly unit: string;
  readonly curve: Curve<P>;
  /** Returns the curve as it is now: keys can come more often than the page is drawn. */
  latest(): Curve<P>;
  readonly selected: number | null;
  onSelect(index: number): void;
  onCurve(curve: Curve<P>, index: number | null): void;
  onSettle(): void;
  onShowPoints(): void;
  /** Called when the user wants to type the number of the selected point. */
  onType(): void;
}

/** The differences between kinds of points. */
interface HandleKind<P extends Point> {
  y(point: P): number;
  color(point: P): string | null;
  label(n: number, of: number): string;
  text(point: P): string;
  /** How far one press of an arrow moves a point up. */
  rise(point: P): number;
  /** The curve with a point added where the user clicked twice: at a value, `y` pixels below the top. */
  added(value: number, y: number): Edited<P>;
  /** The point dragged to a value, `y` pixels below the top. */
  dragged(point: P, value: number, y: number): P;
  /** The point moved by a key. */
  stepped(point: P, value: number, rise: number): P;
}

/** The handles of a curve, and the axis, measures and listeners of the drawing around them. */
export function useHandles<P extends Point>(editor: PointEditor<P>, kind: HandleKind<P>) {
  const { seen, curve, selected } = editor;
  const [svg, width] = useWidth<SVGSVGElement>();
  const drag = useRef<{ readonly index: number; readonly x: number; readonly y: number } | null>(null);
  const inner = width - MARGIN.left - MARGIN.right;
  const xOf = (value: number): number => MARGIN.left + ((value - seen[0]) / (seen[1] - seen[0])) * inner;
  const valueAt = (x: number): number => seen[0] + ((x - MARGIN.left) / inner) * (seen[1] - seen[0]);
  const inside = (event: MouseEvent): { x: number; y: number } => {
    const box = svg.current?.getBoundingClientRect();
    return { x: event.clientX - (box?.left ?? 0), y: event.clientY - (box?.top ?? 0) };
  };
  const move = (index: number, moved: (point: P) => P): void => {
    const latest = editor.latest();
    const point = latest[index];
    if (point !== undefined) editor.onCurve(withMoved(latest, index, moved(point)), index);
  };
  const onKeyDown = (event: KeyboardEvent, index: number): void => {
    const latest = editor.latest();
    const point = latest[index];
    if (point === undefined) return;
    const key = pointKey(event.key, event.shiftKey, seen, kind.rise(point));
    if (key === null || (key.does === "remove" && latest.length === 1)) return;
    if (key.does === "move") move(index, (point) => kind.stepped(point, key.value, key.rise));
    else if (key.does === "type") editor.onType();
    else changePoints(editor, key.does, index);
    take(event);
  };
  const listeners = {
    onDblClick: (event: MouseEvent): void => {
      const { x, y } = inside(event);
      const added = kind.added(valueAt(x), y);
      editor.onCurve(added.curve, added.index);
      editor.onSettle();
    },
    onPointerMove: (event: PointerEvent): void => {
      const begun = drag.current;
      const { x, y } = inside(event);
      if (begun !== null) move(begun.index, (point) => kind.dragged(point, valueAt(x - begun.x), y - begun.y));
    },
    onLostPointerCapture: (): void => {
      if (drag.current !== null) editor.onSettle();
      drag.current = null;
    },
  };
  const handles = curve.map((point, index) => {
    const [value = 0] = point;
    if (value < seen[0] || value > seen[1]) return null;
    const place = { x: xOf(value), y: kind.y(point) };
    return (
      <g
        key={index}
        class="look-handle"
        role="slider"
        tabindex={0}
        aria-label={kind.label(index + 1, curve.length)}
        aria-valuemin={seen[0]}
        aria-valuemax={seen[1]}
        aria-valuenow={value}
        aria-valuetext={kind.text(point)}
        aria-description={KEYS}
        data-selected={index === selected}
        transform={`translate(${px(place.x)} ${px(place.y)})`}
        onFocus={() => editor.onSelect(index)}
        onKeyDown={(event) => onKeyDown(event, index)}
        onKeyUp={() => editor.onSettle()}
        onDblClick={(event) => event.stopPropagation()}
        onPointerDown={(event) => {
          if (event.button !== 0) return;
          take(event);
          event.currentTarget.focus();
          editor.onSelect(index);
          svg.current?.setPointerCapture(event.pointerId);
          const { x, y } = inside(event);
          drag.current = { index, x: x - place.x, y: y - place.y };
        }}
      >
        <title>{kind.text(point)}</title>
        <circle class="look-reach" r={REACH_PX} />
        <Dot color={kind.color(point)} />
      </g>
    );
  });
  return { svg, width, inner, xOf, valueAt, inside, listeners, handles };
}

function Dot({ color }: { color: string | null }) {
  if (color === null) return <circle class="look-dot" r={DOT_PX} />;
  return <path class="look-dot" d="M0 -10 L7 -2 V9 H-7 V-2 Z" style={{ fill: color }} />;
}

/** Removes a point, or adds one beside it. */
export function changePoints<P extends Point>(
  { latest, seen, onCurve, onSettle }: Pick<PointEditor<P>, "latest" | "seen" | "onCurve" | "onSettle">,
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

type PointKey =
  | { readonly does: "move"; readonly value: number; readonly rise: number }
  | { readonly does: "remove" | "insert" | "type" };

/** The edit of a point that a key stands for: arrows move finely (with Shift more so), Page up and down coarsely; null
 * for other keys. `rise`: how much one press moves up or down. */
export function pointKey(key: string, isShifted: boolean, seen: Range, rise: number): PointKey | null {
  const share = isShifted ? 0.2 : 1;
  const fine = share * keyStep(seen, true);
  const coarse = keyStep(seen, false);
  const steps: Partial<Record<string, readonly [number, number]>> = {
    ArrowLeft: [-fine, 0],
    ArrowRight: [fine, 0],
    ArrowUp: [0, share * rise],
    ArrowDown: [0, -share * rise],
    PageDown: [-coarse, 0],
    PageUp: [coarse, 0],
    Home: [0, -1],
    End: [0, 1],
  };
  const step = steps[key];
  if (step !== undefined) return { does: "move", value: step[0], rise: step[1] };
  if (key === "Delete" || key === "Backspace") return { does: "remove" };
  if (key === "Insert") return { does: "insert" };
  return key === "Enter" ? { does: "type" } : null;
}

/** The width of an element in CSS pixels, kept up to date. */
function useWidth<E extends Element>(): [{ current: E | null }, number] {
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

/** Text of a length in a drawing. */
export function px(value: number): string {
  return value.toFixed(2);
}
