/* Exports before the validator of Khronos: node validate.mjs MODULES A.glb ..., with gltf-validator
 * in MODULES. Prints what it counted and fails on errors and warnings. */
import {createRequire} from 'node:module';
import {readFile} from 'node:fs/promises';
import {resolve} from 'node:path';

const [, , modules, ...files] = process.argv;
const validator = createRequire(resolve(modules, 'none.js'))('gltf-validator');
let faults = 0;
for (const file of files) {
  const bytes = await readFile(file), NOTE = 2;
  /* It knows of no KTX2: that is a note where the extension says that there is some. */
  const severityOverrides = bytes.includes('"KHR_texture_basisu"')
    ? {VALUE_NOT_IN_LIST: NOTE, IMAGE_UNRECOGNIZED_FORMAT: NOTE} : {};
  const {issues} = await validator.validateBytes(new Uint8Array(bytes), {severityOverrides});
  const codes = [...new Set(issues.messages.map((m) => m.code))].join(' ');
  console.log(`made: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ` +
              `${issues.numInfos} notes ${codes}`);
  faults += issues.numErrors + issues.numWarnings;
}
process.exit(faults ? 1 : 0);
