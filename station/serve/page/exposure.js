// Exposure: how bright pictures are shown, those of a screen alike, and how much of them the screen cannot show.

import {fill, make, percent, text} from "/document.js";

const kStops = [-4, -3, -2, -1, 0, 1, 2, 3, 4];

// A list of exposures, at first the one at which a white card is white.
export function fillStops(list) {
  const first = !list.options.length;
  fill(list, kStops.map(String), kStops.map(stops => stops === 0 ? text("stops_none") : text(stops > 0 ? "stops_brighter" : "stops_darker", {n: Math.abs(stops)})));
  if (first) list.value = "0";
}

// Of what is not black: the shares that are brighter, and more vivid, than a screen shows.
function beyond(image) {
  const width = Math.min(image.naturalWidth, 600), height = Math.max(1, Math.round(image.naturalHeight * width / image.naturalWidth));
  const context = make("canvas", {width, height}).getContext("2d", {willReadFrequently: true});
  context.drawImage(image, 0, 0, width, height);
  const {data} = context.getImageData(0, 0, width, height), kDark = 40;
  let seen = 0, bright = 0, vivid = 0;
  for (let i = 0; i < data.length; i += 4) {
    const most = Math.max(data[i], data[i + 1], data[i + 2]);
    if (most === 0) continue;
    seen += 1;
    bright += most === 255;
    vivid += most > kDark && most < 255 && Math.min(data[i], data[i + 1], data[i + 2]) === 0;
  }
  return seen ? {bright: bright / seen, vivid: vivid / seen} : {bright: 0, vivid: 0};
}

// Says below a picture, once it is there, how much of it is clipped.
export function tellClipping(image, words) {
  image.onload = () => {
    const {bright, vivid} = beyond(image), kSeen = 0.0005;
    words.textContent = [[bright, "clipped_bright"], [vivid, "clipped_vivid"]].filter(([share]) => share >= kSeen)
      .map(([share, key]) => text(key, {share: percent(share)})).join(" · ");
  };
  return image;
}
