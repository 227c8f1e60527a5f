"""Where directional textures fail, as numbers and charts: thin parts, open meshes, the box from within, low light, and
harmonics that ring."""

from __future__ import annotations

import numpy as np
import trimesh

from renderer.core.failure import Charted, Curve
from renderer.core.technique import Arrays
from renderer.directional.cloud import bake_cloud
from renderer.directional.codes.code import decode
from renderer.directional.codes.harmonics import Harmonics, ringing
from renderer.directional.codes.horizon_ring import HorizonRing
from renderer.directional.facing import faces_seen
from renderer.directional.frames import quantised
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.shadow_hemispheres import Caster, shadow_bits, unpacked, world_directions
from renderer.directional.subjects import bake_subject, box_of
from renderer.directional.visibility import FACES, bake_faces, bake_visibility
from renderer.directional.visibility_failures import missed_share, turned_share
from renderer.world.camera import Look

KNOT = {"kind": "knot", "size": 2.0, "turns": 2, "loops": 3, "strands": 3, "twist": 14}
POINTS = 2000
"""Of the cloud whose hemispheres are looked at."""


def _quiet(share: float, words: str) -> None:
    """Nobody waits for these."""


def _subject(vertices: np.ndarray, faces: np.ndarray, two_sided: bool = False) -> Arrays:
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return {
        "vertices": np.asarray(vertices, np.float64),
        "faces": np.asarray(faces, np.int32),
        "normals": np.repeat(normal[:, None], 3, axis=1),
        "colour": np.full((len(faces), 3), 0.5),
        "two_sided": np.asarray(two_sided),
        "box": box_of(vertices, faces),
    }


BARS, WIDTH = 8, 0.06
"""Of a fence 2 m wide: how many, and each one's width [m]."""

TEXELS = (16, 32, 64, 128)


def thin_parts() -> Charted:
    """Share of a fence that stands in texels whose own ray goes by, against the texels of a face's side."""
    middles = np.linspace(-1 + WIDTH, 1 - WIDTH, BARS) + 0.013 * np.arange(BARS)
    bars = [trimesh.creation.box((WIDTH, 0.02, 1.0)).apply_translation((x, 0.0, 0.5)) for x in middles]
    vertices = np.concatenate([bar.vertices for bar in bars])
    faces = np.concatenate([np.asarray(bar.faces) + 8 * number for number, bar in enumerate(bars)])
    subject = _subject(vertices, faces)
    cloud = bake_cloud({"points": 5000}, {"subject": subject}, _quiet)
    shares = np.array([missed_share(subject, cloud, texels, 33, (2,)) for texels in TEXELS])
    curves = (Curve("failing", np.array(TEXELS[:1]), shares[:1]), Curve("surviving", np.array(TEXELS), shares))
    return Charted(float(shares[0]), float(shares[-1]), curves, "texels along a face's side", "share missed", "x")


def open_mesh() -> Charted:
    """Share of what the faces see of a bowl that shows its back, lit as if from inside, against how far it is open."""
    depths = np.array([-0.6, -0.2, 0.2, 0.6])
    found = {sides: np.array([_turned(float(depth), sides) for depth in depths]) for sides in (False, True)}
    curves = (Curve("failing", depths, found[False]), Curve("surviving", depths, found[True]))
    return Charted(float(found[False].max()), float(found[True].max()), curves, "height of the rim, radii of the ball",
                   "share with normals turned away")  # fmt: skip


def _turned(rim: float, two_sided: bool) -> float:
    ball = trimesh.creation.icosphere(subdivisions=3)
    kept = np.asarray(ball.faces)[(ball.vertices[ball.faces][..., 2] < rim).all(axis=1)]
    subject = _subject(np.asarray(ball.vertices), kept, two_sided)
    inputs = {"subject": subject, "cloud": bake_cloud({"points": 4000}, {"subject": subject}, _quiet)}
    sizes = {"texels": 16, "directions": 33}
    faces = bake_faces({**sizes, "faces": list(range(FACES))}, inputs, _quiet)
    return turned_share(inputs["cloud"], bake_visibility(sizes, {"subject": subject, "faces_0": faces}, _quiet))


def inside_the_box() -> Charted:
    """Share of a knot's directions that no face is looked through, against the eye's distance from the middle."""
    box = np.asarray(bake_subject(KNOT, {}, _quiet)["box"])
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    away = np.array([0.0, 0.3, 0.6, 0.9, 1.2, 1.6, 2.0])
    way = np.array([0.48, 0.6, 0.64])
    # all faces are seen from outside alone: an eye within the box has none before it
    missed = np.array([float(not faces_seen(_at(middle + far * way * half / np.abs(way).max(), middle), box))
                       for far in away])  # fmt: skip
    curves = (Curve("failing", away, missed), Curve("surviving", away[-3:], missed[-3:]))
    return Charted(float(missed[1]), float(missed[-1]), curves, "eye from the middle, half boxes", "share not drawn")


def _at(eye: np.ndarray, middle: np.ndarray) -> Look:
    target = middle if np.linalg.norm(eye - middle) > 1e-3 else middle + [0.0, 1.0, 0.0]
    return Look(eye=tuple(float(v) for v in eye), target=tuple(float(v) for v in target))


ELEVATIONS = np.array([2.0, 5.0, 10.0, 20.0, 35.0, 50.0, 70.0])
"""Of light above a point's own horizon [deg]."""


def grazing_light() -> Charted:
    """Share of a knot's points at which light is misjudged, against its height over their horizons, by 129 directions
    and by 513."""
    caster, positions, normals = _points()
    rng = np.random.default_rng(2)
    shares: dict[int, list[float]] = {129: [], 513: []}
    masks = {count: _masks(caster, positions, normals, hemisphere_of(count)) for count in shares}
    for elevation in np.radians(ELEVATIONS):
        turn = rng.uniform(0, 2 * np.pi, len(positions))
        local = np.stack([np.cos(elevation) * np.cos(turn), np.cos(elevation) * np.sin(turn),
                          np.full(len(turn), np.sin(elevation))], axis=-1)  # fmt: skip
        lit = caster.open(positions, normals, world_directions(normals, local[:, None]))[:, 0]
        for count, own in shares.items():
            held = masks[count][np.arange(len(turn)), hemisphere_of(count).nearest(local)]
            own.append(float((held != lit).mean()))
    curves = (
        Curve("failing", ELEVATIONS, np.array(shares[129])),
        Curve("surviving", ELEVATIONS, np.array(shares[513])),
    )
    low = slice(0, 3)
    return Charted(float(np.mean(shares[129][low])), float(np.mean(shares[513][low])), curves,
                   "light above the horizon, degrees", "share misjudged")  # fmt: skip


def _points() -> tuple[Caster, np.ndarray, np.ndarray]:
    subject = bake_subject(KNOT, {}, _quiet)
    cloud = bake_cloud({"points": POINTS}, {"subject": subject}, _quiet)
    caster = Caster(subject["vertices"], subject["faces"])
    return caster, cloud["position"], quantised(cloud["normal"].astype(np.float64))


def _masks(caster: Caster, positions: np.ndarray, normals: np.ndarray, layout: Hemisphere) -> np.ndarray:
    return unpacked(shadow_bits(caster, positions, normals, layout, _quiet)[0], layout.count)


BYTES = (5, 9, 17, 33)


def ringing_harmonics() -> Charted:
    """Share of a knot's hemispheres that truncated harmonics put beyond 0 to 1 by a tenth, before any clamp."""
    layout = hemisphere_of(129)
    masks = _masks(*_points(), layout)
    codes = [Harmonics(layout, size) for size in BYTES]
    shares = np.array([ringing(decode(code, code.encode(masks)))[0] for code in codes])
    ring = HorizonRing(layout, 9)
    still = ringing(decode(ring, ring.encode(masks)))[0]
    sizes = np.array(BYTES)
    curves = (Curve("failing", sizes, shares), Curve("surviving", sizes, np.full(len(sizes), still)))
    return Charted(float(shares[1]), float(still), curves, "bytes of a point", "share off by a tenth", "x")
