// node soak.mjs PROGRAM DATA FOLDER [CLICKS [SEED]]
// Two people at two browsers who click, choose and press keys at random, by a seed that is printed. Nothing that a person can do
// on the page may end in a script error or an answer that says that the station itself failed; and whenever all is quiet, both
// pages must show what the station knows. FOLDER is made anew.
import assert from "node:assert/strict";
import {mkdirSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import path from "node:path";
import {startServer} from "./station_server.mjs";
import {WatchedPage} from "./watched_page.mjs";

const [program, data, folder, clicks = "400", seed = "20261128"] = process.argv.slice(2);
const kBetweenLooks = 50;  // clicks

// Mulberry32: small, and the same everywhere.
function numbers(start) {
  let at = start >>> 0;
  return () => {
    at = (at + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(at ^ (at >>> 15), at | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

const random = numbers(Number(seed));
const words = ["week 3", "Müller", "4006381333948", "../../etc", "", "0", "seide, blau", "monday"];
const some = list => list[Math.floor(random() * list.length)];
const pause = ms => new Promise(resolve => setTimeout(resolve, ms));

// The page's own elements that a person could use now; nothing that leads away from it.
function act(choice, word) {
  const usable = [...document.querySelectorAll("button, a[href^='#'], select, input:not([type=file]), summary")].filter(element => !element.disabled &&
    element.offsetParent !== null && element.id !== "language" && element.id !== "live-full");
  const element = usable[Math.floor(choice * usable.length)];
  if (!element) return "nothing";
  const name = element.id || element.name || element.textContent.slice(0, 30);
  if (element.tagName === "SELECT") element.selectedIndex = Math.floor(choice * 7919) % Math.max(1, element.options.length);
  else if (element.type === "number") element.value = String(Math.floor(100 * choice));
  else if (element.tagName === "INPUT" && !/checkbox|range|color/.test(element.type)) element.value = word;
  else element.click();
  element.dispatchEvent(new Event("input", {bubbles: true}));
  element.dispatchEvent(new Event("change", {bubbles: true}));
  return name;
}

// What the page shows of the station's state, and what that is.
function shown() {
  return fetch("/api/state").then(answer => answer.json()).then(state => {
    const job = state.job, title = document.getElementById("job-title").textContent;
    const outcomes = {well: "ended well", badly: "ended with a problem", paused: "paused", stopped: "stopped"};
    return {
      job: [document.body.dataset.job, job ? `${job.number} ${job.running ? "running" : "ended"}` : "none"],
      end: [job ? title.endsWith(job.running ? "running" : outcomes[job.outcome]) : true, true],
      question: [document.getElementById("question").hidden, !(job && job.question)],
      sessions: [document.getElementById("session-choice").options.length, state.sessions.length],
      control: [document.getElementById("control").disabled, state.control === sessionStorage.client],
      rig: [document.getElementById("rig").textContent, state.rig],
    };
  });
}

async function agreed(stations) {
  let lies = [];
  for (let i = 0; i < 40; i++) {  // a change is on its way
    lies = [];
    for (const [which, station] of stations.entries())
      for (const [what, [page, truth]] of Object.entries(await station.page.evaluate(shown)))
        if (page !== truth) lies.push(`page ${which}: ${what} is ${truth} and ${page} is shown`);
    if (lies.length === 0) return;
    await pause(250);
  }
  assert.deepEqual(lies, []);
}

rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
const rig = JSON.parse(readFileSync(path.join(data, "rigs/simulated.json"), "utf8"));
rig.operator = "console";
rig.simulation.samples_per_pixel = rig.simulation.target_samples_per_pixel = 1;
writeFileSync(path.join(folder, "rig.json"), JSON.stringify(rig));
console.log(`${clicks} clicks, seed ${seed}`);
const server = await startServer(program, path.join(folder, "rig.json"), path.join(folder, "bench"));
const first = await WatchedPage.open(server.address, path.join(folder, "browser"));
try {
  const stations = [first, await first.another()];
  // What the station refuses (names, a job over a running one, what another browser controls) is an answer, not a fault.
  for (const station of stations) station.expected.push(/^(400|404|409) for/, /status of (400|404|409)/);
  const done = new Map();
  for (let i = 0; i < Number(clicks); i++) {
    const station = some(stations), choice = random(), word = some(words);
    const key = random() < 0.1 ? some(["p", "t", "1", "2", "3", "4", "5", "6", "7", "Enter", "Escape"]) : null;
    if (key) await station.page.keyboard.press(key);
    const name = key || await station.page.evaluate(act, choice, word);
    done.set(name, (done.get(name) || 0) + 1);
    await pause(30 * random());
    if (i % kBetweenLooks === kBetweenLooks - 1) await agreed(stations);
    assert.deepEqual(first.shared.problems, [], `after ${i + 1} clicks, the last on ${name}`);
  }
  await agreed(stations);
  console.log(`${done.size} different things were done; no error, and nothing shown that is not so`);
} finally {
  await first.close();
  server.stop();
}
