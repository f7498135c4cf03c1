// The state in a link: what is shown, never the data; with the fingerprint of the data.

/** Largest length of a link that mail programs and browsers take, in characters. */
const MAX_CHARACTERS = 8000;

/** A text (JSON with the fields `fingerprint` and `state`) as a part of a link, or null where it is too long: a file is better then. */
export async function linkPart(text: string): Promise<string | null> {
  const packed = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  const part = btoa(Array.from(packed, (byte) => String.fromCharCode(byte)).join(""))
    .replaceAll("+", "-")
    .replaceAll("/", "_")
    .replaceAll("=", "");
  return part.length > MAX_CHARACTERS ? null : part;
}

/** Decodes the part of a link: the state, still unchecked, and the fingerprint of its data. */
export async function fromLink(part: string): Promise<{ fingerprint: string; state: unknown }> {
  const binary = atob(part.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const text = new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw")));
  const found: unknown = JSON.parse(text);
  if (typeof found !== "object" || found === null || !("fingerprint" in found) || !("state" in found)) {
    throw new Error("the link holds no state of the viewer");
  }
  return { fingerprint: String(found.fingerprint), state: found.state };
}

async function through(
  bytes: Uint8Array<ArrayBuffer>,
  stream: CompressionStream | DecompressionStream,
): Promise<Uint8Array> {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}
