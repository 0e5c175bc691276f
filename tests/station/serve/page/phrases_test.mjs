// node phrases_test.mjs PAGE
// How the page puts what the program says into another language: phrases.js from the folder PAGE with a small catalogue.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import path from "node:path";

const catalogue = {
  "It stands {a}.": "Es steht {a}.",
  "{a} and {b}": "{a} und {b}",
  "{a} cm too near": "{a} cm zu nah",
  "turned {a} degrees to the left": "um {a} Grad nach links gedreht",
  "Put stand {a} on the platform.": "Stellen Sie Ständer {a} auf den Drehteller.",
  "the {a}": "das {a}",
  "board": "Brett",
  "Take {a} away.": "Nehmen Sie {a} weg.",
};
globalThis.fetch = async () => ({json: async () => catalogue});
const source = readFileSync(path.join(process.argv[2], "phrases.js"), "utf8");
const {readPhrases, said, untold} = await import("data:text/javascript," + encodeURIComponent(source));

assert.equal(said("Put stand 3 on the platform."), "Put stand 3 on the platform.", "English before a catalogue is read");
await readPhrases("en");
assert.equal(said("It stands 3 cm too near."), "It stands 3 cm too near.");
await readPhrases("de");
assert.equal(said(""), "");
assert.equal(said(undefined), "");
assert.equal(said("1.5"), "1.5");
assert.equal(said("It stands 3 cm too near and turned 20 degrees to the left."), "Es steht 3 cm zu nah und um 20 Grad nach links gedreht.");
assert.equal(said("Put stand 3 on the platform. It stands 3 cm too near."),
             "Stellen Sie Ständer 3 auf den Drehteller. Es steht 3 cm zu nah.");
assert.equal(said("Put stand 1 on the platform.\nPut stand 2 on the platform."),
             "Stellen Sie Ständer 1 auf den Drehteller.\nStellen Sie Ständer 2 auf den Drehteller.");
assert.equal(said("Take the board away."), "Nehmen Sie das Brett weg.");
assert.equal(said("Take IMG_1 away."), "Nehmen Sie IMG_1 weg.", "names stay as they are");
assert.deepEqual([...untold], []);
assert.equal(said("Bread and butter."), "Bread and butter.", "what only joins is no translation of what is unknown");
assert.equal(said("Unknown. It stands 3 cm too near."), "Unknown. Es steht 3 cm zu nah.");
assert.deepEqual([...untold], ["Bread and butter.", "Unknown."]);
console.log("all as it should be");
