// Names of keys and buttons: what a browser calls them, and what the Linux kernel calls them.

const KEYS = {
  Escape: "ESC", Backspace: "BACKSPACE", Tab: "TAB", Enter: "ENTER", Space: "SPACE", CapsLock: "CAPSLOCK",
  Minus: "MINUS", Equal: "EQUAL", BracketLeft: "LEFTBRACE", BracketRight: "RIGHTBRACE", Semicolon: "SEMICOLON",
  Quote: "APOSTROPHE", Backquote: "GRAVE", Backslash: "BACKSLASH", IntlBackslash: "102ND", Comma: "COMMA", Period: "DOT", Slash: "SLASH",
  ControlLeft: "LEFTCTRL", ControlRight: "RIGHTCTRL", ShiftLeft: "LEFTSHIFT", ShiftRight: "RIGHTSHIFT",
  AltLeft: "LEFTALT", AltRight: "RIGHTALT", MetaLeft: "LEFTMETA", MetaRight: "RIGHTMETA", ContextMenu: "COMPOSE",
  ArrowUp: "UP", ArrowDown: "DOWN", ArrowLeft: "LEFT", ArrowRight: "RIGHT",
  Home: "HOME", End: "END", PageUp: "PAGEUP", PageDown: "PAGEDOWN", Insert: "INSERT", Delete: "DELETE",
  PrintScreen: "SYSRQ", ScrollLock: "SCROLLLOCK", Pause: "PAUSE", NumLock: "NUMLOCK",
  NumpadEnter: "KPENTER", NumpadAdd: "KPPLUS", NumpadSubtract: "KPMINUS", NumpadMultiply: "KPASTERISK",
  NumpadDivide: "KPSLASH", NumpadDecimal: "KPDOT", NumpadComma: "KPCOMMA", NumpadEqual: "KPEQUAL",
  IntlRo: "RO", IntlYen: "YEN", Convert: "HENKAN", NonConvert: "MUHENKAN", KanaMode: "KATAKANAHIRAGANA",
  Lang1: "HANGEUL", Lang2: "HANJA", AudioVolumeMute: "MUTE", AudioVolumeDown: "VOLUMEDOWN", AudioVolumeUp: "VOLUMEUP",
  MediaTrackNext: "NEXTSONG", MediaTrackPrevious: "PREVIOUSSONG", MediaPlayPause: "PLAYPAUSE", MediaStop: "STOPCD",
  BrowserBack: "BACK", BrowserForward: "FORWARD", BrowserRefresh: "REFRESH", BrowserHome: "HOMEPAGE", BrowserSearch: "SEARCH",
};

/** The kernel's name of a key by `KeyboardEvent.code`, or null. */
export function keyName(code) {
  const regular = /^(?:Key([A-Z])|Digit(\d)|(F\d{1,2}))$/.exec(code);
  if (regular !== null) return `KEY_${regular[1] ?? regular[2] ?? regular[3]}`;
  const pad = /^Numpad(\d)$/.exec(code);
  if (pad !== null) return `KEY_KP${pad[1]}`;
  return code in KEYS ? `KEY_${KEYS[code]}` : null;
}

const MODIFIERS = /^(Control|Shift|Alt|Meta)(Left|Right)$/;

/** Whether a key is one that is held beside others. */
export const isModifier = (code) => MODIFIERS.test(code);

/** Buttons of the Gamepad API's standard mapping by their place; triggers have no name among bindings. The kernel calls X of an Xbox 360 pad north. */
const PAD_BUTTONS = [
  "BTN_SOUTH", "BTN_EAST", "BTN_NORTH", "BTN_WEST", "BTN_TL", "BTN_TR", null, null, "BTN_SELECT", "BTN_START",
  "BTN_THUMBL", "BTN_THUMBR", "ABS_HAT0Y-", "ABS_HAT0Y+", "ABS_HAT0X-", "ABS_HAT0X+", "BTN_MODE",
];
const PAD_AXES = [["ABS_HAT0X-", "ABS_HAT0X+"], ["ABS_HAT0Y-", "ABS_HAT0Y+"]];
const AXIS_FROM = 0.7;

/** What is down on all gamepads, by the kernel's names; the left stick stands for the hat. */
export function padNames() {
  const down = new Set();
  for (const pad of navigator.getGamepads?.() ?? []) {
    if (pad === null) continue;
    pad.buttons.forEach((button, index) => button.pressed && PAD_BUTTONS[index] && down.add(PAD_BUTTONS[index]));
    PAD_AXES.forEach(([less, more], axis) => {
      if (pad.axes[axis] <= -AXIS_FROM) down.add(less);
      if (pad.axes[axis] >= AXIS_FROM) down.add(more);
    });
  }
  return down;
}
