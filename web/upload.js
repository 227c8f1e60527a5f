// Drop a file anywhere: it is checked by the server and shown with its size before it replaces anything.

import * as api from "./api.js";
import { el } from "./dom.js";
import { bytes } from "./overlay.js";
import { humanise } from "./form.js";

const REFERENCE = /asset:/;

/** Where in the state an asset of `kind` may go: union members that hold a text field made for assets. */
export function placesFor(schema, kind) {
  const found = [];
  for (const [name, node] of schema.fields(schema.root)) {
    if (schema.sort(node) !== "union") continue;
    for (const [member, fields] of schema.members(node)) {
      for (const [field, inner] of schema.fields(fields)) {
        const fits = REFERENCE.test(inner.pattern ?? "") || field === "asset";
        const declared = inner.umbrage?.asset ?? name;
        if (fits && (declared === kind || name === kind || member === kind)) found.push({ slot: name, member, field, title: node.title ?? humanise(name) });
      }
    }
  }
  return found;
}

/** The drop zone and its dialog. */
export class Upload {
  constructor(dialog, store, notices) {
    Object.assign(this, { dialog, store, notices });
    this.input = el("input", { type: "file", hidden: true, "aria-label": "File to open", on: { change: () => this.take(this.input.files[0]) } });
    this.veil = el("div", { class: "veil", hidden: true }, el("p", { class: "glass", text: "Drop a terrain, mesh or volume" }));
    document.body.append(this.input, this.veil);
    addEventListener("dragover", (event) => {
      event.preventDefault();
      this.veil.hidden = false;
    });
    addEventListener("dragleave", (event) => { if (!event.relatedTarget) this.veil.hidden = true; });
    addEventListener("drop", (event) => {
      event.preventDefault();
      this.veil.hidden = true;
      this.take(event.dataTransfer.files[0]);
    });
  }

  choose() {
    this.input.value = "";
    this.input.click();
  }

  async take(file) {
    if (!file) return;
    this.notices.connection(`Checking ${file.name} (${bytes(file.size)}) …`);
    try {
      const asset = await api.upload(file);
      this.preview(file, asset);
    } catch (error) {
      this.notices.toast(`${file.name} was refused. ${error.message}`, "refusal");
    } finally {
      this.notices.connection(null);
    }
  }

  preview(file, { hash, kind, ...facts }) {
    const places = placesFor(this.store.schema, kind);
    const rows = Object.entries({ kind, size: bytes(file.size), ...facts }).filter(([, value]) => ["string", "number", "boolean"].includes(typeof value));
    const use = places.map((place) => el("button", { type: "button", class: "wide", text: `Use as ${place.title.toLowerCase()}`,
      on: { click: () => this.apply(place, hash) } }));
    const none = places.length ? null : el("p", { text: `This scene has no place for a ${kind} file.` });
    this.dialog.querySelector("h2").textContent = file.name;
    this.dialog.querySelector(".dialog-body").replaceChildren(
      el("dl", { class: "costs" }, rows.flatMap(([name, value]) => [el("dt", { text: humanise(name) }), el("dd", { text: String(value) })])), ...use, ...(none ? [none] : []));
    this.dialog.showModal();
  }

  apply(place, hash) {
    const { schema, document } = this.store;
    const fresh = schema.fresh(schema.members(schema.at(place.slot, document)).get(place.member));
    this.store.change({ [place.slot]: { ...fresh, [place.field]: `asset:${hash}` } }, "upload");
    this.dialog.close();
  }
}
