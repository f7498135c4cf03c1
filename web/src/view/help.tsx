// Keys and gestures, as tables.

import { useEffect, useRef } from "preact/hooks";

import { GESTURES, KEYS } from "../input/keys.ts";

export function Help({ onClose }: { readonly onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    dialog.current?.showModal();
  }, []);
  return (
    <dialog ref={dialog} aria-labelledby="help-title" onClose={onClose}>
      <h2 id="help-title">Keys and gestures</h2>
      <p class="dim">Keys act in the focused view; in slices arrows move the crosshair.</p>
      <table>
        <caption class="hidden">Mouse and touch</caption>
        <tbody>
          {GESTURES.map(([gesture, what]) => (
            <tr key={gesture}><th scope="row">{gesture}</th><td>{what}</td></tr>
          ))}
        </tbody>
      </table>
      <table>
        <caption class="hidden">Keys</caption>
        <tbody>
          {KEYS.map(({ shown, text }) => (
            <tr key={shown}><th scope="row"><kbd>{shown}</kbd></th><td>{text}</td></tr>
          ))}
        </tbody>
      </table>
      <form method="dialog"><button class="button">Close</button></form>
    </dialog>
  );
}
