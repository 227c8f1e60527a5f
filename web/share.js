// The state as a link: packed into the address, kept up to date there, and read from it.

const SETTLE_MS = 700;

async function squeeze(bytes, Stream) {
  const stream = new Blob([bytes]).stream().pipeThrough(new Stream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** A state document as the part of an address after `#`. */
export async function encode(document) {
  const packed = await squeeze(new TextEncoder().encode(JSON.stringify(document)), CompressionStream);
  const text = btoa(String.fromCharCode(...packed));
  return `s=${text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "")}`;
}

/** The state document in the part of an address after `#`, or null where there is none. Raises where it is damaged. */
export async function decode(hash) {
  const text = new URLSearchParams(hash.replace(/^#/, "")).get("s");
  if (!text) return null;
  const packed = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
  return JSON.parse(new TextDecoder().decode(await squeeze(packed, DecompressionStream)));
}

/** Keeps the address up to date. */
export class Share {
  constructor(store, notices) {
    Object.assign(this, { store, notices });
    store.addEventListener("change", () => {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.remember(), SETTLE_MS);
    });
  }

  async link() {
    const address = new URL(location.href);
    address.hash = await encode(this.store.document);
    return address.href;
  }

  async remember() {
    if (this.store.document) history.replaceState(null, "", await this.link());
  }

  async copyLink() {
    await this.remember();
    await this.copy(location.href, "The link to this picture is copied.", "copy the link from the address bar");
  }

  async copy(text, words, otherwise = "select the text and copy it") {
    try {
      await navigator.clipboard.writeText(text);
      this.notices.toast(words);
    } catch {
      this.notices.toast(`The browser does not let the page copy: ${otherwise}.`);
    }
  }
}
