// Technique pickers: one card per published method of a slot, then the chosen one's parameters.

import { el, freshId, icon } from "./dom.js";
import { UnionPart } from "./form.js";
import { valueAt } from "./document.js";

/** What a technique costs and how wrong it is, as the study measured it with everything else at its default. */
const told = ({ sun, sun_ms: ms, camera, error, worst } = {}) => [
  error && `Error ${(100 * error).toFixed(0)} %, worst ${(100 * worst).toFixed(0)} %`,
  sun && `frame ${ms.toFixed(0)} ms (${sun.toPrecision(2)} yardsticks) as the sun moves, ${((ms * camera) / sun).toFixed(0)} ms (${camera.toPrecision(2)}) as the camera does`,
].filter(Boolean).join(" · ");

/** The picker of one slot. */
export class SlotPicker {
  constructor(context, slot, node) {
    Object.assign(this, { context, slot, path: slot.name });
    this.union = new UnionPart(context, slot.name, node, { picker: false });
    this.name = freshId("slot");
    this.list = freshId("techniques");
    this.title = el("span", { class: "slot-technique" });
    this.caption = el("span", { class: "caption" });
    this.paper = el("span", { class: "paper" });
    this.facts = el("span", { class: "facts" });
    this.known = {};
    this.button = el("button", { type: "button", class: "slot-button", "aria-expanded": "false", "aria-controls": this.list,
      on: { click: () => this.unfold(this.cards.hidden) } },
    el("span", { class: "slot-name", text: slot.title }), this.title, this.caption, this.paper, this.facts, icon("down"));
    this.radios = new Map();
    this.measured = new Map();
    this.note = el("p", { class: "facts" });
    this.cards = el("div", { id: this.list, class: "cards", role: "radiogroup", "aria-label": slot.title, hidden: true },
      slot.techniques.map((technique) => this.card(technique)), this.note);
    this.root = el("section", { class: "slot", data: { slot: slot.name } }, this.button, this.cards, this.union.root);
    this.button.addEventListener("pointerenter", () => context.hint?.({ title: slot.title, description: slot.help }, slot.name));
  }

  card(technique) {
    const note = technique.available ? technique.caption : technique.why_not;
    const radio = el("input", { type: "radio", name: this.name, value: technique.kind, disabled: !technique.available,
      on: { change: () => this.union.choose(technique.kind) } });
    this.radios.set(technique.kind, radio);
    const facts = el("span", { class: "facts" });
    this.measured.set(technique.kind, facts);
    const standard = technique.kind === this.slot.default ? el("span", { class: "badge", text: "default" }) : null;
    return el("label", { class: "card" }, radio,
      el("span", { class: "card-title" }, technique.title, standard),
      el("span", { class: "caption", text: note }),
      el("span", { class: "paper", text: technique.paper }), facts);
  }

  /** What the study measured of this slot's techniques, and how. */
  learn(known, note) {
    this.known = known;
    for (const [kind, facts] of this.measured) facts.textContent = told(known[kind]);
    this.facts.textContent = told(known[this.kind]);
    this.note.textContent = note;
  }

  unfold(open) {
    this.cards.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    if (open) this.radios.get(this.kind)?.focus({ preventScroll: true });
  }

  refresh(document) {
    this.kind = valueAt(document, this.slot.name)?.kind;
    const technique = this.slot.techniques.find((item) => item.kind === this.kind);
    this.title.textContent = technique?.title ?? this.kind;
    this.caption.textContent = technique?.caption ?? "";
    this.paper.textContent = technique?.paper ?? "";
    this.facts.textContent = told(this.known[this.kind]);
    for (const [kind, radio] of this.radios) radio.checked = kind === this.kind;
    this.union.refresh(document);
  }
}
