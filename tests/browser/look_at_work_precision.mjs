// node look_at_work_precision.mjs TOOL [FOLDER]: runs `TOOL work-precision`, opens its page in headless chromium, light and dark,
// wide and at 400 px, and asserts that the picture is drawn with its front, that other metrics and another surface can be chosen, that
// no script failed, that the page names nothing outside itself and does not scroll sideways. Screenshots go to FOLDER. Exit status 77:
// no chromium.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Browser, find_browser} from './browser.mjs';

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

for (const [name, width, dark] of [['wide', 1280, false], ['dark', 1280, true], ['narrow', 400, false]]) {
  const browser = new Browser(executable);
  await browser.open('file://' + page);
  await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: dark ? 'dark' : 'light'}]});
  await browser.send('Emulation.setDeviceMetricsOverride', {width, height: 1500, deviceScaleFactor: 1, mobile: false});
  await browser.value('new Promise(r => setTimeout(r, 300))');
  check(await browser.value('document.body.dataset.charts') === '1', name + ': the picture is not drawn');
  check(await browser.value('document.getElementById("group").options.length') === 4, name + ': not 2 surfaces at points and on meshes');
  check(+await browser.value('document.body.dataset.points') === of_sphere.length, name + ': not ' + of_sphere.length + ' methods');
  check(+await browser.value('document.body.dataset.front') === of_sphere.filter(s => s.on_front).length, name + ': another front');
  if (folder) await browser.screenshot(join(folder, 'work-precision-' + name + '.png'));
  const choose = (id, value) => browser.value(`(() => { const s = document.getElementById("${id}"); ${value};
      s.dispatchEvent(new Event("change")); })()`);
  await choose('y', 's.value = "partials_max"');
  check((await browser.value('document.getElementById("plot").ariaLabel')).includes('partials'), name + ': another metric is not drawn');
  await choose('group', 's.selectedIndex = 3');
  const on_meshes = document.samples.filter(s => s.surface.startsWith('torus') && s.domain === 'meshes').length;
  check(+await browser.value('document.body.dataset.points') === on_meshes, name + ': not ' + on_meshes + ' measurements on meshes');
  check(await browser.value('document.querySelectorAll("#table tbody tr").length') === on_meshes, name + ': the table lacks some');
  check(await browser.value('document.documentElement.scrollWidth <= innerWidth'), name + ': it scrolls sideways');
  if (folder) await browser.screenshot(join(folder, 'work-precision-' + name + '-meshes.png'));
  for (const complaint of browser.complaints()) check(false, name + ': ' + complaint);
  await browser.close();
}
check(!/<(script|link|img|iframe)[^>]*(src|href)="?(https?:)?\/\//.test(readFileSync(page, 'utf8')), 'the page needs a network');
rmSync(work, {recursive: true});
console.log(failed ? failed + ' failed' : 'passed');
process.exit(failed ? 1 : 0);
