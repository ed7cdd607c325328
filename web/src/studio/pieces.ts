// What several parts of the page are made of.
import { make } from '../dom';
import { raised } from '../figures';
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
  const box = make('div', { class: 'trouble', role: 'alert' }, make('p', {}, raised(sentence(what))));
  // What that help says stands here too.
  const told = hint?.replace("see 'aerate hollow --help'", 'the "?" beside each field tells what it takes');
  if (told) box.append(make('p', { class: 'hint' }, raised(sentence(told))));
  return box;
}

// Asks before what cannot be taken back is done.
export function isWanted(question: string, act: string): Promise<boolean> {
  const no = make('button', { value: '', autofocus: '' }, 'Keep');
  const yes = make('button', { value: 'yes', class: 'danger' }, act);
  const dialog = make('dialog', { 'aria-labelledby': 'question' }, make('form', { method: 'dialog' }, make('p', { id: 'question' }, question), make('div', { class: 'answers' }, no, yes)));
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((done) =>
    dialog.addEventListener('close', () => {
      dialog.remove();
      done(dialog.returnValue === 'yes');
    }),
  );
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
