"use strict";
// The technician's page: shows /api/state, asks for it again whenever the event stream says that something has changed.

const client = sessionStorage.client || (sessionStorage.client = crypto.randomUUID());
const $ = id => document.getElementById(id);
let texts = {}, state = null, screen = "bench", session = "";

const text = key => texts[key] || key;
const mine = () => state && state.control === client;

async function post(path, fields) {
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: {"Content-Type": "application/json", "X-Threadstation": "page"},
      body: JSON.stringify({client, ...fields}),
    });
    $("said").textContent = (await answer.json()).message;
    return answer.ok;
  } catch {
    $("said").textContent = text("lost");
    return false;
  }
}

const stop = () => post("/api/stop", {});

function show(name) {
  screen = name;
  for (const section of document.querySelectorAll("main > section")) section.hidden = section.id !== name;
  for (const button of document.querySelectorAll("#screens button")) {
    if (button.dataset.screen === name) button.setAttribute("aria-current", "page");
    else button.removeAttribute("aria-current");
  }
  if (name === "session") showSession();
}

function time(seconds) {
  const minutes = Math.floor(seconds / 60);
  return minutes ? `${minutes} min ${Math.round(seconds % 60)} s` : `${Math.round(seconds)} s`;
}

function fill(list, names, chosen) {
  if ([...list.options].map(option => option.value).join("\n") === names.join("\n")) return;
  const before = chosen || list.value;
  list.replaceChildren(...names.map(name => new Option(name, name)));
  if (names.includes(before)) list.value = before;
}

function items(list, lines) {
  list.replaceChildren(...lines.map(line => Object.assign(document.createElement("li"), {textContent: line})));
}

function showJob(job) {
  $("job-title").textContent = !job ? text("idle")
    : `${job.title}: ${job.running ? text("running") : job.status === 0 ? text("ended_well") : text("ended_badly")}`;
  $("question").hidden = !(job && job.question);
  if (job && job.question) items($("instructions"), job.question);
  $("progress").hidden = !(job && job.running && !job.question);
  if (job) {
    $("label").textContent = `${job.done} / ${job.total} ${job.label}`;
    $("bar").value = job.total ? job.done / job.total : 0;
    $("left").textContent = job.seconds_left === null ? "" : `${time(job.seconds_left)} ${text("left")}`;
    const lines = $("lines"), end = lines.scrollTop + lines.clientHeight >= lines.scrollHeight - 4;
    lines.textContent = job.lines.join("\n");
    if (end) lines.scrollTop = lines.scrollHeight;
  }
}

async function showSession() {
  if (!session) { $("tiles").replaceChildren(); $("session-state").textContent = ""; return; }
  const answer = await fetch("/api/session?name=" + encodeURIComponent(session));
  if (!answer.ok) return;
  const found = await answer.json();
  $("session-state").textContent = `${found.spool || ""} · ${found.state}`;
  $("tiles").replaceChildren(...found.views.map(view => {
    const tile = document.createElement("div");
    tile.className = "tile " + (view.grade || "");
    tile.setAttribute("role", "listitem");
    const number = Object.assign(document.createElement("strong"), {textContent: view.number});
    const name = Object.assign(document.createElement("p"), {textContent: view.step});
    const grade = Object.assign(document.createElement("p"), {textContent: text(view.grade || "missing") + (view.reason ? ": " + view.reason : "")});
    tile.append(number, name, grade);
    if (view.grade) {
      const again = Object.assign(document.createElement("button"), {type: "button", textContent: text("reshoot"), disabled: !mine()});
      again.setAttribute("aria-label", `${text("reshoot")} ${view.number}`);
      again.onclick = () => post("/api/job", {kind: "reshoot", name: session, view: view.number}).then(ok => ok && show("bench"));
      tile.append(again);
    }
    return tile;
  }));
  $("report-link").hidden = !found.report;
  $("report-link").href = "/report?name=" + encodeURIComponent(session);
}

function render() {
  $("rig").textContent = "· " + state.rig;
  const control = $("control");
  control.textContent = mine() ? text("control_mine") : state.control ? text("control_other") : text("control_free");
  control.disabled = mine();
  for (const button of document.querySelectorAll("form button, #done, #decline, #pause, [data-kind]")) button.disabled = !mine();
  showJob(state.job);
  items($("calibrations"), state.calibrations);
  fill($("capture-form").spool, state.spools);
  fill($("capture-form").calibration, state.calibrations);
  fill($("session-choice"), state.sessions.map(line => line.name));
  session = $("session-choice").value;
  const {library: threads} = state;
  $('threads').replaceChildren(...threads.map(thread => {
    const row = document.createElement("tr");
    for (const value of [thread.number, thread.name, thread.diameter_mm,
                         thread.relative_rmse === null ? "" : (100 * thread.relative_rmse).toFixed(1) + " %", thread.added_utc])
      row.append(Object.assign(document.createElement("td"), {textContent: value}));
    return row;
  }));
  if (screen === "session") showSession();
}

let asking = false, again = false;
async function refresh() {
  if (asking) { again = true; return; }
  asking = true;
  try {
    const answer = await fetch("/api/state");
    if (answer.ok) { state = await answer.json(); render(); }
  } catch { $("said").textContent = text("lost"); }
  asking = false;
  if (again) { again = false; setTimeout(refresh, 100); }
}

function form(id, kind) {
  $(id).onsubmit = event => {
    event.preventDefault();
    post("/api/job", {kind, ...Object.fromEntries(new FormData($(id)))}).then(ok => ok && show("bench"));
  };
}

async function begin() {
  texts = await (await fetch("/texts.json")).json();
  for (const element of document.querySelectorAll("[data-text]")) element.textContent = text(element.dataset.text);
  document.body.dataset.theme = localStorage.theme || "dark";
  for (const button of document.querySelectorAll("#screens button")) button.onclick = () => show(button.dataset.screen);
  for (const button of document.querySelectorAll("[data-kind]"))
    button.onclick = () => post("/api/job", {kind: button.dataset.kind, name: session}).then(ok => ok && show("bench"));
  form("calibrate-form", "calibrate");
  form("capture-form", "capture");
  $("control").onclick = () => post("/api/control", {take: Boolean(state && state.control)});
  $("theme").onclick = () => { document.body.dataset.theme = localStorage.theme = document.body.dataset.theme === "red" ? "dark" : "red"; };
  $("stop").onclick = stop;
  $("done").onclick = () => post("/api/answer", {done: true});
  $("decline").onclick = () => post("/api/answer", {done: false});
  $("pause").onclick = () => post("/api/pause", {});
  $("session-choice").onchange = () => { session = $("session-choice").value; showSession(); };
  addEventListener("keydown", event => {
    if (event.key === "Escape") { event.preventDefault(); stop(); return; }
    if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA|BUTTON|A)$/.test(event.target.tagName)) return;
    if (event.key === "Enter" && !$("question").hidden && mine()) post("/api/answer", {done: true});
    if (event.key === "p" && !$("progress").hidden && mine()) post("/api/pause", {});
    if (event.key === "t") $("theme").click();
  });
  show("bench");
  await refresh();
  const events = new EventSource("/api/events");
  events.onmessage = refresh;
  events.onopen = refresh;
  events.onerror = () => { $("said").textContent = text("lost"); };
}

begin();
