// SPDX-License-Identifier: MIT
// A finished session in a browser: served by `thermorig view`, and as the one file of `inspect --html`.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, describe, test } from 'node:test';
import { imagePixels, launch, openTab, screenshot, textOf, until } from './browser.mjs';
import { programPath, whyNot } from './program.mjs';

/** What h5py says of a frame: another reader than the program's. */
function frameOf(session, frame) {
  const script = `
import h5py, json, sys
with h5py.File(sys.argv[1]) as file:
    i = int(sys.argv[2])
    samples, camera = file["samples"], file["camera"]
    names = samples["reason_bits"].attrs["flag_meanings"].split()
    masks = samples["reason_bits"].attrs["flag_masks"]
    bits = int(samples["reason_bits"][i])
    image = camera["temperature"][i]
    if file["rig/profile/camera"].attrs["mirrored"]: image = image[:, ::-1]
    print(json.dumps({"commanded": None if samples["rate_commanded"][i] != samples["rate_commanded"][i] else float(samples["rate_commanded"][i]), "time": float(samples["time"][i]), "frames": len(samples["time"]),
        "valid": bool(samples["valid"][i]), "reasons": [name for name, mask in zip(names, masks) if bits & int(mask)],
        "image": [float(value) for value in image.ravel()]}))
`;
  const { stdout, stderr, status } = spawnSync('/usr/bin/python3', ['-c', script, session, String(frame)], { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return JSON.parse(stdout);
}

/** How well the brightness of the image follows the temperatures: 1 if one grows with the other in all pixels. */
function likeness(pixels, temperatures) {
  const bright = temperatures.map((unused, i) => pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2]);
  const ranks = (values) => {
    const order = values.map((value, i) => [value, i]).sort((a, b) => a[0] - b[0]);
    const rank = new Array(values.length);
    order.forEach(([, i], place) => { rank[i] = place; });
    return rank;
  };
  const [a, b] = [ranks(bright), ranks(temperatures)];
  const mean = (a.length - 1) / 2;
  const sum = (f) => a.reduce((total, unused, i) => total + f(a[i] - mean, b[i] - mean), 0);
  return sum((x, y) => x * y) / sum((x) => x * x);
}

const shownFrame = (tab) => tab.evaluate(() => Number(document.getElementById('frame').dataset.frame));
const opened = (tab) => until(() => tab.evaluate(() => document.documentElement.dataset.opened !== undefined), 'the session is open', 20_000);

async function goTo(tab, what) {
  await tab.keyboard.press('g');
  await tab.keyboard.type(String(what));
  await tab.keyboard.press('Enter');
}

describe('a session', { skip: whyNot() || false }, () => {
  let browser;
  let folder;
  let session;
  let page;
  let served;

  function run(...words) {
    const { stderr, stdout, status } = spawnSync(programPath, words, { cwd: folder, encoding: 'utf8', timeout: 120_000, env: { ...process.env, XDG_STATE_HOME: folder } });
    assert.equal(status, 0, stderr + stdout);
    return stdout;
  }

  /** The address of `thermorig view`; it says it to nobody but a terminal. */
  async function serve() {
    const words = ['view', '--page-port', '0', session].map((word) => `'${word}'`).join(' ');
    served = spawn('script', ['-qec', `${programPath} ${words}`, '/dev/null'], { cwd: folder, env: { ...process.env, XDG_STATE_HOME: folder }, detached: true });
    let said = '';
    served.stdout.on('data', (part) => { said += part; });
    const find = () => /http:\/\/127\.0\.0\.1:\d+\/#t=[0-9a-f]{32}/.exec(said);
    await until(find, 'the program prints its address', 20_000);
    return find()[0];
  }

  before(async () => {
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), 'thermorig-session-'));
    run('live', '--record', '--simulated=4', '--fast', '--plan', 'paper', '--environment', 'garden', '--no-preflight', '-o', 'kept');
    session = join(folder, 'kept/garden', readdirSync(join(folder, 'kept/garden')).find((name) => name.endsWith('.h5')));
    page = join(folder, 'look.html');
    run('inspect', '--html', page, session);
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });
  afterEach(() => {
    if (served !== undefined) process.kill(-served.pid, 'SIGKILL');
    served = undefined;
  });

  /** The same is asked of both. */
  async function looksRight(tab, troubles, name) {
    await opened(tab);
    const frames = [0, 840, 1680];  // every n-th has an image in the file
    for (const frame of frames) {
      const known = frameOf(session, frame);
      await goTo(tab, frame);
      await until(async () => await shownFrame(tab) === frame, `frame ${frame} is shown`);
      await until(async () => likeness(await imagePixels(tab), known.image) > 0.9, `the image is that of frame ${frame}`);
      assert.equal(await textOf(tab, '#validity'), known.valid ? '✓ valid' : '▲ not valid');
      const reasons = (await textOf(tab, '#reasons')).split(', ').filter((word) => word !== '');
      assert.deepEqual(reasons, known.reasons.map((word) => word.replaceAll('_', ' ')));
      if (Number.isFinite(known.commanded)) {
        const text = await tab.locator('#lines tbody tr').filter({ hasText: 'commanded' }).first().locator('td.n').first().textContent();
        assert.ok(Math.abs(Number(text.replace('−', '-').replace(',', '')) - known.commanded) < 0.051, `${text} is not ${known.commanded}`);
      }
    }
    assert.match(await textOf(tab, '#simulated'), /SIMULATED/);
    assert.equal(await tab.locator('#simulated').isVisible(), true);
    await screenshot(tab, name);
    assert.deepEqual(troubles, []);
  }

  test('served by view shows each frame with its image, label and reasons', async () => {
    const url = await serve();
    const { tab, troubles, close } = await openTab(browser);
    await tab.goto(url);
    await looksRight(tab, troubles, 'session');
    await close();
  });

  test('in one file shows the same, takes less than 5 MB and asks nobody', async () => {
    assert.ok(statSync(page).size < 5_000_000);
    const { tab, troubles, close } = await openTab(browser);
    const asked = [];
    const listener = (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); };
    tab.on('request', listener);
    await tab.goto(`file://${page}`);
    await looksRight(tab, troubles, 'session_file');
    assert.deepEqual(asked, []);
    tab.off('request', listener);
    await close();
  });

  test('is walked through by keys, zoomed, and gone to by time', async () => {
    const { tab, close } = await openTab(browser);
    await tab.goto(`file://${page}`);
    await opened(tab);
    const first = await shownFrame(tab);
    assert.ok(frameOf(session, first).valid && !frameOf(session, first - 1).valid, 'it opens on the first valid frame');
    const last = frameOf(session, 0).frames - 1;
    await tab.keyboard.press('End');
    assert.equal(await shownFrame(tab), last);
    await tab.keyboard.press('ArrowLeft');
    assert.equal(await shownFrame(tab), last - 1);
    await tab.keyboard.press('Home');
    await tab.keyboard.press('Shift+ArrowRight');
    const second = frameOf(session, await shownFrame(tab)).time - frameOf(session, 0).time;
    assert.ok(Math.abs(second - 1) < 0.1, `Shift goes a second on, not ${second}`);
    await tab.keyboard.press('n');
    const change = await shownFrame(tab);
    assert.notEqual(frameOf(session, change).valid, frameOf(session, change - 1).valid);
    const whole = await textOf(tab, '#window');
    await tab.keyboard.press('+');
    await until(async () => await textOf(tab, '#window') !== whole, 'the plots show less');
    await tab.keyboard.press('0');
    await until(async () => await textOf(tab, '#window') === whole, 'the plots show all');
    await goTo(tab, '1:00');
    const there = frameOf(session, await shownFrame(tab));
    assert.ok(Math.abs(there.time - 60) < 0.2, `the minute is at ${there.time}`);
    await goTo(tab, 'nonsense');
    assert.match(await textOf(tab, '#goto-trouble'), /a frame \(1200\) or a time/);
    await close();
  });

  test('plays on, and Space stops it', async () => {
    const { tab, close } = await openTab(browser);
    await tab.goto(`file://${page}`);
    await opened(tab);
    await tab.keyboard.press('Space');
    await until(async () => await shownFrame(tab) > 5, 'frames pass');
    await tab.keyboard.press('Space');
    const stopped = await shownFrame(tab);
    await new Promise((done) => setTimeout(done, 400));
    assert.equal(await shownFrame(tab), stopped);
    await close();
  });

  test('is shown to nobody without the token', async () => {
    const url = new URL(await serve());
    for (const name of ['facts', 'rows', 'images/0']) {
      assert.equal((await fetch(new URL(`/data/${name}`, url))).status, 401);
      assert.equal((await fetch(new URL(`/data/${name}`, url), { headers: { Authorization: `Bearer ${'0'.repeat(32)}` } })).status, 401);
      const token = url.hash.slice(3);
      assert.equal((await fetch(new URL(`/data/${name}`, url), { headers: { Authorization: `Bearer ${token}` } })).status, 200);
    }
  });
});
