"""Series of a chart: thinned without losing a peak, in units that read well."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_POINTS = 6000
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def thin(time: Array, values: Array, most: int = MOST_POINTS) -> tuple[Array, Array]:
    """A series of at most `most` + 4 points that looks the same: lowest and highest value of each interval, and the ends.

    Parameters
    ----------
    time, values : (n,) each.
    """
    n = len(time)
    if n <= most:
        return time, values
    width = -(-n // (most // 2))
    padded = np.concatenate([values, np.full(-n % width, values[-1])])
    bins = padded.reshape(-1, width)
    first = np.arange(0, n, width)
    places = np.concatenate([first + bins.argmin(axis=1), first + bins.argmax(axis=1), [0, n - 1]])
    places = np.unique(np.minimum(places, n - 1))
    return time[places], values[places]


def readable(unit: str, *values: Array) -> tuple[float, str]:
    """A factor and a unit with a prefix in which the largest of the values lies between 1 and 1000.

    ``1`` stays as it is; a product such as ``N m`` takes the prefix at its first factor.
    """
    largest = max((float(np.abs(array).max()) for array in values if array.size), default=0.0)
    if unit == "1" or largest == 0.0 or not np.isfinite(largest):
        return 1.0, unit
    power = int(np.floor(np.log10(largest) / 3.0 + 1e-9)) * 3
    power = min(max(power, min(_PREFIXES)), max(_PREFIXES))
    if unit in ("m", "s"):  # nobody reads kilometres or kiloseconds from a mechanism
        power = min(power, 0)
    return 10.0**-power, f"{_PREFIXES[power]}{unit}"
