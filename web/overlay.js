// The corner: what this picture cost, from the pointer to the screen; green while within the budget.

import { el, freshId, terms } from "./dom.js";

const BUDGET_MS = 60;
const EVERY_MS = 200;

const ms = (value) => (value === null || value === undefined ? "–" : `${value.toFixed(value < 10 ? 1 : 0)} ms`);

/** `1.2 MB` of a number of bytes. */
export function bytes(value) {
  if (value < 1000) return `${value} B`;
  return value < 1e6 ? `${(value / 1e3).toFixed(value < 1e4 ? 1 : 0)} kB` : `${(value / 1e6).toFixed(1)} MB`;
}

/** A chip that unfolds into a table of costs. */
export class Overlay {
  constructor(root, stats) {
    this.stats = stats;
    const id = freshId("costs");
    this.summary = el("span", { class: "chip-text", text: "no picture yet" });
    this.table = el("dl", { id, class: "costs", hidden: true });
    this.button = el("button", { type: "button", class: "chip", "aria-expanded": "false", "aria-controls": id, "aria-label": "What a picture costs",
      on: { click: () => this.unfold(this.table.hidden) } }, el("span", { class: "lamp", "aria-hidden": "true" }), this.summary);
    this.root = root;
    root.append(this.table, this.button);
    stats.addEventListener("frame", () => this.soon());
  }

  unfold(open) {
    this.table.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    this.draw();
  }

  /** Numbers that change thirty times a second cannot be read. */
  soon() {
    if (this.timer) return;
    this.timer = setTimeout(() => {
      this.timer = null;
      this.draw();
    }, EVERY_MS);
  }

  draw() {
    const frame = this.stats.last;
    if (!frame) return;
    const latency = this.stats.medianLatency;
    const within = latency === null || latency <= BUDGET_MS;
    this.button.dataset.within = String(within);
    const samples = `${frame.samples} of ${frame.target_samples} samples`;
    this.summary.textContent = frame.samples > 1 || frame.converged ? samples : `${ms(frame.render_ms)} · ${this.stats.rate} per second`;
    if (this.table.hidden) return;
    const rows = [
      ["render", ms(frame.render_ms)], ["encode", ms(frame.encode_ms)], ["network", ms(frame.network)], ["decode", ms(frame.decode)],
      ["input to picture", latency === null ? "–" : `${ms(latency)} median`], ["pictures", `${this.stats.rate} per second`],
      ["this picture", `${bytes(frame.bytes)} ${frame.codec.toUpperCase()}`], ["received", `${bytes(this.stats.throughput)} per second`],
      ["resolution", `${frame.width} × ${frame.height}`], ["samples", samples],
    ];
    if (frame.predicted_error !== null && frame.predicted_error !== undefined) rows.push(["expected error", `${(100 * frame.predicted_error).toFixed(1)} %`]);
    this.table.replaceChildren(...terms(rows));
  }
}
