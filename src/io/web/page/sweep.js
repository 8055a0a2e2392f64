// SPDX-License-Identifier: MIT
import { drawBars } from './bars.js';
import { byId, clock, count, fields, fixed, list, number, plain, say } from './text.js';

const signed = (value) => fixed(value, 0, { sign: true });

/** The speed of the leg that is driven; between legs there is none. */
const rateOfLeg = (state) => (state.phase === 'leg' ? number(state.rate_dps) : null);

/** Where the sweep is, and what each speed has so far. */
export class Sweep {
  constructor() {
    this.clear();
  }

  clear() {
    this.over = false;
    this.show({});
    say(byId('leg'), 'no sweep yet');
  }

  /** Nothing is driven any more (or is again): no leg is counted. */
  runIsOver(over) {
    if (this.over === over) return;
    this.over = over;
    this.show(this.state);
  }

  hello(message) {
    const plan = fields(message.plan);
    const name = plain(plan.name, 60);
    const seconds = number(plan.expected_s);
    say(byId('plan'), name === '' ? '' : `· ${name}${seconds === null ? '' : `, about ${clock(seconds)}`}${plan.repeats === true ? ' a pass, repeated until stopped' : ''}`);
  }

  show(state) {
    this.state = state;
    const share = Math.min(1, Math.max(0, number(state.done_share) ?? 0));
    byId('done').value = share;
    say(byId('leg'), this.over ? this.endText(state, share) : this.legText(state));
    const repeated = number(state.repeated) ?? 0;
    const texts = [this.framesText(state), repeated > 0 ? `${count(repeated)} ${repeated === 1 ? 'leg' : 'legs'} repeated` : ''];
    say(byId('leg-frames'), texts.filter((text) => text !== '').join(', '));
    this.showSpeeds(list(state.speeds), this.over ? null : rateOfLeg(state));
  }

  legText(state) {
    const legs = number(state.leg_count) ?? 0;
    const leg = number(state.leg) ?? 0;
    const now = rateOfLeg(state);
    const next = number(state.next_rate_dps);
    const parts = [];
    if (legs > 0) parts.push(leg > 0 ? `leg ${count(leg)} of ${count(legs)}` : `${count(legs)} legs`);
    if (now !== null) parts.push(`now ${signed(now)}`);
    if (next !== null) parts.push(`next ${signed(next)}`);
    return parts.length === 0 ? 'no sweep' : parts.join(', ') + (now === null && next === null ? '' : ' deg/s');
  }

  endText(state, share) {
    const legs = number(state.leg_count) ?? 0;
    const leg = number(state.leg) ?? 0;
    if (legs === 0) return 'no sweep';
    if (share === 1) return `complete: all ${count(legs)} legs`;
    return leg > 0 ? `ended early: leg ${count(leg)} of ${count(legs)} is not complete` : `ended early, of ${count(legs)} legs`;
  }

  /** Of the leg while one is driven, of the whole sweep after it. */
  framesText(state) {
    if (this.over) {
      const valid = list(state.speeds).map((speed) => Math.max(0, number(fields(speed).valid) ?? 0));
      return valid.length === 0 ? '' : `${count(valid.reduce((sum, frames) => sum + frames, 0))} valid frames`;
    }
    const frames = number(state.frames);
    if (frames === null || state.phase !== 'leg') return '';
    const wanted = number(state.frames_per_leg) ?? 0;
    return `${count(frames)}${wanted === 0 ? '' : ` of ${count(wanted)}`} frames`;
  }

  showSpeeds(speeds, now) {
    const known = speeds.slice(0, 400).map(fields).map((speed) => ({ rate: number(speed.rate_dps), valid: Math.max(0, number(speed.valid) ?? 0),
      quota: Math.max(0, number(speed.quota) ?? 0) })).filter((speed) => speed.rate !== null).sort((a, b) => a.rate - b.rate);
    const canvas = byId('speeds');
    const full = Math.max(1, ...known.map((speed) => Math.max(speed.valid, speed.quota)));
    const bars = known.map((speed) => ({ value: speed.valid, colour: speed.rate === now ? 'now' : 'bar', mark: speed.quota > 0 ? speed.quota : null }));
    document.querySelector('#sweep h3').hidden = known.length === 0;
    canvas.hidden = known.length === 0;
    say(byId('quota'), known.some((speed) => speed.quota > 0) ? 'deg/s; line: quota' : 'deg/s');
    const place = (i) => (i + 0.5) / known.length;
    const labels = known.length === 0 ? [] : [0, known.length - 1].map((i) => ({ text: signed(known[i].rate), at: place(i) }));
    const turn = known.findIndex((speed) => speed.rate > 0);
    if (turn > 2 && turn < known.length - 3) labels.push({ text: '0', at: turn / known.length });
    drawBars(canvas, bars, labels, full);
    canvas.speeds = known;
    if (Date.now() - (this.described ?? 0) < 5000 || known.length === 0) return;
    this.described = Date.now();
    canvas.setAttribute('aria-label', `Valid frames by speed in deg/s: ${known.map(({ rate, valid }) => `${signed(rate)}: ${valid}`).join(', ')}`);
  }
}
