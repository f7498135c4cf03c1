// A view: the canvas that frames are drawn on, its overlay, and the events of pointers and keys on it.
// Gestures are passed on; the parts that place a viewport know what they mean in space or on a slice.

import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef, useState } from "preact/hooks";

import type { Frame, Problem } from "../engine/engine.ts";
import { Gestures, wheelFactor, wheelSteps, type Gesture } from "../input/gestures.ts";
import { actionOf, keyName, type Action } from "../input/keys.ts";
import type { ViewName } from "../state/state.ts";
import { WORDS } from "../words.ts";
import { heldAt, type Held } from "./handle.tsx";
import { Refining } from "./liveness.tsx";
import type { CssSize, PartProps } from "./part.ts";

/** A turn of the wheel at a place of the view. */
export interface Wheel {
  readonly factor: number;
  readonly steps: number;
  readonly ctrl: boolean;
  readonly x: number;
  readonly y: number;
}

/** Whole numbers of device pixels. */
export interface PixelSize {
  readonly width: number;
  readonly height: number;
}

interface ViewportHandlers {
  /** Called with drags, pinches and taps; `size`: of the view, CSS pixels. */
  readonly onGesture: (gesture: Gesture, size: CssSize) => void;
  readonly onWheel: (wheel: Wheel, size: CssSize) => void;
  /** Called with the action of a key; returns whether the key was for this view. */
  readonly onAction: (action: Action, shift: boolean, size: CssSize) => boolean;
  /** Called with the pointer's position, or null when it leaves. */
  readonly onHover?: (place: { readonly x: number; readonly y: number } | null, size: CssSize) => void;
  /** Called with the size of the picture, in device pixels, when the view is shown first, and when it was resized. */
  readonly onResize?: (size: PixelSize) => void;
  /** Draws a frame of values into the canvas; such frames come where it is given. */
  readonly onValues?: (frame: Frame, canvas: HTMLCanvasElement) => Promise<void>;
  /** CSS transform of the frame on the screen until the next one comes. */
  readonly transform?: (frame: Frame, size: CssSize) => string;
}

interface ViewportProps extends PartProps, ViewportHandlers {
  readonly view: ViewName;
  /** Description of the picture, for screen readers. */
  readonly label: string;
  readonly children?: (frame: Frame, size: CssSize) => ComponentChildren;
}

/** Milliseconds for which the size must not change before a picture is asked for. */
const RESIZED_MS = 60;

export function Viewport(props: ViewportProps) {
  const { view, store, ui, label, children, transform } = props;
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const [size, setSize] = useState<CssSize>({ width: 0, height: 0 });
  const [hint, setHint] = useState(false);
  const latest = useRef(props);
  latest.current = props;
  const sizeNow = useRef(size);
  sizeNow.current = size;
  const frame = ui.frames[view];

  useSize(box, latest, setSize);
  useFrames(canvas, latest);

  useLayoutEffect(() => {
    const element = box.current;
    if (element === null) return undefined;
    const noted = (at: number, act: () => void): void => {
      const before = store.seq;
      act();
      if (store.seq !== before) ui.statistics.event(store.seq, at);
    };
    // What is pressed, a handle or the view itself, gets the gesture up to its end.
    let held: Held | undefined;
    const gestures = new Gestures((gesture, at) =>
      noted(at, () => held?.onGesture(gesture) ?? latest.current.onGesture(gesture, sizeNow.current)),
    );
    const place = (event: MouseEvent): [number, number] => {
      const { left, top } = element.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    const down = (event: PointerEvent): void => {
      if (!gestures.isActive) held = event.button === 0 ? heldAt(event) : undefined;
      const focused = held !== undefined && held.element.tabIndex >= 0 ? held.element : element;
      focused.focus({ preventScroll: true });
      ui.views.use(view);
      element.setPointerCapture(event.pointerId);
      gestures.down(event, ...place(event));
    };
    const move = (event: PointerEvent): void => {
      // Every move is passed on at once, so that what is dragged does not lag.
      if (gestures.isActive) gestures.move(event, ...place(event));
      else {
        const [x, y] = place(event);
        latest.current.onHover?.({ x, y }, sizeNow.current);
      }
    };
    const up = (event: PointerEvent): void => gestures.up(event, ...place(event));
    const cancel = (event: PointerEvent): void => gestures.up(event, ...place(event), true);
    const leave = (): void => latest.current.onHover?.(null, sizeNow.current);
    const wheel = (event: WheelEvent): void => {
      // In a notebook the wheel scrolls the page, unless the viewer has the focus.
      const root = element.getRootNode() as Document | ShadowRoot;
      const isFocused = element.contains(root.activeElement);
      if (ui.host === "widget" && !isFocused && !event.ctrlKey) {
        setHint(true);
        return;
      }
      event.preventDefault();
      setHint(false);
      const { deltaY, deltaMode } = event;
      const [x, y] = place(event);
      const what = { factor: wheelFactor(deltaY, deltaMode), steps: wheelSteps(deltaY, deltaMode), ctrl: event.ctrlKey, x, y };
      noted(event.timeStamp, () => latest.current.onWheel(what, sizeNow.current));
    };
    const key = (event: KeyboardEvent): void => {
      const action = actionOf(keyName(event));
      if (action === undefined || event.defaultPrevented) return;
      noted(event.timeStamp, () => {
        if (latest.current.onAction(action, event.shiftKey, sizeNow.current)) {
          event.preventDefault();
          event.stopPropagation();
        }
      });
    };
    const focus = (): void => ui.views.use(view);
    const keyUp = (): void => store.settle();
    const menu = (event: Event): void => event.preventDefault();
    const stop = new AbortController();
    const listeners = {
      pointerdown: down,
      pointermove: move,
      pointerup: up,
      pointercancel: cancel,
      pointerleave: leave,
      wheel,
      keydown: key,
      focusin: focus,
      keyup: keyUp,
      contextmenu: menu,
    };
    for (const [name, listener] of Object.entries(listeners)) {
      element.addEventListener(name, listener as EventListener, { passive: false, signal: stop.signal });
    }
    const remove = ui.views.add(view, key);
    return () => {
      stop.abort();
      remove();
    };
  }, []);

  const moved = frame !== undefined && transform !== undefined && size.width > 0 ? transform(frame, size) : "";
  return (
    <div
      class="viewport"
      ref={box}
      tabIndex={0}
      role="group"
      aria-label={view === "3d" ? "3-D picture" : `Slice, ${view}`}
      data-view={view}
      data-tool={ui.tool}
      onPointerDown={() => setHint(false)}
    >
      <canvas ref={canvas} role="img" aria-label={label} style={{ transform: moved }} />
      {frame !== undefined && size.width > 0 && children?.(frame, size)}
      <Refining engine={props.engine} view={view} />
      {hint && <p class="hint">{WORDS.scene.wheelHint}</p>}
    </div>
  );
}

/**
 * Sends the engine how many pixels the view has, and that it is not shown where it is not. With the layout, since a
 * later effect of a view that has gone by then would hide the one that took its place.
 */
function useSize(
  box: { current: HTMLDivElement | null },
  latest: { current: ViewportProps },
  setSize: (size: CssSize) => void,
): void {
  useLayoutEffect(() => {
    const element = box.current;
    if (element === null) return undefined;
    const { engine, view } = latest.current;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let pixels: { width: number; height: number } | null = null;
    let isSeen = true;
    const ask = (): void => {
      const shown = isSeen && !document.hidden ? pixels : null;
      engine.show(view, shown);
      if (shown !== null) latest.current.onResize?.(shown);
    };
    const resized = new ResizeObserver(([entry]) => {
      if (entry === undefined) return;
      const { width, height } = entry.contentRect;
      const ratio = window.devicePixelRatio || 1;
      const exact = entry.devicePixelContentBoxSize?.[0];
      const [w, h] = exact ? [exact.inlineSize, exact.blockSize] : [width * ratio, height * ratio];
      const isFirst = pixels === null;
      pixels = w >= 1 && h >= 1 ? { width: Math.round(w), height: Math.round(h) } : null;
      setSize({ width, height });
      clearTimeout(timer);
      if (isFirst) ask();
      else timer = setTimeout(ask, RESIZED_MS);
    });
    try {
      resized.observe(element, { box: "device-pixel-content-box" });
    } catch {
      resized.observe(element);
    }
    const seen = new IntersectionObserver(([entry]) => {
      if (entry === undefined || entry.isIntersecting === isSeen) return;
      isSeen = entry.isIntersecting;
      ask();
    });
    seen.observe(element);
    document.addEventListener("visibilitychange", ask);
    return () => {
      clearTimeout(timer);
      resized.disconnect();
      seen.disconnect();
      document.removeEventListener("visibilitychange", ask);
      engine.show(view, null);
    };
  }, []);
}

/** Draws the frames that come, the newest alone where several wait. */
function useFrames(canvas: { current: HTMLCanvasElement | null }, latest: { current: ViewportProps }): void {
  useLayoutEffect(() => {
    const { engine, view } = latest.current;
    let newest: Frame | null = null;
    let isDecoding = false;
    let isGone = false;
    const next = async (): Promise<void> => {
      if (isDecoding) return;
      isDecoding = true;
      while (newest !== null && !isGone) {
        const frame: Frame = newest;
        newest = null;
        try {
          if (frame.format === "values") {
            if (canvas.current !== null) await latest.current.onValues?.(frame, canvas.current);
            if (canvas.current !== null) noted(canvas.current, frame);
          } else {
            const picture = await decoded(frame);
            if (!isGone && canvas.current !== null) drawn(canvas.current, picture, frame);
            picture.close();
          }
          latest.current.ui.frameShown(frame);
        } catch (problem) {
          latest.current.ui.problem(problem as Problem);
        } finally {
          engine.shown(frame);
        }
      }
      isDecoding = false;
    };
    const stop = engine.onFrame((frame) => {
      if (frame.view !== view) return;
      // Frames that were not drawn in time are left out.
      if (newest !== null) engine.shown(newest);
      newest = frame;
      void next();
    });
    return () => {
      isGone = true;
      stop();
    };
  }, []);
}

function decoded(frame: Frame): Promise<ImageBitmap> {
  const blob = new Blob([frame.bytes], { type: `image/${frame.format}` });
  return createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
}

function drawn(canvas: HTMLCanvasElement, picture: ImageBitmap, frame: Frame): void {
  const scale = Number(frame.settings["scale"] ?? 1);
  const [width, height] = [Math.round(frame.width / scale), Math.round(frame.height / scale)];
  if (frame.at_rest || Math.abs(canvas.width - width) > 2 || Math.abs(canvas.height - height) > 2) {
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }
  const context = canvas.getContext("2d");
  if (context === null) return;
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, 0, canvas.width, canvas.height);
  noted(canvas, frame);
}

/** Notes on the canvas what it shows, for tests. */
function noted(canvas: HTMLCanvasElement, frame: Frame): void {
  canvas.dataset["seq"] = String(frame.seq);
  canvas.dataset["atRest"] = String(frame.at_rest);
}
