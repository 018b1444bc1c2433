#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Chooses a development set of blind sensors among seeds that have been looked at: the first ones of each kind, more
of the kinds that are hard, clean ones, and those that were once a false alarm. Prints the seeds, for
`score_blind.py --only $(choose_seeds.py)`. What is measured on them is no exam."""
import argparse
import sys

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit("choose_seeds: numpy is missing for this Python; install python3-numpy")

from kinds import KINDS
from sensor import draw_role

MORE = {"dead zone": 3, "saturation": 2, "feedback ramp, not logged": 3, "hysteresis over temperature": 2,
        "bias with two states": 2, "hidden cause": 2, "turning point over temperature": 2, "supply, squared": 2,
        "Faraday, one axis": 2, "acceleration, squared": 2, "Shupe, heat through the layers": 2,
        "scale factor over the coil's temperature": 2}
ONCE_FALSE = (710047, 710100, 710141, 710180)
ONCE_CONTRADICTED = (710097, 710221)


def role_of(seed):
    """Role and kinds, as the sensor of the seed draws them."""
    return draw_role(np.random.default_rng([seed, 0x1F06]), seed, None)


def chosen(first, count, clean):
    """The seeds, in order."""
    wanted = {kind: MORE.get(kind, 1) for kind in KINDS}
    seeds = set(ONCE_FALSE + ONCE_CONTRADICTED)
    for seed in range(first, first + count):
        role, kinds = role_of(seed)
        if role == "clean" and clean > 0:
            clean -= 1
            seeds.add(seed)
        elif role == "visible" and wanted[kinds[0]] > 0:
            wanted[kinds[0]] -= 1
            seeds.add(seed)
    return sorted(seeds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=710001, help="seed to begin with")
    parser.add_argument("--count", type=int, default=240, help="seeds to choose from")
    parser.add_argument("--clean", type=int, default=5, help="sensors without an effect, beside those once false")
    options = parser.parse_args()
    print(*chosen(options.first, options.count, options.clean))


if __name__ == "__main__":
    main()
