// The crop box on a slice: a rectangle whose sides are dragged, where the slice runs along the box.

import { add, scaled } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Box, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, stepOf } from "../handle.tsx";
import type { PartProps } from "../part.ts";
import { placeOf, type SliceFrame } from "../slices/geometry.ts";
import { boxOf, placeOfBox, withFace, type Face } from "./box.ts";

const COLOR = "#ffd166";
const ALONG = 0.999;

export function CropOnSlice(props: PartProps & { readonly on: SliceFrame }) {
  const { store, welcome, on } = props;
  const place = placeOfBox(store.state.clip, "keep");
  const clip = store.state.clip[place];
  const box = clip === undefined ? null : boxOf(clip);
  const normalAxis = on.geometry.normal.findIndex((one) => Math.abs(one) > ALONG);
  if (box === null || normalAxis < 0) return null;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const { crosshair } = store.state.view.slices;
  const inPlane = (point: Vec3): Vec3 => point.map((value, a) => (a === normalAxis ? crosshair[a] : value)) as unknown as Vec3;
  const [from, to] = [placeOf(on, inPlane(box.lower)), placeOf(on, inPlane(box.upper))];
  const [left, top] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  const now = (): Box => {
    const found = store.state.clip[place];
    return (found === undefined ? null : boxOf(found)) ?? box;
  };
  const faces: Face[] = ([0, 1, 2] as const)
    .filter((axis) => axis !== normalAxis)
    .flatMap((axis) => [{ axis, side: "lower" as const }, { axis, side: "upper" as const }]);
  return (
    <g>
      <rect x={left} y={top} width={Math.abs(to.x - from.x)} height={Math.abs(to.y - from.y)} stroke={COLOR} fill="none" stroke-width="1.3" />
      {faces.map((face) => {
        const middle = scaled(add(box.lower, box.upper), 0.5);
        const at = placeOf(on, inPlane(middle.map((value, a) => (a === face.axis ? box[face.side][face.axis] : value)) as unknown as Vec3));
        const value = box[face.side][face.axis];
        const bounds: readonly [number, number] = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
        const name = WORDS.cut.face(true, "xyz"[face.axis] ?? "", face.side === "lower" ? "from" : "to");
        const move = (target: number, gesture: string): void =>
          store.change([set({ keep: withFace(now(), face, target, welcome.bounds, spacing[face.axis]) }, "clip", place)], gesture);
        return (
          <Handle
            key={name}
            label={name}
            text={`${name} ${shortNumber(value, 4)}`}
            value={value}
            range={bounds}
            x={at.x}
            y={at.y}
            color={COLOR}
            onDrag={(_x, _y, dx, dy) => {
              const per = (on.geometry.pixel * on.width) / on.size.width;
              const way = dx * (on.geometry.right[face.axis] ?? 0) + dy * (on.geometry.down[face.axis] ?? 0);
              move(now()[face.side][face.axis] + way * per, "face");
            }}
            onKey={(event) => {
              const n = stepOf(event);
              if (n === undefined) return;
              move(now()[face.side][face.axis] + n * spacing[face.axis], "key face");
            }}
            onEnd={() => store.settle()}
          />
        );
      })}
    </g>
  );
}
