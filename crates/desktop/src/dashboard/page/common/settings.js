// What a person chose for this page: colours, motion, announcements. Kept in the browser.

const KEY = "tactpad-display";
const DEFAULTS = { theme: "auto", motion: "auto", announce: true, codes: false, tones: false, measurements: false };
const less = matchMedia("(prefers-reduced-motion: reduce)");
const dark = matchMedia("(prefers-color-scheme: dark)");

/** @type {{ theme: string, motion: string, announce: boolean, codes: boolean, tones: boolean, measurements: boolean }} */
let chosen = { ...DEFAULTS };
const themeListeners = [];

function read() {
  try {
    chosen = { ...DEFAULTS, ...JSON.parse(localStorage.getItem(KEY) ?? "{}") };
  } catch {
    chosen = { ...DEFAULTS };
  }
}

function apply() {
  document.documentElement.dataset.theme = chosen.theme;
  document.documentElement.dataset.motion = calm() ? "reduced" : "full";
  document.documentElement.dataset.codes = String(chosen.codes);
  for (const listener of themeListeners) listener();
}

function change(part) {
  chosen = { ...chosen, ...part };
  localStorage.setItem(KEY, JSON.stringify(chosen));
  apply();
}

/** Whether things should not move of themselves. */
export const calm = () => (chosen.motion === "auto" ? less.matches : chosen.motion === "reduced");

/** Whether presses are spoken. */
export const announces = () => chosen.announce;

/** Whether cues are told by a tone, too. */
export const sounds = () => chosen.tones;

/** A fold is found as it was left. @param {HTMLDetailsElement} details @param {"measurements"} name */
export function rememberFold(details, name) {
  details.open = chosen[name];
  details.addEventListener("toggle", () => change({ [name]: details.open }));
}

/** Calls `listener` whenever colours may have changed. */
export function onTheme(listener) {
  themeListeners.push(listener);
}

/** Reads the choices and ties the controls to them. */
export function startSettings() {
  read();
  apply();
  const theme = document.getElementById("setting-theme");
  const motion = document.getElementById("setting-motion");
  const announce = document.getElementById("setting-announce");
  theme.value = chosen.theme;
  motion.value = chosen.motion;
  announce.checked = chosen.announce;
  const codes = document.getElementById("setting-codes");
  codes.checked = chosen.codes;
  codes.addEventListener("change", () => change({ codes: codes.checked }));
  const tones = document.getElementById("setting-tones");
  tones.checked = chosen.tones;
  tones.addEventListener("change", () => change({ tones: tones.checked }));
  theme.addEventListener("change", () => change({ theme: theme.value }));
  motion.addEventListener("change", () => change({ motion: motion.value }));
  announce.addEventListener("change", () => change({ announce: announce.checked }));
  less.addEventListener("change", apply);
  dark.addEventListener("change", apply);
  closeWithEscape(document.getElementById("settings"));
}

function closeWithEscape(details) {
  details.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !details.open) return;
    details.open = false;
    details.querySelector("summary").focus();
  });
}
