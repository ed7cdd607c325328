import { expect, it } from 'vitest';
import { bytesIn, secondsIn, sentence, sentences, stageIn } from '../../src/studio/words';

it('gives figures as they are read', () => {
  expect([12, 360_184, 7_352_784, 536_870_912, 2_147_483_648].map(bytesIn)).toEqual(['12 bytes', '360 kB', '7.4 MB', '537 MB', '2.1 GB']);
  expect([0.234, 9.96, 75.2].map(secondsIn)).toEqual(['0.2 s', '10.0 s', '75 s']);
});

it('makes sentences of the words of the command line', () => {
  expect(sentence('the mesh is open')).toBe('The mesh is open.');
  expect(sentence('Already one!')).toBe('Already one!');
  expect(sentence('')).toBe('');
  expect(sentence('bunny.stl has no inside')).toBe('bunny.stl has no inside.');
  expect(sentences({ what: 'it is open', hint: 'try --surface remesh' })).toBe('It is open. Try --surface remesh.');
});

it('names stages, those it does not know too', () => {
  expect(stageIn('pack')).toBe('Packing spheres');
  expect(stageIn('polish')).toBe('Polish');
});
