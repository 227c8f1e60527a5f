"""The land of a sun study: from files, with its place and its north."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import AssetError, InputError
from renderer.world.sun_course import SunlightPeriod
from renderer.world.sunlit_land import land_of, land_of_files, place_of
from renderer.world.terrain import Terrain
from renderer.world.terrain_crs import Crs
from renderer.world.terrain_grid import placed


def test_a_grid_s_north_is_not_the_pole_s() -> None:
    """The meridian convergence of UTM is (longitude - central meridian) sin(latitude), nearly."""
    heights = np.linspace(300, 900, 1200, dtype=np.float32).reshape(40, 30)
    terrain = placed(Terrain(heights, (25.0, 25.0), (711_000.0, 5_010_000.0), Crs(32631, False)))
    place = place_of(SunlightPeriod(), land_of(terrain))
    assert place.altitudes == (300.0, 900.0)
    assert (place.latitude, place.longitude) == (terrain.latitude, terrain.longitude)
    expected = np.radians(terrain.longitude - 3.0) * np.sin(np.radians(terrain.latitude))
    # East of the central meridian the grid's north lies clockwise of the true one.
    assert place.bearing == pytest.approx(expected, rel=2e-3)


def test_files_are_named_when_they_are_wrong(tmp_path: Path) -> None:
    ground, canopy = tmp_path / "ground.npz", tmp_path / "canopy.npz"
    np.savez(ground, elevation=np.zeros((4, 5), np.float32), cell_size=(2.0, 2.0))
    np.savez(canopy, elevation=np.full((4, 5), 3, np.float32), cell_size=(2.0, 2.0))
    assert land_of_files({"terrain": ground, "canopy": canopy}).closed
    np.savez(canopy, elevation=np.zeros((5, 4), np.float32), cell_size=(2.0, 2.0))
    with pytest.raises(AssetError) as refused:
        land_of_files({"terrain": ground, "canopy": canopy})
    assert refused.value.field == "canopy"
    for wrong, field in (({"canopy": canopy}, "canopy"), ({"terrain": ground, "mesh": ground}, "mesh")):
        with pytest.raises(InputError) as named:
            land_of_files(wrong)
        assert named.value.field == field
    ground.write_bytes(b"no terrain")
    with pytest.raises(AssetError) as refused:
        land_of_files({"terrain": ground})
    assert refused.value.field == "terrain"
