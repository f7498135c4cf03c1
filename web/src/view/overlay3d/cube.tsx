// The orientation cube: bevelled and lit; a click on a face, an edge or a corner looks from there.

import { axesOf, dot, seenFrom, unit } from "../../input/camera.ts";
import { leveled } from "../../input/turntable.ts";
import type { Camera, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { holding } from "../handle.tsx";
import type { PartProps } from "../part.ts";
import { showFrom } from "../scene_view.tsx";
import { CUBE_PLACES, type CubePlace } from "./cube_places.ts";

/** Half an edge, and the distance of the middle from the corner of the view, in pixels. */
const HALF = 27;
const MARGIN = 56;
/** Direction to the light in the picture: from above, a little from the left, towards the eye. Share of ambient light. */
const LIGHT: Vec3 = unit([-0.35, 0.6, 0.8]);
const AMBIENT = 0.3;
/** Least cosines to the line of sight of places that are drawn, and of faces whose names can be read. */
const SEEN = 0.02;
const READABLE = 0.35;

/** The standard views that look at the ends of -x, +x, -y, +y, -z, +z. */
const VIEWS = ["left", "right", "back", "front", "bottom", "top"] as const;

export function Cube(props: PartProps & { readonly camera: Camera; readonly width: number }) {
  const { camera, width, welcome } = props;
  const { right, up, back } = axesOf(camera);
  const flat = (point: Vec3): string => `${(dot(point, right) * HALF).toFixed(2)} ${(-dot(point, up) * HALF).toFixed(2)}`;
  return (
    <g class="cube" role="group" aria-label={WORDS.scene.cube} transform={`translate(${width - MARGIN} ${MARGIN})`}>
      {CUBE_PLACES.map((place) => {
        const towards = dot(place.outward, back);
        if (towards < SEEN) return null;
        const lit = Math.max(0, dot(place.outward, right) * LIGHT[0] + dot(place.outward, up) * LIGHT[1] + towards * LIGHT[2]);
        const name = place.ends.map((end) => welcome.axis_ends[end] ?? "").join("");
        return (
          <g
            key={place.ends.join()}
            ref={holding((gesture) => {
              // A drag that begins on the cube turns the picture.
              if (gesture.kind !== "tap") return undefined;
              lookFrom(props, place);
              return true;
            })}
            data-handle
            role="button"
            tabindex={-1}
            aria-label={WORDS.scene.cubePlace(name, place.ends.map((end) => WORDS.views[VIEWS[end] ?? "front"]))}
          >
            <path d={`M${place.outline.map(flat).join("L")}Z`} style={{ "--light": (AMBIENT + (1 - AMBIENT) * lit).toFixed(3) }} />
            {place.ends.length === 1 && towards > READABLE && (
              <text x={dot(place.outward, right) * HALF} y={-dot(place.outward, up) * HALF + 5} opacity={Math.min(1, (towards - READABLE) * 4)}>
                {name}
              </text>
            )}
          </g>
        );
      })}
    </g>
  );
}

/** Looks from a place of the cube: from faces as the standard views do, else upright. */
function lookFrom(props: PartProps, { ends, outward }: CubePlace): void {
  const { store, welcome } = props;
  const [end] = ends;
  const standard = ends.length === 1 && end !== undefined ? welcome.standard_views[VIEWS[end] ?? ""] : undefined;
  const now = store.state.camera;
  const { up } = axesOf(now);
  // Where the view's up direction lies along the new line of sight, any other one does, which levelling replaces.
  const across: Vec3 = Math.abs(dot(up, outward)) < 0.9 ? up : axesOf(now).right;
  showFrom(props, standard ?? leveled(seenFrom(now, outward, across), welcome.upright));
}
