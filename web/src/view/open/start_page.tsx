// The page before anything is open.

import type { Engine } from "../../engine/engine.ts";
import { WORDS } from "../../words.ts";
import { Offer } from "./offer.tsx";
import type { PageOpener } from "./page_opener.ts";
import { Progress, SeveralDialog } from "./steps.tsx";

export function StartPage({ opener, engine, host }: { readonly opener: PageOpener; readonly engine: Engine; readonly host: "page" | "widget" }) {
  const { failure } = opener;
  return (
    <main class="open-start">
      <div class="open-column">
        <h1 class="open-title">{WORDS.opening.name}</h1>
        {failure !== null && (
          <div class="open-failure" role="alert">
            <strong>{failure.message}</strong>
            {failure.remedy !== undefined && <span class="dim">{failure.remedy}</span>}
          </div>
        )}
        <Offer opener={opener} engine={engine} host={host} />
      </div>
      <Progress opener={opener} />
      <SeveralDialog opener={opener} />
    </main>
  );
}
