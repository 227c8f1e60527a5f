"""Named views of the shells: the scenes of Dufort 2005, table 6.1 and figures 5.11 and 6.1."""

from __future__ import annotations

from typing import Any

from renderer.core.technique import Preset

_COMMON_DAY = {"haze": 20}
"""Air in which shade on the ground keeps a quarter of the light, and is grey; very clear air leaves a tenth, blue."""


def _camera(
    distance: float, azimuth: float, elevation: float, field_of_view: float = 35, height: float = 0.0
) -> dict[str, Any]:
    return {
        "kind": "orbit",
        "target": [0, 0, height],
        "distance": distance,
        "azimuth": azimuth,
        "elevation": elevation,
        "field_of_view": field_of_view,
    }


def _sun(azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


_HOLLOW = {"opaque": False}

_SPARSE = {"first_rays": 1, "first_places": 6}
"""Thin matter: each ray has far to go, and many places to light."""

_MOVING = "Moving"

_BESIDE = "Beside other meshes"

PRESETS = {
    "fur": Preset(
        "Fur",
        "Hair that grows on a sphere, semi-transparent at its tips.",
        {
            "camera": _camera(2.9, 150, 15),
            "sun": _sun(205, 45),
            "extrusion": {"thickness": 0.16},
            "base": {"colour": [0.12, 0.07, 0.04]},
        },
    ),
    "teapot_relief": Preset(
        "Teapot, relief",
        "A semi-transparent relief on a hollow teapot.",
        {
            "surface": {"kind": "teapot"},
            "extrusion": {"thickness": 0.06},
            "texture": {"kind": "relief"},
            "base": _HOLLOW,
            "camera": _camera(3.2, 200, 20),
            "sun": _sun(150, 50),
            "sampling": {**_SPARSE, "rate": 0.7}, "shadow": {"resolution": 224},
        },
    ),
    "teapot_wicker": Preset(
        "Teapot, wicker",
        "Opaque rods woven round a teapot.",
        {
            "surface": {"kind": "teapot"},
            "extrusion": {"thickness": 0.05},
            "texture": {"kind": "weave"},
            "base": {"colour": [0.1, 0.06, 0.03]},
            "camera": _camera(3.2, 165, 22),
            "sun": _sun(110, 40),
            "sampling": {"rate": 1.1, "first_places": 6}, "shadow": {"reach": 1.25},
        },
    ),
    "teapot_table": Preset(
        "Wicker teapot on a table",
        "Other meshes of the scene: they hide and shade the wicker, and it shades them.",
        {
            "surface": {"kind": "teapot"},
            "extrusion": {"thickness": 0.05},
            "texture": {"kind": "weave"},
            "base": {"colour": [0.1, 0.06, 0.03]},
            "camera": _camera(4.2, 165, 24, 35, -0.1),
            "sun": _sun(250, 36),
            "air": _COMMON_DAY,
            "things": {
                "list": [
                    {"kind": "box", "position": [0, 0, -0.49], "width": 2.6, "depth": 2.0, "height": 0.08,
                     "colour": [0.42, 0.25, 0.13]},
                    {"kind": "ball", "position": [0.62, -0.62, -0.41], "radius": 0.14, "colour": [0.6, 0.25, 0.03]},
                    {"kind": "ball", "position": [0.88, -0.45, -0.41], "radius": 0.13, "colour": [0.62, 0.3, 0.04]},
                    {"kind": "ground", "position": [0, 0, -1.3], "size": 40, "colour": [0.3, 0.32, 0.3]},
                ]
            },
        },
        _BESIDE,
    ),
    "fur_pedestal": Preset(
        "Fur on a pedestal",
        "A ball of fur among other meshes: each hair of its edge is seen in the shadow on the ground.",
        {
            "camera": _camera(4.4, 150, 20, 35, -0.15),
            "sun": _sun(225, 38),
            "air": _COMMON_DAY,
            "extrusion": {"thickness": 0.16},
            "base": {"colour": [0.12, 0.07, 0.04]},
            "things": {
                "list": [
                    {"kind": "ground", "position": [0, 0, -1.1], "size": 40, "colour": [0.34, 0.33, 0.3]},
                    {"kind": "pedestal", "position": [0, 0, -1.1], "radius": 0.42, "height": 0.5},
                    {"kind": "box", "position": [-0.9, 0.3, -1.1], "width": 0.4, "depth": 0.4, "height": 0.75},
                ]
            },
        },
        _BESIDE,
    ),
    "vase_trees": Preset(
        "Vase, trees",
        "Opaque trees that stand out of a vase.",
        {
            "surface": {"kind": "vase"},
            "extrusion": {"thickness": 0.12},
            "texture": {"kind": "trees"},
            "base": {"colour": [0.2, 0.26, 0.07]},
            "camera": _camera(3.6, 180, 12),
            "sun": _sun(120, 35),
        },
    ),
    "vase_relief": Preset(
        "Vase, relief",
        "A semi-transparent relief on a hollow vase: its back shows through.",
        {
            "surface": {"kind": "vase", "repeat_u": 6, "repeat_v": 4},
            "extrusion": {"thickness": 0.05},
            "texture": {"kind": "relief"},
            "base": _HOLLOW,
            "camera": _camera(3.6, 180, 12),
            "sun": _sun(230, 40),
            "sampling": {"rate": 1.1, "first_places": 12},
        },
    ),
    "plane_fog": Preset(
        "Trees in fog",
        "Trees on a plane, in fog that the sun shines through.",
        {
            "surface": {"kind": "plane", "size": 4, "repeat_u": 4, "repeat_v": 4},
            "extrusion": {"thickness": 0.35},
            "texture": {"kind": "trees", "fog": 1.5},
            "base": {"colour": [0.2, 0.26, 0.07]},
            "camera": _camera(4.0, 200, 22, 40),
            "sun": _sun(290, 25),
            "sampling": {**_SPARSE, "rate": 0.9, "most": 20}, "shadow": {"close": 1},
        },
    ),
    "tube_rocks": Preset(
        "Tube, rocks",
        "Rocks on a tube of few triangles.",
        {
            "surface": {"kind": "tube"},
            "extrusion": {"thickness": 0.12},
            "texture": {"kind": "rocks"},
            "base": {"colour": [0.1, 0.09, 0.08]},
            "camera": _camera(3.4, 160, 14),
            "sun": _sun(95, 35),
            "sampling": {"rate": 1.0, "first_places": 2, "most": 16}, "shadow": {"close": 2},
        },
    ),
    "fur_growing": Preset(
        "Fur that grows",
        "Hair that grows and goes as time runs: no precomputation, at twenty pictures a second and more.",
        {
            "camera": _camera(3.1, 150, 15),
            "sun": _sun(205, 45),
            "surface": {"divisions": 8, "repeat_u": 2, "repeat_v": 2},
            "texture": {"kind": "fur", "across": 64, "strands": 13, "layers": 24},
            "extrusion": {"thickness": 0.14},
            "base": {"colour": [0.12, 0.07, 0.04]},
            "sampling": {"rate": 1.0}, "shadow": {"resolution": 128},
            "course": {"period": 8, "keys": [{"at": 0}, {"at": 1}, {"at": 4, "growth": 0.1}, {"at": 7}]},
        },
        _MOVING,
    ),
    "tube_bending": Preset(
        "Tube that bends",
        "Rocks on a tube that bends to and fro: moved tetrahedra alone are computed again.",
        {
            "surface": {"kind": "tube"},
            "motion": {"kind": "bend", "angle": 70, "period": 6},
            "extrusion": {"thickness": 0.12},
            "texture": {"kind": "rocks"},
            "base": {"colour": [0.1, 0.09, 0.08]},
            "sampling": {"rate": 1.0, "first_places": 2, "most": 16}, "shadow": {"resolution": 128},
            "camera": _camera(3.6, 160, 14),
            "sun": _sun(95, 35),
        },
        _MOVING,
    ),
    "tube_keys": Preset(
        "Tube by key frames",
        "Fur that grows and slides on a tube that twists, bends and swells: planes and maps of eight key frames.",
        {
            "surface": {"kind": "tube", "along": 12},
            "motion": {"kind": "keys", "planes": "interpolated"},
            "extrusion": {"thickness": 0.12},
            "texture": {"kind": "fur", "across": 64, "strands": 13, "layers": 24},
            "base": {"colour": [0.12, 0.07, 0.04]},
            "sampling": {"rate": 1.0}, "shadow": {"resolution": 128},
            "camera": _camera(3.8, 160, 14),
            "sun": _sun(120, 40),
            "course": {
                "period": 8,
                "keys": [
                    {"at": 0, "growth": 0.4},
                    {"at": 1, "growth": 0.55, "bend": 15, "twist": 20},
                    {"at": 2, "growth": 0.7, "bend": 30, "twist": 40},
                    {"at": 3, "growth": 0.85, "bend": 45, "twist": 60},
                    {"at": 4, "bend": 60, "twist": 80},
                    {"at": 5.5, "bend": 30, "twist": 40, "swell": 0.1, "slide_v": 0.5},
                    {"at": 7, "growth": 0.6, "slide_v": 1},
                    {"at": 8, "growth": 0.4, "slide_v": 1},
                ],
            },
        },
        _MOVING,
    ),
    "earth_clouds": Preset(
        "Clouds over the Earth",
        "The Earth under semi-transparent clouds that cast their shadow.",
        {
            "surface": {"kind": "sphere", "layout": "globe", "divisions": 12, "repeat_u": 4, "repeat_v": 2},
            "picture": {"kind": "earth"},
            "extrusion": {"thickness": 0.05},
            "texture": {"kind": "clouds"},
            "voxels": {"density": 0.4},
            "base": {"colour": [1, 1, 1]},
            "camera": _camera(2.7, 160, 18),
            "sun": _sun(100, 30),
            "course": {"period": 120, "keys": [{"at": 0}, {"at": 120, "slide_u": 1}]},
        },
    ),
    "jelly": Preset(
        "Balls in jelly",
        "Opaque balls in red, semi-transparent jelly.",
        {
            "texture": {"kind": "jelly"},
            "course": {"period": 8, "keys": [{"at": 0}, {"at": 4, "second": 0.1}]},
            "extrusion": {"thickness": 0.2},
            "base": {"colour": [0.5, 0.05, 0.04]},
            "camera": _camera(2.9, 150, 15),
            "sun": _sun(205, 45),
        },
    ),
    "absorber": Preset(
        "Green absorber",
        "Even green matter in a hollow sphere: its opacity has a closed form.",
        {
            "texture": {"kind": "uniform"},
            "extrusion": {"thickness": 0.2},
            "base": _HOLLOW,
            "camera": _camera(2.9, 150, 15),
            "sun": _sun(205, 45),
        },
    ),
    "chain": Preset(
        "Chain",
        "Opaque links round a sphere.",
        {
            "texture": {"kind": "chain"},
            "extrusion": {"thickness": 0.12},
            "surface": {"kind": "sphere", "layout": "globe", "repeat_u": 6, "repeat_v": 3},
            "base": {"colour": [0.05, 0.05, 0.06]},
            "camera": _camera(2.7, 150, 15),
            "sun": _sun(205, 45),
        },
    ),
    "sphere_rocks": Preset(
        "Rocks",
        "A sphere of rocks.",
        {
            "texture": {"kind": "rocks", "across": 256, "stones": 6},
            "extrusion": {"thickness": 0.15},
            "base": {"colour": [0.1, 0.09, 0.08]},
            "camera": _camera(2.8, 150, 15),
            "sun": _sun(220, 30),
        },
    ),
    "mushroom": Preset(
        "Mushroom",
        "Deformed wood on a mushroom: voxels finer than pixels, filtered (figure 5.11).",
        {
            "surface": {"kind": "mushroom"},
            "texture": {"kind": "wood"},
            "extrusion": {"thickness": 0.04},
            "base": {"colour": [0.2, 0.1, 0.04]},
            "camera": _camera(3.0, 150, 12),
            "sun": _sun(210, 40),
        },
    ),
}
