// SPDX-License-Identifier: MIT
import { byId, count, fields, fixed, number, plain, say, unknown } from './text.js';

const expected = ['camera', 'gyro', 'servo'];
const words = { ok: 'ok', late: 'late', waiting: 'waiting', lost: 'lost', absent: 'none', awaited: 'away' };

function ageText(seconds) {
  const age = number(seconds);
  if (age === null) return unknown;
  return age < 1 ? `${fixed(age * 1000, 0)} ms` : `${fixed(age, age < 100 ? 1 : 0)} s`;
}

/** How long the program still waits for it. */
function leftText(device) {
  const left = number(fields(device).left_s);
  return left === null ? '' : `, waited for ${fixed(left, 0)} s more: plug it in again`;
}

function rateText(device) {
  const low = number(device.rate_min_hz);
  const high = number(device.rate_max_hz);
  const digits = (high ?? low ?? 0) < 20 ? 1 : 0;
  if (low === null || high === null) return fixed(low ?? high, digits);
  const [first, second] = [fixed(low, digits), fixed(high, digits)];
  return first === second ? first : `${first}–${second}`;
}

/** A row a device: how its stream is. */
export class Health {
  constructor() {
    this.body = byId('health').tBodies[0];
    this.rows = new Map();
    this.over = false;
    this.devices = {};
  }

  rowOf(name) {
    if (!this.rows.has(name)) {
      const row = this.body.insertRow();
      const head = document.createElement('th');
      head.scope = 'row';
      head.textContent = plain(name, 40);
      row.append(head);
      for (let i = 0; i < 7; ++i) row.insertCell().className = i === 0 ? '' : 'n';
      this.rows.set(name, row);
    }
    return this.rows.get(name);
  }

  /** The run is over (or not, again): nothing is read any more, and no device is late. */
  runIsOver(over) {
    if (this.over === over) return;
    this.over = over;
    this.show(this.devices);
  }

  /** Sentences about devices that are not well. */
  show(devices) {
    this.devices = devices;
    const known = fields(devices);
    const names = [...new Set([...expected, ...Object.keys(known)])].slice(0, 8);
    return names.filter((name) => this.showDevice(name, fields(known[name])))
      .map((name) => `${plain(name, 40)}: ${words[fields(known[name]).state] ?? 'unknown'}${leftText(known[name])}`);
  }

  /** True if the device is not well. */
  showDevice(name, device) {
    const row = this.rowOf(name);
    const state = words[device.state] ?? (plain(device.state, 30) || 'unknown');
    const told = Object.keys(device).length > 0;
    const closed = this.over && told && device.state !== 'lost';
    const well = closed || device.state === 'ok';
    const hz = number(device.expected_hz);
    const sync = number(device.uncertainty_s);
    const texts = [closed ? 'closed' : well ? 'ok' : told ? `▲ ${state}` : unknown, rateText(device), hz === null ? unknown : fixed(hz, hz < 20 ? 1 : 0), closed ? unknown : ageText(device.age_s),
      count(device.lost), count(device.bad), sync === null ? unknown : fixed(sync * 1000, 1)];
    texts.forEach((text, i) => say(row.cells[i + 1], text));
    const skipped = number(device.skipped_bytes);
    row.cells[6].title = skipped === null ? '' : `${count(skipped)} bytes in no valid message`;
    row.className = well || !told ? '' : 'unwell';
    return !this.over && ['late', 'lost', 'awaited'].includes(device.state);
  }
}
