// A box over the picture in space: its edges, a handle on every face, one in the middle.

import { project, scaled, withComponent } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Box, Camera, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, stepOf, take } from "../handle.tsx";
import type { CssSize, PartProps } from "../part.ts";
import {
  alongAxis, center, corners, EDGES, faceCenter, FACES, inPicture, isHidden, isSeen, movedBy, withFace, type Face,
} from "./box.ts";
import { handleName, type Place } from "./handle_places.ts";

const TEXT = WORDS.cut;
const NAMES = ["x", "y", "z"] as const;
export const COLORS = { keep: "#ffd166", cut_out: "#ff8fb1" } as const;

interface ClippingBox extends PartProps {
  readonly kind: "keep" | "cut_out";
  /** Place of the box among the clips. */
  readonly place: number;
  readonly box: Box;
}

interface BoxHandlesProps extends ClippingBox {
  readonly camera: Camera;
  readonly size: CssSize;
  /** The handles that are shown, by their names. */
  readonly places: ReadonlyMap<string, Place>;
}

interface FaceHandleProps extends ClippingBox {
  readonly face: Face;
  /** Place of the handle in the view, CSS pixels. */
  readonly at: Place;
  /** Distance along the face's axis, in world units, by which a drag moves the face. */
  wayOf(before: Box, dx: number, dy: number): number;
}

export function BoxHandles(props: BoxHandlesProps) {
  const { store, welcome, kind, place, box, camera, size, places } = props;
  const color = COLORS[kind];
  const isCrop = kind === "keep";
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const { now, change } = boxIn(props);
  const points = corners(box).map((corner) => project(camera, size, corner));
  const middle = places.get(handleName(place, "middle"));
  return (
    <g>
      {EDGES.map((edge) => {
        const [a, b] = [points[edge.a], points[edge.b]];
        if (!a || !b) return null;
        const hidden = isHidden(box, edge, camera);
        const line = `M${a.x} ${a.y}L${b.x} ${b.y}`;
        return <path key={`${edge.a}${edge.b}`} d={line} stroke={color} stroke-width="1.3" opacity={hidden ? 0.3 : 0.95} />;
      })}
      {FACES.map((face) => {
        const at = places.get(handleName(place, face));
        if (at === undefined) return null;
        return (
          <g key={`${face.axis}${face.side}`} opacity={isSeen(box, face, camera) ? 1 : 0.5}>
            <FaceHandle
              {...props}
              face={face}
              at={at}
              wayOf={(before, dx, dy) => alongAxis(camera, size, faceCenter(before, face), unitAlong(face.axis), dx, dy)}
            />
          </g>
        );
      })}
      {middle !== undefined && (
        <Handle
          label={TEXT.box(isCrop)}
          text={TEXT.boxMiddle(isCrop)}
          value={0}
          range={[0, 0]}
          x={middle.x}
          y={middle.y}
          color={color}
          round
          onDrag={(_x, _y, dx, dy) => {
            const before = now();
            change(movedBy(before, inPicture(camera, size, center(before), dx, dy), welcome.bounds), "box");
          }}
          onKey={(event) => {
            const axis = { ArrowRight: 0, ArrowLeft: 0, ArrowUp: 2, ArrowDown: 2, PageUp: 1, PageDown: 1 }[event.key];
            if (axis === undefined) return;
            take(event);
            const sign = event.key === "ArrowRight" || event.key === "ArrowUp" || event.key === "PageUp" ? 1 : -1;
            const by = scaled(unitAlong(axis), sign * (spacing[axis] ?? 1));
            change(movedBy(now(), by, welcome.bounds), "key box");
          }}
          onEnd={() => store.settle()}
        />
      )}
    </g>
  );
}

/** A handle that moves a face of a box, in space or on a slice. */
export function FaceHandle(props: FaceHandleProps) {
  const { store, welcome, kind, box, face, at, wayOf } = props;
  const { axis, side } = face;
  const { now, change } = boxIn(props);
  const spacing = welcome.volumes[0]?.spacing[axis] ?? 1;
  const bounds: readonly [number, number] = [welcome.bounds[0][axis], welcome.bounds[1][axis]];
  const name = TEXT.face(kind === "keep", NAMES[axis], side === "lower" ? "from" : "to");
  const move = (to: number, gesture: string): void =>
    change(withFace(now(), face, to, welcome.bounds, spacing), gesture);
  return (
    <Handle
      label={name}
      text={`${name} ${shortNumber(box[side][axis], 4)}`}
      value={box[side][axis]}
      range={bounds}
      x={at.x}
      y={at.y}
      color={COLORS[kind]}
      onDrag={(_x, _y, dx, dy) => {
        const before = now();
        move(before[side][axis] + wayOf(before, dx, dy), "face");
      }}
      onKey={(event) => {
        const n = stepOf(event);
        const end = { Home: bounds[0], End: bounds[1] }[event.key];
        if (n === undefined && end === undefined) return;
        take(event);
        move(end ?? now()[side][axis] + (n ?? 0) * spacing, "key face");
      }}
      onEnd={() => store.settle()}
      onDouble={() => move(bounds[side === "lower" ? 0 : 1], "face")}
    />
  );
}

/** The box as it is now, since gestures can come more often than the page is drawn, and a function that changes it. */
function boxIn({ store, kind, place, box }: ClippingBox) {
  const now = (): Box => (store.state.clip[place] as Record<string, Box> | undefined)?.[kind] ?? box;
  const change = (next: Box, gesture: string): void => store.change([set({ [kind]: next }, "clip", place)], gesture);
  return { now, change };
}

const unitAlong = (axis: number): Vec3 => withComponent([0, 0, 0], axis, 1);
