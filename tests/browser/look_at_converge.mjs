// node look_at_converge.mjs TOOL [FOLDER]: runs `TOOL converge`, opens its page in headless chromium and asserts that the pictures have
// their lines, random meshes and interior vertices first, that the map has a cell per study of the tangents, that a click on a cell or on a
// verdict chooses its curve, that the table is sorted and filtered, and what report_page.mjs does. Exit status 77: no chromium.
import {spawnSync} from 'node:child_process';
import {mkdirSync, mkdtempSync, readFileSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {find_browser} from './browser.mjs';
import {look_at} from './report_page.mjs';

const [tool, folder] = process.argv.slice(2);
const executable = find_browser();
const work = mkdtempSync(join(tmpdir(), 'darboux_converge_'));
let failed = 0;
const check = (good, what) => { if (!good) ++failed, console.log('FAILED: ' + what); };

// A folder with what HTML and the shell give a meaning to: it comes back in the page's command line.
const awkward = join(work, 'it\'s <b>&"$here"');
mkdirSync(awkward);
const page = join(awkward, 'report.html');
const methods = ['face', 'average', 'angle', 'cubic'];
const {status, stderr, stdout} = spawnSync(
  tool, ['converge', '--surfaces', 'torus:major_radius=1,minor_radius=0.4', '--surfaces', 'sphere;cylinder', '--methods', methods.join(','),
         '--meshes', 'regular,jittered,sheared', '--resolutions', '4..32', '--v-range', '0.2,0.8', '--seed', '7', '-o', page, '--json'],
  {encoding: 'utf8', maxBuffer: 1 << 28});
check(status <= 1, 'status ' + status + ': ' + stderr);
const {studies} = JSON.parse(stdout);
check(statSync(page).size < 3e6, 'the page has ' + statSync(page).size + ' bytes');
const html = readFileSync(page, 'utf8');
check(html.includes('&lt;b&gt;&amp;') && !html.includes('<b>&'), 'the command line is not escaped');
const torus = studies.filter(s => s.surface.startsWith('torus') && s.quantity === 'tangent');

await look_at(executable, page, {charts: 2, folder, title: 'converge', check, look: async (browser, name, ok) => {
  const value = expression => browser.value(expression);
  const selected = async () => [await value('mesh.value'), await value('document.getElementById("class").value'), await value('quantity.value')].join(' ');
  ok(await selected() === 'jittered interior tangent', 'first is shown ' + await selected());
  const drawn = torus.filter(s => s.mesh === 'jittered' && s.class === 'interior' && s.order !== null).length;
  ok(+await value('document.body.dataset.lines') === drawn, 'not ' + drawn + ' lines are drawn');
  ok(await value('document.querySelectorAll("#legend label").length') === methods.length, 'the legend lacks a method');
  ok(await value('document.querySelectorAll("#map button").length') === torus.length, 'not ' + torus.length + ' cells in the map');
  ok(await value('document.querySelector("#map thead tr").innerText').then(t => t.trim().startsWith('jittered')), 'jittered is not first');
  const choose = (id, text) => value(`(() => { const s = document.getElementById("${id}"); s.value = ${JSON.stringify(text)};
    s.dispatchEvent(new Event("change")); })()`);
  await choose('mesh', 'regular');
  ok((await value('document.getElementById("at-floor").textContent')).includes('angle'), 'it is not said that angle is at the floor');
  // All studies, the highest order first, then those of one method; from a verdict to its curve.
  await value('document.getElementById("only").click()');
  ok(+await value('studies.dataset.rows') === studies.length, 'not ' + studies.length + ' rows');
  const sort = '[...document.querySelectorAll("#studies .sort")].find(b => b.textContent === "order").click()';
  await value(sort);
  await value(sort);
  const top = Math.max(...studies.map(s => s.order ?? -9));
  ok(Math.abs(+await value('document.querySelector("#studies tbody tr").cells[6].textContent') - top) < 0.006, 'sorted by order the first has not ' + top);
  await value('(f => { f.value = "cubic seam cylinder"; f.dispatchEvent(new Event("input")); })(document.getElementById("find"))');
  const found = studies.filter(s => s.method === 'cubic' && s.class === 'seam' && s.surface.startsWith('cylinder')).length;
  ok(found > 0 && +await value('studies.dataset.rows') === found, 'not ' + found + ' rows are found');
  await value('document.querySelector("#studies tbody .verdict").click()');
  ok((await value('surface.value')).startsWith('cylinder') && (await selected()).includes('seam'), 'a verdict does not lead to its curve');
  ok(await value('document.querySelectorAll("#map td.chosen").length') === 1, 'the chosen cell is not marked');
  await value('document.querySelectorAll("#map button")[1].click()');
  ok(!(await selected()).startsWith('regular seam'), 'a cell of the map does not lead to its curve');
}});
rmSync(work, {recursive: true});
console.log(failed ? failed + ' failed' : 'passed');
process.exit(failed ? 1 : 0);
