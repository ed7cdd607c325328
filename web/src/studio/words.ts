import { format } from '../colours';
import type { Trouble } from './told';

export function bytesIn(bytes: number): string {
  if (bytes < 1e3) return `${bytes} bytes`;
  if (bytes < 1e6) return `${format(bytes / 1e3, 0)} kB`;
  if (bytes < 1e9) return `${format(bytes / 1e6, bytes < 1e7 ? 1 : 0)} MB`;
  return `${format(bytes / 1e9, 1)} GB`;
}

export const secondsIn = (seconds: number): string => (seconds < 10 ? `${seconds.toFixed(1)} s` : `${format(seconds, 0)} s`);

// Words of the command line begin small and end without a point. Names of files and options stay as they are.
export function sentence(text: string): string {
  if (text === '') return '';
  const isWord = /^[a-z]+([ ,;:]|$)/.test(text);
  const end = /[.!?…]$/.test(text) ? '' : '.';
  return (isWord ? text[0].toUpperCase() + text.slice(1) : text) + end;
}

export const sentences = ({ what, hint }: Trouble): string => [what, hint ?? ''].filter(Boolean).map(sentence).join(' ');

const kStages: Readonly<Record<string, string>> = {
  load: 'Reading the model',
  inspect: 'Inspecting it',
  remesh: 'Meshing it anew',
  pack: 'Packing spheres',
  verify: 'Verifying each sphere',
  shape: 'Shaping cells',
  drain: 'Planning channels and holes',
  carve: 'Making surfaces',
  predict: 'Predicting the print',
  stand: 'Making sure that it stands',
  write: 'Writing',
  check: 'Reading back and checking',
  cups: 'Looking for cups',
  picture: 'Preparing the view',
  page: 'Preparing the view',
};

export const stageIn = (stage: string): string => kStages[stage] ?? sentence(stage).replace(/\.$/, '');
