// A run of `aerate studio`, as somebody starts it who copies the address that it prints.
import { spawn, spawnSync, type ChildProcess } from 'node:child_process';

const kProgram = process.env.AERATE_PROGRAM ?? '';

export class Program {
  private constructor(
    private readonly child: ChildProcess,
    readonly address: string,
  ) {}

  static start(...options: readonly string[]): Promise<Program> {
    const child = spawn(kProgram, ['studio', '--no-browser', ...options], { stdio: ['ignore', 'pipe', 'pipe'] });
    let told = '';
    return new Promise((done, fail) => {
      const read = (piece: Buffer): void => {
        told += piece.toString();
        const address = /http:\/\/\S+#\S+(?=\s)/.exec(told);
        if (address) done(new Program(child, address[0]));
      };
      child.stdout.on('data', read);
      child.stderr.on('data', read);
      child.on('error', fail);
      child.on('exit', () => fail(new Error(`aerate studio ended: ${told}`)));
    });
  }

  get port(): string {
    return new URL(this.address).port;
  }

  end(): Promise<void> {
    return new Promise((done) => {
      this.child.on('exit', () => done());
      this.child.kill('SIGINT');
    });
  }
}

// What the command line says of a file that it cannot use.
export function saidOf(file: string): string {
  return spawnSync(kProgram, ['hollow', file, '-o', `${file}.out.stl`], { encoding: 'utf8' }).stderr;
}
