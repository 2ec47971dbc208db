"""Linux's figures for processes: memory, file descriptors, threads (proc(5))."""

import os
from dataclasses import dataclass


@dataclass
class Usage:
    """The current figures of a process."""

    # All resident memory, and the part that is not backed by a file: the program's own pages are loaded when first
    # used.
    rss_mb: float
    own_mb: float
    descriptors: int
    threads: int


def usage_of(pid):
    """The current figures of a process; None if it has ended or is a zombie."""
    try:
        with open(f"/proc/{pid}/status", encoding="utf-8") as file:
            status = dict(line.split(":", 1) for line in file)
        descriptors = len(os.listdir(f"/proc/{pid}/fd"))
    except (FileNotFoundError, ProcessLookupError):
        return None
    if "VmRSS" not in status:
        return None
    rss_mb, own_mb = (int(status[name].split()[0]) / 1024 for name in ("VmRSS", "RssAnon"))
    return Usage(rss_mb, own_mb, descriptors, int(status["Threads"]))


def children_of(pid):
    """The processes that a process has started, and their command lines: empty for one that has ended."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                # The name of the program is in brackets and may contain anything.
                parent = int(file.read().rpartition(")")[2].split()[1])
            if parent == pid:
                with open(f"/proc/{name}/cmdline", encoding="utf-8", errors="replace") as file:
                    found[int(name)] = file.read().split("\0")[:-1]
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found
