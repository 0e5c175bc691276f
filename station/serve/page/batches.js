// Batches: how far each step of many sessions is, what failed, and a way to stop one.

import {allow, byId, make, row, show, text} from "/document.js";
import {said} from "/phrases.js";
import {ask, post, whyNot} from "/station.js";

const kStates = ["done", "running", "queued", "ready", "waiting", "stopped", "failed", "died", "held"];
const kNotOften_ms = 15000;  // each question goes through all records, and to Slurm
const kMostProblems = 20;    // the report has all of them

let asked = -Infinity, batches = [];

const busy = batch => batch.steps.some(step => step.running + step.queued > 0);

function table(batch) {
  const states = kStates.filter(state => batch.steps.some(step => step[state] > 0));
  const head = make("tr", {}, ...["step", "tasks", ...states.map(state => `task_${state}`)].map(key => make("th", {scope: "col", textContent: text(key)})));
  const body = batch.steps.map(step => row(step.step, step.tasks, ...states.map(state => step[state])));
  return make("div", {className: "wide", tabIndex: 0, role: "region", ariaLabel: `${text("batch")} ${batch.name}`}, make("table", {}, make("thead", {}, head), make("tbody", {}, ...body)));
}

function card(batch) {
  const title = make("h4", {textContent: batch.name});
  if (batch.problem) return make("div", {}, title, make("p", {className: "badly", textContent: said(batch.problem)}));
  const problems = batch.problems.slice(0, kMostProblems).map(problem => make("li", {textContent: `${problem.task}: ${problem.why}`}));
  const button = make("button", {type: "button", textContent: text("stop_batch"), ariaLabel: `${text("stop_batch")} ${batch.name}`});
  button.onclick = async () => { await post("/api/batch", {name: batch.name}); asked = -Infinity; showBatches(); };
  allow(button, busy(batch) ? whyNot() : text("batch_rests"));
  const report = make("a", {href: "/batch?" + new URLSearchParams({name: batch.name}), target: "_blank", rel: "noopener", className: "as-button", textContent: text("open_report"), ariaLabel: `${text("open_report")} ${batch.name}`});
  return make("div", {}, title, table(batch), ...(problems.length ? [make("ul", {className: "badly"}, ...problems)] : []), make("div", {className: "row tight"}, report, button));
}

export async function showBatches() {
  if (performance.now() - asked > kNotOften_ms) {
    asked = performance.now();
    batches = await ask("/api/batches") || batches;
  }
  byId("batches-part").hidden = batches.length === 0;
  show(byId("batches"), [batches, whyNot()], () => batches.map(card));
}
