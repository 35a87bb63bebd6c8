"""Times libraries from PyPI on request: one line of JSON in, one line with seconds per item out.

Started by the run `sh-core/peers`, which times the same thing in between, so both see the same machine.
"""

import json
import sys
import time

import ducc0
import numpy as np
import sphericart

RNG = np.random.default_rng(1)
REPEATS = 7


def directions(count, dtype):
    x = RNG.normal(size=(count, 3))
    return (x / np.linalg.norm(x, axis=1, keepdims=True)).astype(dtype)


def best(f):
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        f()
        times.append(time.perf_counter() - start)
    return min(times)


def measure(what, n, dtype, count):
    if what == "ducc0":
        height, width = count // 1024, 1024
        maps = RNG.random((3, height, width)).astype(dtype)

        def project():
            for channel in range(3):
                ducc0.sht.analysis_2d(
                    map=maps[channel : channel + 1], lmax=n - 1, spin=0, geometry="F1", nthreads=1
                )

        return best(project) / count
    harmonics = sphericart.SphericalHarmonics(n - 1)
    x = directions(count, dtype)
    compute = harmonics.compute if what == "sphericart" else harmonics.compute_with_gradients
    return best(lambda: compute(x)) / count


print(f"sphericart {sphericart.__version__}, ducc0 {ducc0.__version__}", flush=True)
for line in sys.stdin:
    request = json.loads(line)
    print(measure(request["what"], request["n"], request["type"], request["count"]), flush=True)
