// The current picture as a link, a curl line, a command and a Python snippet; and as files. Fetched when first wanted.

import * as api from "./api.js";
import { differences } from "./document.js";
import { el, iconButton } from "./dom.js";

const KEPT_MS = 7000;
const FORMATS = [["PNG", "image/png", "png", "as displayed"], ["EXR", "image/x-exr", "exr", "linear light"], ["NPY", "application/x-npy", "npy", "linear light, for NumPy"]];

const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** The four ways to ask for this picture from elsewhere, each to be run as pasted. */
export function snippets(document, defaults, width, height, link) {
  const size = `${width}x${height}`;
  const body = JSON.stringify({ scene: document.scene, state: document, width, height });
  const sets = differences(document, defaults)
    .map(([path, value]) => `--set ${path}=${typeof value === "string" ? quoted(value) : quoted(JSON.stringify(value))}`);
  const command = [`.venv/bin/umbrage render ${document.scene}`, ...sets, `--size ${size}`, "-o umbrage.png"].join(" \\\n  ");
  const address = new URL("api/render", window.document.baseURI);
  address.hash = "";
  const curl = `curl -sS ${quoted(address.href)} \\\n  -H 'Content-Type: application/json' -H 'Accept: image/png' \\\n  -d ${quoted(body)} \\\n  -o umbrage.png`;
  const python = [
    "import json", "from pathlib import Path", "", "from renderer.session import Session", "",
    'if __name__ == "__main__":',
    "    session = Session()",
    `    state = session.validate(json.loads(r'''${JSON.stringify(document)}'''))`,
    `    picture = session.render(state, ${width}, ${height})`,
    '    Path("umbrage.png").write_bytes(picture.encode("png"))',
    "    session.close()", ""].join("\n");
  return [["Link", link], ["curl", curl], ["Command line", command], ["Python", python]];
}

/** Fill the dialogs of what leaves the page. */
export class Doors {
  constructor(store, screen, notices, share) {
    Object.assign(this, { store, screen, notices, share });
  }

  async fillCode(root) {
    const link = await this.share.link();
    const { document, scene } = this.store;
    root.replaceChildren(...snippets(document, scene.defaults, this.screen.width, this.screen.height, link).map(([title, text]) =>
      el("section", { class: "snippet" },
        el("div", { class: "snippet-head" }, el("h3", { text: title }), iconButton("copy", `Copy ${title}`, () => this.share.copy(text, `${title}: copied.`))),
        el("pre", { tabindex: 0, "aria-label": title }, el("code", { text })))));
  }

  fillExport(root, close) {
    const buttons = FORMATS.map(([title, type, suffix, note]) => el("button", { type: "button", class: "format",
      on: { click: () => { close(); this.save(type, suffix); } } }, el("strong", { text: title }), el("span", { text: note })));
    root.replaceChildren(el("p", { text: `The picture as it is now, ${this.screen.width} × ${this.screen.height} pixels.` }), el("div", { class: "formats" }, buttons));
  }

  async save(type, suffix) {
    this.notices.toast("Rendering the file …");
    try {
      const blob = await api.render(this.store.document, this.screen.width, this.screen.height, type);
      const anchor = el("a", { href: URL.createObjectURL(blob), download: `umbrage-${this.store.scene.name}.${suffix}` });
      anchor.click();
      setTimeout(() => URL.revokeObjectURL(anchor.href), KEPT_MS);
    } catch (error) {
      this.notices.toast(error.message, "refusal");
    }
  }
}
