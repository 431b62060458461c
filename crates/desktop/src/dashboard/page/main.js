// Starts the page: the way in, settings, views, the live socket, and the notices at the top.

import { announce } from "./common/announce.js";
import { setToken, takeToken } from "./link/api.js";
import { measured, say } from "./common/dom.js";
import { DraftStore, takeAsFragment } from "./profile/draft_store.js";
import { LiveView } from "./live/live.js";
import { fetchKeys, handshake } from "./link/handshake.js";
import { ProfileView } from "./profile/editor.js";
import { GuidesView } from "./guides.js";
import { ReportsView } from "./reports.js";
import { DoctorView } from "./doctor.js";
import { onShow, shown, startRouter } from "./common/router.js";
import { Screen } from "./common/screen.js";
import { startSettings } from "./common/settings.js";
import { Live } from "./link/socket.js";
import { Trace } from "./picture/trace.js";
import { loadWords } from "./common/words.js";

const NO_WAY_IN = "This page does not find its bridge: open it from the tray, or with `tactpad ctl dashboard`.";
const LOST = "tactpad has ended. Start it again, or ask whoever started it: this page goes on by itself, and a draft is kept.";
const STALLED = "No answer from tactpad for some seconds: the machine is busy, or the program stands still or has ended. This page goes on by itself, and a draft is kept.";
const SHUT = "tactpad is there, and lets no further page in: close another one.";

const live = new Live();
const screen = new Screen();
const trace = new Trace();
const section = (view) => document.getElementById(view);
const connection = section("connection");

function makeViews() {
  const views = { live: new LiveView(section("live"), trace) };
  views.profile = new ProfileView(section("profile"));
  views.guides = new GuidesView(section("guides"), (draft) => views.profile.openDraft(draft));
  views.reports = new ReportsView(section("reports"));
  views.doctor = new DoctorView(section("doctor"), views.live);
  return views;
}

function followFrames(views) {
  live.on("frame", (frame) => {
    trace.take(frame.trace);
    trace.forget(frame.t_us);
    views.live.take(frame);
    views.profile.take(frame);
    screen.ask();
  });
  screen.add(section("live"), () => views.live.draw());
  screen.add(section("profile"), () => views.profile.draw(views.live.frame));
}

function followStatus(views) {
  live.on("sketch", (message) => {
    views.live.setSketch(message);
    views.guides.setSketch(message);
  });
  live.on("guide", ({ guide }) => views.guides.update(guide));
  live.on("status", (message) => {
    views.live.setStatus(message);
    views.profile.setStatus(message);
    if (!section("live").hidden) views.live.drawSlow(live.ages);
    const age_ms = live.ages.p95();
    if (age_ms !== null) document.documentElement.dataset.ageMs = age_ms.toFixed(2);
    const { warning_sentence, line } = message.status;
    const sentences = [warning_sentence, line?.sentence].filter((sentence) => sentence);
    say(section("warning"), sentences.map((sentence) => `⚠ ${sentence}`).join(" "));
  });
}

function followConnection(views) {
  live.on("open", () => {
    const wasLost = connection.textContent !== "";
    say(connection, "");
    views.live.status.listProfiles();
    if (!wasLost) return;
    announce("tactpad is there again.");
    views.guides.show();
    views.profile.again();
  });
  live.on("lost", () => clear(views, LOST));
  live.on("stalled", () => clear(views, STALLED));
  live.on("shut", () => clear(views, SHUT));
  live.on("moved", (origin) => move(views, origin));
}

/** Nothing is shown that may no longer be so. */
function clear(views, sentence) {
  if (connection.textContent === sentence) return;
  say(connection, sentence);
  for (const notice of ["warning", "failure"]) say(section(notice), "");
  trace.clear();
  views.live.clear();
  views.guides.clear();
  views.profile.clear();
}

/** Goes to where the page is now, with the drafts that are stored here. */
async function move(views, origin) {
  await views?.profile.leave();
  location.replace(`${origin}/#${shown()}${await takeAsFragment()}`);
  return new Promise(() => {});
}

/** Gets the key for drafts: with the token, else by a handshake, which may lead elsewhere. Null is no way in. */
async function enter() {
  try {
    return await fetchKeys();
  } catch (error) {
    if (error.status !== 401) throw error;
  }
  const answer = await handshake({ isFresh: true });
  if (answer === null) return null;
  if (answer.origin !== location.origin) return move(null, answer.origin);
  setToken(answer.token);
  return fetchKeys();
}

async function start() {
  takeToken();
  startSettings();
  measured(document.querySelector(".top"), "--top-height");
  const views = makeViews();
  onShow("live", () => views.live.status.listProfiles());
  for (const view of ["profile", "guides", "reports", "doctor"]) onShow(view, () => views[view].show());
  const key = await enter().catch((error) => say(connection, error.message));
  if (!key) {
    if (connection.textContent === "") say(connection, NO_WAY_IN);
    views.live.status.clear();
    return startRouter();
  }
  await loadWords();
  const { store, found } = await DraftStore.open(key).catch(() => ({ store: null, found: null }));
  views.profile.setDraftStore(store, found);
  startRouter();
  followFrames(views);
  followStatus(views);
  followConnection(views);
  live.start();
}

start();
