// The panel of settings: quality at rest and while moving, overlays of the views, lens, theme.

import { withLens } from "../input/camera.ts";
import { set } from "../state/patch.ts";
import { OVERLAYS, QUALITIES } from "../state/state.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { Choice, NumberField, Switch } from "./fields.tsx";
import type { PartProps } from "./part.ts";

const TEXT = PANEL_WORDS.settings;
const FIRST_ANGLE = 30;

export function SettingsPanel(props: PartProps & { readonly figures: boolean; readonly onFigures: (on: boolean) => void }) {
  const { store, figures, onFigures } = props;
  const { view, render, camera } = store.state;
  const isNamed = typeof render.quality === "string";
  return (
    <>
      <Choice
        label={TEXT.rest}
        value={isNamed ? render.quality : "own"}
        options={[...QUALITIES.map((name) => [name, PANEL_WORDS.qualities[name]] as const), ...(isNamed ? [] : [["own", TEXT.custom] as const])]}
        onChoose={(value) => value !== "own" && store.change([set(value, "render", "quality")])}
      />
      <Choice
        label={TEXT.moving}
        value={view.quality.moving}
        options={Object.entries(TEXT.movings)}
        onChoose={(value) => store.change([set(value, "view", "quality", "moving")])}
      />
      <Switch
        label={TEXT.perspective}
        on={camera.view_angle !== undefined}
        onToggle={(on) => store.change([set(withLens(camera, on ? FIRST_ANGLE : undefined), "camera")])}
      />
      {camera.view_angle !== undefined && (
        <NumberField
          label={TEXT.angle}
          unit="°"
          value={camera.view_angle}
          min={5}
          max={100}
          onInput={(value) => store.change([set(withLens(camera, value), "camera")], "view angle")}
          onSettle={() => store.settle()}
        />
      )}
      <Choice
        label={TEXT.turning}
        value={view.interface.turning}
        options={Object.entries(TEXT.turnings)}
        onChoose={(value) => store.change([set(value, "view", "interface", "turning")])}
      />
      <Choice
        label={TEXT.theme}
        value={view.interface.theme}
        options={Object.entries(TEXT.themes)}
        onChoose={(value) => store.change([set(value, "view", "interface", "theme")])}
      />
      <Switch label={TEXT.follow} on={store.isFollowing} onToggle={(on) => store.follow(on)} />
      <fieldset>
        <legend>{TEXT.over}</legend>
        {OVERLAYS.map((name) => (
          <Switch
            key={name}
            label={TEXT.overlays[name]}
            on={view.overlays[name]}
            onToggle={(on) => store.change([set(on, "view", "overlays", name)])}
          />
        ))}
        <Switch label={TEXT.figures} on={figures} onToggle={onFigures} />
      </fieldset>
    </>
  );
}
