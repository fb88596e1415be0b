// What the tests of the report commands' pages share.
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {Browser} from './browser.mjs';

/// Opens a page in headless chromium: wide and light, dark, 400 px wide, printed. Asserts what holds of all report pages: pictures are
/// drawn, no script fails, nothing outside the page is named, it does not scroll sideways, what is drawn is offered as SVG and CSV,
/// arrow keys go from point to point, the end says how it was made. Then calls look(browser, name, value). Screenshots go to `folder`.
export async function look_at(executable, page, {charts, folder, title, look, check}) {
  const browser = new Browser(executable);
  for (const [name, width, scheme, media] of
       [['wide', 1280, 'light', ''], ['dark', 1280, 'dark', ''], ['narrow', 400, 'light', ''], ['print', 800, 'dark', 'print']]) {
    const value = expression => browser.value(expression), ok = (good, what) => check(good, name + ': ' + what);
    await browser.open('file://' + page);
    await browser.send('Emulation.setEmulatedMedia', {media, features: [{name: 'prefers-color-scheme', value: scheme}]});
    await browser.send('Emulation.setDeviceMetricsOverride', {width, height: 1500, deviceScaleFactor: 1, mobile: false});
    await value('new Promise(r => setTimeout(r, 300))');
    ok(await value('document.body.dataset.charts') === String(charts), 'not ' + charts + ' pictures are drawn');
    const light = await value('getComputedStyle(document.body).backgroundColor').then(c => /\((\d+)/.exec(c)[1] > 128);
    ok(light === (name !== 'dark'), 'the page is ' + (light ? 'light' : 'dark'));
    ok(await value('document.documentElement.scrollWidth <= innerWidth'), 'it scrolls sideways');
    if (folder) await browser.screenshot(join(folder, title + '-' + name + '.png'));
    if (name === 'wide') {
      await value(`(() => { window.saved = []; URL.createObjectURL = blob => { saved.push(blob); return 'data:,'; };
        HTMLAnchorElement.prototype.click = () => {}; })()`);
      await value('document.querySelectorAll("figure .tool").forEach(b => b.click())');
      const texts = await value('Promise.all(saved.map(b => b.text()))');
      ok(texts.length === 2 * charts, 'not SVG and CSV of each picture are offered');
      for (const [i, text] of texts.entries()) {
        if (i % 2 === 0) {
          const error = await value(`(() => { const d = new DOMParser().parseFromString(${JSON.stringify(text)}, 'image/svg+xml');
            return d.querySelector('parsererror')?.textContent || d.querySelectorAll('path').length < 20 && 'few paths' || '' })()`);
          ok(error === '', 'an SVG is broken: ' + error);
          ok(!/NaN|undefined/.test(text), 'an SVG has a number that is none');
        } else {
          ok(text.startsWith('line,') && text.split('\r\n').length > 3 && !/NaN|undefined/.test(text), 'a CSV is broken: ' + text.slice(0, 200));
        }
      }
      await value('document.querySelector(".plot canvas").focus()');
      await browser.key('ArrowRight');
      ok(await value('Chart.getChart(document.querySelector(".plot canvas")).tooltip.opacity') === 1, 'an arrow key shows no value');
    }
    await look(browser, name, ok);
    for (const complaint of browser.complaints()) check(false, name + ': ' + complaint);
    ok(await value('document.body.dataset.error === undefined'), 'a script failed: ' + await value('document.body.dataset.error'));
  }
  await browser.close();
  const html = readFileSync(page, 'utf8');
  check(!/<(script|link|img|iframe)[^>]*(src|href)="?(https?:)?\/\//.test(html), 'the page needs a network');
  for (const part of ['<dt>Machine', '<dt>Compiler', '<dt>Date', '<dt>Darboux', '<dt>Seed', '<dt>Again', '<dt>Cite'])
    check(html.includes(part), 'the page does not say ' + part);
}
