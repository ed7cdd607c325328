import { expect, it } from 'vitest';
import { EventParser } from '../../src/studio/event_stream';

const kStream = 'event: job\ndata: {"id":"j1"}\n\n: here\n\nevent: model\r\ndata: one\r\ndata:two\r\n\r\ndata\n\n';
const kEvents = [
  { name: 'job', data: '{"id":"j1"}' },
  { name: 'model', data: 'one\ntwo' },
  { name: 'message', data: '' },
];

it('tells events, whatever pieces they come in', () => {
  for (const size of [1, 2, 3, 7, 1000]) {
    const parser = new EventParser();
    const events = [];
    for (let at = 0; at < kStream.length; at += size) events.push(...parser.take(kStream.slice(at, at + size)));
    expect(events).toEqual(kEvents);
  }
});

it('tells nothing of comments, nor of what has not ended', () => {
  const parser = new EventParser();
  expect(parser.take(': here\n\n: here\n\nevent: job\ndata: 1\n')).toEqual([]);
  expect(parser.take('\n')).toEqual([{ name: 'job', data: '1' }]);
});

it('begins each event without the name of the one before', () => {
  expect(new EventParser().take('event: job\n\ndata: 1\n\n')).toEqual([{ name: 'message', data: '1' }]);
});
