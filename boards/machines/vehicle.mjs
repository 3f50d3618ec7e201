// Sends a file through the vehicle's gateway in WebAssembly, and writes its reports: node vehicle.mjs WASM FILE
import { readFileSync, writeSync } from "node:fs";

const [wasm, file] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(wasm));
const { memory, push, report } = instance.exports;
for (const byte of readFileSync(file)) {
  const length = push(byte);
  if (length > 0) writeSync(1, new Uint8Array(memory.buffer, report(), length));
}
