'use strict';
addEventListener('error', e => { document.body.dataset.error = e.message; });

(() => {
// ---- colours: as many bytes as there are levels of error, 255 for what is not compared
const scale = JSON.parse(document.getElementById('scale').textContent);
const srgb = x => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
const most_level = 254, not_compared = 255;
const colours = new Uint8Array(256 * 3);
for (let level = 0; level <= most_level; ++level) {
  const at = level / most_level * (scale.colours.length - 1), i = Math.min(Math.floor(at), scale.colours.length - 2);
  for (let k = 0; k < 3; ++k)
    colours[3 * level + k] = srgb(scale.colours[i][k] * (1 - at + i) + scale.colours[i + 1][k] * (at - i));
}
for (let k = 0; k < 3; ++k) colours[3 * not_compared + k] = srgb(scale.not_compared[k]);

// ---- a mesh, from base64
const unpack = (text, Type) => {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return new Type(bytes.buffer);
};
const read = section => {
  const data = JSON.parse(section.querySelector('script').textContent);
  return {
    triangles: unpack(data.triangles, data.vertices <= 0x10000 ? Uint16Array : Uint32Array), shape: data.shape,
    places: unpack(data.places, Uint16Array), errors: unpack(data.errors, Uint8Array),
    uvs: data.uvs && unpack(data.uvs, Uint16Array), square: data.square};
};

// ---- the uv square: every pixel has the largest error of the triangles over it
const no_uv = 0xffff;
function draw_uvs(canvas, mesh) {
  const {triangles, uvs, errors} = mesh, corner = (i, k) => uvs[2 * triangles[i] + k] / (no_uv - 1);
  const visible = i => [0, 1, 2].every(k => uvs[2 * triangles[i + k]] !== no_uv);
  const spans = (i, k) => {
    const a = corner(i, k), b = corner(i + 1, k), c = corner(i + 2, k);
    return [Math.min(a, b, c), Math.max(a, b, c)];
  };
  // Triangles may lie upon each other without end: where they do, fewer pixels.
  let area = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [u0, u1] = spans(i, 0), [v0, v1] = spans(i, 1);
    area += (u1 - u0) * (v1 - v0);
  }
  const size = Math.max(64, Math.min(720, Math.floor(Math.sqrt(2e8 / Math.max(area, 1e-9)))));
  canvas.width = canvas.height = size;
  const levels = new Float32Array(size * size).fill(-2);  // nothing -2, not compared -1
  for (let i = 0; i < triangles.length; i += 3) {
    if (!visible(i)) continue;
    const [ax, ay, bx, by, cx, cy] = [0, 1, 2].flatMap(k => [corner(i + k, 0) * size, corner(i + k, 1) * size]);
    const double_area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (double_area === 0) continue;
    const [ea, eb, ec] = [0, 1, 2].map(k => errors[triangles[i + k]]);
    const known = Math.max(ea, eb, ec) !== not_compared;
    // Pixels whose centres are inside.
    const first_x = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5)), last_x = Math.min(size - 1, Math.max(ax, bx, cx) - 0.5);
    const first_y = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5)), last_y = Math.min(size - 1, Math.max(ay, by, cy) - 0.5);
    for (let y = first_y; y <= last_y; ++y)
      for (let x = first_x; x <= last_x; ++x) {
        const px = x + 0.5 - ax, py = y + 0.5 - ay;
        const b = (px * (cy - ay) - py * (cx - ax)) / double_area, c = (py * (bx - ax) - px * (by - ay)) / double_area;
        if (b < 0 || c < 0 || b + c > 1) continue;
        const level = known ? ea + b * (eb - ea) + c * (ec - ea) : -1;
        if (level > levels[y * size + x]) levels[y * size + x] = level;
      }
  }
  const context = canvas.getContext('2d'), image = context.createImageData(size, size);
  for (let i = 0; i < levels.length; ++i) {
    if (levels[i] < -1) continue;
    const level = levels[i] < 0 ? not_compared : Math.round(levels[i]);
    for (let k = 0; k < 3; ++k) image.data[4 * i + k] = colours[3 * level + k];
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  // Where the square from 0 to 1 lies, if there is more than it.
  const [u0, u1, v0, v1] = mesh.square;
  context.strokeStyle = getComputedStyle(canvas).color;
  context.lineWidth = size / 360;
  context.strokeRect(-u0 / (u1 - u0) * size, -v0 / (v1 - v0) * size, size / (u1 - u0), size / (v1 - v0));
}

// ---- one WebGL context for all views, which copy its picture: browsers give few of them
const shaders = [
  `#version 300 es
  uniform mat3 turn;
  uniform vec2 zoom;
  uniform vec3 shape;
  in vec3 place, colour;
  out vec3 at, mixed;
  void main() {
    at = turn * ((2.0 * place - 1.0) * shape);
    mixed = colour;
    gl_Position = vec4(at.xy * zoom, -0.5 * at.z, 1.0);
  }`,
  `#version 300 es
  precision highp float;
  in vec3 at, mixed;
  out vec4 pixel;
  void main() {
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    pixel = vec4(mixed * (0.6 + 0.4 * abs(normal.z)), 1.0);
  }`];
const screen = document.createElement('canvas');
const gl = screen.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});
const program = gl && gl.createProgram();
if (gl) {
  shaders.forEach((source, i) => {
    const shader = gl.createShader(i === 0 ? gl.VERTEX_SHADER : gl.FRAGMENT_SHADER);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  });
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error('shader: ' + gl.getProgramInfoLog(program));
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
}

const about = (axis, angle) => {
  const c = Math.cos(angle), s = Math.sin(angle), i = (axis + 1) % 3, j = (axis + 2) % 3, m = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  m[4 * i] = m[4 * j] = c;
  m[3 * i + j] = s;  // column by column
  m[3 * j + i] = -s;
  return m;
};
const times = (a, b) => Array.from({length: 9}, (_, n) => {
  const row = n % 3, column = n - row;
  return a[row] * b[column] + a[3 + row] * b[column + 1] + a[6 + row] * b[column + 2];
});

function make_view(canvas, mesh) {
  const buffer = (target, values) => {
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, values, gl.STATIC_DRAW);
    return made;
  };
  const attribute = (name, values) => ({
    at: gl.getAttribLocation(program, name), buffer: buffer(gl.ARRAY_BUFFER, values),
    type: values instanceof Uint16Array ? gl.UNSIGNED_SHORT : gl.UNSIGNED_BYTE, stride: 4 * values.BYTES_PER_ELEMENT});
  // Four numbers a vertex, as graphics hardware wants them.
  const padded = (Type, count, from) => {
    const values = new Type(4 * count);
    for (let i = 0; i < count; ++i) for (let k = 0; k < 3; ++k) values[4 * i + k] = from(i, k);
    return values;
  };
  const count = mesh.errors.length;
  const attributes = [attribute('place', padded(Uint16Array, count, (i, k) => mesh.places[3 * i + k])),
                      attribute('colour', padded(Uint8Array, count, (i, k) => colours[3 * mesh.errors[i] + k]))];
  const elements = buffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
  const index_type = mesh.triangles instanceof Uint16Array ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
  let radius = 0;
  for (let i = 0; i < count; ++i)
    radius = Math.max(radius, Math.hypot(...mesh.shape.map((x, k) => x * (2 * mesh.places[3 * i + k] / 0xffff - 1))));
  const shape = mesh.shape.map(x => 0.97 * x / (radius || 1));
  let turn, zoom;

  const draw = () => {
    const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
    const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
    canvas.width = screen.width = width;
    canvas.height = screen.height = height;
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const a of attributes) {
      gl.bindBuffer(gl.ARRAY_BUFFER, a.buffer);
      gl.enableVertexAttribArray(a.at);
      gl.vertexAttribPointer(a.at, 3, a.type, true, a.stride, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements);
    const uniform = name => gl.getUniformLocation(program, name);
    gl.uniformMatrix3fv(uniform('turn'), false, turn);
    gl.uniform3fv(uniform('shape'), shape);
    const side = Math.min(width, height);
    gl.uniform2f(uniform('zoom'), zoom * side / width, zoom * side / height);
    gl.drawElements(gl.TRIANGLES, mesh.triangles.length, index_type, 0);
    canvas.getContext('2d').drawImage(screen, 0, 0);
  };
  const turn_by = (right, down) => {
    turn = times(times(about(0, down), about(1, right)), turn);
    draw();
  };
  const zoom_by = factor => {
    zoom = Math.min(200, Math.max(0.2, zoom * factor));
    draw();
  };
  const reset = () => {
    turn = times(about(0, 0.45), about(1, -0.6));
    zoom = 1;
    draw();
  };

  const pointers = new Map(), per_pixel = 0.008;
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', e => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, {x: e.clientX, y: e.clientY});
  });
  canvas.addEventListener('pointermove', e => {
    const pointer = pointers.get(e.pointerId);
    if (!pointer) return;
    const before = pointers.size === 2 && spread(), {x, y} = pointer;
    pointers.set(e.pointerId, {x: e.clientX, y: e.clientY});
    if (pointers.size === 1) turn_by(per_pixel * (e.clientX - x), per_pixel * (e.clientY - y));
    if (before > 0) zoom_by(spread() / before);
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, e => { pointers.delete(e.pointerId); });
  // The page keeps the wheel until the view is chosen.
  canvas.addEventListener('wheel', e => {
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    zoom_by(Math.exp(-0.0015 * e.deltaY * (e.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1)));
  }, {passive: false});
  const step = Math.PI / 18;
  const keys = {
    ArrowLeft: () => turn_by(-step, 0), ArrowRight: () => turn_by(step, 0), ArrowUp: () => turn_by(0, -step),
    ArrowDown: () => turn_by(0, step), '+': () => zoom_by(1.25), '=': () => zoom_by(1.25), '-': () => zoom_by(0.8), 0: reset};
  canvas.addEventListener('keydown', e => {
    if (e.ctrlKey || e.altKey || e.metaKey || !Object.hasOwn(keys, e.key)) return;
    e.preventDefault();
    keys[e.key]();
  });
  reset();
  addEventListener('resize', () => { if (canvas.clientWidth > 0) draw(); });
}

// ---- sections are drawn when they are opened
function open(section) {
  const pictures = section.querySelector('.pictures');
  if (!pictures || section.dataset.drawn) return;
  section.dataset.drawn = 'yes';
  pictures.hidden = false;
  const mesh = read(section), uv = section.querySelector('canvas.uv'), view = section.querySelector('canvas.view');
  if (uv) draw_uvs(uv, mesh);
  if (gl) {
    make_view(view, mesh);
  } else {
    view.hidden = true;
    section.querySelector('.no-webgl').hidden = false;
  }
}
for (const section of document.querySelectorAll('details.mesh')) {
  section.addEventListener('toggle', () => { if (section.open) open(section); });
  if (section.open) open(section);
}
// A link to a section opens it.
const follow = () => {
  const section = location.hash && document.getElementById(location.hash.slice(1));
  if (section instanceof HTMLDetailsElement) section.open = true;
};
addEventListener('hashchange', follow);
follow();

// ---- which meshes are shown, and in which order
const controls = document.querySelector('.controls');
if (controls) {
  const list = document.querySelector('.meshes'), meshes = [...list.children];
  const verdicts = [...controls.querySelectorAll('.by-verdict')], code = controls.querySelector('.by-code');
  const sort = controls.querySelector('.sort'), shown = controls.querySelector('.shown');
  const name = mesh => mesh.querySelector('.name').textContent;
  const orders = {
    verdict: () => 0,  // as they came
    name: (a, b) => name(a).localeCompare(name(b)),
    corners: (a, b) => b.dataset.corners - a.dataset.corners,
    worst: (a, b) => b.dataset.worst - a.dataset.worst};
  const choose = () => {
    const permitted = new Set(verdicts.filter(v => v.checked).map(v => v.value));
    let count = 0;
    for (const mesh of meshes) {
      mesh.hidden = !permitted.has(mesh.dataset.verdict) ||
                    code && code.value !== '' && !mesh.dataset.codes.split(' ').includes(code.value);
      count += !mesh.hidden;
    }
    shown.textContent = count === meshes.length ? '' : `${count} of ${meshes.length} are shown`;
    list.append(...[...meshes].sort(orders[sort.value]));
  };
  controls.hidden = false;
  controls.addEventListener('change', choose);
  choose();
}
document.body.dataset.ready = 'yes';
})();
