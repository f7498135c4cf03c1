// Steps of undo across a reload: kept in the storage of the tab, by the fingerprint of the data, while the tab is open.

import type { Steps, Store } from "./store.ts";

/** The part of `sessionStorage` that is used. */
export type Storage = Pick<globalThis.Storage, "getItem" | "setItem" | "removeItem">;

const keyOf = (fingerprint: string): string => `wavesplat-undo:${fingerprint}`;

/** Keeps the steps of a store; the older half of them as often as needed where there is no room for all. */
export function keepSteps(store: Store, fingerprint: string, storage: Storage): void {
  let { now, past, future } = store.steps;
  for (;;) {
    try {
      storage.setItem(keyOf(fingerprint), JSON.stringify({ now, past, future }));
      return;
    } catch {
      if (past.length + future.length === 0) {
        storage.removeItem(keyOf(fingerprint));
        return;
      }
      // The newest of the past are at its end, and so are the nearest of the future.
      [past, future] = [past.slice(Math.ceil(past.length / 2)), future.slice(Math.ceil(future.length / 2))];
    }
  }
}

/** Gives a store the steps that were kept, if they are of its state. */
export function resumeSteps(store: Store, fingerprint: string, storage: Storage): void {
  try {
    const text = storage.getItem(keyOf(fingerprint));
    if (text !== null) store.resume(JSON.parse(text) as Steps);
  } catch {
    // What cannot be read is as good as nothing.
  }
}
