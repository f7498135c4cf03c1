// Files that were dropped or chosen, with their places in folders, and how they are sent to the session.

import type { Engine } from "../../engine/engine.ts";

/** A file and where it lay: folders and name with "/" between them. */
export interface Dropped {
  readonly path: string;
  readonly file: File;
}

/** Bytes of a piece, and pieces that may be on their way: messages to the session have at most 1 MiB. */
const PIECE = 1 << 19;
const MAX_ON_THEIR_WAY = 4;

/** The files of a drop, with the files of folders. Must be called in the event's handler, before anything is awaited. */
export function droppedIn(transfer: DataTransfer): Promise<Dropped[]> {
  const items = [...transfer.items].filter(({ kind }) => kind === "file");
  const found = items.map((item) => {
    const entry = item.webkitGetAsEntry();
    const file = item.getAsFile();
    if (entry !== null) return inEntry(entry, "");
    return Promise.resolve(file === null ? [] : [{ path: file.name, file }]);
  });
  return Promise.all(found).then((lists) => lists.flat());
}

/** The files of a field, which of a folder know their place in it. */
export function chosenIn(files: FileList | null): Dropped[] {
  return [...(files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
}

async function inEntry(entry: FileSystemEntry, folder: string): Promise<Dropped[]> {
  const path = `${folder}${entry.name}`;
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ path, file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: Dropped[] = [];
  for (;;) {
    // Each call of a reader returns some of the entries; no entries mean the end.
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) return found;
    found.push(...(await Promise.all(entries.map((one) => inEntry(one, `${path}/`)))).flat());
  }
}

/** A short name for files that were dropped together. */
export function nameOf(files: readonly Dropped[]): string {
  const [first] = files;
  if (first === undefined) return "";
  if (files.length === 1) return first.file.name;
  const folder = first.path.split("/")[0] ?? "";
  return files.every(({ path }) => path.startsWith(`${folder}/`)) ? folder : `${first.file.name} and ${files.length - 1} more`;
}

export const sizeOf = (files: readonly Dropped[]): number => files.reduce((sum, { file }) => sum + file.size, 0);

/** Sends files in pieces, and returns the number of the upload, which is discarded where it is aborted or fails. */
export async function send(engine: Engine, files: readonly Dropped[], progress: (part: number) => void, signal: AbortSignal): Promise<number> {
  const total = sizeOf(files);
  const { upload } = await engine.ask("upload_begin", { files: files.length, bytes: total });
  const waiting = new Set<Promise<unknown>>();
  try {
    for (const { path, file } of files) {
      for (let offset = 0; offset === 0 || offset < file.size; offset += PIECE) {
        const piece = new Uint8Array(await file.slice(offset, offset + PIECE).arrayBuffer());
        signal.throwIfAborted();
        const answer = engine.ask("upload", { upload, path, offset }, undefined, undefined, piece);
        const stored = answer.then(({ received }) => progress(total === 0 ? 1 : received / total)).finally(() => waiting.delete(stored));
        // Where several fail, the first failure is reported.
        stored.catch(() => undefined);
        waiting.add(stored);
        if (waiting.size >= MAX_ON_THEIR_WAY) await Promise.race(waiting);
      }
    }
    await Promise.all(waiting);
    signal.throwIfAborted();
  } catch (problem) {
    engine.ask("discard", { upload }).catch(() => undefined);
    throw problem;
  }
  return upload;
}
