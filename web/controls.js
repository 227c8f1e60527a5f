// One control per declared parameter, made from its schema node: label, entry, unit, range, reset, error.

import { el, follow, freshId, humanise, iconButton, numberIn } from "./dom.js";
import { patchOf, same, valueAt } from "./document.js";
import { range, stepOf, unitOf } from "./schema.js";
import { fromHex, toHex } from "./colour.js";

const SLIDER_STEPS = 1000;
const LOG_FROM = 500;
const DRAG_PIXELS_PER_RANGE = 300;

/** A number as people write it: no more digits than the step deserves. */
export function written(value, step = 0) {
  if (!Number.isFinite(value)) return "";
  const digits = step >= 1 ? Math.max(0, Math.ceil(-Math.log10(step))) : 6;
  return String(Number(value.toPrecision(digits === 0 && Math.abs(value) >= 1e6 ? 7 : 6)));
}

/** Shared by every control: the row, its label, its reset and its place for an error. */
class Control {
  constructor(context, path, node) {
    Object.assign(this, { context, path, node });
    this.id = freshId("control");
    this.label = el("label", { for: this.id, class: "label", text: node.title ?? path });
    this.reset = iconButton("reset", `Reset ${node.title ?? path}`, () => this.set(context.defaultOf(path)), { class: "icon-button reset" });
    this.error = el("p", { class: "field-error", role: "alert", hidden: true });
    this.root = el("div", { class: "control", data: { path } }, el("div", { class: "control-head" }, this.label, this.badge(), this.reset), this.error);
    const hint = () => context.hint?.(node, path);
    this.root.addEventListener("pointerenter", hint);
    this.root.addEventListener("focusin", hint);
    context.controls.set(path, this);
  }

  badge() {
    const cost = this.node.umbrage?.cost;
    const words = { bake: "Starts a precomputation", build: "Recompiles the shader" }[cost];
    return words ? el("span", { class: "badge", text: cost, title: words }) : null;
  }

  forget() {
    this.context.controls.delete(this.path);
  }

  body(...nodes) {
    this.error.before(...nodes);
  }

  /** A bake is dear: it starts when the person lets go, not at every step of the way. */
  get dear() {
    return this.node.umbrage?.cost === "bake";
  }

  set(value) {
    const time = performance.now();
    this.fail("");
    this.context.store.change(patchOf(this.path, value), this.path, time);
  }

  fail(sentence) {
    this.error.textContent = sentence;
    this.error.hidden = !sentence;
    this.root.classList.toggle("refused", Boolean(sentence));
  }

  refresh(document) {
    const value = valueAt(document, this.path);
    const standard = this.context.defaultOf(this.path);
    this.reset.disabled = standard === undefined || same(value, standard);
    if (value !== undefined) this.show(value);
  }
}

class NumberControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    Object.assign(this, range(node));
    this.step = stepOf(node);
    this.bounded = this.minimum !== undefined && this.maximum !== undefined;
    this.logarithmic = this.bounded && this.minimum > 0 && this.maximum / this.minimum > LOG_FROM;
    this.entry = el("input", { id: this.id, type: "text", inputmode: "decimal", class: "entry", autocomplete: "off",
      on: { input: () => { this.typing = true; }, blur: () => { this.typing = false; }, change: () => this.commit(), keydown: (event) => this.key(event) } });
    const unit = el("span", { class: "unit", text: unitOf(node) });
    this.reset.after(el("span", { class: "number" }, this.entry, unit));
    if (this.bounded && !node.umbrage?.plays) this.body(this.track()); // no slider reaches all of time
    this.draggable(this.label);
  }

  track() {
    const name = `${this.node.title ?? this.path}, slider`;
    this.slider = el("input", { type: "range", min: 0, max: SLIDER_STEPS, step: 1, "aria-label": name,
      on: { input: () => this.slid(!this.dear), change: () => this.slid(true) } });
    const standard = this.context.defaultOf(this.path);
    const mark = el("span", { class: "mark", "aria-hidden": "true" });
    if (typeof standard === "number") mark.style.setProperty("--at", this.toSlider(standard) / SLIDER_STEPS);
    else mark.hidden = true;
    return el("div", { class: "track" }, mark, this.slider);
  }

  toSlider(value) {
    const { minimum: low, maximum: high } = this;
    const part = this.logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return Math.round(Math.min(1, Math.max(0, part)) * SLIDER_STEPS);
  }

  fromSlider(position) {
    const { minimum: low, maximum: high } = this;
    const part = position / SLIDER_STEPS;
    return this.rounded(this.logarithmic ? low * (high / low) ** part : low + part * (high - low));
  }

  rounded(value) {
    const whole = this.node.type === "integer" ? Math.round(value) : Number(value.toPrecision(5));
    return Math.min(this.maximum ?? Infinity, Math.max(this.minimum ?? -Infinity, whole));
  }

  slid(send) {
    const value = this.fromSlider(Number(this.slider.value));
    this.entry.value = written(value, this.step);
    if (send) this.set(value);
  }

  /** What was typed goes to the server as it is, which refuses it in words where it must. */
  commit() {
    this.typing = false;
    const value = numberIn(this.entry.value);
    if (Number.isFinite(value)) this.set(value);
    else this.fail(`“${this.entry.value}” is not a number.`);
  }

  key(event) {
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    event.preventDefault();
    this.typing = false;
    const size = this.step * (event.shiftKey ? 10 : 1) * (event.key === "ArrowUp" ? 1 : -1);
    this.set(this.rounded(valueAt(this.context.store.document, this.path) + size));
  }

  /** Drag on the label to change the number, as in Blender; a click still focuses the entry. */
  draggable(handle) {
    handle.classList.add("scrub");
    handle.addEventListener("pointerdown", (down) => {
      const from = valueAt(this.context.store.document, this.path);
      const span = this.bounded ? this.maximum - this.minimum : Math.max(1, Math.abs(from)) * 4;
      const target = (event) => this.rounded(from + ((event.clientX - down.clientX) / DRAG_PIXELS_PER_RANGE) * span);
      let last = null;
      const move = (event) => {
        if (last === null && Math.abs(event.clientX - down.clientX) < 3) return;
        last = target(event);
        this.entry.value = written(last, this.step);
        if (!this.dear) this.set(last);
      };
      follow(handle, down, move, () => last !== null && this.dear && this.set(last));
    });
  }

  show(value) {
    const kept = this.typing || (document.activeElement === this.entry && this.root.classList.contains("refused"));
    if (!kept) this.entry.value = written(value, this.step);
    if (this.slider) {
      if (!this.slider.matches(":active")) this.slider.value = this.toSlider(value);
      this.slider.setAttribute("aria-valuetext", `${written(value, this.step)} ${unitOf(this.node)}`.trim());
    }
  }
}

class SwitchControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    this.box = el("input", { id: this.id, type: "checkbox", role: "switch", class: "switch", on: { change: () => this.set(this.box.checked) } });
    this.reset.after(this.box);
  }

  show(value) {
    this.box.checked = value;
  }
}

class ChoiceControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    const options = node.enum.map((value, i) => el("option", { value: i, text: humanise(value) }));
    this.select = el("select", { id: this.id, class: "select", on: { change: () => this.set(node.enum[Number(this.select.value)]) } }, options);
    this.reset.after(this.select);
  }

  show(value) {
    this.select.value = this.node.enum.indexOf(value);
  }
}

class ColourControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    this.input = el("input", { id: this.id, type: "color", class: "colour", on: { input: () => this.set(fromHex(this.input.value)) } });
    this.reset.after(this.input);
  }

  show(value) {
    this.input.value = toHex(value);
  }
}

class VectorControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    this.label.removeAttribute("for");
    this.label.id = this.id;
    const axes = ["x", "y", "z"].slice(0, node.prefixItems.length);
    this.entries = axes.map((axis, i) => el("input", { type: "text", inputmode: "decimal", class: "entry", autocomplete: "off",
      "aria-label": `${node.title ?? path} ${axis}`, on: { change: () => this.commit(i) } }));
    const unit = el("span", { class: "unit", text: unitOf(node) });
    this.body(el("div", { class: "vector", role: "group", "aria-labelledby": this.id }, this.entries, unit));
  }

  commit(index) {
    const values = this.entries.map((entry) => numberIn(entry.value));
    if (values.every(Number.isFinite)) this.set(values);
    else this.fail(`“${this.entries[index].value}” is not a number.`);
  }

  show(value) {
    this.entries.forEach((entry, i) => { if (entry !== document.activeElement) entry.value = written(value[i]); });
  }
}

class TextControl extends Control {
  constructor(context, path, node) {
    super(context, path, node);
    const type = node.umbrage?.unit === "date" ? "date" : /time$/.test(path) ? "time" : "text";
    this.time = type === "time";
    this.input = el("input", { id: this.id, type, class: "text", step: this.time ? 1 : undefined, maxlength: node.maxLength,
      list: path.endsWith("time_zone") ? "time-zones" : undefined, on: { change: () => this.commit() } });
    this.body(this.input);
  }

  commit() {
    if (!this.input.value && this.input.type !== "text") this.fail("Is not complete.");
    else this.set(this.time && this.input.value.length === 5 ? `${this.input.value}:00` : this.input.value);
  }

  show(value) {
    if (this.input !== document.activeElement) this.input.value = value;
  }
}

const CONTROLS = { number: NumberControl, switch: SwitchControl, choice: ChoiceControl, colour: ColourControl, vector: VectorControl, text: TextControl };

/** The control for a schema node, or null where a person has nothing to set. */
export function controlFor(context, path, node) {
  const Kind = CONTROLS[context.schema.sort(node)];
  return Kind ? new Kind(context, path, node) : null;
}
