// Library: search, two threads side by side, export.

import {byId, fill, make, percent, row, text} from "/document.js";
import {curves} from "/curves.js";
import {ask, inControl, picture, startJob, state} from "/station.js";
import {unknownRows} from "/result.js";

let chosen = [];  // numbers, the last two that were marked
let shown = "";   // what the table was made of; made again only for something else, so that the focus stays where it is

function matches(thread, words) {
  const all = [thread.name, thread.session, thread.added_utc, ...Object.values(thread.sample)].join(" ").toLowerCase();
  return words.toLowerCase().split(/\s+/).every(word => all.includes(word));
}

function mark(number, wanted) {
  chosen = chosen.filter(one => one !== number);
  if (wanted) chosen = [...chosen, number].slice(-2);
  showLibrary();
}

function choice(thread) {
  const box = make("input", {type: "checkbox", checked: chosen.includes(thread.number)});
  box.setAttribute("aria-label", `${text("compare")} ${thread.number}`);
  box.onchange = () => mark(thread.number, box.checked);
  return box;
}

function exportButton(thread) {
  const format = byId("export-format").value, name = `thread-${thread.number}-${format}`;
  if (state.exports.includes(name)) return make("span", {textContent: `${text("exported")}: exports/${name}`});
  const button = make("button", {type: "button", textContent: text("export"), disabled: !inControl()});
  button.setAttribute("aria-label", `${text("export")} ${thread.number}`);
  button.dataset.export = thread.number;
  button.onclick = () => startJob({kind: "export", number: thread.number, format, name});
  return button;
}

async function showComparison() {
  const threads = (await Promise.all(chosen.map(number => ask("/api/thread", {number})))).filter(Boolean);
  byId("comparison").hidden = threads.length === 0;
  byId("compared").replaceChildren(...threads.map((thread, i) => {
    const line = state.threads.find(one => one.number === chosen[i]);
    const column = make("div", {className: "thread"}, make("h4", {textContent: `${chosen[i]} · ${thread.name}`}));
    const swatch = make("div", {className: "swatch"});
    swatch.style.backgroundColor = thread.colour;
    const woven = line && state.sessions.some(one => one.name === line.session && one.cloth);
    column.append(swatch, make("p", {textContent: `${thread.diameter_mm} mm · ${text("fit")} ${percent(thread.relative_rmse)}`}),
      ...(woven ? [make("img", {src: picture({of: "cloth", session: line.session, view: "swatch"}), alt: text("cloth_swatch")})] : []),
      make("table", {}, make("tbody", {}, ...unknownRows(thread))));
    return column;
  }));
  byId("compared-curves").replaceChildren(...(threads.length ? [curves(threads)] : []));
}

export function showLibrary() {
  const words = byId("search").value.trim(), found = state.threads.filter(thread => matches(thread, words));
  fill(byId("export-format"), state.export_formats, state.export_formats.map(format => text(`export_${format}`)));
  const mark = JSON.stringify([found, chosen, state.exports, byId("export-format").value, inControl()]);
  if (mark === shown) return;
  shown = mark;
  byId("found").textContent = `${found.length} / ${state.threads.length}`;
  byId("threads").replaceChildren(...found.map(thread => row(choice(thread), thread.number, thread.name, thread.sample.barcode,
    thread.sample.lot, thread.sample.colour, thread.diameter_mm, percent(thread.relative_rmse), exportButton(thread))));
  return showComparison();
}

export function beginLibrary() {
  byId("search").oninput = showLibrary;
  byId("export-format").onchange = showLibrary;
}
