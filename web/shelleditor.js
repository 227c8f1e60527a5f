// The shell editor: how the shell stands on its surface, paint on its thickness, its cells and conflicts over the picture.
// Fetched when first wanted.

import * as api from "./api.js";
import { Brush } from "./brush.js";
import { el, freshId, say, segments } from "./dom.js";
import { Form } from "./form.js";
import { KeyFrames } from "./keyframes.js";
import { Lines, SORTS } from "./lines.js";

const VIEWS = {
  none: [],
  shell: ["surface", "top", "upright"],
  cells: ["side", "surface", "top", "upright"],
  conflicts: ["top", "before", "shorter", "conflict"],
};
const CHOICES = [["none", "Nothing"], ["shell", "Prisms"], ["cells", "Cells"], ["conflicts", "Conflicts"]];
const AGAIN_MS = 120;
const VERSIONS = 64;
const STEPS = 100;
const SMALLEST = 0.01;
const STRONGEST = 4;
const WEAKEST = 0.05;
const TYPES = { float32: Float32Array, uint32: Uint32Array, uint8: Uint8Array };
const PARTS = ["extrusion", "surface", "motion", "time"];

function decoded({ dtype, base64 }) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new TYPES[dtype](bytes.buffer);
}

/** The left panel of the shells' scene. */
export class ShellEditor {
  constructor(root, { screen, store, link, stats, pointer, notices, context, run }) {
    Object.assign(this, { root, screen, store, link, stats, notices, context, run });
    this.view = "cells";
    this.cameras = new Map([[stats.last?.version, store.accepted?.camera]]);
    this.lines = new Lines(screen.root, pointer.surface);
    this.brush = new Brush(screen.root, pointer, store, (words) => say(this.said, words), () => this.draw());
    store.addEventListener("scene", () => this.build());
    store.addEventListener("change", () => this.follow());
    link.addEventListener("message", ({ detail }) => ["state", "welcome"].includes(detail.type) && this.remember(detail));
    stats.addEventListener("frame", () => this.draw());
    screen.addEventListener("size", () => this.draw());
    addEventListener("keydown", (event) => event.key === "Escape" && this.painting(false));
    if (store.scene) this.build();
  }

  get open() {
    return !this.root.hidden && Boolean(this.form);
  }

  /** Which camera each version of the document has: lines belong to the picture shown, not to the one to come. */
  remember({ type, version, state }) {
    if (type === "welcome") this.cameras.clear();
    this.cameras.set(version, state.camera);
    if (this.cameras.size > VERSIONS) this.cameras.delete(this.cameras.keys().next().value);
  }

  build() {
    this.painting(false);
    this.form = null;
    const node = this.store.schema.fields(this.store.schema.root).find(([name]) => name === "extrusion")?.[1];
    if (!node) {
      this.root.hidden = true;
      return;
    }
    this.controls = new Map();
    this.form = new Form({ ...this.context(), controls: this.controls });
    this.form.addFields("extrusion", node);
    this.keys = new KeyFrames({ ...this.context(), controls: this.controls }, this.run);
    const views = segments("Lines over the picture", CHOICES, (view) => this.choose(view));
    this.radios = views.radios;
    this.facts = el("p", { class: "facts" });
    this.words = el("ul", { class: "facts warnings" });
    this.key = el("div", { class: "line-key", "aria-label": "What the lines are" });
    this.said = el("p", { class: "facts", role: "status" });
    this.root.querySelector(".panel-body").replaceChildren(
      el("div", { class: "form beside-brush" }, el("span", { class: "label", text: "Lines over the picture" }), views.group, this.key, this.facts, this.words),
      this.brushPart(), el("div", { class: "beside-brush" }, this.form.root),
      el("details", { class: "fold beside-brush", open: this.store.document.course.keys.length > 0, on: { toggle: () => this.follow() } },
        el("summary", {}, el("h3", { text: "Key frames" })), el("div", { class: "fold-body" }, this.keys.root)));
    this.follow();
  }

  brushPart() {
    const slider = (label, show, read) => {
      const id = freshId("brush");
      const entry = el("output", { for: id, class: "unit" });
      const input = el("input", { id, type: "range", min: 0, max: STEPS, step: 1, on: { input: () => { read(Number(input.value) / STEPS); show(input, entry); this.draw(); } } });
      return { root: el("div", { class: "control" }, el("div", { class: "control-head" }, el("label", { class: "label", for: id, text: label }), entry), input), show: () => show(input, entry) };
    };
    const place = (input, entry, share, words) => {
      input.value = Math.round(share * STEPS);
      input.setAttribute("aria-valuetext", words);
      entry.value = words;
    };
    const power = (low, high, share) => Number((low * (high / low) ** share).toPrecision(3));
    const share = (low, high, value) => Math.log(value / low) / Math.log(high / low);
    const ends = () => { const most = this.lines.radius ?? 1; return [SMALLEST * most, most]; };
    const radius = slider("Radius", (input, entry) => place(input, entry, share(...ends(), this.brush.radius), `${this.brush.radius} m`),
      (at) => { this.brush.radius = power(...ends(), at); });
    const factor = slider("Thickness there", (input, entry) => place(input, entry, share(WEAKEST, STRONGEST, this.brush.factor), `× ${this.brush.factor}`),
      (at) => { this.brush.factor = power(WEAKEST, STRONGEST, at); });
    this.sliders = [radius, factor];
    const id = freshId("paint");
    this.box = el("input", { id, type: "checkbox", role: "switch", class: "switch", on: { change: () => this.painting(this.box.checked) } });
    this.clear = el("button", { type: "button", class: "quiet", text: "Take all paint off", on: { click: () => this.store.change({ extrusion: { paint: [] } }, "paint off") } });
    const help = el("p", { class: "facts", text: "Drag on the shell, or press Enter for the middle of the picture. Two fingers, the right button and the arrow keys move the camera." });
    this.brushFields = el("div", { class: "form", hidden: true }, radius.root, factor.root, help);
    return el("div", { class: "form" }, el("div", { class: "control" }, el("div", { class: "control-head" }, el("label", { class: "label", for: id, text: "Paint the thickness" }), this.box)),
      this.brushFields, this.said, this.clear);
  }

  /** Open or close: the lines come and go with the panel. */
  shown() {
    if (this.root.hidden) this.painting(false);
    this.follow();
    this.draw();
  }

  choose(view) {
    this.view = view;
    this.follow();
    this.draw();
  }

  painting(on) {
    this.brush.on = on && this.open;
    this.brush.point(null);
    document.body.classList.toggle("painting", this.brush.on);
    if (!this.form) return;
    this.box.checked = this.brush.on;
    this.brushFields.hidden = !this.brush.on;
    this.follow();
  }

  /** Bring the panel up to date; lines are asked for again where the shell is another. */
  follow() {
    if (!this.open) return;
    const { document } = this.store;
    this.form.refresh(document);
    this.keys.refresh(document);
    for (const radio of this.radios) radio.checked = radio.value === this.view;
    this.clear.disabled = !document.extrusion.paint.length;
    const wanted = PARTS.map((name) => document[name]);
    if (wanted.every((part, i) => part === this.wanted?.[i]) || this.asking) return;
    if (this.view === "none" && !this.brush.on) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.ask(wanted), AGAIN_MS);
  }

  /** One request at a time; what changed meanwhile asks again. A refusal is told by the picture itself. */
  async ask(wanted) {
    this.asking = true;
    this.wanted = wanted;
    try {
      this.take(await api.outline(this.store.document));
    } catch (error) {
      say(this.facts, error.message);
    }
    this.asking = false;
    this.follow();
  }

  take({ arrays, facts, words }) {
    const outline = Object.fromEntries(Object.entries(arrays).map(([name, coded]) => [name, decoded(coded)]));
    const first = !this.outline;
    this.outline = outline;
    this.lines.take(outline);
    this.brush.take(outline);
    if (first) this.brush.radius = Number((this.lines.radius / 6).toPrecision(2));
    for (const slider of this.sliders) slider.show();
    const count = (name) => facts[name].toLocaleString("en");
    say(this.facts, `${count("triangles")} triangles, ${count("tetrahedra")} tetrahedra.`);
    this.words.replaceChildren(...words.map((text) => el("li", { text: `${text}.` })));
    if (!this.lines.able) say(this.facts, "This browser cannot draw lines over the picture: it has no WebGL.");
    this.draw();
  }

  draw() {
    if (!this.form) return;
    const camera = this.open && this.outline ? this.cameras.get(this.stats.last?.version) ?? this.store.document.camera : null;
    const sorts = VIEWS[this.view].filter((name) => this.lines.counts?.[name]);
    this.lines.draw(camera, sorts, this.brush.on ? this.brush.rings() : []);
    const shown = this.open ? sorts.join() : "";
    if (shown === this.named) return;
    this.named = shown;
    this.key.replaceChildren(...(shown ? sorts : []).map((name) => this.swatch(...SORTS[name])));
  }

  swatch(name, [red, green, blue]) {
    const colour = `rgb(${[red, green, blue].map((value) => Math.round(255 * value)).join(" ")})`;
    return el("span", {}, el("i", { style: { background: colour }, "aria-hidden": "true" }), name);
  }

  /** Show a refusal at its control; false where none shows that field. */
  fail(field, sentence) {
    const control = this.open && this.controls.get(field);
    if (!control) return false;
    control.fail(sentence);
    control.root.scrollIntoView({ block: "nearest" });
    return true;
  }
}
