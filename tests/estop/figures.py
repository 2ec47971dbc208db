"""Statistics of many stops: counts, quantiles, and tables of at most 80 columns."""

import math
from dataclasses import dataclass, field

WIDTH = 80


def quantile(values, share):
    """The quantile at this fraction of all values, by nearest rank; None without values."""
    if not values:
        return None
    rank = max(1, math.ceil(share * len(values)))
    return sorted(values)[rank - 1]


@dataclass
class Stop:
    """One E-stop of one boat or several; times are ms from the operator's request."""

    # Time until each boat was sent standby; infinite if it never was.
    wire_ms_each: list
    # Time until the operator was shown each boat as stopped; infinite if that never happened.
    shown_ms_each: list

    def wire_ms(self):
        """Time until the last of the boats was sent standby."""
        return max(self.wire_ms_each)

    def is_shown(self):
        return all(map(math.isfinite, self.shown_ms_each))

    def is_false(self):
        """Whether the operator was shown a boat as stopped before it was."""
        return any(shown < wire for shown, wire in zip(self.shown_ms_each, self.wire_ms_each))

    def is_good(self, limit_ms):
        return self.wire_ms() <= limit_ms and self.is_shown() and not self.is_false()


@dataclass
class Tally:
    """The E-stops under one condition."""

    limit_ms: float
    stops: list = field(default_factory=list)
    # The longest time during a stop for which the machine ran no ordinary programs.
    stall_ms: float = 0.0
    # Fraction of all stops that may be shown before they have happened.
    false_share: float = 0.0

    def in_time(self):
        return sum(stop.wire_ms() <= self.limit_ms for stop in self.stops)

    def shown(self):
        return sum(stop.is_shown() for stop in self.stops)

    def false(self):
        return sum(stop.is_false() for stop in self.stops)

    def passed(self):
        total = len(self.stops)
        return 0 < total == self.in_time() == self.shown() and self.false() <= math.ceil(self.false_share * total)

    def row(self, name):
        wire = [stop.wire_ms() for stop in self.stops]
        cells = [milliseconds(quantile(wire, share)) for share in (0.5, 0.99, 1.0)]
        return [name, f"{self.in_time()}/{len(self.stops)}", *cells, str(self.shown()), str(self.false()),
                milliseconds(self.stall_ms), "" if self.passed() else "MISSED"]


HEADING = ["under", "in time", "median", "p99", "max", "shown", "false", "stall"]


def milliseconds(value):
    if value is None:
        return "-"
    return "never" if math.isinf(value) else f"{value:.1f}"


def table(heading, rows):
    """Rows below a heading: the first column to the left, all others to the right.

    A table wider than a terminal is a bug.
    """
    rows = [[*row, *[""] * (len(heading) - len(row))] for row in [heading, *rows]]
    columns = max(map(len, rows))
    rows = [[*row, *[""] * (columns - len(row))] for row in rows]
    widths = [max(len(row[column]) for row in rows) for column in range(columns)]
    lines = ["  ".join(cell.ljust(width) if column == 0 else cell.rjust(width)
                       for column, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in rows]
    assert max(map(len, lines)) <= WIDTH, f"{max(map(len, lines))} columns"
    return "\n".join(lines)


def round_trips(took_ms, start_ms, delay_ms):
    """Number of round trips that a command took, excluding its time on a network without delay."""
    return None if delay_ms == 0 else (took_ms - start_ms) / (2 * delay_ms)
