// Facts of what is open, asked for anew when the state names other volumes: opened here, undone, or set by others.

import type { Data, Engine } from "../../engine/engine.ts";
import type { ViewerState } from "../../state/state.ts";

const namesOf = (state: ViewerState): string => state.layers.map(({ volume }) => volume.id ?? "").join();

export class DataFollower {
  private known: string;
  private isAsking = false;

  constructor(
    private readonly engine: Engine,
    private readonly state: () => ViewerState,
    private readonly show: (data: Data) => void,
  ) {
    this.known = namesOf(state());
  }

  /** Asks if the state names other volumes than before. */
  check(): void {
    const names = namesOf(this.state());
    if (this.isAsking || names === this.known) return;
    this.isAsking = true;
    this.engine.ask("data", {}).then(
      (data) => {
        this.isAsking = false;
        this.known = names;
        this.show(data);
        this.check();
      },
      () => {
        // After the next change, when there is a connection.
        this.isAsking = false;
      },
    );
  }
}
