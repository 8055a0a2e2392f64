// SPDX-License-Identifier: MIT
// What the chart library and our own scripts take for granted and an engine of ES5 lacks. Nothing here moves or waits.
const everything = Function('return this')();
everything.global = everything;
everything.globalThis = everything;
everything.setTimeout = () => 0;
everything.clearTimeout = () => {};

function add(owner, name, value) {
  if (owner[name] === undefined) Object.defineProperty(owner, name, { value, writable: true, configurable: true });
}

add(Array, 'from', (source, made) => {
  const list = [];
  for (let i = 0; i < source.length; ++i) list.push(made === undefined ? source[i] : made(source[i], i));
  return list;
});
add(Array.prototype, 'find', function find(fits) {
  for (let i = 0; i < this.length; ++i) if (fits(this[i], i)) return this[i];
  return undefined;
});
add(Array.prototype, 'flatMap', function flatMap(made) {
  return Array.prototype.concat.apply([], this.map((value, i) => made(value, i)));
});
