#!/usr/bin/env python3
"""Runs every command that Squall documents: `tests/documented_commands.py PATH/OF/squall [PART OF A PLACE]`.

Commands come from the help, the templates, the hints in the program's own output, README.md, docs/ and scenarios/.
Each page has an empty folder and one shell, so that its commands follow one another as a reader types them. Output that
a page shows must be the real output. The first hint of each kind follows the command that printed it. The tables below
list every exception with its reason. A command that fails, and an entry that excuses nothing, are errors. Exits with
status 1 if there are any.
"""

import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Commands that cannot run here, as regular expressions over whole commands, with the reason.
SKIPPED = {
    r"squall (watch|view) --game \S+": "a hint about a game that is already over",
    r".* --blue A --red B .*": "a hint in which A and B stand for files",
    r".*(10\.0\.0\.\d+|192\.168\.\d+\.\d+).*": "needs another host or a boat at this address",
    r"squall gateway (check|stop|surveyor|tell|replay|console)\b.*": "needs a boat; tests/process drives emulated ones",
    r"squall log runs/gateway-.*": "needs the recording of a boat's gateway",
    r"squall view --game day.*": "belongs to a game with boats, in its own terminal",
    r"squall run .*--blue imported.*|squall (strategy|policy) imported.*": "needs a model that the reader has trained",
    r"squall league .*(mine\.onnx|host:).*": "needs a policy and an entry of the reader's; tests/command/league.rs has some",
    r"squall run .*--blue host:.*": "needs an entry of the reader's; python/tests/test_host.py has some",
    r"squall import .*": "needs the reader's logs; tests/command/import.rs has some",
    r"squall (trial|identify|gap|sea) .*field\.(csv|nmea).*": "needs the reader's log of a boat; tests/command/trial.rs has one",
    r"squall keys new keys --help": "prints help; the keys page creates keys",
    r"source <\(squall completions zsh\)|squall completions fish \| source": "needs its shell; tests/terminal.py has them",
    r"squall moos .*blue_two=tcp.*": "needs the reader's own MOOSDB; tests/moos_peer.py has one",
    r"squall ros messages .* && colcon .*": "needs a ROS 2 workspace; tests/ros_peer.py reads the package",
}

# Commands that fail, as their pages say.
REFUSED = {r"squall strategy scenarios/strategies/mine_1\.toml": "the tutorial shows the error"}

# Commands that take minutes: Ctrl-C ends them after this many seconds of work without an error, or once they have
# printed this text.
LONG_S = 5
LONG = {
    r"squall train .*": "best.toml",
    r"squall tournament (paper_2023|simple|learned|mine).*": None,
    r"squall league\b(?!.*--help).*": None,
    r"squall sweep .*": None,
    r"squall run .*--pace realtime.*": None,
    r"squall run .*--emulate.*": None,
}

# Commands that serve until Ctrl-C, which ends them once they print this text.
SERVES = {
    r"squall run surveyor_2v2 --blue runs/train/.*--view": "the game is over",
    r".*squall (demo|view|replay(?!.*--check))\b.*": "http://",
    r"squall run .*--view.*": "http://",
    r"squall sim .*": " at t",
    r"squall agent .*": "joined",
    r"squall gateway emulate (?!.*--help).*": "",
    r"squall watch.*": "blue",
    r"squall moos --team.*": "MOOSTimeWarp",
    r"squall ros bridge.*": "to ROS 2",
    r"squall gateway sitl .*": "firmware at",
}

# Commands that need a second one running beside them.
GAME = "squall run surveyor_2v2 --pace realtime --no-record"
BESIDE = {
    r"squall agent --game dock .*": "squall sim my_game --game dock --pace realtime",
    r"squall agent --game day .*": "squall sim mixed_2v2 --game day --pace realtime",
    r"squall (watch|helm)\b(?!.*10\.0).*": GAME,
    r"squall gateway emulate --game water .*": "squall sim mixed_2v2 --afloat blue_one --pace realtime --game water",
    r"squall gateway (emulate --protocol mavlink|sitl) .*": "squall sim mixed_2v2 --afloat blue_one --pace realtime --game water",
    r"squall ros bridge": GAME,
    r"squall (moos --team|ros bridge --vehicle|agent --vehicle blue_2) .*":
        "squall sim surveyor_2v2 --pace realtime --listen tcp/127.0.0.1:7500",
}

# Commands whose real output differs from the one shown.
UNCOMPARED = {r"squall policy runs/train/first/best\.onnx --game.*": "the training was shortened"}

# Steps that a reader does by hand before the commands of a page.
PREPARED = {
    "docs/first-boat.md": "squall copy mixed_2v2 my_game && squall copy surveyor my_boat",
    "docs/recordings.md": "squall run attack_1v1 --in-process; for name in GAME OTHER FIELD SIMULATION; do squall run attack_1v1 --in-process --record $name"
    " && mv $name/*.mcap $name.mcap; done",
    "docs/page.md": "squall run attack_1v1 --in-process && cp runs/*.mcap FILE.mcap && cp runs/*.mcap REPORT.mcap",
}

# Placeholders for the reader's own values, with a value for the test.
PLACEHOLDERS = {" FILE": " FILE.mcap", " REPORT": " REPORT.mcap"}


class Failure(Exception):
    """A command that does not behave as its page says."""


def matching(table, command):
    return next((key for key in table if re.fullmatch(key, command)), None)


def normal(text):
    """Text without the parts that differ between runs and machines: durations, speeds and times of recording."""
    text = re.sub(r"\d{8}T\d{6}Z", "TIME", text)
    text = re.sub(r"(lockstep|in process|computed in) [\d.]+ s, [\d.]+x", r"\1 WALL", text)
    return [" ".join(line.split()) for line in text.splitlines()]


class Page:
    """The commands of one page, which run in one folder."""

    def __init__(self, checker, place):
        self.checker, self.place = checker, place
        self.folder = tempfile.TemporaryDirectory()
        self.variables, self.hints = {}, []
        if prepared := PREPARED.get(place):
            self.shell(prepared, 120)

    def start(self, command, output=subprocess.DEVNULL):
        env = os.environ | {"PATH": f"{self.checker.bin}:{os.environ['PATH']}", "BROWSER": "true"}
        env |= {"XDG_RUNTIME_DIR": self.checker.runtime} | self.variables
        return subprocess.Popen(["bash", "-c", command], cwd=self.folder.name, env=env, stdin=subprocess.DEVNULL,
                                stdout=output, stderr=subprocess.STDOUT, start_new_session=True)

    def shell(self, command, limit_s, until=None):
        """Runs a command; returns its output and exit code. Ctrl-C ends it after `limit_s` or the text `until`."""
        with tempfile.NamedTemporaryFile() as file:
            process = self.start(command, file)
            began, is_ended = time.monotonic(), False
            while process.poll() is None:
                late_s = time.monotonic() - began
                said = Path(file.name).read_text(errors="replace")
                if not is_ended and (late_s > limit_s or until and until in said):
                    os.killpg(process.pid, signal.SIGINT)
                    is_ended = True
                if late_s > limit_s + 30:
                    os.killpg(process.pid, signal.SIGKILL)
                time.sleep(0.05)
            return Path(file.name).read_text(errors="replace"), process.returncode

    def run(self, command):
        """Runs one command as typed; returns its output, or none if it is skipped or ended early."""
        command = re.sub(r"\s+#.*$|\s+# in its own terminal", "", command).strip()
        for word, value in PLACEHOLDERS.items():
            command = re.sub(rf"{word}$", value, command)
        if name := re.fullmatch(r"(\w+)=(.*)", command):
            self.variables[name[1]] = self.shell(f"printf %s {name[2]}", 10)[0]
            return None
        if key := matching(SKIPPED, command):
            self.checker.used.add(key)
            return None
        tables = [(name, key) for name, table in [("LONG", LONG), ("SERVES", SERVES), ("BESIDE", BESIDE)]
                  if (key := matching(table, command))]
        self.checker.used.update(key for _, key in tables)
        named = dict(tables)
        beside = self.start(BESIDE[named["BESIDE"]]) if "BESIDE" in named else None
        if beside:
            time.sleep(3)
        serves = SERVES.get(named.get("SERVES"))
        until = serves or LONG.get(named.get("LONG"))
        try:
            is_brief = serves == "" or "LONG" in named and not until
            output, code = self.shell(command, LONG_S if is_brief else 600, until)
        finally:
            if beside:
                os.killpg(beside.pid, signal.SIGINT)
                beside.wait()
        if "--help" not in command and command not in ("squall", "squall help"):
            self.hints = self.checker.new_hints(output)
        is_ended = "LONG" in named or serves is not None
        if key := matching(REFUSED, command):
            self.checker.used.add(key)
        if code not in ((0, 130, -2) if is_ended else (1,) if key else (0,)):
            raise Failure(f"exit code {code}: {output[-800:]}")
        if serves and serves not in output:
            raise Failure(f"never printed {serves!r}: {output[-800:]}")
        if key := matching(UNCOMPARED, command):
            self.checker.used.add(key)
        return None if is_ended or key else output

    def close(self):
        self.folder.cleanup()


class Checker:
    def __init__(self, program, only):
        self.only, self.errors, self.used, self.count = only, [], set(), 0
        self.home = tempfile.TemporaryDirectory()
        self.bin, self.runtime = f"{self.home.name}/bin", f"{self.home.name}/run"
        os.mkdir(self.bin)
        os.mkdir(self.runtime, 0o700)
        os.symlink(Path(program).resolve(), f"{self.bin}/squall")
        self.hinted = set()

    def new_hints(self, output):
        """The commands in an output whose kind has not been seen before."""
        hints = []
        for hint in re.findall(r"(?:: |^ +)(squall [a-z][^\n,;]*)", output, re.M):
            kind = re.sub(r"[^ ]*[0-9/=][^ ]*", "X", hint)
            if kind not in self.hinted:
                self.hinted.add(kind)
                hints.append(hint.strip())
        return hints

    def command(self, page, command):
        self.count += 1
        began = time.monotonic()
        output, page.hints = None, []
        try:
            output = page.run(command)
        except Failure as failure:
            self.errors.append(f"{page.place}: {command}\n    {failure}")
        print(f"{time.monotonic() - began:6.1f} s  {page.place}: {command}", flush=True)
        for hint in page.hints:
            self.command(page, hint)
        return output

    def page(self, place, blocks):
        """Runs the blocks of a page: their language and text."""
        if self.only and self.only not in place:
            return
        page, outputs = Page(self, place), []
        for language, text in blocks:
            if language == "sh":
                outputs = []
                for command in text.replace("\\\n", " ").splitlines():
                    command = command.replace("cargo run --release -- run", "squall run")
                    if re.match(r"(\w+=\S+ )*(source <\()?squall |[A-Z]+=", command):
                        outputs.append(self.command(page, command))
                continue
            if language == "toml" and (name := re.match(r"# (\S+\.toml)\n", text)):
                path = name[1] if "/" in name[1] else f"strategies/{name[1]}"
                path = Path(page.folder.name, "scenarios", path)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            elif language == "text" and outputs and None not in outputs:
                missing = [self.missing(text, output) for output in outputs]
                if None not in missing:
                    self.errors.append(f"{place}: shows a line that the commands above do not print:\n    {missing[0]}")
            # Only the text directly after the commands is their output.
            outputs = []
        page.close()

    @staticmethod
    def missing(text, output):
        """The first line of a page's text that an output does not contain in this order; `…` stands for any lines."""
        real = iter(normal(output))
        return next((line for line in normal(text) if line and line != "…" and line not in real), None)


def check_prose(checker, place, markdown):
    """Commands within sentences name existing subcommands and options; most have placeholders, so they are not run."""
    prose = re.sub(r"^```.*?^```", "", markdown, flags=re.M | re.S)
    for command in set(re.findall(r"`(squall (?!help)[a-z][^`]*)`", prose)):
        words = command.split()[1:]
        path = words[: 2 if words[0] in ("gateway", "keys") and words[1:2] and words[1].islower() else 1]
        done = subprocess.run([f"{checker.bin}/squall", *path, "--help"], capture_output=True, text=True)
        unknown = [word for word in words if word.startswith("--") and word.split("=")[0] not in done.stdout]
        if done.returncode or unknown:
            checker.errors.append(f"{place}: {command}: unknown: {' '.join(unknown or path)}")


def blocks_of(markdown):
    return re.findall(r"^```(\w+)\n(.*?)^```", markdown, re.M | re.S)


def helped(checker):
    """The examples of every command's help, and the first steps, as one page."""
    page = Page(checker, "help")
    first, _ = page.shell("squall", 10)
    commands = [re.split(r"  +", line.strip())[0] for line in first.splitlines() if line.startswith("  squall ")]
    names = re.findall(r"^  ([a-z]+)  ", page.shell("squall help", 10)[0], re.M)
    # Files before their users.
    for name in sorted(names, key=lambda name: ["new", "copy", "run", "tournament"].index(name)
                       if name in ("new", "copy", "run", "tournament") else 9):
        text, _ = page.shell(f"squall {name} --help", 10)
        commands += re.findall(r"^  (.*squall .*)$", text.split("Examples:")[-1], re.M)
    page.close()
    return [("sh", "\n".join(dict.fromkeys(commands)))]


def templates(checker):
    """The commands in the comments of every template."""
    page = Page(checker, "templates")
    commands = []
    for kind in ["strategy", "boat", "sea", "game", "sweep", "training", "tournament"]:
        page.shell(f"squall new {kind} mine", 10)
        commands.append(f"squall new {kind} mine")
        for path in Path(page.folder.name).glob(f"scenarios/*/mine.toml"):
            commands += re.findall(r"`(squall [^`]*)`", path.read_text().replace("GAME", "surveyor_2v2"))
            path.unlink()
    page.close()
    return [("sh", "\n".join(commands))]


def main():
    checker = Checker(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "")
    checker.page("help", helped(checker))
    checker.page("templates", templates(checker))
    for path in sorted([ROOT / "README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("scenarios/**/*.md")]):
        checker.page(str(path.relative_to(ROOT)), blocks_of(path.read_text()))
        check_prose(checker, path.relative_to(ROOT), path.read_text())
    if not checker.only:
        for table in (SKIPPED, REFUSED, LONG, SERVES, BESIDE, UNCOMPARED):
            checker.errors += [f"the table entry {key} excuses nothing" for key in table if key not in checker.used]
    print(f"{checker.count} commands, {len(checker.errors)} errors")
    print("\n".join(checker.errors))
    sys.exit(bool(checker.errors))


if __name__ == "__main__":
    main()
