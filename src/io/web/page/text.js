// SPDX-License-Identifier: MIT
// Whatever comes in a message is hostile until it has passed one of these.

/** A finite number, or null. */
export function number(value) {
  return typeof value === 'number' && Number.isFinite(value) ? value : null;
}

/** An object to read fields from, whatever came. */
export function fields(value) {
  return value !== null && typeof value === 'object' && !Array.isArray(value) ? value : {};
}

export function list(value) {
  return Array.isArray(value) ? value : [];
}

// Drawn as nothing, or turns what follows: thermorig/core/code_point.h has the same.
const unseen = /(?![\ufe0e\ufe0f])[\u007f-\u009f\u2028\u2029\ufff9-\ufffb\p{Default_Ignorable_Code_Point}]/gu;

/** A text with control and invisible characters made visible, of bounded length. For textContent only. */
export function plain(value, longest = 500) {
  if (typeof value === 'number' || typeof value === 'boolean') return String(value);
  if (typeof value !== 'string') return '';
  const shown = value.slice(0, longest).replace(/[\u0000-\u001f]/g, (c) => String.fromCharCode(0x2400 + c.charCodeAt(0)))
    .replace(unseen, '\u2421');
  return value.length > longest ? `${shown}…` : shown;
}

export const unknown = '–';

/** With a real minus sign, so that columns stand still. */
export function fixed(value, digits, { sign = false } = {}) {
  const known = number(value);
  if (known === null) return unknown;
  if (Math.abs(known) >= 1e7) return known.toExponential(2);
  const text = Math.abs(known).toFixed(digits);
  const zero = Number(text) === 0;
  return `${known < 0 && !zero ? '−' : sign && !zero ? '+' : ''}${text}`;
}

export function count(value) {
  const known = number(value);
  return known === null ? unknown : Math.round(known).toLocaleString('en-GB').replaceAll(',', '\u202f');
}

/** Three significant digits, without an exponent for what is usual. */
export function significant(value) {
  const known = number(value);
  if (known === null) return unknown;
  if (known === 0) return '0';
  const size = Math.abs(known);
  if (size >= 1e6 || size < 1e-5) return known.toExponential(1);
  return size >= 100 ? known.toFixed(0) : known.toPrecision(3);
}

/** Seconds as m:ss or h:mm:ss. */
export function clock(seconds) {
  const known = number(seconds);
  if (known === null) return unknown;
  const whole = Math.max(0, Math.floor(known));
  const two = (n) => String(n).padStart(2, '0');
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${two(minutes)}:${two(whole % 60)}`;
}

export function bytes(value) {
  const known = number(value);
  if (known === null) return unknown;
  for (const [unit, size] of [['TB', 1e12], ['GB', 1e9], ['MB', 1e6], ['kB', 1e3]]) {
    if (known >= size) return `${Number((known / size).toPrecision(3))} ${unit}`;
  }
  return `${known} B`;
}

/** Sets a text only where it changed: a screen reader hears of changes, not of frames. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export const byId = (id) => document.getElementById(id);
