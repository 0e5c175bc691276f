// Drawings for each step that a person does: how the bench should stand, seen from above and as the camera sees what is on
// the platform, or how far the platform is to be turned.

import {draw, text} from "/document.js";

const words = (x, y, key, attributes = {}) =>
  draw("text", {x, y, "text-anchor": "middle", ...attributes}, text(key));

// Where the lamp stands, seen from above; the camera is at the bottom.
const lamps = {front: [245, 195], front_left: [55, 195], back: [95, 45]};

function lamp([x, y]) {
  return draw("g", {class: "lit"},
    draw("line", {x1: x, y1: y, x2: 150 + (x - 150) * 0.45, y2: 110 + (y - 110) * 0.45, "stroke-width": 6, "stroke-dasharray": "9 7"}),
    draw("circle", {cx: x, cy: y, r: 14}));
}

function fromAbove(wanted) {
  const thing = wanted.object === "nothing" ? [] : wanted.object === "cylinder"
    ? [draw("circle", {cx: 150, cy: 110, r: 20, class: "thing"})]
    : [draw("rect", {x: 110, y: 105, width: 80, height: 10, class: "thing"})];
  return draw("g", {},
    draw("circle", {cx: 150, cy: 110, r: 58, class: "platform"}), ...thing,
    draw("path", {d: "M130 232 h40 v22 h-40 z M141 232 l4 -12 h10 l4 12", class: "camera"}),
    words(150, 275, "camera"),
    ...(lamps[wanted.lamp] ? [lamp(lamps[wanted.lamp])] : []),
    words(150, 24, wanted.lamp === "off" ? "lamp_off" : `lamp_${wanted.lamp}`, {class: wanted.lamp === "off" ? "dim" : "lit"}));
}

const lines = (count, upright) => Array.from({length: count}, (unused, i) => upright
  ? draw("line", {x1: 425 + 12 * i, y1: 90, x2: 425 + 12 * i, y2: 170})
  : draw("line", {x1: 415, y1: 97 + 12 * i, x2: 525, y2: 97 + 12 * i}));

function grid(columns, rows, filled) {
  const cells = [];
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < columns; column++)
      cells.push(draw("rect", {x: 408 + column * 124 / columns, y: 78 + row * 104 / rows, width: 100 / columns, height: 80 / rows,
                               class: filled ? "thing" : "patch"}));
  return cells;
}

const fronts = {
  nothing: () => [],
  board: wanted => wanted.on_its_side ? grid(3, 4, true) : grid(4, 3, true),
  colour_chart: () => grid(6, 4, false),
  spectralon: () => [draw("rect", {x: 435, y: 95, width: 70, height: 70, class: "white"})],
  holder: wanted => lines(wanted.mounting === "vertical" ? 8 : 7, wanted.mounting === "vertical"),
  cylinder: () => [draw("rect", {x: 435, y: 70, width: 70, height: 120, class: "thing"})],
};

function front(wanted) {
  return draw("g", {},
    draw("rect", {x: 390, y: 60, width: 160, height: 140, class: wanted.object === "nothing" ? "empty" : "frame"}),
    ...fronts[wanted.object](wanted),
    words(470, 235, `object_${wanted.object}`),
    ...(wanted.stand ? [draw("text", {x: 470, y: 52, "text-anchor": "middle", class: "lit"}, `${text("stand")} ${wanted.stand}`)] : []),
    words(470, 262, howItStands(wanted), {class: "dim"}));
}

function howItStands(wanted) {
  if (wanted.object === "nothing") return "object_nothing";
  if (wanted.object === "holder") return `threads_${wanted.mounting}`;
  if (wanted.kept_moving) return "kept_moving";
  if (wanted.stand) return wanted.on_its_side ? "on_its_side" : "upright_on_stand";
  return wanted.on_platform ? "on_platform" : "by_hand";
}

export function stepPicture(wanted) {
  const light = wanted.room_light ? "room_light_on" : "room_light_off";
  return draw("svg", {viewBox: "0 0 600 320", role: "img", "aria-label": text("step_picture")},
    fromAbove(wanted), front(wanted),
    words(300, 308, light, {class: wanted.room_light ? "lit" : "dim"}));
}

// The platform seen from above, its mark where it should be; counter-clockwise is more, and 0 is in front, at the camera.
export function turnPicture(degrees) {
  const at = (angle, radius) => { const turn = angle * Math.PI / 180; return [300 + radius * Math.sin(turn), 130 + radius * Math.cos(turn)].map(value => value.toFixed(1)); };
  const marks = Array.from({length: 24}, (unused, i) => {
    const [x1, y1] = at(15 * i, 92), [x2, y2] = at(15 * i, i % 6 ? 98 : 104);
    return draw("line", {x1, y1, x2, y2, class: "scale"});
  });
  const turned = ((degrees % 360) + 360) % 360, way = Math.min(Math.max(turned, 0.1), 359.9), end = at(way, 76).join(" ");
  return draw("svg", {viewBox: "0 0 600 320", role: "img", "aria-label": text("turn_picture", {degrees: degrees.toFixed(1)})},
    draw("circle", {cx: 300, cy: 130, r: 92, class: "platform"}), ...marks,
    ...(turned ? [draw("path", {d: `M${at(0, 76).join(" ")} A76 76 0 ${way > 180 ? 1 : 0} 0 ${end}`, class: "way"})] : []),
    draw("line", {x1: 300, y1: 130, x2: at(turned, 88)[0], y2: at(turned, 88)[1], class: "mark"}),
    draw("circle", {cx: at(turned, 88)[0], cy: at(turned, 88)[1], r: 9, class: "thing"}),
    draw("text", {x: 300, y: 120, "text-anchor": "middle", class: "angle"}, `${degrees.toFixed(1)}°`),
    draw("path", {d: "M280 262 h40 v22 h-40 z M291 262 l4 -12 h10 l4 12", class: "camera"}),
    words(300, 308, "camera"));
}
