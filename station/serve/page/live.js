// The camera's picture as large as the window allows: full screen, single pixels, grid, what is in focus, what is clipped.

import {byId, text} from "/document.js";

const kClipped = 250, kEdge = 28;  // of 255

const on = new Set();

// Marks over the picture, pixel by pixel of what the station sent.
function marks() {
  const image = byId("frame-picture"), canvas = byId("frame-marks");
  canvas.hidden = !on.has("focus") && !on.has("clipping");
  if (canvas.hidden || !image.naturalWidth) return;
  const width = canvas.width = image.naturalWidth, height = canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  context.drawImage(image, 0, 0);
  const from = context.getImageData(0, 0, width, height).data, to = context.createImageData(width, height), out = to.data;
  const mark = (at, r, g, b) => { out[at] = r; out[at + 1] = g; out[at + 2] = b; out[at + 3] = 255; };
  for (let y = 1; y < height - 1; y++)
    for (let x = 1; x < width - 1; x++) {
      const at = 4 * (y * width + x);
      if (on.has("clipping") && Math.max(from[at], from[at + 1], from[at + 2]) >= kClipped) { mark(at, 255, 0, 80); continue; }
      if (!on.has("focus")) continue;
      const across = from[at + 5] - from[at - 3], down = from[at + 4 * width + 1] - from[at - 4 * width + 1];
      if (Math.abs(across) + Math.abs(down) > kEdge) mark(at, 255, 220, 0);
    }
  context.putImageData(to, 0, 0);
}

function toggle(name) {
  if (on.has(name)) on.delete(name);
  else on.add(name);
  byId(`live-${name}`).setAttribute("aria-pressed", on.has(name));
  byId("frame-view").classList.toggle(name, on.has(name));
  marks();
}

// The place that was clicked comes to the middle.
function loupe(event) {
  const view = byId("frame-view"), box = byId("frame-picture").getBoundingClientRect();
  const x = (event.clientX - box.left) / box.width, y = (event.clientY - box.top) / box.height;
  toggle("loupe");
  if (!on.has("loupe")) return;
  view.scrollLeft = x * byId("frame-picture").clientWidth - view.clientWidth / 2;
  view.scrollTop = y * byId("frame-picture").clientHeight - view.clientHeight / 2;
}

export const newFrame = marks;

export function beginLive() {
  for (const name of ["grid", "focus", "clipping", "loupe"]) {
    byId(`live-${name}`).onclick = () => toggle(name);
    byId(`live-${name}`).setAttribute("aria-pressed", "false");
  }
  byId("frame-picture").onclick = loupe;
  byId("live-full").onclick = () => document.fullscreenElement ? document.exitFullscreen() : byId("frame").requestFullscreen().catch(() => byId("frame").classList.toggle("full"));
  document.addEventListener("fullscreenchange", () => { byId("live-full").textContent = text(document.fullscreenElement ? "live_small" : "live_full"); });
}
