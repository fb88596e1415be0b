// node look_at_stability.mjs TOOL [FOLDER]: runs `TOOL stability`, opens its page in headless chromium, light and dark, wide
// and at 400 px, and asserts that the picture is drawn, that a click on the table chooses its curves, that no script failed, that
// the page names nothing outside itself and does not scroll sideways. Screenshots go to FOLDER. Exit status 77: no chromium.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Browser, find_browser} from './browser.mjs';

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

for (const [name, width, dark] of [['wide', 1280, false], ['dark', 1280, true], ['narrow', 400, false]]) {
  const browser = new Browser(executable);
  await browser.open('file://' + page);
  await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: dark ? 'dark' : 'light'}]});
  await browser.send('Emulation.setDeviceMetricsOverride', {width, height: 1500, deviceScaleFactor: 1, mobile: false});
  await browser.value('new Promise(r => setTimeout(r, 300))');
  check(await browser.value('document.body.dataset.charts') === '1', name + ': the picture is not drawn');
  check(await browser.value('document.querySelectorAll("#map button").length') === cells, name + ': not ' + cells + ' cells');
  const offered = await browser.value('document.getElementById("surface").options.length');
  check(offered === surfaces.length, name + ': ' + offered + ' surfaces are offered');
  await browser.value('document.querySelector("#map button[data-surface^=torus][data-sweep=turns]").click()');
  check(await browser.value('document.getElementById("sweep").value') === 'turns', name + ': a click does not choose the sweep');
  check((await browser.value('document.getElementById("surface").value')).startsWith('torus'), name + ': nor the surface');
  check(await browser.value('+document.body.dataset.lines') >= 9, name + ': too few lines');
  check(await browser.value('document.documentElement.scrollWidth <= innerWidth'), name + ': it scrolls sideways');
  for (const complaint of browser.complaints()) check(false, name + ': ' + complaint);
  if (folder) await browser.screenshot(join(folder, 'stability-' + name + '.png'));
  await browser.close();
}
check(!/<(script|link|img|iframe)[^>]*(src|href)="?(https?:)?\/\//.test(readFileSync(page, 'utf8')), 'the page needs a network');
rmSync(work, {recursive: true});
console.log(failed ? failed + ' failed' : 'passed');
process.exit(failed ? 1 : 0);
