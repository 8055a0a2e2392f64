// SPDX-License-Identifier: MIT
import { fixed, fields, list, number, plain } from './text.js';
import { estimatorLines } from '../../../line_styles.js';

const mostEstimators = estimatorLines.length;
const mostValues = 8;
const units = { dps: 'deg/s', deg: 'deg', s: 's', c: 'K' };  // of a temperature: a difference

/** A style of line for each name: its own where it has one, else the next that nobody has. */
function linesFor(names) {
  const free = estimatorLines.filter(({ of }) => !names.includes(of));
  return names.map((name) => estimatorLines.find(({ of }) => of === name) ?? free.shift());
}

/** The estimators that a hello lists, in its order, each with its line. What has no name, or one that was there before, is none. */
export function estimatorsOf(told) {
  const byName = new Map();
  for (const entry of list(told).slice(0, 64).map(fields)) {
    const { name } = entry;
    if (typeof name !== 'string' || name === '' || byName.has(name)) continue;
    byName.set(name, { name, label: plain(name, 40), title: plain(entry.title, 200), shown: true,
      values: list(entry.values).filter((value) => typeof value === 'string' && value !== '').slice(0, mostValues) });
  }
  const estimators = [...byName.values()].slice(0, mostEstimators);
  const styles = linesFor(estimators.map(({ name }) => name));
  return { estimators: estimators.map((estimator, i) => ({ ...estimator, line: styles[i] })), left: byName.size - estimators.length };
}

/** Whether two runs have the same ones. */
export function sameEstimators(some, others) {
  const told = (estimators) => JSON.stringify(estimators.map(({ name, title, values }) => [name, title, values]));
  return told(some) === told(others);
}

/** Where the fusion's gain stands among the values of an estimator; -1 without. */
export const gainOf = (estimator) => estimator.values.indexOf('gain');

/** What the scores of a frame's message say of one estimator. */
export const scoresOf = (message, estimator) => fields(fields(fields(message.scores).estimators)[estimator.name]);

/** A standard deviation, or null. */
function sigma(value) {
  const known = number(value);
  return known === null || known < 0 ? null : known;
}

export const noEstimate = Object.freeze({ rate: null, rateSigma: null, error: null, heading: null, angle: null, angleSigma: null, state: 'absent', reason: '', values: [] });

/** What a frame's message says of one estimator, as numbers and nulls. `error` and `angle` are differences from the servo, `heading` is its own angle. */
export function estimateOf(message, estimator) {
  const told = fields(fields(message.estimates)[estimator.name]);
  const rate = number(told.rate_dps);
  const commanded = number(message.commanded_dps);
  const values = fields(told.values);
  return {
    rate,
    rateSigma: sigma(told.rate_sigma_dps),
    error: rate === null || commanded === null ? null : rate - commanded,
    heading: number(told.angle_deg),
    angle: number(scoresOf(message, estimator).angle_error_deg),
    angleSigma: sigma(told.angle_sigma_deg),
    state: plain(told.state, 30) || 'absent',
    reason: plain(told.reason, 60).replaceAll('_', ' '),
    values: estimator.values.map((name) => number(values[name])),
  };
}

/** State and reason of an estimate that is not good; else nothing. */
export function stateText({ state, reason }) {
  if (state === 'good') return '';
  return `${state === 'starting' ? '◌' : '▲'} ${state}${reason === '' ? '' : `: ${reason}`}`;
}

/** A named value with its unit, which stands at the end of the name. */
function valueText(name, value) {
  const digits = Math.abs(value) < 0.1 && name !== 'gain' ? 4 : 2;
  if (name === 'gain') return `Kg ${fixed(value, digits)}`;
  const [, words, unit] = /^(.*?)(?:_(dps|deg|s|c))?$/s.exec(plain(name, 40));
  return `${words === 'nis' ? 'NIS' : words.replaceAll('_', ' ')} ${fixed(value, digits)}${unit === undefined ? '' : ` ${units[unit]}`}`;
}

/** The named values of an estimate that are known. */
export function valuesText(estimator, estimate) {
  return estimator.values.map((name, i) => [name, estimate.values[i] ?? null]).filter(([, value]) => value !== null)
    .map(([name, value]) => valueText(name, value)).join(', ');
}
