// Bench: the next instruction and its big button; what the camera sees, and how the bench stands.

import {allow, byId, draw, items, make, show, text, time} from "/document.js";
import {outcomeText} from "/frame.js";
import {beginLive, newFrame} from "/live.js";
import {said} from "/phrases.js";
import {ask, inControl, jobRuns, picture, post, startJob, state, whyNot} from "/station.js";
import {stepPicture, turnPicture} from "/step_picture.js";

let shownFrame = "", shownArrangement = "";

export function showJob() {
  const job = state.job;
  document.body.dataset.job = !job ? "none" : `${job.number} ${job.running ? "running" : "ended"}`;
  byId("job-title").textContent = !job ? text("idle") : `${text("kind_" + job.kind)} · ${job.title}: ${outcomeText(job)}`;
  byId("job-title").className = !job || job.running ? "" : job.outcome === "well" ? "well" : job.outcome === "badly" ? "badly" : "doubtfully";
  showSteps(job);
  showQuestion(job);
  const live = Boolean(job && job.kind === "preview");
  byId("progress").hidden = !(job && job.running && !job.question);
  byId("bar-of").hidden = live;  // nobody waits for its end
  const why = whyNot() || (live && job.running ? text("live_runs") : "");
  allow(byId("preview"), why);
  byId("log").hidden = !job;
  if (!job) return;
  byId("label").textContent = stageOf(job) + (job.total ? `${job.done} / ${job.total} ${said(job.label)}` : said(job.label) || text("begins"));
  if (job.total) byId("bar").value = job.done / job.total;
  else byId("bar").removeAttribute("value");
  byId("left").textContent = job.seconds_left === null ? "" : `${time(job.seconds_left)} ${text("left")}`;
  byId("pause").textContent = text(live ? "end_preview" : "pause");
  const lines = byId("lines"), end = lines.scrollTop + lines.clientHeight >= lines.scrollHeight - 4;
  lines.textContent = job.lines.map(line => said(line, false)).join("\n");
  if (end) lines.scrollTop = lines.scrollHeight;
  if (job.outcome === "badly") byId("log").open = true;
}

// A calibration counts twice: pictures, and what is read from them.
function stageOf(job) {
  const stage = {"photograph": "stage_photograph", "work out": "stage_work_out"}[job.task];
  return stage ? `${text(stage)}: ` : "";
}

// What follows what, of a job of several commands.
function showSteps(job) {
  const steps = job && job.steps.length > 1 ? job.steps : [];
  byId("steps").hidden = steps.length === 0;
  show(byId("steps"), steps, () => steps.map(step => make("li", {className: `step ${step.state}`},
    make("strong", {textContent: text(`step_${step.kind}`)}), ` ${text(step.state === "running" || step.state === "waiting" ? `step_is_${step.state}` : `ended_${step.state}`)}`)));
}

// A question is shown once: its buttons stay the same until it has been answered.
function showQuestion(job) {
  const shown = byId("question"), question = job && job.question;
  shown.hidden = !question;
  if (question) byId("remark").textContent = said(question.remark);  // changes with what the camera sees
  if (!question || shown.dataset.number === `${job.number} ${question.id}`) return;
  shown.dataset.number = `${job.number} ${question.id}`;
  byId("choices").replaceChildren(...question.choices.map((choice, i) => make("button", {
    type: "button", className: i === 0 ? "primary" : "", textContent: said(choice.label) + (i === 0 ? ` ${text("by_enter")}` : ""),
    onclick: () => answer(question, choice.answer)})));
  byId("step-count").textContent = question.step ? `${text("step")} ${question.step} / ${question.of}` : "";
  items(byId("instructions"), said(question.text).split("\n"));
  const typed = byId("typed-form");
  typed.hidden = !question.typed;
  byId("typed-label").textContent = `${text("typed")} ${said(question.typed)}`;
  typed.reset();
  typed.onsubmit = event => {
    event.preventDefault();
    answer(question, typed.typed.value);
  };
  showStep(question);
  if (!byId("bench").hidden) scrollTo(0, 0);  // to the buttons
}

// Where the handbook says more about what is asked.
function helpOn(question) {
  if (question.drawing !== undefined) return "rig.html";
  const wanted = question.arrangement;
  if (!wanted) return "troubleshooting.html";
  return wanted.object === "holder" || wanted.object === "cylinder" ? "first_spool.html" : `calibrate.html#${wanted.object}`;
}

function showStep(question) {
  byId("step-help").href = `/handbook/${helpOn(question)}`;
  byId("question").classList.toggle("turns", "turn_to_deg" in question);
  const wanted = JSON.stringify([question.arrangement, question.drawing, question.turn_to_deg]);
  if (wanted === shownArrangement) return;
  shownArrangement = wanted;
  const drawing = question.drawing ? [make("img", {src: `/handbook/drawings/${question.drawing}.svg`, alt: text("measure_drawing")})] : [];
  byId("step").replaceChildren(...("turn_to_deg" in question ? [turnPicture(question.turn_to_deg)]
                               : question.arrangement ? [stepPicture(question.arrangement)] : drawing));
}

function histogram(bins) {
  const most = Math.max(1e-6, ...["r", "g", "b"].flatMap(channel => bins[channel]));
  const curve = channel => "M0 100 " + bins[channel].map((part, i) => `L${i * 4 + 2} ${100 - 96 * Math.sqrt(part / most)}`).join(" ") + " L256 100 z";
  return draw("svg", {viewBox: "0 0 256 100", preserveAspectRatio: "none", role: "img", "aria-label": text("histogram")},
    ...["r", "g", "b"].map(channel => draw("path", {d: curve(channel), class: `channel ${channel}`})));
}

// Value between 0 and 1 with a mark where it should be.
function bar(label, value, aim, words) {
  const meter = draw("svg", {viewBox: "0 0 100 10", preserveAspectRatio: "none", role: "img", "aria-label": `${label}: ${words}`},
    draw("rect", {x: 0, y: 0, width: 100, height: 10, class: "empty"}),
    draw("rect", {x: 0, y: 0, width: 100 * Math.min(1, Math.max(0, value)), height: 10, class: "level"}),
    ...(aim === null ? [] : [draw("line", {x1: 100 * aim, x2: 100 * aim, y1: 0, y2: 10, class: "aim"})]));
  return make("div", {className: "meter"}, make("span", {textContent: label}), meter, make("strong", {textContent: words}));
}

function measures(frame) {
  const found = [];
  if (frame.exposure)
    found.push(bar(text("exposure"), frame.exposure.level, frame.exposure.aim,
                   `${(100 * frame.exposure.level).toFixed(0)} % · ${frame.exposure.exposure_s.toPrecision(2)} s · ${(100 * frame.exposure.saturated).toFixed(1)} % ${text("saturated")}`));
  found.push(frame.focus
    ? bar(text("focus"), 1 - frame.focus.blur_px / (frame.focus.bad_px * 1.5), 1 - frame.focus.doubtful_px / (frame.focus.bad_px * 1.5),
          `${frame.focus.blur_px.toFixed(2)} px · ${text(frame.focus.blur_px > frame.focus.bad_px ? "bad" : frame.focus.blur_px > frame.focus.doubtful_px ? "doubtful" : "good")}`)
    : make("div", {className: "meter"}, make("span", {textContent: text("focus")}), make("strong", {textContent: text("no_edge")})));
  found.push(make("div", {className: "meter"}, make("span", {textContent: text("tags")}),
    make("strong", {textContent: frame.tags.map(one => `${text("tags_" + one.where)} ${one.seen} / ${one.printed}`).join(" · ")})));
  if (frame.lamp && frame.lamp.length) {
    const values = frame.lamp.map(one => one.percent), last = values.at(-1);
    const low = Math.min(95, ...values), high = Math.max(105, ...values), y = value => 30 - 30 * (value - low) / (high - low);
    const line = draw("svg", {viewBox: "0 0 100 30", preserveAspectRatio: "none", role: "img", "aria-label": text("lamp_drift")},
      draw("line", {x1: 0, x2: 100, y1: y(100), y2: y(100), class: "aim"}),
      draw("polyline", {points: values.map((value, i) => `${values.length > 1 ? 100 * i / (values.length - 1) : 50},${y(value)}`).join(" "), class: "drift"}));
    found.push(make("div", {className: "meter"}, make("span", {textContent: text("lamp_drift")}), line,
                    make("strong", {textContent: `${last.toFixed(1)} %`})));
  }
  return found;
}

function devices(list) {
  return list.map(device => make("li", {className: device.passed === null ? "" : device.passed ? "well" : "badly"},
    make("strong", {textContent: `${said(device.device)}: ${text(device.passed === null ? "never_checked" : device.passed ? "sound" : "failed")}`}),
    ...device.rows.filter(one => !one.passed).map(one => make("p", {textContent: `${said(one.name)}: ${said(one.what)}`}))));
}

export async function showBench() {
  const bench = await ask("/api/bench");
  if (!bench) return;
  byId("devices").replaceChildren(...devices(bench.devices));
  byId("checked").textContent = bench.checked_ms === null ? "" : `${text("checked")} ${new Date(bench.checked_ms).toLocaleString()}`;
  const frame = bench.frame;
  byId("no-frame").hidden = frame !== null;
  byId("frame").hidden = frame === null;
  if (frame === null || `${frame.id} ${jobRuns()}` === shownFrame) return;
  shownFrame = `${frame.id} ${jobRuns()}`;
  byId("frame-source").textContent = `${frame.source || text(jobRuns() ? "live_view" : "live_view_ended")} · ${frame.width_px} × ${frame.height_px}`;
  byId("histogram").replaceChildren(histogram(frame.histogram));
  byId("measures").replaceChildren(...measures(frame));
  byId("frame-picture").src = picture({of: "frame", id: frame.id});
  await byId("frame-picture").decode().catch(() => {});  // the next picture waits for this one, or none would ever be seen
  newFrame();
}

// Answers the question that the person has read, not one that has come meanwhile.
const answer = (question, chosen) => post("/api/answer", {question: question.id, answer: chosen});

export function beginBench() {
  beginLive();
  byId("pause").onclick = () => post("/api/pause");
  byId("preview").onclick = () => startJob({kind: "preview"});
  byId("home").onclick = () => startJob({kind: "home"});
  byId("rig-form").onsubmit = event => {
    event.preventDefault();
    startJob({kind: "rig", name: event.target.name.value});
  };
  byId("check-form").onsubmit = event => {
    event.preventDefault();
    startJob({kind: "check", calibration: event.target.calibration.value});
  };
}
