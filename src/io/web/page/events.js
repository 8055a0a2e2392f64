// SPDX-License-Identifier: MIT
import { byId, clock, number, plain } from './text.js';

const shown = 5;
const kept = 300;

/** What happened, newest first. */
export class Events {
  constructor() {
    this.clear();
    byId('all-events').addEventListener('click', () => {
      this.fill(byId('history').querySelector('ol'), this.events);
      byId('history').showModal();
    });
  }

  clear() {
    this.events = [];
    this.keys = new Set();
    this.fill(byId('events').querySelector('ol'), []);
  }

  add(message) {
    const event = { time: number(message.time_s), kind: plain(message.kind, 40), source: plain(message.source, 40), text: plain(message.message, 400) };
    const key = JSON.stringify(event);
    if (this.keys.has(key)) return;  // a page that comes back is told again
    this.keys.add(key);
    this.events.unshift(event);
    for (const old of this.events.splice(kept)) this.keys.delete(JSON.stringify(old));
    this.fill(byId('events').querySelector('ol'), this.events.slice(0, shown));
  }

  fill(element, events) {
    element.replaceChildren(...events.map((event) => {
      const item = document.createElement('li');
      const time = document.createElement('time');
      const kind = document.createElement('b');
      time.textContent = clock(event.time);
      kind.textContent = event.kind.replaceAll('_', ' ') || 'event';
      item.append(time, ' ', kind, ` ${[event.source, event.text].filter((text) => text !== '').join(': ')}`);
      item.title = event.text;
      return item;
    }));
    if (events.length > 0) return;
    const item = document.createElement('li');
    item.className = 'none';
    item.textContent = 'none yet';
    element.append(item);
  }
}
