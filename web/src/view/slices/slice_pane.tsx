// A slice: crosshair, scrolling, window and level, tilting, letters, scale bar, values under the pointer.

import type { Frame } from "../../engine/engine.ts";
import { add, dot, scaled } from "../../input/camera.ts";
import type { Gesture } from "../../input/gestures.ts";
import type { Action } from "../../input/keys.ts";
import { set } from "../../state/patch.ts";
import type { Pane, Vec3 } from "../../state/state.ts";
import { placeText, shortNumber } from "../descriptions.ts";
import { Handle, stepOf } from "../handle.tsx";
import { CropOnSlice } from "../overlay3d/crop_on_slice.tsx";
import type { CssSize, PartProps } from "../part.ts";
import { settleSoon } from "../scene_view.tsx";
import { Viewport } from "../viewport.tsx";
import {
  barLength, lineOf, normalOf, othersOf, placeOf, sampleStep, stepped, tilted, worldAt, type SliceFrame,
} from "./geometry.ts";
import { MeasuresOnSlice } from "./measures.tsx";

export const PANE_COLORS: Readonly<Record<Pane, string>> = { z: "#ff6b6b", y: "#6bd46b", x: "#6ba8ff" };
/** Names of planes: radiology's for bodies, else the axis across the plane. */
const BODY: Readonly<Record<Pane, string>> = { z: "Axial", y: "Coronal", x: "Sagittal" };
export const nameOf = ({ welcome }: Pick<PartProps, "welcome">, pane: Pane): string => (welcome.volumes[0]?.is_anatomical ? BODY[pane] : pane);
/** Number of slices that a key with Shift, or PageUp, moves by. */
const COARSE = 10;

export function SlicePane(props: PartProps & { readonly pane: Pane }) {
  const { pane, store, ui, welcome } = props;
  // Handlers take the newest frame, which may have come since this was drawn.
  const frame = (): Frame | undefined => ui.frames[pane];
  const slices = () => store.state.view.slices;
  const step = (): number => sampleStep(welcome.volumes[0]?.affine ?? [], normalOf(store.state, pane));
  const scroll = (n: number, gesture: string): void => {
    const range = frame()?.slice?.range;
    if (range === undefined) return;
    store.change([set(stepped(store.state, pane, n * step(), range), "view", "slices", "crosshair")], gesture);
  };
  const window = (dx: number, dy: number, size: CssSize): void => {
    const volume = welcome.volumes[0];
    const now = slices().window ?? frame()?.slice?.window;
    if (volume === undefined || !now) return;
    const span = volume.robust_range[1] - volume.robust_range[0] || 1;
    const width = Math.max(now[1] + (dx / size.width) * span, span * 1e-4);
    store.change([set([now[0] - (dy / size.height) * span, width], "view", "slices", "window")], "window");
  };
  const moveTo = (x: number, y: number, size: CssSize, gesture?: string): void => {
    const on = sliceFrame(frame(), size);
    if (on !== null) store.change([set(worldAt(on, x, y), "view", "slices", "crosshair")], gesture);
  };
  const zoom = (factor: number): void => {
    const next = Math.min(Math.max(slices().zoom * factor, 0.1), 100);
    store.change([set(next, "view", "slices", "zoom")], "slice zoom");
  };

  const onGesture = (gesture: Gesture, size: CssSize): void => {
    if (gesture.kind === "tap") {
      const on = sliceFrame(frame(), size);
      if ((ui.tool === "distance" || ui.tool === "angle") && on !== null) ui.addPoint(worldAt(on, gesture.x, gesture.y));
      else if (gesture.double && slices().window !== undefined) store.change([{ op: "remove", path: "/view/slices/window" }]);
      else moveTo(gesture.x, gesture.y, size);
      return;
    }
    if (gesture.phase === "end") store.settle();
    else if (gesture.kind === "pinch") zoom(gesture.factor);
    else if (gesture.phase === "start") return;
    else if (gesture.what === "window" || (gesture.what === "main" && ui.tool === "window")) {
      window(gesture.dx, gesture.dy, size);
    } else if (gesture.what === "zoom") zoom(Math.exp((-2 * gesture.dy) / size.height));
    else if (gesture.what === "main" || gesture.what === "pan") moveTo(gesture.x, gesture.y, size, "crosshair");
  };

  const onAction = (action: Action, shift: boolean, size: CssSize): boolean => {
    const on = sliceFrame(frame(), size);
    const nudge = (right: number, down: number): boolean => {
      if (on === null) return true;
      const { geometry } = on;
      const moved = add(scaled(geometry.right, right * step()), scaled(geometry.down, down * step()));
      store.change([set(add(slices().crosshair, moved), "view", "slices", "crosshair")], "key crosshair");
      return true;
    };
    switch (action) {
      case "slice-back": scroll(shift ? -COARSE : -1, "key slice"); return true;
      case "slice-on": scroll(shift ? COARSE : 1, "key slice"); return true;
      case "turn-left": return nudge(-1, 0);
      case "turn-right": return nudge(1, 0);
      case "turn-up": return nudge(0, -1);
      case "turn-down": return nudge(0, 1);
      case "zoom-in": zoom(1.1); return true;
      case "zoom-out": zoom(1 / 1.1); return true;
      case "first-view":
      case "fit":
        store.change([set(1, "view", "slices", "zoom")]);
        return true;
      default: return false;
    }
  };

  const cutAt = frame()?.slice;
  const position = cutAt === undefined ? "" : shortNumber(cutAt.position, 4);
  return (
    <Viewport
      {...props}
      view={pane}
      label={`${nameOf(props, pane)} slice at ${position}`}
      onGesture={onGesture}
      onAction={onAction}
      onWheel={({ factor, steps, ctrl }) => {
        if (ctrl) zoom(factor);
        else scroll(-steps, "wheel slice");
        settleSoon(store);
      }}
      onHover={(place, size) => probe(props, place === null ? null : sliceFrame(frame(), size), place)}
    >
      {(shown, size) => <SliceOverlay {...props} frame={shown} size={size} />}
    </Viewport>
  );
}

export function sliceFrame(frame: Frame | undefined, size: CssSize): SliceFrame | null {
  if (frame?.slice === undefined || size.width === 0) return null;
  return { geometry: frame.slice, size, width: frame.width, height: frame.height };
}

function SliceOverlay(props: PartProps & { pane: Pane; frame: Frame; size: CssSize }) {
  const { pane, frame, size, store, welcome } = props;
  const { slices, overlays } = store.state.view;
  const on = sliceFrame(frame, size);
  if (on === null) return null;
  const { geometry } = on;
  const letters = geometry.letters;
  const unit = welcome.volumes[0]?.unit ?? "units";
  const perCss = (geometry.pixel * frame.width) / size.width;
  const bar = barLength(perCss * size.width * 0.3);
  const [level, width] = slices.window ?? geometry.window ?? [0, 0];
  const isTilted = slices.normals?.[pane] !== undefined;
  return (
    <>
      <svg class="over" aria-hidden={false}>
        {overlays.crosshair && othersOf(pane).map((other) => <CrosshairLine key={other} {...props} on={on} other={other} />)}
        {overlays.crop_box && <CropOnSlice {...props} on={on} />}
        <MeasuresOnSlice {...props} on={on} />
        {overlays.letters && letters !== null && (
          <g aria-hidden="true" text-anchor="middle">
            <text class="at-left" x={14} y={size.height / 2}>{letters.left}</text>
            <text x={size.width - 14} y={size.height / 2}>{letters.right}</text>
            <text class="at-top" x={size.width / 2} y={18}>{letters.top}</text>
            <text class="at-bottom" x={size.width / 2} y={size.height - 8}>{letters.bottom}</text>
          </g>
        )}
        {overlays.scale_bar && (
          <g aria-hidden="true" class="at-corner">
            <path d={`M12 ${size.height - 14}h${bar / perCss}`} stroke="#000" stroke-width="5" />
            <path d={`M12 ${size.height - 14}h${bar / perCss}`} stroke="#fff" stroke-width="2.5" />
            <text x={12} y={size.height - 20}>{`${bar} ${unit}`}</text>
          </g>
        )}
      </svg>
      <div class="corner" style={{ color: PANE_COLORS[pane] }}>
        {`${nameOf(props, pane)}${isTilted ? ", tilted" : ""}\n${shortNumber(geometry.position, 4)} ${unit}`}
        {slices.thickness > 0 ? `\n${slices.slab} of ${shortNumber(slices.thickness)} ${unit}` : ""}
      </div>
      {geometry.window && (
        <div class="corner right">{`L ${shortNumber(level, 4)}\nW ${shortNumber(width, 4)}`}</div>
      )}
    </>
  );
}

function CrosshairLine(props: PartProps & { pane: Pane; on: SliceFrame; other: Pane }) {
  const { store, on, other, welcome } = props;
  const { size } = on;
  const normal = normalOf(store.state, other);
  const line = lineOf(on, normal);
  if (line === null) return null;
  const at = placeOf(on, store.state.view.slices.crosshair);
  const reach = size.width + size.height;
  const color = PANE_COLORS[other];
  // The handle for tilting lies near the edge of the view.
  const far = Math.min(size.width, size.height) * 0.42;
  const position = dot(normal, store.state.view.slices.crosshair);
  const step = sampleStep(welcome.volumes[0]?.affine ?? [], normal);
  const range = props.ui.frames[other]?.slice?.range ?? rangeOf(welcome.bounds, normal);
  const move = (distance: number, gesture: string): void =>
    store.change([set(stepped(store.state, other, distance, range), "view", "slices", "crosshair")], gesture);
  const keys = (event: KeyboardEvent): void => {
    const n = stepOf(event);
    if (n === undefined) return;
    move(n * step, "key plane");
  };
  const tilt = (x: number, y: number): void =>
    store.change([tiltTo(store, other, tilted(on, normalOf(store.state, other), x - at.x, y - at.y))], "tilt");
  const tiltKeys = (event: KeyboardEvent): void => {
    const n = stepOf(event);
    if (n === undefined) return;
    const angle = Math.atan2(line.dy, line.dx) + (n * Math.PI) / 180;
    store.change([tiltTo(store, other, tilted(on, normal, Math.cos(angle), Math.sin(angle)))], "key tilt");
  };
  return (
    <g stroke={color} fill="none">
      <path
        d={`M${at.x - line.dx * reach} ${at.y - line.dy * reach}L${at.x + line.dx * reach} ${at.y + line.dy * reach}`}
        stroke-width="1.2"
        opacity="0.85"
      />
      <Handle
        label={`${nameOf(props, other)} plane`}
        text={`${nameOf(props, other)} plane at ${shortNumber(position, 4)}`}
        value={position}
        range={range}
        x={at.x - line.dx * far * 0.55}
        y={at.y - line.dy * far * 0.55}
        color={color}
        onDrag={(_x, _y, dx, dy) => {
          // The plane moves by the part of the drag that lies along its normal.
          const { geometry } = on;
          const per = (geometry.pixel * on.width) / size.width;
          const way = add(scaled(geometry.right, dx * per), scaled(geometry.down, dy * per));
          move(dot(way, normal), "drag plane");
        }}
        onKey={keys}
        onEnd={() => store.settle()}
      />
      <Handle
        label={`Tilt the ${nameOf(props, other)} plane`}
        text={`Tilt of the ${nameOf(props, other)} plane`}
        value={(Math.atan2(line.dy, line.dx) * 180) / Math.PI}
        range={[-180, 180]}
        x={at.x + line.dx * far}
        y={at.y + line.dy * far}
        color={color}
        round
        onDrag={(x, y) => tilt(x, y)}
        onKey={tiltKeys}
        onEnd={() => store.settle()}
      />
    </g>
  );
}

function tiltTo(store: PartProps["store"], pane: Pane, normal: Vec3) {
  return set({ ...store.state.view.slices.normals, [pane]: normal }, "view", "slices", "normals");
}

function rangeOf([lower, upper]: readonly [Vec3, Vec3], normal: Vec3): readonly [number, number] {
  const ends = [0, 1, 2].map((a) => [(lower[a] ?? 0) * (normal[a] ?? 0), (upper[a] ?? 0) * (normal[a] ?? 0)]);
  const sum = (pick: (...values: number[]) => number): number => ends.reduce((total, end) => total + pick(...end), 0);
  return [sum(Math.min), sum(Math.max)];
}

/** Asks for the values under the pointer. */
function probe({ engine, ui, welcome }: PartProps, on: SliceFrame | null, place: { x: number; y: number } | null): void {
  if (on === null || place === null) {
    ui.probe(null);
    return;
  }
  const point = worldAt(on, place.x, place.y);
  ui.probe(async () => {
    const { values, label } = await engine.ask("probe", { point });
    const shown = values.map((value, n) =>
      value === null ? "outside" : `${shortNumber(value, 5)} ${welcome.volumes[n]?.value_unit ?? ""}`.trim(),
    );
    return `${shown.join(", ")}${label === null ? "" : ` · ${label.name}`} at ${placeText(point, welcome)}`;
  });
}
