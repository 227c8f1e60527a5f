// Drop a file anywhere: it is checked by the server and shown with its size before it replaces anything.

import * as api from "./api.js";
import { el } from "./dom.js";
import { bytes } from "./overlay.js";
import { humanise } from "./form.js";

/** Where in the state a file of `kind` may go: `{path, title, patch(asset)}` for every text field made for such a file. */
export function placesFor(schema, kind) {
  const found = [];
  for (const [name, node] of schema.fields(schema.root)) {
    const title = node.title ?? humanise(name);
    const add = (field, patch) => {
      if ([name, field].includes(kind)) found.push({ path: `${name}.${field}`, title, patch });
    };
    const sort = schema.sort(node);
    for (const member of sort === "union" ? schema.members(node).values() : []) {
      for (const [field, inner] of schema.fields(member)) {
        if (schema.isAsset(inner)) add(field, (asset) => ({ [name]: { ...schema.fresh(member), [field]: asset } }));
      }
    }
    for (const [field, inner] of sort === "object" ? schema.fields(node) : []) {
      if (schema.isAsset(inner)) add(field, (asset) => ({ [name]: { [field]: asset } }));
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

  preview(file, { asset, kind, preview = {} }) {
    const places = placesFor(this.store.schema, kind);
    const rows = Object.entries({ kind, size: bytes(file.size), ...preview }).filter(([, value]) => value !== null && value !== "");
    const use = places.map((place) => el("button", { type: "button", class: "wide", text: `Use for: ${place.title.toLowerCase()}`,
      on: { click: () => this.apply(place, asset) } }));
    const none = places.length ? null : el("p", { text: `This scene has no place for a file of this kind (${kind}).` });
    this.dialog.querySelector("h2").textContent = file.name;
    this.dialog.querySelector(".dialog-body").replaceChildren(
      el("dl", { class: "costs" }, rows.flatMap(([name, value]) => [el("dt", { text: humanise(name) }), el("dd", { text: said(value) })])),
      ...use, ...(none ? [none] : []));
    this.dialog.showModal();
  }

  apply(place, asset) {
    this.store.change(place.patch(asset), "upload");
    this.dialog.close();
  }
}

/** A fact of the preview in one line. */
function said(value) {
  if (Array.isArray(value)) return value.map(said).join(" × ");
  if (typeof value === "number") return String(Number(value.toPrecision(6)));
  if (value !== null && typeof value === "object") return Object.entries(value).map(([key, item]) => `${humanise(key)} ${said(item)}`).join(", ");
  return String(value);
}
