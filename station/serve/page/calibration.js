// Calibrate: the form; the calibrations of this bench with a verdict; one of them in full: gates, error budget, report.

import {ago, byId, draw, make, percent, row, show, text} from "/document.js";
import {said} from "/phrases.js";
import {ask, startJob, state} from "/station.js";

const kNear = 0.9;  // of a limit: usable, but look at it

let chosen = "";

const old = line => Date.now() - Date.parse(line.utc) > state.calibration_valid_days * 86400000;

const solved = () => state.calibrations.filter(one => one.utc);

// The newest that is solved, with "old"; null without any.
export function newestCalibration() {
  const newest = solved().sort((a, b) => a.utc < b.utc ? -1 : 1).at(-1);
  return newest ? {...newest, old: old(newest)} : null;
}

const near = gate => gate.value === null || (gate.at_least ? gate.limit > kNear * gate.value : gate.value > kNear * gate.limit);

// "good", "usable" (old, or a gate near its limit) or "not".
export function calibrationVerdict(line) {
  if (line.problem || !line.utc || line.gates.some(gate => !gate.passed)) return "not";
  return old(line) || line.gates.some(near) ? "usable" : "good";
}

// In one sentence: why it is not better.
function reasons(line) {
  if (line.problem) return [said(line.problem)];
  if (!line.utc) return [text("calibration_unsolved")];
  const found = line.gates.filter(gate => !gate.passed).map(gate => `${said(gate.name)}: ${said(gate.reason)}`);
  if (found.length) return found;
  if (old(line)) found.push(text("calibration_old", {days: state.calibration_valid_days}));
  return [...found, ...line.gates.filter(near).map(gate => text("gate_near", {gate: said(gate.name)}))];
}

const number = value => value === null ? text("no_number") : Number(value.toPrecision(3)).toString();

// How much of its limit a gate has used, as a bar.
function gateBar(gate) {
  const used = gate.value === null ? 1 : gate.at_least ? (gate.value > 0 ? gate.limit / gate.value : 1.5) : gate.limit > 0 ? gate.value / gate.limit : gate.value > 0 ? 1.5 : 0;
  return draw("svg", {viewBox: "0 0 150 10", preserveAspectRatio: "none", "aria-hidden": "true", class: "gate-bar"},
    draw("rect", {x: 0, y: 0, width: Math.min(150, Math.max(0, 100 * used)), height: 10, class: gate.passed ? "level" : "over"}),
    draw("line", {x1: 100, x2: 100, y1: 0, y2: 10, class: "aim"}));
}

function gates(calibration) {
  return calibration.gates.map(gate => row(
    make("span", {className: gate.passed ? "well" : "badly", textContent: text(gate.passed ? "passed" : "not_passed")}), said(gate.name), number(gate.value),
    `${text(gate.at_least ? "at_least" : "at_most")} ${number(gate.limit)}`, gateBar(gate), said(gate.reason)));
}

// The sources of the error of a radiance, for both lamps; the whole is the root of the sum of squares.
function budget(sources) {
  const most = Math.max(...sources.flatMap(one => [one.front, one.behind]), 1e-6), high = 34;
  const bars = sources.flatMap((one, i) => [
    draw("text", {x: 0, y: i * high + 21}, said(one.source)),
    draw("rect", {x: 430, y: i * high + 4, width: Math.max(1, 260 * one.front / most), height: 11, class: "lamp-front"}),
    draw("rect", {x: 430, y: i * high + 17, width: Math.max(1, 260 * one.behind / most), height: 11, class: "lamp-behind"}),
    draw("text", {x: 700, y: i * high + 21}, `${percent(one.front, 2)} · ${percent(one.behind, 2)}`)]);
  return draw("svg", {viewBox: `0 0 860 ${sources.length * high + 4}`, role: "img", class: "plot",
                      "aria-label": text("budget_in_words", {list: sources.map(one => `${said(one.source)} ${percent(one.front, 2)}, ${percent(one.behind, 2)}`).join("; ")})}, ...bars);
}

// The whole error of each calibration over time: whether the bench gets worse.
function trend() {
  const of = solved().filter(one => one.error_front !== undefined).sort((a, b) => a.utc < b.utc ? -1 : 1);
  if (of.length < 2) return [];
  const most = 1.15 * Math.max(...of.flatMap(one => [one.error_front, one.error_behind]));
  const x = i => 60 + 620 * i / (of.length - 1), y = value => 150 - 130 * value / most;
  const line = (key, name) => draw("polyline", {points: of.map((one, i) => `${x(i)},${y(one[key])}`).join(" "), class: `curve ${name}`});
  return [make("h3", {textContent: text("trend")}),
    draw("svg", {viewBox: "0 0 760 190", role: "img", "aria-label": text("trend"), class: "plot"},
      draw("line", {x1: 55, x2: 690, y1: 150, y2: 150, class: "grid"}), draw("text", {x: 0, y: 28}, percent(most / 1.15, 2)), draw("text", {x: 20, y: 154}, "0"),
      line("error_front", "lobe0"), line("error_behind", "lobe2"),
      ...of.map((one, i) => draw("text", {x: x(i), y: 175, "text-anchor": "middle", class: "small"}, one.utc.slice(5, 10))))];
}

const legend = () => make("p", {className: "dim"}, make("span", {className: "key lamp-front-key"}), ` ${text("lamp_in_front")}  `,
                          make("span", {className: "key lamp-behind-key"}), ` ${text("lamp_behind")}`);

async function showChosen() {
  const line = state.calibrations.find(one => one.name === chosen), shown = byId("calibration-shown");
  shown.hidden = !line || !line.utc;
  if (shown.hidden) return;
  const calibration = await ask("/api/calibration", {name: chosen});
  if (!calibration) return;
  show(shown, [calibration, solved().length], () => {
    const verdict = calibrationVerdict(calibration);
    const found = reasons(calibration);
    return [
      make("h3", {textContent: calibration.name}),
      make("p", {className: `verdict-line ${verdict}`}, make("strong", {textContent: text(`calibration_${verdict}`)}),
           ` · ${ago(calibration.utc)} · ${calibration.rig} · ${calibration.camera}`),
      ...found.map(words => make("p", {textContent: words})),
      ...(calibration.report ? [make("p", {}, make("a", {href: "/calibration?" + new URLSearchParams({name: chosen}), target: "_blank", rel: "noopener",
                                                         textContent: text("open_calibration")}))] : []),
      make("h4", {textContent: text("budget")}), make("p", {className: "dim", textContent: text("budget_means")}), legend(), budget(calibration.budget),
      ...trend(),
      make("h4", {textContent: text("gates")}),
      make("div", {className: "wide", tabIndex: 0}, make("table", {className: "gates"},
        make("thead", {}, make("tr", {}, ...["verdict", "what", "value", "limit", "of_limit", "why"].map(key => make("th", {scope: "col", textContent: text(key)})))),
        make("tbody", {}, ...gates(calibration)))),
    ];
  });
}

function listed(line) {
  const verdict = calibrationVerdict(line);
  const link = make("a", {href: `#/calibrate/${encodeURIComponent(line.name)}`, className: `card wide-card ${verdict}`},
    make("strong", {textContent: line.name}), make("span", {textContent: `${text("calibration_" + verdict)}${line.utc ? ` · ${ago(line.utc)}` : ""}`}),
    make("span", {className: "dim", textContent: reasons(line)[0] || text("all_gates_passed")}));
  if (line.name === chosen) link.setAttribute("aria-current", "true");
  return link;
}

export function chooseCalibration(name) { chosen = name; }

export function showCalibrations() {
  if (!state.calibrations.some(one => one.name === chosen)) chosen = (newestCalibration() || {name: ""}).name;
  show(byId("calibrations"), [state.calibrations, chosen], () => state.calibrations.map(listed).reverse());
  byId("no-calibrations").hidden = state.calibrations.length > 0;
  return showChosen();
}

export function beginCalibrations() {
  const form = byId("calibrate-form");
  form.onsubmit = event => {
    event.preventDefault();
    startJob({kind: "calibrate", name: form.elements.name.value});
  };
  form.elements.name.value = new Date().toISOString().slice(0, 10);
}
