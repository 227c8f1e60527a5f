// Drop a file anywhere, or choose one.

import { el } from "./dom.js";

/** The drop zone; `take` is called with the file. */
export class Drop {
  constructor(take) {
    this.input = el("input", { type: "file", hidden: true, "aria-label": "File to open", on: { change: () => this.input.files[0] && take(this.input.files[0]) } });
    const veil = el("div", { class: "veil", hidden: true }, el("p", { class: "glass", text: "Drop a terrain, mesh, cloud of points, volume, picture or reflectance" }));
    document.body.append(this.input, veil);
    const over = (on) => (event) => {
      event.preventDefault();
      veil.hidden = !on;
    };
    addEventListener("dragover", over(true));
    addEventListener("dragleave", (event) => event.relatedTarget || over(false)(event));
    addEventListener("drop", (event) => {
      over(false)(event);
      if (event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
    });
  }

  choose() {
    this.input.value = "";
    this.input.click();
  }
}
