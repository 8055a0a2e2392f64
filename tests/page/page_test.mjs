// SPDX-License-Identifier: MIT
// The page on synthetic messages.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, describe, test } from 'node:test';
import { filesFolder, imagePixels, launch, openTab, screenshot, stripData, textOf, until, untilOnItsClock } from './browser.mjs';
import { FakeServer, token } from './fake_server.mjs';
import { estimators, event, frame, hello, image, period, span, state, surroundings } from './synthetic_run.mjs';

const strips = ['rate', 'error', 'angle', 'gain'];
const five = estimators(5).map(({ name }) => name);
const known = (column) => column.filter((value) => value !== null && value !== undefined);
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

let browser;
let server;
let open = [];

/** A tab on the fake server's page, after `messages` have been shown. */
async function page(messages, options = {}) {
  server.greeting = messages;
  const opened = await openTab(browser, options);
  open.push(opened);
  await opened.tab.goto(options.url ?? server.url);
  if (messages.length > 0) await until(() => server.streams.size > 0, 'the page opens its stream');
  return opened;
}

/** Waits until frame `index` stands in the table of numbers: then everything before it has been drawn. */
const shown = (tab, index) => until(() => tab.evaluate((wanted) => document.getElementById('numbers').dataset.index === String(wanted), index), `frame ${index} is shown`);

const hidden = (tab, id) => tab.evaluate((name) => document.getElementById(name).hidden, id);
/** A cell of the table of estimators. */
const cellOf = (tab, name, figure) => tab.locator(`#numbers td[data-estimator="${name}"][data-figure="${figure}"]`);
const valueOf = (tab, name, figure) => cellOf(tab, name, figure).locator('.value').textContent();
const rowOf = (tab, name) => tab.locator('#numbers tbody tr', { has: tab.locator(`td[data-estimator="${name}"]`) });
const pressed = (tab, key) => tab.getAttribute(`button[data-key="${key}"]`, 'aria-pressed');
const postsTo = (path) => server.posts.filter((post) => post.path === path);

before(async () => {
  browser = await launch();
});
after(() => browser.close());
beforeEach(async () => {
  server = await new FakeServer(filesFolder).open();
});
afterEach(async () => {
  const troubles = open.flatMap((opened) => opened.troubles);
  for (const opened of open) await opened.close();
  open = [];
  await server.close();
  assert.deepEqual(troubles, [], 'the browser has nothing to complain of');
});

describe('what is shown', () => {
  test('every strip has data and the image changes with each frame', async () => {
    const { tab } = await page([hello(), ...span(0, 200)]);
    await shown(tab, 199);
    for (const id of strips) {
      const [times, ...columns] = await stripData(tab, id);
      assert.equal(times.length, 200, id);
      for (const column of columns) assert.ok(known(column).length > 150, `${id} has values`);
    }
    const one = await imagePixels(tab);
    server.send(...span(200, 204));
    await shown(tab, 203);
    assert.notDeepEqual(await imagePixels(tab), one);
    assert.ok(new Set(one).size > 50, 'the image has many colours');
  });

  test('differences are estimate minus servo', async () => {
    const { tab } = await page([hello(), ...span(0, 40)]);
    await shown(tab, 39);
    const [times, ...columns] = await stripData(tab, 'error');
    times.forEach((time, i) => {
      const message = frame(i);
      assert.equal(time, message.time_s);
      assert.deepEqual(columns.map((column) => column[i]), five.map((name) => message.estimates[name].rate_dps - message.commanded_dps));
    });
  });

  test('the table has the figures of the newest frame, rounded', async () => {
    const { tab } = await page([hello(), ...span(0, 300)]);
    await shown(tab, 299);
    const { scores, estimates, commanded_dps: commanded } = frame(299);
    for (const name of five) {
      const told = { ...scores.estimators[name], rate: estimates[name].rate_dps, error: estimates[name].rate_dps - commanded, angle: scores.estimators[name].angle_error_deg };
      for (const figure of ['rate', 'error', 'angle', 'frames', 'recent_median_mse', 'recent_iqr_mse', 'rmse_dps', 'drift_deg_per_min']) {
        assert.equal(Number(await cellOf(tab, name, figure).getAttribute('data-value')), told[figure], `${name} ${figure}`);
        assert.notEqual(await valueOf(tab, name, figure), '–');
      }
    }
    assert.equal(await valueOf(tab, 'cnn-thermal', 'rmse_dps'), '6.10');
    assert.equal(await valueOf(tab, 'cnn-thermal', 'recent_median_mse'), '0.419');
    assert.equal(await valueOf(tab, 'cnn-thermal', 'drift_deg_per_min'), '−18.8');
    assert.match(await textOf(tab, '#counted'), /260 frames counted, 39 excluded \(hatched\)/);
    assert.match(await textOf(tab, '#which'), /the newest frame/);
    assert.match(await textOf(tab, '#inference'), /61\.3 µs/);
  });

  test('the surroundings stand as the camera sees them, with its view and the dial at the heading', async () => {
    const { tab } = await page([hello(), ...span(0, 20)]);
    await shown(tab, 19);
    assert.equal(await hidden(tab, 'surroundings'), true, 'none are known yet');
    server.send(surroundings(20), ...span(20, 41));
    await shown(tab, 40);
    const seen = await tab.evaluate(() => {
      const canvas = document.getElementById('around');
      const { data } = canvas.getContext('2d').getImageData(0, 12, canvas.width, 1);
      const columns = Array.from({ length: canvas.width }, (_, x) => [data[4 * x] + data[4 * x + 1] + data[4 * x + 2], data[4 * x + 3]]);
      return { width: canvas.width, alphas: columns.map(([, alpha]) => alpha), warm: columns.flatMap(([light], x) => (light === Math.max(...columns.map(([other]) => other)) ? [x] : [])),
        view: [...document.querySelectorAll('#surroundings .view')].map((box) => [parseFloat(box.style.left), parseFloat(box.style.width)]),
        heading: document.getElementById('heading-hand').getAttribute('transform'), servo: document.getElementById('servo-hand').getAttribute('transform') };
    });
    assert.equal(seen.width, 420);
    const middle = (seen.warm[0] + seen.warm.at(-1) + 1) / 2;
    assert.ok(Math.abs((0.5 - middle / 420) * 360 - 30) < 2, `warm at 30 degrees, left of the middle: ${seen.warm}`);
    assert.equal(seen.alphas[Math.floor(420 * 0.875)], 0, '225 degrees were never seen');
    assert.equal(seen.alphas[210], 255);
    const { estimates, scores } = frame(40);
    const heading = estimates['gyro-kalman'].angle_deg;
    const width = 55 / 360;
    const left = 0.5 - heading / 360 - width / 2;
    assert.ok(Math.abs(seen.view[0][0] - 100 * left) < 0.01 && Math.abs(seen.view[0][1] - 100 * width) < 0.01, String(seen.view));
    assert.equal(seen.heading, `rotate(${(-heading).toFixed(2)})`);
    assert.equal(seen.servo, `rotate(${(-(heading - scores.estimators['gyro-kalman'].angle_error_deg)).toFixed(2)})`);
    assert.match(await textOf(tab, '#heading'), /^gyro-kalman: heading \+60\.0° ± /);
    await screenshot(tab, 'surroundings');
  });

  test('a view over the end of the surroundings goes on at the other end', async () => {
    const { tab } = await page([hello(), ...span(0, 120), surroundings(120)]);  // frame 119: 178.5 degrees
    await until(async () => !(await hidden(tab, 'surroundings')), 'the surroundings are shown');
    await until(() => tab.evaluate(() => document.querySelector('#surroundings .view').style.left !== ''), 'they are drawn');
    const lefts = await tab.evaluate(() => [...document.querySelectorAll('#surroundings .view')].map((box) => parseFloat(box.style.left)));
    assert.ok(lefts[0] < 0 && Math.abs(lefts[1] - lefts[0] - 100) < 0.01, String(lefts));
  });

  test('surroundings that are none are not shown', async () => {
    const wrong = [{ columns: 419 }, { columns: '420' }, { columns: -1 }, { columns: 1e9 }, { pixels: null }, { pixels: '!' }, { view_deg: null }, { view_deg: -3 },
      { estimator: 'nobody' }, { estimator: { name: 'gyro' } }, { estimator: '__proto__' }];
    const { tab } = await page([hello(), ...span(0, 20), ...wrong.map((changes) => surroundings(20, changes)), ...span(20, 24)]);
    await shown(tab, 23);
    assert.equal(await hidden(tab, 'surroundings'), true);
    server.send(surroundings(24), hello({ run: 'fedcba9876543210' }), ...span(0, 4));
    await shown(tab, 3);
    assert.equal(await hidden(tab, 'surroundings'), true, 'another run has seen nothing yet');
  });

  test('the band and the title say what runs', async () => {
    const { tab } = await page([hello(), ...span(0, 100), state(12.5)]);
    await shown(tab, 99);
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
    assert.match(await textOf(tab, '#simulated'), /SIMULATED/);
    assert.match(await tab.title(), /RECORDING garden/);
    assert.equal(await textOf(tab, '#elapsed'), '00:12 of 05:58, 05:45 to go');
    assert.match(await textOf(tab, '#kept'), /100 frames saved/);
    assert.equal(await textOf(tab, '#disk'), '61 GB free');
    assert.ok(await tab.locator('#start').isHidden(), 'no start without --control');
    server.send(hello({ recording: false, simulated: false, run: 'b' }));
    await until(async () => await textOf(tab, '#mode-word') === 'LIVE', 'LIVE');
    assert.ok(await hidden(tab, 'simulated'));
    server.send(hello({ mode: 'replay', run: 'c' }));
    await until(async () => await textOf(tab, '#mode-word') === 'REPLAY', 'REPLAY');
    assert.match(await tab.title(), /REPLAY garden/);
  });

  test('a device that is not well has a word and a shape, and the warning names it', async () => {
    const devices = { ...state(0).devices, gyro: { state: 'lost', expected_hz: 100, age_s: 4.2 } };
    const { tab } = await page([hello(), ...span(0, 8), state(1, { devices })]);
    await until(async () => (await textOf(tab, '#health')).includes('▲ lost'), 'the row says lost');
    assert.match(await textOf(tab, '#warnings'), /gyro: lost/);
    server.send(state(1.25));
    await until(async () => !(await textOf(tab, '#health')).includes('▲'), 'and is well again');
    assert.equal(await textOf(tab, '#warnings'), '');
  });

  test('events: the last five, and all on request', async () => {
    const { tab } = await page([hello(), ...Array.from({ length: 12 }, (_, i) => event(i * 24))]);
    await until(async () => /leg 12/.test(await textOf(tab, '#events')), 'the last event');
    assert.equal(await tab.locator('#events li').count(), 5);
    assert.match(await textOf(tab, '#events li:first-child'), /leg 12/);
    await tab.click('#all-events');
    assert.equal(await tab.locator('#history li').count(), 12);
  });

  test('sweep: leg, speeds and progress', async () => {
    const { tab } = await page([hello(), state(10)]);
    await until(async () => /leg 4 of 38, now \+60, next −60 deg\/s/.test(await textOf(tab, '#leg')), 'the leg');
    assert.match(await textOf(tab, '#leg-frames'), /8 of 40 frames, 1 leg repeated/);
    assert.equal((await tab.evaluate(() => document.getElementById('speeds').speeds)).length, 38);
    assert.match(await tab.getAttribute('#speeds', 'aria-label'), /−200: /);
    server.send(state(11, { speeds: [] }));
    await until(() => hidden(tab, 'speeds'), 'a replay has no box without bars');
  });

  test('sweep: frames are counted in a leg, and none are between two', async () => {
    const { tab } = await page([hello(), state(10, { phase: 'transit', leg: 5, rate_dps: 0, next_rate_dps: -60, frames: 0, repeated: 2 })]);
    await until(async () => await textOf(tab, '#leg') === 'leg 5 of 38, next −60 deg/s', 'the leg that comes');
    assert.equal(await textOf(tab, '#leg-frames'), '2 legs repeated');
    server.send(state(10.25, { phase: 'opening_rest', leg: 0, rate_dps: 0, next_rate_dps: 120, frames: 0, repeated: 0 }));
    await until(async () => await textOf(tab, '#leg') === '38 legs, next +120 deg/s', 'no leg yet');
    assert.equal(await textOf(tab, '#leg-frames'), '');
  });

  test('sweep: after the run it says what was driven, not what a leg lacks', async () => {
    const speeds = [{ rate_dps: -40, valid: 30, quota: 30 }, { rate_dps: 40, valid: 31, quota: 30 }];
    const over = { phase: 'done', leg: 2, leg_count: 2, rate_dps: 0, next_rate_dps: null, frames: 0, frames_per_leg: 30, repeated: 1, speeds };
    const { tab } = await page([hello(), state(60, { ...over, done_share: 1 })]);
    await until(async () => await textOf(tab, '#leg') === 'complete: all 2 legs', 'complete');
    assert.equal(await textOf(tab, '#leg-frames'), '61 valid frames, 1 leg repeated');
    server.send({ event: 'ended', exit: 0, message: 'Done.', advice: '', session: null });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'ENDED');
    assert.equal(await textOf(tab, '#leg'), 'complete: all 2 legs');
    server.send(hello({ run: 'stopped' }), state(20, { ...over, done_share: 0.4, leg: 1, repeated: 0 }));
    await until(async () => await textOf(tab, '#leg') === 'ended early: leg 1 of 2 is not complete', 'stopped');
    server.send(hello({ run: 'failed' }), state(20, { repeated: 0 }), { event: 'ended', exit: 5, message: 'The servo is gone.', advice: '', session: null });
    await until(async () => await textOf(tab, '#leg') === 'ended early: leg 7 of 38 is not complete', 'an error within a leg');
    assert.match(await textOf(tab, '#leg-frames'), /^\d+ valid frames$/);
    server.send(hello({ run: 'next' }));
    await until(async () => await textOf(tab, '#leg') === 'no sweep yet', 'the next run');
  });

  test('before anything is driven the band says what it waits for, and nothing counts down', async () => {
    const waiting = { phase: 'waiting', leg: 0, frames: 0, rate_dps: 0, eta_s: 27 };
    const { tab } = await page([hello({ control: true }), state(3, waiting)]);
    await until(async () => await textOf(tab, '#phase') === 'waits for Start sweep', 'what it waits for');
    assert.equal(await textOf(tab, '#elapsed'), '00:03, the sweep takes 00:27');
    server.send(hello({ run: 'at once' }), state(1, waiting));
    await until(async () => await textOf(tab, '#phase') === 'checks the devices', 'the preflight check');
    assert.equal(await textOf(tab, '#elapsed'), '00:01 of 00:28, 00:27 to go');
  });

  test('a plan that repeats has no time to go', async () => {
    const { tab } = await page([hello({ plan: { name: 'quick', repeats: true, legs: 4, frames_per_leg: 40, expected_s: 60 } }), state(70, { eta_s: null })]);
    await until(async () => /^01:10, until it is stopped$/.test(await textOf(tab, '#elapsed')), 'the time');
    assert.match(await textOf(tab, '#plan'), /repeated until stopped/);
  });

  test('a device that is waited for says for how long, and what to do', async () => {
    const away = state(10);
    away.devices.camera = { ...away.devices.camera, state: 'awaited', left_s: 41.2 };
    const { tab } = await page([hello(), away]);
    await until(async () => /camera: away, waited for 41 s more: plug it in again/.test(await textOf(tab, '#warnings')), 'the warning');
    assert.match(await tab.locator('#health tbody tr').first().textContent(), /▲ away/);
  });
});

describe('honest plots', () => {
  test('lost frames and long pauses are gaps', async () => {
    const { tab } = await page([hello(), ...span(0, 40), ...span(60, 80), frame(80, { time_s: 14 }), frame(81, { time_s: 14.125 })]);
    await shown(tab, 81);
    for (const id of strips) {
      const [times, ...columns] = await stripData(tab, id);
      for (const column of columns) {
        const nulls = column.flatMap((value, i) => (value === null ? [times[i]] : []));
        assert.equal(nulls.length, 2, id);
        assert.ok(nulls[0] > 39 * period && nulls[0] < 60 * period && nulls[1] > 79 * period && nulls[1] < 14, id);
      }
    }
  });

  test('one lost frame is a gap, a camera that is slower than it should be is none', async () => {
    const late = (index, time) => frame(index, { time_s: time });
    const { tab } = await page([hello(), ...span(0, 20), ...Array.from({ length: 20 }, (_, i) => late(20 + i, 2.625 + i * period))]);
    await shown(tab, 39);
    assert.equal((await stripData(tab, 'rate'))[1].filter((value) => value === null).length, 1);
    server.send(hello({ run: 'slow' }), ...Array.from({ length: 60 }, (_, i) => late(i, i * 0.5)));
    await shown(tab, 59);
    const [, servo] = await stripData(tab, 'rate');
    assert.ok(known(servo.slice(10)).length === servo.length - 10, 'lines as soon as the rate is known');
  });

  test('a frame that is not counted tells why under the pointer', async () => {
    const { tab } = await page([hello(), ...span(0, 24 * 20)]);
    await shown(tab, 479);
    const box = await tab.locator('#error .u-over').boundingBox();
    const [times] = await stripData(tab, 'error');
    const end = times.at(-1);
    const at = 24 * 10 * period + period;  // a ramp
    await tab.mouse.move(box.x + box.width * (1 - (end - at) / 60), box.y + 40);
    await until(async () => !(await hidden(tab, 'tip')), 'the tip');
    assert.match(await textOf(tab, '#tip'), /frame 24[0-2], not counted: servo ramp, frame overlap/);
    await tab.mouse.move(box.x + box.width * (1 - (end - at - 1.5) / 60), box.y + 40);
    await until(() => hidden(tab, 'tip'), 'no tip over a counted frame');
    assert.ok(await tab.evaluate(() => [...document.querySelectorAll('.plot')].every((plot) => plot.strip.cursor.idx === document.querySelector('#error .plot').strip.cursor.idx)), 'one cursor');
  });

  test('excluded frames do not set the scale of the differences', async () => {
    const { tab } = await page([hello(), ...span(0, 120)]);
    await shown(tab, 119);
    const scale = await tab.evaluate(() => document.querySelector('#error .plot').strip.scales.y.max);
    assert.ok(scale < 20, `${scale}`);
  });

  test('memory is bounded and old frames leave', async () => {
    const { tab } = await page([hello({ frame_rate_hz: 64 })]);
    for (let index = 0; index < 6400; index += 640) server.send(...Array.from({ length: 640 }, (_, i) => frame(index + i, { time_s: (index + i) / 64 })));
    await shown(tab, 6399);
    const [times] = await stripData(tab, 'rate');
    assert.ok(times.length <= 64 * 62 + 1 && times.length > 64 * 60, `${times.length}`);
    assert.ok(times[0] >= 6399 / 64 - 62);
  });

  test('a page that comes back takes each frame and event once', async () => {
    const { tab } = await page([hello(), ...span(0, 50)]);
    await shown(tab, 49);
    server.send(hello(), ...span(20, 60));
    await shown(tab, 59);
    assert.equal((await stripData(tab, 'rate'))[0].length, 60);
    assert.equal(await tab.locator('#events li').count(), 3);
  });

  test('a second replay of the same session starts from nothing', async () => {
    const replay = (run) => hello({ mode: 'replay', run });
    const { tab } = await page([replay('1'), ...span(0, 50), { event: 'ended', exit: 0, message: 'Played.', advice: '', session: null }]);
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'ENDED');
    server.send(replay('2'), ...span(0, 10));
    await shown(tab, 9);
    assert.equal((await stripData(tab, 'rate'))[0].length, 10);
    assert.ok(await hidden(tab, 'ended'));
    assert.equal(await textOf(tab, '#mode-word'), 'REPLAY');
  });

  test('another run starts from nothing', async () => {
    const { tab } = await page([hello(), ...span(0, 50)]);
    await shown(tab, 49);
    server.send(hello({ run: 'later' }), ...span(0, 10));
    await shown(tab, 9);
    assert.equal((await stripData(tab, 'rate'))[0].length, 10);
  });
});

describe('keys', () => {
  test('Tab reaches every button, the note and the licences, in the order of the page', async () => {
    const { tab } = await page([hello({ control: true }), ...span(0, 10), state(1.5, { phase: 'waiting' })]);
    await shown(tab, 9);
    await until(() => tab.locator('#start').isEnabled(), 'it may be started');
    const reached = [];
    for (let i = 0; i < 25; ++i) {
      await tab.keyboard.press('Tab');
      const name = await tab.evaluate(() => {
        const element = document.activeElement;
        return element === document.body ? '' : element.id || element.dataset.key || element.textContent;
      });
      if (name === '' || reached.includes(name)) break;
      reached.push(name);
      assert.ok(await tab.evaluate(() => getComputedStyle(document.activeElement).outlineStyle !== 'none'), `${name} shows its focus`);
    }
    assert.deepEqual(reached, ['start', 'stop', 'all-events', ...five, 'm', 'note', 'p', 'r', 'c', 'l', 'i', 's', 'f', '?', 'licences']);
  });

  test('S saves what is seen as a PNG', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    const [download] = await Promise.all([tab.waitForEvent('download'), tab.keyboard.press('s')]);
    assert.match(download.suggestedFilename(), /^thermorig_\d{8}T\d{6}\.png$/);
    const bytes = readFileSync(await download.path());
    assert.deepEqual([...bytes.subarray(1, 4)], [...'PNG'].map((c) => c.charCodeAt(0)));
    assert.equal(bytes.readUInt32BE(16), 2 * await tab.evaluate(() => document.documentElement.clientWidth));
  });

  test('Space stops the servo wherever the focus is, with the token, but not within the note', async () => {
    const { tab } = await page([hello({ control: true }), ...span(0, 10)]);
    await shown(tab, 9);
    for (const place of [null, '#start', '#all-events', '#numbers button', 'button[data-key="p"]', 'footer a', '#stop']) {
      if (place !== null) await tab.focus(place);
      const before = server.posts.length;
      await tab.keyboard.press('Space');
      await until(() => server.posts.length === before + 1, `Space at ${place}`);
      await pause(50);
      assert.equal(server.posts.length, before + 1, `once at ${place}`);
      const post = server.posts.at(-1);
      assert.equal(post.path, '/stop');
      assert.equal(post.headers.authorization, `Bearer ${token}`);
      assert.equal(post.headers['content-type'], 'application/json');
      assert.equal(post.body, '{}');
    }
    assert.equal(await pressed(tab, 'p'), 'false', 'Space did not press the button');
    assert.equal(await tab.locator('#numbers button').first().getAttribute('aria-pressed'), 'true', 'nor that of a line');
    await tab.keyboard.press('?');
    assert.ok(await tab.locator('#help').isVisible());
    let count = server.posts.length;
    await tab.keyboard.press('Space');
    await until(() => server.posts.length === count + 1, 'Space within the help');
    assert.ok(await tab.locator('#help').isVisible(), 'which stays open');
    await tab.keyboard.press('Escape');
    count = server.posts.length;
    await tab.focus('#note');
    await tab.keyboard.type('a b m');
    await pause(100);
    assert.equal(server.posts.length, count, 'nothing from within the note');
    assert.equal(await tab.inputValue('#note'), 'a b m');
  });

  test('a stop that does not get through says so', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    server.answer = { status: 503, body: JSON.stringify({ error: 'the loop <b>hangs</b>' }) };
    await tab.click('#stop');
    await until(async () => /did not reach the program: the loop <b>hangs<\/b>/.test(await textOf(tab, '#warnings')), 'the warning');
    server.answer = { status: 204, body: '' };
    await tab.keyboard.press('Space');
    await until(async () => await textOf(tab, '#warnings') === '', 'and goes when it does');
  });

  test('M marks, with the note that was written', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    await tab.keyboard.press('m');
    await until(() => postsTo('/mark').length === 1, 'a mark');
    assert.equal(postsTo('/mark')[0].body, '{"note":""}');
    await tab.focus('#note');
    await tab.keyboard.type('sun came out');
    await tab.keyboard.press('Enter');
    await until(() => postsTo('/mark').length === 2, 'a mark with its note');
    assert.equal(JSON.parse(postsTo('/mark')[1].body).note, 'sun came out');
    await until(async () => await tab.inputValue('#note') === '', 'the note is empty again');
  });

  test('a mark that is refused says why, and its note stays', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    server.answer = { status: 429, body: JSON.stringify({ error: 'no more than 10 marks can be set at once, then one in 1 s' }) };
    await tab.fill('#note', 'a bird');
    await tab.press('#note', 'Enter');
    await until(async () => await textOf(tab, '#warnings') === '▲ The mark was not set: no more than 10 marks can be set at once, then one in 1 s.', 'the warning');
    assert.equal(await tab.inputValue('#note'), 'a bird');
    server.answer = { status: 204, body: '' };
    await tab.press('#note', 'Enter');
    await until(async () => await textOf(tab, '#warnings') === '', 'and goes when it is set');
    assert.equal(await tab.inputValue('#note'), '');
  });

  test('P pauses the plots and nothing else', async () => {
    const { tab } = await page([hello(), ...span(0, 20)]);
    await shown(tab, 19);
    await tab.keyboard.press('p');
    assert.equal(await pressed(tab, 'p'), 'true');
    server.send(...span(20, 40));
    await shown(tab, 39);
    assert.equal((await stripData(tab, 'rate'))[0].length, 20);
    await tab.keyboard.press('p');
    await until(async () => (await stripData(tab, 'rate'))[0].length === 40, 'all of it after the pause');
    assert.equal(server.posts.length, 0);
  });

  test('R sets the shown angles to zero, on this page only', async () => {
    const { tab } = await page([hello(), ...span(0, 100)]);
    await shown(tab, 99);
    await tab.keyboard.press('r');
    await until(async () => /on this page only/.test(await textOf(tab, '#zero')), 'the page says so');
    const [, ...angles] = await stripData(tab, 'angle');
    for (const column of angles) assert.equal(column.at(-1), 0);
    for (const name of five) assert.equal(await valueOf(tab, name, 'angle'), '0.0', name);
    assert.equal(await valueOf(tab, 'gyro', 'drift_deg_per_min'), '+96.3', 'figures stay');
    server.send(...span(100, 120));
    await shown(tab, 119);
    const moved = frame(119).scores.estimators.gyro.angle_error_deg - frame(99).scores.estimators.gyro.angle_error_deg;
    assert.ok(moved > 1 && Math.abs(Number(await cellOf(tab, 'gyro', 'angle').getAttribute('data-value')) - moved) < 1e-9, 'errors since then');
    assert.equal(server.posts.length, 0);
  });

  test('C, I and L: colours, inversion and a locked range', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    const seen = [await imagePixels(tab)];
    for (const name of ['ironbow', 'viridis', 'cividis', 'grey']) {
      await tab.keyboard.press('c');
      assert.equal(await textOf(tab, '#colours'), name);
      seen.push(await imagePixels(tab));
    }
    assert.equal(new Set(seen.map(String)).size, 5);
    await tab.keyboard.press('i');
    assert.equal(await pressed(tab, 'i'), 'true');
    const [grey, inverted] = [seen[4], await imagePixels(tab)];
    grey.forEach((value, i) => assert.ok(i % 4 === 3 || Math.abs(value + inverted[i] - 255) <= 1));
    await tab.keyboard.press('l');
    const range = await textOf(tab, '.scale');
    const hot = image(10);
    hot.pixels = Buffer.from(new Int16Array(768).fill(9000).buffer).toString('base64');
    server.send(frame(10), hot, frame(11));
    await shown(tab, 11);
    assert.equal(await textOf(tab, '.scale'), range);
    await tab.keyboard.press('l');
    server.send(frame(12), { ...hot, index: 12, time_s: 1.5 }, frame(13));
    await until(async () => await textOf(tab, '#hot') === '90.5 °C', 'the range follows again');
  });

  test('F asks for full screen', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await tab.keyboard.press('f');
    await until(() => tab.evaluate(() => document.fullscreenElement !== null), 'full screen');
    await tab.keyboard.press('f');
    await until(() => tab.evaluate(() => document.fullscreenElement === null), 'and back');
  });

  test('no key starts motion; the button asks first', async () => {
    const { tab } = await page([hello({ control: true }), ...span(0, 10), state(1.5, { phase: 'waiting' })]);
    await shown(tab, 9);
    await until(() => tab.locator('#start').isEnabled(), 'it may be started');
    for (const key of ['Enter', 's', 'g', 'x', '1', 'ArrowUp', 'Control+Enter', 'b', 'q']) await tab.keyboard.press(key);
    await tab.focus('#start');
    await tab.keyboard.press('Enter');
    await tab.keyboard.press('Enter');  // on Cancel, which has the focus
    await pause(100);
    assert.equal(postsTo('/start').length, 0);
    assert.ok(await tab.locator('#motion').isHidden());
    await tab.click('#start');
    await tab.click('#motion .go');
    await until(() => postsTo('/start').length === 1, 'the order to start');
    assert.equal(postsTo('/start')[0].headers.authorization, `Bearer ${token}`);
    server.send(state(2, { phase: 'transit' }));
    await until(() => tab.locator('#start').isDisabled(), 'a sweep that runs is not started again');
  });
});

describe('connection', () => {
  test('an overlay after 3 s without a message, and back within 5 s, on the clock of the page', async () => {
    const { tab } = await page([hello(), ...span(0, 40)], { clock: true });
    await shown(tab, 39);
    await tab.clock.pauseAt(Date.now() + 1000);
    server.send(state(5.25));
    await pause(200);
    await tab.clock.runFor(2500);
    assert.ok(await hidden(tab, 'silence'), 'not yet after 2.5 s');
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
    const { port } = server;
    await server.close();
    await tab.clock.runFor(700);
    assert.ok(!(await hidden(tab, 'silence')), 'after 3.2 s');
    assert.match(await textOf(tab, '#silence'), /^no data for 3\.\d s, last frame \d\d:\d\d:\d\d$/);
    assert.equal(await tab.title(), '▲ NO DATA garden · thermorig');
    assert.equal(await textOf(tab, '#mode-word'), 'NO DATA', 'nobody knows whether it still records');
    assert.equal(await tab.getAttribute('#mode', 'data-mode'), 'silent');
    assert.equal(await textOf(tab, '#elapsed'), 'last data at 00:05');
    assert.equal(await textOf(tab, '#phase'), '');
    await screenshot(tab, 'no_data');
    for (let i = 0; i < 12; ++i) {  // a minute without a program, so that the waits are at their longest
      await tab.clock.runFor(5000);
      await pause(30);
    }
    assert.match(await textOf(tab, '#silence'), /no data for 6\d\.\d s/);
    server.greeting = [hello(), ...span(300, 310)];
    await server.open(port);
    await untilOnItsClock(tab, () => server.streams.size === 1, 'found again', 5000);
    await until(async () => {
      await tab.clock.runFor(100);
      return hidden(tab, 'silence');
    }, 'the overlay goes');
    await until(async () => {
      await tab.clock.runFor(100);
      return tab.evaluate(() => document.getElementById('numbers').dataset.index === '309');
    }, 'the newest frame is shown');
    const [times, servo] = await stripData(tab, 'rate');
    const gap = servo.indexOf(null);
    assert.ok(gap > 0 && times[gap + 1] - times[gap - 1] > 30, 'with a gap in the plots');
    assert.equal(await tab.title(), '● RECORDING garden · thermorig');
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
    assert.equal(await textOf(tab, '#elapsed'), '00:38 of 05:58, 05:19 to go');
  });

  test('an open stream that says nothing is opened again', async () => {
    const { tab } = await page([hello(), ...span(0, 5)], { clock: true });
    await shown(tab, 4);
    const [first] = server.streams;
    await tab.clock.fastForward(4600);
    await tab.clock.fastForward(600);
    await until(() => [...server.streams].some((stream) => stream !== first), 'another stream');
  });

  test('a program that closes its file may be silent for a minute', async () => {
    const { tab } = await page([hello(), ...span(0, 5), state(1, { phase: 'done', stopping: true })], { clock: true });
    await until(async () => await textOf(tab, '#phase') === 'closing the file …', 'it says so');
    const [first] = server.streams;
    await tab.clock.fastForward(50_000);
    await pause(100);
    assert.ok(await hidden(tab, 'silence'));
    assert.deepEqual([...server.streams], [first], 'the stream stays');
    await tab.clock.fastForward(11_000);
    await until(async () => !(await hidden(tab, 'silence')), 'then the overlay');
    await tab.clock.fastForward(4_000);
    await tab.clock.fastForward(600);
    await until(() => [...server.streams].some((stream) => stream !== first), 'and another stream');
  });

  test('a program that is gone while it closes its file is missed at once', async () => {
    const { tab } = await page([hello(), ...span(0, 5), state(1, { phase: 'done', stopping: true })], { clock: true });
    await until(async () => await textOf(tab, '#phase') === 'closing the file …', 'it says so');
    await server.close();
    await untilOnItsClock(tab, async () => await textOf(tab, '#mode-word') === 'NO DATA', 'NO DATA', 4000);
    assert.equal(await textOf(tab, '#phase'), '');
  });

  test('after a normal stop no device is late, and Stop has nothing to stop', async () => {
    const late = { ...state(0).devices, gyro: { ...state(0).devices.gyro, state: 'late' }, camera: { ...state(0).devices.camera, state: 'lost' } };
    const { tab } = await page([hello(), ...span(0, 5), state(1, { devices: late })]);
    await until(async () => /gyro: late/.test(await textOf(tab, '#warnings')), 'late while it runs');
    server.send(state(2, { devices: late, phase: 'done', stopping: true, done_share: 0.25 }));
    await until(async () => await textOf(tab, '#warnings') === '', 'not when it is done');
    server.send({ event: 'ended', exit: 0, message: 'Stopped.', advice: '', session: null });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'ENDED');
    assert.equal(await textOf(tab, '#warnings'), '');
    assert.match(await textOf(tab, '#health'), /camera▲ lost.*gyroclosed.*servoclosed/, 'what was lost stays lost');
    assert.equal(await tab.locator('#health tbody tr:nth-child(2) td:nth-child(5)').textContent(), '–', 'what is closed has no age');
    assert.equal(await tab.evaluate(() => document.getElementById('done').value), 0.25);
    assert.ok(await tab.locator('#stop').isDisabled());
    await tab.keyboard.press('Space');
    await pause(100);
    assert.equal(server.posts.length, 0);
    server.send(hello({ run: 'next' }), ...span(0, 3), state(0.5));
    await until(async () => (await textOf(tab, '#health')).includes('gyrook'), 'well again in the next run');
    assert.ok(await tab.locator('#stop').isEnabled());
  });

  test('after the end silence opens no other stream', async () => {
    const { tab } = await page([hello(), ...span(0, 5), { event: 'ended', exit: 0, message: 'Done.', advice: '', session: null }], { clock: true });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'ENDED');
    const [first] = server.streams;
    await tab.clock.fastForward(100_000);
    await tab.clock.fastForward(600);
    await pause(100);
    assert.ok(await hidden(tab, 'silence'));
    assert.deepEqual([...server.streams], [first], 'the stream stays');
  });

  test('a wrong token and a missing one say what to do', async () => {
    for (const fragment of ['', '#t=', '#t=nonsense', `#t=${'f'.repeat(32)}`]) {
      const { tab } = await page([], { url: `http://127.0.0.1:${server.port}/${fragment}` });
      await until(async () => /Open the address that thermorig printed/.test(await textOf(tab, '#warnings')), `advice for "${fragment}"`);
      assert.equal(await textOf(tab, '#mode-word'), 'NOT CONNECTED', fragment);
      assert.ok(await hidden(tab, 'stop'), 'no button that would stop nothing');
    }
    const { tab } = open.at(-1);
    server.greeting = [hello(), ...span(0, 10)];
    await tab.evaluate((t) => { location.hash = `#t=${t}`; }, token);
    await shown(tab, 9);
    await until(async () => await textOf(tab, '#warnings') === '', 'the advice goes');
    assert.ok(!(await hidden(tab, 'stop')));
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
  });

  test('a reload finds the token in the address', async () => {
    const { tab } = await page([hello(), ...span(0, 10)]);
    await shown(tab, 9);
    await tab.reload();
    await shown(tab, 9);
  });

  test('the end: its message, no overlay, and a next run is found', async () => {
    const { tab } = await page([hello(), ...span(0, 20)], { clock: true });
    await shown(tab, 19);
    server.send({ event: 'ended', exit: 0, message: 'The sweep is complete.', advice: 'Look at it: thermorig info', session: 'recordings/garden/3.h5' });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'ENDED');
    assert.match(await textOf(tab, '#ended'), /The sweep is complete\..*thermorig info.*garden\/3\.h5/);
    assert.match(await tab.title(), /ENDED garden/);
    const { port } = server;
    await server.close();
    await tab.clock.fastForward(10_000);
    await pause(100);
    assert.ok(await hidden(tab, 'silence'));
    await screenshot(tab, 'ended');
    server.greeting = [hello({ run: 'next' }), ...span(0, 5)];
    await server.open(port);
    await untilOnItsClock(tab, () => server.streams.size === 1, 'found again', 6000);
    await until(async () => await textOf(tab, '#mode-word') === 'RECORDING', 'the next run');
    assert.ok(await hidden(tab, 'ended'));
  });

  test('an end without words says that all went well, and a stop is no failure', async () => {
    const end = (exit, message = '') => ({ event: 'ended', exit, message, advice: '', session: null });
    const { tab } = await page([hello({ mode: 'replay', recording: false }), ...span(0, 5), end(0)]);
    await until(async () => await textOf(tab, '#ended') === 'The replay is over.', 'the sentence');
    assert.equal(await tab.getAttribute('#ended', 'data-well'), 'yes');
    server.send(hello({ run: 'a sweep' }), end(0));
    await until(async () => await textOf(tab, '#ended') === 'The run is complete.', 'that of a run');
    for (const [exit, words, well] of [[130, 'stopped on request of the page', 'stopped'], [5, 'The servo is gone.', 'no']]) {
      server.send(hello({ run: `${exit}` }), end(exit, words));
      await until(async () => await textOf(tab, '#ended') === words, words);
      assert.equal(await tab.getAttribute('#ended', 'data-well'), well);
    }
  });

  test('frames that did not reach the page are told', async () => {
    const { tab } = await page([hello(), ...span(0, 5), { event: 'dropped', frames: 12 }, { event: 'dropped', frames: 3 }]);
    await until(async () => /15 frames did not reach this page/.test(await textOf(tab, '#warnings')), 'the counter');
    server.send({ event: 'dropped', frames: 0, events: 1 });
    await until(async () => /15 frames and 1 event did not reach/.test(await textOf(tab, '#warnings')), 'events are counted as well');
  });

  test('a collapsed gate is a warning', async () => {
    const { tab } = await page([hello(), frame(0, { scores: { ...frame(0).scores, gate_collapsed: true } })]);
    await until(async () => /gate has collapsed/.test(await textOf(tab, '#warnings')), 'the warning');
    assert.equal(await tab.getAttribute('#warnings', 'aria-live'), 'polite');
  });
});

describe('estimators', () => {
  const names = (count) => estimators(count).map(({ name }) => name);
  const switchOf = (tab, name) => rowOf(tab, name).locator('button');
  const shownLines = (tab, id) => tab.evaluate((strip) => document.querySelector(`#${strip} .plot`).strip.series.slice(1).map(({ show }) => show), id);
  const alphas = (tab, id) => tab.evaluate((strip) => document.querySelector(`#${strip} .plot`).strip.series.slice(1).map(({ alpha }) => alpha), id);

  for (const [count, dark] of [[1, false], [3, true], [5, false], [8, true]]) {
    test(`a run with ${count}: a row and a line each, in the order of hello, on one screen`, async () => {
      const { tab } = await page([hello({ estimators: estimators(count) }), ...span(0, 300, count)], { dark });
      await shown(tab, 299);
      await screenshot(tab, `estimators_${count}`);
      assert.deepEqual(await tab.locator('#numbers tbody th').allTextContents(), names(count));
      const { estimates, scores, commanded_dps: commanded } = frame(299, {}, count);
      const newest = async (id) => (await stripData(tab, id)).slice(1).map((column) => column.at(-1));
      assert.deepEqual(await newest('rate'), [commanded, ...names(count).map((name) => estimates[name].rate_dps)]);
      assert.deepEqual(await newest('error'), names(count).map((name) => estimates[name].rate_dps - commanded));
      assert.deepEqual(await newest('angle'), names(count).map((name) => scores.estimators[name].angle_error_deg));
      assert.deepEqual(await newest('gain'), count >= 5 ? [estimates['cnn-fusion'].values.gain] : []);
      assert.equal(await hidden(tab, 'gain'), count < 5);
      assert.equal(await hidden(tab, 'histogram-part'), count < 5);
      assert.ok(await tab.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
      for (const column of ['.picture', '.estimators', '.strips', '.figures']) {
        assert.ok(await tab.evaluate((name) => { const e = document.querySelector(name); return e.scrollHeight <= e.clientHeight + 1 && e.scrollWidth <= e.clientWidth + 1; }, column), `${column} fits`);
      }
      assert.ok(await tab.locator('.table', { has: tab.locator('#numbers') }).evaluate((e) => e.scrollWidth <= e.clientWidth), 'the table fits');
    });
  }

  test('a run with other estimators has other rows and lines', async () => {
    const { tab } = await page([hello({ estimators: estimators(2) }), ...span(0, 30, 2)]);
    await shown(tab, 29);
    server.send(hello({ run: 'b', estimators: estimators(8).slice(3, 7) }), ...span(0, 20, 8));
    await shown(tab, 19);
    const others = names(8).slice(3, 7);
    assert.deepEqual(await tab.locator('#numbers tbody th').allTextContents(), others);
    const [, ...columns] = await stripData(tab, 'error');
    assert.deepEqual(columns.map((column) => column[5]), others.map((name) => frame(5, {}, 8).estimates[name].rate_dps - frame(5).commanded_dps));
  });

  test('titles are words on the page: at the names, and all of them in the help', async () => {
    const { tab } = await page([hello(), ...span(0, 20)]);
    await shown(tab, 19);
    assert.match(await switchOf(tab, 'gyro').getAttribute('title'), /^gyro as it is /);
    assert.match(await rowOf(tab, 'gyro').locator('.remarks').textContent(), /gyro as it is/);
    await tab.keyboard.press('?');
    assert.ok(await tab.locator('#titles').isVisible());
    assert.deepEqual(await tab.locator('#titles dd').allTextContents(), estimators(5).map(({ title }) => title));
  });

  test('a stated sigma stands beside its value, a named value with its unit, and what is not good says why', async () => {
    const estimates = { ...frame(20).estimates };
    estimates['gyro-rest'] = { rate_dps: null, angle_deg: 3, angle_sigma_deg: 0.4, state: 'absent', reason: 'no_rest', values: { bias_dps: null } };
    estimates['gyro-kalman'] = { ...estimates['gyro-kalman'], state: 'starting', reason: null, values: { bias_dps: -0.0123, scale: 1.0042 } };
    const { tab } = await page([hello(), ...span(0, 20), frame(20, { estimates })]);
    await shown(tab, 20);
    const sigma = (name, figure) => cellOf(tab, name, figure).locator('.sigma').textContent();
    assert.equal(await sigma('gyro', 'rate'), '±2.2');
    assert.equal(await sigma('gyro', 'angle'), '±0.55');
    assert.equal(await sigma('cnn-thermal', 'rate'), '', 'none is stated');
    const remark = (name, what) => rowOf(tab, name).locator(`.${what}`).textContent();
    assert.equal(await remark('gyro-rest', 'state'), '▲ absent: no rest');
    assert.equal(await remark('gyro-rest', 'values'), '');
    assert.equal(await remark('gyro-kalman', 'state'), '◌ starting');
    assert.equal(await remark('gyro-kalman', 'values'), 'bias −0.0123 deg/s, scale 1.00');
    assert.equal(await remark('cnn-fusion', 'values'), `Kg ${estimates['cnn-fusion'].values.gain.toFixed(2)}`);
  });

  test('a drift tells over how many seconds it was integrated, and is none below ten', async () => {
    const { tab } = await page([hello(), ...span(0, 60), frame(60, { scores: { ...frame(60).scores, integrated_s: 9.9 } })]);
    await shown(tab, 60);
    assert.match(await textOf(tab, '#numbers thead'), /drift, °\/minfrom 10 s on/);
    assert.equal(await valueOf(tab, 'gyro', 'drift_deg_per_min'), '–');
    assert.equal(await cellOf(tab, 'gyro', 'drift_deg_per_min').getAttribute('data-value'), '');
    server.send(frame(61, { scores: { ...frame(61).scores, integrated_s: 312.4 } }));
    await shown(tab, 61);
    assert.match(await textOf(tab, '#numbers thead'), /drift, °\/minover 312 s/);
    assert.equal(await valueOf(tab, 'gyro', 'drift_deg_per_min'), '+96.3');
    server.send(frame(62, { scores: { ...frame(62).scores, integrated_s: null } }));
    await shown(tab, 62);
    assert.equal(await valueOf(tab, 'gyro', 'drift_deg_per_min'), '–', 'nobody knows over how long');
  });

  test('the table has the values of the frame under the pointer', async () => {
    const { tab } = await page([hello(), ...span(0, 24 * 20)]);
    await shown(tab, 479);
    await tab.keyboard.press('p');
    const box = await tab.locator('#angle .u-over').boundingBox();
    await tab.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await until(async () => /under the pointer/.test(await textOf(tab, '#which')), 'the table says so');
    const index = Number(/frame (\d+),/.exec(await textOf(tab, '#which'))[1]);
    assert.ok(index > 200 && index < 280, `${index}`);
    for (const name of five) assert.equal(Number(await cellOf(tab, name, 'rate').getAttribute('data-value')), frame(index).estimates[name].rate_dps);
    assert.equal(await textOf(tab, '#servo output'), frame(index).commanded_dps.toFixed(1).replace(/^(?=\d)/, '+').replace('-', '−'));
    await tab.mouse.move(0, 0);
    await until(async () => /of frame 479, paused/.test(await textOf(tab, '#which')), 'the newest that is drawn');
  });

  test('a click on a name or Enter switches its lines off and on, and the scale follows', async () => {
    const { tab } = await page([hello(), ...span(0, 200)]);
    await shown(tab, 199);
    const top = () => tab.evaluate(() => document.querySelector('#angle .plot').strip.scales.y.max);
    const all = await top();
    await switchOf(tab, 'gyro').click();
    await until(async () => await top() < all / 3, 'the scale of the others');
    assert.deepEqual(await shownLines(tab, 'rate'), [true, false, true, true, true, true], 'the servo stays');
    for (const id of ['error', 'angle']) assert.deepEqual(await shownLines(tab, id), [false, true, true, true, true], id);
    assert.equal(await switchOf(tab, 'gyro').getAttribute('aria-pressed'), 'false');
    assert.notEqual(await valueOf(tab, 'gyro', 'rate'), '–', 'its figures stay');
    await switchOf(tab, 'cnn-fusion').focus();
    await tab.keyboard.press('Enter');
    assert.deepEqual(await shownLines(tab, 'gain'), [false]);
    server.send(...span(200, 210));
    await shown(tab, 209);
    assert.deepEqual(await shownLines(tab, 'error'), [false, true, true, true, false], 'new frames change nothing');
    server.send(hello({ run: 'again' }), ...span(0, 10));
    await shown(tab, 9);
    assert.deepEqual(await shownLines(tab, 'error'), [false, true, true, true, false], 'nor does a next run of the same ones');
    await switchOf(tab, 'gyro').click();
    assert.deepEqual(await shownLines(tab, 'error'), [true, true, true, true, false]);
    assert.deepEqual(await tab.evaluate(() => [Object.keys(localStorage), Object.keys(sessionStorage)]), [[], ['thermorig token']], 'nothing of it is kept');
    assert.equal(server.posts.length, 0);
  });

  test('all lines can be off', async () => {
    const { tab } = await page([hello({ estimators: estimators(2) }), ...span(0, 50, 2)]);
    await shown(tab, 49);
    for (const name of names(2)) await switchOf(tab, name).click();
    server.send(...span(50, 60, 2));
    await shown(tab, 59);
    assert.deepEqual(await shownLines(tab, 'error'), [false, false]);
    const { min, max } = await tab.evaluate(() => document.querySelector('#error .plot').strip.scales.y);
    assert.ok(min < 0 && max > 0 && max < 3);
  });

  test('the pointer on a name or the focus brings its line forward, with its sigma as a band', async () => {
    const { tab } = await page([hello(), ...span(0, 200)]);
    await shown(tab, 199);
    await tab.keyboard.press('p');
    // Half a sigma beside the line at a frame whose neighbours are counted: under no line, within the band.
    const inBand = (id, name, value, sigma) => tab.evaluate(([strip, index, offset]) => {
      const { strip: plot } = document.querySelector(`#${strip} .plot`);
      const at = 12 + 24 * 5;
      const [x, y] = [plot.valToPos(plot.data[0][at], 'x', true), plot.valToPos(plot.data[index][at] + offset, 'y', true)];
      return [...plot.ctx.getImageData(Math.round(x), Math.round(y), 1, 1).data].join();
    }, [id, five.indexOf(name) + 1, sigma * value]);
    const sigma = frame(132).estimates.gyro.angle_sigma_deg;
    const [within, beyond] = [() => inBand('angle', 'gyro', 0.7, sigma), () => inBand('angle', 'gyro', 2.5, sigma)];
    const before = [await within(), await beyond()];
    await rowOf(tab, 'gyro').hover();
    await until(async () => await within() !== before[0], 'the band');
    assert.equal(await beyond(), before[1], 'which ends');
    const faint = (await alphas(tab, 'error')).map((alpha) => alpha < 1);
    assert.deepEqual(faint, [false, true, true, true, true]);
    await tab.mouse.move(0, 0);
    await until(async () => await within() === before[0], 'it goes');
    assert.ok((await alphas(tab, 'error')).every((alpha) => alpha === 1));
    await tab.focus('#all-events');
    await tab.keyboard.press('Tab');
    await until(async () => await within() !== before[0], 'the focus shows it as well');
    await tab.keyboard.press('Enter');
    assert.equal(await within(), before[0], 'a line that is off has no band');
    assert.ok((await alphas(tab, 'error')).every((alpha) => alpha === 1), 'and none is before the others');
  });

  /** Colour and dashes of the lines in the table, and the colour of the paper, in the theme of the tab. */
  const linesOf = (tab) => tab.evaluate(() => ({ paper: getComputedStyle(document.body).backgroundColor,
    lines: [...document.querySelectorAll('#numbers line')].map((line) => ({ colour: getComputedStyle(line).stroke, dash: line.getAttribute('stroke-dasharray'),
      width: line.getAttribute('stroke-width') })) }));
  const linear = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  const luminance = (colour) => linear(colour).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  /** Linear RGB as people see it who lack one kind of cones: Machado, Oliveira and Fernandes 2009, severity 1. */
  const eyes = {
    normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    protanope: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    deuteranope: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    tritanope: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
  };
  /** CIE 1976 L*a*b* of linear sRGB. */
  function lab(rgb) {
    const [x, y, z] = [[0.4124, 0.3576, 0.1805, 0.9505], [0.2126, 0.7152, 0.0722, 1], [0.0193, 0.1192, 0.9505, 1.089]]
      .map(([r, g, b, white]) => (r * rgb[0] + g * rgb[1] + b * rgb[2]) / white).map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
  }
  const seenBy = (eye, colour) => lab(eye.map((row) => Math.min(1, Math.max(0, row.reduce((sum, share, i) => sum + share * linear(colour)[i], 0)))));

  for (const dark of [false, true]) {
    test(`${dark ? 'dark' : 'light'}: eight lines differ in colour for every eye, and in dashes where there is no colour`, async (t) => {
      const { tab } = await page([hello({ estimators: estimators(8) }), ...span(0, 3, 8)], { dark });
      await shown(tab, 2);
      const { lines, paper } = await linesOf(tab);
      assert.equal(new Set(lines.map(({ dash }) => dash)).size, 8, 'no two have the same dashes');
      for (const { colour } of lines) {
        const [one, two] = [luminance(colour), luminance(paper)];
        assert.ok((Math.max(one, two) + 0.05) / (Math.min(one, two) + 0.05) >= 3, `${colour} on ${paper}`);
      }
      for (const [name, eye] of Object.entries(eyes)) {
        const seen = lines.map(({ colour }) => seenBy(eye, colour));
        const pairs = seen.flatMap((one, i) => seen.slice(0, i).map((two, k) => [Math.hypot(...one.map((c, a) => c - two[a])), lines[i].colour, lines[k].colour]));
        const [distance, one, two] = pairs.sort((a, b) => a[0] - b[0])[0];
        t.diagnostic(`${name}: least distance ${distance.toFixed(0)} (${one}, ${two})`);
        assert.ok(distance >= 15, `${name}: ${one} and ${two} are ${distance.toFixed(1)} apart`);
      }
    });
  }

  test('each estimator of the paper has its own line in every run', async () => {
    const { tab } = await page([hello({ estimators: estimators(8) }), ...span(0, 3, 8)]);
    await shown(tab, 2);
    const own = async (name) => (await linesOf(tab)).lines[(await tab.locator('#numbers tbody th').allTextContents()).indexOf(name)];
    const before = await Promise.all(['gyro', 'cnn-thermal', 'cnn-fusion'].map(own));
    assert.deepEqual(before.map(({ colour }) => colour), ['rgb(0, 114, 178)', 'rgb(168, 82, 138)', 'rgb(213, 94, 0)']);
    server.send(hello({ run: 'b', estimators: estimators(5).toReversed() }), ...span(0, 4, 5));
    await shown(tab, 3);
    assert.deepEqual(await Promise.all(['gyro', 'cnn-thermal', 'cnn-fusion'].map(own)), before);
  });
});

describe('whatever comes', () => {
  const nothing = (message) => Object.fromEntries(Object.keys(message).map((key) => [key, key === 'event' ? message.event : null]));

  test('null in each field, no fields, wrong types and unknown events break nothing', async () => {
    const { tab } = await page([hello()]);
    const ended = { event: 'ended', exit: 0, message: '', advice: '', session: '' };
    for (const message of [hello(), state(1), frame(0), image(0), surroundings(0), event(0), { event: 'dropped', frames: 1 }, ended]) {
      server.send(nothing(message), { event: message.event });
      for (const wrong of ['x', -1, 1e300, true, [], {}, [null], { a: null }]) {
        server.send(Object.fromEntries(Object.keys(message).map((key) => [key, key === 'event' ? message.event : wrong])));
      }
      for (const key of Object.keys(message)) if (key !== 'event') server.send({ ...message, [key]: null });
    }
    server.send('not json', '[]', 'null', '17', '"x"', '{}', '{"event":null}', '{"event":"__proto__"}', '{"event":"constructor"}', { event: 'tomorrow', a: 1 });
    server.send(state(2, { devices: { camera: null, other: { state: 'odd' } }, speeds: [null, {}, { rate_dps: 1 }] }));
    server.send(frame(5, { scores: null }), frame(6, { scores: { estimators: { gyro: null }, gain_histogram: [null, 'x'] } }), frame(7, { reasons: [null, 3, {}] }));
    server.send(hello({ run: 'after' }), ...span(0, 10));
    await shown(tab, 9);
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
  });

  test('without a network nothing of one is shown, and a sentence says so', async () => {
    const bare = (index) => frame(index, { inference_us: null, scores: { ...frame(index, {}, 2).scores, gain_mean: null, gain_histogram: null } }, 2);
    const { tab } = await page([hello({ model: null, estimators: estimators(2) }), ...Array.from({ length: 40 }, (_, i) => bare(i)), image(39), state(5)]);
    await shown(tab, 39);
    assert.equal(await textOf(tab, '#no-gain'), 'No network runs, so there is no fusion gain Kg.');
    assert.ok(await hidden(tab, 'gain') && await hidden(tab, 'histogram-part'));
    assert.equal(await tab.locator('#numbers tbody tr').count(), 2);
    assert.doesNotMatch(await textOf(tab, '#numbers'), /thermal|fusion/);
    const [, ...columns] = await stripData(tab, 'error');
    assert.deepEqual(columns.map((column) => known(column).length), [40, 40]);
    await screenshot(tab, 'no_network');
    server.send(hello({ run: 'b', model: { name: 'small.onnx', frames: 1, reduction: 0, fusion: false, simulated: false }, estimators: estimators(4) }));
    await until(async () => await textOf(tab, '#no-gain') === 'No estimator of this run has a fusion gain Kg.', 'a network without fusion');
    server.send(hello({ run: 'c' }));
    await until(() => hidden(tab, 'no-gain'), 'with fusion there is nothing to say');
    assert.ok(!(await hidden(tab, 'gain')) && !(await hidden(tab, 'histogram-part')));
  });

  test('without a camera there is no image, and no temperature', async () => {
    const pixels = (value) => {
      const bytes = Buffer.alloc(768 * 2);
      for (let i = 0; i < 768; ++i) bytes.writeInt16LE(i < 700 && value !== null ? value + i : -32768, 2 * i);
      return bytes.toString('base64');
    };
    const { tab } = await page([hello(), ...span(0, 5)]);
    await shown(tab, 4);
    server.send(image(5, { pixels: pixels(null) }), frame(5, { fresh: 'repeated' }));
    await shown(tab, 5);
    assert.ok((await imagePixels(tab)).every((value) => value === 0), 'nothing is drawn');
    assert.equal(await textOf(tab, '#fresh'), 'no image');
    assert.equal(await textOf(tab, '#hot'), '–');
    assert.match(await tab.getAttribute('#image', 'aria-label'), /no image/);
    server.send(image(6, { pixels: pixels(2000) }), frame(6));
    await shown(tab, 6);
    assert.match(await tab.getAttribute('#image', 'aria-label'), /Thermal image, 20\.0 to 27\.0 °C/);
    assert.match(await textOf(tab, '#cold'), /^20\.1/);
    assert.equal(await textOf(tab, '#fresh'), 'all pixels new');
    assert.equal((await imagePixels(tab)).at(-1), 0, 'what has no value has no colour');
  });

  test('without a gyro its lines are gaps and the rest goes on', async () => {
    const gone = { rate_dps: null, rate_sigma_dps: null, angle_deg: null, angle_sigma_deg: null, state: 'absent', reason: 'no_gyro', values: {} };
    const { tab } = await page([hello(), ...Array.from({ length: 40 }, (_, i) => frame(i, { estimates: { ...frame(i).estimates, gyro: gone, 'cnn-fusion': gone } }))]);
    await shown(tab, 39);
    const [, ...columns] = await stripData(tab, 'error');
    assert.deepEqual(columns.map((column) => known(column).length), [0, 40, 40, 40, 0]);
    assert.equal(await valueOf(tab, 'gyro', 'rate'), '–');
    assert.equal(await rowOf(tab, 'gyro').locator('.state').textContent(), '▲ absent: no gyro');
    assert.equal(await rowOf(tab, 'gyro-rest').locator('.state').textContent(), '', 'what is good has no word');
  });

  test('estimators that are none are left out, and names of the language are names', async () => {
    const odd = [null, 3, {}, { name: '' }, { name: 7, title: 'x' }, { name: 'a', title: null, values: [null, 3, 'gain_dps', ''] }, { name: 'a', title: 'again' },
      { name: '__proto__', title: 'first' }, { name: 'constructor', title: 'second', values: 'gain' }, { name: 'toString' }];
    const { tab } = await page([hello({ estimators: odd })]);
    const good = (rate) => ({ rate_dps: rate, state: 'good', values: { gain_dps: 0.25 } });
    const sent = JSON.stringify(frame(0, { estimates: { a: good(10), constructor: { ...good(20), rate_sigma_dps: -1 } } }));
    server.send(sent.replace('"estimates":{', `"estimates":{"__proto__":${JSON.stringify(good(30))},`));
    await shown(tab, 0);
    const [, , ...columns] = await stripData(tab, 'rate');
    assert.deepEqual(columns, [[10], [30], [20], [null]]);
    assert.equal(await rowOf(tab, 'a').locator('.values').textContent(), 'gain 0.25 deg/s');
    assert.equal(await rowOf(tab, 'toString').locator('.state').textContent(), '▲ absent');
    assert.equal(await cellOf(tab, 'constructor', 'rate').locator('.sigma').textContent(), '', 'a sigma below zero is none');
    for (const nothing of [null, [], 'gyro', { gyro: {} }]) {
      server.send(hello({ run: `${JSON.stringify(nothing)}`, estimators: nothing }), ...span(0, 3));
      await until(async () => !(await hidden(tab, 'no-estimators')), 'a sentence in the place of the table');
      assert.equal(await textOf(tab, '#no-estimators'), 'No estimators yet.');
      assert.equal((await stripData(tab, 'rate')).length, 2, 'the servo alone');
      server.send(hello({ run: 'between' }));
      await until(() => hidden(tab, 'no-estimators'), 'estimators again');
    }
  });

  test('more estimators than lines can be told apart are counted in a warning', async () => {
    const many = Array.from({ length: 11 }, (_, i) => ({ name: `number ${i}`, title: '', values: [] }));
    const { tab } = await page([hello({ estimators: many }), ...span(0, 3)]);
    await until(async () => await textOf(tab, '#warnings') === '▲ 3 more estimators run than this page shows.', 'the warning');
    assert.equal(await tab.locator('#numbers tbody tr').count(), 8);
    server.send(hello({ run: 'b' }));
    await until(async () => await textOf(tab, '#warnings') === '', 'and goes');
  });

  test('hostile texts are texts', async () => {
    const evil = '<img src=x onerror="window.hit=1"><script>window.hit=1</script>\u001b[31mred\u0007\u202egnp\u061c\u00ad\u180e\u2028\u{e0041}';
    const evilObject = (message) => Object.fromEntries(Object.entries(message).map(([key, value]) => [key, typeof value === 'string' && key !== 'event' ? evil : value]));
    const { tab } = await page([{ ...evilObject(hello()), model: { name: evil, fusion: false }, plan: { name: evil }, estimators: [{ name: evil, title: evil, values: [evil] }] }, ...span(0, 5),
      frame(5, { reasons: [evil], excluded: evil, fresh: evil, counted: false, estimates: { [evil]: { state: evil, reason: evil, values: { [evil]: 1 } } } }), { ...evilObject(event(5)) }, state(1, { phase: evil, devices: { [evil]: { state: evil } } })]);
    await shown(tab, 5);
    server.send({ event: 'ended', exit: 1, message: evil, advice: evil, session: evil });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'the end');
    await tab.click('#all-events');
    assert.equal(await tab.evaluate(() => window.hit), undefined);
    assert.equal(await tab.locator('img, script:not([src])').count(), 0);
    for (const place of ['#environment', '#events', '#ended', '#fresh', '#history', '#numbers', '#titles', '#numbers .state', '#numbers .values']) {
      const text = await textOf(tab, place);
      assert.ok(text.includes('<img src=x'), `${place} shows it as text`);
      assert.ok(!/[\u0000-\u0008\u000b-\u001f\u2028\p{Default_Ignorable_Code_Point}]/u.test(text), `${place} has no character that steers or hides`);
    }
    await screenshot(tab, 'hostile');
  });

  test('texts without spaces and very long ones do not widen the page', async () => {
    const long = 'x'.repeat(3000);
    const { tab } = await page([hello({ environment: long, plan: { name: long }, estimators: [...estimators(2), { name: long, title: long, values: [long] }] }), ...span(0, 5),
      frame(5, { estimates: { [long]: { state: long, reason: long, values: { [long]: 1 } } } }), event(1, { message: long, source: long }),
      { event: 'ended', exit: 1, message: long, advice: long, session: long }], { width: 400 });
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'the end');
    assert.deepEqual(await tab.evaluate(() => [...document.querySelectorAll('body *')].filter((e) => e.getBoundingClientRect().right > innerWidth)
      .map((e) => e.id || e.tagName)), []);
    assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth) <= 400);
  });
});

describe('looks', () => {
  /** The least contrast of all visible texts, with the text. */
  const leastContrast = (tab) => tab.evaluate(() => {
    const parse = (text) => (text.match(/[\d.]+/g) ?? []).map(Number);
    const luminance = ([r, g, b]) => [r, g, b].map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
      .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
    const ground = (element) => {
      for (let at = element; at !== null; at = at.parentElement) {
        const colour = parse(getComputedStyle(at).backgroundColor);
        if (colour.length === 3 || colour[3] === 1) return colour;
      }
      return parse(getComputedStyle(document.body).backgroundColor);
    };
    const found = [];
    for (const element of document.querySelectorAll('body *')) {
      if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim() !== '') || element.getClientRects().length === 0) continue;
      const [one, two] = [luminance(parse(getComputedStyle(element).color)), luminance(ground(element))];
      found.push([(Math.max(one, two) + 0.05) / (Math.min(one, two) + 0.05), element.textContent]);
    }
    return found.sort((a, b) => a[0] - b[0])[0];
  });

  for (const dark of [false, true]) {
    const theme = dark ? 'dark' : 'light';
    test(`${theme}: one screen at 1280 x 800, texts with contrast`, async (t) => {
      const late = { ...state(0).devices, gyro: { ...state(0).devices.gyro, state: 'late', age_s: 0.7, rate_min_hz: 71.2 } };
      const { tab } = await page([hello({ control: true }), ...span(0, 520)], { dark });
      await shown(tab, 519);
      await screenshot(tab, theme);
      assert.ok((await tab.locator('.band').boundingBox()).height < 60, 'the band is one line');
      assert.ok(await tab.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
      for (const column of ['.picture', '.strips', '.figures']) {
        assert.ok(await tab.evaluate((name) => { const e = document.querySelector(name); return e.scrollHeight <= e.clientHeight + 1 && e.scrollWidth <= e.clientWidth + 1; }, column), `${column} fits`);
      }
      for (const table of await tab.locator('main .table').all()) assert.ok(await table.evaluate((e) => e.scrollWidth <= e.clientWidth), 'the table fits');
      server.send(state(65, { devices: late }));
      await until(async () => (await textOf(tab, '#health')).includes('▲'), 'a row with a warning');
      await screenshot(tab, `${theme}_late`);
      for (const mode of ['recording', 'live', 'replay', 'connecting', 'refused', 'silent', 'ended']) {
        await tab.evaluate((name) => { document.getElementById('mode').dataset.mode = name; }, mode);
        const [contrast, text] = await leastContrast(tab);
        assert.ok(contrast >= 4.5, `${mode}: ${contrast.toFixed(2)} of "${text}"`);
        if (mode === 'recording') t.diagnostic(`least contrast, ${theme}: ${contrast.toFixed(2)} ("${text.slice(0, 30)}")`);
      }
    });
  }

  for (const width of [700, 800, 900, 1100, 1200, 1240, 1600]) {
    test(`${width} px wide: no heading is cut`, async () => {
      const { tab } = await page([hello({ control: true }), ...span(0, 520)], { width, height: 900, dark: width === 1600 });
      await shown(tab, 519);
      await screenshot(tab, `wide_${width}`);
      const cut = await tab.evaluate(() => [...document.querySelectorAll('h2, h3, caption, th, #numbers .n, #servo')].filter((e) => e.getClientRects().length > 0)
        .filter((e) => e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).display !== 'inline').map((e) => e.textContent));
      assert.deepEqual(cut, []);
      for (const table of await tab.locator('main .table').all()) assert.ok(await table.evaluate((e) => e.scrollWidth <= e.clientWidth), 'the table fits');
      for (const strip of await tab.locator('.strip').all()) assert.ok((await strip.locator('.plot').boundingBox()).height > 50, 'a plot is left');
      const [heading, servo] = [await tab.locator('#rate h2').boundingBox(), await tab.locator('#servo').boundingBox()];
      assert.ok(servo.x >= heading.x + heading.width - 1, 'the servo stands beside its heading');
    });
  }

  test('400 px wide: nothing is cut', async () => {
    const { tab } = await page([hello({ control: true }), ...span(0, 520)], { width: 400, height: 2200 });
    await shown(tab, 519);
    await screenshot(tab, 'narrow');
    assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth) <= 400);
    for (const table of await tab.locator('main .table').all()) assert.ok(await table.evaluate((e) => e.scrollWidth <= e.clientWidth), 'the table fits');
  });

  test('390 px wide: Stop, state and the whole image stand on the first screen', async () => {
    const { tab } = await page([hello({ control: true }), ...span(0, 20)], { width: 390, height: 844 });
    await shown(tab, 19);
    for (const id of ['stop', 'mode', 'phase', 'image']) {
      const { y, height } = await tab.locator(`#${id}`).boundingBox();
      assert.ok(y >= 0 && y + height <= 844, id);
    }
    const below = await tab.locator('#image').evaluate((e) => e.getBoundingClientRect().bottom);
    assert.ok((await tab.locator('#numbers').boundingBox()).y > below);
  });

  test('empty states say what is missing', async () => {
    const { tab } = await page([hello({ control: true, acquisition: null, recording: false })]);
    await until(async () => await textOf(tab, '#mode-word') === 'LIVE', 'LIVE');
    await screenshot(tab, 'empty');
    assert.match(await textOf(tab, '#events'), /none yet/);
    assert.match(await textOf(tab, '#leg'), /no sweep/);
    assert.match(await tab.getAttribute('#image', 'aria-label'), /none yet/);
  });

  test('the image has a text that follows slowly', async () => {
    const colder = (messages) => [...messages].map((message) => (message.event === 'image' ? image(message.index, { offset: -30 }) : message));
    const { tab } = await page([hello(), ...span(0, 10)], { clock: true });
    await shown(tab, 9);
    const first = await tab.getAttribute('#image', 'aria-label');
    assert.match(first, /Thermal image, \d+\.\d to 3\d\.\d °C, hottest at the middle/);
    server.send(...colder(span(10, 18)));
    await shown(tab, 17);
    assert.equal(await tab.getAttribute('#image', 'aria-label'), first);
    // For the stream that is opened again after the silence. Whichever of its images is drawn first is a cold one.
    server.greeting = [hello(), ...colder(span(0, 20))];
    await tab.clock.fastForward(11_000);
    await shown(tab, 19);
    assert.match(await tab.getAttribute('#image', 'aria-label'), /Thermal image, −2\d\.\d to [01]\.\d °C, hottest at the middle/);
  });

  test('reduced motion: at most a drawing a second', async () => {
    const { tab } = await page([hello(), ...span(0, 8)], { calm: true });
    await shown(tab, 7);
    const drawings = await tab.evaluate(() => {
      const { strip } = document.querySelector('#rate .plot');
      const draw = strip.setData.bind(strip);
      window.drawings = 0;
      strip.setData = (...data) => { ++window.drawings; draw(...data); };
      return new Promise((done) => { setTimeout(() => done(window.drawings), 10); });
    });
    assert.equal(drawings, 0);
    for (let index = 8; index < 28; ++index) {
      server.send(...span(index, index + 1));
      await pause(50);
    }
    assert.ok(await tab.evaluate(() => window.drawings) <= 3);
  });

  test('tables have captions and nothing is styled or scripted within the HTML', () => {
    const html = readFileSync(join(filesFolder, 'index.html'), 'utf8');
    assert.ok(!/ style=| on[a-z]+=|<style|<script>/i.test(html));
    assert.equal(html.match(/<table/g).length, html.match(/<caption/g).length);
    assert.ok(!/https?:\/\//.test(html));
  });

  test('all files together are less than 100 kB, packed', () => {
    const sizes = readdirSync(filesFolder).filter((name) => name.endsWith('.gz')).map((name) => statSync(join(filesFolder, name)).size);
    const total = sizes.reduce((sum, size) => sum + size, 0);
    assert.ok(total < 100_000);
  });
});
