// exporters_three.mjs FOLDER: three.js makes shapes, changes them as people do, computes tangents by its two
// ways, and exports them as GLB, OBJ and PLY. The same files every time.
import fs from 'fs';
import * as THREE from 'three';
import * as mikktspace from 'mikktspace';
import { LoopSubdivision } from 'three-subdivide';
import { GLTFExporter } from 'three/examples/jsm/exporters/GLTFExporter.js';
import { OBJExporter } from 'three/examples/jsm/exporters/OBJExporter.js';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import * as Functions from 'three/examples/jsm/geometries/ParametricFunctions.js';
import { ParametricGeometry } from 'three/examples/jsm/geometries/ParametricGeometry.js';
import { ConvexGeometry } from 'three/examples/jsm/geometries/ConvexGeometry.js';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import { TeapotGeometry } from 'three/examples/jsm/geometries/TeapotGeometry.js';
import { TessellateModifier } from 'three/examples/jsm/modifiers/TessellateModifier.js';
import * as Utilities from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const folder = process.argv[2];
// What the exporters expect of a browser.
globalThis.requestAnimationFrame = call => setTimeout(call, 0);
globalThis.FileReader = class {
  readAsArrayBuffer(blob) {
    blob.arrayBuffer().then(bytes => { this.result = bytes; this.onloadend(); });
  }
};
console.warn = () => {};  // that normals were made unit

let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
const between = (a, b) => a + (b - a) * random();
const whole = (a, b) => Math.floor(between(a, b + 1));
const chance = share => random() < share;

class Curve extends THREE.Curve {
  constructor() {
    super();
    this.turns = [between(0.2, 0.9), between(0.2, 0.9), between(1, 4)];
  }
  getPoint(t, to = new THREE.Vector3()) {
    const [a, b, c] = this.turns;
    return to.set(2 * Math.cos(2 * Math.PI * a * t), 2 * Math.sin(2 * Math.PI * b * t), 3 * c * t);
  }
}
const outline = () => {
  const shape = new THREE.Shape();
  shape.moveTo(0, 0);
  shape.lineTo(between(1, 2), 0);
  shape.quadraticCurveTo(between(2, 3), between(0.5, 1), between(1, 2), between(1, 2));
  shape.bezierCurveTo(1, 2, 0.5, between(2, 3), 0, between(1, 2));
  shape.lineTo(0, 0);
  if (chance(0.5)) shape.holes.push(new THREE.Path().absarc(0.6, 0.6, 0.25, 0, 2 * Math.PI, true));
  return shape;
};
const profile = () => Array.from({ length: whole(4, 20) }, (_, i) => new THREE.Vector2(1 + 0.4 * Math.sin(0.4 * i), 0.1 * i));
const directions = n => Array.from({ length: n }, () => new THREE.Vector3(between(-1, 1), between(-1, 1), between(-1, 1)).normalize());

const shapes = {
  box: () => new THREE.BoxGeometry(between(0.3, 3), between(0.3, 3), between(0.3, 3), whole(1, 6), whole(1, 6), whole(1, 6)),
  capsule: () => new THREE.CapsuleGeometry(between(0.3, 1), between(0.3, 2), whole(2, 12), whole(4, 24)),
  circle: () => new THREE.CircleGeometry(between(0.3, 2), whole(3, 32), 0, between(1, 6.28)),
  cone: () => new THREE.ConeGeometry(between(0.3, 2), between(0.3, 3), whole(3, 32), whole(1, 8), chance(0.5)),
  cylinder: () => new THREE.CylinderGeometry(between(0.3, 2), between(0.3, 2), between(0.3, 3), whole(3, 32), whole(1, 8), chance(0.5)),
  dodecahedron: () => new THREE.DodecahedronGeometry(between(0.3, 2), whole(0, 5)),
  icosahedron: () => new THREE.IcosahedronGeometry(between(0.3, 2), whole(0, 6)),
  octahedron: () => new THREE.OctahedronGeometry(between(0.3, 2), whole(0, 6)),
  tetrahedron: () => new THREE.TetrahedronGeometry(between(0.3, 2), whole(0, 6)),
  convex: () => new ConvexGeometry(directions(whole(12, 200))),
  extrusion: () => new THREE.ExtrudeGeometry(outline(), { depth: between(0.2, 1), steps: whole(1, 4), bevelEnabled: chance(0.6), bevelSegments: whole(1, 5) }),
  sweep: () => new THREE.ExtrudeGeometry(outline(), { steps: whole(8, 40), extrudePath: new Curve() }),
  lathe: () => new THREE.LatheGeometry(profile(), whole(5, 40), 0, chance(0.5) ? 2 * Math.PI : between(1, 6)),
  plane: () => new THREE.PlaneGeometry(between(0.3, 3), between(0.3, 3), whole(1, 10), whole(1, 10)),
  ring: () => new THREE.RingGeometry(between(0.1, 0.5), between(0.6, 2), whole(3, 32), whole(1, 6)),
  shape: () => new THREE.ShapeGeometry(outline(), whole(3, 20)),
  sphere: () => new THREE.SphereGeometry(between(0.3, 2), whole(3, 40), whole(2, 30)),
  sphere_part: () => new THREE.SphereGeometry(between(0.3, 2), whole(3, 40), whole(2, 30), between(0, 3), between(0.5, 6.28), between(0, 1), between(0.5, 2)),
  torus: () => new THREE.TorusGeometry(between(1, 2), between(0.1, 0.9), whole(3, 24), whole(3, 40)),
  torus_part: () => new THREE.TorusGeometry(between(1, 2), between(0.1, 0.9), whole(3, 24), whole(3, 40), between(1, 6.28)),
  torus_knot: () => new THREE.TorusKnotGeometry(1, between(0.1, 0.4), whole(30, 120), whole(4, 12), whole(1, 4), whole(2, 5)),
  tube: () => new THREE.TubeGeometry(new Curve(), whole(8, 60), between(0.05, 0.5), whole(3, 16)),
  rounded_box: () => new RoundedBoxGeometry(between(1, 3), between(1, 3), between(1, 3), whole(1, 6), between(0.05, 0.4)),
  teapot: () => new TeapotGeometry(1, whole(2, 8)),
  klein: () => new ParametricGeometry(Functions.klein, whole(10, 40), whole(10, 40)),
  moebius: () => new ParametricGeometry(Functions.mobius, whole(10, 40), whole(4, 20)),
};
const smoothed = geometry => {
  geometry.computeVertexNormals();
  return geometry;
};
const changes = {
  plain: g => g,
  computed: g => smoothed(g),
  flat: g => smoothed(g.index ? g.toNonIndexed() : g),
  creased: g => Utilities.toCreasedNormals(g, between(0.2, 1)),
  merged: g => Utilities.mergeVertices(g),
  without_uvs: g => {
    g.deleteAttribute('normal').deleteAttribute('uv');
    return smoothed(Utilities.mergeVertices(g));
  },
  tessellated: g => new TessellateModifier(between(0.2, 0.6), 3).modify(g),
  subdivided: g => LoopSubdivision.modify(g, 1, { split: chance(0.5), uvSmooth: chance(0.5), preserveEdges: chance(0.3) }),
  scaled: g => g.scale(between(0.3, 2), between(0.3, 2), between(0.3, 2)),
  moved: g => g.rotateX(between(0, 3)).rotateZ(between(0, 3)).translate(between(-5, 5), between(-5, 5), between(-5, 5)),
  bent: g => {
    const p = g.attributes.position;
    for (let i = 0; i < p.count; ++i) p.setY(i, p.getY(i) * (1 + 0.2 * Math.sin(2 * p.getX(i))));
    return smoothed(g);
  },
};
const has = g => g.attributes.uv && g.attributes.normal;
const tangents = {
  none: g => g,
  three: g => {
    if (!g.index || !has(g)) return null;
    g.computeTangents();
    return g;
  },
  mikktspace: g => has(g) && Utilities.computeMikkTSpaceTangents(g, { isReady: true, generateTangents: mikktspace.generateTangents }),
};

for (const [shape, make] of Object.entries(shapes))
  for (const [change, changed] of Object.entries(changes))
    for (const [kind, with_tangents] of Object.entries(tangents)) {
      const geometry = with_tangents(changed(make().clone()));
      if (!geometry) continue;
      const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial());
      const name = `${folder}/${shape}_${change}`;
      fs.writeFileSync(`${name}.${kind}.glb`, Buffer.from(await new GLTFExporter().parseAsync(mesh, { binary: true })));
      if (kind !== 'none') continue;
      fs.writeFileSync(`${name}.obj`, new OBJExporter().parse(mesh));
      fs.writeFileSync(`${name}.ply`, Buffer.from(new PLYExporter().parse(mesh, () => {}, { binary: true })));
    }
