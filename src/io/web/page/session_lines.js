// SPDX-License-Identifier: MIT
// The lines of a session's plots, and the table that is their legend: what each says of one frame.
import { estimatorsOf, stateText, valuesText } from './estimators.js';
import { lineSample } from './line_sample.js';
import { byId, fixed, list, plain, say } from './text.js';
import { lineOf } from '../../../line_styles.js';

const noEstimate = 255;

const make = (kind, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
};

const minus = (one, other) => Float32Array.from(one, (value, row) => value - other[row]);
const known = (value) => (Number.isFinite(value) ? value : null);

/** The lines of the estimators of a live run; none without. */
function estimatorLinesOf(facts, rows) {
  const told = list(facts.estimators).map((entry) => ({ ...entry, title: '' }));
  const names = told.map(({ name }) => name);
  const { estimators, left } = estimatorsOf(told);
  const window = rows.get('window_dps');
  const lines = estimators.map((estimator) => {
    const prefix = `estimates.${names.indexOf(estimator.name)}`;
    const rate = rows.get(`${prefix}.rate_dps`);
    const [states, reasons] = ['state', 'reason'].map((word) => rows.get(`${prefix}.${word}`));
    const values = estimator.values.map((name, i) => rows.get(`${prefix}.values.${i}`));
    const words = (names_, number) => plain(list(names_)[number], 40).replaceAll('_', ' ');
    return { ...estimator, rate, difference: minus(rate, window), sigma: rows.get(`${prefix}.sigma_dps`),
      remark: (row) => {
        if (!(states[row] < noEstimate)) return '';
        const reason = reasons[row] === 0 ? '' : words(facts.estimate_reason_names, reasons[row]);
        const state = stateText({ state: words(facts.state_names, states[row]), reason });
        return [state, valuesText(estimator, { values: values.map((column) => known(column[row])) })].filter((text) => text !== '').join(' · ');
      } };
  });
  return { lines, left };
}

/** All lines, those of the session itself first, and how many estimators are left out. */
export function linesOf(facts, rows) {
  const commanded = rows.get('commanded_dps');
  const own = (name, label, title, column, sigma = null) => ({ name, label, title, shown: true, line: lineOf(name), rate: rows.get(column),
    difference: name === 'commanded' ? null : minus(rows.get(column), commanded), sigma: sigma === null ? null : rows.get(sigma), remark: () => '' });
  const estimators = estimatorLinesOf(facts, rows);
  return { left: estimators.left, lines: [
    own('commanded', 'commanded', 'the label: commanded speed, mean over the exposure', 'commanded_dps'),
    own('shaft', 'shaft', 'speed of the shaft: measured where a sensor measures it, else from the servo model', 'shaft_dps', 'shaft_sigma_dps'),
    own('gyro-mean', 'gyro mean', 'mean over the exposure, with its bias and scale', 'gyro_dps'),
    own('corrected', 'gyro corrected', 'the same, corrected for the bias and scale that this session knows', 'corrected_dps'),
    ...estimators.lines,
  ] };
}

/** A row a line, for one frame. */
export class LinesTable {
  /** `onSwitch()` when a line was switched, `onHighlight(line)` for the one under the pointer or the focus, or null. */
  constructor(lines, onSwitch, onHighlight) {
    this.lines = lines;
    this.onSwitch = onSwitch;
    this.onHighlight = onHighlight;
    this.rows = lines.map((line) => this.makeRow(line));
    byId('lines').tBodies[0].replaceChildren(...this.rows.flatMap(({ row, remark }) => [row, remark]));
  }

  makeRow(line) {
    const cells = ['rate', 'sigma', 'difference'].map((figure) => {
      const cell = make('td', { className: 'n' });
      Object.assign(cell.dataset, { line: line.name, figure });
      return cell;
    });
    const row = make('tr', {}, make('th', { scope: 'row' }, this.makeSwitch(line)), ...cells);
    row.addEventListener('pointerenter', () => this.onHighlight(line));
    row.addEventListener('pointerleave', () => this.onHighlight(null));
    const remark = make('tr', { className: 'remark', hidden: true }, make('td', { colSpan: 4 }));
    return { row, cells, remark };
  }

  makeSwitch(line) {
    const button = make('button', { type: 'button', title: `${line.title === '' ? '' : `${line.title} `}(a click switches its lines off or on)` }, lineSample(line.line), make('span', { textContent: line.label }));
    button.setAttribute('aria-pressed', 'true');
    button.addEventListener('click', () => {
      line.shown = !line.shown;
      button.setAttribute('aria-pressed', String(line.shown));
      this.onSwitch();
    });
    button.addEventListener('focus', () => this.onHighlight(line));
    button.addEventListener('blur', () => this.onHighlight(null));
    return button;
  }

  show(at) {
    this.rows.forEach(({ cells, remark }, i) => {
      const line = this.lines[i];
      const figures = [line.rate[at], line.sigma?.[at] ?? NaN, line.difference?.[at] ?? NaN];
      cells.forEach((cell, k) => {
        const value = known(figures[k]);
        cell.dataset.value = value ?? '';
        say(cell, value === null ? '' : fixed(value, 2, { sign: k !== 1 }));
      });
      const text = line.remark(at);
      remark.hidden = text === '';
      say(remark.firstElementChild, text);
      remark.firstElementChild.title = text;
    });
  }
}

