// What can be done here, in one short dialog. Fetched when first wanted.

import { el, terms } from "./dom.js";

const GESTURES = [
  ["Turn", "drag, or the arrow keys"], ["Shift", "right drag, Shift and drag, or two fingers"], ["Closer, further", "wheel, pinch, or + and −"],
  ["Fly", "W A S D, Q down, E up"], ["Read a point", "click it, or Enter for the middle"], ["Sun", "drag the dome, or the time of day"],
  ["A number exactly", "type it, drag its name, or the arrow keys in its field"], ["Back to default", "the round arrow beside a value"],
  ["Undo, redo", "Ctrl Z, Ctrl Shift Z"], ["Your own data", "drop a file anywhere"], ["Hide the panels", "H"], ["Paint a shell", "the brush above, then drag on it, or Enter for the middle"],
];

/** Fill the help dialog. */
export function fill(root) {
  root.replaceChildren(el("dl", { class: "gestures" }, terms(GESTURES)),
    el("p", {}, "The same pictures come by HTTP: ", el("a", { href: "docs", text: "the doors of the server" }), "."));
}
