// A slice: its gestures, wheel and keys; the picture follows them at once, until the session's next one comes.

import { useLayoutEffect, useRef } from "preact/hooks";

import type { Frame } from "../../engine/engine.ts";
import { add, scaled } from "../../input/camera.ts";
import type { Gesture } from "../../input/gestures.ts";
import type { Action } from "../../input/keys.ts";
import { set, type Operation } from "../../state/patch.ts";
import type { Pane, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { windowDrag } from "../look/window_drag.ts";
import type { CssSize, PartProps } from "../part.ts";
import { settleSoon } from "../scene_view.tsx";
import { Viewport, type Wheel } from "../viewport.tsx";
import { useDrawing } from "./drawing.ts";
import { newest, normalOf, sampleStep, stepped, transformOf, worldAt, type SliceFrame } from "./geometry.ts";
import { toggleMaximised } from "./maximise.ts";
import { centerOf, fitted, panned, TwoFingers, zoomedAbout } from "./moves.ts";
import { nameOf } from "./panes.ts";
import { probe } from "./probe.ts";
import { SlicePainter } from "./slice_painter.ts";
import { SliceOverlay } from "./slice_overlay.tsx";

/** Number of slices that a key with Shift, or PageUp, moves by; pixels that a key moves the picture by. */
const COARSE = 10;
const KEY_PX = 24;
const KEY_ZOOM = 1.1;
/** Pixels of a drag over which the width of a window grows e times, and over which its level moves by its width. */
const WINDOW_PX = 200;

/** A drag: the frame and the middle of the picture when it began, which hold until it ends. */
interface Press {
  readonly on: SliceFrame;
  readonly center: Vec3;
  readonly x: number;
  readonly y: number;
}

export function SlicePane(props: PartProps & { readonly pane: Pane }) {
  const { pane, store, ui, welcome } = props;
  const press = useRef<Press | null>(null);
  const fingers = useRef(new TwoFingers());
  const drawing = useDrawing(props);
  const painter = useRef(new SlicePainter());
  // After each change of the state, in the animation frame that draws it.
  useLayoutEffect(() => {
    if (ui.frames[pane] === painter.current.frame) painter.current.draw(store.state);
  });
  const slices = () => store.state.view.slices;
  const change = (operations: readonly Operation[], gesture?: string): void => {
    if (operations.length > 0) store.change(operations, gesture);
  };
  // Handlers take the newest frame, which may have come since this was drawn, as the newest state has it.
  const now = (size: CssSize): SliceFrame | null => {
    const frame = sliceFrame(ui.frames[pane], size);
    return frame === null ? null : newest(frame, store.state, pane, centerOf(store.state, welcome));
  };
  const step = (): number => sampleStep(welcome.volumes[0]?.affine ?? [], normalOf(store.state, pane));
  const scroll = (n: number, gesture: string): void => {
    const range = ui.frames[pane]?.slice?.range;
    if (range === undefined) return;
    change([set(stepped(store.state, pane, n * step(), range), "view", "slices", "crosshair")], gesture);
  };
  const window = (dx: number, dy: number): void => {
    const volume = welcome.volumes[0];
    const automatic = ui.frames[pane]?.slice?.window;
    // Channels have windows of their own, in their looks.
    if (automatic === null) windowDrag(props, dx, dy);
    const before = automatic && (slices().window ?? automatic);
    if (volume === undefined || !before) return;
    const span = volume.robust_range[1] - volume.robust_range[0] || 1;
    // By shares of the window, so that a narrow one is set as finely as a wide one: 140 px double its width.
    const width = Math.max(before[1] * Math.exp(dx / WINDOW_PX), span * 1e-4);
    change([set([before[0] - (dy / WINDOW_PX) * before[1], width], "view", "slices", "window")], "window");
  };
  const zoomAt = (size: CssSize, factor: number, x: number, y: number): void => {
    const on = now(size);
    if (on !== null) change(zoomedAbout(store.state, welcome, worldAt(on, x, y), factor), "slice zoom");
  };
  const panBy = (size: CssSize, dx: number, dy: number, gesture: string): void => {
    const on = now(size);
    if (on !== null) change(panned(on, centerOf(store.state, welcome), dx, dy, welcome), gesture);
  };

  const onTap = (gesture: Gesture & { kind: "tap" }, size: CssSize): void => {
    const on = now(size);
    if (on === null) return;
    if (drawing.isOn) drawing.onTap(on, gesture.x, gesture.y, gesture.double);
    else if (gesture.double) toggleMaximised(store, pane);
    else change([set(worldAt(on, gesture.x, gesture.y), "view", "slices", "crosshair")]);
  };

  const onDrag = (gesture: Gesture & { kind: "drag" }, size: CssSize): void => {
    const { phase, what, x, y } = gesture;
    if (phase === "start") {
      const on = now(size);
      press.current = on === null ? null : { on, center: centerOf(store.state, welcome), x, y };
    }
    const from = press.current;
    if (from === null) return;
    const isMain = what === "main" || what === "roll";
    if (isMain && drawing.isOn) drawing.onDrag(from.on, gesture);
    else if (phase === "end") store.settle();
    else if (what === "pan") change(panned(from.on, from.center, x - from.x, y - from.y, welcome), "slice pan");
    else if (phase === "start") return;
    else if (what === "window" || (isMain && ui.tool === "window")) window(gesture.dx, gesture.dy);
    else if (what === "zoom") zoomAt(size, Math.exp((-2 * gesture.dy) / size.height), from.x, from.y);
    else if (isMain) change([set(worldAt(from.on, x, y), "view", "slices", "crosshair")], "crosshair");
    if (phase === "end") press.current = null;
  };

  const onPinch = (gesture: Gesture & { kind: "pinch" }, size: CssSize): void => {
    if (gesture.phase === "end") {
      fingers.current.end();
      store.settle();
      return;
    }
    const recognised = fingers.current.moved(gesture.dx, gesture.dy, gesture.factor);
    if (recognised === null) return;
    if ("steps" in recognised) scroll(-recognised.steps, "touch slice");
    else {
      panBy(size, recognised.dx, recognised.dy, "slice pinch");
      zoomAt(size, recognised.factor, gesture.x, gesture.y);
    }
  };

  const onGesture = (gesture: Gesture, size: CssSize): void => {
    if (gesture.kind === "tap") onTap(gesture, size);
    else if (gesture.kind === "pinch") onPinch(gesture, size);
    else onDrag(gesture, size);
  };

  const onWheel = ({ factor, steps, ctrl, x, y }: Wheel, size: CssSize): void => {
    if (ctrl) zoomAt(size, factor, x, y);
    else scroll(-steps, "wheel slice");
    settleSoon(store);
  };

  const onAction = (action: Action, shift: boolean, size: CssSize): boolean => {
    const nudge = (right: number, down: number): boolean => {
      const on = now(size);
      if (on === null) return true;
      const moved = add(scaled(on.geometry.right, right * step()), scaled(on.geometry.down, down * step()));
      change([set(add(slices().crosshair, moved), "view", "slices", "crosshair")], "key crosshair");
      return true;
    };
    const magnify = (factor: number): boolean => {
      change(zoomedAbout(store.state, welcome, slices().crosshair, factor), "slice zoom");
      return true;
    };
    const pan = (dx: number, dy: number): boolean => {
      panBy(size, dx, dy, "key pan");
      return true;
    };
    switch (action) {
      case "slice-back": scroll(shift ? -COARSE : -1, "key slice"); return true;
      case "slice-on": scroll(shift ? COARSE : 1, "key slice"); return true;
      case "turn-left": return nudge(-1, 0);
      case "turn-right": return nudge(1, 0);
      case "turn-up": return nudge(0, -1);
      case "turn-down": return nudge(0, 1);
      case "pan-left": return pan(-KEY_PX, 0);
      case "pan-right": return pan(KEY_PX, 0);
      case "pan-up": return pan(0, -KEY_PX);
      case "pan-down": return pan(0, KEY_PX);
      case "zoom-in": return magnify(KEY_ZOOM);
      case "zoom-out": return magnify(1 / KEY_ZOOM);
      case "first-view":
      case "fit":
        change(fitted(store.state));
        return true;
      default: return false;
    }
  };

  const cutAt = ui.frames[pane]?.slice;
  return (
    <Viewport
      {...props}
      view={pane}
      label={WORDS.slices.pane(nameOf(props, pane), cutAt === undefined ? "" : shortNumber(cutAt.position, 4))}
      onGesture={onGesture}
      onAction={onAction}
      onWheel={onWheel}
      onHover={(place, size) => {
        const on = place === null ? null : now(size);
        drawing.onHover(on, place);
        probe(props, painter.current, on, place);
      }}
      onValues={(frame, canvas) => painter.current.take(frame, canvas, store.state)}
      transform={(frame, size) => {
        const [from, to] = [sliceFrame(frame, size), now(size)];
        return from === null || to === null ? "" : transformOf(from, to);
      }}
    >
      {(frame, size) => {
        const on = now(size);
        return on !== null && <SliceOverlay {...props} frame={frame} on={on} drawing={drawing.drawing} />;
      }}
    </Viewport>
  );
}

function sliceFrame(frame: Frame | undefined, size: CssSize): SliceFrame | null {
  if (frame?.slice === undefined || size.width === 0) return null;
  return { geometry: frame.slice, size, width: frame.width, height: frame.height };
}
