// What is there on every screen: bench and calibration with their state, the job with its time left, who is in control,
// the emergency stop; and how a job's end is told to somebody who does not look.

import {calibrationVerdict, newestCalibration} from "/calibration.js";
import {ago, byId, make, nextLanguage, show, text, time} from "/document.js";
import {inControl, post, say, state, stop} from "/station.js";

const kThemes = ["dark", "light", "red"];

let told = null, sound = null;

export function setTheme(name) {
  document.body.dataset.theme = localStorage.theme = name;
  byId("theme").textContent = text(`theme_${name}`);
}

export function nextTheme() { setTheme(kThemes[(kThemes.indexOf(document.body.dataset.theme) + 1) % kThemes.length]); }

export const outcomeText = job => text(job.running ? "running" : `ended_${job.outcome}`);

function chip(screen, grade, ...words) {
  const link = make("a", {href: `#/${screen}`, className: `chip ${grade}`});
  link.append(...words.map(word => make("span", {textContent: word})));
  return link;
}

function devicesChip() {
  const {passed, checked_ms: checked} = state.devices;
  return chip("bench", passed === null ? "" : passed ? "well" : "badly", text("devices"),
              passed === null ? text("never_checked") : `${text(passed ? "sound" : "failed")}, ${ago(new Date(checked).toISOString())}`);
}

function calibrationChip() {
  const newest = newestCalibration();
  if (!newest) return chip("calibrate", "badly", text("calibration"), text("none"));
  const verdict = calibrationVerdict(newest);
  return chip("calibrate", verdict === "good" ? "well" : verdict === "usable" ? "doubtfully" : "badly", text("calibration"),
              `${text("calibration_" + verdict)}, ${ago(newest.utc)}`);
}

function jobChip() {
  const job = state.job;
  if (!job) return chip("bench", "", text("job"), text("idle_short"));
  const left = job.running && job.seconds_left !== null && job.kind !== "preview" ? `, ${time(job.seconds_left)} ${text("left")}` : "";
  const grade = job.question ? "asking" : job.running ? "" : job.outcome === "well" ? "well" : job.outcome === "badly" ? "badly" : "doubtfully";
  return chip("bench", grade, text("job"), `${text(`kind_${job.kind}`)} ${job.question ? text("asks") : outcomeText(job) + left}`);
}

function title() {
  const job = state.job;
  if (!job) return "threadstation";
  const kind = text(`kind_${job.kind}`);
  if (job.question) return `? ${kind} · threadstation`;
  if (!job.running) return `${{well: "✓", badly: "✗"}[job.outcome] || "‖"} ${kind} · threadstation`;
  return `${job.total && job.kind !== "preview" ? `${Math.floor(100 * job.done / job.total)} % ` : ""}${kind} · threadstation`;
}

// A short tone; browsers allow it after a click on the page.
function beep(well) {
  if (localStorage.sound !== "on") return;
  sound = sound || new AudioContext();
  const tone = sound.createOscillator(), loudness = sound.createGain();
  loudness.gain.value = 0.2;
  tone.frequency.value = well ? 880 : 330;
  tone.connect(loudness).connect(sound.destination);
  tone.start();
  tone.stop(sound.currentTime + 0.4);
}

// Ends, and questions, are told once.
function tell() {
  const job = state.job, mark = job ? `${job.number} ${job.question ? job.question.id : job.running ? "running" : job.outcome}` : "";
  if (told === mark) return;
  const first = told === null;
  told = mark;
  if (first || !job) return;
  say("");  // what was said of the state before
  if ((job.running && !job.question) || job.kind === "preview") return;
  beep(Boolean(job.question) || job.outcome === "well");
  if (localStorage.sound === "on" && document.hidden && window.Notification && Notification.permission === "granted")
    new Notification(`${text("kind_" + job.kind)}: ${job.question ? text("asks") : outcomeText(job)}`, {body: job.title});
}

function setSound(on) {
  localStorage.sound = on ? "on" : "off";
  byId("sound").setAttribute("aria-pressed", on);
  byId("sound").textContent = text(on ? "sound_on" : "sound_off");
}

export function showFrame() {
  byId("rig").textContent = state.rig;
  document.title = title();
  tell();
  show(byId("chips"), [state.devices, newestCalibration(), state.job && {...state.job, lines: 0}, Math.floor(Date.now() / 60000)],
       () => [devicesChip(), calibrationChip(), jobChip()]);
  const control = byId("control");
  control.textContent = text(inControl() ? "control_mine" : state.control ? "control_other" : "control_free");
  control.disabled = inControl();
  control.className = inControl() ? "" : "wanted";
  for (const button of document.querySelectorAll("form button, #choices button, #pause, #home")) {
    button.disabled = !inControl();
    button.title = inControl() ? "" : text("not_in_control");
  }
}

export function beginFrame() {
  setTheme(kThemes.includes(localStorage.theme) ? localStorage.theme : matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  byId("theme").onclick = nextTheme;
  byId("language").onclick = nextLanguage;
  setSound(localStorage.sound === "on");
  byId("sound").onclick = () => {
    setSound(localStorage.sound !== "on");
    if (localStorage.sound === "on" && window.Notification && Notification.permission === "default") Notification.requestPermission();
    beep(true);
  };
  byId("control").onclick = () => post("/api/control", {take: Boolean(state && state.control)});
  byId("stop").onclick = stop;
  byId("not-stopped-again").onclick = stop;
  setInterval(() => state && showFrame(), 30000);  // ages grow
}
