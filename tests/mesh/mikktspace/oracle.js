// node oracle.js MESHES TANGENTS: for each mesh of the first file (a number of corners n, then n times position, normal, uv)
// its number of corners and x, y, z, w of each by the npm package mikktspace, or 0 where that gives up.
const fs = require('fs');
const { generateTangents } = require('mikktspace');

const bytes = fs.readFileSync(process.argv[2]);
const results = [];
let meshes = 0, given_up = 0;
for (let at = 0; at < bytes.length; ++meshes) {
  const n = bytes.readUInt32LE(at);
  const numbers = new Float32Array(bytes.buffer.slice(bytes.byteOffset + at + 4, bytes.byteOffset + at + 4 + 32 * n));
  at += 4 + 32 * n;
  const pick = (from, count) => {
    const to = new Float32Array(count * n);
    for (let i = 0; i < n; ++i) for (let k = 0; k < count; ++k) to[count * i + k] = numbers[8 * i + from + k];
    return to;
  };
  const head = new Uint32Array([n]);
  try {
    const tangents = generateTangents(pick(0, 3), pick(3, 3), pick(6, 2));
    results.push(Buffer.from(head.buffer), Buffer.from(tangents.buffer, tangents.byteOffset, tangents.byteLength));
  } catch (error) {
    ++given_up;
    results.push(Buffer.from(new Uint32Array([0]).buffer));
  }
}
fs.writeFileSync(process.argv[3], Buffer.concat(results));
console.log(`${meshes} meshes, given up ${given_up}`);
