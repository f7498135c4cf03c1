// What the page says of the program that draws: that it is gone or silent, and how far a picture at rest is.

import { useEffect, useState } from "preact/hooks";

import type { Connection, Engine } from "../engine/engine.ts";
import type { ViewName } from "../state/state.ts";
import { WORDS } from "../words.ts";
import css from "./liveness.css";

export { css };

/** Whether the pictures on the screen are outdated, since the program that draws cannot be reached. */
export function isStale(connection: Connection): boolean {
  return connection.kind === "lost" || connection.kind === "silent";
}

/** A banner over the dimmed views: what has happened, and the one thing to do. */
export function Banner({ connection, engine }: { readonly connection: Connection; readonly engine: Engine }) {
  if (connection.kind !== "lost" && connection.kind !== "silent") return null;
  const { message, remedy } = connection.problem;
  return (
    <div class="banner" role="alert">
      <strong>{message}</strong>
      {remedy !== undefined && <span>{remedy}</span>}
      {connection.kind === "lost" && connection.retries && (
        <button class="button" onClick={() => engine.retry()}>{WORDS.status.retry}</button>
      )}
    </div>
  );
}

/** Milliseconds for which a picture must be under way before its ring is shown. */
const SHOWN_AFTER_MS = 350;
const RADIUS = 7;

/** A ring in the corner of a view with the share of the picture at rest that is drawn. */
export function Refining({ engine, view }: { readonly engine: Engine; readonly view: ViewName }) {
  const [part, setPart] = useState<number | null>(null);
  const [isDue, setDue] = useState(false);
  const isUnderWay = part !== null;
  useEffect(() => engine.onRefining((name, next) => name === view && setPart(next)), [engine, view]);
  useEffect(() => {
    setDue(false);
    if (!isUnderWay) return undefined;
    const timer = setTimeout(() => setDue(true), SHOWN_AFTER_MS);
    return () => clearTimeout(timer);
  }, [isUnderWay]);
  if (part === null || !isDue) return null;
  const percent = Math.floor(100 * part);
  const around = 2 * Math.PI * RADIUS;
  return (
    <div class="refining" role="progressbar" aria-label={WORDS.status.refining} aria-valuemin={0} aria-valuemax={100} aria-valuenow={percent}>
      <svg viewBox="0 0 18 18" aria-hidden="true">
        <circle cx={9} cy={9} r={RADIUS} />
        <circle cx={9} cy={9} r={RADIUS} stroke-dasharray={around} stroke-dashoffset={around * (1 - part)} />
      </svg>
      {WORDS.status.refined(percent)}
    </div>
  );
}
