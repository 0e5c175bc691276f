// Session: the contact sheet with a verdict for each view, and what can be done next, or why it cannot.

import {ago, allow, byId, fill, make, text, time} from "/document.js";
import {said} from "/phrases.js";
import {ask, jobRuns, picture, startJob, state, whyNot} from "/station.js";
import {openViewer} from "/viewer.js";

export let session = "";

const shown = new Map();  // tiles by step, as they stand, so that pictures are not asked for again

function tile(view) {
  const why = whyNot(), known = shown.get(view.step), mark = JSON.stringify([session, view, why]);
  if (known && known.mark === mark) return known.element;
  const element = make("div", {className: `tile ${view.grade || ""}`}, make("strong", {textContent: `${view.number}`}));
  element.setAttribute("role", "listitem");
  if (view.picture) {
    const enlarge = make("a", {className: "picture", href: "#", role: "button"},
      make("img", {src: picture({of: "raw", session, step: view.step, id: view.picture.slice(0, 16)}), alt: `${text("view")} ${view.number}, ${text("enlarge")}`, loading: "lazy"}));
    enlarge.onclick = event => { event.preventDefault(); openViewer(session, view); };
    element.append(enlarge);
  }
  element.append(make("p", {textContent: view.step}),
                 make("p", {className: "verdict", textContent: text(view.grade || "missing") + (view.reason ? `: ${said(view.reason)}` : "")}));
  if (view.grade && view.grade !== "good") element.append(make("p", {}, make("a", {href: "/handbook/verdicts.html", target: "_blank", textContent: text("what_to_do")})));
  if (view.grade) {
    const again = make("button", {type: "button", textContent: text("reshoot")});
    again.setAttribute("aria-label", `${text("reshoot")} ${view.number}`);
    again.onclick = () => startJob({kind: "reshoot", name: session, view: view.number});
    allow(again, why);
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
  if (!names.includes(session)) session = names.at(-1) || "";
}

export function chooseSession(name) { session = name; }

// Why a step cannot be done now; empty when it can.
function reason(kind, line) {
  if (!line) return text("no_session");
  if (whyNot()) return whyNot();
  const complete = !line.left.includes("capture"), views = text("views_missing", {n: line.views - line.taken, of: line.views});
  switch (kind) {
    case "process": return line.left.length ? "" : text("nothing_left");
    case "resume": return complete ? text("all_taken") : "";
    case "develop": return complete ? "" : views;
    case "invert": return !complete ? views : line.left.includes("develop") ? text("not_developed") : "";
    case "report": return complete ? "" : views;
    default: return !line.inverted ? text("not_fitted") : !line.left.includes("add") ? text("in_library") : "";
  }
}

export async function showSession() {
  const line = state.sessions.find(one => one.name === session), found = session ? await ask("/api/session", {name: session}) : null;
  byId("session-state").textContent = found ? `${found.spool || ""} · ${text("state_" + found.state)}${found.utc ? ` · ${ago(found.utc)}` : ""}` : text("no_session");
  byId("taken").textContent = found ? `${found.views.filter(view => view.grade).length} / ${found.views.length} ${text("taken")}${timeLeft()}` : "";
  byId("session-left").textContent = line && line.left.length ? `${text("lacks")} ${line.left.map(one => text(`step_${one}`)).join(", ")}.` : "";
  for (const button of document.querySelectorAll("[data-kind]")) allow(button, reason(button.dataset.kind, line));
  const whys = ["resume", "develop", "invert", "report", "add"].map(kind => [kind, reason(kind, line)]).filter(([, why]) => why);
  byId("session-why").textContent = !line ? "" : whyNot() || whys.map(([kind, why]) => `${text(`step_${kind}`)}: ${why}`).join(" · ");
  const tiles = found ? found.views.map(tile) : [];
  if (tiles.length !== byId("tiles").children.length || tiles.some(element => !element.isConnected))  // else the focus stays where it is
    byId("tiles").replaceChildren(...tiles);
  const link = byId("report-link");
  link.hidden = !(found && found.report);
  link.textContent = text(found && found.left.includes("report") ? "open_old_report" : "open_report");
  link.href = "/report?" + new URLSearchParams({name: session});
}

function timeLeft() {
  return jobRuns() && state.job.seconds_left !== null ? ` · ${time(state.job.seconds_left)} ${text("left")}` : "";
}

export function beginSession() {
  for (const button of document.querySelectorAll("[data-kind]"))
    button.onclick = () => startJob({kind: button.dataset.kind, name: session, quick: byId("quick").checked});
}
