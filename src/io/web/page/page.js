// SPDX-License-Identifier: MIT
// The page of a live run: docs/live_messages.md says what comes, decision 9 who may ask for it.
import { Band } from './band.js';
import { Connection } from './connection.js';
import { EstimatorTable } from './estimator_table.js';
import { estimatorsOf, gainOf, sameEstimators } from './estimators.js';
import { Events } from './events.js';
import { GainHistogram } from './gain_histogram.js';
import { Health } from './health.js';
import { History } from './history.js';
import { Keys } from './keys.js';
import { press, sharedActions } from './shared_actions.js';
import { Strips } from './strips.js';
import { Surroundings } from './surroundings.js';
import { Sweep } from './sweep.js';
import { ThermalImage } from './thermal_image.js';
import { byId, count, fields, fixed, number, plain, say } from './text.js';
import { Warnings } from './warnings.js';

const overlayAfter = 3000;  // ms without a message; states come four a second
const stoppedOnRequest = 130;  // exit code
const closingTime = 60_000;  // ms in which a program that closes its file may say nothing
const calmly = matchMedia('(prefers-reduced-motion: reduce)');
// ms between drawings: at most a third of the time goes into them
const drawnEvery = () => Math.max(calmly.matches ? 1000 : 50, 3 * cost);

const history = new History();
const band = new Band();
const warnings = new Warnings();
const image = new ThermalImage();
const surroundings = new Surroundings();
const table = new EstimatorTable(() => strips.showLines(), (estimator) => strips.highlight(estimator));
const histogram = new GainHistogram();
const strips = new Strips(history, (row, angles, pointed) =>
  table.showFrame(row, angles, pointed ? `frame ${row?.index}, under the pointer` : strips?.paused ? `frame ${row?.index}, paused` : 'the newest frame'));
const health = new Health();
const sweep = new Sweep();
const events = new Events();

let run = null;          // its id; two replays of one session have two
let estimators = [];     // of the run
let ended = false;
let refused = false;     // the program does not take our token: nothing will come
let closing = false;     // done, but the file is still written
let now = null;          // newest time_s
let frame = null;        // newest frame's message, not yet shown
let newest = null;       // the newest frame's message
let lastHeard = Date.now();
let lastFrame = null;    // its time of day
let dropped = { frames: 0, events: 0 };
let drawn = -Infinity;
let cost = 0;            // ms of the last drawing
let waiting = false;

/** Draws soon, but not with every message. */
function redraw() {
  if (waiting) return;
  waiting = true;
  setTimeout(() => requestAnimationFrame(() => {
    waiting = false;
    drawn = Date.now();
    const begun = performance.now();
    image.draw();
    surroundings.draw(newest, image.table, image.range);
    strips.draw(now);
    if (frame !== null) showScores(frame);
    frame = null;
    // Painting comes after the script: the next picture tells how long both took.
    requestAnimationFrame(() => {
      cost = Math.min(400, performance.now() - begun);
    });
  }), Math.max(0, drawn + drawnEvery() - Date.now()));
}

function showScores(message) {
  table.showScores(message);
  histogram.show(message);
}

function clear() {
  history.clear(estimators);
  strips.clear();
  image.clear();
  surroundings.clear();
  events.clear();
  warnings.clear();
  frame = newest = null;
  now = null;
  dropped = { frames: 0, events: 0 };
  ended = false;
  closing = false;
  byId('stop').disabled = false;
  health.runIsOver(false);
  sweep.clear();
  connection.expectSilence(0);
  byId('ended').hidden = true;
  byId('ended').replaceChildren();
  showScores({});
}

/** The estimators of a run. False if they are those of the run before, whose lines may be switched off. */
function takeEstimators(message) {
  const listed = estimatorsOf(message.estimators);
  const others = !sameEstimators(listed.estimators, estimators);
  if (others) {
    estimators = listed.estimators;
    for (const view of [strips, table, histogram]) view.setEstimators(estimators);
  }
  warnings.set('estimators', listed.left <= 0 ? '' : `${count(listed.left)} more ${listed.left === 1 ? 'estimator runs' : 'estimators run'} than this page shows.`);
  return others;
}

/** What the page cannot show of this run, in a sentence. */
function showNoGain(model) {
  const there = estimators.some((estimator) => gainOf(estimator) >= 0);
  byId('no-gain').hidden = there || estimators.length === 0;
  say(byId('no-gain'), model === null || model === undefined ? 'No network runs, so there is no fusion gain Kg.'
    : 'No estimator of this run has a fusion gain Kg.');
}

const takers = {
  hello(message) {
    refused = false;
    byId('stop').hidden = false;
    const name = plain(message.run, 40);
    const others = takeEstimators(message);
    if (name !== run || others) clear();
    run = name;
    history.expect(message.frame_rate_hz);
    band.hello(message);
    sweep.hello(message);
    showNoGain(message.model);
    const model = fields(message.model);
    warnings.set('model', model.simulated === true && message.simulated !== true
      ? `${plain(model.name, 80)} was trained on data of a simulated rig; its errors here say little.` : '');
    warnings.set('token', '');
  },
  state(message) {
    now = Math.max(now ?? 0, number(message.time_s) ?? 0);
    if (!ended) {
      closing = message.phase === 'done';
      connection.expectSilence(closing ? closingTime : 0);
    }
    health.runIsOver(ended || closing);
    sweep.runIsOver(ended || closing);
    band.state(message);
    sweep.show(message);
    const unwell = health.show(message.devices);
    warnings.set('devices', unwell.length === 0 ? '' : `${unwell.join(', ')}.`);
    if (message.phase === 'done' || message.stopping === true) warnings.set('stop', '');
  },
  frame(message) {
    if (!history.add(message)) return;
    now = Math.max(now ?? 0, history.last.time);
    frame = newest = message;
    lastFrame = new Date();
    image.freshness(message.fresh);
    const scores = fields(message.scores);
    warnings.set('gate', scores.gate_collapsed === true
      ? 'The gate has collapsed: Kg stays below 0.02 or above 0.98, so fusion follows one sensor alone. Check the network and the gyro.' : '');
  },
  image(message) {
    image.take(message);
  },
  surroundings(message) {
    surroundings.take(message, estimators);
  },
  event(message) {
    events.add(message);
  },
  ended(message) {
    const exit = number(message.exit);
    const said = plain(message.message) || (exit !== 0 ? '' : band.mode === 'replay' ? 'The replay is over.' : 'The run is complete.');
    ended = true;
    connection.expectSilence(Infinity);
    health.runIsOver(true);
    sweep.runIsOver(true);
    warnings.set('devices', '');
    byId('stop').disabled = true;
    band.ended();
    const texts = [said, message.advice, plain(message.session) && `Session: ${plain(message.session)}`].map((text) => plain(text, 1000));
    byId('ended').replaceChildren(...texts.filter((text) => text !== '').map((text, i) => {
      const paragraph = document.createElement(i === 0 ? 'strong' : 'p');
      paragraph.textContent = text;
      return paragraph;
    }));
    byId('ended').dataset.well = exit === null || exit === 0 ? 'yes' : exit === stoppedOnRequest ? 'stopped' : 'no';
    byId('ended').hidden = byId('ended').childElementCount === 0;
  },
  dropped(message) {
    dropped.frames += Math.max(0, number(message.frames) ?? 0);
    dropped.events += Math.max(0, number(message.events) ?? 0);
    const what = [[dropped.frames, 'frame'], [dropped.events, 'event']].filter(([lost]) => lost > 0)
      .map(([lost, noun]) => `${count(lost)} ${noun}${lost === 1 ? '' : 's'}`);
    warnings.set('dropped', what.length === 0 ? '' : `${what.join(' and ')} did not reach this page, which was too slow; a recording has them.`);
  },
};

function take(message) {
  lastHeard = Date.now();
  showSilence();
  if (Object.hasOwn(takers, message.event)) takers[message.event](message);
  // Between frames a state moves nothing that is drawn; without frames the time axis goes on.
  if (message.event !== 'state' || Date.now() - (lastFrame?.getTime() ?? 0) > 500) redraw();
}

function refuse() {
  const other = connection?.token ? 'This address is of another program or of an earlier run' : 'This address has no token';
  band.refused();
  refused = true;
  byId('stop').hidden = true;  // it would stop nothing
  warnings.set('token', `${other}. Open the address that thermorig printed (it ends with #t=…).`);
}

/** Over everything but the band: nothing comes, and what is seen is old. */
function showSilence() {
  const silent = Date.now() - lastHeard;
  const patience = closing && connection.isOpen ? closingTime : overlayAfter;  // a program that closes its file holds the stream
  const over = silent > patience && !ended && !refused;
  byId('silence').hidden = !over;
  band.silence(over);
  if (!over) {
    warnings.set('silence', '');
    return;
  }
  warnings.set('silence', run === null ? 'The program has not answered yet; trying again.' : 'The connection to the program is lost; trying again. The run probably goes on.');
  const last = lastFrame === null ? 'no frame yet' : `last frame ${lastFrame.toLocaleTimeString('en-GB')}`;
  say(byId('silence').firstElementChild, `no data for ${fixed(silent / 1000, 1)} s, ${last}`);
}

async function stop() {
  if (ended) return;
  byId('stop').dataset.pressed = 'yes';
  const trouble = await connection.order('/stop', {});
  delete byId('stop').dataset.pressed;
  warnings.set('stop', trouble === '' ? '' :
    `Stop did not reach the program: ${trouble}. Press Ctrl-C where thermorig runs, or cut the servo's power.`);
  if (trouble === '') say(byId('announcement'), 'Stop sent');
}

async function mark() {
  const note = byId('note').value.trim();
  const trouble = await connection.order('/mark', { note });
  warnings.set('mark', trouble === '' ? '' : `The mark was not set: ${trouble}.`);
  if (trouble !== '') return;
  byId('note').value = '';
  say(byId('announcement'), 'Mark set');
}

const actions = {
  m: mark,
  p() {
    strips.paused = !strips.paused;
    press('p', strips.paused);
    byId('hint').hidden = !strips.paused;
    say(byId('hint'), strips.paused ? 'Plots are paused, the recording is not. P resumes them.' : '');
    redraw();
  },
  r: () => strips.resetAngle(),
  ...sharedActions(image),
};

byId('note').addEventListener('keydown', (event) => {
  if (event.key === 'Enter') mark();
  if (event.key === 'Escape') byId('note').blur();
});
byId('start').addEventListener('click', () => byId('motion').showModal());
byId('motion').addEventListener('close', async () => {
  const wanted = byId('motion').returnValue === 'start';
  byId('motion').returnValue = '';
  if (!wanted) return;
  const trouble = await connection.order('/start', {});
  warnings.set('start', trouble === '' ? '' : `The sweep was not started: ${trouble}.`);
});

say(byId('elsewhere'), 'This page opens only on the computer of the rig. From another one, or from a phone with an app for SSH, open a tunnel'
  + ` (ssh -L ${location.port}:127.0.0.1:${location.port} USER@COMPUTER), then the same address there.`);
health.show({});
showScores({});
strips.draw(null);
let connection = null;
new Keys(actions, stop);
connection = new Connection(take, refuse);
setInterval(showSilence, 100);
