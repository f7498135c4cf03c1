// The crop box on a slice: a rectangle whose sides are dragged, where the slice runs along the box.

import { vector } from "../../input/camera.ts";
import type { Vec3 } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { placeOf, type SliceFrame } from "../slices/geometry.ts";
import { boxOf, faceCenter, FACES, placeOfBox } from "./box.ts";
import { COLORS, FaceHandle } from "./box_handles.tsx";

const ALONG = 0.999;

export function CropOnSlice(props: PartProps & { readonly on: SliceFrame }) {
  const { store, on } = props;
  const place = placeOfBox(store.state.clip, "keep");
  const clip = store.state.clip[place];
  const box = clip === undefined ? null : boxOf(clip);
  const normalAxis = on.geometry.normal.findIndex((one) => Math.abs(one) > ALONG);
  if (box === null || normalAxis < 0) return null;
  const { crosshair } = store.state.view.slices;
  const inPlane = (point: Vec3): Vec3 => vector((axis) => (axis === normalAxis ? crosshair : point)[axis]);
  const [from, to] = [placeOf(on, inPlane(box.lower)), placeOf(on, inPlane(box.upper))];
  const [left, top] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  return (
    <g>
      <rect x={left} y={top} width={Math.abs(to.x - from.x)} height={Math.abs(to.y - from.y)} stroke={COLORS.keep} fill="none" stroke-width="1.3" />
      {FACES.filter((face) => face.axis !== normalAxis).map((face) => (
        <FaceHandle
          key={`${face.axis}${face.side}`}
          {...props}
          {...{ kind: "keep" as const, place, box, face }}
          at={placeOf(on, inPlane(faceCenter(box, face)))}
          wayOf={(_, dx, dy) => {
            const way = dx * (on.geometry.right[face.axis] ?? 0) + dy * (on.geometry.down[face.axis] ?? 0);
            return (way * on.geometry.pixel * on.width) / on.size.width;
          }}
        />
      ))}
    </g>
  );
}
