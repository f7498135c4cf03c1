// Distances and angles as a list.

import { set } from "../state/patch.ts";
import { placeText } from "./descriptions.ts";
import type { PartProps } from "./part.ts";
import { measured } from "./slices/measures.tsx";

export function MeasurePanel({ store, welcome, ui }: PartProps) {
  const { measures } = store.state.view;
  const unit = welcome.volumes[0]?.unit ?? "units";
  const csv = (): string =>
    ["kind,value,unit,points", ...measures.map((one) => {
      const [value, of] = measured(one, unit).replace("°", " degree").split(" ");
      return `${one.kind},${value},${of},"${one.points.map((point) => point.join(" ")).join("; ")}"`;
    })].join("\n");
  return (
    <>
      <div class="row">
        {(["distance", "angle"] as const).map((tool) => (
          <button
            key={tool}
            class="button"
            aria-pressed={ui.tool === tool}
            onClick={() => ui.setTool(ui.tool === tool ? "turn" : tool)}
          >
            {tool === "distance" ? "Distance" : "Angle"}
          </button>
        ))}
        <button
          class="button"
          onClick={() => {
            const { crosshair } = store.state.view.slices;
            ui.addPoint(crosshair);
          }}
          disabled={ui.tool !== "distance" && ui.tool !== "angle"}
        >
          Point at the crosshair
        </button>
      </div>
      {ui.points.length > 0 && <p class="dim">{`${ui.points.length} of ${ui.tool === "angle" ? 3 : 2} points`}</p>}
      {measures.length === 0 ? (
        <p class="dim">Choose one, then click in a view.</p>
      ) : (
        <ol>
          {measures.map((one, n) => (
            <li key={n}>
              <span class="row">
                {measured(one, unit)}
                <button
                  class="icon-button"
                  aria-label={`Delete measure ${n + 1}`}
                  onClick={() => store.change([{ op: "remove", path: `/view/measures/${n}` }])}
                >
                  ×
                </button>
              </span>
              <span class="dim">{one.points.map((point) => placeText(point, welcome)).join(" – ")}</span>
            </li>
          ))}
        </ol>
      )}
      <div class="row">
        <button class="button" disabled={measures.length === 0} onClick={() => store.change([set([], "view", "measures")])}>
          Delete all
        </button>
        <button
          class="button"
          disabled={measures.length === 0}
          onClick={() => ui.download("measures.csv", csv(), "text/csv")}
        >
          Save as CSV
        </button>
      </div>
    </>
  );
}
