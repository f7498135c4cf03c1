// A box over the picture in space: its edges, a handle on every face, one in the middle.

import { add, project } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Box, Camera, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, stepOf, take } from "../handle.tsx";
import type { CssSize, PartProps } from "../part.ts";
import {
  alongAxis, center, corners, EDGES, faceCenter, FACES, inPicture, isHidden, isSeen, movedBy, withFace, type Face,
} from "./box.ts";

const TEXT = WORDS.cut;
const NAMES = ["x", "y", "z"] as const;
const UNITS: readonly Vec3[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

interface BoxHandlesProps extends PartProps {
  readonly kind: "keep" | "cut_out";
  readonly place: number;
  readonly box: Box;
  readonly camera: Camera;
  readonly size: CssSize;
}

export function BoxHandles(props: BoxHandlesProps) {
  const { store, welcome, kind, place, box, camera, size } = props;
  const color = kind === "keep" ? "#ffd166" : "#ff8fb1";
  const isCrop = kind === "keep";
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const change = (next: Box, gesture: string): void => store.change([set({ [kind]: next }, "clip", place)], gesture);
  const now = (): Box => {
    const clip = store.state.clip[place] as Record<string, Box> | undefined;
    return clip?.[kind] ?? box;
  };
  const points = corners(box).map((corner) => project(camera, size, corner));
  const middle = project(camera, size, center(box));
  const moveFace = (face: Face, to: number, gesture: string): void =>
    change(withFace(now(), face, to, welcome.bounds, spacing[face.axis]), gesture);
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
        const at = project(camera, size, faceCenter(box, face));
        if (at === null) return null;
        const value = box[face.side][face.axis];
        const bounds: readonly [number, number] = [welcome.bounds[0][face.axis], welcome.bounds[1][face.axis]];
        const name = TEXT.face(isCrop, NAMES[face.axis], face.side === "lower" ? "from" : "to");
        const keys = (event: KeyboardEvent): void => {
          const n = stepOf(event);
          const end = { Home: bounds[0], End: bounds[1] }[event.key];
          if (n === undefined && end === undefined) return;
          take(event);
          moveFace(face, end ?? now()[face.side][face.axis] + (n ?? 0) * spacing[face.axis], "key face");
        };
        return (
          <g key={name} opacity={isSeen(box, face, camera) ? 1 : 0.5}>
            <Handle
              label={name}
              text={`${name} ${shortNumber(value, 4)}`}
              value={value}
              range={bounds}
              x={at.x}
              y={at.y}
              color={color}
              onDrag={(_x, _y, dx, dy) => {
                const before = now();
                const axis = UNITS[face.axis] as Vec3;
                const way = alongAxis(camera, size, faceCenter(before, face), axis, dx, dy);
                moveFace(face, before[face.side][face.axis] + way, "face");
              }}
              onKey={keys}
              onEnd={() => store.settle()}
              onDouble={() => moveFace(face, bounds[face.side === "lower" ? 0 : 1], "face")}
            />
          </g>
        );
      })}
      {middle !== null && (
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
            const by = UNITS[axis]?.map((one) => one * sign * (spacing[axis] ?? 1)) as unknown as Vec3;
            change(movedBy(now(), add(by, [0, 0, 0]), welcome.bounds), "key box");
          }}
          onEnd={() => store.settle()}
        />
      )}
    </g>
  );
}
