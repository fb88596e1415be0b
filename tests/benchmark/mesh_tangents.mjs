// node mesh_tangents.mjs PACKAGES MAKER MESH [TANGENTS]: runs a maker of tangents from npm, "mikktspace", "meshoptimizer" or
// "meshoptimizer-compatible", on the triangles of a file that torus_file.cpp wrote, and prints the numbers of a Sample
// (tangent_makers.h), measured as measure_maker() does. PACKAGES is the folder of node_modules.
import fs from 'fs';
import { createRequire } from 'module';
import path from 'path';
import { pathToFileURL } from 'url';

const [packages, maker, mesh_file, tangents_file] = process.argv.slice(2);
const require = createRequire(path.resolve(packages) + '/');

function read_mesh(file) {
  const descriptor = fs.openSync(file);
  const fill = (array) => {
    const bytes = new Uint8Array(array.buffer);
    for (let at = 0; at < bytes.length;) {
      const count = fs.readSync(descriptor, bytes, at, Math.min(bytes.length - at, 1 << 30), null);
      if (count === 0) throw new Error(`${file}: ends too early`);
      at += count;
    }
    return array;
  };
  const [vertices, corners] = fill(new Uint32Array(2));
  return {
    positions: fill(new Float32Array(3 * vertices)),
    normals: fill(new Float32Array(3 * vertices)),
    uvs: fill(new Float32Array(2 * vertices)),
    corners: corners === 0 ? null : fill(new Uint32Array(corners)),
  };
}

async function maker_of({ positions, normals, uvs, corners }) {
  if (maker === 'mikktspace') {
    if (corners !== null) throw new Error('it takes no indices');
    const { generateTangents } = require('mikktspace');
    return () => generateTangents(positions, normals, uvs);
  }
  const { MeshoptTangents } = await import(pathToFileURL(require.resolve('meshoptimizer/tangents')));
  await MeshoptTangents.ready;
  const flags = { 'meshoptimizer': [], 'meshoptimizer-compatible': ['Compatible'] }[maker];
  return () => MeshoptTangents.generateTangents(corners, positions, 3, normals, 3, uvs, 2, flags);
}

function peak_bytes() {
  return 1024 * Number(fs.readFileSync('/proc/self/status', 'utf8').match(/VmHWM:\s*(\d+)/)[1]);
}
function reset_peak() {
  try {
    fs.writeFileSync('/proc/self/clear_refs', '5');
  } catch {
    // The peak so far is then that of reading, which is what memory holds now.
  }
}

let result;
function timed(make) {
  const from = process.cpuUsage();
  result = make();
  const { user, system } = process.cpuUsage(from);
  return (user + system) / 1e6;
}

try {
  const make = await maker_of(read_mesh(mesh_file));
  reset_peak();
  const before = peak_bytes();
  const first = timed(make);
  const bytes = peak_bytes() - before - result.byteLength;
  for (let passed = 0; passed < 0.5;) passed += timed(make);
  let calls = 0, seconds = 0;
  for (; seconds < 0.2; ++calls) seconds += timed(make);
  if (tangents_file) fs.writeFileSync(tangents_file, new Uint8Array(result.buffer, result.byteOffset, result.byteLength));
  console.log(seconds / calls, first, bytes);
} catch (error) {
  console.log(error instanceof WebAssembly.RuntimeError ? `gives up: ${error.message}` : error.message);
  process.exit(1);
}
