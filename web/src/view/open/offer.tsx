// What can be opened: a place to drop files, buttons that choose them, examples with their pictures, recent files.

import { useEffect, useState } from "preact/hooks";

import type { Engine, Offered } from "../../engine/engine.ts";
import { chosenIn } from "./dropped.ts";
import type { PageOpener } from "./page_opener.ts";
import { WORDS } from "../../words.ts";

const TEXT = WORDS.opening;

interface OfferProps {
  readonly opener: PageOpener;
  readonly engine: Engine;
  readonly host: "page" | "widget";
}

export function Offer({ opener, engine, host }: OfferProps) {
  const { offered } = opener;
  return (
    <>
      <div class="open-drop" data-over={opener.isOver}>
        <svg viewBox="0 0 48 48" aria-hidden="true"><path d="M24 6v24M14 20l10 10 10-10M8 34v8h32v-8" /></svg>
        <p class="open-big">{TEXT.drop}</p>
        <div class="row open-middle">
          <FileField opener={opener} label={TEXT.files} />
          <FileField opener={opener} label={TEXT.folder} folder />
        </div>
        <p class="dim">{TEXT.kinds}</p>
        {offered !== null && <p class="dim">{host === "page" ? TEXT.limit(offered.max_bytes) : TEXT.limitOfKernel(offered.max_bytes)}</p>}
      </div>
      {offered !== null && (
        <section aria-labelledby="open-examples">
          <h2 id="open-examples">{TEXT.examples}</h2>
          <ul class="open-examples">
            {offered.examples.map(({ name, title }) => (
              <li key={name}>
                <button class="open-tile" onClick={() => void opener.source({ example: name }, title)}>
                  <ExamplePicture engine={engine} name={name} />
                  <span>{title}</span>
                </button>
              </li>
            ))}
          </ul>
        </section>
      )}
      {offered?.recent && offered.recent.length > 0 && <RecentFiles opener={opener} recent={offered.recent} />}
    </>
  );
}

function RecentFiles({ opener, recent }: { readonly opener: PageOpener; readonly recent: NonNullable<Offered["recent"]> }) {
  return (
    <section aria-labelledby="open-recent">
      <div class="row open-apart">
        <h2 id="open-recent">{TEXT.recent}</h2>
        <button class="button" onClick={() => opener.clearRecent()}>{TEXT.clear}</button>
      </div>
      <ul class="open-recent">
        {recent.map(({ name, folder, is_there }, index) => (
          <li key={`${folder}/${name}`}>
            <button class="open-file" disabled={!is_there} onClick={() => void opener.source({ recent: index, name }, name)}>
              <span>{name}</span>
              <span class="dim">{is_there ? folder : `${folder} (${TEXT.gone})`}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

function FileField({ opener, label, folder = false }: { readonly opener: PageOpener; readonly label: string; readonly folder?: boolean }) {
  return (
    <label class={folder ? "button open-field" : "button first open-field"}>
      {label}
      <input
        class="hidden"
        type="file"
        multiple
        {...(folder ? { webkitdirectory: true } : {})}
        onChange={(event) => {
          // The list empties with the field.
          const files = chosenIn(event.currentTarget.files);
          event.currentTarget.value = "";
          if (files.length > 0) void opener.files(files);
        }}
      />
    </label>
  );
}

/** The first picture of an example, drawn by the session when it is shown. */
function ExamplePicture({ engine, name }: { readonly engine: Engine; readonly name: string }) {
  const [url, setUrl] = useState<string | null>(null);
  useEffect(() => {
    let made: string | null = null;
    let isGone = false;
    engine.ask("example_picture", { name }).then(
      ({ bytes }) => {
        if (isGone) return;
        made = URL.createObjectURL(new Blob([bytes], { type: "image/jpeg" }));
        setUrl(made);
      },
      () => undefined,
    );
    return () => {
      isGone = true;
      if (made !== null) URL.revokeObjectURL(made);
    };
  }, [engine, name]);
  return url === null ? <span class="open-picture" /> : <img class="open-picture" src={url} alt="" />;
}
