// Window and level of slices as a text that is a menu: automatic, the named windows of CT, colours.

import type { Frame } from "../../engine/engine.ts";
import { set } from "../../state/patch.ts";
import { shortNumber } from "../descriptions.ts";
import { SLICE_COLORS } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import type { PartProps } from "../part.ts";

const TEXT = WORDS.slices;

/** Text of the window, "L 40 W 400"; null for channels in their colours, which have no single window. */
export function windowText({ store }: PartProps, frame: Frame): string | null {
  const window = frame.slice?.window && (store.state.view.slices.window ?? frame.slice.window);
  return window ? `L ${shortNumber(window[0], 4)} W ${shortNumber(window[1], 4)}` : null;
}

/** Names of the windows that fit the first volume, with level and width. */
export function namedWindows({ welcome }: PartProps): readonly (readonly [string, readonly [number, number]])[] {
  return welcome.volumes[0]?.value_unit === "HU" ? Object.entries(welcome.window_names) : [];
}

/** Sets the window or the colours by a name; "automatic" takes the defaults of the data. */
export function chooseWindow({ store, welcome }: PartProps, name: string): void {
  const { slices } = store.state.view;
  const window = welcome.window_names[name];
  if (window !== undefined) store.change([set(window, "view", "slices", "window")]);
  else if (name in TEXT.colorNames) store.change([set(name, "view", "slices", "colors")]);
  else if (name === "automatic") {
    const fields = (["window", "colors"] as const).filter((field) => slices[field] !== undefined);
    if (fields.length > 0) store.change(fields.map((field) => ({ op: "remove", path: `/view/slices/${field}` })));
  }
}

export function WindowMenu(props: PartProps & { readonly text: string }) {
  const { text } = props;
  return (
    <label class="corner right pill menu" data-handle>
      <span class="hidden">{TEXT.window}</span>
      <select
        value=""
        onChange={(event) => {
          const select = event.currentTarget;
          chooseWindow(props, select.value);
          select.value = "";
        }}
      >
        <option value="" selected hidden>{text}</option>
        <option value="automatic">{TEXT.automatic}</option>
        {namedWindows(props).map(([name, [level, width]]) => (
          <option key={name} value={name}>{`${name} (${level}, ${width})`}</option>
        ))}
        <optgroup label={TEXT.colors}>
          {SLICE_COLORS.map((name) => <option key={name} value={name}>{TEXT.colorNames[name]}</option>)}
        </optgroup>
      </select>
    </label>
  );
}
