"""One steady cycle of a trot for the bench, by canter's formulas over whole arrays in numpy.

First line in: the number of points, period, duty, swing height, hip height, forward velocity, then
for each leg its phase offset, hip, upper and lower link, and the signs and offsets of its axes.
Then, for each line, one computation of the whole cycle; out comes its time in seconds. At the end of
the input positions, velocities and accelerations of every axis go out as raw doubles.
"""

import sys
from time import perf_counter

import numpy as np


class Varying:
    """A quantity over time with its first two derivatives, as arrays."""

    def __init__(self, value, rate=0.0, acceleration=0.0):
        self.value, self.rate, self.acceleration = value, rate, acceleration

    def __add__(self, other):
        if not isinstance(other, Varying):
            return Varying(self.value + other, self.rate, self.acceleration)
        return Varying(
            self.value + other.value,
            self.rate + other.rate,
            self.acceleration + other.acceleration,
        )

    def __neg__(self):
        return self * -1.0

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        if not isinstance(other, Varying):
            return Varying(
                self.value * other, self.rate * other, self.acceleration * other
            )
        return Varying(
            self.value * other.value,
            self.rate * other.value + self.value * other.rate,
            self.acceleration * other.value
            + 2.0 * self.rate * other.rate
            + self.value * other.acceleration,
        )

    def sqrt(self):
        root = np.sqrt(self.value)
        first, second = 0.5 / root, -0.25 / (root * self.value)
        return Varying(
            root,
            first * self.rate,
            first * self.acceleration + second * self.rate**2,
        )

    def atan2(self, cosine):
        y, x = self, cosine
        square = x.value**2 + y.value**2
        rate = (x.value * y.rate - y.value * x.rate) / square
        turning = x.value * y.acceleration - y.value * x.acceleration
        growing = 2.0 * (x.value * x.rate + y.value * y.rate)
        return Varying(
            np.arctan2(y.value, x.value), rate, (turning - rate * growing) / square
        )


def pieces(parts):
    """A law's pieces from the amplitude, rate, phase and length of each, and its state at the end."""
    start, position, velocity, made = 0.0, 0.0, 0.0, []
    for amplitude, rate, phase, length in parts:
        piece = (start, position, velocity, amplitude, rate, phase)
        made.append(piece)
        position, velocity, _ = of_piece(piece, start + length)
        start += length
    return made


def of_piece(piece, u):
    start, position, velocity, amplitude, rate, phase = piece
    elapsed = u - start
    if rate == 0.0:
        return (
            position + elapsed * (velocity + 0.5 * amplitude * elapsed),
            velocity + amplitude * elapsed,
            amplitude + 0.0 * elapsed,
        )
    angle = rate * elapsed + phase
    drift = velocity - amplitude / rate * np.sin(phase)
    return (
        position
        + drift * elapsed
        - amplitude / rate**2 * (np.cos(angle) - np.cos(phase)),
        drift + amplitude / rate * np.sin(angle),
        amplitude * np.cos(angle),
    )


def law(made, scale, u):
    """Value and two derivatives by u of a law over an array."""
    which = np.searchsorted([piece[0] for piece in made], u, side="right") - 1
    out = np.empty((3, len(u)))
    for index, piece in enumerate(made):
        here = which == index
        if here.any():
            out[:, here] = of_piece(piece, u[here])
    return out * scale


def modified_trapezoid():
    ramp, half = 0.125, np.pi / 2
    hold = 0.5 - 2 * ramp
    made = pieces(
        [
            (1.0, half / ramp, -half, ramp),
            (1.0, 0.0, 0.0, hold),
            (1.0, half / ramp, 0.0, 2 * ramp),
            (-1.0, 0.0, 0.0, hold),
            (-1.0, half / ramp, 0.0, ramp),
        ]
    )
    return made, 1.0 / of_piece(made[-1], 1.0)[0]


def bump():
    ramp, half = 1.0 / 16, np.pi / 2
    difference, together = 2 * ramp / np.pi, 0.5 - 3 * ramp
    outer, inner = 0.5 * (together - difference), together + difference
    made = pieces(
        [
            (1.0, half / ramp, -half, ramp),
            (1.0, 0.0, 0.0, outer),
            (1.0, half / ramp, 0.0, 2 * ramp),
            (-1.0, 0.0, 0.0, inner),
            (-1.0, half / ramp, 0.0, 2 * ramp),
            (1.0, 0.0, 0.0, outer),
            (1.0, half / ramp, 0.0, ramp),
        ]
    )
    top = [piece for piece in made if piece[0] <= 0.5][-1]
    return made, 1.0 / of_piece(top, 0.5)[0]


WAY, BUMP = modified_trapezoid(), bump()


def joints(foot, hip, upper, lower):
    x, y, z = foot
    across = y + hip
    distance = (across * across + z * z).sqrt()
    w = ((distance - hip) * (distance + hip)).sqrt()
    abduction = across.atan2(-z) - Varying(hip).atan2(w)
    distance = (x * x + w * w).sqrt()
    reach, least = upper + lower, abs(upper - lower)
    outside = -((distance - reach) * (distance + reach))
    inside = (distance - least) * (distance + least)
    area = (outside * inside).sqrt()
    square = distance * distance
    inner = area.atan2(square + (upper**2 - lower**2))
    knee = area.atan2(-square + (upper**2 + lower**2))
    return [w.atan2(x) + inner, knee, abduction]


def cycle(times, period, duty, swing, height, velocity, legs):
    rows = []
    for offset, hip, upper, lower, *axes in legs:
        clock = (times / period - offset) % 1.0
        air = (1.0 - duty) * period
        x = -velocity * (clock - 0.5 * duty) * period
        x = np.stack([x, np.full_like(x, -velocity), np.zeros_like(x)])
        z = np.stack([np.full_like(clock, -height), 0.0 * clock, 0.0 * clock])
        up = clock >= duty
        u = (clock[up] - duty) / (1.0 - duty)
        by_time = np.array([[1.0], [1.0 / air], [1.0 / air**2]])
        x[:, up] += velocity * period * law(*WAY, u) * by_time
        z[:, up] += swing * law(*BUMP, u) * by_time
        foot = Varying(*x), Varying(0.0 * clock), Varying(*z)
        for joint, sign, turned in zip(
            joints(foot, hip, upper, lower), axes[:3], axes[3:]
        ):
            joint = joint * sign + turned
            rows += [joint.value, joint.rate, joint.acceleration]
    return np.stack(rows)


count, *numbers = (float(word) for word in sys.stdin.readline().split())
period, *rest = numbers[:5]
legs = np.array(numbers[5:]).reshape(4, 10).tolist()
# The same times as canter's, in the middle of each millisecond: nothing changes there.
times = (np.arange(int(count)) + 0.5) * (period / count)
result = None
for _ in sys.stdin:
    begin = perf_counter()
    result = cycle(times, period, *rest, legs)
    print(perf_counter() - begin, flush=True)
sys.stdout.flush()
sys.stdout.buffer.write(np.ascontiguousarray(result).astype("<f8").tobytes())
