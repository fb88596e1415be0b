// look_at_validate.mjs TOOL DATA [SCREENSHOTS]: runs `TOOL validate --report` on the meshes in DATA and looks at the page in
// headless chromium: no script fails and nothing is asked of a network; the numbers are those of --json; the mesh and its uvs
// are drawn, and turn by mouse, keys and fingers; names cannot run a script. Exit status 77 where chromium is not installed.
// SCREENSHOTS begins the names of pictures that are left behind.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {copyFileSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {Browser, find_browser} from './browser.mjs';

const [tool, data, screenshots] = process.argv.slice(2);
const executable = find_browser();
const folder = mkdtempSync(join(tmpdir(), 'darboux_page_'));
process.on('exit', () => rmSync(folder, {recursive: true, force: true}));

// A GLB whose mesh is called something else.
function rename(from, to, name) {
  const glb = readFileSync(from), length = glb.readUInt32LE(12);
  const document = JSON.parse(glb.subarray(20, 20 + length));
  for (const mesh of document.meshes) mesh.name = name;
  const bytes = Buffer.from(JSON.stringify(document)), json = Buffer.alloc(Math.ceil(bytes.length / 4) * 4, ' ');
  bytes.copy(json);
  const head = Buffer.from(glb.subarray(0, 20));
  head.writeUInt32LE(20 + json.length + glb.length - 20 - length, 8);
  head.writeUInt32LE(json.length, 12);
  writeFileSync(to, Buffer.concat([head, json, glb.subarray(20 + length)]));
}

// Runs the tool: the page's path, and the JSON.
function assess(files, ...more) {
  const page = join(folder, 'report.html');
  const {status, stdout, stderr} =
    spawnSync(tool, ['validate', '--json', '--report', page, ...more, ...files], {encoding: 'utf8', maxBuffer: 1 << 28});
  assert.ok(status === 0 || status === 1 || status === 2, `status ${status}: ${stderr}`);
  return {url: pathToFileURL(page).href, page, report: JSON.parse(stdout)};
}

// What the page says of each assessment, in the order of the JSON, as a reader sees it.
const shown = `[...document.querySelectorAll('.assessment')].sort((a, b) => a.dataset.number - b.dataset.number).map(section => {
  const words = (from, name) => from.querySelector(name).textContent;
  return {number: Number(section.dataset.number), verdict: section.dataset.verdict, corners: Number(section.dataset.corners),
          findings: [...section.querySelectorAll('.finding')].map(
            f => ['.verdict', 'code', 'b', '.message', '.to-do'].map(name => words(f, name))),
          classes: [...section.querySelectorAll('tr.vertex-class')].map(row => [...row.cells].map(c => c.textContent.trim()))};
})`;
// And of each mesh, in the order of the page.
const shown_meshes = `[...document.querySelectorAll('details.mesh')].map(mesh => ({
  summary: mesh.querySelector('summary').textContent, verdict: mesh.dataset.verdict, codes: mesh.dataset.codes,
  corners: Number(mesh.dataset.corners), hidden: mesh.hidden, open: mesh.open,
  compared: [...mesh.querySelectorAll('rect title')].reduce((sum, t) => sum + parseInt(t.textContent), 0)}))`;

const grade = f => ['info', 'warning', 'error'].indexOf(f.severity);
function expect_same_numbers(sections, report) {
  const meshes = report.files.flatMap(f => f.meshes);
  assert.deepEqual(sections.map(s => s.number), meshes.map((_, i) => i));
  meshes.forEach((mesh, i) => {
    const section = sections[i];
    assert.equal(section.verdict, mesh.verdict);
    assert.equal(section.corners, mesh.corners);
    const worst_first = [...mesh.findings].sort((a, b) => grade(b) - grade(a));
    assert.deepEqual(section.findings, worst_first.map(f => [f.severity, f.code, String(f.count), f.message, f.to_do]));
    const classes = Object.entries(mesh.classes).filter(([, c]) => c.normal_deg || c.tangent_deg || c.bitangent_deg);
    assert.deepEqual(section.classes.map(row => row[0]), classes.map(([name]) => name));
    classes.forEach(([, c], k) => {
      const wanted = [c.corners];
      for (const quantity of ['normal_deg', 'tangent_deg', 'bitangent_deg'])
        for (const statistic of ['max', 'rms', 'p95']) wanted.push(c[quantity] ? c[quantity][statistic] : '–');
      wanted.push(c.worst ? c.worst.vertex : '–');
      // Three digits are shown.
      wanted.forEach((x, column) => {
        const cell = section.classes[k][column + 1], counted = column === 0 || column === wanted.length - 1;
        if (typeof x === 'string') assert.equal(cell, x);
        else assert.equal(Number(cell), counted ? x : Number(x.toPrecision(3)), JSON.stringify(section.classes[k]));
      });
    });
  });
}

// A row for each mesh with all its parts, failures first; its histogram has what was compared.
const order = ['fail', 'undetermined', 'pass', 'nothing'];
function expect_rows(meshes, report) {
  const wanted = new Map();
  for (const f of report.files)
    for (const m of f.meshes) {
      const key = `${f.file} ${m.mesh} ${m.primitive}`, row = wanted.get(key) ?? {corners: 0, verdict: 3, found: new Set()};
      row.corners += m.corners;
      row.verdict = Math.min(row.verdict, order.indexOf(m.verdict));
      for (const finding of m.findings) if (finding.severity !== 'info') row.found.add(finding.code);
      wanted.set(key, row);
    }
  const as_text = rows => rows.map(r => JSON.stringify(r)).sort();
  assert.deepEqual(as_text(meshes.map(m => [m.verdict, m.corners, m.codes.split(' ').filter(c => c).sort()])),
                   as_text([...wanted.values()].map(r => [order[r.verdict], r.corners, [...r.found].sort()])));
  meshes.forEach((mesh, i) => {
    assert.ok(mesh.compared <= mesh.corners);
    assert.ok(mesh.summary.includes(mesh.verdict) && mesh.summary.includes(String(mesh.corners)));
    if (i > 0) assert.ok(order.indexOf(meshes[i - 1].verdict) <= order.indexOf(mesh.verdict), 'failures are not first');
    if (mesh.verdict === 'pass') assert.ok(mesh.compared > 0, 'an empty histogram');
  });
  assert.ok(meshes[0].open, 'the first failure is folded');
}

// Verdicts, codes and orders that a reader chooses.
async function expect_controls(browser) {
  const choose = async (name, value) => {
    await browser.value(`(control => {
      if (control.type === 'checkbox') control.checked = ${JSON.stringify(value)}; else control.value = ${JSON.stringify(value)};
      control.dispatchEvent(new Event('change', {bubbles: true}));
    })(document.querySelector(${JSON.stringify(name)}))`);
    return (await browser.value(shown_meshes)).filter(m => !m.hidden);
  };
  const all = await browser.value(shown_meshes);
  assert.ok(all.every(m => !m.hidden));
  const failing = await choose('.by-verdict[value=pass]', false);
  assert.ok(failing.length > 0 && failing.length < all.length && failing.every(m => m.verdict !== 'pass'));
  assert.match(await browser.value(`document.querySelector('.shown').textContent`), /of \d+ are shown/);
  await choose('.by-verdict[value=pass]', true);
  const code = all.find(m => m.codes).codes.split(' ')[0];
  const found = await choose('.by-code', code);
  assert.deepEqual(found.map(m => m.summary), all.filter(m => m.codes.split(' ').includes(code)).map(m => m.summary));
  await choose('.by-code', '');
  const by_corners = (await choose('.sort', 'corners')).map(m => m.corners);
  assert.deepEqual(by_corners, [...by_corners].sort((a, b) => b - a));
  assert.deepEqual(await choose('.sort', 'verdict'), all);
}

// What a canvas of a section shows: the share of its pixels that are drawn, how many colours, and all of it as a number.
const look = (section, name) => `(() => {
  const canvas = document.querySelectorAll('details.mesh')[${section}].querySelector('canvas.${name}');
  if (!canvas) return null;
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), colours = new Set();
  let drawn = 0, hash = 0;
  for (let i = 0; i < data.length; i += 4) {
    const colour = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
    if (data[i + 3] > 0) { ++drawn; colours.add(colour); hash = hash * 31 + colour * 7 + i | 0; }
  }
  return {share: drawn / (canvas.width * canvas.height), colours: colours.size, hash};
})()`;

async function expect_drawn(browser, section, {uvs, views = true}) {
  await browser.value(`document.querySelectorAll('details.mesh')[${section}].open = true`);
  await browser.value('new Promise(r => setTimeout(r, 100))');
  const uv = await browser.value(look(section, 'uv'));
  assert.equal(uv !== null, uvs);
  if (uv) assert.ok(uv.share > 0.3 && uv.colours > 0, JSON.stringify(uv));
  if (!views) return;
  const view = await browser.value(look(section, 'view'));
  assert.ok(view.share > 0.1 && view.share < 0.95 && view.colours > 8, JSON.stringify(view));
}

async function expect_turning(browser) {
  let before = (await browser.value(look(0, 'view'))).hash;
  const changed = async what => {
    const after = (await browser.value(look(0, 'view'))).hash;
    assert.notEqual(after, before, what + ' changes nothing');
    before = after;
  };
  const first = before;
  await browser.value(`document.querySelector('canvas.view').scrollIntoView({block: 'center'})`);
  const {x, y} = await browser.value(`(({left, top, width, height}) => ({x: left + width / 2, y: top + height / 2}))(
    document.querySelector('canvas.view').getBoundingClientRect())`);
  await browser.mouse('mousePressed', x, y);
  await browser.mouse('mouseMoved', x + 60, y + 20);
  await browser.mouse('mouseReleased', x + 60, y + 20);
  await changed('dragging');
  await browser.mouse('mouseMoved', x, y);
  assert.equal((await browser.value(look(0, 'view'))).hash, before, 'a mouse that is only moved turns it');
  await browser.mouse('mouseWheel', x, y, {deltaX: 0, deltaY: -240, button: 'none'});
  await browser.value('new Promise(r => setTimeout(r, 200))');
  await changed('the wheel');
  for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-']) {
    await browser.key(key);
    await changed(key);
  }
  await browser.key('0');
  await changed('0');
  assert.equal(before, first, '0 does not start again');
}

// On the screen of a phone fingers on the view turn and zoom it, and neither move nor zoom the page, as they do beside it.
async function expect_fingers(browser) {
  await browser.send('Emulation.setDeviceMetricsOverride', {width: 400, height: 800, deviceScaleFactor: 2, mobile: true});
  assert.equal(await browser.value('innerWidth'), 400, 'the page is wider than the screen');
  const view = async () => (await browser.value(look(0, 'view'))).hash;
  const page = () => browser.value('({zoom: visualViewport.scale, left: visualViewport.pageLeft, top: visualViewport.pageTop})');
  const to = name => browser.value(`(canvas => {
    canvas.scrollIntoView({block: 'center'});
    const {left, top, width, height} = canvas.getBoundingClientRect();
    return [Math.round(left + width / 2), Math.round(top + height / 2)];
  })(document.querySelector('canvas.${name}'))`);
  const one = ([x, y]) => [0, 60, 120].map(down => [[x, y + down]]);
  const two = ([x, y], ...distances) => distances.map(d => [[x - d / 2, y], [x + d / 2, y]]);

  await browser.value(`document.querySelector('canvas.view').focus()`);
  await browser.key('0');
  const first = await view();
  for (const key of ['+', '+']) await browser.key(key);
  const larger = await view();
  await browser.key('0');

  const centre = await to('view'), before = await page();
  await browser.touch(...two(centre, 160, 200, 250));
  assert.equal(await view(), larger, 'two fingers 1.25² times as far apart do not do what + + does');
  await browser.touch(...two(centre, 250, 200, 160));
  assert.equal(await view(), first, 'two fingers closer together do not undo it');
  await browser.touch(...one(centre));
  assert.notEqual(await view(), first, 'one finger does not turn it');
  assert.deepEqual(await page(), before, 'fingers on the view change the page');

  // Where this is not so the above says nothing. On a busy machine the browser takes a gesture for another, or for none: it is repeated.
  const in_the_end = async (gesture, condition, otherwise) => {
    for (let k = 0; k < 200; ++k) {
      if (k % 20 == 0) await browser.touch(...gesture(await to('uv')));
      await browser.value('new Promise(r => setTimeout(r, 50))');
      if (condition(await page())) return;
    }
    assert.fail(otherwise);
  };
  await to('uv');
  const still = await page();
  await in_the_end(one, ({top}) => top < still.top, 'a finger beside the view does not move the page');
  await in_the_end(at => two(at, 160, 200, 250), ({zoom}) => zoom > still.zoom,
                   'two fingers beside the view do not zoom the page');
}

// ---- meshes that pass, fail and have parts; without uvs and tangents; names that would be scripts; a file that is none
const evil = `</script><script>document.body.dataset.broken=1</script><img src=x onerror="document.body.dataset.broken=1">'"&`;
mkdirSync(join(folder, 'a<'));
const evil_path = join(folder, 'a<', `script><img src=x onerror=document.body.dataset.broken=1>"'&.glb`);
rename(join(data, 'torus_016.three.glb'), evil_path, evil);
copyFileSync(join(data, 'sphere_016.obj'), join(folder, 'sphere.obj'));
writeFileSync(join(folder, 'none.glb'), 'glTF, but no more');
const many = assess([...['torus_016.three.glb', 'plainsphere_016.three.glb', 'mirrortorus_016.mikk.glb'].map(f => join(data, f)),
                    evil_path, join(folder, 'sphere.obj'), join(folder, 'none.glb')]);
const source = readFileSync(many.page, 'utf8');
assert.ok(!/(src|href)="?(https?:)?\/\//.test(source), 'the page names something outside itself');

let browser = new Browser(executable);
try {
  await browser.open(many.url);
  assert.equal(await browser.value('document.body.dataset.ready'), 'yes');
  assert.match(await browser.value('document.title'), /^fail: 6 files/);
  const sections = await browser.value(shown);
  expect_same_numbers(sections, many.report);
  const meshes = await browser.value(shown_meshes);
  expect_rows(meshes, many.report);
  await expect_controls(browser);
  const page_text = await browser.value('document.body.textContent');
  assert.ok(page_text.includes(evil), 'the name is not shown as it is');
  assert.ok(page_text.includes(evil_path) && page_text.includes('none.glb'));
  for (let i = 0; i < meshes.length; ++i) await expect_drawn(browser, i, {uvs: true});
  assert.deepEqual(browser.complaints(), []);
  assert.equal(await browser.value('document.body.dataset.broken'), undefined);
  if (screenshots) await browser.screenshot(screenshots + 'many.png');
  // On a phone nothing but tables of numbers, which scroll by themselves, is wider than the screen.
  await browser.send('Emulation.setDeviceMetricsOverride', {width: 400, height: 800, deviceScaleFactor: 1, mobile: false});
  assert.deepEqual(await browser.value(`[...document.querySelectorAll('main *')].filter(
    e => !e.closest('.scroll') && e.getBoundingClientRect().right > 400).map(e => e.outerHTML.slice(0, 100))`), []);
  if (screenshots) await browser.screenshot(screenshots + 'narrow.png');
  await browser.send('Emulation.clearDeviceMetricsOverride');
  // Even markup that came through would not run.
  await browser.value(`document.body.insertAdjacentHTML('beforeend', '<img src=x onerror="document.body.dataset.broken=1">')`);
  await browser.value('new Promise(r => setTimeout(r, 300))');
  assert.equal(await browser.value('document.body.dataset.broken'), undefined, 'the policy lets scripts run');

  // ---- one mesh, in the light and in the dark
  const one = assess([join(data, 'sphere_016.three.glb')], '--max-angle', '2');
  await browser.open(one.url);
  await expect_drawn(browser, 0, {uvs: true});
  await expect_turning(browser);
  expect_same_numbers(await browser.value(shown), one.report);
  const background = 'getComputedStyle(document.body).backgroundColor';
  const light = await browser.value(background);
  if (screenshots) await browser.screenshot(screenshots + 'light.png');
  await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: 'dark'}]});
  assert.notEqual(await browser.value(background), light);
  if (screenshots) await browser.screenshot(screenshots + 'dark.png');
  await expect_fingers(browser);
  assert.deepEqual(browser.complaints(), []);
} finally {
  await browser.close();
}

// ---- without WebGL the uvs are drawn, and a line says why the mesh is not
browser = new Browser(executable, ['--disable-3d-apis']);
try {
  await browser.open(assess([join(data, 'torus_016.three.glb')]).url);
  await expect_drawn(browser, 0, {uvs: true, views: false});
  assert.equal(await browser.value(`document.querySelector('.no-webgl').hidden`), false);
  assert.equal(await browser.value('document.body.dataset.error'), undefined);
} finally {
  await browser.close();
}
console.log('passed');
