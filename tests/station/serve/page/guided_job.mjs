// node guided_job.mjs PROGRAM DATA FOLDER [hand]
// The whole guided job through the technician's page, clicked as a person clicks it, with the real drivers on the simulated
// wires: check, live view, calibration, spool form, 17 views, development, fit, cloth, library, export; what a page must not do
// to somebody who scans, presses keys and looks away; German. FOLDER is made anew; its screenshots are for looking at.
// hand: the rig has no motor, and the person turns the platform; from check to the thread in the library.
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import path from "node:path";
import {disturb} from "./disturb.mjs";
import {startServer} from "./station_server.mjs";
import {WatchedPage} from "./watched_page.mjs";

const [program, data, folder, turned] = process.argv.slice(2);
const byHand = turned === "hand";
const workspace = path.join(folder, "bench");
const session = "4006381333948-B-3";
const inWorkspace = (...parts) => path.join(workspace, ...parts);

const began = Date.now();
const note = text => console.log(`${((Date.now() - began) / 1000).toFixed(1).padStart(6)} s  ${text}`);

// The documented rig with a person at it, drawn with few samples a pixel.
function writeRig() {
  const rig = JSON.parse(readFileSync(path.join(data, byHand ? "rigs/simulated.json" : "rigs/simulated_wire_grbl.json"), "utf8"));
  if (byHand) rig.turntable = "manual";
  rig.operator = "console";
  rig.simulation.samples_per_pixel = 2;
  rig.simulation.target_samples_per_pixel = 3;
  const file = path.join(folder, "rig.json");
  writeFileSync(file, JSON.stringify(rig));
  return file;
}

const pause = count => new Promise(resolve => setTimeout(resolve, 1000 * count));

let jobs = 0;

// Until the job on the bench has ended well; each question is answered by the big button. Returns how many there were.
async function attend(station, what, seconds, outcome = /ended well$/) {
  let questions = 0;
  const ended = `${++jobs} ended`;
  for (;;) {
    await station.until(`${what} to ask or end`, end => {
      const asks = !document.getElementById("question").hidden && !document.querySelector("#choices .primary").disabled;
      return asks || document.body.dataset.job === end;
    }, seconds, ended);
    if (await station.page.$eval("body", body => body.dataset.job) === ended) break;
    assert.ok(await station.page.$("#step svg"), "each step has its picture");
    assert.match(await station.page.title(), /^\? /, "the tab says that something is asked");
    if (questions === 0) await station.look(`question-${what}`);
    const number = await station.page.$eval("#question", question => question.dataset.number);
    await station.click("#choices .primary");
    questions++;
    await station.until("the answer to be taken", answered => {
      const question = document.getElementById("question");
      return question.hidden || question.dataset.number !== answered;
    }, 30, number);
  }
  assert.match(await station.text("#job-title"), outcome, await station.text("#lines"));
  assert.equal(await station.text("#said"), "", "what was said of the beginning does not stand beside the end");
  note(`${what}: ${questions} questions`);
  return questions;
}

// Who comes first is in control, and is told what the station needs.
async function check(station) {
  await station.until("control", () => document.getElementById("control").disabled, 10);
  assert.match(await station.text("#next"), /not been checked/);
  const bytes = await station.page.evaluate(() => performance.getEntriesByType("resource").reduce((sum, one) => sum + one.encodedBodySize, 0));
  assert.ok(bytes < 200e3, `${bytes} bytes until the first screen is there`);
  await station.look("start");
  await station.click('[data-screen="bench"]');
  await station.look("bench-idle");
  await station.click('[data-screen="overview"]');
  await station.click("#next-button");
  assert.equal(await attend(station, "check", 60) > 0, byHand);
  assert.equal((await station.page.$$("#devices .well")).length, 2, "turntable and camera are sound");
  await station.click("#preview");
  await station.until("a live picture", () => {
    const image = document.getElementById("frame-picture");
    return image.offsetParent !== null && image.complete && image.naturalWidth > 0;
  }, 30);
  await station.until("tags in it", () => /platform [1-9]/.test(document.getElementById("measures").textContent), 30);
  assert.equal(await station.page.$eval("#bar-of", bar => bar.hidden), true, "a live view has no end to wait for");
  for (const tool of ["grid", "focus", "clipping", "loupe"]) await station.click(`#live-${tool}`);
  assert.ok(await station.page.$eval("#frame-marks", canvas => !canvas.hidden && canvas.width > 0));
  await station.look("bench-live-view");
  for (const tool of ["grid", "focus", "clipping", "loupe"]) await station.click(`#live-${tool}`);
  await station.page.keyboard.press("P");  // with caps lock
  await attend(station, "preview", 30);
  await station.until("the last frame to be named so", () => /ended/.test(document.getElementById("frame-source").textContent), 10);
  await station.page.keyboard.press("T");
  await station.until("the other theme", () => document.body.dataset.theme !== "dark", 5);
  await station.setTheme("dark");
}

async function calibrate(station) {
  await station.click('[data-screen="calibrate"]');
  await station.look("calibrate");
  await station.type('#calibrate-form [name="name"]', "monday morning");
  await station.click("#calibrate-form .primary");
  assert.ok(await attend(station, "calibrate", 300) >= 3);
  await station.look("bench-calibrated");
  await station.click("#chips .chip:nth-child(2)");
  await station.until("the calibration's verdict", () => document.querySelector("#calibration-shown .verdict-line.good, #calibration-shown .verdict-line.usable"), 20);
  assert.ok((await station.page.$$("#calibration-shown .gates tbody tr")).length > 10, "each gate has its row");
  assert.ok((await station.page.$$("#calibration-shown .lamp-front")).length > 3, "the error budget is drawn");
  assert.equal(await station.page.evaluate(link => fetch(link).then(answer => answer.status),
                                           await station.page.$eval('#calibration-shown a[href^="/calibration"]', link => link.href)), 200);
  await station.look("calibrated");
}

// A scanner with no field focused fills in the form and answers nothing; Escape in a field leaves the field.
async function scannedAnywhere(station) {
  await station.click('[data-screen="library"]');
  await station.click("#search");
  await station.page.keyboard.press("Escape");
  await pause(1);
  assert.equal(await station.page.evaluate(() => fetch("/api/state").then(answer => answer.json()).then(state => state.job.running)), true);
  assert.match(await station.text("#said"), /again/);
  const asked = await station.page.$eval("#question", question => question.dataset.number);
  await station.click('[data-screen="bench"]');
  await station.page.evaluate(() => document.activeElement.blur());
  // All at once: a computer that is busy with other things would type as slowly as a person.
  await station.page.evaluate(() => {
    for (const key of [..."4006381333955", "Enter"]) document.body.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
  });
  await station.until("the scanned barcode", () => document.getElementById("spool-form").barcode.value === "4006381333955", 10);
  assert.match(await station.page.evaluate(() => location.hash), /capture/);
  await pause(1);
  assert.equal(await station.page.$eval("#question", question => question.dataset.number), asked, "its Enter answers no question");
  note("scanner and Escape in a field");
}

// Stopped by the key, at once, by a browser that only watches.
async function stopByKey(station) {
  await station.click('[data-screen="calibrate"]');
  await station.type('#calibrate-form [name="name"]', "stopped");
  await station.click("#calibrate-form .primary");
  await station.until("a question", () => !document.getElementById("question").hidden, 60);
  await scannedAnywhere(station);
  const watching = await station.another();
  await watching.until("the question", () => !document.getElementById("question").hidden, 30);
  assert.equal(await watching.page.$eval("#choices .primary", button => button.disabled), true, "who watches cannot answer");
  await watching.page.keyboard.press("Escape");
  await watching.until("the stop", () => /: stopped$/.test(document.getElementById("job-title").textContent), 10);
  await watching.closePage();
  jobs++;
  note("emergency stop by a watcher's key");
}

async function fillSpool(station) {
  await station.click('[data-screen="capture"]');
  await station.type('#spool-form [name="barcode"]', "4006381333948\n");  // a scanner ends with Enter
  assert.match(await station.text("#spool-said"), /new/);
  for (const [field, words] of Object.entries({name: "silk, blue", lot: "B 3", material: "silk", colour: "blue", turns: "0"}))
    await station.type(`#spool-form [name="${field}"]`, words);
  await station.page.select('#spool-form [name="simulated"]', "silk_blue");
  await station.page.$eval('#spool-form', form => { form.noValidate = true; });
  station.expected.push(/^400 for .*\/api\/spool$/, /status of 400/);
  await station.click("#spool-form > button");
  await station.until("the refusal of 0 turns", () => /turns/.test(document.getElementById("spool-said").textContent), 10);
  await station.type('#spool-form [name="turns"]', "50");
  station.expected.length = 0;
  await station.click("#spool-form > button");
  await station.until("the spool to be chosen", name =>
    document.getElementById("capture-form").spool.value === name, 10, session);
  await station.look("capture-form");
}

// Paused, gone on with after the page was closed, and one view taken again.
async function capture(station) {
  await fillSpool(station);
  assert.equal(await station.page.$eval("#capture-form", form => form.person.value), "", "nobody needs to say who captures");
  await station.click("#capture-form [name=whole]");
  await station.click("#capture-form .primary");
  await station.until("a question", () => !document.getElementById("question").hidden, 60);
  await station.click("#choices .primary");
  await station.until("a picture of this session", name =>
    document.getElementById("frame-source").textContent.startsWith(name), 60, session);
  await station.click("#pause");
  await attend(station, "pause", 60, /: paused$/);
  assert.match(await station.text("#lines"), /paused/);
  await station.click('[data-screen="session"]');
  await station.look("session-paused");
  for (const kind of ["develop", "invert", "report", "add"])
    assert.equal(await station.page.$eval(`[data-kind="${kind}"]`, button => button.disabled && button.title.length > 5), true, `${kind} says why not`);
  assert.match(await station.text("#session-why"), /views are missing/);
  await station.page.reload({waitUntil: "load"});
  await station.until("the same screen after a reload", () => document.body.dataset.job && !document.getElementById("session").hidden, 20);
  await station.click('[data-screen="overview"]');
  await station.until("the unfinished spool", () => /not finished/.test(document.getElementById("next").textContent), 10);
  await station.page.goBack();
  await station.until("the screen before", () => !document.getElementById("session").hidden, 10);
  await station.click('[data-kind="resume"]');
  await station.until("the run", () => document.body.dataset.job.endsWith("running"), 30);
  const later = await station.another();
  await station.closePage();
  await later.until("who comes to be told that a person is needed", () => /asks something/.test(document.getElementById("next").textContent), 60);
  await later.click("#next-button");
  await later.click("#control");
  await undisturbed(later);
  assert.ok(await attend(later, "capture", 300) >= 3);
  await later.look("bench-captured");
  await later.click('[data-screen="session"]');
  await verdicts(later);
  await later.click("#tiles .tile:nth-child(7) button");
  await attend(later, "reshoot", 120);
  await later.click('[data-screen="session"]');
  await verdicts(later);
  await later.look("session");
  return later;
}

// Every turn is a question.
async function captureByHand(station) {
  await fillSpool(station);
  await station.click("#capture-form [name=whole]");
  await station.click("#capture-form .primary");
  assert.ok(await attend(station, "capture", 300) >= 17);
  await station.click('[data-screen="session"]');
  await verdicts(station);
  return station;
}

// A thousand connections of no use while the run is under way: the page comes back by itself, the run has not noticed.
async function undisturbed(station) {
  station.expected.push(/net::ERR_/);
  const end = await disturb(station.address);
  end();
  const jobIsThere = () => fetch("/api/state").then(answer => answer.json()).then(state => state.job.running, () => false);
  for (let i = 0; i < 30 && !await station.page.evaluate(jobIsThere); i++) await pause(1);
  await pause(4);  // a dropped event stream is opened again by then
  station.expected.length = 0;
  assert.equal(await station.page.evaluate(jobIsThere), true);
}

async function verdicts(station) {
  await station.until("17 tiles with pictures and verdicts", () => {
    const tiles = [...document.querySelectorAll("#tiles .good, #tiles .doubtful")];
    for (const tile of tiles) tile.querySelector("img").loading = "eager";
    return tiles.length === 17 && tiles.every(tile => tile.querySelector("img").naturalWidth > 0);
  }, 60);
}

async function enlarge(station) {
  await station.click("#tiles .tile:nth-child(2) .picture");
  await station.until("the large picture", () => [...document.querySelectorAll("#viewer-pictures img")].every(image => image.naturalWidth > 0), 30);
  await station.look("session-view");
  await station.page.keyboard.press("Escape");
  await station.until("the viewer to close", () => document.getElementById("viewer").hidden, 5);
}

// All that is left of a spool by one button, and what is older than its sources is said to be.
async function fit(station) {
  await station.click('[data-screen="session"]');
  await enlarge(station);
  await station.click("#quick");
  await station.click('[data-kind="process"]');
  await station.until("its steps", () => document.querySelectorAll("#steps .step").length === 4, 20);
  await station.look("bench-steps");
  await attend(station, "process", 300);
  assert.equal((await station.page.$$("#steps .well")).length, 4);
  await station.click('[data-screen="session"]');
  await station.until("nothing to be left", () => document.querySelector('[data-kind="process"]').disabled, 10);
  await station.click('[data-kind="report"]');
  await attend(station, "report", 60);
  await station.click('[data-screen="result"]');
  await station.until("both pictures of a view", () => ["photographed", "fitted"].every(id =>
    document.getElementById(id).complete && document.getElementById(id).naturalWidth > 0), 30);
  assert.equal((await station.page.$$("#curves .band")).length, 3);
  assert.equal((await station.page.$$("#unknowns tr")).length, 16);
  assert.match(await station.text("#fit-verdict"), /fit · /);
  assert.match(await station.text("#colour-words"), /^#[0-9a-f]{6} · Lab /);
  await station.page.focus("#wipe");
  for (let i = 0; i < 20; i++) await station.page.keyboard.press("ArrowRight");
  assert.equal(await station.page.$eval("#fitted", image => image.style.clipPath), "inset(0px 0px 0px 70%)");
  await station.look("result");
  await station.page.select("#compare-with", "residual");
  await station.until("the residual", () => document.getElementById("fitted").src.includes("residual") &&
    document.getElementById("fitted").complete, 30);
  await station.look("result-residual");
}

async function weave(station) {
  await station.page.select('#cloth-form [name="draft"]', "satin_5");
  assert.equal(await station.page.$eval("#chosen-colours", pickers => pickers.hidden), true, "no picker that is ignored");
  await station.page.select('#cloth-form [name="own"]', "chosen");
  await station.click('#cloth-form [name="quick"]');
  await station.click("#cloth-form .primary");
  await attend(station, "cloth", 200);
  await station.click('[data-screen="result"]');
  await station.until("swatch and cylinder", () => {
    const pictures = [...document.querySelectorAll("#cloth-pictures img")];
    return pictures.length === 2 && pictures.every(image => image.naturalWidth > 0);
  }, 30);
  assert.match(await station.text("#cloth-made-of"), /satin 5.*#1d3f8f.*#c9a227/);
  await station.page.$eval("#cloth-form", form => form.scrollIntoView());
  await station.look("result-cloth");
}

// Edited, taken out, put back.
async function editing(station) {
  await station.click('[aria-label="Edit 2"]');
  await station.type('.edit [name="lot"]', "C 4");
  await station.type('.edit [name="tags"]', "summer, sari");
  await station.click(".edit button");
  await station.until("the new lot", () => /C 4/.test(document.getElementById("threads").textContent), 10);
  await station.click('[aria-label="Search sari"]');
  await station.until("the tagged thread alone", () => document.getElementById("found").textContent === "1 / 2", 10);
  await station.type("#search", " ");
  await station.click('[aria-label="Take out 2"]');
  await station.until("the thread to be out", () => !/C 4/.test(document.getElementById("threads").textContent), 10);
  await station.click("#undo-button");
  await station.until("the thread to be back", () => /C 4/.test(document.getElementById("threads").textContent), 10);
}

// The cloth before it is woven, turned by the mouse, the lamp by a key.
async function seenAtOnce(station) {
  const look = () => station.page.$eval("#look-picture", image => image.dataset.look);
  const another = before => station.until("another look", one => document.getElementById("look-picture").dataset.look !== one, 20, before);
  await station.page.select('#design-form [name="shape"]', "cylinder");
  await station.until("the cloth", () => document.getElementById("look-picture").naturalWidth > 0, 20);
  await station.page.$eval("#look-picture", image => image.scrollIntoView());
  let before = await look();
  const {x, y} = await (await station.page.$("#look-picture")).boundingBox();
  await station.page.mouse.move(x + 100, y + 100);
  await station.page.mouse.down();
  await station.page.mouse.move(x + 180, y + 130, {steps: 4});
  await station.page.mouse.up();
  await another(before);
  before = await look();
  await station.page.focus('#look-sliders [name="light_turn_deg"]');
  await station.page.keyboard.press("ArrowRight");
  await another(before);
  await station.until("a finer picture", () => !/Coarse/.test(document.getElementById("look-state").textContent), 240);
}

// Of a thread of the library, in a folder that is downloaded as one.
async function design(station) {
  await station.click('[data-screen="library"]');
  await station.click('[aria-label="Weave 2"]');
  await station.until("the thread that was chosen", () => document.querySelector('#design-form [name="weft"]').value === "2", 10);
  await station.page.select('#design-form [name="draft"]', "plain");
  await seenAtOnce(station);
  await station.type('#design-form [name="name"]', "Kissen, groß");
  await station.click('#design-form [name="quick"]');
  await station.click("#design-form .primary");
  await attend(station, "design", 200);
  await station.click('[data-screen="design"]');
  await station.page.$eval("#designs", designs => designs.scrollIntoView());  // pictures are fetched when they are seen
  await station.until("its pictures", () => {
    const pictures = [...document.querySelectorAll("#designs img")];
    return pictures.length === 1 && pictures.every(image => image.naturalWidth > 0);
  }, 30);
  assert.match(await station.text("#designs h3"), /^Kissen-gro/);
  const made = JSON.parse(readFileSync(inWorkspace("designs", await station.text("#designs h3"), "made_of.json"), "utf8"));
  assert.ok(Math.abs(made.views.cylinder.turn_deg) > 10, "it is woven as it was seen");
  await station.page.evaluate(() => scrollTo(0, 0));
  await station.look("design");
}

// Every screen in the other language, without a word of the first one's keys left.
async function german(station) {
  await station.click("#language");
  await station.until("German", () => document.documentElement.lang === "de" && document.body.dataset.job, 20);
  for (const screen of ["overview", "bench", "calibrate", "capture", "session", "result", "library", "design"]) {
    await station.click(`[data-screen="${screen}"]`);
    await pause(1);
    await station.look(`de-${screen}`);
    const keys = await station.page.evaluate(() => fetch("/texts.en.json").then(answer => answer.json()).then(texts =>
      (document.body.innerText.match(/[a-z]+(_[a-z]+)+/g) || []).filter(word => word in texts)));
    assert.deepEqual(keys, [], screen);
  }
  await station.click("#language");
  await station.until("English", () => document.documentElement.lang === "en" && document.body.dataset.job, 20);
}

// Somebody who reads German and only watches.
async function germanWatcher(station) {
  const watching = await station.another();
  watching.expected.push(/net::ERR_/);
  await watching.page.evaluate(() => { localStorage.language = "de"; });
  await watching.page.reload({waitUntil: "load"});
  await watching.until("German", () => document.documentElement.lang === "de" && document.body.dataset.job, 20);
  await watching.page.evaluate(() => { localStorage.language = "en"; });
  await watching.click('[data-screen="bench"]');
  await station.page.bringToFront();
  return watching;
}

// Nothing that the program has said during the whole job was left in English.
async function nothingUntold(watching) {
  await watching.page.bringToFront();
  for (const screen of ["calibrate", "session", "result", "library", "bench"]) {
    await watching.click(`[data-screen="${screen}"]`);
    await pause(1);
  }
  await watching.look("de-watched");
  assert.deepEqual(await watching.page.evaluate(() => import("/phrases.js").then(({untold}) => [...untold])), []);
  await watching.closePage();
}

// A stop that does not reach the station is said so that nobody can miss it.
async function stopWithoutServer(station) {
  station.expected.push(/./);
  server.stop();
  await pause(1);
  await station.page.evaluate(() => document.activeElement.blur());
  await station.page.keyboard.press("Escape");
  await station.until("the alarm", () => !document.getElementById("not-stopped").hidden, 10);
  await station.page.screenshot({path: path.join(station.folder, "not-stopped.png")});
}

async function library(station) {
  await station.click('[data-screen="library"]');
  await station.type("#search", "b 3 silk");
  await station.until("one thread", () => document.getElementById("found").textContent === "1 / 2", 10);
  await station.click('[data-export="2"]');
  await attend(station, "export", 30);
  await station.click('[data-screen="library"]');
  await station.until("the download", () => document.querySelector("a[download]"), 10);
  const packed = await station.page.evaluate(link => fetch(link).then(answer => answer.arrayBuffer()).then(bytes => [...new Uint8Array(bytes)]),
                                             await station.page.$eval("a[download]", link => link.href));
  writeFileSync(path.join(folder, "export.zip"), Buffer.from(packed));
  assert.match(execFileSync("python3", ["-m", "zipfile", "-l", path.join(folder, "export.zip")]).toString(), /thread-2-folder\/thread\.json/);
  await editing(station);
  await station.page.select("#export-format", "materials");
  await station.click('[data-export="2"]');
  await attend(station, "export", 300);
  await station.click('[data-screen="library"]');
  await station.type("#search", " ");
  for (const number of [1, 2]) await station.click(`[aria-label="Compare ${number}"]`);
  await station.until("two threads side by side", () => document.querySelectorAll("#compared .thread").length === 2, 10);
  await station.look("library");
}

mkdirSync(folder, {recursive: true});
rmSync(folder, {recursive: true});
mkdirSync(inWorkspace("queues"), {recursive: true});
execFileSync(program, ["library", "add", path.join(data, "threads/silk_red.json"), "--library", inWorkspace("library")]);
writeFileSync(inWorkspace("queues/week.csv"), "barcode,name,lot,material,colour,note,spool\n" +
  `4006381333931,"silk, red",A 12,silk,red,,${path.join(data, "spools/silk_red.json")}\n`);
const server = await startServer(program, writeRig(), workspace);
let station = await WatchedPage.open(server.address, path.join(folder, "browser"));
try {
  const watching = await germanWatcher(station);
  await check(station);
  await calibrate(station);
  if (byHand) {
    station = await captureByHand(station);
    await fit(station);
    await nothingUntold(watching);
  } else {
    await stopByKey(station);
    station = await capture(station);
    await fit(station);
    await weave(station);
    await library(station);
    await design(station);
    await german(station);
    await nothingUntold(watching);
    await stopWithoutServer(station);
  }
} catch (error) {
  console.log(await station.report());
  throw error;
} finally {
  await station.close();
  server.stop();
}
const exported = ["exports/thread-2-folder/thread.json", "exports/thread-2-folder/manifest.json", "exports/thread-2-materials/export.json"];
for (const file of [`sessions/${session}/report.html`, ...(byHand ? [] : exported)])
  assert.ok(existsSync(inWorkspace(file)), file);
assert.match(execFileSync(program, ["verify", inWorkspace("sessions", session)]).toString(), /17/);
note(`${station.shared.pictures} screenshots in ${station.folder}`);
assert.deepEqual(station.shared.problems, []);
note("no console error, no failed request, no accessibility violation");
