// Result: photograph against fit, view by view; parameters and curves with their errors; cloth in a weave and colours to choose.

import {byId, fill, make, percent, row, text} from "/document.js";
import {curves} from "/curves.js";
import {ask, picture, startJob, state} from "/station.js";
import {session} from "/session.js";

let shown = "", result = null;

const residual = () => byId("compare-with").value === "residual";

function showView() {
  const view = byId("view-choice").value;
  if (!view) return;
  const made = `${session}-${shown}`;
  byId("photographed").src = picture({of: "photographed", session, view, made});
  byId("fitted").src = picture({of: residual() ? "residual" : "fitted", session, view, made});
  const line = result.views.find(one => one.id === view);
  byId("view-figures").textContent =
    line ? `${line.held_out ? `${text("held_out")}: ` : ""}${text("relative_rmse")} ${percent(line.relative_rmse)} · ${text("relative_bias")} ${percent(line.relative_bias)}` : "";
}

function wipe() { byId("fitted").style.clipPath = `inset(0 0 0 ${byId("wipe").value}%)`; byId("wipe-line").style.left = `${byId("wipe").value}%`; }

export function unknownRows(thread) {
  return thread.unknowns.map(one => row(one.name, one.value.toPrecision(3), `± ${one.sigma.toPrecision(2)}`, one.at_bound ? text("at_bound") : ""));
}

function showCloth() {
  byId("cloth-pictures").replaceChildren(...result.cloth.map(one => make("figure", {},
    make("img", {src: picture({of: "cloth", session, view: one.name, made: one.made}), alt: text(`cloth_${one.name}`)}),
    make("figcaption", {textContent: text(`cloth_${one.name}`)}))));
  const of = result.cloth_made_of;
  const colour = (key, system) => system
    ? `${text(key)} ${"#" + system.srgb.map(value => value.toString(16).padStart(2, "0")).join("")}, ${text("gamut")} ${system.delta_e_2000.toFixed(1)}`
    : `${text(key)} ${text("own_colour")}`;
  byId("cloth-made-of").textContent = of ? `${of.draft} · ${colour("warp", of.warp)} · ${colour("weft", of.weft)}` : text("no_cloth");
}

function showDraft() { byId("draft-picture").src = picture({of: "draft", name: byId("cloth-form").draft.value}); }

export async function showResult() {
  fill(byId("cloth-form").draft, state.drafts);
  if (!byId("draft-picture").src && state.drafts.length) showDraft();
  const line = state.sessions.find(one => one.name === session), fitted = Boolean(line && line.inverted);
  byId("no-result").hidden = fitted;
  byId("fit").hidden = !fitted;
  if (!fitted) return;
  const found = await ask("/api/result", {name: session});
  if (!found || JSON.stringify([session, found]) === shown) return;
  shown = JSON.stringify([session, found]);
  result = found;
  byId("fit-figures").textContent = `${result.name} · ${result.diameter_mm} mm · ${text("fit")} ${percent(result.relative_rmse)}`;
  byId("swatch").style.backgroundColor = result.colour;
  byId("doubts").replaceChildren(...result.doubts.map(doubt => make("li", {textContent: doubt})));
  byId("unknowns").replaceChildren(...unknownRows(result));
  byId("curves").replaceChildren(curves([result]));
  fill(byId("view-choice"), result.views.map(view => view.id), result.views.map(view => `${view.id} · ${percent(view.relative_rmse)}`));
  showView();
  showCloth();
}

export function beginResult(started) {
  byId("view-choice").onchange = showView;
  byId("compare-with").onchange = showView;
  byId("wipe").oninput = wipe;
  wipe();
  const form = byId("cloth-form");
  form.draft.onchange = showDraft;
  form.onsubmit = event => {
    event.preventDefault();
    const fields = {kind: "cloth", name: session, draft: form.draft.value, quick: form.quick.checked};
    if (form.own.value === "chosen") Object.assign(fields, {warp_colour: form.warp.value, weft_colour: form.weft.value});
    startJob(fields).then(answer => answer.ok && started());
  };
}
