// Clip planes over the picture in space: a handle that moves the plane along its normal, and two that tilt it.

import { add, dot, length, project, scaled, sub, turnedAbout, unit } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Camera, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, stepOf } from "../handle.tsx";
import type { CssSize, PartProps } from "../part.ts";
import { alongAxis } from "./box.ts";
import { handleName, squareOf, type Place } from "./handle_places.ts";

const TEXT = WORDS.cut;
const COLOR = "#8be0d4";
/** Steps of keys: a share of the volume, and degrees. */
const STEP_SHARE = 0.01;
const STEP_DEG = 2;

interface Plane {
  readonly point: Vec3;
  readonly normal: Vec3;
}

export function PlaneHandles(
  props: PartProps & {
    readonly place: number;
    readonly plane: Plane;
    readonly camera: Camera;
    readonly size: CssSize;
    /** The handles that are shown, by their names. */
    readonly places: ReadonlyMap<string, Place>;
  },
) {
  const { store, welcome, place, plane, camera, size, places } = props;
  const drawn = squareOf(plane, camera, size);
  if (drawn === null) return null;
  const { at, normal, arm, first, second, ends } = drawn;
  const middle = places.get(handleName(place, "middle"));
  const number = store.state.clip.slice(0, place + 1).filter((clip) => "plane" in clip).length;
  const extent = length(sub(welcome.bounds[1], welcome.bounds[0]));
  const now = (): Plane => (store.state.clip[place] as { plane: Plane } | undefined)?.plane ?? plane;
  const change = (next: Plane, gesture: string): void => store.change([set({ plane: next }, "clip", place)], gesture);
  const square = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a, b]) =>
    project(camera, size, add(plane.point, add(scaled(first, (a ?? 0) * arm), scaled(second, (b ?? 0) * arm)))),
  );
  const tip = project(camera, size, add(plane.point, scaled(normal, arm * 0.6)));
  const slide = (way: number, gesture: string): void => {
    const before = now();
    change({ ...before, point: add(before.point, scaled(unit(before.normal), way)) }, gesture);
  };
  const tilt = (axis: Vec3, angle: number, gesture: string): void => {
    const before = now();
    change({ ...before, normal: turnedAbout(unit(before.normal), axis, angle) }, gesture);
  };
  return (
    <g stroke={COLOR} fill="none">
      {square.every((corner) => corner !== null) && (
        <path d={`M${square.map((corner) => `${corner?.x} ${corner?.y}`).join("L")}Z`} stroke-width="1.3" fill={COLOR} fill-opacity="0.08" />
      )}
      {tip !== null && <path d={`M${at.x} ${at.y}L${tip.x} ${tip.y}`} stroke-width="2" />}
      {ends.map((end, k) => {
        const shown = places.get(handleName(place, k));
        if (shown === undefined) return null;
        const axis = k === 0 ? second : first;
        return (
          <Handle
            key={k}
            round
            label={TEXT.tiltHandle(number, k === 0)}
            text={TEXT.normalIs(normal.map((one) => shortNumber(one, 2)).join(", "))}
            value={0}
            range={[-180, 180]}
            x={shown.x}
            y={shown.y}
            color={COLOR}
            onDrag={(_x, _y, dx, dy) => {
              const way = alongAxis(camera, size, end, normal, dx, dy);
              tilt(axis, (k === 0 ? -1 : 1) * Math.atan2(way, arm), "tilt plane");
            }}
            onKey={(event) => {
              const n = stepOf(event);
              if (n !== undefined) tilt(axis, (n * STEP_DEG * Math.PI) / 180, "key tilt plane");
            }}
            onEnd={() => store.settle()}
          />
        );
      })}
      {middle !== undefined && <Handle
        label={TEXT.planeHandle(number)}
        text={TEXT.planeAlong(number, shortNumber(dot(plane.point, normal), 4))}
        value={dot(plane.point, normal)}
        range={[-extent, extent]}
        x={middle.x}
        y={middle.y}
        color={COLOR}
        onDrag={(_x, _y, dx, dy) => slide(alongAxis(camera, size, now().point, unit(now().normal), dx, dy), "plane")}
        onKey={(event) => {
          const n = stepOf(event);
          if (n !== undefined) slide(n * STEP_SHARE * extent, "key plane");
        }}
        onEnd={() => store.settle()}
      />}
    </g>
  );
}
