// Capture: the spool form with its barcode, one spool, the queue.

import {calibrationVerdict, newestCalibration} from "/calibration.js";
import {allow, byId, fill, row, show, text} from "/document.js";
import {said} from "/phrases.js";
import {post, startJob, state, whyNot} from "/station.js";

const numbers = ["turns", "diameter_mm"];

export function showForms() {
  const spools = state.spools.map(spool => spool.name);
  const titles = state.spools.map(spool => spool.sample && spool.sample.name ? `${spool.name} · ${spool.sample.name}` : spool.name);
  fill(byId("capture-form").spool, spools, titles);
  const solved = state.calibrations.filter(one => one.utc), names = solved.map(one => one.name), newest = newestCalibration();
  const verdicts = solved.map(one => `${one.name} · ${text("calibration_" + calibrationVerdict(one))}`);
  for (const form of ["capture-form", "queue-form"]) {
    const list = byId(form).calibration, empty = list.options.length === 0;
    fill(list, names, verdicts);
    if (empty && newest) list.value = newest.name;
  }
  fill(byId("check-form").calibration, ["", ...names], [text("no_calibration"), ...verdicts]);
  fill(byId("queue-form").queue, state.queues.map(queue => queue.name));
  fill(byId("spool-form").simulated, state.simulated_spools);
  // A wound frame has two runs of thread; the simulated bench has the front one alone unless it is told otherwise.
  if (!byId("spool-form").sheets.chosen) byId("spool-form").sheets.value = state.simulated_spools.length ? "front" : "front_and_back";
  byId("spool-form").sheets.chosen = true;
  byId("simulated").hidden = state.simulated_spools.length === 0;
  byId("queue-form").hidden = state.queues.length === 0;
  const why = whyNot() || (spools.length === 0 ? text("no_spool") : names.length === 0 ? text("no_calibration_yet") : "");
  allow(byId("capture-form").querySelector(".primary"), why);
  byId("capture-why").textContent = why;
  fill(byId("people"), [...new Set(people())]);
  showQueue();
}

// Who captured here before, for the browser to complete.
const people = () => JSON.parse(localStorage.people || "[]");

function remember(person) {
  if (person) localStorage.people = JSON.stringify([person, ...people().filter(one => one !== person)].slice(0, 20));
}

function showQueue() {
  const queue = state.queues.find(one => one.name === byId("queue-form").queue.value);
  byId("queue-problem").textContent = queue ? said(queue.problem) : "";
  show(byId("queue-rows"), queue, () => (queue ? queue.spools : []).map(spool =>
    row(spool.session, spool.sample.name, spool.sample.lot, spool.sample.material, spool.sample.colour, spool.state || text("waiting"))));
}

// Of a spool that is known, everything else is filled in.
export function scanned(barcode) {
  const form = byId("spool-form"), wanted = barcode.trim();
  form.barcode.value = wanted;
  const known = state.spools.find(spool => spool.sample && spool.sample.barcode === wanted);
  if (known) {
    for (const key of ["name", "lot", "material", "colour", "note"]) form.elements[key].value = known.sample[key];
    for (const key of numbers) if (known[key] !== undefined) form[key].value = known[key];
    byId("capture-form").spool.value = known.name;
  }
  byId("spool-said").textContent = text(known ? "spool_known" : "spool_new");
  form.elements.name.focus();
}

async function writeSpool(event) {
  event.preventDefault();
  const form = event.target, fields = Object.fromEntries(new FormData(form));
  for (const key of numbers) fields[key] = Number(fields[key]);
  if (!state.simulated_spools.length) delete fields.simulated;
  const answer = await post("/api/spool", fields);
  byId("spool-said").textContent = said(answer.message);
  if (!answer.ok) return;
  const capture = byId("capture-form");
  if (![...capture.spool.options].some(option => option.value === answer.name)) capture.spool.append(new Option(answer.name, answer.name));
  capture.spool.value = answer.name;
  capture.elements.name.value = answer.name;
  capture.person.focus();
}

export function beginForms() {
  byId("capture-form").onsubmit = event => {
    event.preventDefault();
    const {whole, ...fields} = Object.fromEntries(new FormData(event.target));
    remember(fields.person);
    startJob({kind: whole ? "digitize" : "capture", ...fields});
  };
  byId("queue-form").onsubmit = event => {
    event.preventDefault();
    const {queue, ...fields} = Object.fromEntries(new FormData(event.target));
    remember(fields.person);
    startJob({kind: "queue", name: queue, ...fields});
  };
  byId("queue-form").queue.onchange = showQueue;
  const spool = byId("spool-form");
  spool.onsubmit = writeSpool;
  spool.barcode.onkeydown = event => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    scanned(spool.barcode.value);
  };
}
