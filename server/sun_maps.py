"""The maps that a study of the sun leaves, as every door hands them out."""

from __future__ import annotations

from server.facade import SunStudy

MAPS = ("hours", "insolation")
"""Maps that are files of their own; what else a study found is in its arrays."""


def map_files(found: SunStudy) -> dict[str, bytes]:
    """Each map as GeoTIFF and as a picture, by file name."""
    files = {f"{name}.tif": found.geotiff(name) for name in MAPS}
    return files | {f"{name}.png": found.picture(name) for name in MAPS}
