// SPDX-License-Identifier: MIT
import { byId, clock, count, fields, fixed, list, number, plain, say } from './text.js';

const mostShown = 300;
const quietKinds = ['leg_start', 'leg_end'];  // the legs have a list of their own

const make = (kind, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
};

/** A moment of the session to a tenth: 1:23.4 */
export function moment(seconds) {
  const known = number(seconds);
  if (known === null) return '–';
  const tenths = Math.round(Math.max(0, known) * 10);
  return `${clock(Math.floor(tenths / 10))}.${tenths % 10}`;
}

/** The time of day at that moment, UTC to a tenth of a second; empty if the start is not known. */
export function timeOfDay(startUtc, seconds) {
  const start = Date.parse(plain(startUtc, 40));
  if (!Number.isFinite(start) || number(seconds) === null || Math.abs(seconds) > 1e9) return '';
  return `${new Date(start + 1000 * seconds).toISOString().slice(0, 21).replace('T', ' ')} UTC`;
}

/** A simulation in words: of a world that turns many knobs, how many. */
export function simulationText(text) {
  const world = text.slice(text.lastIndexOf(' ') + 1);
  const knobs = world.split('=').length - 1;
  return knobs > 3 ? `${text.slice(0, -world.length)}${world.split(',')[0]} (${knobs} knobs)` : text;
}

/** What stands beside the frames. */
export class SessionFacts {
  /** `goTo(begin, end)`: shows that part of the session. */
  constructor(facts, goTo) {
    this.facts = facts;
    this.goTo = goTo;
    this.showBand();
    this.showVerdict();
    this.showList();
    this.showAnnotations();
    this.showEvents();
    this.showLegs();
  }

  showBand() {
    const { facts } = this;
    say(byId('mode-word'), 'SESSION');
    const state = plain(facts.state, 20);
    if (state !== '' && state !== 'complete') say(byId('mode-word'), `SESSION, ${state}`);
    byId('simulated').hidden = facts.simulated !== true;
    byId('simulated').title = plain(facts.simulation, 500);
    say(byId('environment'), plain(facts.environment, 60));
    say(byId('acquisition'), number(facts.acquisition) === null ? '' : `acquisition ${count(facts.acquisition)}`);
    say(byId('started'), timeOfDay(facts.start_utc, 0).replace(/\.\d UTC$/, ' UTC'));
    say(byId('plan'), `plan ${plain(facts.plan, 60)}`);
    say(byId('length'), `${clock(facts.duration_s)}, ${count(facts.frames)} frames`);
    document.title = `${plain(facts.file, 80)} · thermorig`;
  }

  showVerdict() {
    const verdict = plain(this.facts.verdict, 20) || 'unknown';
    byId('verdict').hidden = false;
    byId('verdict').dataset.verdict = verdict;
    say(byId('verdict'), `verdict: ${verdict}`);
    const reasons = list(this.facts.verdict_reasons).slice(0, 50).map((reason) => plain(reason, 1000));
    if (this.facts.verdict_altered === true) reasons.unshift('The verdict was changed after thermorig had written it.');
    const share = (part, of) => (of > 0 ? ` (${fixed((100 * part) / of, 1)} %)` : '');
    reasons.push(`${count(this.facts.frames_valid)} of ${count(this.facts.frames_swept)} frames in legs are valid${share(this.facts.frames_valid, this.facts.frames_swept)}`);
    byId('verdict-reasons').replaceChildren(...reasons.map((reason) => make('li', { textContent: reason })));
  }

  showList() {
    const { facts } = this;
    const bias = number(facts.gyro_bias_dps);
    const simulation = facts.simulated === true ? `SIMULATED: ${simulationText(plain(facts.simulation, 5000))}${number(facts.seed) === null ? '' : `, seed ${facts.seed}`}` : 'recorded from ports';
    const entries = [['file', facts.file], ['world', simulation], ['plan', `${plain(facts.plan, 60)}, ${count(facts.frames_per_leg)} frames a leg`],
      ['camera', `${plain(facts.camera_mode, 30)}, ${fixed(1 / facts.frame_period_s, 2)} frames/s`],
      ['gyro', `bias ${fixed(bias, 3, { sign: true })} deg/s${facts.gyro_bias_moves === true ? ', which moves' : ''}; scale ${fixed(facts.gyro_scale, 4)}`],
      ['network', facts.model], ['operator', facts.operator], ['place', facts.place], ['note', facts.note], ['licence', facts.licence], ['servo', facts.firmware], ['shaft', facts.shaft], ['made by', facts.creator]];
    byId('facts').replaceChildren(...entries.map(([name, value]) => [name, plain(value, 1000)]).filter(([, value]) => value !== '')
      .flatMap(([name, value]) => [make('dt', { textContent: name }), make('dd', { textContent: value })]));
  }

  /** A list of what can be gone to; hidden if it is empty. `entries`: text, begin and end, or no times. */
  fill(id, entries, all) {
    const section = byId(id);
    section.hidden = entries.length === 0;
    say(section.querySelector('small'), all > mostShown ? `the first ${count(Math.min(mostShown, entries.length))} of ${count(all)}` : count(all));
    section.querySelector('ol').replaceChildren(...entries.slice(0, mostShown).map(({ text, begin, end }) => {
      if (begin === null) return make('li', { textContent: text });
      const button = make('button', { type: 'button' }, make('time', { textContent: moment(begin) }), ` ${text}`);
      button.addEventListener('click', () => this.goTo(begin, end));
      return make('li', {}, button);
    }));
  }

  showAnnotations() {
    const annotations = list(this.facts.annotations).map(fields);
    const notes = annotations.filter(({ kind }) => kind !== 'exclusion');
    const excluded = annotations.filter(({ kind }) => kind === 'exclusion');
    this.fill('annotations', notes.map(({ kind, text }) => ({ text: kind === 'environment' ? `belongs to ${plain(text, 100)}` : plain(text, 1000), begin: null })), notes.length);
    this.fill('excluded', excluded.map(({ begin_s, end_s, text }) => ({ text: `to ${moment(end_s)}${plain(text) === '' ? '' : `: ${plain(text, 500)}`}`,
      begin: number(begin_s), end: number(end_s) })), excluded.length);
  }

  showEvents() {
    const events = list(this.facts.events).map(fields).filter(({ kind }) => !quietKinds.includes(kind));
    this.fill('events', events.map(({ time_s, kind, message }) => ({ text: `${plain(kind, 30).replaceAll('_', ' ')}${plain(message) === '' ? '' : `: ${plain(message, 300)}`}`,
      begin: number(time_s), end: number(time_s) })), events.length);
  }

  showLegs() {
    const legs = list(this.facts.legs).map(fields);
    this.fill('legs', legs.map(({ leg, rate_dps, begin_s, end_s, complete }) => ({ text: `leg ${count(leg)}: ${fixed(rate_dps, 1, { sign: true })} deg/s${complete === false ? ', cut short' : ''}`,
      begin: number(begin_s), end: number(end_s) })), number(this.facts.leg_count) ?? legs.length);
  }

  /** What drove in a leg, in words. */
  legText(leg) {
    if (!(leg > 0)) return 'outside legs';
    const driven = list(this.facts.legs).map(fields).find((each) => each.leg === leg);
    return `leg ${leg}${driven === undefined ? '' : `, ${fixed(driven.rate_dps, 1, { sign: true })} deg/s`}`;
  }

  /** The names of a frame's reasons. */
  reasonNames(bits) {
    return list(this.facts.reason_names).filter((name, i) => i < 32 && ((bits >>> i) & 1) === 1).map((name) => plain(name, 60).replaceAll('_', ' '));
  }
}
