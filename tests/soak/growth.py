"""Whether a figure grew over a run: its slope, and its total over the observed time."""

from dataclasses import dataclass
from statistics import median

# Maximum number of paired samples: the slope is the median of the slopes between pairs.
PAIRED_MAX = 200
# The first part of a run fills buffers and caches: growth there does not continue.
WARM_UP = 0.2
# Fewer samples do not determine a slope.
SAMPLES_MIN = 5


@dataclass
class Growth:
    """A figure at the beginning and at the end, and the total of its slope in between."""

    first: float
    last: float
    grew: float


def growth_of(samples):
    """The growth of a figure, from pairs of time and value in the order of time; None if they are too few.

    The slope is that of Theil (1950) and Sen (1968): a few outliers do not affect it, as they would a least-squares line."""
    warm = samples[int(len(samples) * WARM_UP):]
    if len(warm) < SAMPLES_MIN:
        return None
    step = -(-len(warm) // PAIRED_MAX)
    kept = warm[::step]
    slopes = [
        (value - before) / (at - then)
        for i, (at, value) in enumerate(kept)
        for then, before in kept[:i]
        if at > then
    ]
    edge = max(1, len(warm) // 10)
    first, last = (median(value for _, value in part) for part in (warm[:edge], warm[-edge:]))
    return Growth(first, last, median(slopes) * (warm[-1][0] - warm[0][0]))
