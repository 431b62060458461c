// Starts the page: token, settings, views, the live socket, and the notices at the top.

import { onRefused, takeToken } from "./api.js";
import { say } from "./dom.js";
import { LiveView } from "./live.js";
import { ProfileView } from "./editor.js";
import { GuidesView } from "./guides.js";
import { ReportsView } from "./reports.js";
import { DoctorView } from "./doctor.js";
import { onShow, startRouter } from "./router.js";
import { Screen } from "./screen.js";
import { startSettings } from "./settings.js";
import { Live } from "./socket.js";
import { Trace } from "./trace.js";

const NO_TOKEN = "This page needs its token: open it from the tray, or with `tactpad ctl dashboard`";

const live = new Live();
const screen = new Screen();
const trace = new Trace();
const section = (view) => document.getElementById(view);
const connection = section("connection");

function refuse() {
  live.stop();
  say(connection, NO_TOKEN);
}

function makeViews() {
  const views = { live: new LiveView(section("live"), trace) };
  views.profile = new ProfileView(section("profile"));
  views.guides = new GuidesView(section("guides"), (draft) => views.profile.openDraft(draft));
  views.reports = new ReportsView(section("reports"));
  views.doctor = new DoctorView(section("doctor"));
  return views;
}

function followFrames(views) {
  live.on("frame", (frame) => {
    trace.take(frame.trace);
    trace.forget(frame.t_us);
    views.live.take(frame);
    screen.ask();
  });
  screen.add(section("live"), () => views.live.draw());
  screen.add(section("profile"), () => views.profile.draw(views.live.frame));
}

function followStatus(views) {
  live.on("sketch", (message) => views.live.setSketch(message));
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
    say(connection, "");
    views.live.status.listProfiles();
    views.profile.preview.again();
  });
  live.on("lost", () => {
    if (connection.textContent !== NO_TOKEN) say(connection, "The connection to tactpad is lost. Trying again every second …");
  });
}

function start() {
  const token = takeToken();
  startSettings();
  onRefused(refuse);
  const views = makeViews();
  onShow("live", () => views.live.status.listProfiles());
  for (const view of ["profile", "guides", "reports", "doctor"]) onShow(view, () => views[view].show());
  startRouter();
  if (token === null) return refuse();
  followFrames(views);
  followStatus(views);
  followConnection(views);
  live.start();
}

start();
