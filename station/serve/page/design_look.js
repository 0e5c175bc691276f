// The cloth that is designed, as the station renders it: better and better while one looks, its view and light turned by hand.

import {byId, make, text} from "/document.js";
import {tellClipping} from "/exposure.js";
import {said} from "/phrases.js";
import {ask, inControl, oneAtATime, picture, post, say} from "/station.js";

const kRest = {turn_deg: 0, tilt_deg: 0, light_turn_deg: 0, light_tilt_deg: 0, zoom: 1};
const kSoon_ms = 150, kLater_ms = 1000;  // until the station is asked again: while a picture is being made, else
const kDegreesPerPixel = 0.4, kMostZoom = 20, kLeastZoom = 0.25;

let view = {...kRest};
let cloth = null;     // that is looked at: {number, weft, draft, shape, fibers}
let shape = "";       // that was looked at last, also before the page was left
let begun = false;    // a look that this page has to end
let asked = 0;        // the number of the last look that was asked for
let polling = false;

export const viewWanted = () => view;

const isSeen = () => !byId("design").hidden && !document.hidden;

const send = oneAtATime(async () => {
  if (!cloth || !inControl()) return;
  const answer = await post("/api/look", {...cloth, ...view}, false);
  if (!answer.ok) { say(said(answer.message || "")); return; }
  begun = true;
  asked = answer.look;
  poll();
});

async function poll() {
  if (polling) return;
  polling = true;
  while (begun && isSeen()) {
    const found = await ask("/api/look");
    if (found) show(found);
    const done = !found || !found.running || (found.shown && found.shown.look >= asked && found.shown.samples >= found.shown.of);
    await new Promise(wake => setTimeout(wake, done ? kLater_ms : kSoon_ms));
  }
  polling = false;
  if (!begun) return;
  begun = false;
  cloth = null;
  if (inControl()) post("/api/look", {ended: true}, false);
}

function show({running, shown, of, problem, label}) {
  const image = byId("look-picture"), words = byId("look-state");
  const made = shown ? `${of}-${shown.picture}` : "";
  image.hidden = !shown && !image.naturalWidth;
  if (made && image.dataset.made !== made) {
    image.dataset.made = made;
    image.dataset.look = shown.look;
    image.src = picture({of: "look", made});
  }
  words.textContent = problem ? said(problem) : shown ? text(shown.samples ? "look_samples" : "look_coarse", shown) : running ? said(label) || text("look_begins") : "";
}

// Looks at this cloth from now on, from where one looked at the last one of this shape.
export function lookAt(wanted) {
  if (!inControl() || (cloth && JSON.stringify(cloth) === JSON.stringify(wanted))) return;
  if (shape !== wanted.shape) turnTo(kRest, false);
  shape = wanted.shape;
  cloth = wanted;
  send();
}

const wrapped = angle => angle - 360 * Math.round(angle / 360);
const within = (value, least, most) => Math.min(most, Math.max(least, value));

function turnTo(wanted, told = true) {
  view = {turn_deg: wrapped(wanted.turn_deg), tilt_deg: within(wanted.tilt_deg, -90, 90), light_turn_deg: wrapped(wanted.light_turn_deg),
          light_tilt_deg: within(wanted.light_tilt_deg, -90, 90), zoom: within(wanted.zoom, kLeastZoom, kMostZoom)};
  for (const slider of byId("look-sliders").querySelectorAll("input"))
    slider.value = slider.name === "zoom" ? Math.log2(view.zoom) : Math.round(view[slider.name]);
  if (told) send();
}

// Dragging takes hold of the cloth, or of the lamp.
function drag(image) {
  let held = null;
  image.onpointerdown = event => {
    held = {x: event.clientX, y: event.clientY, view, light: event.shiftKey || byId("look-light").checked};
    image.setPointerCapture(event.pointerId);
    event.preventDefault();
  };
  image.onpointermove = event => {
    if (!held) return;
    const right = kDegreesPerPixel * (event.clientX - held.x), down = kDegreesPerPixel * (event.clientY - held.y);
    turnTo(held.light ? {...held.view, light_turn_deg: held.view.light_turn_deg + right, light_tilt_deg: held.view.light_tilt_deg - down}
                      : {...held.view, turn_deg: held.view.turn_deg - right, tilt_deg: held.view.tilt_deg + down});
  };
  image.onpointerup = image.onpointercancel = () => { held = null; };
  // A pinch comes as a wheel with Ctrl; the wheel alone scrolls the page.
  image.addEventListener("wheel", event => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    turnTo({...view, zoom: view.zoom * 2 ** (-event.deltaY / 200)});
  }, {passive: false});
}

export function beginLook() {
  const sliders = [["turn_deg", -180, 180, 1], ["tilt_deg", -90, 90, 1], ["light_turn_deg", -180, 180, 1], ["light_tilt_deg", -90, 90, 1],
                   ["zoom", Math.log2(kLeastZoom), Math.log2(kMostZoom), 0.05]];
  byId("look-sliders").replaceChildren(...sliders.map(([name, min, max, step]) => {
    const slider = make("input", {type: "range", name, min, max, step});
    slider.oninput = () => turnTo({...view, [name]: name === "zoom" ? 2 ** Number(slider.value) : Number(slider.value)});
    return make("label", {}, make("span", {textContent: text(`look_${name}`)}), slider);
  }));
  byId("look-rest").onclick = () => turnTo(kRest);
  tellClipping(byId("look-picture"), byId("look-clipped"));
  drag(byId("look-picture"));
  turnTo(kRest, false);
}
