// Messages as bytes: the length of the header (u32, little-endian), the header (JSON), payload.
// `python/wavesplat/_viewer/server/messages.py` is the twin.

export type Header = Readonly<Record<string, unknown>>;
export type Payload = Uint8Array<ArrayBuffer>;

export function packed(header: Header, payload: Payload = new Uint8Array()): Payload {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const message = new Uint8Array(4 + text.length + payload.length);
  new DataView(message.buffer).setUint32(0, text.length, true);
  message.set(text, 4);
  message.set(payload, 4 + text.length);
  return message;
}

export function unpacked(message: ArrayBuffer): { header: Header; payload: Payload } {
  if (message.byteLength < 4) throw new Error("message: it is shorter than the length of a header");
  const length = new DataView(message).getUint32(0, true);
  if (length > message.byteLength - 4) throw new Error(`message: the header has ${length} bytes, which did not come`);
  const header: unknown = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, length)));
  if (typeof header !== "object" || header === null || Array.isArray(header)) {
    throw new Error("message: the header must be an object");
  }
  return { header: header as Header, payload: new Uint8Array(message, 4 + length) };
}
