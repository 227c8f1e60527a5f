// A list of the document: its items fold out one by one; they are added, taken out and changed as wholes of the list.

import { el, humanise } from "./dom.js";
import { patchOf, valueAt, withItem } from "./document.js";
import { Form, UnionPart } from "./form.js";

/** The context for controls of one item: a merge patch cannot reach into a list, so each change sends the list. */
export function within(context, path) {
  const { store, schema } = context;
  const change = (patch, source, time) => {
    const inner = valueAt(patch, path);
    const [index] = Object.keys(inner);
    store.change(patchOf(path, withItem(valueAt(store.document, path), Number(index), inner[index])), source, time);
  };
  const inner = { change, schema, get document() { return store.document; } };
  return { ...context, store: inner, defaultOf: (at) => schema.defaultOf(schema.at(at, store.document) ?? {}), convert: null };
}

/** The items of a list of models, and how one is added. */
export class ListPart {
  constructor(context, path, node) {
    Object.assign(this, { context, path, node });
    this.item = context.schema.resolve(node.items);
    this.members = context.schema.sort(this.item) === "union" ? context.schema.members(this.item) : null;
    this.folds = [];
    this.holder = el("div", { class: "list" });
    this.adder = this.members ? this.choice() : el("button", { type: "button", class: "wide", text: "Add one", on: { click: () => this.add(this.item) } });
    this.root = el("div", { class: "form", data: { path } }, el("h4", { text: node.title }), this.holder, this.adder);
  }

  choice() {
    const options = [...this.members.keys()].map((kind) => el("option", { value: kind, text: kind === "asset" ? "Your own mesh …" : humanise(kind) }));
    return el("select", { class: "select wide", "aria-label": `Add to ${this.node.title.toLowerCase()}`,
      on: { change: ({ target }) => { this.add(this.members.get(target.value)); target.value = ""; } } }, el("option", { value: "", text: "Add …" }), options);
  }

  get list() {
    return valueAt(this.context.store.document, this.path) ?? [];
  }

  /** An item that needs a file waits for it. */
  add(member) {
    if (this.members && this.context.schema.needsFile(member)) return this.context.askFile();
    const fresh = this.members ? this.context.schema.fresh(member) : this.context.schema.defaultOf(this.item);
    this.open = this.list.length;
    return this.set([...this.list, fresh]);
  }

  set(list) {
    this.context.store.change(patchOf(this.path, list), this.path);
  }

  refresh(document) {
    const list = valueAt(document, this.path) ?? [];
    const names = list.map((item) => item.kind ?? "").join();
    if (names !== this.names || list.length !== this.folds.length) this.rebuild(list, names);
    this.adder.disabled = list.length >= this.node.maxItems;
    for (const { part } of this.folds) part?.refresh(document);
  }

  rebuild(list, names) {
    this.forget();
    this.names = names;
    this.folds = list.map((item, index) => this.fold(item, index));
    this.holder.replaceChildren(...this.folds.map(({ root }) => root));
  }

  fold(item, index) {
    const word = item.kind ? humanise(item.kind === "asset" ? "own mesh" : item.kind) : this.node.title;
    const body = el("div", { class: "fold-body" });
    const made = { part: null };
    const build = () => {
      if (made.part) return;
      made.part = this.part(index);
      body.prepend(made.part.root);
      made.part.refresh(this.context.store.document);
    };
    const remove = el("button", { type: "button", class: "wide", text: `Take ${word.toLowerCase()} out`, on: { click: () => this.set(this.list.toSpliced(index, 1)) } });
    body.append(remove);
    made.root = el("details", { class: "fold", open: index === this.open, on: { toggle: build } }, el("summary", {}, el("span", { text: `${index + 1}. ${word}` })), body);
    if (index === this.open) build();
    return made;
  }

  part(index) {
    const context = within(this.context, this.path);
    const path = `${this.path}.${index}`;
    if (this.members) return new UnionPart(context, path, this.item, { titled: false, picker: false });
    const form = new Form(context, path);
    form.addFields(path, this.item);
    return form;
  }

  forget() {
    for (const { part } of this.folds) part?.forget();
  }
}
