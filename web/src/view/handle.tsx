// Handles over the views: dragged by the pointer, moved by keys; sliders for those who do not see them.
// The view takes all events of the pointer, and passes a gesture on to the handle on which it began.

import type { Gesture } from "../input/gestures.ts";

/** Number of steps that PageUp and PageDown move by. */
const COARSE = 10;
const STEPS: Readonly<Record<string, number>> = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: COARSE,
  PageDown: -COARSE,
};

/** Number of steps that a key press stands for, which is then taken; undefined for other keys. */
export function stepOf(event: KeyboardEvent): number | undefined {
  const step = STEPS[event.key];
  if (step !== undefined) take(event);
  return step;
}

/** Keeps an event from its default action and from other listeners. */
export function take(event: Event): void {
  event.preventDefault();
  event.stopPropagation();
}

export interface HandleProps {
  readonly label: string;
  readonly text: string;
  readonly value: number;
  readonly range: readonly [number, number];
  readonly x: number;
  readonly y: number;
  readonly color: string;
  readonly round?: boolean;
  /** Called with the pointer's position, and its movement since the last call, in CSS pixels of the view. */
  readonly onDrag: (x: number, y: number, dx: number, dy: number) => void;
  readonly onKey: (event: KeyboardEvent) => void;
  readonly onEnd: () => void;
  readonly onDouble?: () => void;
}

/** An element that takes gestures. */
export interface Held {
  readonly element: SVGElement;
  /** Takes a gesture; undefined for those that are for the view. */
  readonly onGesture: (gesture: Gesture) => true | undefined;
}

const holders = new WeakMap<EventTarget, Held>();

/** Makes an element take gestures: a function for its `ref`. */
export function holding(onGesture: Held["onGesture"]): (element: SVGElement | null) => void {
  return (element) => {
    if (element !== null) holders.set(element, { element, onGesture });
  };
}

/** The element that takes a gesture that begins with this event; undefined where the view takes it. */
export function heldAt(event: Event): Held | undefined {
  return event.composedPath().flatMap((one) => holders.get(one) ?? [])[0];
}

/** A handle that is dragged, and moved by keys: a slider for those who do not see it. */
export function Handle(props: HandleProps) {
  const { label, text, value, range, x, y, color, round, onDrag, onKey, onEnd, onDouble } = props;
  const onGesture = (gesture: Gesture): true => {
    if (gesture.kind === "tap") {
      if (gesture.double) onDouble?.();
    } else if (gesture.phase === "end") onEnd();
    else if (gesture.kind === "drag" && gesture.phase === "move") onDrag(gesture.x, gesture.y, gesture.dx, gesture.dy);
    return true;
  };
  return (
    <g
      ref={holding(onGesture)}
      data-handle
      role="slider"
      tabindex={0}
      aria-label={label}
      aria-valuenow={Number(value.toFixed(3))}
      aria-valuemin={Number(range[0].toFixed(3))}
      aria-valuemax={Number(range[1].toFixed(3))}
      aria-valuetext={text}
      transform={`translate(${x} ${y})`}
      onKeyDown={onKey}
      onKeyUp={onEnd}
    >
      <circle r="13" fill="transparent" stroke="none" />
      {round ? (
        <circle r="5" fill="#000" stroke={color} stroke-width="2" />
      ) : (
        <rect x="-5" y="-5" width="10" height="10" fill={color} stroke="#000" stroke-width="1" />
      )}
    </g>
  );
}
