// node compare_plan.js TOOL WORK: whether `TOOL plan` and the Khronos validator say the same of small files, one per rule of
// plan, with TANGENT and without, with and without NORMAL and uvs. The validator says MESH_PRIMITIVE_NO_TANGENT_SPACE of what no
// viewer can make, MESH_PRIMITIVE_GENERATED_TANGENT_SPACE of what viewers have to make, UNUSED_MESH_TANGENT of what nothing
// reads. Where it has no rule, or another than the specifications, that is in `differs`, with the reason. Exit status 1 where they
// disagree elsewhere, or agree there.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const { validateBytes } = require('gltf-validator');

const texture = { index: 0 };
const extension = (name, value) => ({ extensions: { [name]: value } });
const anisotropy = { KHR_materials_anisotropy: { anisotropyStrength: 0.5 } };
const clearcoat = { KHR_materials_clearcoat: { clearcoatFactor: 1, clearcoatNormalTexture: texture } };
const materials = {
  nothing: {},
  base_colour: { pbrMetallicRoughness: { baseColorTexture: texture }, occlusionTexture: texture },
  normal_texture: { normalTexture: texture },
  clearcoat_normal_texture: { extensions: clearcoat },
  clearcoat_without: extension('KHR_materials_clearcoat', { clearcoatFactor: 1 }),
  anisotropy: { extensions: anisotropy },
  anisotropy_texture: extension('KHR_materials_anisotropy', { anisotropyStrength: 0.5, anisotropyTexture: texture }),
  anisotropy_with_normal_texture: { normalTexture: texture, extensions: anisotropy },
  anisotropy_with_clearcoat_normal_texture: { extensions: { ...anisotropy, ...clearcoat } },
  unlit: { normalTexture: texture, ...extension('KHR_materials_unlit', {}) },
  iridescence: extension('KHR_materials_iridescence', { iridescenceFactor: 1, iridescenceTexture: texture }),
  sheen: extension('KHR_materials_sheen', { sheenColorTexture: texture }),
  transmission: extension('KHR_materials_transmission', { transmissionTexture: texture }),
};

function document(material, has) {
  const views = [], accessors = [], bytes = [];
  const add = (rows, type, bounds) => {
    const data = Buffer.from(new Float32Array(rows.flat()).buffer);
    views.push({ buffer: 0, byteOffset: bytes.reduce((n, b) => n + b.length, 0), byteLength: data.length });
    bytes.push(data);
    accessors.push({ bufferView: views.length - 1, componentType: 5126, count: rows.length, type, ...bounds });
    return accessors.length - 1;
  };
  const repeat = (row) => [row, row, row];
  const attributes = { POSITION: add([[0, 0, 0], [1, 0, 0], [0, 1, 0]], 'VEC3', { min: [0, 0, 0], max: [1, 1, 0] }) };
  if (has.NORMAL) attributes.NORMAL = add(repeat([0, 0, 1]), 'VEC3');
  if (has.TANGENT) attributes.TANGENT = add(repeat([1, 0, 0, 1]), 'VEC4');
  if (has.TEXCOORD) attributes.TEXCOORD_0 = add([[0, 0], [1, 0], [0, 1]], 'VEC2');
  const pixel = 'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==';
  const buffer = Buffer.concat(bytes);
  return {
    asset: { version: '2.0' },
    extensionsUsed: Object.keys(material.extensions || {}),
    buffers: [{ byteLength: buffer.length, uri: 'data:application/octet-stream;base64,' + buffer.toString('base64') }],
    bufferViews: views,
    accessors,
    images: [{ uri: 'data:image/png;base64,' + pixel }],
    textures: [{ source: 0 }],
    materials: [material],
    meshes: [{ primitives: [{ attributes, material: 0 }] }],
    nodes: [{ mesh: 0 }],
    scenes: [{ nodes: [0] }],
  };
}

// What the validator says of the tangents of primitive 0.
async function validated(file) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const codes = (await validateBytes(bytes, { maxIssues: 0 })).issues.messages.map((m) => m.code);
  return codes.filter((c) => /TANGENT/.test(c)).sort();
}

// Files of which the validator says otherwise, by material, and why plan does: TANGENT counts 1, NORMAL 2, uvs 4.
const differs = {
  unlit: [[0, 2, 3, 4, 6, 7], 'KHR_materials_unlit draws the base colour alone'],
  anisotropy: [[0, 2, 3, 4, 6, 7], 'KHR_materials_anisotropy asks for a tangent space whether there is a texture or not'],
  clearcoat_normal_texture: [[6], 'viewers derive the frame from the uvs of the normal texture that they draw'],
};

// Whether both say the same: needed or not, and what no viewer can make.
function agree(has, planned, codes) {
  const says = (code) => codes.includes(code);
  if (has.TANGENT && !has.NORMAL) return planned.need === 'idle' && says('MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL');
  if (has.TANGENT) return (planned.need === 'needed') === !says('UNUSED_MESH_TANGENT');
  const impossible = says('MESH_PRIMITIVE_NO_TANGENT_SPACE'), generated = says('MESH_PRIMITIVE_GENERATED_TANGENT_SPACE');
  if (planned.derivable !== (generated && has.NORMAL !== 0 && has.TEXCOORD !== 0)) return false;
  return (planned.need === 'missing') === (impossible || generated);
}

(async () => {
  const [, , tool, work] = process.argv;
  const files = [];
  for (const [name, material] of Object.entries(materials))
    for (let bits = 0; bits < 8; ++bits) {
      const has = { TANGENT: bits & 1, NORMAL: bits & 2, TEXCOORD: bits & 4 };
      const file = path.join(work, `${name}_${bits}.gltf`);
      fs.writeFileSync(file, JSON.stringify(document(material, has)));
      files.push({ name, has, file });
    }
  // Status 1 says that something is missing that no viewer can make.
  const run = spawnSync(tool, ['plan', ...files.map((f) => f.file), '--json'], { maxBuffer: 1 << 26 });
  if (run.status !== 1) throw new Error(`status ${run.status} of darboux plan: ${run.stderr}`);
  const planned = JSON.parse(run.stdout).files;
  const expected = new Set();
  for (const [name, [cases]] of Object.entries(differs)) for (const bits of cases) expected.add(`${name}_${bits}.gltf`);
  let failures = 0;
  for (const [i, { has, file }] of files.entries()) {
    const plan = planned[i].primitives[0], codes = await validated(file), name = path.basename(file);
    if (agree(has, plan, codes) !== expected.has(name)) continue;
    ++failures;
    const not = expected.has(name) ? ' not' : '';
    console.log(`FAILED: ${name} does${not} differ: plan says ${plan.need}, derivable ${plan.derivable}; the validator ${codes}`);
  }
  console.log(`${files.length} files, ${expected.size} of which the validator says otherwise, ${failures} failures`);
  process.exit(failures > 0 ? 1 : 0);
})();
