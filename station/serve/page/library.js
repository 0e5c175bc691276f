// Library: pictures, search, tags, duplicates by barcode, edit, taking out and putting back, two threads side by side, export.

import {ago, allow, byId, fill, make, percent, row, show, text} from "/document.js";
import {curves} from "/curves.js";
import {threadPicture} from "/overview.js";
import {ask, go, inControl, post, startJob, state, whyNot} from "/station.js";
import {chip, colourMeans, colourWords, unknownRows} from "/result.js";

const kFields = ["name", "barcode", "lot", "material", "colour", "note"];

let chosen = [];   // numbers, the last two that were marked
let edited = 0;    // the number of the thread whose form is open
let lotsOf = "";   // the threads whose lots are shown
let takenOut = 0;  // the number that can be put back

function matches(thread, words) {
  const all = [thread.number, thread.name, thread.session, thread.added_utc, ...Object.values(thread.sample), ...thread.tags].join(" ").toLowerCase();
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

function button(key, thread, act, why = "") {
  const made = make("button", {type: "button", textContent: text(key), onclick: act});
  made.setAttribute("aria-label", `${text(key)} ${thread.number}`);
  allow(made, why);
  return made;
}

function exported(thread) {
  const format = byId("export-format").value, name = `thread-${thread.number}-${format}`;
  if (state.exports.includes(name))
    return make("a", {href: "/download?" + new URLSearchParams({name}), download: `${name}.zip`, textContent: `${text("download")} ${name}.zip`});
  const made = button("export", thread, () => startJob({kind: "export", number: thread.number, format, name}), whyNot());
  made.dataset.export = thread.number;
  return made;
}

function searchFor(words) {
  byId("search").value = words;
  showLibrary();
}

async function change(fields) {
  const answer = await post("/api/thread", fields);
  if (answer.ok && "removed" in fields) takenOut = fields.removed ? fields.number : 0;
  if (answer.ok) edited = 0;
  showLibrary();
}

function editForm(thread) {
  const form = make("form", {className: "edit"}, ...kFields.map(key => make("label", {}, make("span", {textContent: text(key === "material" ? "fiber" : key)}),
    make("input", {name: key, value: thread.sample[key], maxLength: 100, autocomplete: "off"}))),
    make("label", {}, make("span", {textContent: text("tags_how")}), make("input", {name: "tags", value: thread.tags.join(", "), maxLength: 200, autocomplete: "off"})), make("button", {textContent: text("keep")}),
    button("cancel", thread, () => { edited = 0; showLibrary(); }));
  form.onsubmit = event => {
    event.preventDefault();
    change({number: thread.number, ...Object.fromEntries(new FormData(form))});
  };
  return make("tr", {}, make("td", {colSpan: 9}, form));
}

function lines(thread, twins) {
  const name = make("span", {}, make("strong", {textContent: thread.name}));
  if (twins > 1) name.append(make("span", {className: "badge", textContent: text("same_barcode", {n: twins})}));
  name.append(make("span", {className: "about", textContent: `${ago(thread.added_utc)}${thread.sample.note ? ` · ${thread.sample.note}` : ""}`}));
  for (const tag of thread.tags) {
    const shown = make("button", {type: "button", className: "tag", textContent: tag, onclick: () => searchFor(tag)});
    shown.setAttribute("aria-label", `${text("search")} ${tag}`);
    name.append(shown);
  }
  const actions = make("div", {className: "row tight"}, exported(thread),
    button("edit", thread, () => { edited = edited === thread.number ? 0 : thread.number; showLibrary(); }),
    make("a", {className: "as-button", href: "/label?" + new URLSearchParams({number: thread.number}), target: "_blank", rel: "noopener", textContent: text("label"), ariaLabel: `${text("label")} ${thread.number}`}),
    button("design_of", thread, () => go("design", thread.number)),
    button("take_out", thread, () => change({number: thread.number, removed: true})));
  const shown = row(choice(thread), make("span", {className: "thumb"}, ...threadPicture(thread)), thread.number, name, thread.sample.barcode, thread.sample.lot,
                    [thread.sample.material, thread.sample.colour].filter(Boolean).join(", "), [`${thread.diameter_mm} mm`, percent(thread.relative_rmse)].filter(Boolean).join(" · "), actions);
  return edited === thread.number ? [shown, editForm(thread)] : [shown];
}

async function showComparison() {
  const [first, second] = chosen;
  const threads = (await Promise.all(chosen.map(number => ask("/api/thread", number === second ? {number, with: first} : {number})))).filter(Boolean);
  byId("comparison").hidden = threads.length === 0;
  byId("compared").replaceChildren(...threads.map((thread, i) => {
    const line = state.threads.find(one => one.number === chosen[i]);
    const column = make("div", {className: "thread"}, make("h4", {textContent: `${chosen[i]} · ${thread.name}`}));
    column.append(chip(thread.colour), make("p", {}, colourWords(thread.colour), make("span", {className: "about", textContent: colourMeans(thread.colour)})),
      make("p", {textContent: `${thread.diameter_mm} mm · ${text("fit")} ${percent(thread.relative_rmse)}`}),
      ...("delta_e_2000" in thread ? [make("p", {textContent: text("colour_difference", {value: thread.delta_e_2000.toFixed(1)})})] : []),
      ...(line ? threadPicture(line) : []), make("div", {className: "wide", tabIndex: 0}, make("table", {}, make("tbody", {}, ...unknownRows(thread)))));
    return column;
  }));
  byId("compared-curves").replaceChildren(...(threads.length ? [curves(threads)] : []));
}

export function showLibrary() {
  const words = byId("search").value.trim(), found = state.threads.filter(thread => matches(thread, words));
  fill(byId("export-format"), state.export_formats, state.export_formats.map(format => text(`export_${format}`)));
  byId("found").textContent = `${found.length} / ${state.threads.length}`;
  byId("undo").hidden = takenOut === 0;
  byId("undo-words").textContent = text("was_taken_out", {number: takenOut});
  byId("undo-button").onclick = () => change({number: takenOut, removed: false});
  const twins = thread => thread.sample.barcode ? state.threads.filter(other => other.sample.barcode === thread.sample.barcode).length : 1;
  const before = byId("threads").shown;
  show(byId("threads"), [found, chosen, edited, state.exports, byId("export-format").value, whyNot()], () => found.flatMap(thread => lines(thread, twins(thread))));
  byId("import-files").disabled = !inControl();
  if (before === byId("threads").shown) return null;
  showLots();
  return showComparison();
}

// Spools of one lot should look alike. The station reads all their threads for it: only when one has come, gone or changed.
async function showLots() {
  const now = JSON.stringify(state.threads.map(thread => [thread.number, thread.sample.lot]));
  if (now === lotsOf) return;
  lotsOf = now;
  const lots = state.threads.length ? await ask("/api/lots") || [] : [];
  byId("lots-part").hidden = lots.length === 0;
  byId("lots").replaceChildren(...lots.map(lot => row(make("strong", {textContent: lot.lot}), lot.numbers.join(", "),
    make("span", {}, chip(lot.colour), ` ${colourWords(lot.colour)}`),
    `${lot.mean_delta_e_2000.toFixed(1)} / ${lot.largest_delta_e_2000.toFixed(1)}`,
    lot.diameter_mm[0] === lot.diameter_mm[1] ? `${lot.diameter_mm[0]} mm` : `${lot.diameter_mm.join(" – ")} mm`)));
}

// Thread files, or one and beside it what the other lab knows of its spool.
async function importFiles(input) {
  const files = await Promise.all([...input.files].map(async file => ({name: file.name, content: await file.text()})));
  input.value = "";
  const format = file => { try { return JSON.parse(file.content).format; } catch { return ""; } };
  const sample = files.find(file => format(file) === "threadstation/sample");
  const threads = files.filter(file => file !== sample), told = sample && threads.length === 1 ? {sample: sample.content} : {};
  for (const file of threads) await post("/api/import", {name: file.name, thread: file.content, ...told});
}

export function beginLibrary() {
  byId("import-files").onchange = event => importFiles(event.target);
  byId("search").oninput = showLibrary;
  byId("export-format").onchange = showLibrary;
}
