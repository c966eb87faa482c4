"""Evaluates s-curve-beta's interpolated curve for the bench, and times it.

First line in: the number of points and the move (duration, from, to). Then, for each line, one
evaluation over the whole array; out comes its time in seconds. At the end of the input the
positions go out as raw doubles.
"""

import sys
from time import perf_counter

import numpy
import scurvebeta

count, duration, start, end = (float(word) for word in sys.stdin.readline().split())
times = numpy.linspace(0.0, duration, int(count))
positions = None
for _ in sys.stdin:
    begin = perf_counter()
    positions = scurvebeta.sCurve(times, duration, start, end)
    print(perf_counter() - begin, flush=True)
sys.stdout.flush()
sys.stdout.buffer.write(positions.astype("<f8").tobytes())
