// Dark or light: the system's preference, unless the person chose.

const KEY = "umbrage-theme";
const ORDER = ["auto", "light", "dark"];

/** Apply the stored choice. */
export function start() {
  apply(localStorage.getItem(KEY) ?? "auto");
}

function apply(choice) {
  if (choice === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = choice;
}

/** The next of system, light, dark; returns words for it. */
export function next() {
  const choice = ORDER[(ORDER.indexOf(localStorage.getItem(KEY) ?? "auto") + 1) % ORDER.length];
  localStorage.setItem(KEY, choice);
  apply(choice);
  return { auto: "Colours follow the system.", light: "Light colours.", dark: "Dark colours." }[choice];
}
