// The state as the session has confirmed it, and on top the changes made here that it has not confirmed yet.
//
// The session confirms each message of changes by the number of its newest change, and sends with each change by others
// the number of the newest change of this page that it had made by then. Messages keep their order, so a change by
// others belongs after our changes up to that number and before the later ones, which are made again on top. Page and
// session therefore hold the same state once all is confirmed, in whatever order changes met.

import { asSent, patched, type Operation } from "./patch.ts";
import type { ViewerState } from "./state.ts";

interface Change {
  readonly seq: number;
  readonly operations: readonly Operation[];
  /** The state after the change. */
  readonly after: ViewerState;
}

export class Replica {
  private changes: readonly Change[] = [];

  /** `confirmed`: the state of the session. */
  constructor(private confirmed: ViewerState) {}

  /** The newest state that the session has confirmed. */
  get base(): ViewerState {
    return this.confirmed;
  }

  /** The newest state, with unconfirmed changes. */
  get state(): ViewerState {
    return this.changes.at(-1)?.after ?? this.confirmed;
  }

  /** Whether changes up to a number wait for their confirmation. */
  isUnconfirmed(upTo: number): boolean {
    return this.changes.some(({ seq }) => seq <= upTo);
  }

  /** Makes a change here; `seq` is its number, larger than those before. */
  change(given: readonly Operation[], seq: number): void {
    const operations = asSent(given);
    this.changes = [...this.changes, { seq, operations, after: patched(this.state, operations) }];
  }

  /** The session has made all changes up to a number. */
  confirm(seq: number): void {
    this.confirmed = this.changes.filter((change) => change.seq <= seq).at(-1)?.after ?? this.confirmed;
    this.changes = this.changes.filter((change) => change.seq > seq);
  }

  /** The session has refused the changes up to a number: they are taken back, later ones stay. */
  refuse(seq: number): void {
    this.changes = this.changes.filter((change) => change.seq > seq);
    this.redo();
  }

  /** The session was changed by others after our changes up to `seq`. */
  merge(operations: readonly Operation[], seq: number): void {
    this.confirm(seq);
    this.confirmed = patched(this.confirmed, operations);
    this.redo();
  }

  private redo(): void {
    const changes: Change[] = [];
    let state = this.confirmed;
    for (const { seq, operations } of this.changes) {
      try {
        state = patched(state, operations);
        changes.push({ seq, operations, after: state });
      } catch {
        // Others removed the object of the change, so the session refuses it too.
      }
    }
    this.changes = changes;
  }
}
