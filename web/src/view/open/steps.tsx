// The steps of opening as they are shown: progress, a choice among several, and how what was read is shown.

import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

import type { How } from "../../engine/engine.ts";
import type { PartProps } from "../part.ts";
import { Offer } from "./offer.tsx";
import type { PageOpener } from "./page_opener.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.opening;

/** All that opening shows over a volume. */
export function Openings(props: PartProps) {
  const { ui, store } = props;
  const { opener } = ui;
  return (
    <>
      {opener.isOver && !opener.isShown && <div class="open-over" aria-hidden="true"><p>{TEXT.dropNow}</p></div>}
      {opener.isShown && (
        <Dialog title={TEXT.openTitle} onClose={() => opener.show(false)} wide>
          <Offer opener={opener} engine={props.engine} host={ui.host} />
          <div class="row"><button class="button" onClick={() => opener.show(false)}>{TEXT.close}</button></div>
        </Dialog>
      )}
      <Progress opener={opener} />
      <SeveralDialog opener={opener} />
      <HowDialog opener={opener} scan={store.state.layers[0]?.name ?? ""} />
    </>
  );
}

export function Progress({ opener }: { readonly opener: PageOpener }) {
  const { step } = opener;
  if (step.kind !== "sending" && step.kind !== "reading") return null;
  const text = step.kind === "sending" ? TEXT.sending(step.name) : TEXT.reading(step.name);
  return (
    <div class="open-progress" role="status">
      <span>{text}</span>
      {step.kind === "sending" ? <progress aria-label={text} max={1} value={step.part} /> : <progress aria-label={text} />}
      <button class="button" onClick={() => opener.cancel()}>{TEXT.cancel}</button>
    </div>
  );
}

/** Asks which of several series or datasets is opened. */
export function SeveralDialog({ opener }: { readonly opener: PageOpener }) {
  const { step } = opener;
  // With a key, so that each file begins with its own first series.
  return step.kind === "several" ? <SeveralChoices key={step.name} opener={opener} step={step} /> : null;
}

function SeveralChoices({ opener, step }: { readonly opener: PageOpener; readonly step: Extract<PageOpener["step"], { kind: "several" }> }) {
  const [chosen, setChosen] = useState(0);
  const { names, described } = step;
  return (
    <Dialog title={TEXT.several(step.name)} onClose={() => opener.cancel()}>
      <fieldset class="open-choices">
        <legend>{TEXT.whichOne(step.option)}</legend>
        {names.map((name, index) => (
          <label key={name} class="row">
            <input type="radio" name="open-several" checked={index === chosen} onChange={() => setChosen(index)} />
            <span>{described[index] ?? String(name)}</span>
          </label>
        ))}
      </fieldset>
      <div class="row">
        <button
          class="button"
          data-first
          onClick={() => {
            const name = names[chosen] ?? names[0];
            if (name !== undefined) void opener.pick(name);
          }}
        >
          {TEXT.openIt}
        </button>
        <button class="button" onClick={() => opener.cancel()}>{TEXT.cancel}</button>
      </div>
    </Dialog>
  );
}

function HowDialog({ opener, scan }: { readonly opener: PageOpener; readonly scan: string }) {
  const { step } = opener;
  if (step.kind !== "choosing") return null;
  const hasLabels = step.found.some(({ kind }) => kind === "labels");
  const choices: readonly (readonly [How, string, string])[] = [
    ...(hasLabels ? [["labels", TEXT.labels, TEXT.labelsNote(scan)] as const] : []),
    ["overlay", TEXT.overlay, TEXT.overlayNote],
    ["replace", TEXT.replace, TEXT.replaceNote],
  ];
  return (
    <Dialog title={TEXT.how(step.name)} onClose={() => opener.cancel()}>
      <div class="open-hows">
        {choices.map(([how, name, note], index) => (
          <button key={how} class="open-how" data-first={index === 0} onClick={() => void opener.choose(how)}>
            <strong>{name}</strong>
            <span class="dim">{note}</span>
          </button>
        ))}
      </div>
      {step.notes.map((note) => <p key={note} class="dim" role="note">{note}</p>)}
      <div class="row"><button class="button" onClick={() => opener.cancel()}>{TEXT.cancel}</button></div>
    </Dialog>
  );
}

/** A dialog over the page; the element with `data-first` has the focus at first. */
function Dialog(props: { readonly title: string; readonly onClose: () => void; readonly wide?: boolean; readonly children: ComponentChildren }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    dialog.current?.showModal();
    dialog.current?.querySelector<HTMLElement>("[data-first=true], [data-first='']")?.focus();
  }, []);
  return (
    <dialog
      ref={dialog}
      class={props.wide === true ? "open-dialog open-wide" : "open-dialog"}
      aria-label={props.title}
      onCancel={(event) => {
        // It is taken away by its owner, which may have more to do.
        event.preventDefault();
        props.onClose();
      }}
      // Keys of the views are for the page behind it.
      onKeyDown={(event) => event.stopPropagation()}
    >
      <h2>{props.title}</h2>
      {props.children}
    </dialog>
  );
}
