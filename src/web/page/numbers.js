// SPDX-License-Identifier: MIT
import { drawBars } from './bars.js';
import { byId, count, fields, fixed, list, number, say, significant, unknown } from './text.js';

const estimators = ['thermal', 'gyro', 'fusion'];
const figures = [
  ['frames counted', 'frames', count],
  ['median e², 10⁻³', 'recent_median_mse', (value) => significant(value * 1000)],
  ['IQR e², 10⁻³', 'recent_iqr_mse', (value) => significant(value * 1000)],
  ['RMSE, deg/s', 'rmse_dps', (value) => fixed(value, 2)],
  ['angle error, deg', 'angle_error_deg', (value) => fixed(value, 1)],
  ['drift, deg/min', 'drift_deg_per_min', (value) => fixed(value, 1)],
];

/** Figures of the three estimators, as the program reckons them. Each cell also has its value unrounded, as data. */
export class Numbers {
  constructor() {
    this.table = byId('numbers');
    this.rows = figures.map(([name]) => {
      const row = this.table.tBodies[0].insertRow();
      const head = document.createElement('th');
      head.scope = 'row';
      head.textContent = name;
      row.append(head);
      for (const estimator of estimators) Object.assign(row.insertCell(), { className: 'n', textContent: unknown }).dataset.of = estimator;
      return row;
    });
  }

  show(frame) {
    const scores = fields(frame.scores);
    this.table.dataset.index = number(frame.index) ?? '';
    say(byId('counted'), number(scores.counted) === null ? '' : `· ${count(scores.counted)} frames counted, ${count(scores.apart)} apart (hatched)`);
    figures.forEach(([, key, text], r) => estimators.forEach((estimator, c) => {
      const value = number(fields(scores[estimator])[key]);
      const cell = this.rows[r].cells[c + 1];
      say(cell, value === null ? unknown : text(value));
      cell.dataset.figure = key;
      cell.dataset.value = value ?? '';
    }));
    const time = number(frame.inference_us);
    say(byId('inference'), time === null ? '' : `Inference ${significant(time)} µs.`);
    this.showHistogram(scores);
  }

  showHistogram(scores) {
    const bins = list(scores.gain_histogram).slice(0, 20).map((value) => Math.max(0, number(value) ?? 0));
    const total = bins.reduce((sum, value) => sum + value, 0);
    const mean = number(scores.gain_mean);
    say(byId('gain-mean'), mean === null ? '' : `· mean ${fixed(mean, 2)}`);
    const canvas = byId('histogram');
    while (bins.length < 20) bins.push(0);
    drawBars(canvas, bins.map((value) => ({ value, colour: 'kg', mark: null })),
      [{ text: '0', at: 0 }, { text: '0.5', at: 0.5 }, { text: '1', at: 1 }], Math.max(1, ...bins));
    canvas.bins = bins;
    if (Date.now() - (this.described ?? 0) < 5000) return;
    this.described = Date.now();
    const most = bins.indexOf(Math.max(...bins));
    canvas.setAttribute('aria-label', total === 0 ? 'Histogram of Kg: nothing yet' :
      `Histogram of Kg over ${total} counted frames, most between ${(most * 0.05).toFixed(2)} and ${(most * 0.05 + 0.05).toFixed(2)}`);
  }
}
