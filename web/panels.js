// The right panel: techniques by slot, then every other parameter of the scene, generated from its schema.

import * as api from "./api.js";
import { converted } from "./camera.js";
import { el, humanise } from "./dom.js";
import { valueAt } from "./document.js";
import { Form, UnionPart } from "./form.js";
import { range, Schema, stepOf, unitOf } from "./schema.js";
import { SlotPicker } from "./techniques.js";

const LATE = ["view", "quality", "camera"];
const COSTS = { live: "Shown with the next frame.", build: "Recompiles the shader.", bake: "Starts a precomputation when you let go.", host: "" };

/** Builds the panel from the scene and keeps it in step with the store. */
export class Panels {
  constructor(root, hintRoot, store, aspect, askFile) {
    Object.assign(this, { root, hintRoot, store, aspect, askFile });
    this.controls = new Map();
    this.parts = [];
    this.shown = new Map();
    store.addEventListener("scene", () => this.build());
  }

  context() {
    return {
      store: this.store, schema: this.store.schema, controls: this.controls,
      hint: (node, path) => this.hint(node, path),
      defaultOf: (path) => this.defaultOf(path),
      askFile: this.askFile,
      convert: (path, kind) => (path === "camera" ? this.cameraOf(kind) : null),
    };
  }

  /** The view kept, in the fields that the other kind of camera declares. */
  cameraOf(kind) {
    const member = this.store.schema.members(this.store.schema.at("camera", this.store.document)).get(kind);
    const fresh = this.store.schema.fresh(member);
    const view = converted(this.store.document.camera, kind, this.aspect());
    for (const key of Object.keys(fresh)) if (view[key] !== undefined) fresh[key] = view[key];
    return fresh;
  }

  /** The default of a path: the scene's own where its union still has that kind, else the member's. */
  defaultOf(path) {
    const { scene, schema, document } = this.store;
    const parent = path.split(".").slice(0, -1).join(".");
    const own = parent && valueAt(document, parent)?.kind !== valueAt(scene.defaults, parent)?.kind;
    return own ? schema.at(path, document)?.default : valueAt(scene.defaults, path);
  }

  build() {
    const { scene, schema } = this.store;
    this.controls.clear();
    this.shown.clear();
    const context = this.context();
    const fields = new Map(schema.fields(schema.root));
    const slots = scene.slots.filter((slot) => fields.has(slot.name)).map((slot) => new SlotPicker(context, slot, fields.get(slot.name)));
    const handled = new Set(["version", "scene", "sun", ...scene.slots.map((slot) => slot.name)]);
    const loose = new Form(context);
    const sections = [];
    this.parts = [...slots, loose];
    this.pickers = slots;
    this.learn();
    for (const [name, node] of [...fields].sort(([a], [b]) => LATE.indexOf(a) - LATE.indexOf(b))) {
      if (handled.has(name)) continue;
      const sort = schema.sort(node);
      if (sort !== "union" && sort !== "object") loose.add(name, node);
      else sections.push(this.section(context, name, node, sort));
    }
    this.root.replaceChildren(
      this.fold("Techniques", true, this.combined(scene), ...slots.map((slot) => slot.root)),
      ...(loose.parts.length ? [this.fold("Scene", true, loose.root)] : []),
      ...sections);
    this.refresh();
  }

  /** What the study measured of each technique; never before the first picture. */
  async learn() {
    if (!this.drawn || !this.pickers) return;
    const { slots, note } = await api.study(this.store.scene.name, "techniques").catch(() => ({ slots: {} }));
    for (const picker of this.pickers) picker.learn(slots[picker.path] ?? {}, note ?? "");
  }

  /** All slots at once. */
  combined({ combinations }) {
    const choices = Object.entries(combinations).map(([value, { title }]) => el("option", { value, text: title }));
    return el("select", { class: "select", "aria-label": "Combination", hidden: !choices.length,
      on: { change: ({ target }) => this.store.change(combinations[target.value].patch) } }, el("option", { text: "Combinations …", hidden: true }), choices);
  }

  section(context, name, node, sort) {
    const part = sort === "union" ? new UnionPart(context, name, node, { titled: false }) : new Form(context, name);
    if (sort === "object") part.addFields(name, node);
    this.parts.push(part);
    return this.fold(node.title ?? humanise(name), name === "view", part.root);
  }

  fold(title, open, ...children) {
    return el("details", { class: "fold", open, on: { toggle: () => this.refresh(false) } }, el("summary", {}, el("h3", { text: title })), el("div", { class: "fold-body" }, children));
  }

  /** Bring the controls up to date: all of them, or those of the fields that changed and that are unfolded. */
  refresh(all = true) {
    const { document } = this.store;
    if (!document || !this.store.schema) return;
    for (const part of this.parts) {
      const value = part.path ? document[part.path] : document;
      if (!all && (value === this.shown.get(part) || part.root.closest("details:not([open])"))) continue;
      this.shown.set(part, value);
      part.refresh(document);
    }
  }

  /** One quiet line at the foot of the panel: what the control under the pointer or the focus means. */
  hint(node, path) {
    const { minimum, maximum } = range(node);
    const unit = unitOf(node);
    const ends = minimum === undefined && maximum === undefined ? "" : `${minimum ?? "−∞"} … ${maximum ?? "∞"} ${unit}`.trim();
    const facts = [ends, COSTS[node.umbrage?.cost] ?? "", node.umbrage?.source ?? ""].filter(Boolean).join(" · ");
    const line = el("span", { class: "hint-facts", text: facts });
    this.hintRoot.replaceChildren(el("strong", { text: node.title ?? path }), ` ${node.description ?? ""}`, line, el("code", { text: path }));
    if (node.umbrage?.cost === "bake") this.price(node, path, line);
  }

  /** What a change would cost, before it starts: that of the next value stands for all. */
  async price(node, path, line) {
    const value = valueAt(this.store.document, path);
    const step = value >= range(node).maximum ? -stepOf(node) : stepOf(node);
    const next = node.enum ? node.enum.find((item) => item !== value) : Number((value + step).toPrecision(6));
    const { seconds } = await api.cost(this.store.document, { [path]: next }).catch(() => ({}));
    if (seconds) line.append(` It takes about ${Math.ceil(seconds)} s.`);
  }

  /** Show a refusal at its control; false where none shows that field. */
  fail(field, sentence) {
    const control = this.controls.get(field);
    if (!control) return false;
    for (let fold = control.root.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
    control.fail(sentence);
    control.root.scrollIntoView({ block: "nearest" });
    return control.root.checkVisibility?.() ?? true;
  }
}

/** The schema of a scene's description. */
export const schemaOf = (scene) => new Schema(scene.schema);
