// SPDX-License-Identifier: MIT
import { byId } from './text.js';

/** Keys and the buttons of the same name. Space is the stop, wherever the focus is, but in the note's field. */
export class Keys {
  /** `actions`: what each key does; `stop`: what Space does. */
  constructor(actions, stop) {
    this.actions = actions;
    this.stop = stop;
    // In the capturing phase, so that no element takes Space for itself; a button is pressed by its keyup.
    addEventListener('keydown', (event) => this.down(event), true);
    addEventListener('keyup', (event) => {
      if (event.code === 'Space' && !this.writing(event)) event.preventDefault();
    }, true);
    for (const button of document.querySelectorAll('button[data-key]')) {
      button.setAttribute('aria-keyshortcuts', button.dataset.key.toUpperCase());
      button.addEventListener('click', () => actions[button.dataset.key]());
    }
    byId('stop').addEventListener('click', stop);
  }

  writing(event) {
    return event.target === byId('note');
  }

  down(event) {
    if (this.writing(event)) return;
    if (event.code === 'Space' || event.key === ' ') {
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) this.stop();
      return;
    }
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]') !== null) return;
    const action = this.actions[event.key.toLowerCase()];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }
}
