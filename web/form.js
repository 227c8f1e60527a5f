// Controls for a whole schema node: objects fold out, unions get a picker and the fields of the chosen member.

import { el, humanise, segments } from "./dom.js";
import { patchOf, valueAt } from "./document.js";
import { controlFor } from "./controls.js";
import { ListPart } from "./list.js";

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
    const part = sort === "union" ? new UnionPart(this.context, path, node) : sort === "object" ? this.inner(path, node) : sort === "list" ? new ListPart(this.context, path, node) : controlFor(this.context, path, node);
    if (!part) return;
    this.parts.push(part);
    this.root.append(part.root);
  }

  inner(path, node) {
    const form = new Form(this.context);
    form.addFields(path, node);
    form.root.prepend(el("h4", { text: node.title }));
    return form;
  }

  addFields(path, node) {
    for (const [name, field] of this.context.schema.fields(node)) this.add(`${path}.${name}`, field);
  }

  refresh(document) {
    for (const part of this.parts) part.refresh(document);
  }

  forget() {
    for (const part of this.parts) part.forget();
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
    const { radios, group } = segments(this.node.title, [...this.members.keys()].map((kind) => [kind, humanise(kind)]), (kind) => this.choose(kind));
    this.radios = radios;
    return el("div", { class: "control" }, titled && el("span", { class: "label", text: this.node.title }), group);
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
    for (const radio of this.radios ?? []) radio.checked = radio.value === this.kind;
    this.form?.refresh(document);
  }

  rebuild(kind) {
    this.form?.forget();
    this.kind = kind;
    const member = this.members.get(kind);
    this.form = new Form(this.context);
    if (member) this.form.addFields(this.path, member);
    this.holder.replaceChildren(this.form.root);
  }

  forget() {
    this.form?.forget();
  }
}
