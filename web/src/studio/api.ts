// Requests to the program.
import { EventParser, type ServerEvent } from './event_stream';
import type { Estimate, Job, Model, Options, Told, Trouble } from './told';

// The program says no, and why.
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly trouble: Trouble,
  ) {
    super(trouble.what);
  }
}

// There is no program at the address.
export class Unreachable extends Error {}

export function troubleOf(error: unknown): Trouble {
  if (error instanceof Refusal) return error.trouble;
  if (error instanceof Unreachable)
    return { what: 'the program does not answer', hint: 'see whether it still runs where it was started' };
  return { what: error instanceof Error ? error.message : String(error) };
}

// Of an answer that is none of ours, the status at least.
function refusalOf(status: number, body: string): Refusal {
  try {
    const { error } = JSON.parse(body) as { error?: Trouble };
    if (error && typeof error.what === 'string') return new Refusal(status, error);
  } catch {
    // Said below.
  }
  return new Refusal(status, { what: `the program answered with status ${status}` });
}

const isAbort = (error: unknown): boolean => error instanceof DOMException && error.name === 'AbortError';

export class Api {
  constructor(private readonly token: string) {}

  private async ask(path: string, request: RequestInit = {}): Promise<Response> {
    let answer: Response;
    try {
      const headers = { ...request.headers, Authorization: `Bearer ${this.token}` };
      answer = await fetch(`/api/${path}`, { ...request, headers });
    } catch (error) {
      throw isAbort(error) ? error : new Unreachable();
    }
    if (!answer.ok) throw refusalOf(answer.status, await answer.text());
    return answer;
  }

  private async json<T>(path: string, request?: RequestInit): Promise<T> {
    return (await (await this.ask(path, request)).json()) as T;
  }

  private post<T>(path: string, body: unknown, signal?: AbortSignal): Promise<T> {
    const headers = { 'Content-Type': 'application/json' };
    return this.json<T>(path, { method: 'POST', headers, body: JSON.stringify(body), ...(signal ? { signal } : {}) });
  }

  state = (): Promise<Told> => this.json<Told>('state');

  estimate = (model: string, options: Options, signal: AbortSignal): Promise<Estimate> =>
    this.post<Estimate>('estimate', { model, options }, signal);

  start = (model: string, options: Options): Promise<Job> => this.post<Job>('jobs', { model, options });

  stop = (job: string): Promise<Job> => this.post<Job>(`jobs/${job}/stop`, {});

  remove = (kind: 'models' | 'jobs', id: string): Promise<unknown> => this.post(`${kind}/${id}/remove`, {});

  report = async <T>(job: string): Promise<T> => this.json<T>(`jobs/${job}/report`);

  async bytes(path: string): Promise<Uint8Array<ArrayBuffer>> {
    return new Uint8Array(await (await this.ask(path)).arrayBuffer());
  }

  // A fetch tells nothing of how much is sent. `onShare`: 0 to 1.
  upload(file: File, onShare: (share: number) => void, signal: AbortSignal): Promise<Model> {
    return new Promise((done, fail) => {
      const request = new XMLHttpRequest();
      request.open('POST', `/api/models?name=${encodeURIComponent(file.name)}`);
      request.setRequestHeader('Authorization', `Bearer ${this.token}`);
      request.setRequestHeader('Content-Type', 'application/octet-stream');
      request.upload.onprogress = ({ loaded, total }) => onShare(total > 0 ? loaded / total : 1);
      request.onload = () => {
        if (request.status === 200) done(JSON.parse(request.responseText) as Model);
        else fail(refusalOf(request.status, request.responseText));
      };
      request.onerror = () => fail(new Unreachable());
      request.onabort = () => fail(new DOMException('', 'AbortError'));
      signal.addEventListener('abort', () => request.abort());
      request.send(file);
    });
  }

  // Until the stream ends, or nothing was heard for longer than the program is ever silent.
  async listen(onEvent: (event: ServerEvent) => void, onOpen: () => void): Promise<void> {
    const kSilent = 30_000; // ms; it sends something every 10 s
    const stop = new AbortController();
    let timer = 0;
    const heard = (): void => {
      window.clearTimeout(timer);
      timer = window.setTimeout(() => stop.abort(), kSilent);
    };
    heard();
    try {
      const { body } = await this.ask('events', { signal: stop.signal });
      if (!body) return;
      onOpen();
      const reader = body.pipeThrough(new TextDecoderStream()).getReader();
      const parser = new EventParser();
      for (;;) {
        const { done, value } = await reader.read();
        if (done) return;
        heard();
        for (const event of parser.take(value)) onEvent(event);
      }
    } finally {
      window.clearTimeout(timer);
    }
  }
}
