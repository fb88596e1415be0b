// A headless chromium, spoken to over a pipe by its DevTools protocol.
import {spawn, spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export function find_browser() {
  for (const name of ['chromium', 'chromium-browser'])
    if (spawnSync(name, ['--version']).status === 0) return name;
  console.log('SKIPPED: chromium not found');
  process.exit(77);
}

export class Browser {
  /// \param flags more of chromium's
  constructor(executable, flags = []) {
    this.profile = mkdtempSync(join(tmpdir(), 'darboux_browser_'));
    this.process = spawn(executable, [
      '--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--window-size=1280,1500', `--user-data-dir=${this.profile}`, '--remote-debugging-pipe', ...flags, 'about:blank'],
      {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    this.waiting = new Map();
    this.events = [];  // all, in order
    this.last = 0;
    let text = '';
    this.process.stdio[4].setEncoding('utf8').on('data', piece => {
      const messages = (text + piece).split('\0');
      text = messages.pop();
      for (const message of messages.map(m => JSON.parse(m))) {
        if (message.id === undefined) { this.events.push(message); continue; }
        const {resolve, reject} = this.waiting.get(message.id);
        this.waiting.delete(message.id);
        if (message.error) reject(new Error(JSON.stringify(message.error))); else resolve(message.result);
      }
    });
  }

  send(method, params = {}) {
    const id = ++this.last;
    this.process.stdio[3].write(JSON.stringify({id, method, params, sessionId: this.session}) + '\0');
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }

  /// Opens a page and waits until it is loaded.
  async open(url) {
    this.session = undefined;
    if (this.target) await this.send('Target.closeTarget', {targetId: this.target});
    const {targetId} = await this.send('Target.createTarget', {url: 'about:blank'});
    this.target = targetId;
    this.session = (await this.send('Target.attachToTarget', {targetId, flatten: true})).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await this.send(domain + '.enable');
    this.events.length = 0;
    await this.send('Page.navigate', {url});
    while (!this.events.some(e => e.method === 'Page.loadEventFired')) await new Promise(r => setTimeout(r, 50));
  }

  /// The value of an expression in the page.
  async value(expression) {
    const {result, exceptionDetails} =
      await this.send('Runtime.evaluate', {expression, returnByValue: true, awaitPromise: true});
    if (exceptionDetails) throw new Error(expression + ': ' + JSON.stringify(exceptionDetails));
    return result.value;
  }

  /// What went wrong in the page, and what it asked of others than itself.
  complaints() {
    return this.events.flatMap(({method, params}) =>
      method === 'Runtime.exceptionThrown' ? [params.exceptionDetails.exception?.description ?? params.exceptionDetails.text]
      : method === 'Log.entryAdded' && params.entry.level === 'error' ? [params.entry.text]
      : method === 'Network.requestWillBeSent' && !/^(file|data):/.test(params.request.url) ? ['asks for ' + params.request.url]
      : []);
  }

  async key(key) {
    for (const type of ['keyDown', 'keyUp']) await this.send('Input.dispatchKeyEvent', {type, key});
  }
  async mouse(type, x, y, more = {}) {
    await this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', clickCount: 1, ...more});
  }
  /// Fingers that go down at the first of `places`, each a list of one [x, y] a finger, are moved to the others, and go up.
  async touch(...places) {
    const points = fingers => fingers.map(([x, y], id) => ({x, y, id}));
    await this.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 5});
    for (const [k, fingers] of places.entries())
      await this.send('Input.dispatchTouchEvent', {type: k === 0 ? 'touchStart' : 'touchMove', touchPoints: points(fingers)});
    await this.send('Input.dispatchTouchEvent', {type: 'touchEnd', touchPoints: []});
    await this.value('new Promise(r => setTimeout(r, 200))');
  }

  async screenshot(path) {
    const {cssContentSize: size} = await this.send('Page.getLayoutMetrics');
    const {data} = await this.send('Page.captureScreenshot', {captureBeyondViewport: true,
      clip: {x: 0, y: 0, width: size.width, height: Math.min(size.height, 12000), scale: 1}});
    writeFileSync(path, Buffer.from(data, 'base64'));
  }

  // Its helpers write to the profile for a moment after it has ended.
  close() {
    const gone = new Promise(resolve => this.process.once('exit', resolve));
    this.session = undefined;
    this.send('Browser.close');
    return gone.then(() => rmSync(this.profile, {recursive: true, force: true, maxRetries: 100, retryDelay: 100}));
  }
}
