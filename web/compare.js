// A beside B: another technique or the reference, by split, blink, difference or error map, with the numbers.
// Fetched when first wanted.

import * as api from "./api.js";
import { same } from "./document.js";
import { el, follow, freshId, say, scaleBar, segments, terms } from "./dom.js";
import { Progress } from "./notices.js";

const BLINK_MS = 700;
const MODES = [["split", "Split"], ["blink", "Blink"], ["difference", "Difference"], ["error", "Error map"]];
const percent = (value) => `${(100 * value).toFixed(2)} %`;
const NUMBERS = [
  ["relative_rmse", "Relative RMSE", percent], ["flip_mean", "FLIP, mean", (v) => v.toFixed(4)],
  ["flip_p95", "FLIP, 95th percentile", (v) => v.toFixed(4)], ["standard_error", "Reference's own error", percent],
  ["seconds", "Reference took", (v) => `${v.toFixed(1)} s`], ["size", "Compared at", (v) => v.join(" × ")],
];
const REFERENCE_SIDE = 128;

/** The left panel and the split on the picture. */
export class Compare {
  constructor(root, screen, store, link, notices) {
    Object.assign(this, { root, screen, store, link, notices });
    this.mode = "split";
    this.at = 0.5;
    this.handle = el("div", { class: "split", role: "slider", tabindex: 0, "aria-label": "Split between A and B", "aria-valuemin": 0,
      "aria-valuemax": 100, hidden: true, on: { pointerdown: (event) => this.drag(event), keydown: (event) => this.key(event) } });
    this.tagA = el("span", { class: "glass tag tag-a", hidden: true });
    this.tagB = el("span", { class: "glass tag tag-b", hidden: true });
    screen.root.append(this.handle, this.tagA, this.tagB);
    store.addEventListener("scene", () => this.build());
    if (store.scene) this.build();
    store.addEventListener("change", () => this.staleReference());
    link.addEventListener("open", () => this.patch && this.link.send({ type: "compare", patch: this.patch }));
  }

  build() {
    const picker = (change) => el("select", { class: "select", id: freshId("pick"), on: { change } });
    const row = (text, control) => el("div", { class: "control" }, el("label", { class: "label", for: control.id, text }), control);
    this.slot = picker(() => this.fillKinds());
    this.slot.append(...this.store.scene.slots.map((slot) => el("option", { value: slot.name, text: slot.title })));
    this.kind = picker(() => this.technique());
    const modes = segments("How to compare", MODES, (mode) => this.show(mode));
    Object.assign(this, { radios: modes.radios, modes: modes.group });
    this.progress = new Progress(() => this.abort?.abort());
    this.progress.root.hidden = true;
    this.numbers = el("dl", { class: "costs" });
    this.note = el("div", { class: "form" });
    this.scale = el("div", { class: "control", hidden: true });
    const gain = el("input", { type: "range", id: freshId("gain"), min: 1, max: 16, step: 1, value: 4,
      on: { input: () => this.screen.root.style.setProperty("--gain", gain.value) } });
    this.gainRow = row("Gain of the difference", gain);
    this.root.querySelector(".panel-body").replaceChildren(
      this.note, row("B differs in", this.slot), row("B uses", this.kind),
      el("button", { type: "button", class: "wide", text: "Compare with the reference", on: { click: () => this.reference() } }),
      this.progress.root, modes.group, this.gainRow, this.scale, this.numbers,
      this.end = el("button", { type: "button", class: "quiet", text: "Stop comparing", on: { click: () => this.stop() } }));
    this.fillKinds(false);
    this.update();
  }

  fillKinds(start = true) {
    const slot = this.store.scene.slots.find((item) => item.name === this.slot.value);
    const here = this.store.document[slot.name]?.kind;
    const options = slot.techniques.filter((item) => item.available);
    this.kind.replaceChildren(el("option", { value: "", text: "Choose …" }), ...options.map((item) => el("option", { value: item.kind, text: item.title })));
    this.kind.value = start ? (options.find((item) => item.kind !== here) ?? options[0])?.kind ?? "" : "";
    if (start) this.technique();
  }

  title(slotName, kind) {
    const slot = this.store.scene.slots.find((item) => item.name === slotName);
    return slot?.techniques.find((item) => item.kind === kind)?.title ?? kind;
  }

  /** B is the same scene with another technique, streamed beside A. */
  technique() {
    if (!this.kind.value) return this.stop();
    const slot = this.slot.value;
    const node = this.store.schema.members(this.store.schema.at(slot, this.store.document)).get(this.kind.value);
    this.beside({ [slot]: this.store.schema.fresh(node) });
  }

  /** B is the picture with a patch over it; `words` name A and B where their kinds do not, a note says what to look for. */
  beside(patch, words = null, note = []) {
    const [slot] = Object.keys(patch);
    this.patch = patch;
    this.words = words && { words, of: this.store.document[slot] };
    this.truth = null;
    this.numbers.replaceChildren();
    this.note.replaceChildren(...note);
    this.slot.value = slot;
    this.fillKinds(false);
    this.kind.value = patch[slot].kind;
    this.link.send({ type: "compare", patch });
    this.show(this.mode === "error" ? "split" : this.mode);
  }

  /** B is the slow truth, computed once for the state as it is now. */
  async reference() {
    this.abort?.abort();
    const abort = this.abort = new AbortController();
    const state = this.store.document;
    const scale = Math.min(1, REFERENCE_SIDE / Math.max(this.screen.width, this.screen.height));
    const size = { width: Math.round(this.screen.width * scale), height: Math.round(this.screen.height * scale) };
    this.progress.root.hidden = false;
    this.progress.show({ words: "Waiting for the reference", fraction: 0 });
    try {
      const result = await api.job({ kind: "reference", state, ...size }, (progress) => this.progress.show(progress), abort.signal);
      if (state === this.store.document) await this.take(result);
      else this.notices.toast("The picture changed while its reference was computed: compare again.");
    } catch (error) {
      if (error.name !== "AbortError") this.notices.toast(error.message, "refusal");
    } finally {
      if (this.abort === abort) this.progress.root.hidden = true;
    }
  }

  async take(result) {
    if (this.patch) this.link.send({ type: "compare", patch: null });
    this.patch = null;
    this.kind.value = "";
    this.note.replaceChildren();
    const image = async (word) => {
      const [, url] = Object.entries(result.files).find(([name]) => name.startsWith(word));
      return createImageBitmap(await (await fetch(url)).blob());
    };
    [this.judged, this.truth, this.errorMap] = await Promise.all(["picture", "reference", "error"].map(image));
    this.legend(result);
    const known = NUMBERS.filter(([key]) => result[key] !== null && result[key] !== undefined);
    this.numbers.replaceChildren(...terms(known.map(([key, title, write]) => [title, write(result[key])])));
    this.show("split");
  }

  /** The reference belongs to one state; once that changes it is taken off rather than left to mislead. */
  staleReference() {
    if (this.truth) this.stop();
    else this.names();
  }

  /** What A and B show, in words. */
  names() {
    const [slot] = Object.keys(this.patch ?? {});
    const known = slot && this.words && same(this.words.of, this.store.document[slot]) ? this.words.words : null;
    const [a, b] = known ?? (slot ? [this.store.document[slot].kind, this.patch[slot].kind].map((kind) => this.title(slot, kind))
      : ["Picture", this.mode === "error" ? "Error" : "Reference"]);
    say(this.tagA, a);
    say(this.tagB, b);
  }

  /** The error map's colours, from no error to the top of its scale. */
  legend({ legend, saturated }) {
    const top = legend.at(-1)[0];
    this.scale.replaceChildren(el("span", { class: "label", text: "Error, as a share of the reference's mean" }),
      ...scaleBar(legend.map(([, colour]) => `rgb(${colour.join(" ")})`), [0, top / 2, top].map((value) => `${(100 * value).toFixed(0)} %`)),
      el("span", { class: "hint-facts", text: `${percent(saturated)} of the pixels lie above.` }));
  }

  show(mode) {
    this.mode = mode;
    this.active = Boolean(this.patch || this.truth);
    if (this.truth) this.screen.still(this.judged, mode === "error" ? this.errorMap : this.truth);
    this.screen.root.toggleAttribute("data-truth", Boolean(this.truth));
    this.names();
    clearInterval(this.blinking);
    const root = this.screen.root;
    root.dataset.compare = this.active ? mode : "";
    root.classList.remove("blink-b");
    if (this.active && mode === "blink") this.blinking = setInterval(() => root.classList.toggle("blink-b"), BLINK_MS);
    this.update();
  }

  update() {
    for (const radio of this.radios ?? []) {
      radio.checked = radio.value === this.mode;
      radio.disabled = radio.value === "error" && !this.truth;
    }
    this.modes.hidden = this.end.hidden = !this.active;
    this.gainRow.hidden = this.mode !== "difference";
    this.scale.hidden = !this.truth || this.mode !== "error";
    this.handle.hidden = !this.active || !["split", "error"].includes(this.mode);
    this.tagA.hidden = this.tagB.hidden = !this.active;
    this.screen.root.style.setProperty("--split", this.at);
    this.handle.setAttribute("aria-valuenow", Math.round(100 * this.at));
  }

  stop() {
    if (this.patch) this.link.send({ type: "compare", patch: null });
    this.screen.forget();
    this.abort?.abort();
    this.patch = this.truth = null;
    if (this.kind) this.kind.value = "";
    this.numbers?.replaceChildren();
    this.note?.replaceChildren();
    this.show("split");
  }

  drag(event) {
    event.preventDefault();
    this.handle.focus({ preventScroll: true });
    follow(this.handle, event, (moved) => this.move(moved.clientX / this.screen.root.clientWidth));
  }

  move(at) {
    this.at = Math.min(1, Math.max(0, at));
    this.update();
  }

  key(event) {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (!step) return;
    event.preventDefault();
    this.move(this.at + step);
  }
}
