// The energies of a thread's lobes over c = cos(theta), with their bands (two standard deviations), of one thread or of two.

import {draw, text} from "/document.js";

const lobes = ["R", "TT", "TRT"];
const left = 52, right = 500, top = 12, bottom = 250;
const x = cosine => left + (right - left) * cosine;

export function curves(threads) {
  const most = Math.max(0.1, ...threads.flatMap(thread => thread.curves.flatMap(one =>
    one.lambda.map((value, lobe) => Math.min(1.5, value + 2 * (one.sigma ? one.sigma[lobe] : 0))))));
  const y = value => bottom - (bottom - top) * Math.min(1.02, Math.max(0, value / most));
  const plot = draw("svg", {viewBox: "0 0 600 300", role: "img", "aria-label": text("curves"), class: "plot"});
  for (let i = 0; i <= 4; i++) {
    plot.append(draw("line", {x1: left, x2: right, y1: y(most * i / 4), y2: y(most * i / 4), class: "grid"}),
                draw("text", {x: left - 8, y: y(most * i / 4) + 5, "text-anchor": "end"}, (most * i / 4).toFixed(2)),
                draw("text", {x: x(i / 4), y: bottom + 22, "text-anchor": "middle"}, (i / 4).toString()));
  }
  plot.append(draw("text", {x: (left + right) / 2, y: 292, "text-anchor": "middle"}, text("cosine")));
  threads.forEach((thread, which) => lobes.forEach((name, lobe) => {
    const points = thread.curves.map(one => [x(one.cosine), one.lambda[lobe], one.sigma ? 2 * one.sigma[lobe] : 0]);
    const path = sign => points.map(([at, value, band]) => `${at},${y(value + sign * band)}`);
    plot.append(draw("polygon", {points: [...path(1), ...path(-1).reverse()].join(" "), class: `band lobe${lobe}`}),
                draw("polyline", {points: path(0).join(" "), class: `curve lobe${lobe} thread${which}`}));
    if (which === 0) {
      const end = y(points.at(-1)[1]);
      plot.append(draw("line", {x1: 512, x2: 536, y1: 30 + 28 * lobe, y2: 30 + 28 * lobe, class: `curve lobe${lobe}`}),
                  draw("text", {x: 544, y: 36 + 28 * lobe}, name),
                  draw("circle", {cx: right, cy: end, r: 3, class: `dot lobe${lobe}`}));
    }
  }));
  return plot;
}
