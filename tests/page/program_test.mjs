// SPDX-License-Identifier: MIT
// The page on the program itself, which drives a simulated rig on the wall clock.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, describe, test } from 'node:test';
import { imagePixels, launch, openTab, screenshot, stripData, textOf, until, untilOnItsClock } from './browser.mjs';
import { Program, whyNot } from './program.mjs';

const source = process.env.THERMORIG_SOURCE;
const model = join(source, 'docs/models/best.onnx');
const rig = ['--simulated=3', '--world', 'honest', '--plan', 'quick', '--frames-per-leg', '60', ...(existsSync(model) ? ['--model', model] : [])];
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

/** All that stands in the table of estimators, and for which frame. */
const numbersOf = (tab) => tab.evaluate(() => ({ index: Number(document.getElementById('numbers').dataset.index),
  cells: [...document.querySelectorAll('#numbers td[data-figure]')].map(({ dataset }) => [dataset.estimator, dataset.figure, dataset.value]) }));

const minus = (one, two) => (one === null || two === null ? null : one - two);

/** What the table shall have, by the name of the column. */
function figureOf(message, name, figure) {
  const [estimate, scores] = [message.estimates[name], message.scores.estimators[name]];
  switch (figure) {
    case 'rate': return estimate.rate_dps;
    case 'error': return minus(estimate.rate_dps, message.commanded_dps);
    case 'angle': return scores.angle_error_deg;
    case 'drift_deg_per_min': return message.scores.integrated_s < 10 ? null : scores[figure];
    default: return scores[figure];
  }
}

async function shownAtLeast(tab, index, program) {
  const shown = async () => (await numbersOf(tab)).index >= index;
  const events = () => program?.of('event').map(({ time_s: time, kind, message }) => `${time} ${kind} ${message}`).join('\n');
  await until(async () => await shown() || program?.of('ended').length > 0, `frame ${index} is shown\n${events()}`, 60_000);
  assert.ok(await shown(), `the run ended before frame ${index}:\n${events()}`);
}

/** Messages by their times, one after the other where some are the same: a stall may hold two frames back to one time. */
function inTurn(messages) {
  const waiting = new Map();
  for (const message of messages) waiting.set(message.time_s, [...(waiting.get(message.time_s) ?? []), message]);
  return (time) => waiting.get(time)?.shift();
}

describe('the program', { skip: whyNot() || false }, () => {
  let browser;
  let folder;
  let running = [];

  function run(...words) {
    const program = new Program(folder, [...rig, ...words]);
    running.push(program);
    return program;
  }

  before(async () => {
    browser = await launch();
    folder = mkdtempSync(join(tmpdir(), 'thermorig-page-'));
  });
  after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
  });
  afterEach(async () => {
    for (const program of running) await program.kill();
    running = [];
  });

  test('numbers and lines of the page are those of the JSON stream, then Space stops the servo', async (t) => {
    const program = run('--page-port', '0');
    const { tab, troubles, close } = await openTab(browser);
    await tab.goto(await program.url());
    await shownAtLeast(tab, 40);
    const first = await imagePixels(tab);
    await shownAtLeast(tab, 110, program);  // five seconds of its first leg: angles are counted
    assert.notDeepEqual(await imagePixels(tab), first, 'the image changes');
    await screenshot(tab, 'program');

    const { index, cells } = await numbersOf(tab);  // before P, which stops the plots and their rates, but no scores
    await tab.keyboard.press('p');
    const { index: newest } = await numbersOf(tab);
    await until(() => program.of('frame').at(-1).index > newest, 'the lines of all of it');
    const frames = new Map(program.of('frame').map((message) => [message.index, message]));
    const { estimators } = program.of('hello')[0];
    const names = estimators.map(({ name }) => name);
    assert.deepEqual(await tab.locator('#numbers tbody th').allTextContents(), names, 'a row each');
    assert.equal(cells.length, 8 * names.length);
    for (const [estimator, figure, value] of cells) {
      assert.equal(value === '' ? null : Number(value), figureOf(frames.get(index), estimator, figure), `${estimator} ${figure} of frame ${index}`);
    }
    const each = (figure) => (message) => names.map((name) => figureOf(message, name, figure));
    const fusion = estimators.filter(({ values }) => values.includes('gain')).map(({ name }) => name);
    assert.equal(await tab.locator('#gain').isVisible(), fusion.length > 0, 'Kg only where there is one');
    const lines = { rate: (m) => [m.commanded_dps, ...each('rate')(m)], error: each('error'), angle: each('angle'),
      gain: (m) => fusion.map((name) => m.estimates[name].values.gain) };
    let compared = 0;
    for (const [id, values] of Object.entries(lines)) {
      const [times, ...columns] = await stripData(tab, id);
      const known = columns.map(() => 0);
      const sent = inTurn([...frames.values()]);
      times.forEach((time, i) => {
        const message = sent(time);
        if (message === undefined) {
          assert.ok(columns.every((column) => column[i] === null), `${id}: a point that the program did not send`);
          return;
        }
        values(message).forEach((value, c) => {
          assert.equal(columns[c][i], value, `${id} at ${time} s`);
          known[c] += value === null ? 0 : 1;
        });
        ++compared;
      });
      assert.ok(known.every((number) => number > 20), `${id} has data: ${known}`);
    }
    t.diagnostic(`${compared} points of four strips equal the JSON stream's`);

    // In the time of the run: it is the program that must be quick, not the browser.
    await until(() => program.of('state').at(-1).phase === 'leg', 'a leg is driven', 30_000);
    await until(() => Math.abs(program.of('frame').at(-1).commanded_dps ?? 0) > 20, 'the servo turns', 30_000);
    await tab.keyboard.press('Space');
    await until(() => program.of('ended').length > 0, 'the run ends', 20_000);
    const last = program.of('state').at(-1);
    assert.equal(last.phase, 'done');
    const stopped = program.of('event').find(({ kind }) => kind === 'stopped');
    assert.match(stopped.message, /page/);
    const seconds = last.time_s - stopped.time_s;
    t.diagnostic(`from the order to a servo at rest and disarmed: ${(seconds * 1000).toFixed(0)} ms of the run`);
    assert.ok(seconds >= 0 && seconds <= 0.3, `${seconds} s`);
    await until(async () => await textOf(tab, '#mode-word') === 'ENDED', 'the page says ENDED');
    assert.notEqual(await textOf(tab, '#ended'), '');
    await screenshot(tab, 'program_stopped');
    assert.deepEqual(troubles, []);
    await close();
  });

  test('with --control motion waits for the button and its question', async () => {
    const program = run('--page-port', '0', '--control');
    const { tab, close } = await openTab(browser);
    await tab.goto(await program.url());
    await shownAtLeast(tab, 10);
    await tab.keyboard.press('Enter');
    assert.ok(!program.of('event').some(({ kind }) => kind === 'leg_start'), 'no leg before the start');
    assert.equal(program.of('state').at(-1).leg, 0);
    await tab.click('#start');
    await tab.click('#motion .go');
    await until(() => program.of('event').some(({ kind }) => kind === 'leg_start'), 'a leg after it', 30_000);
    await tab.keyboard.press('Space');
    await until(() => program.of('ended').length > 0, 'the run ends', 20_000);
    await close();
  });

  test('a recording says RECORDING and what it keeps, its replay says REPLAY', async () => {
    const program = run('--page-port', '0', '--record', '--output', join(folder, 'recordings'));
    const { tab, close } = await openTab(browser, { dark: true });
    await tab.goto(await program.url());
    await shownAtLeast(tab, 60);
    assert.equal(await textOf(tab, '#mode-word'), 'RECORDING');
    assert.match(await textOf(tab, '#kept'), /[1-9]\d* frames saved/);
    assert.match(await textOf(tab, '#disk'), /[kMGT]B free/);
    await screenshot(tab, 'program_recording');
    await tab.keyboard.press('Space');
    await until(() => program.of('ended').length > 0, 'the run ends', 30_000);
    const { session } = program.of('ended')[0];
    await until(async () => (await textOf(tab, '#ended')).includes(session), 'the page names the session');
    await program.ended;
    const replay = new Program(folder, ['--replay', session, ...(existsSync(model) ? ['--model', model] : []), '--page-port', '0']);
    running.push(replay);
    await tab.goto('about:blank');  // the address may be the same
    await tab.goto(await replay.url());
    await until(async () => await textOf(tab, '#mode-word') === 'REPLAY', 'the page says REPLAY', 20_000);
    await shownAtLeast(tab, 20);
    assert.match(await tab.title(), /REPLAY/);
    const { index } = await numbersOf(tab);
    const rates = ({ commanded_dps, estimates }) => ({ commanded_dps, estimates });
    const [one, two] = [program, replay].map((run) => rates(run.of('frame').find((message) => message.index === index)));
    assert.deepEqual(one, two, 'the same estimates');
    await screenshot(tab, 'program_replay');
    await tab.keyboard.press('m');
    await until(() => replay.of('event').some(({ kind }) => kind === 'mark'), 'its mark is seen, though it is kept nowhere');
    await close();
  });

  test('M is an event of the run', async () => {
    const program = run('--page-port', '0');
    const { tab, close } = await openTab(browser);
    await tab.goto(await program.url());
    await shownAtLeast(tab, 5);
    await tab.focus('#note');
    await tab.keyboard.type('the sun <b>came</b> out');
    await tab.keyboard.press('Enter');
    await until(() => program.of('event').some(({ kind, message }) => kind === 'mark' && message.includes('the sun <b>came</b> out')), 'the mark');
    await until(async () => (await textOf(tab, '#events')).includes('the sun <b>came</b> out'), 'on the page');
    await close();
  });

  test('a killed program shows the overlay after 3 s, a restarted one is found within 5 s of the page', async () => {
    const program = run('--page-port', '0');
    const url = await program.url();
    const { tab, troubles, close } = await openTab(browser, { clock: true });
    await tab.goto(url);
    await shownAtLeast(tab, 10);
    await program.kill();
    await pause(100);
    await tab.clock.pauseAt(Date.now() + 1000);
    await tab.clock.runFor(3200);
    assert.equal(await tab.evaluate(() => document.getElementById('silence').hidden), false);
    assert.match(await textOf(tab, '#silence'), /^no data for \d+\.\d s, last frame \d\d:\d\d:\d\d$/);
    const next = run('--page-port', new URL(url).port);
    assert.equal(await next.url(), url, 'the address holds');
    await until(() => next.of('frame').length > 10, 'frames again', 30_000);
    await untilOnItsClock(tab, () => tab.evaluate(() => document.getElementById('silence').hidden), 'found again', 5000);
    await tab.clock.resume();
    await shownAtLeast(tab, 20);
    assert.equal(await textOf(tab, '#warnings'), '');
    assert.deepEqual(troubles, []);
    await close();
  });
});
