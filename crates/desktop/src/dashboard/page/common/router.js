// Which view is shown: the hash of the address says it, the heading gets the focus.

const VIEWS = { live: "Live", profile: "Profile", guides: "Guides", reports: "Reports", doctor: "Doctor" };
const listeners = [];

/** The view that is shown. */
export const shown = () => {
  const [view] = location.hash.slice(1).split("&");
  return view in VIEWS ? view : "live";
};

/** Calls `listener` when this view comes into sight. */
export function onShow(view, listener) {
  listeners.push({ view, listener });
}

function show(focus) {
  const now = shown();
  for (const view of Object.keys(VIEWS)) document.getElementById(view).hidden = view !== now;
  for (const link of document.querySelectorAll("nav a")) {
    if (link.hash === `#${now}`) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  document.title = `${VIEWS[now]} – tactpad`;
  if (focus) document.getElementById(`${now}-title`).focus();
  for (const { view, listener } of listeners) if (view === now) listener();
}

/** Shows the view of the address and follows it. */
export function startRouter() {
  addEventListener("hashchange", () => show(true));
  document.querySelector(".skip").addEventListener("click", (event) => {
    event.preventDefault();
    document.getElementById(`${shown()}-title`).focus();
  });
  show(false);
}
