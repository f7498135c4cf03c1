// The messages of the session, parsed: a header becomes a message with checked fields, or an error that names the field.
// Fields that are not listed pass through, so that a page of before shows what it knows of a newer session.

import { any, either, fields, flag, list, number, oneOf, point, share, text, whole, type Check } from "../state/checks.ts";
import { parseViewerState } from "../state/parse.ts";
import type { Operation } from "../state/patch.ts";
import { PANES } from "../state/state.ts";
import type { Cause, Frame, Offered, Problem, Question, Questions, Welcome } from "./engine.ts";
import type { Header, Payload } from "./framing.ts";

export type Message =
  | { readonly type: "start"; readonly offered: Offered; readonly session: string }
  | { readonly type: "welcome"; readonly welcome: Welcome; readonly session: string }
  /** Progress of opening (`id` null, no `view`), of a question, or of the picture at rest of a view. */
  | { readonly type: "progress"; readonly id: number | null; readonly view?: Frame["view"]; readonly part: number | null; readonly text: string }
  | { readonly type: "patch"; readonly operations: readonly Operation[]; readonly seq: number; readonly cause?: Cause }
  | { readonly type: "confirmed"; readonly seq: number; readonly corrections: readonly Operation[] }
  | { readonly type: "frame"; readonly frame: Frame }
  | { readonly type: "answer"; readonly id: number; readonly fields: Header; readonly payload: Payload }
  | { readonly type: "failed"; readonly id: number | null; readonly seq: number | null; readonly problem: Problem };

const open = (known: Readonly<Record<string, Check>>): Check => fields({ ...known, "*": any }, "message");
const orNull = (check: Check): Check => either(null, check);
const pair = list(number(), 2, 2);
const colorNodes = list(list(number(), 4, 4));
const box = list(point, 2, 2);
const views = oneOf("3d", ...PANES);
const operations = list(
  open({ op: oneOf("add", "replace", "remove"), path: text }),
);
const state: Check = (value, where) => {
  try {
    parseViewerState(value);
  } catch (error) {
    throw new Error(`${where}: ${(error as Error).message}`);
  }
};
const camera = open({ position: point, focal_point: point, view_up: point });
const volume = open({
  name: text, shape: point, spacing: point, unit: orNull(text), value_unit: text, kind: text, range: pair, robust_range: pair,
  bounds: box, is_anatomical: flag, n_times: whole, "times?": list(text), dtype: text, orientation: orNull(text), notes: list(text),
  affine: list(list(number(), 4, 4), 4, 4),
  color_field: orNull(open({ name: text, value_unit: text, color: colorNodes })),
});
const look = open({ transfer_function: open({}) });
const bytes = open({});
/** How the values of a slice become colours. */
const values = open({
  layers: list(
    open({
      layer: whole, kind: oneOf("window", "light", "over"), low: number(), step: number(0), color: colorNodes,
      "opacity?": list(pair), "lowest?": orNull(number()),
    }),
  ),
  labels: orNull(open({ colors: colorNodes, names: list(orNull(text)) })),
  background: list(share, 3, 3),
});
const statistics = { mean: number(), sd: number(), min: number(), max: number() };

/** Facts of what is open. */
const DATA = {
  volumes: list(volume, 1), bounds: box, fingerprint: text,
  presets: list(open({ name: text, description: text, kind: text, layers: list(whole) })),
  composites: list(text), kernels: list(text), window_names: open({ "*": pair }),
  standard_views: fields({ "*": camera }, "message"), upright: point, axis_ends: list(text, 6, 6),
};
/** Examples and recent files. */
const OFFERED = {
  examples: list(open({ name: text, title: text })),
  recent: orNull(list(open({ name: text, folder: text, is_there: flag }))),
  max_bytes: number(0),
};

const MESSAGES: Readonly<Record<Message["type"], Check>> = {
  start: open({ ...OFFERED, session: text }),
  welcome: open({ program: text, state, session: text, ...DATA }),
  progress: open({ id: orNull(whole), "view?": views, part: orNull(share), text }),
  patch: open({ operations, seq: whole, "cause?": oneOf("python", "other view") }),
  confirmed: open({ seq: whole, corrections: operations }),
  frame: open({
    view: views, number: whole, seq: whole, width: number(1), height: number(1), format: oneOf("jpeg", "png", "values"), "values?": values, at_rest: flag,
    pixel: number(0), settings: open({}), expected_psnr_db: orNull(number()),
    ms: open({ wait: number(), render: number(), encode: number() }), notes: list(text), "camera?": camera,
    "slice?": open({
      origin: point, right: point, down: point, normal: point, pixel: number(0), zoom: number(0), position: number(), range: pair,
      letters: orNull(open({ left: text, right: text, top: text, bottom: text })), window: orNull(pair), colors: orNull(text),
    }),
  }),
  answer: open({ id: whole }),
  failed: open({ id: orNull(whole), "seq?": whole, code: text, message: text, "field?": text, "remedy?": text }),
};

/** Answers by their questions; those that are bytes have no field. */
const ANSWERS: Readonly<Record<Question, Check>> = {
  data: open(DATA),
  offered: open(OFFERED),
  clear_recent: open(OFFERED),
  example_picture: bytes,
  upload_begin: open({ upload: whole }),
  upload: open({ received: number(0) }),
  discard: open({}),
  open: open({
    "found?": list(open({ kind: oneOf("volume", "labels", "shape"), name: text })),
    "notes?": list(text), "shown?": flag, "opened?": whole,
    "several?": open({ option: text, names: list(any), described: list(text) }),
  }),
  show: open({ operations }),
  histogram: open({ counts: list(number(0)), low: number(), high: number() }),
  region: open({ layers: list(orNull(open(statistics))) }),
  label_statistics: open({
    labels: list(
      open({
        number: whole, name: text, n_voxels: whole, volume: number(0), mean: orNull(number()), sd: orNull(number()),
        min: orNull(number()), max: orNull(number()),
      }),
    ),
  }),
  pick: open({ point: orNull(point), values: list(open({ name: text, value: orNull(number()), unit: text })), label: orNull(text) }),
  shape: open({
    shape: orNull(open({ kind: text, name: text, part: orNull(whole), label: text, value: orNull(number()), point, text })),
  }),
  layer_rows: open({
    rows: list(
      open({
        kind: oneOf("map", "channel", "look", "table"), colors: text, window: orNull(pair), threshold: orNull(number()), gamma: number(0), is_automatic: flag,
      }),
    ),
    maps: list(text),
  }),
  layer_change: open({ operations }),
  preset: open({ look }),
  preset_picture: bytes,
  framed: open({ camera }),
  first_view: open({ camera }),
  kept_in_view: open({ camera }),
  picture: open({ notes: list(text), name: text }),
  code: open({ text, name: text }),
  token: open({ token: text }),
  open_state: open({ state }),
};

/**
 * The message of a header and its payload.
 * Throws an error that names the field, if the message is not valid.
 */
export function parseMessage(header: Header, payload: Payload): Message {
  const type = header["type"];
  if (typeof type !== "string" || !Object.hasOwn(MESSAGES, type)) {
    throw new Error(`message: type is ${JSON.stringify(type)}; this page knows ${Object.keys(MESSAGES).join(", ")}`);
  }
  try {
    MESSAGES[type as Message["type"]](header, "");
  } catch (error) {
    throw new Error(`message ${type}: ${(error as Error).message}`);
  }
  return made(type as Message["type"], header, payload);
}

/** The answer to a question; throws an error that names the field, if the answer is not valid. */
export function parseAnswer<Q extends Question>(question: Q, header: Header, payload: Payload): Questions[Q]["answer"] {
  try {
    ANSWERS[question](header, "");
  } catch (error) {
    throw new Error(`answer to ${question}: ${(error as Error).message}`);
  }
  return (payload.length > 0 ? { ...header, bytes: payload } : header) as Questions[Q]["answer"];
}

/** The message whose fields are checked. */
function made(type: Message["type"], header: Header, payload: Payload): Message {
  switch (type) {
    case "start":
      return { type, offered: header as unknown as Offered, session: String(header["session"]) };
    case "welcome":
      return { type, welcome: header as unknown as Welcome, session: String(header["session"]) };
    case "frame":
      return { type, frame: { ...(header as unknown as Frame), bytes: payload } };
    case "answer":
      return { type, id: Number(header["id"]), fields: header, payload };
    case "failed": {
      const { id, seq, ...problem } = header as unknown as Problem & { id: number | null; seq?: number };
      return { type, id, seq: seq ?? null, problem };
    }
    default:
      return header as unknown as Message;
  }
}
