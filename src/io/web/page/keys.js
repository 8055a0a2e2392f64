// SPDX-License-Identifier: MIT
import { byId } from './text.js';

/** Keys and the buttons of the same name. Space has a button of its own, wherever the focus is, but in a field that is written in. */
export class Keys {
  /**
   * `actions`: what each key does; `space`: what Space and the button of that id do; `field`: the id of what is written in; `repeated`: the keys
   * that go on while they are held.
   */
  constructor(actions, space, { button = 'stop', field = 'note', repeated = [] } = {}) {
    this.actions = actions;
    this.space = space;
    this.field = byId(field);
    this.repeated = repeated;
    // In the capturing phase, so that no element takes Space for itself; a button is pressed by its keyup.
    addEventListener('keydown', (event) => this.down(event), true);
    addEventListener('keyup', (event) => {
      if (event.code === 'Space' && !this.writing(event)) event.preventDefault();
    }, true);
    for (const pressed of document.querySelectorAll('button[data-key]')) {
      pressed.setAttribute('aria-keyshortcuts', pressed.dataset.key.toUpperCase());
      pressed.addEventListener('click', (event) => actions[pressed.dataset.key](event));
    }
    byId(button).addEventListener('click', space);
  }

  writing(event) {
    return event.target === this.field;
  }

  down(event) {
    if (this.writing(event)) return;
    if (event.code === 'Space' || event.key === ' ') {
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) this.space();
      return;
    }
    if (event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]') !== null) return;
    const key = event.key.toLowerCase();
    if (!Object.hasOwn(this.actions, key) || (event.repeat && !this.repeated.includes(key))) return;
    event.preventDefault();
    this.actions[key](event);
  }
}
