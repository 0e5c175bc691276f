// Start: what the station needs next, in one sentence with one button; what waits; what came out last.

import {showBatches} from "/batches.js";
import {calibrationVerdict, newestCalibration} from "/calibration.js";
import {ago, allow, byId, make, percent, show, text} from "/document.js";
import {go, jobRuns, picture, startJob, state, whyNot} from "/station.js";

const unfinished = () => state.sessions.filter(line => !line.problem && line.state !== "running" && line.left.includes("capture"));
const unprocessed = () => state.sessions.filter(line => !line.problem && line.state === "complete" && line.left.length > 0);

// {words, button, act}
function next() {
  const job = state.job, newest = newestCalibration(), paused = unfinished().at(-1), waiting = unprocessed();
  if (jobRuns() && job.question) return {words: text("next_asks", {job: text(`kind_${job.kind}`)}), button: text("to_bench"), act: () => go("bench"), always: true};
  if (jobRuns()) return {words: text("next_runs", {job: text(`kind_${job.kind}`)}), button: text("to_bench"), act: () => go("bench"), always: true};
  if (state.devices.passed === null) return {words: text("next_check"), button: text("check"), act: () => startJob({kind: "check", calibration: ""})};
  if (!state.devices.passed) return {words: text("next_devices"), button: text("to_bench"), act: () => go("bench"), always: true};
  if (!newest) return {words: text("next_calibrate"), button: text("to_calibrate"), act: () => go("calibrate"), always: true};
  if (calibrationVerdict(newest) === "not")
    return {words: text("next_not_calibrated", {name: newest.name}), button: text("to_calibrate"), act: () => go("calibrate", newest.name), always: true};
  if (paused) return {words: text("next_resume", {name: paused.name, taken: paused.taken, views: paused.views}), button: text("resume"),
                      act: () => startJob({kind: "process", name: paused.name})};
  if (waiting.length)
    return {words: text(waiting.length === 1 ? "next_process_one" : "next_process", {n: waiting.length, name: waiting[0].name}),
            button: text("process"), act: () => startJob({kind: "process", name: waiting[0].name})};
  if (calibrationVerdict(newest) === "usable" && newest.old)
    return {words: text("next_recalibrate", {age: ago(newest.utc)}), button: text("to_calibrate"), act: () => go("calibrate"), always: true};
  return {words: text("next_capture"), button: text("to_capture"), act: () => go("capture"), always: true};
}

function waitingLine(line) {
  const button = make("button", {type: "button", textContent: text("process")});
  button.setAttribute("aria-label", `${text("process")} ${line.name}`);
  button.onclick = () => startJob({kind: "process", name: line.name});
  allow(button, whyNot());
  return make("li", {}, make("a", {href: `#/session/${encodeURIComponent(line.name)}`, textContent: line.name}),
              ` · ${line.spool} · ${line.taken} / ${line.views} ${text("taken")} · ${text("lacks")} ${line.left.map(one => text(`step_${one}`)).join(", ")} `, button);
}

// How a thread of the library looks, where there is a picture of it.
export function threadPicture(thread) {
  if (!thread.pictured) return [];
  const image = make("img", {src: picture({of: "thread", number: thread.number, added: thread.added_utc}), alt: text("picture_of", {name: thread.name}), loading: "lazy"});
  image.onerror = () => image.remove();
  return [image];
}

export function showOverview() {
  const wanted = next(), button = byId("next-button"), why = wanted.always ? "" : whyNot();
  byId("next").textContent = wanted.words;
  button.textContent = wanted.button;
  button.onclick = wanted.act;
  allow(button, why);
  byId("next-why").textContent = why;
  const waiting = [...unfinished(), ...unprocessed()];
  show(byId("waiting"), [waiting, whyNot()], () => waiting.map(waitingLine));
  byId("nothing-waits").hidden = waiting.length > 0;
  const last = state.threads.slice(-6).reverse();
  show(byId("last-threads"), last, () => last.map(thread => make("a", {className: "card", href: "#/library"}, ...threadPicture(thread),
    make("strong", {textContent: thread.name}), make("span", {className: "dim", textContent: [thread.sample.lot, percent(thread.relative_rmse)].filter(Boolean).join(" · ")}))));
  byId("no-threads").hidden = last.length > 0;
  return showBatches();
}
