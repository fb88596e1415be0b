// node make.mjs FOLDER N: meshes of resolution N, by the geometries of three.js, and their tangents by the tools of npm. For each
// mesh FOLDER/NAME/mesh, as torus_file.h describes it, indexed, and FOLDER/NAME/TOOL: x, y, z and the sign w of each corner.
// The packages are those of the folder node_modules beside this file.
import fs from 'fs';
import { Document } from '@gltf-transform/core';
import { tangents, unweld } from '@gltf-transform/functions';
import { MeshoptTangents } from 'meshoptimizer/tangents';
import { generateTangents } from 'mikktspace';
import { CylinderGeometry, SphereGeometry, TorusGeometry } from 'three';

const [folder, resolution] = process.argv.slice(2);
const n = Number(resolution), columns = 2 * n;
const bands = Math.max(2, n / 4);  // of cylinder and cone

const sphere = () => new SphereGeometry(1, columns, n);
const torus = () => new TorusGeometry(1, 0.4, n, columns);
const cylinder = (top, open) => new CylinderGeometry(top, 1, 2, n, bands, open);

// The sphere's vertices, but those of the poles at the u of their columns, and two triangles a cell there too.
function plainsphere() {
  const mesh = sphere(), uv = mesh.attributes.uv, indices = [];
  for (let i = 0; i <= columns; ++i) for (const row of [0, n]) uv.setX(row * (columns + 1) + i, i / columns);
  for (let j = 0; j < n; ++j)
    for (let i = 0; i < columns; ++i) {
      const b = j * (columns + 1) + i, c = b + columns + 1;
      indices.push(b + 1, b, c + 1, b, c, c + 1);
    }
  mesh.setIndex(indices);
  return mesh;
}

function ellipsoid() {
  const mesh = sphere(), { position, normal } = mesh.attributes, axes = [1, 0.7, 0.5];
  for (let k = 0; k < position.count; ++k) {
    const p = [position.getX(k), position.getY(k), position.getZ(k)].map((x, axis) => x * axes[axis]);
    const gradient = p.map((x, axis) => x / axes[axis] ** 2), length = Math.hypot(...gradient);
    position.setXYZ(k, ...p);
    normal.setXYZ(k, ...gradient.map((x) => x / length));
  }
  return mesh;
}

function sheartorus() {
  const mesh = torus(), uv = mesh.attributes.uv;
  for (let k = 0; k < uv.count; ++k) uv.setX(k, uv.getX(k) + uv.getY(k) / 2);
  return mesh;
}

// Vertices inside the chart moved in u and v by up to a quarter of a cell, evenly: the mesh that was measured earlier, whose random
// numbers begin with the seed 12345 and come from the generator that the C standard shows, as doubles compute it.
function jittertorus() {
  const mesh = torus(), { position, normal, uv } = mesh.attributes;
  let state = 12345;
  const quarter = () => {
    state = (state * 1103515245 + 12345) % 2 ** 31;
    return (state / 2 ** 31 - 0.5) / 2;
  };
  for (let j = 1; j < n; ++j)
    for (let i = 1; i < columns; ++i) {
      const k = j * (columns + 1) + i;
      uv.setXY(k, (i + quarter()) / columns, (j + quarter()) / n);
      const a = 2 * Math.PI * uv.getX(k), b = 2 * Math.PI * uv.getY(k), ring = 1 + 0.4 * Math.cos(b);
      position.setXYZ(k, ring * Math.cos(a), ring * Math.sin(a), 0.4 * Math.sin(b));
      normal.setXYZ(k, Math.cos(b) * Math.cos(a), Math.cos(b) * Math.sin(a), Math.sin(b));
    }
  return mesh;
}

const meshes = {
  sphere, plainsphere, torus, ellipsoid, sheartorus, jittertorus,
  cone: () => cylinder(0.5, true),
  cylinder: () => cylinder(1, true),
  capped: () => cylinder(1, false),
};

// The numbers of each corner of the triangles.
function of_corners({ array, itemSize }, corners) {
  const result = new Float32Array(itemSize * corners.length);
  corners.forEach((vertex, corner) => {
    for (let k = 0; k < itemSize; ++k) result[itemSize * corner + k] = array[itemSize * vertex + k];
  });
  return result;
}

async function by_gltf_transform({ positions, normals, uvs, corners }) {
  const document = new Document(), buffer = document.createBuffer();
  const attribute = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document.createPrimitive()
    .setAttribute('POSITION', attribute('VEC3', positions))
    .setAttribute('NORMAL', attribute('VEC3', normals))
    .setAttribute('TEXCOORD_0', attribute('VEC2', uvs))
    .setIndices(attribute('SCALAR', corners));
  document.createMesh().addPrimitive(primitive);
  await document.transform(unweld(), tangents({ generateTangents, overwrite: true }));
  return primitive.getAttribute('TANGENT').getArray();
}

for (const [name, make] of Object.entries(meshes)) {
  const geometry = make(), { position, normal, uv } = geometry.attributes;
  const corners = Uint32Array.from(geometry.index.array);
  const soup = [position, normal, uv].map((attribute) => of_corners(attribute, corners));
  const meshopt = (...flags) =>
    MeshoptTangents.generateTangents(null, soup[0], 3, soup[1], 3, soup[2], 2, flags);
  await MeshoptTangents.ready;

  const write = (file, ...arrays) =>
    fs.writeFileSync(`${folder}/${name}/${file}`,
      Buffer.concat(arrays.map((x) => Buffer.from(x.buffer, x.byteOffset, x.byteLength))));
  fs.mkdirSync(`${folder}/${name}`, { recursive: true });
  write('mesh', Uint32Array.of(position.count, corners.length), position.array, normal.array, uv.array, corners);
  write('mikktspace', generateTangents(...soup));
  write('gltf-transform', await by_gltf_transform(
    { positions: position.array, normals: normal.array, uvs: uv.array, corners }));
  write('meshoptimizer', meshopt());
  write('meshoptimizer-compatible', meshopt('Compatible'));
  geometry.computeTangents();
  write('three', of_corners(geometry.attributes.tangent, corners));
}
