// The technician's page: its screens, and which of them is shown (#/screen/name, so that reload and back lead there).

import {beginBench, showBench, showJob} from "/bench.js";
import {beginCalibrations, chooseCalibration, showCalibrations} from "/calibration.js";
import {beginForms, showForms} from "/capture.js";
import {beginDesign, chooseThread, showDesign} from "/design.js";
import {byId, readTexts, text} from "/document.js";
import {beginFrame, showFrame} from "/frame.js";
import {beginKeys} from "/keys.js";
import {beginLibrary, showLibrary} from "/library.js";
import {showOverview} from "/overview.js";
import {beginResult, showResult} from "/result.js";
import {beginSession, chooseSession, session, showSession, showSessionChoice} from "/session.js";
import {follow, oneAtATime, post, state} from "/station.js";

const shows = {overview: showOverview, bench: showBench, calibrate: showCalibrations, capture: () => null, session: showSession, result: showResult,
               library: showLibrary, design: showDesign};

let screen = "";

const showScreen = oneAtATime(() => state && shows[screen] ? shows[screen]() : null);

// What the address says.
function route() {
  const [name, ...of] = location.hash.replace(/^#\//, "").split("/").map(decodeURIComponent);
  const wanted = shows[name] ? name : "overview";
  if (of[0] && (wanted === "session" || wanted === "result")) chooseSession(of[0]);
  if (of[0] && wanted === "calibrate") chooseCalibration(of[0]);
  if (of[0] && wanted === "design") chooseThread(of[0]);
  if (wanted !== screen) {
    screen = wanted;
    for (const section of document.querySelectorAll("main > section")) section.hidden = section.id !== screen;
    for (const link of document.querySelectorAll("#screens a")) {
      if (link.dataset.screen === screen) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    scrollTo(0, 0);
  }
  showScreen();
}

function render() {
  showSessionChoice();
  showJob();
  showFrame();
  showForms();
  showScreen();
}

async function begin() {
  await readTexts();
  for (const list of ["session-choice", "result-choice"])
    byId(list).onchange = event => { location.hash = `#/${screen}/${encodeURIComponent(event.target.value)}`; };
  beginFrame();
  beginKeys();
  beginBench();
  beginCalibrations();
  beginForms();
  beginSession();
  beginResult();
  beginLibrary();
  beginDesign();
  addEventListener("hashchange", route);
  route();
  await follow(render);
  // Whoever comes first is in control without asking for it.
  if (state && !state.control) await post("/api/control", {}, false);
}

begin();
