// The orientation cube: faces with the names of directions, turned as the picture is; a click looks from there.

import { axesOf, dot } from "../../input/camera.ts";
import type { Camera, Vec3 } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import { showFrom } from "../scene_view.tsx";

/** Half an edge, and the distance of the middle from the corner of the view, in pixels. */
const HALF = 24;
const MARGIN = 54;

/** Faces in the order of `axis_ends`: -x, +x, -y, +y, -z, +z; each with the view that looks at it. */
const SIDES: readonly { readonly outward: Vec3; readonly view: string }[] = [
  { outward: [-1, 0, 0], view: "left" },
  { outward: [1, 0, 0], view: "right" },
  { outward: [0, -1, 0], view: "back" },
  { outward: [0, 1, 0], view: "front" },
  { outward: [0, 0, -1], view: "bottom" },
  { outward: [0, 0, 1], view: "top" },
];

export function Cube(props: PartProps & { readonly camera: Camera; readonly width: number }) {
  const { camera, width, welcome } = props;
  const { right, up, back } = axesOf(camera);
  const flat = (point: Vec3): string => `${(dot(point, right) * HALF).toFixed(2)} ${(-dot(point, up) * HALF).toFixed(2)}`;
  const seen = SIDES.map((side, n) => ({ ...side, name: welcome.axis_ends[n] ?? "", towards: dot(side.outward, back) }))
    .filter(({ towards }) => towards > 0.02)
    .sort((a, b) => a.towards - b.towards);
  return (
    <g transform={`translate(${width - MARGIN} ${MARGIN})`}>
      {seen.map(({ outward, view, name, towards }) => {
        const axis = outward.findIndex((one) => one !== 0);
        const corner = (a: number, b: number): Vec3 => {
          const point = [...outward] as number[];
          point[(axis + 1) % 3] = a;
          point[(axis + 2) % 3] = b;
          return point as unknown as Vec3;
        };
        const outline = [corner(1, 1), corner(1, -1), corner(-1, -1), corner(-1, 1)].map(flat).join("L");
        const target = welcome.standard_views[view];
        const go = (): void => {
          if (target !== undefined) showFrom(props, target);
        };
        const shade = Math.round(38 + 70 * towards);
        return (
          <g
            key={view}
            data-handle
            role="button"
            tabindex={-1}
            aria-label={`${name}, from the ${view}`}
            onClick={go}
            onPointerDown={(event) => event.stopPropagation()}
            style={{ cursor: "pointer" }}
          >
            <path d={`M${outline}Z`} fill={`rgb(${shade},${shade},${shade})`} stroke="#cfd6e0" stroke-width="1" />
            {towards > 0.3 && (
              <text
                x={dot(outward, right) * HALF}
                y={-dot(outward, up) * HALF + 5}
                text-anchor="middle"
                style={{ strokeWidth: 0, fontWeight: 600 }}
              >
                {name}
              </text>
            )}
          </g>
        );
      })}
    </g>
  );
}
