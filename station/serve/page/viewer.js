// A view of a session as large as the window, beside the same view of another session.

import {byId, fill, make, text} from "/document.js";
import {said} from "/phrases.js";
import {picture, state} from "/station.js";

let shown = null, before = null;

function side(session, view) {
  return make("figure", {}, make("img", {src: picture({of: "raw", session, step: view.step, size: "large", id: (view.picture || "").slice(0, 16)}),
                                         alt: `${session}: ${view.step}`}),
              make("figcaption", {textContent: session}));
}

function draw() {
  const other = byId("viewer-other").value;
  byId("viewer-pictures").replaceChildren(side(shown.session, shown.view), ...(other ? [side(other, {step: shown.view.step})] : []));
}

export function openViewer(session, view) {
  shown = {session, view};
  before = document.activeElement;
  byId("viewer").hidden = false;
  byId("viewer-title").textContent = `${view.number} · ${view.step}`;
  byId("viewer-verdict").textContent = text(view.grade || "missing") + (view.reason ? `: ${said(view.reason)}` : "");
  const others = state.sessions.map(line => line.name).filter(name => name !== session);
  fill(byId("viewer-other"), ["", ...others], [text("none"), ...others]);
  byId("viewer-other").value = "";
  byId("viewer-other").onchange = draw;
  byId("viewer-close").onclick = closeViewer;
  byId("viewer-close").focus();
  draw();
}

// Whether one was open.
export function closeViewer() {
  if (byId("viewer").hidden) return false;
  byId("viewer").hidden = true;
  byId("viewer-pictures").replaceChildren();
  if (before) before.focus();
  return true;
}
