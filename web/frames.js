// Pictures as they arrive: header, decoding, order, acknowledgement, and what each one cost.

const HEADER_BYTES = 4;
const AHEAD = 2;
const MIME = { jpeg: "image/jpeg", png: "image/png" };

/** Header and image bytes of one binary message. */
export function parse(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, HEADER_BYTES, length));
  return { header: JSON.parse(text), image: new Uint8Array(buffer, HEADER_BYTES + length) };
}

/** A moving picture is decoded where it lies: a blob goes to another process first. */
async function decoded(data, codec) {
  const type = MIME[codec];
  if (codec !== "jpeg" || !("ImageDecoder" in window)) return createImageBitmap(new Blob([data], { type }));
  const decoder = new ImageDecoder({ data, type });
  return decoder.decode().then(({ image }) => image).finally(() => decoder.close());
}

/**
 * Decodes and draws frames, dropping what is older than the one drawn.
 *
 * A frame is acknowledged when it arrives, so that the next one is rendered meanwhile; where decoding falls behind,
 * once it is decoded.
 */
export class Frames {
  constructor(link, screen, stats) {
    this.link = link;
    this.screen = screen;
    this.stats = stats;
    this.latest = new Map();
    link.addEventListener("frame", (event) => this.take(event.detail));
    link.addEventListener("open", () => this.latest.clear());
  }

  async take(buffer) {
    const arrived = performance.now();
    const { header, image } = parse(buffer);
    this.stats.arrive();
    const early = this.stats.decoding <= AHEAD;
    if (early) this.link.ack(header.sequence);
    const bitmap = await decoded(image, header.codec).catch(() => null);
    this.stats.decoding -= 1;
    if (!early) this.link.ack(header.sequence);
    if (bitmap) this.draw(header, bitmap, buffer.byteLength, arrived);
    else this.stats.damaged += 1;
  }

  draw(header, bitmap, bytes, arrived) {
    const last = this.latest.get(header.stream) ?? -1;
    if (header.sequence < last) {
      bitmap.close();
      return;
    }
    this.latest.set(header.stream, header.sequence);
    this.screen.draw(header.stream, bitmap);
    bitmap.close();
    const drawn = performance.now();
    const inputs = header.stream === 0 ? this.link.drawn(header.version) : [];
    this.stats.record(header, bytes, drawn - arrived, drawn, inputs);
  }
}
