"""Shells that complete a command line: what they offer, each as it stands on the line once it is taken."""
import os
import pty
import re
import select
import shutil
import subprocess
import time

PATIENCE = 30  # seconds, of a machine with much else to do


class OnTerminal:
    """A shell on a pseudo-terminal, in which TAB puts all that it offers on the line."""

    def __init__(self, command, setup, folder):
        environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "TERM": "dumb", "LC_ALL": "C.UTF-8", "INPUTRC": "/dev/null"}
        pid, self.terminal = pty.fork()
        if pid == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)
        self.pid = pid
        # What is completed is a function that shows what it was given.
        self.type("stty cols 30000\n" + setup + "aerate() { printf '\\n@%s@' \"$@\"; printf '\\n%s\\n' '@'end; }\n")
        self.type("printf '%s\\n' '@'ready\n")
        self.read_until("@ready")

    def type(self, text):
        os.write(self.terminal, text.encode())

    def read_until(self, mark):
        text, end = "", time.monotonic() + PATIENCE
        while not re.search(f"^{mark}\r?$", text, re.M):
            if not select.select([self.terminal], [], [], max(0, end - time.monotonic()))[0]:
                raise AssertionError(f"no {mark!r} in {text!r}")
            text += os.read(self.terminal, 1 << 16).decode(errors="replace")
        return text

    def offered(self, line):
        """The words in the place of the last one; that itself if there is nothing to complete it."""
        self.type(line + "\t")
        time.sleep(0.05)
        self.type("\n")
        shown = re.findall("^@(.*)@\r?$", self.read_until("@end"), re.M)
        words_before = len(re.split(r"(?<!\\) ", line)) - 2
        return [word for word in shown[words_before:] if word]

    def close(self):
        os.close(self.terminal)
        os.waitpid(self.pid, 0)


class Bash(OnTerminal):
    name = "bash"

    def __init__(self, completions, folder):
        setup = f"PS1='> '\nsource '{completions}/bash/aerate'\nbind 'TAB: insert-completions'\n"
        super().__init__(["bash", "--norc", "--noprofile", "-i"], setup, folder)


class Zsh(OnTerminal):
    name = "zsh"

    def __init__(self, completions, folder):
        setup = (f"PS1='> '; unsetopt prompt_cr prompt_sp; fpath=('{completions}/zsh' $fpath)\n"
                 "autoload -Uz compinit; compinit -D -u\n"
                 "zle -C all-matches complete-word _generic; bindkey '^I' all-matches\n"
                 "zstyle ':completion:all-matches::::' completer _all_matches _complete\n"
                 "zstyle ':completion:all-matches:*' insert true\n")
        super().__init__(["zsh", "-f", "-i"], setup, folder)


class Fish:
    name = "fish"

    def __init__(self, completions, folder):
        self.completions, self.folder = completions, folder

    def offered(self, line):
        done = subprocess.run(
            ["fish", "--no-config", "-c", f"source '{self.completions}/fish/aerate.fish'; complete -C $argv[1]", line],
            cwd=self.folder, env={"PATH": os.environ["PATH"], "HOME": str(self.folder), "LC_ALL": "C.UTF-8"},
            capture_output=True, text=True, timeout=PATIENCE)
        if done.returncode or done.stderr:
            raise AssertionError(f"{line}: {done.stderr}")
        # As they would stand on the line: each with a description behind a tab.
        offered = [re.sub(r"\\(.)", r"\1", row.split("\t")[0]) for row in done.stdout.splitlines()]
        return offered or [word for word in [line.split(" ")[-1]] if word]

    def close(self):
        pass


SHELLS = {shell.name: shell for shell in (Bash, Zsh, Fish)}


def is_there(shell):
    return shutil.which(shell) is not None
