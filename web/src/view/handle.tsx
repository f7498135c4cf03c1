// Handles over the views: dragged by the pointer, moved by keys; sliders for those who do not see them.

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

/** A handle that is dragged, and moved by keys: a slider for those who do not see it. */
export function Handle(props: HandleProps) {
  const { label, text, value, range, x, y, color, round, onDrag, onKey, onEnd, onDouble } = props;
  const down = (event: PointerEvent): void => {
    event.stopPropagation();
    const element = event.currentTarget as SVGElement;
    element.setPointerCapture(event.pointerId);
    element.focus({ preventScroll: true });
    const box = element.ownerSVGElement?.getBoundingClientRect();
    let [px, py] = [event.clientX, event.clientY];
    const move = (moved: PointerEvent): void => {
      onDrag(moved.clientX - (box?.left ?? 0), moved.clientY - (box?.top ?? 0), moved.clientX - px, moved.clientY - py);
      [px, py] = [moved.clientX, moved.clientY];
    };
    const up = (): void => {
      element.removeEventListener("pointermove", move);
      element.removeEventListener("pointerup", up);
      element.removeEventListener("pointercancel", up);
      onEnd();
    };
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", up);
    element.addEventListener("pointercancel", up);
  };
  return (
    <g
      data-handle
      role="slider"
      tabindex={0}
      aria-label={label}
      aria-valuenow={Number(value.toFixed(3))}
      aria-valuemin={Number(range[0].toFixed(3))}
      aria-valuemax={Number(range[1].toFixed(3))}
      aria-valuetext={text}
      transform={`translate(${x} ${y})`}
      onPointerDown={down}
      onKeyDown={onKey}
      onKeyUp={onEnd}
      onDblClick={onDouble}
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
