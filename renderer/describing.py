"""A scene's slots and techniques as documents, for the page and the command line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from renderer.core.registry import techniques
from renderer.core.technique import Phenomenon, Technique


def listed(found: Phenomenon) -> dict[str, Any]:
    """Name, title, help, presets and combinations of a scene."""
    presets = [
        {"name": name, "title": preset.title, "help": preset.help, "group": preset.group}
        for name, preset in found.presets.items()
    ]
    combinations = [
        {"name": name, "title": entry.title, "help": entry.help} for name, entry in found.combinations.items()
    ]
    return {
        "name": found.name,
        "title": found.title,
        "help": found.help,
        "presets": presets,
        "combinations": combinations,
    }


def described(found: Phenomenon, documents: Mapping[str, dict[str, Any]], version: tuple[int, int]) -> dict[str, Any]:
    """Schema, defaults, presets, combinations and slots of a scene.

    Args:
        found: the phenomenon.
        documents: whole state of each preset.
        version: of the OpenGL at hand.
    """
    presets = {
        name: {"title": preset.title, "help": preset.help, "group": preset.group, "document": documents[name]}
        for name, preset in found.presets.items()
    }
    return {
        "name": found.name,
        "title": found.title,
        "help": found.help,
        "schema": found.state.model_json_schema(),
        "defaults": found.state().model_dump(mode="json"),
        "presets": presets,
        "combinations": {
            name: {"title": entry.title, "help": entry.help, "patch": entry.patch}
            for name, entry in found.combinations.items()
        },
        "slots": slots_of(found, version),
    }


def slots_of(found: Phenomenon, version: tuple[int, int]) -> list[dict[str, Any]]:
    """Every slot of a phenomenon with its techniques.

    Args:
        found: the phenomenon.
        version: of the OpenGL at hand; a technique that needs a later one is not available, with the reason.
    """
    return [
        {
            "name": slot.name,
            "title": slot.title,
            "help": slot.help,
            "contract": slot.contract,
            "default": slot.default,
            "techniques": [
                _technique(kind, technique, version) for kind, technique in techniques(found.name, slot.name).items()
            ],
        }
        for slot in found.slots
    ]


def _technique(kind: str, technique: type[Technique], version: tuple[int, int]) -> dict[str, Any]:
    needed = technique.requires
    missing = version < needed
    why = f"requires OpenGL {needed[0]}.{needed[1]}; this machine has {version[0]}.{version[1]}" if missing else ""
    return {
        "kind": kind,
        "title": technique.title,
        "caption": technique.caption,
        "paper": technique.paper,
        "available": not missing,
        "why_not": why,
    }
