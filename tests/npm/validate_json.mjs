// validate_json.mjs SCHEMA FILE: a JSON Schema of draft 4; one line for each violation on standard output, status 1 if any.
import { readFileSync } from 'node:fs';
import Ajv from 'ajv-draft-04';

const [schema, document] = process.argv.slice(2).map((file) => JSON.parse(readFileSync(file, 'utf8')));
const formats = { 'date-time': /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|[+-]\d\d:\d\d)$/ };
const validate = new Ajv({ allErrors: true, strict: false, formats }).compile(schema);
if (!validate(document)) {
  for (const error of validate.errors) console.log(`${error.instancePath || '/'} ${error.message}`);
  process.exitCode = 1;
}
