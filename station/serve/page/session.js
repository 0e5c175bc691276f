// Session: the contact sheet with a verdict for each view, and what can be done next.

import {byId, fill, make, text, time} from "/document.js";
import {ask, inControl, picture, startJob, state} from "/station.js";

export let session = "";

const shown = new Map();  // tiles by step, as they stand, so that pictures are not asked for again

function tile(view, started) {
  const known = shown.get(view.step), mark = JSON.stringify([session, view, inControl()]);
  if (known && known.mark === mark) return known.element;
  const element = make("div", {className: `tile ${view.grade || ""}`}, make("strong", {textContent: `${view.number}`}));
  element.setAttribute("role", "listitem");
  if (view.picture)
    element.append(make("img", {src: picture({of: "raw", session, step: view.step, id: view.picture.slice(0, 16)}),
                                alt: `${text("view")} ${view.number}`, loading: "lazy"}));
  element.append(make("p", {textContent: view.step}),
                 make("p", {className: "verdict", textContent: text(view.grade || "missing") + (view.reason ? `: ${view.reason}` : "")}));
  if (view.grade) {
    const again = make("button", {type: "button", textContent: text("reshoot"), disabled: !inControl()});
    again.setAttribute("aria-label", `${text("reshoot")} ${view.number}`);
    again.onclick = () => startJob({kind: "reshoot", name: session, view: view.number}).then(answer => answer.ok && started());
    element.append(again);
  }
  shown.set(view.step, {mark, element});
  return element;
}

export function showSessionChoice() {
  const names = state.sessions.map(line => line.name);
  for (const list of ["session-choice", "result-choice"]) {
    fill(byId(list), names);
    if (!session && names.length) session = names.at(-1);
    if (names.includes(session)) byId(list).value = session;
  }
  if (!names.includes(session)) session = "";
}

export function chooseSession(name) { session = name; showSessionChoice(); }

export async function showSession(started) {
  const found = session ? await ask("/api/session", {name: session}) : null;
  byId("session-state").textContent = found ? `${found.spool || ""} · ${found.state}` : text("no_session");
  byId("taken").textContent = found ? `${found.views.filter(view => view.grade).length} / ${found.views.length} ${text("taken")}${timeLeft()}` : "";
  const tiles = found ? found.views.map(view => tile(view, started)) : [];
  if (tiles.length !== byId("tiles").children.length || tiles.some(element => !element.isConnected))  // else the focus stays where it is
    byId("tiles").replaceChildren(...tiles);
  byId("report-link").hidden = !(found && found.report);
  byId("report-link").href = "/report?" + new URLSearchParams({name: session});
}

function timeLeft() {
  const job = state.job;
  return job && job.running && job.seconds_left !== null ? ` · ${time(job.seconds_left)} ${text("left")}` : "";
}

export function beginSession(started) {
  for (const button of document.querySelectorAll("[data-kind]"))
    button.onclick = () => startJob({kind: button.dataset.kind, name: session, quick: byId("quick").checked})
      .then(answer => answer.ok && started());
}
