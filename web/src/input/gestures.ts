// Recognition of gestures from events of pointers, wheels and fingers. No DOM: events are plain objects with few fields.

/** Kinds of drags; button and modifier keys decide which. */
type DragKind = "main" | "pan" | "zoom" | "roll" | "window";

export type Gesture =
  | {
      readonly kind: "drag";
      readonly phase: "start" | "move" | "end";
      readonly what: DragKind;
      readonly x: number;
      readonly y: number;
      readonly dx: number;
      readonly dy: number;
    }
  | {
      readonly kind: "pinch";
      readonly phase: "move" | "end";
      /** The middle between the fingers; 0 at the end. */
      readonly x: number;
      readonly y: number;
      readonly dx: number;
      readonly dy: number;
      readonly factor: number;
      /** Radians, clockwise in the picture. */
      readonly angle: number;
    }
  | { readonly kind: "tap"; readonly x: number; readonly y: number; readonly ctrl: boolean; readonly double: boolean };

export interface PointerLike {
  readonly pointerId: number;
  readonly pointerType: string;
  readonly button: number;
  readonly shiftKey: boolean;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
  readonly timeStamp: number;
}

interface Place {
  x: number;
  y: number;
}

/** Largest movement of a tap, in pixels, and largest time between the taps of a double tap, in milliseconds. */
const TAP_PX = 4;
const DOUBLE_MS = 400;

export class Gestures {
  private readonly pointers = new Map<number, Place>();
  private what: DragKind = "main";
  private begun: Place = { x: 0, y: 0 };
  private isDragging = false;
  private isPinching = false;
  private lastTap = { at: -Infinity, x: 0, y: 0 };

  constructor(private readonly emit: (gesture: Gesture, timeStamp: number) => void) {}

  /** Whether a button or finger is down. */
  get isActive(): boolean {
    return this.pointers.size > 0;
  }

  down(event: PointerLike, x: number, y: number): void {
    if (this.pointers.size === 1 && event.pointerType === "touch" && this.isDragging) this.endDrag(event.timeStamp);
    this.pointers.set(event.pointerId, { x, y });
    if (this.pointers.size > 1) {
      this.isPinching = true;
      return;
    }
    this.what = kindOf(event);
    this.begun = { x, y };
    this.isDragging = false;
  }

  move(event: PointerLike, x: number, y: number): void {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    if (this.isPinching) {
      this.pinch(event, before, { x, y });
      return;
    }
    if (!this.isDragging && Math.hypot(x - this.begun.x, y - this.begun.y) < TAP_PX) return;
    const [dx, dy] = this.isDragging ? [x - before.x, y - before.y] : [x - this.begun.x, y - this.begun.y];
    if (!this.isDragging) {
      this.isDragging = true;
      const { x: x0, y: y0 } = this.begun;
      this.emit({ kind: "drag", phase: "start", what: this.what, x: x0, y: y0, dx: 0, dy: 0 }, event.timeStamp);
    }
    this.pointers.set(event.pointerId, { x, y });
    this.emit({ kind: "drag", phase: "move", what: this.what, x, y, dx, dy }, event.timeStamp);
  }

  up(event: PointerLike, x: number, y: number, isCancelled = false): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.isPinching) {
      if (this.pointers.size === 0) {
        this.isPinching = false;
        this.emit({ kind: "pinch", phase: "end", x: 0, y: 0, dx: 0, dy: 0, factor: 1, angle: 0 }, event.timeStamp);
      }
      return;
    }
    if (this.isDragging) {
      this.endDrag(event.timeStamp, x, y);
      return;
    }
    if (isCancelled || event.button > 0) return;
    const { at, x: x0, y: y0 } = this.lastTap;
    const double = event.timeStamp - at < DOUBLE_MS && Math.hypot(x - x0, y - y0) < 4 * TAP_PX;
    this.lastTap = { at: double ? -Infinity : event.timeStamp, x, y };
    this.emit({ kind: "tap", x, y, ctrl: event.ctrlKey || event.metaKey, double }, event.timeStamp);
  }

  private endDrag(at: number, x = this.begun.x, y = this.begun.y): void {
    this.isDragging = false;
    this.emit({ kind: "drag", phase: "end", what: this.what, x, y, dx: 0, dy: 0 }, at);
  }

  private pinch(event: PointerLike, before: Place, after: Place): void {
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, after);
    if (other === undefined) return;
    const [from, to] = [vector(other, before), vector(other, after)];
    const lengths = [Math.hypot(from.x, from.y), Math.hypot(to.x, to.y)] as const;
    const turn = Math.atan2(to.y, to.x) - Math.atan2(from.y, from.x);
    this.emit(
      {
        kind: "pinch",
        phase: "move",
        x: (after.x + other.x) / 2,
        y: (after.y + other.y) / 2,
        dx: (after.x - before.x) / 2,
        dy: (after.y - before.y) / 2,
        factor: lengths[0] > 0 ? lengths[1] / lengths[0] : 1,
        angle: Math.atan2(Math.sin(turn), Math.cos(turn)),
      },
      event.timeStamp,
    );
  }
}

function vector(from: Place, to: Place): Place {
  return { x: to.x - from.x, y: to.y - from.y };
}

function kindOf(event: PointerLike): DragKind {
  if (event.button === 1 || (event.button === 0 && event.shiftKey)) return "pan";
  if (event.button === 2) return "zoom";
  if (event.altKey) return "window";
  if (event.ctrlKey || event.metaKey) return "roll";
  return "main";
}

/** Factor by which the wheel magnifies: 15 % per notch of 100 pixels or 3 lines, at most 3 notches (or a page) an event. */
export function wheelFactor(deltaY: number, deltaMode: number): number {
  const pixels = deltaY * (deltaMode === 1 ? 33 : deltaMode === 2 ? 300 : 1);
  return Math.exp((-Math.min(Math.max(pixels, -300), 300) / 100) * Math.log(1.15));
}

/** Signed number of notches that the wheel turned, at least one. */
export function wheelSteps(deltaY: number, deltaMode: number): number {
  const pixels = deltaY * (deltaMode === 1 ? 33 : deltaMode === 2 ? 300 : 1);
  return Math.sign(pixels) * Math.max(1, Math.round(Math.abs(pixels) / 100));
}
