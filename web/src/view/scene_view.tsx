// The 3-D view: gestures, wheel and keys that move the camera, and the overlay of the picture.

import type { Frame, PickedValue, Problem, Questions } from "../engine/engine.ts";
import * as cameras from "../input/camera.ts";
import type { Gesture } from "../input/gestures.ts";
import type { Action } from "../input/keys.ts";
import { leveled, turnedUpright } from "../input/turntable.ts";
import { set } from "../state/patch.ts";
import type { Camera, Vec3 } from "../state/state.ts";
import type { Store } from "../state/store.ts";
import { placeText, sceneLabel, shortNumber } from "./descriptions.ts";
import { WORDS } from "../words.ts";
import { windowDrag } from "./look/window_drag.ts";
import { SceneOverlay } from "./overlay3d/scene_overlay.tsx";
import type { CssSize, PartProps, Tool } from "./part.ts";
import { RulerLine, useRuler } from "./scene_ruler.tsx";
import { crosshairAt } from "./slices/moves.ts";
import { Viewport } from "./viewport.tsx";

/** Pixels of a drag that a key press stands for, and its factor of zoom and angle of roll. */
const KEY_PX = 24;
const KEY_ZOOM = 1.1;
const KEY_ROLL = Math.PI / 36;
/** Milliseconds after which a turn of the wheel has ended. */
const WHEEL_MS = 150;

const VIEW_KEYS: Partial<Record<Action, string>> = {
  "view-front": "front",
  "view-back": "back",
  "view-left": "left",
  "view-right": "right",
  "view-top": "top",
  "view-bottom": "bottom",
};

export function SceneView(props: PartProps) {
  const { store, ui, welcome } = props;
  const camera = (): Camera => store.state.camera;
  const move = (next: Camera, gesture: string): void => {
    ui.camera.stop();
    store.change([set(next, "camera")], gesture);
  };
  const isFree = (): boolean => store.state.view.interface.turning === "trackball";
  const turned = (dx: number, dy: number, { height }: CssSize): Camera =>
    isFree() ? cameras.turned(camera(), dx, dy, height) : turnedUpright(camera(), dx, dy, height, welcome.upright);

  const ruler = useRuler(props);
  const onGesture = (gesture: Gesture, size: CssSize): void => {
    if (gesture.kind === "drag" && gesture.what === "main" && isMeasuring(ui.tool)) {
      ruler.onDrag(gesture, size);
      return;
    }
    if (gesture.kind === "tap") {
      if (gesture.ctrl || isMeasuring(ui.tool)) void pick(props, gesture.x / size.width, gesture.y / size.height, size);
      return;
    }
    if (gesture.phase === "end") {
      store.settle();
      return;
    }
    if (gesture.kind === "pinch") {
      const { x, y, dx, dy, factor, angle } = gesture;
      const moved = cameras.zoomedAt(cameras.panned(camera(), dx, dy, size.height), size, factor, x, y);
      // Fingers turn a little in every pinch, which would tip what is upright.
      move(isFree() ? cameras.rolled(moved, angle) : moved, "pinch");
      return;
    }
    if (gesture.phase === "start") return;
    const { what, dx, dy } = gesture;
    if (what === "window" || (what === "main" && ui.tool === "window")) windowDrag(props, dx, dy);
    else if (what === "pan") move(cameras.panned(camera(), dx, dy, size.height), "pan");
    else if (what === "zoom") move(cameras.zoomed(camera(), Math.exp((-2 * dy) / size.height)), "zoom");
    else if (what === "roll") move(cameras.rolled(camera(), (Math.PI * dx) / size.width), "roll");
    else move(turned(dx, dy, size), "turn");
  };

  const onAction = (action: Action, _shift: boolean, size: CssSize): boolean => {
    const pan = (dx: number, dy: number): void => move(cameras.panned(camera(), dx, dy, size.height), "key pan");
    const turn = (dx: number, dy: number): void => move(turned(dx, dy, size), "key turn");
    const view = VIEW_KEYS[action];
    if (view !== undefined) {
      const next = welcome.standard_views[view];
      if (next !== undefined) showFrom(props, next);
      return true;
    }
    switch (action) {
      case "turn-left": turn(-KEY_PX, 0); return true;
      case "turn-right": turn(KEY_PX, 0); return true;
      case "turn-up": turn(0, -KEY_PX); return true;
      case "turn-down": turn(0, KEY_PX); return true;
      case "pan-left": pan(-KEY_PX, 0); return true;
      case "pan-right": pan(KEY_PX, 0); return true;
      case "pan-up": pan(0, -KEY_PX); return true;
      case "pan-down": pan(0, KEY_PX); return true;
      case "zoom-in": move(cameras.zoomed(camera(), KEY_ZOOM), "key zoom"); return true;
      case "zoom-out": move(cameras.zoomed(camera(), 1 / KEY_ZOOM), "key zoom"); return true;
      case "roll-left": move(cameras.rolled(camera(), -KEY_ROLL), "key roll"); return true;
      case "roll-right": move(cameras.rolled(camera(), KEY_ROLL), "key roll"); return true;
      case "level": ui.camera.to(leveled(camera(), welcome.upright)); return true;
      case "fit": fit(props); return true;
      case "first-view": void ui.camera.showFirst(); return true;
      default: return false;
    }
  };

  return (
    <Viewport
      {...props}
      view="3d"
      label={sceneLabel(store.state)}
      onGesture={onGesture}
      onAction={onAction}
      onWheel={({ factor, x, y }, size) => {
        move(cameras.zoomedAt(camera(), size, factor, x, y), "wheel");
        settleSoon(store);
      }}
      onResize={(size) => void ui.camera.resized(size)}
      onHover={(place, size) => ui.probe(place && (() => textAt(props, place, size)))}
      transform={(frame, size) => instant(frame, camera(), size)}
    >
      {(frame, size) => (
        <>
          <SceneOverlay {...props} frame={frame} size={size} />
          {ruler.line !== null && <RulerLine line={ruler.line} />}
        </>
      )}
    </Viewport>
  );
}

/** Frames what is seen, from the same direction. */
export function fit({ store, ui }: PartProps): void {
  void ui.camera.show(store.state.camera);
}

/** Frames what is seen from the direction of another camera, with the lens of the one now. */
export function showFrom({ store, ui }: PartProps, target: Camera): void {
  void ui.camera.show(cameras.withLens(target, store.state.camera.view_angle));
}

/** Timers that end turns of the wheel, which have no end of their own: each settles a while after the last notch. */
const wheelTimers = new WeakMap<Store, ReturnType<typeof setTimeout>>();
export function settleSoon(store: Store): void {
  clearTimeout(wheelTimers.get(store));
  wheelTimers.set(store, setTimeout(() => store.settle(), WHEEL_MS));
}

const placed = (x: number, y: number, { width, height }: CssSize) => ({ x, y, width: Math.round(width), height: Math.round(height) });

/** The shape under the pointer, else the values of the layers, and the label. */
async function textAt(props: PartProps, place: Place, size: CssSize): Promise<string> {
  const shape = props.store.state.geometry.length > 0 ? await shapeAt(props, place, size) : "";
  return shape !== "" ? shape : valuesText(await props.engine.ask("pick", placed(place.x / size.width, place.y / size.height, size)), props);
}

function valuesText({ point, values, label }: Questions["pick"]["answer"], { welcome }: PartProps): string {
  if (point === null || values.length === 0) return "";
  const text = ({ name, value, unit }: PickedValue): string =>
    WORDS.scene.valueOf(name, value === null ? WORDS.scene.unknown : `${shortNumber(value, 4)} ${unit}`.trim()).trim();
  const told = [...values.map(text), ...(label === null ? [] : [WORDS.slices.label(label)])];
  return WORDS.slices.at(told.join(", "), placeText(point, welcome));
}

async function shapeAt({ engine, welcome }: PartProps, { x, y }: Place, size: CssSize): Promise<string> {
  const { shape } = await engine.ask("shape", placed(x / size.width, y / size.height, size));
  return shape === null ? "" : WORDS.slices.at(shape.text, placeText(shape.point, welcome));
}

const isMeasuring = (tool: Tool): boolean => tool === "distance" || tool === "angle";

/** Picks the world point seen at a place: the crosshair moves there, or the tool in use gets a point. False without one. */
export async function pick(props: PartProps, x: number, y: number, size: CssSize): Promise<boolean> {
  const { engine, store, ui } = props;
  try {
    const answer = await engine.ask("pick", placed(x, y, size));
    const { point } = answer;
    if (point === null) ui.announce(WORDS.scene.nothingThere);
    else if (isMeasuring(ui.tool)) ui.addPoint(point);
    else store.change(crosshairAt(store.state, point));
    const text = valuesText(answer, props);
    if (text !== "") ui.tell(text);
    return point !== null;
  } catch (problem) {
    ui.problem(problem as Problem);
    return false;
  }
}

/** CSS transform of a frame to the newest camera: exact where the cameras differ only in position, scale and roll. */
export function instant(frame: Frame, camera: Camera, size: CssSize): string {
  const before = frame.camera;
  if (before === undefined || before === camera) return "";
  const [old, now] = [cameras.axesOf(before), cameras.axesOf(camera)];
  if (cameras.dot(old.back, now.back) < 1 - 1e-9 || before.view_angle !== camera.view_angle) return "";
  const at = (seen: Camera, point: Vec3): Place | null => cameras.project(seen, size, point);
  const beside = cameras.add(before.focal_point, old.right);
  const [a, b] = [at(before, before.focal_point), at(before, beside)];
  const [A, B] = [at(camera, before.focal_point), at(camera, beside)];
  if (a === null || b === null || A === null || B === null) return "";
  // A similarity x -> M x + t with M = [p -q; q p], which two points and their images determine.
  const [dx, dy, DX, DY] = [b.x - a.x, b.y - a.y, B.x - A.x, B.y - A.y];
  const square = dx * dx + dy * dy;
  const [p, q] = [(DX * dx + DY * dy) / square, (DY * dx - DX * dy) / square];
  const [tx, ty] = [A.x - p * a.x + q * a.y, A.y - q * a.x - p * a.y];
  const numbers = [p, q, -q, p, tx, ty].map((value) => value.toFixed(6));
  return numbers.join() === IDENTITY ? "" : `matrix(${numbers.join()})`;
}

interface Place {
  readonly x: number;
  readonly y: number;
}
const IDENTITY = "1.000000,0.000000,-0.000000,1.000000,0.000000,0.000000";
