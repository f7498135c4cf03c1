// Cutting by numbers: the crop box, a box that is cut out, clip planes.

import { add, axesOf, dot, scaled, unit, withComponent } from "../input/camera.ts";
import { set } from "../state/patch.ts";
import type { Box, Vec3 } from "../state/state.ts";
import { NumberField, Switch } from "./fields.tsx";
import { boxOf, cornerTowards, placeOfBox, withFace, type Face } from "./overlay3d/box.ts";
import { decimalsOf } from "./descriptions.ts";
import type { PartProps } from "./part.ts";
import { WORDS } from "../words.ts";

const TEXT = WORDS.cut;
const AXES = ["x", "y", "z"] as const;

export function CutPanel(props: PartProps) {
  const { store, welcome } = props;
  const { clip, view } = store.state;
  const whole: Box = { lower: welcome.bounds[0], upper: welcome.bounds[1], space: "world" };
  const add = (one: object): void => store.change([set(one, "clip", "-"), set(true, "view", "overlays", "crop_box")]);
  const remove = (place: number): void => store.change([{ op: "remove", path: `/clip/${place}` }]);
  return (
    <>
      <Switch
        label={TEXT.handles}
        on={view.overlays.crop_box}
        onToggle={(on) => store.change([set(on, "view", "overlays", "crop_box")])}
      />
      {(["keep", "cut_out"] as const).map((kind) => {
        const place = placeOfBox(clip, kind);
        const found = clip[place];
        const box = found === undefined ? null : boxOf(found);
        return (
          <fieldset key={kind}>
            <legend>{TEXT[kind]}</legend>
            {box === null ? (
              <button
                class="button"
                onClick={() => add({ [kind]: kind === "keep" ? whole : cornerTowards(whole, store.state.camera) })}
              >
                {kind === "keep" ? TEXT.crop : TEXT.cut}
              </button>
            ) : (
              <>
                <BoxNumbers {...props} kind={kind} place={place} box={box} />
                <div class="row">
                  <button class="button" onClick={() => store.change([set({ [kind]: whole }, "clip", place)])}>{TEXT.reset}</button>
                  <button class="button" onClick={() => remove(place)}>{TEXT.remove}</button>
                </div>
              </>
            )}
          </fieldset>
        );
      })}
      <fieldset>
        <legend>{TEXT.planes}</legend>
        {clip.map((one, place) =>
          "plane" in one ? <PlaneNumbers key={place} {...props} place={place} plane={one.plane} onRemove={() => remove(place)} /> : null,
        )}
        <button
          class="button"
          onClick={() => {
            const { back } = axesOf(store.state.camera);
            add({ plane: { point: store.state.view.slices.crosshair, normal: scaled(back, -1) } });
          }}
        >
          {TEXT.add}
        </button>
      </fieldset>
    </>
  );
}

function BoxNumbers(props: PartProps & { kind: "keep" | "cut_out"; place: number; box: Box }) {
  const { store, welcome, kind, place, box } = props;
  const spacing = welcome.volumes[0]?.spacing ?? [1, 1, 1];
  const unitName = welcome.volumes[0]?.unit ?? WORDS.slices.units;
  return (
    <>
      {AXES.flatMap((name, a) =>
        (["lower", "upper"] as const).map((side) => {
          const face: Face = { axis: a as 0 | 1 | 2, side };
          const [low, high] = [welcome.bounds[0][a] ?? 0, welcome.bounds[1][a] ?? 1];
          return (
            <NumberField
              key={`${name}${side}`}
              decimals={decimalsOf(spacing[a] ?? 1)}
              label={side === "lower" ? TEXT.from(name) : TEXT.to(name)}
              unit={unitName}
              value={box[side][a] ?? 0}
              min={low}
              max={high}
              onInput={(value) =>
                store.change(
                  [set({ [kind]: withFace(box, face, value, welcome.bounds, spacing[a] ?? 1) }, "clip", place)],
                  `${kind} ${name} ${side}`,
                )
              }
              onSettle={() => store.settle()}
            />
          );
        }),
      )}
    </>
  );
}

function PlaneNumbers(
  props: PartProps & { place: number; plane: { point: Vec3; normal: Vec3 }; onRemove: () => void },
) {
  const { store, welcome, place, plane, onRemove } = props;
  const normal = unit(plane.normal);
  const [lower, upper] = welcome.bounds;
  const ends = [0, 1, 2].map((a) => [(lower[a] ?? 0) * (normal[a] ?? 0), (upper[a] ?? 0) * (normal[a] ?? 0)]);
  const low = ends.reduce((sum, end) => sum + Math.min(...end), 0);
  const high = ends.reduce((sum, end) => sum + Math.max(...end), 0);
  const along = dot(plane.point, normal);
  const change = (next: { point: Vec3; normal: Vec3 }, gesture?: string): void =>
    store.change([set({ plane: next }, "clip", place)], gesture);
  const number = store.state.clip.slice(0, place + 1).filter((clip) => "plane" in clip).length;
  return (
    <div class="plane">
      <NumberField
        decimals={decimalsOf(Math.min(...(welcome.volumes[0]?.spacing ?? [1])))}
        label={TEXT.plane(number)}
        unit={welcome.volumes[0]?.unit ?? WORDS.slices.units}
        value={along}
        min={low}
        max={high}
        onInput={(value) => {
          const point = add(plane.point, scaled(normal, value - along));
          change({ ...plane, point }, "plane at");
        }}
        onSettle={() => store.settle()}
      />
      <div class="row">
        {AXES.map((name, a) => (
          <label key={name} class="row">
            {TEXT.normal(name)}
            <input
              class="short"
              type="number"
              step="any"
              value={Number((normal[a] ?? 0).toFixed(4))}
              onChange={(event) => {
                const value = event.currentTarget.valueAsNumber;
                const next = withComponent(normal, a, value);
                if (Number.isFinite(value) && next.some((x) => x !== 0)) change({ ...plane, normal: unit(next) });
              }}
            />
          </label>
        ))}
      </div>
      <div class="row">
        <button class="button" onClick={() => change({ ...plane, normal: scaled(plane.normal, -1) })}>{TEXT.flip}</button>
        <button class="button" onClick={onRemove}>{TEXT.remove}</button>
      </div>
    </div>
  );
}
