"""Results of the study: charts and raw files of each scene, as its command left them, and what they say."""

from __future__ import annotations

import json
import mimetypes
from pathlib import Path
from typing import Any

from fastapi import APIRouter
from fastapi import Path as PathField
from starlette.responses import FileResponse, Response

from server.facade import RenderSession
from server.hub import TheHub
from server.problems import Json, Missing, missing
from server.settings import ROOT

router = APIRouter(prefix="/api/study", tags=["study"])
KINDS = {
    ".json": "data",
    ".jsonl": "raw",
    ".csv": "table",
    ".md": "table",
    ".png": "chart",
    ".svg": "chart",
    ".jpg": "picture",
}
KEPT = ROOT / "docs" / "study"
"""What the project's own study found, which is served where this server's left nothing newer."""

mimetypes.add_type("application/jsonl", ".jsonl")
mimetypes.add_type("text/markdown", ".md")
NONE = "there is no study of this scene yet"


def _files(folder: str, scene: str) -> dict[str, Path]:
    """Files of a scene's study by their path inside its folder: what is listed is what can be asked for."""
    homes = [
        entry for root in (KEPT, Path(folder)) for entry in root.glob("*") if entry.is_dir() and entry.name == scene
    ]
    if not homes:
        raise Missing("scene", NONE, "run `umbrage study SCENE` first")
    found: dict[str, Path] = {}
    for home in homes:
        for path in home.rglob("*"):
            name = path.relative_to(home).as_posix()
            if path.suffix not in KINDS or path.is_symlink() or not path.is_file():
                continue
            if name not in found or path.stat().st_mtime > found[name].stat().st_mtime:
                found[name] = path
    return dict(sorted(found.items()))


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
    "/{scene}/failures", summary="Where techniques fail", responses={404: {"description": "There is no such scene"}}
)
async def failures(hub: TheHub, scene: str = PathField(max_length=100)) -> Response:
    """The catalogue: each case with its state, the technique that fails, the one that survives, and their numbers."""
    with missing():
        return Json(await hub.work(_failures, hub.session, hub.settings.study, scene))


def _failures(session: RenderSession, folder: str, scene: str) -> list[dict[str, Any]]:
    from renderer import failing  # charts take a second to import, which no other request should pay

    cases = failing.failures(scene)
    files = _files(folder, scene) if cases else {}
    measured = {one["name"]: one for one in _read(files.get("failures/results.json"), [])}
    return [
        {
            **failing.document(case, measured.get(name)),
            **failing.opened(session, scene, case),
            "picture": f"/api/study/{scene}/{picture}" if picture in files else None,
        }
        for name, case in cases.items()
        for picture in [f"failures/{failing.picture_name(case)}"]
    ]


@router.get(
    "/{scene}/techniques",
    summary="Cost and error of every technique",
    responses={404: {"description": "There is no study of this scene"}},
)
async def techniques(hub: TheHub, scene: str = PathField(max_length=100)) -> Response:
    """Of each slot's techniques, everything else at its default: frame time, yardsticks, median and worst error."""
    return Json(await hub.call(_techniques, hub.settings.study, scene))


def _techniques(folder: str, scene: str) -> Any:
    return _read(_files(folder, scene).get("techniques/facts.json"), {"slots": {}})


def _read(path: Path | None, otherwise: Any) -> Any:
    return otherwise if path is None else json.loads(path.read_text(encoding="utf-8"))


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
