"""What Linux says of processes: memory, file descriptors, threads (proc(5))."""

import os
from dataclasses import dataclass


@dataclass
class Usage:
    """What a process has now."""

    # All that is resident, and of that what is no page of a file: the program's own pages come in as they are first used.
    rss_mb: float
    own_mb: float
    descriptors: int
    threads: int


def usage_of(pid):
    """What a process has now; None if it has ended, or is a zombie."""
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
    """The processes that a process has started, and their command lines: empty of one that has ended."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                # The name of the program stands in brackets and may contain anything.
                parent = int(file.read().rpartition(")")[2].split()[1])
            if parent == pid:
                with open(f"/proc/{name}/cmdline", encoding="utf-8", errors="replace") as file:
                    found[int(name)] = file.read().split("\0")[:-1]
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found
