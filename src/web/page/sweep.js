// SPDX-License-Identifier: MIT
import { drawBars } from './bars.js';
import { byId, clock, count, fields, fixed, list, number, plain, say } from './text.js';

const signed = (value) => fixed(value, 0, { sign: true });

/** Where the sweep is, and what each speed has so far. */
export class Sweep {
  hello(message) {
    const plan = fields(message.plan);
    const name = plain(plan.name, 60);
    const seconds = number(plan.expected_s);
    say(byId('plan'), name === '' ? '' : `· ${name}${seconds === null ? '' : `, about ${clock(seconds)}`}${plan.repeats === true ? ' a pass, again and again' : ''}`);
  }

  show(state) {
    const legs = number(state.leg_count);
    const leg = number(state.leg);
    const now = number(state.rate_dps);
    const next = number(state.next_rate_dps);
    const parts = [];
    if (legs !== null && legs > 0 && leg !== null) parts.push(`leg ${count(leg)} of ${count(legs)}`);
    if (now !== null) parts.push(`now ${signed(now)}`);
    if (next !== null) parts.push(`next ${signed(next)}`);
    say(byId('leg'), parts.length === 0 ? 'no sweep' : parts.join(', ') + (now === null && next === null ? '' : ' deg/s'));
    const share = number(state.done_share);
    byId('done').value = share === null ? 0 : Math.min(1, Math.max(0, share));
    const frames = number(state.frames);
    const wanted = number(state.frames_per_leg);
    const repeated = number(state.repeated);
    const texts = [];
    if (frames !== null) texts.push(`${count(frames)}${wanted === null || wanted === 0 ? '' : ` of ${count(wanted)}`} frames`);
    if (repeated !== null && repeated > 0) texts.push(`${count(repeated)} ${repeated === 1 ? 'leg' : 'legs'} repeated`);
    say(byId('leg-frames'), texts.join(', '));
    this.showSpeeds(list(state.speeds), now);
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
