// What the pictures cost: kept for the corner overlay and, as `window.umbrage.stats`, for tests and the benchmark.

const KEEP = 400;
const WINDOW_MS = 1000;

/** Latencies in ms (input handler to completed draw), frames, bytes, and the newest header. */
export class Stats extends EventTarget {
  constructor() {
    super();
    this.latencies = [];
    this.frames = 0;
    this.bytes = 0;
    this.damaged = 0;
    this.told = false;
    this.decoding = 0;
    this.last = null;
    this.recent = [];
  }

  record(header, bytes, decode, now, inputs) {
    this.frames += 1;
    this.bytes += bytes;
    for (const time of inputs) this.latencies.push(now - time);
    if (this.latencies.length > KEEP) this.latencies.splice(0, this.latencies.length - KEEP);
    this.recent.push({ now, bytes });
    while (this.recent[0].now < now - WINDOW_MS) this.recent.shift();
    const latency = inputs.length ? now - inputs[inputs.length - 1] : null;
    const cost = header.render_ms + header.encode_ms + decode;
    this.last = { ...header, bytes, decode, latency, network: latency === null ? null : Math.max(0, latency - cost), at: now };
    this.dispatchEvent(new Event("frame"));
  }

  /** A frame arrived and is being decoded. */
  arrive() {
    this.told = false;
    this.decoding += 1;
  }

  /** Whether the server said that nothing more comes, and all that came is drawn. */
  get idle() {
    return this.told && this.decoding === 0;
  }

  /** Pictures drawn in the last second. */
  get rate() {
    const since = performance.now() - WINDOW_MS;
    return this.recent.filter((frame) => frame.now > since).length;
  }

  /** Bytes received in the last second. */
  get throughput() {
    const since = performance.now() - WINDOW_MS;
    return this.recent.reduce((sum, frame) => sum + (frame.now > since ? frame.bytes : 0), 0);
  }

  /** Median of the recorded latencies in ms, or null. */
  get medianLatency() {
    if (!this.latencies.length) return null;
    const sorted = [...this.latencies].sort((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
  }
}
