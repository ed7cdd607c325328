// What several parts of the page are made of.
import { make } from '../dom';
import { troubleOf } from './api';
import type { Trouble } from './told';
import { sentence } from './words';

// Trouble is said in words beside the button, until it is pressed again.
export function button(text: string, act: () => unknown, label?: string): HTMLButtonElement {
  const element = make('button', { type: 'button', ...(label ? { 'aria-label': label, title: label } : {}) }, text);
  element.addEventListener('click', () => void attempt(act, element));
  return element;
}

export async function attempt(act: () => unknown, beside: HTMLElement): Promise<void> {
  const last = beside.nextElementSibling;
  if (last?.classList.contains('trouble')) last.remove();
  try {
    await act();
  } catch (error) {
    beside.after(trouble(troubleOf(error)));
  }
}

export function trouble({ what, hint }: Trouble): HTMLElement {
  const box = make('div', { class: 'trouble', role: 'alert' }, make('p', {}, sentence(what)));
  if (hint) box.append(make('p', { class: 'hint' }, sentence(hint)));
  return box;
}

export function copyButton(what: string, text: () => string): HTMLButtonElement {
  const element = make('button', { type: 'button' }, what);
  element.addEventListener('click', () => {
    const told = (words: string): void => {
      element.textContent = words;
      window.setTimeout(() => (element.textContent = what), 2000);
    };
    // Not every browser lets a page without https do it.
    Promise.resolve()
      .then(() => navigator.clipboard.writeText(text()))
      .then(() => told('Copied'))
      .catch(() => told('Cannot copy: select it'));
  });
  return element;
}

// Downloads need the token, which an address would show.
export async function download(bytes: Promise<Uint8Array<ArrayBuffer>>, name: string): Promise<void> {
  const url = URL.createObjectURL(new Blob([await bytes]));
  make('a', { href: url, download: name }).click();
  window.setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
