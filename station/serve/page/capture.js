// Calibrate, and capture: the spool form with its barcode, and the queue.

import {byId, fill, make, row, text} from "/document.js";
import {post, startJob, state} from "/station.js";

const numbers = ["turns", "diameter_mm"];

export function showForms() {
  const spools = state.spools.map(spool => spool.name);
  const titles = state.spools.map(spool => spool.sample && spool.sample.name ? `${spool.name} · ${spool.sample.name}` : spool.name);
  fill(byId("capture-form").spool, spools, titles);
  for (const form of ["capture-form", "queue-form"]) fill(byId(form).calibration, state.calibrations);
  fill(byId("check-form").calibration, ["", ...state.calibrations], [text("no_calibration"), ...state.calibrations]);
  fill(byId("queue-form").queue, state.queues.map(queue => queue.name));
  fill(byId("spool-form").simulated, state.simulated_spools);
  byId("simulated").hidden = state.simulated_spools.length === 0;
  byId("queue-form").hidden = state.queues.length === 0;
  byId("calibrations").replaceChildren(...state.calibrations.map(name => make("li", {textContent: name})));
  showQueue();
}

function showQueue() {
  const queue = state.queues.find(one => one.name === byId("queue-form").queue.value);
  byId("queue-problem").textContent = queue && queue.problem ? queue.problem : "";
  byId("queue-rows").replaceChildren(...(queue ? queue.spools : []).map(spool =>
    row(spool.session, spool.sample.name, spool.sample.lot, spool.sample.material, spool.sample.colour, spool.state || text("waiting"))));
}

// A scanner types the barcode and Enter: of a spool that is known, everything else is filled in.
function scanned(form) {
  const known = state.spools.find(spool => spool.sample && spool.sample.barcode === form.barcode.value.trim());
  if (known) {
    for (const key of ["name", "lot", "material", "colour", "note"]) form[key].value = known.sample[key];
    for (const key of numbers) if (known[key] !== undefined) form[key].value = known[key];
    byId("capture-form").spool.value = known.name;
  }
  byId("spool-said").textContent = text(known ? "spool_known" : "spool_new");
  form.name.focus();
}

async function writeSpool(event) {
  event.preventDefault();
  const form = event.target, fields = Object.fromEntries(new FormData(form));
  for (const key of numbers) fields[key] = Number(fields[key]);
  if (!state.simulated_spools.length) delete fields.simulated;
  const answer = await post("/api/spool", fields);
  byId("spool-said").textContent = answer.message || "";
  if (!answer.ok) return;
  const capture = byId("capture-form");
  if (![...capture.spool.options].some(option => option.value === answer.name)) capture.spool.append(new Option(answer.name, answer.name));
  capture.spool.value = answer.name;
  if (!capture.name.value) capture.name.value = answer.name;
  capture.person.focus();
}

export function beginForms(started) {
  const submit = (id, fields) => {
    byId(id).onsubmit = event => {
      event.preventDefault();
      startJob(fields(Object.fromEntries(new FormData(event.target)))).then(answer => answer.ok && started());
    };
  };
  submit("calibrate-form", fields => ({kind: "calibrate", ...fields}));
  submit("capture-form", fields => ({kind: "capture", ...fields}));
  submit("queue-form", ({queue, ...fields}) => ({kind: "queue", name: queue, ...fields}));
  byId("queue-form").queue.onchange = showQueue;
  const spool = byId("spool-form");
  spool.onsubmit = writeSpool;
  spool.barcode.onkeydown = event => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    scanned(spool);
  };
}
