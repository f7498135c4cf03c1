// The crop box on a slice: a rectangle whose sides are dragged, where the slice runs along the box.

import { vector } from "../../input/camera.ts";
import type { Vec3 } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { placeOf, type SliceFrame } from "../slices/geometry.ts";
import { boxOf, faceCenter, FACES, placeOfBox, type Face } from "./box.ts";
import { COLORS, FaceHandle } from "./box_handles.tsx";
import { APART_PX, inside, type Place } from "./handle_places.ts";

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
  const cross = placeOf(on, inPlane(crosshair));
  // In the middle of a side, or where a line of the crosshair with its handles crosses that, at a quarter.
  const handleOf = (face: Face): Place => {
    const { x, y } = placeOf(on, inPlane(faceCenter(box, face)));
    const isUpright = Math.abs(on.geometry.right[face.axis] ?? 0) > ALONG;
    const aside = (middle: number, line: number, a: number, b: number): number => (Math.abs(middle - line) < APART_PX ? (3 * a + b) / 4 : middle);
    return inside(isUpright ? { x, y: aside(y, cross.y, from.y, to.y) } : { x: aside(x, cross.x, from.x, to.x), y }, on.size);
  };
  const [left, top] = [Math.min(from.x, to.x), Math.min(from.y, to.y)];
  return (
    <g>
      <rect x={left} y={top} width={Math.abs(to.x - from.x)} height={Math.abs(to.y - from.y)} stroke={COLORS.keep} fill="none" stroke-width="1.3" />
      {FACES.filter((face) => face.axis !== normalAxis).map((face) => (
        <FaceHandle
          key={`${face.axis}${face.side}`}
          {...props}
          {...{ kind: "keep" as const, place, box, face }}
          at={handleOf(face)}
          wayOf={(_, dx, dy) => {
            const way = dx * (on.geometry.right[face.axis] ?? 0) + dy * (on.geometry.down[face.axis] ?? 0);
            return (way * on.geometry.pixel * on.width) / on.size.width;
          }}
        />
      ))}
    </g>
  );
}
