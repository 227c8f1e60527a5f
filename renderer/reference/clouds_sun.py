"""Sunlight at a point of the clouds' reference: through clouds whose forward peak bends it, air and relief. Compiled.

Next-event estimation with droplets would put all its noise into the peak, which is thousands of times brighter than
the rest. So the peak's events between a point and the sun are drawn together with the way there: their angles from the
sun on, their places along the straight line, as many as a Poisson process of the peak's share of the extinction puts
there. Were the bent way as long as the straight one, what a draw counts for would be exp(-(1 - f) tau) without any
noise; what is left of the difference is weighed exactly. With the chance `OWN` the events are drawn along their own
way instead, which reaches what the straight line does not; both are weighed by the balance heuristic (Veach 1997).

The three bands share every draw: a path is drawn in one of them, and weighed by the mean of the three densities with
which each would have drawn it (hero wavelength sampling, Wilkie et al. 2014).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.clouds_air import air_phase, depth_to_top
from renderer.reference.clouds_layer import FAR, gap_at, ground_at, run
from renderer.reference.clouds_phase import PEAK, PEAK_OF, PEAK_SUM, REST_OF, draw_cosine, place_of, read
from renderer.reference.clouds_world import SHARE, SUN

OWN = 0.4
"""Chance that the peak's events are drawn along their own way."""

MOST = 96
"""Most events of the peak between a point and the sun; more leave less than 1e-9 of the light."""

DARK = 40.0
"""Optical depth of the rest beyond which no sunlight is looked for."""

LIKELY, UNLIKELY = 12.0, 0.3
"""Sunlight that comes through less than a sixth of what it could is looked for by chance, at least this."""

COS_PEAK = math.cos(PEAK)

CLOUD, GROUND, MOLECULES, HAZE = (np.int64(kind) for kind in range(4))
"""What stands at a point; numpy's integers, since what takes a literal of Python is compiled for each anew."""


@njit(cache=True, inline="always")
def uniform(state):
    """The next number in [0, 1) of a generator (splitmix64, Steele, Lea and Flood 2014)."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@njit(cache=True)
def turned(d, cosine, angle):
    """A direction turned away from `d` by an angle of a given cosine, towards `angle` round it [rad]."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    a, b = sine * math.cos(angle), sine * math.sin(angle)
    # an orthonormal basis without a square root (Duff et al. 2017)
    sign = math.copysign(1.0, d[2])
    e = -1.0 / (sign + d[2])
    f = d[0] * d[1] * e
    x = a * (1.0 + sign * d[0] * d[0] * e) + b * f + cosine * d[0]
    y = a * sign * f + b * (sign + d[1] * d[1] * e) + cosine * d[1]
    z = -a * sign * d[0] - b * d[1] + cosine * d[2]
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


@njit(cache=True, inline="always")
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _chain(scene, hero, s, straight, state, angles, ways, ratio):
    """Draw the peak's events of a way to the sun.

    Args:
        s: direction to the sun. straight: length inside clouds that way, m.
        angles: (MOST, 3) gets directions, the first next to the sun; ways: (MOST,) lengths inside clouds between two
            events, from the point on; ratio: (3,) what the angles' density is in each band against the hero's.

    Returns:
        how many, MOST where there are too many, and the sum of `ways`.
    """
    share = scene.triples[SHARE, hero]
    count = 0
    if uniform(state) < OWN:
        while count < MOST and (count == 0 or uniform(state) < share):
            ways[count] = -math.log(1.0 - uniform(state)) / scene.extinction
            count += 1
    else:
        at = 0.0
        while count < MOST:
            at -= math.log(1.0 - uniform(state)) / (share * scene.extinction)
            if at > straight:
                break
            ways[count] = at
            count += 1
        for k in range(count - 1, 0, -1):
            ways[k] -= ways[k - 1]
    total = 0.0
    before = s
    for c in range(3):
        ratio[c] = 1.0
    tables = scene.tables
    for k in range(count):
        total += ways[k]
        cosine = draw_cosine(tables, scene.guides, PEAK_SUM + hero, uniform(state))
        before = turned(before, cosine, 2.0 * math.pi * uniform(state))
        angles[k, 0], angles[k, 1], angles[k, 2] = before
        place = place_of(math.acos(min(cosine, 1.0)))
        own = max(read(tables, PEAK_OF + hero, place), 1e-12)
        for c in range(3):
            ratio[c] *= read(tables, PEAK_OF + c, place) / own
    return count, total


@njit(cache=True)
def _walk(scene, p, s, count, angles, ways, state, work):
    """Walk a bent way to the sun.

    Returns:
        the length inside clouds behind its last event, m, or -1 where there is no such way; the optical depth of its
        air is then in work[3].
    """
    depth, more = work[3], work[4]
    first = (angles[count - 1, 0], angles[count - 1, 1], angles[count - 1, 2])
    if ground_at(scene, p, first) < FAR:
        return -1.0
    depth_to_top(scene, p[0], p[1], p[2], first, depth)
    x, y, z = p
    for k in range(count):
        d = (angles[count - 1 - k, 0], angles[count - 1 - k, 1], angles[count - 1 - k, 2])
        t = run(scene, (x, y, z), d, ways[k], FAR, uniform(state))[1]
        if t >= FAR:
            return -1.0
        x, y, z = x + t * d[0], y + t * d[1], z + t * d[2]
        if k == 0:
            # the way's air: below the clouds along its own direction, above them along the sun's
            depth_to_top(scene, x, y, z, d, more)
            for c in range(3):
                depth[c] -= more[c]
    if ground_at(scene, (x, y, z), s) < FAR:
        return -1.0
    depth_to_top(scene, x, y, z, s, more)
    for c in range(3):
        depth[c] += more[c]
    return run(scene, (x, y, z), s, FAR, FAR, uniform(state))[0]


@njit(cache=True)
def _value(scene, kind, band, cosine):
    """What stands at a point sends that way, for each unit of light: the rest of the phase function, or Lambert's."""
    if kind == CLOUD:
        return read(scene.tables, REST_OF + band, place_of(math.acos(min(max(cosine, -1.0), 1.0))))
    if kind == GROUND:
        return max(cosine, 0.0) / math.pi
    return air_phase(kind == HAZE, cosine)


@njit(cache=True)
def peak_light(scene, p, facing, factor, path, state, work, out):
    """Add the sunlight that the droplets' peak alone sends along a path that has met nothing else so far."""
    s = to_sun(scene, state)
    cosine = _dot(facing, s)
    if cosine <= COS_PEAK or ground_at(scene, p, s) < FAR:
        return
    depth = work[3]
    depth_to_top(scene, p[0], p[1], p[2], s, depth)
    straight = run(scene, p, s, FAR, FAR, uniform(state))[0]
    place = place_of(math.acos(min(cosine, 1.0)))
    mean = (path[0] + path[1] + path[2]) / 3.0
    for c in range(3):
        sent = read(scene.tables, PEAK_OF + c, place) * factor[c] * path[c] / mean
        out[c] += scene.irradiance * sent * math.exp(-scene.extinction * straight - depth[c])


@njit(cache=True, inline="always")
def to_sun(scene, state):
    """Direction to a point of the sun's disc."""
    cosine = 1.0 - uniform(state) * (1.0 - math.cos(scene.sun_radius))
    return turned(
        (scene.triples[SUN, 0], scene.triples[SUN, 1], scene.triples[SUN, 2]), cosine, 2.0 * math.pi * uniform(state)
    )


@njit(cache=True)
def sunlight(scene, hero, p, facing, kind, factor, path, state, work, out):
    """Add the sunlight that a point sends along a path, all but what a droplet's peak does.

    Args:
        hero: the band in which the path is drawn.
        p, facing: the point, and the direction that its cosine is measured from: the ground's normal, or where the
            path is going.
        kind: CLOUD, GROUND, MOLECULES or HAZE.
        factor, path: (3,) what the path counts for in each band, and its density against the hero's.
        work: scratch. out: (3,) gets the radiance.
    """
    angles, ways, ratio, depth, _ = work
    s = to_sun(scene, state)
    light = scene.irradiance
    if kind == CLOUD:
        below = gap_at(scene, p)
        rest = (1.0 - scene.triples[SHARE, hero]) * scene.extinction * below / max(_up(scene, p, s), 0.1)
        chance = min(max(LIKELY * math.exp(-max(rest, 0.0)), UNLIKELY), 1.0)
        if uniform(state) >= chance:
            return
        light /= chance
    straight = run(scene, p, s, FAR, FAR, uniform(state))[0]
    if ground_at(scene, p, s) >= FAR:
        depth_to_top(scene, p[0], p[1], p[2], s, depth)
        mean = (path[0] + path[1] + path[2]) / 3.0
        through = light * math.exp(-scene.extinction * straight) / mean
        cosine = _dot(facing, s)
        for c in range(3):
            out[c] += _value(scene, kind, c, cosine) * factor[c] * path[c] * through * math.exp(-depth[c])
    rest = (1.0 - scene.triples[SHARE, hero]) * scene.extinction * straight
    chance = min(max(LIKELY * math.exp(-rest), UNLIKELY), 1.0)
    if rest > DARK or uniform(state) >= chance:
        return
    light /= chance
    count, total = _chain(scene, hero, s, straight, state, angles, ways, ratio)
    if count == 0 or count == MOST:
        return
    left = _walk(scene, p, s, count, angles, ways, state, work)
    if left < 0.0:
        return
    through = light * math.exp(-scene.extinction * (total + left))
    drawn = 0.0
    for c in range(3):
        share = scene.triples[SHARE, c]
        own = OWN * (1.0 - share) / share * math.exp(-scene.extinction * total)
        if total <= straight:
            own += (1.0 - OWN) * math.exp(-share * scene.extinction * straight)
        drawn += path[c] * ratio[c] * own / 3.0
    cosine = _dot(facing, (angles[count - 1, 0], angles[count - 1, 1], angles[count - 1, 2]))
    for c in range(3):
        sent = _value(scene, kind, c, cosine) * factor[c] * path[c] * ratio[c]
        out[c] += sent * through * math.exp(-depth[c]) / drawn


@njit(cache=True, inline="always")
def _up(scene, p, d):
    """Cosine of a direction to the vertical of a point."""
    up = p[2] + scene.radius
    return (p[0] * d[0] + p[1] * d[1] + up * d[2]) / math.sqrt(p[0] * p[0] + p[1] * p[1] + up * up)
