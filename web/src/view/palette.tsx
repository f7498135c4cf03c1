// The palette of commands, opened by Ctrl K: typing finds, arrows choose, Enter does.

import { useEffect, useRef, useState } from "preact/hooks";

import { WORDS } from "../words.ts";
import { commandsOf, found } from "./commands.ts";
import type { PartProps } from "./part.ts";

const TEXT = WORDS.palette;
/** Most commands that are listed. */
const MAX_ROWS = 40;

export function Palette({ onClose, ...part }: PartProps & { onClose(): void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const list = useRef<HTMLUListElement>(null);
  const [text, setText] = useState("");
  const [at, setAt] = useState(0);
  useEffect(() => dialog.current?.showModal(), []);
  useEffect(() => {
    list.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }, [at, text]);
  const rows = found(commandsOf(part, text), text).slice(0, MAX_ROWS);
  const run = (index: number): void => {
    const command = rows[index];
    if (command === undefined) return;
    if (command.fill !== undefined) {
      setText(command.fill);
      setAt(0);
      dialog.current?.querySelector("input")?.focus();
      return;
    }
    // First, since a command may move the focus, which closing gives back.
    dialog.current?.close();
    command.run();
  };
  const onKeyDown = (event: KeyboardEvent): void => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step !== undefined) setAt((rows.length + at + step) % Math.max(1, rows.length));
    else if (event.key === "Enter") run(at);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <dialog ref={dialog} class="palette" aria-label={TEXT.title} onClose={onClose} onClick={(event) => event.target === dialog.current && dialog.current?.close()}>
      <input
        type="text"
        role="combobox"
        aria-label={TEXT.find}
        aria-expanded="true"
        aria-controls="palette-list"
        aria-activedescendant={rows.length > 0 ? `palette-${at}` : undefined}
        placeholder={TEXT.find}
        autocomplete="off"
        spellcheck={false}
        value={text}
        onInput={(event) => {
          setText(event.currentTarget.value);
          setAt(0);
        }}
        onKeyDown={onKeyDown}
      />
      <ul id="palette-list" role="listbox" aria-label={TEXT.title} ref={list}>
        {rows.map(({ text: name, hint }, index) => (
          <li key={`${name} ${hint}`} id={`palette-${index}`} role="option" aria-selected={index === at} onClick={() => run(index)}>
            <span>{name}</span>
            <span class="dim">{hint}</span>
          </li>
        ))}
      </ul>
      {rows.length === 0 && <p class="dim">{TEXT.none}</p>}
    </dialog>
  );
}
