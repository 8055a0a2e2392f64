// SPDX-License-Identifier: MIT
import { gainOf } from './estimators.js';
import { excludedSpans } from './hatching.js';
import { shownSeconds } from './history.js';
import { countedFirst, everything } from './limits.js';
import { lineSample } from './line_sample.js';
import { Strip } from './strip.js';
import { byId, fixed, say } from './text.js';
import { servoLine } from '../../../line_styles.js';
import { onThemeChange } from './theme.js';

/** The four plots over time, with one cursor and one time axis. */
export class Strips {
  /** `onCursor(row, angles, pointed)`: the frame under the pointer, or the newest that is drawn, or null, and its angle errors as they are shown. */
  constructor(history, onCursor) {
    this.history = history;
    this.onCursor = onCursor;
    this.paused = false;
    this.error = new Strip('error', { limits: countedFirst(2), axis: true });
    this.rate = new Strip('rate', { limits: everything(10), onCursor: () => this.showCursor() });
    this.angle = new Strip('angle', { limits: everything(1) });
    this.gain = new Strip('gain', { limits: () => [-0.02, 1.02], axis: true, ticks: [0, 0.5, 1] });
    this.strips = [this.error, this.rate, this.angle, this.gain];
    for (const strip of this.strips) this.explain(strip);
    byId('servo').prepend(lineSample(servoLine));
    this.setEstimators([]);
    onThemeChange(() => this.strips.forEach((strip) => strip.redraw()));
  }

  /** The estimators of another run. */
  setEstimators(estimators) {
    this.estimators = estimators;
    this.offsets = estimators.map(() => 0);
    const lines = (read, sigma) => estimators.map((estimator, i) => ({ estimator, style: estimator.line,
      read: (row) => read(row.estimates[i], i), sigma: (row) => sigma(row.estimates[i]) }));
    this.rate.setLines([{ style: servoLine, read: (row) => row.commanded, sigma: () => null }, ...lines(({ rate }) => rate, ({ rateSigma }) => rateSigma)]);
    this.error.setLines(lines(({ error }) => error, ({ rateSigma }) => rateSigma));
    this.angle.setLines(lines((estimate, i) => this.shownAngle(estimate, i), ({ angleSigma }) => angleSigma));
    const gains = lines(({ values }, i) => values[gainOf(estimators[i])] ?? null, () => null).filter(({ estimator }) => gainOf(estimator) >= 0);
    this.gain.setLines(gains);
    this.gain.section.hidden = gains.length === 0;
    this.showCursor();
  }

  /** The angle error of an estimate since the zero that was set on this page. */
  shownAngle({ angle }, i) {
    return angle === null ? null : angle - this.offsets[i];
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
      say(tip, `frame ${row.index}, not counted: ${(row.excluded || row.reasons.join(', ')).replaceAll('_', ' ') || 'no reason given'}`);
      tip.hidden = false;
      tip.style.left = `${Math.min(event.clientX + 12, innerWidth - tip.offsetWidth - 8)}px`;
      tip.style.top = `${Math.max(4, event.clientY - tip.offsetHeight - 8)}px`;
    });
    strip.box.addEventListener('pointerleave', () => {
      tip.hidden = true;
    });
  }

  draw(now) {
    if (this.paused) return;
    const { rows } = this.history;
    const end = Math.max(now ?? 0, this.history.last?.time ?? 0, shownSeconds);
    const spans = excludedSpans(rows);
    const shown = [...rows];  // of its own: what is drawn while paused stays as it is
    for (const strip of this.strips) strip.draw(shown, spans, [end - shownSeconds, end]);
    this.showCursor();
  }

  showCursor() {
    const { plot, rows } = this.rate;
    const { idx } = plot.cursor;
    const row = rows[idx ?? rows.length - 1] ?? null;
    say(byId('servo').lastElementChild, fixed(row?.commanded, 1, { sign: true }));
    this.onCursor(row, row?.estimates.map((estimate, i) => this.shownAngle(estimate, i)) ?? [], typeof idx === 'number');
  }

  /** Lines that were switched off or on. */
  showLines() {
    for (const strip of this.strips) strip.showLines();
  }

  /** An estimator's lines before the others; null: none. */
  highlight(estimator) {
    for (const strip of this.strips) strip.highlight(estimator);
  }

  resetAngle() {
    const last = this.history.last;
    this.offsets = this.estimators.map((estimator, i) => last?.estimates[i].angle ?? 0);
    this.showZero(`· zero set at ${new Date().toLocaleTimeString('en-GB')}, on this page only`);
    this.angle.draw(this.angle.rows, this.angle.spans, this.angle.window);
    this.showCursor();
  }

  clear() {
    this.offsets = this.estimators.map(() => 0);
    this.showZero('');
  }

  showZero(text) {
    say(byId('zero'), text);
  }
}
