// Keys of the page, and the barcode scanner, which types like a person, but faster than one, and ends with Enter.

import {scanned} from "/capture.js";
import {byId, text} from "/document.js";
import {nextTheme} from "/frame.js";
import {go, inControl, jobRuns, post, say, stop} from "/station.js";
import {closeViewer} from "/viewer.js";

const kScanner_ms = 80;      // longest time between two characters of a scanner
const kShortestBarcode = 3;

let typed = "", waiting = 0;

function pressed(key) {
  if (key === "p" && jobRuns() && inControl()) post("/api/pause");
  if (key === "t") nextTheme();
  const link = document.querySelectorAll("#screens a")[Number(key) - 1];
  if (link) link.click();
}

function enter() {
  const first = byId("choices").firstChild;
  if (!byId("question").hidden && first) first.click();
}

// One character alone is a key; several in quick succession, ended by Enter, are a barcode and nothing else.
function quiet() {
  if (typed.length === 1) pressed(typed);
  typed = "";
}

function key(event) {
  const on = event.target.tagName;
  const writes = /^(SELECT|TEXTAREA)$/.test(on) || (on === "INPUT" && !/^(checkbox|range|color|radio)$/.test(event.target.type));
  if (event.key === "Escape") {
    event.preventDefault();
    if (closeViewer()) return;
    if (!writes) { stop(); return; }
    event.target.blur();
    say(text("escape_again"));
    return;
  }
  if (event.ctrlKey || event.altKey || event.metaKey || writes) return;
  if (event.key === "Enter") {
    clearTimeout(waiting);
    const barcode = typed;
    typed = "";
    if (barcode.length >= kShortestBarcode) {
      event.preventDefault();
      go("capture");
      scanned(barcode);
    } else if (!/^(BUTTON|A|SUMMARY)$/.test(on)) {
      enter();
    }
    return;
  }
  if (event.key.length !== 1) return;
  typed += typed ? event.key : event.key.toLowerCase();
  clearTimeout(waiting);
  waiting = setTimeout(quiet, kScanner_ms);
}

export function beginKeys() { addEventListener("keydown", key); }
