// What the page says: progress with words and a way out, the connection's state, refusals in sentences.

import { el, iconButton } from "./dom.js";
import { sentence } from "./api.js";

const TOAST_MS = 9000;

/** Whole seconds in words, or nothing. */
export function secondsLeft(seconds) {
  if (seconds === null || seconds === undefined) return "";
  if (seconds < 90) return `about ${Math.max(1, Math.round(seconds))} s left`;
  return `about ${Math.round(seconds / 60)} min left`;
}

/** A bar with words, a fraction and an optional cancel button. */
export class Progress {
  constructor(onCancel) {
    this.words = el("span", { class: "progress-words" });
    this.left = el("span", { class: "progress-left" });
    this.bar = el("progress", { max: 1, value: 0, "aria-label": "Progress" });
    this.cancel = el("button", { type: "button", class: "quiet", text: "Cancel", on: { click: onCancel } });
    this.root = el("div", { class: "progress" }, el("div", { class: "progress-row" }, this.words, this.left, this.cancel), this.bar);
  }

  show({ words, fraction, seconds_left: left, cancellable = true }) {
    this.words.textContent = words;
    this.left.textContent = [`${Math.round(100 * (fraction ?? 0))} %`, secondsLeft(left)].filter(Boolean).join(" · ");
    this.bar.value = fraction ?? 0;
    this.cancel.hidden = !cancellable;
  }
}

/** Toasts, the progress card at the top and the line about the connection. */
export class Notices {
  constructor(root, link) {
    this.root = root;
    this.progress = new Progress(() => link.send({ type: "cancel" }));
    this.card = el("div", { class: "glass notice", hidden: true }, this.progress.root);
    this.line = el("p", { class: "glass notice line", role: "status", hidden: true });
    this.retry = el("button", { type: "button", class: "quiet", text: "Try now", on: { click: () => link.retry() } });
    this.toasts = el("div", { class: "toasts", role: "alert" });
    root.append(this.line, this.card, this.toasts);
  }

  working(progress) {
    this.card.hidden = !progress;
    if (progress) this.progress.show(progress);
  }

  /** Words about the connection, or null when all is well. */
  connection(words, retry = false) {
    this.line.hidden = !words;
    this.line.replaceChildren(words ?? "", ...(retry ? [this.retry] : []));
  }

  /** A refusal that no visible control can show. */
  refuse(error) {
    this.toast(sentence(error), "refusal");
  }

  /** A line that goes away by itself; a refusal stays until it is dismissed. */
  toast(words, sort = "") {
    const toast = el("div", { class: `glass toast ${sort}` }, el("span", { text: words }), iconButton("close", "Dismiss", () => toast.remove()));
    this.toasts.append(toast);
    while (this.toasts.children.length > 3) this.toasts.firstChild.remove();
    if (!sort) setTimeout(() => toast.remove(), TOAST_MS);
  }
}
