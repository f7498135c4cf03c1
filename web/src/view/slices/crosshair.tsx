// The crosshair of a slice: lines in which the other planes cut it, moved and tilted by handles.

import { add, dot, scaled } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Pane, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, stepOf } from "../handle.tsx";
import type { PartProps } from "../part.ts";
import { lineOf, normalOf, placeOf, sampleStep, stepped, tilted, type SliceFrame } from "./geometry.ts";
import { nameOf, PANE_COLORS } from "./panes.ts";

const TEXT = WORDS.slices;
/** Half of the gap in the middle of the crosshair, so that nothing covers what is looked at, pixels. */
const GAP = 12;
/** Distances of the handles from the crosshair, as shares of the pane's smaller side: letters stay free. */
const TILT_AT = 0.36;
const MOVE_AT = 0.22;

export function CrosshairLine(props: PartProps & { pane: Pane; on: SliceFrame; other: Pane }) {
  const { store, on, other, welcome } = props;
  const { size } = on;
  const name = nameOf(props, other);
  const normal = normalOf(store.state, other);
  const line = lineOf(on, normal);
  if (line === null) return null;
  const at = placeOf(on, store.state.view.slices.crosshair);
  const reach = size.width + size.height;
  const color = PANE_COLORS[other];
  const side = Math.min(size.width, size.height);
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
  const along = (far: number): string => `${at.x + line.dx * far} ${at.y + line.dy * far}`;
  return (
    <g class="quiet" stroke={color} fill="none">
      <path d={`M${along(-reach)}L${along(-GAP)}M${along(GAP)}L${along(reach)}`} stroke-width="1.2" opacity="0.85" />
      <Handle
        label={TEXT.plane(name)}
        text={TEXT.planeAt(name, shortNumber(position, 4))}
        value={position}
        range={range}
        x={at.x - line.dx * side * MOVE_AT}
        y={at.y - line.dy * side * MOVE_AT}
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
        label={TEXT.tilt(name)}
        text={TEXT.tiltOf(name)}
        value={(Math.atan2(line.dy, line.dx) * 180) / Math.PI}
        range={[-180, 180]}
        x={at.x + line.dx * side * TILT_AT}
        y={at.y + line.dy * side * TILT_AT}
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
