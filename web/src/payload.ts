import type { Scene } from './scene';

export interface Payload {
  readonly scene: Scene;
  readonly streams: readonly Uint8Array[]; // steps, links, x, y, z
}

function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflated(packed: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export const unpack = (base64: string): Promise<Payload> => unpackBytes(bytesOf(base64.trim()));

// A header's length (4 bytes, the lowest first), the header as JSON, the streams; all deflated.
export async function unpackBytes(packed: Uint8Array<ArrayBuffer>): Promise<Payload> {
  const bytes = await inflated(packed);
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const scene = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length))) as Scene;
  if (scene.format !== 1) throw new Error(`data of format ${String(scene.format)}, this page reads 1`);
  let at = 4 + length;
  const streams = scene.streams.map((size) => bytes.subarray(at, (at += size)));
  if (at !== bytes.length) throw new Error('the data has not the length that it says');
  return { scene, streams };
}
