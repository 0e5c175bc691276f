// validate_gltf.mjs FILE.gltf: Khronos' validator; its report as JSON on standard output.
import { readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import validator from 'gltf-validator';

const file = process.argv[2];
const bytes = (path) => new Uint8Array(readFileSync(path));
const report = await validator.validateBytes(bytes(file), {
  uri: basename(file),
  externalResourceFunction: async (uri) => bytes(join(dirname(file), uri)),
});
console.log(JSON.stringify(report));
