// A session in the test's hands, behind a channel: its messages are said by the test, and the page's are kept.

import { readFileSync } from "node:fs";

import type { Channel, ChannelState } from "../src/engine/channel.ts";
import type { Engine } from "../src/engine/engine.ts";
import type { Header, Payload } from "../src/engine/framing.ts";
import { remoteEngine } from "../src/engine/remote.ts";
import type { ViewerState } from "../src/state/state.ts";

export const STATE = JSON.parse(readFileSync(new URL("../schema/state.json", import.meta.url), "utf8")) as ViewerState;

export const WELCOME: Header = {
  type: "welcome", protocol: 1, program: "wavesplat 0", session: "key", state: STATE,
  volumes: [{
    name: "ripples", shape: [16, 16, 16], spacing: [1, 1, 1], unit: null, value_unit: "", kind: "ct", range: [0, 1],
    robust_range: [0, 1], bounds: [[0, 0, 0], [15, 15, 15]], is_anatomical: false, n_times: 1,
    dtype: "float32", orientation: null, notes: [],
    affine: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], color_field: null,
  }],
  bounds: [[0, 0, 0], [15, 15, 15]], presets: [], composites: ["over"], kernels: ["linear"], window_names: { bone: [480, 2500] },
  standard_views: { front: STATE.camera }, upright: [0, 0, 1], axis_ends: ["-x", "+x", "-y", "+y", "-z", "+z"], fingerprint: "sha256:1",
};

export const LOST: ChannelState = { kind: "closed", problem: { code: "lost", message: "lost" }, retries: true };

export interface FakeSession {
  readonly engine: Engine;
  /** Messages of the page. */
  readonly sent: Header[];
  /** Says a message of the session. */
  say(header: Header, payload?: Payload): void;
  state(state: ChannelState): void;
  /** The next animation frame. */
  tick(): void;
  /** Opens the channel, and welcomes the page. */
  open(): void;
}

export function fakeSession(): FakeSession {
  const sent: Header[] = [];
  let message: (header: Header, payload: Payload) => void = () => undefined;
  let changed: (state: ChannelState) => void = () => undefined;
  const frames: (() => void)[] = [];
  const channel: Channel = {
    send: (header) => void sent.push(header),
    onMessage: (listener) => {
      message = listener;
      return () => undefined;
    },
    onState: (listener) => {
      changed = listener;
      return () => undefined;
    },
    retry: () => undefined,
    close: () => undefined,
    silence: { code: "silent", message: "no answer", remedy: "wait" },
  };
  const engine = remoteEngine(channel, { hello: () => ({ token: "t" }), nextFrame: (callback) => void frames.push(callback) });
  return {
    engine,
    sent,
    say: (header, payload = new Uint8Array()) => message(header, payload),
    state: (state) => changed(state),
    tick: () => frames.splice(0).forEach((callback) => callback()),
    open() {
      changed({ kind: "open" });
      message(WELCOME, new Uint8Array());
    },
  };
}
