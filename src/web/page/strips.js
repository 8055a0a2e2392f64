// SPDX-License-Identifier: MIT
import { spansApart } from './hatching.js';
import { shownSeconds } from './history.js';
import { Strip } from './strip.js';
import { byId, fixed, fields, number, say } from './text.js';
import { onThemeChange } from './theme.js';

const estimators = ['thermal', 'gyro', 'fusion'];
const all = ['servo', ...estimators];

/** Least and greatest of the columns where `wanted`, with a margin, never narrower than `least` around zero. */
function extremes(rows, columns, wanted, least) {
  let low = -least;
  let high = least;
  for (const column of columns) {
    column.forEach((value, i) => {
      if (value === null || !wanted(rows[i])) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    });
  }
  const margin = (high - low) * 0.06;
  return [low - margin, high + margin];
}

/** Frames apart may lie anywhere; they set the scale only where there are no others. */
function countedFirst(least) {
  return (rows, columns) => {
    const counted = rows.some((row) => row.counted && !row.gap);
    return extremes(rows, columns, (row) => row.counted || !counted, least);
  };
}

const everything = (least) => (rows, columns) => extremes(rows, columns, () => true, least);

/** The four plots over time, with one cursor and one time axis. */
export class Strips {
  constructor(history) {
    this.history = history;
    this.paused = false;
    this.offsets = { thermal: 0, gyro: 0, fusion: 0 };
    const of = (kind) => (row) => estimators.map((key) => row[kind][key]);
    this.error = new Strip('error', { keys: estimators, read: of('errors'), limits: countedFirst(2), digits: 1, axis: true });
    this.rate = new Strip('rate', { keys: all, read: (row) => [row.commanded, ...of('values')(row)], limits: everything(10), digits: 1 });
    this.angle = new Strip('angle', { keys: estimators, read: (row) => this.shownAngles(row), limits: everything(1), digits: 1, unit: '°' });
    this.gain = new Strip('gain', { keys: ['kg'], read: (row) => [row.gain], limits: () => [-0.02, 1.02], digits: 2, sign: false, axis: true, ticks: [0, 0.5, 1] });
    this.strips = [this.error, this.rate, this.angle, this.gain];
    for (const strip of this.strips) this.explain(strip);
    onThemeChange(() => this.strips.forEach((strip) => strip.redraw()));
  }

  shownAngles(row) {
    return estimators.map((key) => (row.angles[key] === null ? null : row.angles[key] - this.offsets[key]));
  }

  /** Why a frame is not counted, beside the pointer. */
  explain(strip) {
    const tip = byId('tip');
    strip.box.addEventListener('pointermove', (event) => {
      const row = strip.rows[strip.plot.posToIdx(event.clientX - strip.plot.over.getBoundingClientRect().left)];
      if (row === undefined || row.gap || row.counted) {
        tip.hidden = true;
        return;
      }
      say(tip, `frame ${row.index}, not counted: ${(row.apart || row.reasons.join(', ')).replaceAll('_', ' ') || 'no reason given'}`);
      tip.hidden = false;
      tip.style.left = `${Math.min(event.clientX + 12, innerWidth - tip.offsetWidth - 8)}px`;
      tip.style.top = `${Math.max(4, event.clientY - tip.offsetHeight - 8)}px`;
    });
    strip.box.addEventListener('pointerleave', () => {
      tip.hidden = true;
    });
  }

  withFusion(there) {
    this.gain.section.hidden = !there;
  }

  draw(now) {
    if (this.paused) return;
    const { rows } = this.history;
    const end = Math.max(now ?? 0, this.history.last?.time ?? 0, shownSeconds);
    const spans = spansApart(rows);
    const shown = [...rows];  // of its own: what is drawn while paused stays as it is
    for (const strip of this.strips) strip.draw(shown, spans, [end - shownSeconds, end]);
  }

  resetAngle() {
    const last = this.history.last;
    for (const key of estimators) this.offsets[key] = last?.angles[key] ?? 0;
    this.zero = new Date().toLocaleTimeString('en-GB');
    this.angle.draw(this.angle.rows, this.angle.spans, this.angle.window);
    this.showDrift(this.scores);
  }

  clear() {
    this.offsets = { thermal: 0, gyro: 0, fusion: 0 };
    this.zero = undefined;
    this.showDrift({});
  }

  showDrift(scores) {
    this.scores = scores;
    const drifts = estimators.map((key) => [key, number(fields(fields(scores)[key]).drift_deg_per_min)])
      .filter(([, drift]) => drift !== null).map(([key, drift]) => `${key} ${fixed(drift, 1, { sign: true })}`);
    const zero = this.zero === undefined ? '' : `${drifts.length > 0 ? ' · ' : ''}zero set at ${this.zero}, on this page only`;
    say(byId('zero'), (drifts.length > 0 ? `drift of the run, °/min: ${drifts.join(', ')}` : '') + zero);
  }
}
