// The panel of settings: quality at rest and while moving, overlays of the views, lens, theme.

import { withLens } from "../input/camera.ts";
import { set } from "../state/patch.ts";
import { OVERLAYS, QUALITIES, type Overlay } from "../state/state.ts";
import { Choice, NumberField, Switch } from "./fields.tsx";
import type { PartProps } from "./part.ts";

const OVERLAY_NAMES: Readonly<Record<Overlay, string>> = {
  scale_bar: "Scale bar",
  letters: "Letters of directions",
  cube: "Orientation cube",
  color_bar: "Colour bar",
  crosshair: "Crosshair",
  crop_box: "Crop box and clip planes",
  legend: "Legend",
};
const FIRST_ANGLE = 30;

export function SettingsPanel(props: PartProps & { readonly figures: boolean; readonly onFigures: (on: boolean) => void }) {
  const { store, figures, onFigures } = props;
  const { view, render, camera } = store.state;
  const isNamed = typeof render.quality === "string";
  return (
    <>
      <Choice
        label="At rest"
        value={isNamed ? render.quality : "own"}
        options={[...QUALITIES.map((name) => [name, name] as const), ...(isNamed ? [] : [["own", "own sampling"] as const])]}
        onChoose={(value) => value !== "own" && store.change([set(value, "render", "quality")])}
      />
      <Choice
        label="While moving"
        value={view.quality.moving}
        options={[["smooth", "Smooth: 30 frames/s"], ["balanced", "Balanced: better"], ["exact", "Exact: as at rest"]]}
        onChoose={(value) => store.change([set(value, "view", "quality", "moving")])}
      />
      <Switch
        label="Perspective"
        on={camera.view_angle !== undefined}
        onToggle={(on) => store.change([set(withLens(camera, on ? FIRST_ANGLE : undefined), "camera")])}
      />
      {camera.view_angle !== undefined && (
        <NumberField
          label="View angle"
          unit="°"
          value={camera.view_angle}
          min={5}
          max={100}
          onInput={(value) => store.change([set(withLens(camera, value), "camera")], "view angle")}
          onSettle={() => store.settle()}
        />
      )}
      <Choice
        label="Theme"
        value={view.interface.theme}
        options={[["system", "As the system"], ["dark", "Dark"], ["light", "Light"]]}
        onChoose={(value) => store.change([set(value, "view", "interface", "theme")])}
      />
      <fieldset>
        <legend>Over the views</legend>
        {OVERLAYS.map((name) => (
          <Switch
            key={name}
            label={OVERLAY_NAMES[name]}
            on={view.overlays[name]}
            onToggle={(on) => store.change([set(on, "view", "overlays", name)])}
          />
        ))}
        <Switch label="Frame rate, latency, error" on={figures} onToggle={onFigures} />
      </fieldset>
    </>
  );
}
