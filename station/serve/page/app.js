// The technician's page: screens, keys, themes; each screen is a module of its own.

import {beginBench, showBench, showJob} from "/bench.js";
import {beginForms, showForms} from "/capture.js";
import {byId, readTexts, text} from "/document.js";
import {beginLibrary, showLibrary} from "/library.js";
import {beginResult, showResult} from "/result.js";
import {beginSession, chooseSession, showSession, showSessionChoice} from "/session.js";
import {follow, inControl, oneAtATime, post, state} from "/station.js";

let screen = "bench";

const toBench = () => show("bench");
const shows = {bench: showBench, session: () => showSession(toBench), result: showResult, library: showLibrary};
const showScreen = oneAtATime(() => state && shows[screen] ? shows[screen]() : null);
const stop = () => post("/api/stop");

function show(name) {
  screen = name;
  for (const section of document.querySelectorAll("main > section")) section.hidden = section.id !== name;
  for (const button of document.querySelectorAll("#screens button")) {
    if (button.dataset.screen === name) button.setAttribute("aria-current", "page");
    else button.removeAttribute("aria-current");
  }
  scrollTo(0, 0);
  showScreen();
}

function render() {
  byId("rig").textContent = "· " + state.rig;
  const control = byId("control");
  control.textContent = text(inControl() ? "control_mine" : state.control ? "control_other" : "control_free");
  control.disabled = inControl();
  showJob();
  for (const button of document.querySelectorAll("form button, #choices button, #pause, [data-kind]")) button.disabled = !inControl();
  showForms();
  showSessionChoice();
  showScreen();
}

function setTheme(name) {
  document.body.dataset.theme = localStorage.theme = name;
  byId("theme").textContent = text(name === "red" ? "theme_dark" : "theme_red");
}

function key(event) {
  if (event.key === "Escape") { event.preventDefault(); stop(); return; }
  const on = event.target.tagName;
  if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(on)) return;
  if (event.key === "Enter" && !/^(BUTTON|A)$/.test(on) && !byId("question").hidden) byId("choices").firstChild.click();
  if (event.key === "p" && !byId("progress").hidden && inControl()) post("/api/pause");
  if (event.key === "t") byId("theme").click();
  const screens = [...document.querySelectorAll("#screens button")], wanted = screens[Number(event.key) - 1];
  if (wanted) wanted.click();
}

async function begin() {
  await readTexts();
  setTheme(localStorage.theme || "dark");
  for (const button of document.querySelectorAll("#screens button")) button.onclick = () => show(button.dataset.screen);
  for (const list of ["session-choice", "result-choice"])
    byId(list).onchange = event => { chooseSession(event.target.value); show(screen); };
  byId("control").onclick = () => post("/api/control", {take: Boolean(state && state.control)});
  byId("theme").onclick = () => setTheme(document.body.dataset.theme === "red" ? "dark" : "red");
  byId("stop").onclick = stop;
  addEventListener("keydown", key);
  beginBench();
  beginForms(toBench);
  beginSession(toBench);
  beginResult(toBench);
  beginLibrary();
  show("bench");
  await follow(render);
}

begin();
