// The legend of the 3-D picture: labels and layers with their colours. A click hides one, in space and on slices.

import type { ComponentChild } from "preact";
import { useRef } from "preact/hooks";

import { set } from "../state/patch.ts";
import { WORDS } from "../words.ts";
import { compositeName } from "./descriptions.ts";
import { labelRows, toggledLabel } from "./look/layers.ts";
import { hexColor, namedColor } from "./look/looks.ts";
import { Ramp } from "./look/ramp.tsx";
import type { ViewerState } from "../state/state.ts";
import { chosenRows } from "./legend_rows.ts";
import type { PartProps } from "./part.ts";
import { toggled } from "./sheet.tsx";

const TEXT = WORDS.legend;
/** Most rows; fewer where the view is low, so that the letters in the middle of its edges stay free. */
const MAX_ROWS = 12;
const ROW_PX = 24;
/** Height of the gap above the legend, of the row that counts the others, of the gaps, and of half a letter. */
const ABOVE_PX = 60;
const ENDINGS = /\.(nii|nii\.gz|nrrd|nhdr|mha|mhd|tiff?|h5|hdf5|zarr|ome\.zarr|ome\.tiff?|vti|vtk|dcm)$/i;

interface Row {
  readonly key: string;
  readonly name: string;
  readonly isShown: boolean;
  readonly chip: ComponentChild;
  readonly toggle: () => void;
}

export function Legend(props: PartProps & { readonly height: number }) {
  const { store, height } = props;
  const touched = useRef(new Set<string>());
  const rows = [...labelsOf(props), ...layersOf(props)];
  if (rows.length === 0) return null;
  const most = Math.max(1, Math.min(MAX_ROWS, Math.floor((height / 2 - ABOVE_PX) / ROW_PX)));
  // A row that counts one other takes the place of that one.
  const shown = rows.length <= most + 1 ? rows : chosenRows(rows, most, touched.current);
  const more = rows.length - shown.length;
  const onRow = (key: string, toggle: () => void): void => {
    touched.current.add(key);
    toggle();
  };
  return (
    <ul class="corner legend" aria-label={TEXT.title} onPointerDown={(event) => event.stopPropagation()}>
      {shown.map(({ key, name, isShown, chip, toggle }) => (
        <li key={key}>
          <button class="legend-row" aria-pressed={isShown} title={isShown ? TEXT.hide(name) : TEXT.show(name)} onClick={() => onRow(key, toggle)}>
            {chip}
            <span>{name}</span>
          </button>
        </li>
      ))}
      {more > 0 && (
        <li>
          <button class="legend-row" onClick={() => store.change([set(sheetOfMore(store.state), "view", "interface", "panels")])}>
            <span>{TEXT.more(more)}</span>
          </button>
        </li>
      )}
    </ul>
  );
}

/** The open panels with the list of labels or, without a segmentation, of layers. */
function sheetOfMore({ labels, view }: ViewerState): string[] {
  const { panels } = view.interface;
  const name = labels === null ? "layers" : "labels";
  return panels.includes(name) ? [...panels] : toggled(panels, name);
}

function labelsOf({ store }: PartProps): Row[] {
  const labels = store.state.labels?.labels ?? {};
  return labelRows(labels).map(({ number, name, look, isShown }) => ({
    key: `label ${number}`,
    name,
    isShown,
    chip: <span class="chip" style={{ background: hexColor(look.color, namedColor) }} />,
    toggle: () => store.change(toggledLabel(store, number)),
  }));
}

/** Rows of the layers, where there are several. */
function layersOf({ store }: PartProps): Row[] {
  const { layers, render } = store.state;
  if (layers.length < 2 || compositeName(render.composite) === "first-hit") return [];
  return layers.map((layer, index) => ({
    key: `layer ${index}`,
    name: layer.name.replace(ENDINGS, ""),
    isShown: layer.visible,
    chip: <Ramp layer={layer} />,
    toggle: () => store.change([set(!layer.visible, "layers", index, "visible")]),
  }));
}
