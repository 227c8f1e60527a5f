// Controls for a whole schema node: objects fold out, unions get a picker and the fields of the chosen member.

import { el, freshId } from "./dom.js";
import { patchOf, valueAt } from "./document.js";
import { controlFor } from "./controls.js";

/** `double_horizon_map` as people read it. */
export function humanise(name) {
  const words = String(name).replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Controls of every field of `node` under `path`; `refresh` brings them up to date with a document. */
export class Form {
  constructor(context, path = null) {
    Object.assign(this, { context, path });
    this.parts = [];
    this.root = el("div", { class: "form" });
  }

  /** Add the control (or the nested form) of one field. */
  add(path, node) {
    const sort = this.context.schema.sort(node);
    if (sort === "union") this.parts.push(new UnionPart(this.context, path, node));
    else if (sort === "object") this.addObject(path, node);
    else {
      const control = controlFor(this.context, path, node);
      if (!control) return;
      this.context.controls.set(path, control);
      this.parts.push(control);
      this.root.append(control.row);
      return;
    }
    const part = this.parts[this.parts.length - 1];
    if (part.root) this.root.append(part.root);
  }

  addObject(path, node) {
    const inner = new Form(this.context);
    inner.addFields(path, node);
    inner.root.prepend(el("h4", { text: node.title }));
    this.parts.push(inner);
  }

  addFields(path, node) {
    for (const [name, field] of this.context.schema.fields(node)) this.add(`${path}.${name}`, field);
  }

  refresh(document) {
    for (const part of this.parts) part.refresh(document);
  }

  forget() {
    for (const part of this.parts) {
      if (part.forget) part.forget();
      else this.context.controls.delete(part.path);
    }
  }
}

/** A union: a row of choices, then the fields of the chosen member. */
export class UnionPart {
  constructor(context, path, node, { picker = true, titled = true } = {}) {
    Object.assign(this, { context, path, node });
    this.members = context.schema.members(node);
    this.holder = el("div", { class: "union-fields" });
    this.root = el("div", { class: "union", data: { path } }, picker ? this.picker(titled) : null, this.holder);
    this.kind = null;
  }

  picker(titled) {
    const name = freshId("union");
    this.radios = [...this.members].map(([kind]) => {
      const radio = el("input", { type: "radio", name, value: kind, on: { change: () => this.choose(kind) } });
      return [radio, el("label", { class: "segment" }, radio, el("span", { text: humanise(kind) }))];
    });
    const group = el("div", { class: "segments", role: "radiogroup", "aria-label": this.node.title }, this.radios.map(([, label]) => label));
    const head = el("div", { class: "control-head" }, el("span", { class: "label", text: this.node.title }));
    return el("div", { class: "control" }, titled ? head : null, group);
  }

  /** A member that needs a file waits for it; the others start at their defaults. */
  choose(kind) {
    if (this.context.schema.needsFile(this.members.get(kind))) {
      this.context.askFile();
      this.refresh(this.context.store.document);
      return;
    }
    const fresh = this.context.convert?.(this.path, kind) ?? this.context.schema.fresh(this.members.get(kind));
    this.context.store.change(patchOf(this.path, fresh), `${this.path}.kind`);
  }

  refresh(document) {
    const value = valueAt(document, this.path);
    if (value?.kind !== this.kind) this.rebuild(value?.kind);
    for (const [radio] of this.radios ?? []) radio.checked = radio.value === this.kind;
    this.form?.refresh(document);
  }

  rebuild(kind) {
    this.form?.forget();
    this.kind = kind;
    const member = this.members.get(kind);
    this.form = member ? new Form(this.context) : null;
    this.form?.addFields(this.path, member);
    this.holder.replaceChildren(...(this.form ? [this.form.root] : []));
  }

  forget() {
    this.form?.forget();
  }
}
