// Runs the cases in WebAssembly: node run.mjs FILE
import { readFileSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]));
const { count, check } = instance.exports;
for (let i = 0; i < count(); i++) {
  console.log(`case ${i}`);
  check(i);
}
