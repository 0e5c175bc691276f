// Result: photograph against fit, view by view; parameters and curves with their errors; cloth in a weave and colours to choose.

import {allow, byId, fill, hasText, make, percent, row, text} from "/document.js";
import {curves} from "/curves.js";
import {fillStops, tellClipping} from "/exposure.js";
import {said} from "/phrases.js";
import {ask, picture, startJob, state, whyNot} from "/station.js";
import {session} from "/session.js";

const kGood = 0.1, kUsable = 0.2;  // relative RMSE of a fit

let shown = "", result = null;

const stops = () => byId("stops").value;
const residual = () => byId("compare-with").value === "residual";

function showView() {
  const view = byId("view-choice").value;
  if (!view) return;
  const made = `${session}-${shown}`;
  tellClipping(byId("photographed"), byId("view-clipped")).src = picture({of: "photographed", session, view, made, stops: stops()});
  byId("fitted").src = picture({of: residual() ? "residual" : "fitted", session, view, made, stops: stops()});
  const line = result.views.find(one => one.id === view);
  byId("view-figures").textContent =
    line ? `${line.held_out ? `${text("held_out")}: ` : ""}${text("relative_rmse")} ${percent(line.relative_rmse)} · ${text("relative_bias")} ${percent(line.relative_bias)}` : "";
}

function wipe() { byId("fitted").style.clipPath = `inset(0 0 0 ${byId("wipe").value}%)`; byId("wipe-line").style.left = `${byId("wipe").value}%`; }

// Each by its name in words and a sentence; its symbol after that.
export function unknownRows(thread) {
  return thread.unknowns.map(one => {
    const name = make("span", {}, make("strong", {textContent: hasText(`name_${one.name}`) ? text(`name_${one.name}`) : one.name}),
                      make("span", {className: "dim symbol", textContent: ` ${one.name}`}));
    if (hasText(`about_${one.name}`)) name.append(make("span", {className: "about", textContent: text(`about_${one.name}`)}));
    return row(name, one.value.toPrecision(3), `± ${one.sigma.toPrecision(2)}`, one.at_bound ? text("at_bound") : "");
  });
}

// In words first: whether to believe it.
function verdict() {
  const off = result.relative_rmse, grade = off === null ? "not" : off <= kGood ? "good" : off <= kUsable ? "usable" : "not";
  byId("fit-verdict").className = `verdict-line ${grade}`;
  byId("fit-verdict").replaceChildren(make("strong", {textContent: text(`fit_${grade}`)}), ` · ${text(`fit_${grade}_means`)}`);
}

export function colourWords(colour) {
  const [l, a, b] = colour.lab;
  return `${colour.srgb} · Lab ${l.toFixed(1)}, ${a.toFixed(1)}, ${b.toFixed(1)}${colour.clipped ? ` · ${text("colour_clipped")}` : ""}`;
}

export function chip(colour) {
  const made = make("div", {className: "swatch"});
  made.style.backgroundColor = colour.srgb;
  return made;
}

export const colourMeans = colour => text(colour.of === "views" ? "colour_of_views" : "colour_of_model");

function showCloth() {
  byId("cloth-pictures").replaceChildren(...result.cloth.map(one => {
    const clipped = make("span", {className: "dim"}), image = tellClipping(make("img", {alt: text(`cloth_${one.name}`)}), clipped);
    image.src = picture({of: "cloth", session, view: one.name, made: one.made, stops: stops()});
    return make("figure", {}, image, make("figcaption", {}, `${text(`cloth_${one.name}`)} `, clipped));
  }));
  const woven = result.cloth_colour;
  const of = result.cloth_made_of, itsOwn = of && !of.warp && !of.weft;
  byId("cloth-colour").replaceChildren(...(woven ? [chip(woven), make("p", {}, colourWords(woven), make("span", {className: "about",
    textContent: `${text("colour_of_cloth")}${itsOwn ? ` ${text("colour_to_thread", {value: result.cloth_delta_e_2000.toFixed(1)})}` : ""}`}))] : []));
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
  const why = whyNot();
  allow(byId("cloth-form").querySelector(".primary"), why);
  byId("cloth-why").textContent = why;
  byId("fit").hidden = !fitted;
  if (!fitted) return;
  const found = await ask("/api/result", {name: session});
  if (!found || JSON.stringify([session, found]) === shown) return;
  shown = JSON.stringify([session, found]);
  result = found;
  byId("fit-figures").textContent = `${result.name} · ${result.diameter_mm} mm · ${text("fit")} ${percent(result.relative_rmse)}`;
  verdict();
  byId("swatch").style.backgroundColor = result.colour.srgb;
  byId("colour-words").textContent = colourWords(result.colour);
  byId("colour-means").textContent = colourMeans(result.colour);
  byId("doubts").replaceChildren(...result.doubts.map(doubt => make("li", {textContent: said(doubt)})));
  byId("unknowns").replaceChildren(...unknownRows(result));
  byId("curves").replaceChildren(curves([result]));
  fill(byId("view-choice"), result.views.map(view => view.id), result.views.map(view => `${view.id} · ${percent(view.relative_rmse)}`));
  showView();
  showCloth();
}

export function beginResult() {
  byId("view-choice").onchange = showView;
  byId("compare-with").onchange = showView;
  fillStops(byId("stops"));
  byId("stops").onchange = () => {
    showView();
    showCloth();
  };
  byId("wipe").oninput = wipe;
  wipe();
  const form = byId("cloth-form");
  form.draft.onchange = showDraft;
  const colours = () => { byId("chosen-colours").hidden = form.own.value !== "chosen"; };
  form.own.onchange = colours;
  colours();
  form.onsubmit = event => {
    event.preventDefault();
    const fields = {kind: "cloth", name: session, draft: form.draft.value, quick: form.quick.checked};
    if (form.own.value === "chosen") Object.assign(fields, {warp_colour: form.warp.value, weft_colour: form.weft.value});
    startJob(fields);
  };
}
