// node look_at_stability.mjs TOOL [FOLDER]: runs `TOOL stability`, opens its page in headless chromium and asserts that a click on the map
// chooses its curves, that the legend hides some, and what report_page.mjs does. Screenshots go to FOLDER. Exit status 77: no chromium.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {find_browser} from './browser.mjs';
import {look_at} from './report_page.mjs';

const [tool, folder] = process.argv.slice(2);
const executable = find_browser();
const work = mkdtempSync(join(tmpdir(), 'darboux_stability_'));
const page = join(work, 'page.html');
let failed = 0;
const check = (good, what) => { if (!good) ++failed, console.log('FAILED: ' + what); };

const surfaces = ['sphere', 'torus', 'bezier-patch'];
const {status, stderr, stdout} = spawnSync(tool, ['stability', ...surfaces, '--points', '8', '--samples', '1', '--json', '-o', page],
                                           {encoding: 'utf8', maxBuffer: 1 << 28});
check(status === 0, 'status ' + status + ': ' + stderr);
const document = JSON.parse(stdout);
const cells = new Set(document.curves.filter(c => c.route === 'double' || /^(mesh|fitted)/.test(c.quantity)).map(c => c.surface + ' ' + c.sweep)).size;
check(statSync(page).size < 3e6, 'the page has ' + statSync(page).size + ' bytes');

await look_at(executable, page, {charts: 1, folder, title: 'stability', check, look: async (browser, name, ok) => {
  ok(await browser.value('document.querySelectorAll("#map button").length') === cells, 'not ' + cells + ' cells');
  if (name !== 'narrow')
    ok(await browser.value('(s => s.scrollWidth <= s.clientWidth)(document.querySelector("#map").parentElement)'), 'the map is cut off');
  const offered = await browser.value('document.getElementById("surface").options.length');
  ok(offered === surfaces.length, offered + ' surfaces are offered');
  await browser.value('document.querySelector("#map button[data-surface^=torus][data-sweep=turns]").click()');
  ok(await browser.value('document.getElementById("sweep").value') === 'turns', 'a click does not choose the sweep');
  ok((await browser.value('document.getElementById("surface").value')).startsWith('torus'), 'nor the surface');
  const lines = +await browser.value('document.body.dataset.lines');
  ok(lines >= 9, 'too few lines');
  await browser.value('document.querySelector("#legend input").click()');
  ok(+await browser.value('document.body.dataset.lines') < lines, 'the legend hides no line');
}});
rmSync(work, {recursive: true});
console.log(failed ? failed + ' failed' : 'passed');
process.exit(failed ? 1 : 0);
