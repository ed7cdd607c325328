// What to do about a refusal, said with the fields of the page where the command line speaks of its options.
import type { Model, Trouble } from './told';

// What the command line says, after the word for what can be done with it: "none: ...".
export const whyUnusable = ({ use }: Model): string => use.replace(/^none: /, '');

// What stands in the list of models already, word for word.
function isKnown({ what, hint }: Trouble, model: Model | null): boolean {
  return model !== null && !model.usable && whyUnusable(model) === [what, hint].filter(Boolean).join('; ');
}

// null where no field helps.
function adviceOf({ hint = '' }: Trouble): string | null {
  if (hint.includes('--unit and --scale')) return 'are "Unit of the file" and "Scale" right, under "The model"?';
  if (!hint.includes('--surface remesh')) return null;
  const span = /--max-hole ([\d.e+-]+)/.exec(hint);
  if (span) return `close it in a mesh editor, or choose "Surface: remesh" and "Largest hole to close: ${span[1]}", under "The model", to span it`;
  return 'choose "Surface: remesh", under "The model"';
}

// The option that a refusal begins with: "--wall: ..." or "--min-radius 9 mm (command line) is ...".
export const optionOf = ({ what }: Trouble): string | null => /^--([a-z][a-z-]*)/.exec(what)?.[1] ?? null;

// With the title that the option has on this page.
export function titled(refused: Trouble, title: string): Trouble {
  return { ...refused, what: refused.what.replace(/^--[a-z-]+/, (option) => `${title} (${option})`) };
}

export function advised(refused: Trouble, model: Model | null = null): Trouble {
  const hint = adviceOf(refused);
  if (isKnown(refused, model))
    return { ...refused, what: 'this model cannot be hollowed as it is', hint: hint ?? 'what is wrong is said above, and marked in it where that can be seen' };
  return hint ? { ...refused, hint } : refused;
}
