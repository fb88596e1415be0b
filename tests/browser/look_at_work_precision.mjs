// node look_at_work_precision.mjs TOOL [FOLDER]: runs `TOOL work-precision`, opens its page in headless chromium and asserts that the front is
// drawn, that other metrics and another surface can be chosen, that tables are sorted, and what report_page.mjs does. Screenshots go to
// FOLDER. Exit status 77: no chromium.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {find_browser} from './browser.mjs';
import {look_at} from './report_page.mjs';

const [tool, folder] = process.argv.slice(2);
const executable = find_browser();
const work = mkdtempSync(join(tmpdir(), 'darboux_work_precision_'));
const page = join(work, 'page.html');
let failed = 0;
const check = (good, what) => { if (!good) ++failed, console.log('FAILED: ' + what); };

const {status, stderr, stdout} = spawnSync(
    tool, ['work-precision', 'sphere', 'torus', '--rounds', '3', '--resolutions', '8,16', '--json', '-o', page],
    {encoding: 'utf8', maxBuffer: 1 << 28});
check(status === 0, 'status ' + status + ': ' + stderr);
const document = JSON.parse(stdout);
const of_sphere = document.samples.filter(s => s.surface.startsWith('sphere') && s.domain === 'evaluation');
check(statSync(page).size < 3e6, 'the page has ' + statSync(page).size + ' bytes');

await look_at(executable, page, {charts: 1, folder, title: 'work-precision', check, look: async (browser, name, ok) => {
  ok(await browser.value('document.getElementById("group").options.length') === 4, 'not 2 surfaces at points and on meshes');
  ok(+await browser.value('document.body.dataset.points') === of_sphere.length, 'not ' + of_sphere.length + ' methods');
  ok(+await browser.value('document.body.dataset.front') === of_sphere.filter(s => s.on_front).length, 'another front');
  const choose = (id, value) => browser.value(`(() => { const s = document.getElementById("${id}"); ${value};
      s.dispatchEvent(new Event("change")); })()`);
  await choose('y', 's.value = "partials_max"');
  ok((await browser.value('document.getElementById("plot").ariaLabel')).includes('partials'), 'another metric is not drawn');
  await choose('x', 's.value = "position_max"');
  ok((await browser.value('document.getElementById("what").textContent')).includes('error of the position'), 'the title is of other axes');
  await choose('group', 's.selectedIndex = 3');
  const on_meshes = document.samples.filter(s => s.surface.startsWith('torus') && s.domain === 'meshes').length;
  ok(+await browser.value('document.body.dataset.points') === on_meshes, 'not ' + on_meshes + ' measurements on meshes');
  ok(await browser.value('document.querySelectorAll("#table tbody tr").length') === on_meshes, 'the table lacks some');
  await browser.value('[...document.querySelectorAll("table.adopt .sort")].find(b => b.textContent === "method").click()');
  const names = await browser.value('[...document.querySelectorAll("table.adopt tbody tr")].map(r => r.cells[1].textContent)');
  ok(names.length > 3 && names.every((n, i) => i === 0 || names[i - 1].localeCompare(n) <= 0), 'fronts are not sorted by method');
}});
rmSync(work, {recursive: true});
console.log(failed ? failed + ' failed' : 'passed');
process.exit(failed ? 1 : 0);
