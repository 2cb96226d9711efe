// The page's contents as a link: packed JSON after the `#`, which browsers do not send.

const VERSION = "1.";
const MOST = 1_000_000;

async function through(stream, bytes) {
  const parts = [];
  let size = 0;
  for await (const part of new Blob([bytes]).stream().pipeThrough(stream)) {
    size += part.length;
    if (size > MOST) throw new Error(`there are more than ${MOST.toLocaleString("en")} bytes in it`);
    parts.push(part);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/** The part of a link after its `#`. */
export async function packed(content) {
  const bytes = new TextEncoder().encode(JSON.stringify(content));
  const small = await through(new CompressionStream("deflate-raw"), bytes);
  const text = btoa(Array.from(small, (byte) => String.fromCharCode(byte)).join(""));
  return VERSION + text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The texts in a link, by name. Throws an Error if the link is not valid. */
export async function unpacked(fragment) {
  if (!fragment.startsWith(VERSION)) throw new Error("it is of another version");
  const text = fragment.slice(VERSION.length).replaceAll("-", "+").replaceAll("_", "/");
  const small = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const bytes = await through(new DecompressionStream("deflate-raw"), small);
  const content = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes));
  if (content === null || typeof content !== "object") throw new Error("there are no texts in it");
  const texts = Object.entries(content).filter(([, value]) => typeof value === "string");
  return Object.fromEntries(texts);
}
