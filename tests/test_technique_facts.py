"""What each technique costs and how wrong it is: the right numbers under the right names."""

from __future__ import annotations

from typing import Any

import pytest

from renderer.benching import variants
from renderer.technique_facts import facts

MACHINE = {"renderer": "pretended", "cores": 2}


def lines(number: Any, **more: Any) -> list[dict[str, Any]]:
    return [
        {"techniques": chosen, "preset": preset, "machine": MACHINE, **more, **number(chosen, preset)}
        for preset in ("noon", "low_sun", "dawn")
        for chosen in variants("forest")
    ]


def test_each_technique_has_its_own_numbers_and_the_default_those_of_all() -> None:
    wrong = {"noon": 0.3, "low_sun": 0.1, "dawn": 0.2}

    def error(chosen: Any, preset: str) -> dict[str, Any]:
        if chosen["light"] == "gouraud" and preset == "dawn":
            return {"failed": "no light there"}
        return {"relative_rmse": wrong[preset] * (2 if chosen["shadow"] == "none" else 1)}

    def cost(chosen: Any, preset: str) -> dict[str, Any]:
        twice = 2 if chosen["shadow"] == "none" else 1
        return {"parameters": {"moves": "sun"}, "frame_ms": 90.0 * twice, "yardsticks": 0.5 * twice}

    found = facts("forest", lines(error), lines(cost)[: len(variants("forest"))], 48, 40.0)
    none, default = (found["slots"]["shadow"][kind] for kind in ("none", "voxel_transmittance"))
    assert none == pytest.approx({"error": 0.4, "worst": 0.6, "sun": 1.0, "sun_ms": 40.0})
    assert default == pytest.approx({"error": 0.2, "worst": 0.3, "sun": 0.5, "sun_ms": 20.0})
    assert found["slots"]["light"]["leaf"] == default
    assert found["slots"]["light"]["gouraud"]["error"] == pytest.approx(0.2), "of the pictures that were drawn"
    assert "3 presets, 48 px" in found["note"]
    assert "40 ms" in found["note"]


def test_what_was_not_measured_is_left_out() -> None:
    found = facts("forest", lines(lambda chosen, preset: {"relative_rmse": 0.1}), [], 48, 40.0)
    assert found["slots"]["sky"]["constant"] == {"error": pytest.approx(0.1), "worst": pytest.approx(0.1)}
