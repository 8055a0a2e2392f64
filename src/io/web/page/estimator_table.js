// SPDX-License-Identifier: MIT
import { noEstimate, scoresOf, stateText, valuesText } from './estimators.js';
import { lineSample } from './line_sample.js';
import { byId, count, fields, fixed, number, say, significant, unknown } from './text.js';

const leastDriftSeconds = 10;  // integrated over less, a drift says nothing

const signed = (value) => fixed(value, 1, { sign: true });
const thousandths = (value) => significant(value * 1000);

/** What a frame says: `of` an estimate, with its sigma. */
const frameColumns = [
  { of: 'rate', sigma: 'rateSigma', label: 'rate', unit: 'deg/s', text: signed },
  { of: 'error', label: 'difference', unit: 'deg/s', text: signed },
  { of: 'angle', sigma: 'angleSigma', label: 'angle error', unit: 'deg', text: signed },
];
/** What the scores say: the field of that name. */
const scoreColumns = [
  { of: 'frames', label: 'frames', unit: 'counted', text: count },
  { of: 'recent_median_mse', label: 'median e²', unit: '10⁻³', text: thousandths },
  { of: 'recent_iqr_mse', label: 'IQR e²', unit: '10⁻³', text: thousandths },
  { of: 'rmse_dps', label: 'RMSE', unit: 'deg/s', text: (value) => fixed(value, 2) },
  { of: 'drift_deg_per_min', label: 'drift, °/min', unit: '', text: signed },
];
const columns = [...frameColumns, ...scoreColumns];

const driftColumn = columns.findIndex(({ of }) => of === 'drift_deg_per_min');

const make = (kind, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
};

const sigmaText = (value) => (value === null ? '' : `±${fixed(value, value < 1 ? 2 : 1)}`);

/** A row an estimator: its line, which a click on the name switches off and on, what it says, and what became of it. */
export class EstimatorTable {
  /** `onSwitch()` when a line was switched, `onHighlight(estimator)` for the one under the pointer or the focus, or null. */
  constructor(onSwitch, onHighlight) {
    this.table = byId('numbers');
    this.onSwitch = onSwitch;
    this.onHighlight = onHighlight;
    this.heads = columns.map(({ label, unit, sigma }) => make('th', { scope: 'col', className: sigma === undefined ? 'n' : 'n with-sigma' }, label, make('br'), unit));
    this.table.tHead.rows[0].append(make('th', { scope: 'col' }, 'estimator'), ...this.heads, make('th', { scope: 'col' }, 'state, values'));
    this.setEstimators([]);
  }

  /** The estimators of another run. */
  setEstimators(estimators) {
    this.estimators = estimators;
    this.rows = estimators.map((estimator) => this.makeRow(estimator));
    this.table.tBodies[0].replaceChildren(...this.rows.map(({ row }) => row));
    this.table.hidden = estimators.length === 0;
    byId('no-estimators').hidden = estimators.length > 0;
    byId('titles').replaceChildren(...estimators.flatMap(({ label, title, line }) =>
      [make('dt', {}, lineSample(line), ` ${label}`), make('dd', {}, title || 'without a description')]));
    this.showScores({});
    this.showFrame(null, [], '');
  }

  makeRow(estimator) {
    const row = make('tr', {}, make('th', { scope: 'row' }, this.makeSwitch(estimator)));
    row.addEventListener('pointerenter', () => this.onHighlight(estimator));
    row.addEventListener('pointerleave', () => this.onHighlight(null));
    const cells = columns.map((column) => {
      const cell = make('td', { className: 'n' }, make('span', { className: 'value' }), ...(column.sigma === undefined ? [] : [make('small', { className: 'sigma' })]));
      Object.assign(cell.dataset, { estimator: estimator.name, figure: column.of, label: `${column.label}, ${column.unit}` });
      return cell;
    });
    const remarks = ['state', 'values', 'title'].map((className) => make('span', { className }));
    say(remarks[2], estimator.title);
    row.append(...cells, make('td', { className: 'remarks', title: estimator.title }, ...remarks));
    return { row, cells, remarks };
  }

  /** The name with its line, as the button that switches the line. */
  makeSwitch(estimator) {
    const button = make('button', { type: 'button', title: `${estimator.title} (a click switches its lines off or on)` }, lineSample(estimator.line),
      make('span', {}, estimator.label));
    const press = () => button.setAttribute('aria-pressed', String(estimator.shown));
    press();
    button.addEventListener('click', () => {
      estimator.shown = !estimator.shown;
      press();
      this.onSwitch();
      this.onHighlight(estimator);
    });
    button.addEventListener('focus', () => button.matches(':focus-visible') && this.onHighlight(estimator));
    button.addEventListener('blur', () => this.onHighlight(null));
    return button;
  }

  showValue(cell, { text }, value) {
    say(cell.firstChild, value === null ? unknown : text(value));
    cell.dataset.value = value ?? '';
  }

  /** `row` of the history, or null; its angle errors as they are shown; `which` frame it is, in words. */
  showFrame(row, angles, which) {
    say(byId('which'), row === null ? '' : `· rates and angles of ${which}`);
    this.rows.forEach(({ row: line, cells, remarks }, i) => {
      const estimate = row?.estimates[i] ?? noEstimate;
      frameColumns.forEach((column, c) => {
        this.showValue(cells[c], column, column.of === 'angle' ? angles[i] ?? null : estimate[column.of]);
        if (column.sigma !== undefined) say(cells[c].lastChild, sigmaText(estimate[column.sigma]));
      });
      say(remarks[0], row === null || row.gap ? '' : stateText(estimate));
      line.dataset.state = row === null || row.gap ? '' : estimate.state;
      say(remarks[1], valuesText(this.estimators[i], estimate));
    });
  }

  /** `frame`: a message, of which the scores are shown. */
  showScores(frame) {
    const scores = fields(frame.scores);
    const seconds = number(scores.integrated_s);
    const lasts = seconds !== null && seconds >= leastDriftSeconds;
    this.table.dataset.index = number(frame.index) ?? '';
    say(byId('counted'), number(scores.counted) === null ? '' : `· ${count(scores.counted)} frames counted, ${count(scores.excluded)} excluded (hatched)`);
    const over = lasts ? `over ${count(seconds)} s` : `from ${leastDriftSeconds} s on`;
    this.heads[driftColumn].lastChild.data = over;
    this.rows.forEach(({ cells }, i) => {
      const own = scoresOf(frame, this.estimators[i]);
      scoreColumns.forEach((column, c) => {
        const value = number(own[column.of]);
        this.showValue(cells[frameColumns.length + c], column, column.of === columns[driftColumn].of && !lasts ? null : value);
      });
      cells[driftColumn].dataset.label = `${columns[driftColumn].label} ${over}`;
    });
    const time = number(frame.inference_us);
    say(byId('inference'), time === null ? '' : `Inference ${significant(time)} µs.`);
  }
}
