// The overlay of the 3-D view, drawn with the camera of the frame, so that it never swims against the picture.

import type { Frame } from "../../engine/engine.ts";
import { axesOf, dot, project, scaled, unitsPerPixel, withComponent } from "../../input/camera.ts";
import type { Camera, ColorPoint, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Legend } from "../legend.tsx";
import type { CssSize, PartProps } from "../part.ts";
import { barLength } from "../slices/geometry.ts";
import { Measures3d } from "../slices/measures.tsx";
import { boxOf, placeOfBox } from "./box.ts";
import { BoxHandles } from "./box_handles.tsx";
import { Cube } from "./cube.tsx";
import { handlePlaces } from "./handle_places.ts";
import { PlaneHandles } from "./plane_handles.tsx";

const DIRECTIONS: readonly Vec3[] = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
/** Least width of a view, CSS pixels, in which the cube covers neither the picture nor the letter beside it. */
const CUBE_FITS_PX = 240;
/** Least cosine between a direction and the way to an edge of the picture for its name to stand there. */
const NAMED = 0.5;

export function SceneOverlay(props: PartProps & { readonly frame: Frame; readonly size: CssSize }) {
  const { frame, size, store } = props;
  const { overlays } = store.state.view;
  const camera = frame.camera ?? store.state.camera;
  const clips = store.state.clip;
  const places = handlePlaces(clips, camera, size);
  return (
    <>
      <svg class="over">
        {/* First, so that handles lie over it. */}
        {overlays.cube && size.width >= CUBE_FITS_PX && <Cube {...props} camera={camera} width={size.width} />}
        {overlays.crosshair && <Crosshair {...props} camera={camera} />}
        {overlays.crop_box &&
          (["keep", "cut_out"] as const).map((kind) => {
            const place = placeOfBox(clips, kind);
            const clip = clips[place];
            const box = clip === undefined ? null : boxOf(clip);
            return box === null ? null : <BoxHandles key={kind} {...props} {...{ kind, place, box, camera, size, places }} />;
          })}
        {overlays.crop_box &&
          clips.map((clip, place) =>
            "plane" in clip ? <PlaneHandles key={place} {...props} {...{ place, plane: clip.plane, camera, size, places }} /> : null,
          )}
        <Measures3d {...props} camera={camera} />
        {overlays.letters && <EdgeLetters {...props} camera={camera} />}
        {overlays.scale_bar && <ScaleBar {...props} camera={camera} />}
      </svg>
      {overlays.color_bar && <ColorBar {...props} />}
      {overlays.legend && <Legend {...props} height={size.height} />}
    </>
  );
}

function Crosshair({ store, welcome, camera, size }: PartProps & { camera: Camera; size: CssSize }) {
  const { crosshair } = store.state.view.slices;
  if (store.state.view.layout.name === "3d") return null;
  const [lower, upper] = welcome.bounds;
  const colors = ["#6ba8ff", "#6bd46b", "#ff6b6b"];
  return (
    <g aria-hidden="true" stroke-width="1.2" opacity="0.8">
      {([0, 1, 2] as const).map((axis) => {
        const end = (from: Vec3): Vec3 => withComponent(crosshair, axis, from[axis]);
        const [a, b] = [project(camera, size, end(lower)), project(camera, size, end(upper))];
        return a && b ? <path key={axis} d={`M${a.x} ${a.y}L${b.x} ${b.y}`} stroke={colors[axis]} /> : null;
      })}
    </g>
  );
}

/** Names of directions at the edges of the picture, where one points there. */
function edgeNames(camera: Camera, names: readonly string[]): { left: string; right: string; top: string; bottom: string } {
  const { right, up } = axesOf(camera);
  const name = (way: Vec3): string => {
    const shares = DIRECTIONS.map((direction, n) => ({ n, share: dot(direction, way) }));
    return shares
      .filter(({ share }) => share > NAMED)
      .sort((a, b) => b.share - a.share)
      .map(({ n }) => names[n] ?? "")
      .slice(0, 2)
      .join("");
  };
  return { left: name(scaled(right, -1)), right: name(right), top: name(up), bottom: name(scaled(up, -1)) };
}

function EdgeLetters({ welcome, camera, size }: PartProps & { camera: Camera; size: CssSize }) {
  if (!welcome.volumes[0]?.is_anatomical) return null;
  const names = edgeNames(camera, welcome.axis_ends);
  return (
    <g aria-hidden="true" text-anchor="middle">
      <text x={16} y={size.height / 2}>{names.left}</text>
      <text x={size.width - 16} y={size.height / 2}>{names.right}</text>
      <text x={size.width / 2} y={18}>{names.top}</text>
      <text x={size.width / 2} y={size.height - 8}>{names.bottom}</text>
    </g>
  );
}

function ScaleBar({ welcome, camera, size }: PartProps & { camera: Camera; size: CssSize }) {
  const perPixel = unitsPerPixel(camera, size.height);
  const bar = barLength(perPixel * size.width * 0.25);
  const unit = welcome.volumes[0]?.unit ?? WORDS.slices.units;
  const where = camera.parallel_scale === undefined ? WORDS.scene.barAtMiddle : "";
  const [x, y] = [12, size.height - 14];
  return (
    <g aria-hidden="true">
      <path d={`M${x} ${y}h${bar / perPixel}`} stroke="#000" stroke-width="5" />
      <path d={`M${x} ${y}h${bar / perPixel}`} stroke="#fff" stroke-width="2.5" />
      <text x={x} y={y - 6}>{`${shortNumber(bar)} ${unit}${where}`}</text>
    </g>
  );
}

/** A bar of the colours of values, for a projection or a look; of the field that gives a layer its colours, if one does. */
function ColorBar({ store, welcome, ui }: PartProps) {
  const layer = store.state.layers[ui.layer];
  const info = welcome.volumes[ui.layer];
  if (layer === undefined || info === undefined || !("color" in layer.look.transfer_function)) return null;
  const field = info.color_field;
  const points = field?.color ?? (layer.look.transfer_function.color as readonly ColorPoint[]);
  const [first, last] = [points[0], points.at(-1)];
  if (first === undefined || last === undefined || first[0] === last[0]) return null;
  const stops = points.map(
    ([value, ...rgb]) =>
      `rgb(${rgb.map((one) => Math.round(255 * one)).join()}) ${(100 * (value - first[0])) / (last[0] - first[0])}%`,
  );
  const unit = (field ?? info).value_unit;
  const ends = [shortNumber(first[0]), shortNumber(last[0]), unit] as const;
  const label = field === null ? WORDS.scene.colorBar(...ends) : WORDS.scene.fieldBar(field.name, ...ends);
  return (
    <div class="corner right low color-bar" role="img" aria-label={label.trim()}>
      {field !== null && <span class="name">{field.name}</span>}
      <span>{`${shortNumber(last[0])} ${unit}`}</span>
      <span class="ramp" style={{ background: `linear-gradient(to top, ${stops.join(", ")})` }} />
      <span>{shortNumber(first[0])}</span>
    </div>
  );
}
