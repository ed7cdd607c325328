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

export function advised(refused: Trouble, model: Model | null = null): Trouble {
  const hint = adviceOf(refused);
  if (isKnown(refused, model))
    return { ...refused, what: 'this model cannot be hollowed as it is', hint: hint ?? 'what is wrong is said above, and marked in it where that can be seen' };
  return hint ? { ...refused, hint } : refused;
}
