"""Results of the study: charts and raw files of each scene, as its command left them."""

from __future__ import annotations

import mimetypes
from pathlib import Path

from fastapi import APIRouter
from fastapi import Path as PathField
from starlette.responses import FileResponse, Response

from server.hub import TheHub
from server.problems import Json, Missing

router = APIRouter(prefix="/api/study", tags=["study"])
KINDS = {".json": "data", ".jsonl": "raw", ".csv": "table", ".png": "chart", ".svg": "chart"}
mimetypes.add_type("application/jsonl", ".jsonl")


def _files(folder: str, scene: str) -> dict[str, Path]:
    """Files of a scene's study by their path inside its folder: what is listed is what can be asked for."""
    root = Path(folder)
    if scene not in {entry.name for entry in root.glob("*") if entry.is_dir()}:
        raise Missing("scene", "there is no study of this scene yet", "run `umbrage study SCENE` first")
    home = root / scene
    return {
        path.relative_to(home).as_posix(): path
        for path in sorted(home.rglob("*"))
        if path.is_file() and not path.is_symlink() and path.suffix in KINDS
    }


@router.get("/{scene}", summary="Files of a study", responses={404: {"description": "There is no study of this scene"}})
async def study(hub: TheHub, scene: str = PathField(max_length=100)) -> Response:
    """Charts, tables and raw results of a scene's study."""
    found = await hub.call(_files, hub.settings.study, scene)
    return Json(
        [
            {
                "name": name,
                "kind": KINDS[path.suffix],
                "bytes": path.stat().st_size,
                "url": f"/api/study/{scene}/{name}",
            }
            for name, path in found.items()
        ]
    )


@router.get(
    "/{scene}/{name:path}",
    summary="A file of a study",
    response_class=FileResponse,
    responses={404: {"description": "There is no such file"}},
)
async def file(hub: TheHub, scene: str = PathField(max_length=100), name: str = PathField(max_length=300)) -> Response:
    """One chart, table or raw result."""
    found = await hub.call(_files, hub.settings.study, scene)
    if name not in found:
        raise Missing("name", "the study has no such file", ", ".join(list(found)[:20]))
    return FileResponse(found[name], headers={"Cache-Control": "no-cache"})
