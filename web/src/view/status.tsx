// The status of the viewer: opening, problems, notes on the picture, statistics of frames.

import { useEffect, useReducer, useState } from "preact/hooks";

import type { Connection, Problem } from "../engine/engine.ts";
import { WORDS } from "../words.ts";
import { FreshNotes, noteForPage, NOTED_MS } from "./notes.ts";
import type { PartProps } from "./part.ts";

const TEXT = WORDS.status;

export function Opening({ connection, problem }: { readonly connection: Connection; readonly problem: Problem | null }) {
  if (problem !== null) {
    return (
      <div class="opening" role="alert">
        <h2>{TEXT.notOpened}</h2>
        <p>{problem.message}</p>
        {problem.remedy !== undefined && <p class="dim">{problem.remedy}</p>}
      </div>
    );
  }
  const isOpening = connection.kind === "connecting";
  return (
    <div class="opening" role="status">
      <p>{(isOpening && connection.text) || TEXT.opening}</p>
      {isOpening && connection.part !== undefined ? <progress max={1} value={connection.part} /> : <progress />}
    </div>
  );
}

export function ProblemCard({ problem, onClose }: { readonly problem: Problem; readonly onClose: () => void }) {
  return (
    <div class="alert" role="alert">
      <strong>{problem.message}</strong>
      {problem.field !== undefined && <span>{TEXT.field(problem.field)}</span>}
      {problem.remedy !== undefined && <span class="dim">{problem.remedy}</span>}
      <button class="button" onClick={onClose}>{TEXT.close}</button>
    </div>
  );
}

export function Status(props: PartProps & { readonly figures: boolean }) {
  const { ui, figures } = props;
  const frame = ui.frames["3d"] ?? Object.values(ui.frames)[0];
  const notes = useFresh(frame?.notes ?? []);
  return (
    <div class="status">
      {notes.map((note) => <span key={note} role="note">{noteForPage(note)}</span>)}
      {ui.probed && <span>{ui.probed}</span>}
      {figures && <Figures {...props} />}
    </div>
  );
}

/** The notes that are new; the page is drawn anew when they are not any more. */
function useFresh(notes: readonly string[]): readonly string[] {
  const [known] = useState(() => new FreshNotes());
  const [, redraw] = useReducer((count: number) => count + 1, 0);
  const fresh = known.of(notes, performance.now());
  useEffect(() => {
    if (fresh.length === 0) return undefined;
    const timer = setTimeout(() => redraw(null as never), NOTED_MS);
    return () => clearTimeout(timer);
  }, [fresh.join()]);
  return fresh;
}

function Figures({ ui }: PartProps) {
  const recent = ui.statistics.recent(performance.now());
  const frame = ui.frames["3d"];
  if (frame === undefined) return null;
  const { sheets_per_slice, oversampling, scale } = frame.settings;
  const parts = [
    recent === null ? null : TEXT.framesPerSecond(recent.framesPerSecond.toFixed(0)),
    recent?.latency == null ? null : TEXT.latency(recent.latency.toFixed(0)),
    TEXT.drawn(frame.ms.render.toFixed(0), frame.ms.encode.toFixed(0)),
    `${(frame.bytes.length / 1000).toFixed(0)} kB ${frame.format}`,
    `${frame.width} x ${frame.height}`,
    TEXT.sampling(Number(sheets_per_slice ?? 0).toFixed(1), (Number(oversampling ?? 0) * Number(scale ?? 1)).toFixed(2)),
    frame.expected_psnr_db === null ? null : TEXT.error(frame.expected_psnr_db.toFixed(0)),
  ];
  return <span class="figures">{parts.filter((part) => part !== null).join(" · ")}</span>;
}
