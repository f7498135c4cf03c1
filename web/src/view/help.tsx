// Keys and gestures, as tables.

import { useEffect, useRef } from "preact/hooks";

import { KEYS } from "../input/keys.ts";
import { PANEL_WORDS } from "../panel_words.ts";
import { WORDS } from "../words.ts";

const TEXT = PANEL_WORDS.help;

export function Help({ onClose }: { readonly onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    dialog.current?.showModal();
  }, []);
  return (
    <dialog ref={dialog} class="help" aria-labelledby="help-title" onClose={onClose}>
      <form method="dialog" class="row">
        <h2 id="help-title">{WORDS.toolbar.help}</h2>
        <span class="spring" />
        <button class="button">{TEXT.close}</button>
      </form>
      <p class="dim">{TEXT.where}</p>
      <div class="columns">
        <table>
          <caption>{TEXT.gestures}</caption>
          <tbody>
            {PANEL_WORDS.gestures.map(([gesture, what]) => (
              <tr key={gesture}><th scope="row">{gesture}</th><td>{what}</td></tr>
            ))}
          </tbody>
        </table>
        <table>
          <caption>{TEXT.keys}</caption>
          <tbody>
            {KEYS.map(({ shown, text }) => (
              <tr key={shown}><th scope="row"><kbd>{shown}</kbd></th><td>{text}</td></tr>
            ))}
          </tbody>
        </table>
      </div>
    </dialog>
  );
}
