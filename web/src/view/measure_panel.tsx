// Distances, angles and regions as a list, and statistics of labels.

import { set } from "../state/patch.ts";
import type { Measure } from "../state/state.ts";
import { WORDS } from "../words.ts";
import { placeText } from "./descriptions.ts";
import { LabelStatistics } from "./label_statistics.tsx";
import type { PartProps, Tool } from "./part.ts";
import { closeRegion } from "./slices/drawing.ts";
import { measuresCsv } from "./slices/measure_csv.ts";
import { measured } from "./slices/measures.tsx";
import { regionFacts, textOfRegion, useRegionFacts } from "./slices/region_text.tsx";

const TEXT = WORDS.measures;
const TOOLS = ["distance", "angle", "area"] as const satisfies readonly (Tool & Measure["kind"])[];

export function MeasurePanel(props: PartProps) {
  const { store, welcome, ui } = props;
  const { measures } = store.state.view;
  const tool = TOOLS.find((name) => name === ui.tool);
  const save = async (): Promise<void> => {
    const facts = await Promise.all(measures.map((one) => (one.kind === "area" ? regionFacts(props, one) : null)));
    const { unit, value_unit } = welcome.volumes[0] ?? { unit: null, value_unit: "" };
    ui.download("measures.csv", measuresCsv(measures, facts, unit ?? WORDS.slices.units, value_unit), "text/csv");
  };
  return (
    <>
      <div class="row">
        {TOOLS.map((name) => (
          <button key={name} class="button" aria-pressed={ui.tool === name} onClick={() => ui.setTool(ui.tool === name ? "turn" : name)}>
            {TEXT.tools[name][0]}
          </button>
        ))}
        <button class="button" onClick={() => ui.addPoint(store.state.view.slices.crosshair)} disabled={tool === undefined}>
          {TEXT.atCrosshair}
        </button>
        {ui.tool === "area" && ui.points.length > 2 && <button class="button" onClick={() => closeRegion(props)}>{TEXT.close}</button>}
      </div>
      {ui.points.length > 0 && <p class="dim">{pointsSoFar(ui.tool, ui.points.length)}</p>}
      {(tool !== undefined || measures.length === 0) && <p class="dim">{tool === undefined ? TEXT.choose : TEXT.tools[tool][1]}</p>}
      {measures.length > 0 && <ol>{measures.map((one, n) => <Row key={n} {...props} measure={one} number={n} />)}</ol>}
      <div class="row">
        <button class="button" disabled={measures.length === 0} onClick={() => store.change([set([], "view", "measures")])}>
          {TEXT.deleteAll}
        </button>
        <button class="button" disabled={measures.length === 0} onClick={() => void save()}>{TEXT.csv}</button>
      </div>
      {store.state.labels !== null && <LabelStatistics {...props} />}
    </>
  );
}

function pointsSoFar(tool: Tool, n: number): string {
  return tool === "area" ? TEXT.corners(n) : TEXT.points(n, tool === "angle" ? 3 : 2);
}

function Row(props: PartProps & { readonly measure: Measure; readonly number: number }) {
  const { store, welcome, measure, number } = props;
  const { unit, value_unit } = welcome.volumes[0] ?? { unit: null, value_unit: "" };
  return (
    <li>
      <span class="row">
        {measured(measure, unit ?? WORDS.slices.units)}
        <button
          class="icon-button"
          aria-label={TEXT.remove(number + 1)}
          onClick={() => store.change([{ op: "remove", path: `/view/measures/${number}` }])}
        >
          ×
        </button>
      </span>
      {measure.kind === "area" ? (
        <RegionValues {...props} valueUnit={value_unit} />
      ) : (
        <span class="dim">{measure.points.map((point) => placeText(point, welcome)).join(" – ")}</span>
      )}
    </li>
  );
}

function RegionValues(props: PartProps & { readonly measure: Measure; readonly valueUnit: string }) {
  const facts = useRegionFacts(props, props.measure);
  if (facts === null) return null;
  return <span class="dim">{`${textOfRegion(facts, props.valueUnit)}, ${TEXT.range(facts.min.toPrecision(4), facts.max.toPrecision(4))}`}</span>;
}
