// SPDX-License-Identifier: MIT
import { drawBars } from './bars.js';
import { gainOf } from './estimators.js';
import { byId, fields, fixed, list, number, say } from './text.js';

/** How often the fusion trusted whom: shown where an estimator of the run has a gain. */
export class GainHistogram {
  constructor() {
    this.setEstimators([]);
  }

  setEstimators(estimators) {
    const fusion = estimators.find((estimator) => gainOf(estimator) >= 0);
    byId('histogram-part').hidden = fusion === undefined;
    this.colour = fusion?.line.colour ?? 'bar';
  }

  show(frame) {
    const scores = fields(frame.scores);
    const bins = list(scores.gain_histogram).slice(0, 20).map((value) => Math.max(0, number(value) ?? 0));
    const total = bins.reduce((sum, value) => sum + value, 0);
    const mean = number(scores.gain_mean);
    say(byId('gain-mean'), mean === null ? '' : `· mean ${fixed(mean, 2)}`);
    const canvas = byId('histogram');
    while (bins.length < 20) bins.push(0);
    drawBars(canvas, bins.map((value) => ({ value, colour: this.colour, mark: null })),
      [{ text: '0', at: 0 }, { text: '0.5', at: 0.5 }, { text: '1', at: 1 }], Math.max(1, ...bins));
    canvas.bins = bins;
    if (Date.now() - (this.described ?? 0) < 5000) return;
    this.described = Date.now();
    const most = bins.indexOf(Math.max(...bins));
    canvas.setAttribute('aria-label', total === 0 ? 'Histogram of Kg: nothing yet' :
      `Histogram of Kg over ${total} counted frames, most between ${(most * 0.05).toFixed(2)} and ${(most * 0.05 + 0.05).toFixed(2)}`);
  }
}
