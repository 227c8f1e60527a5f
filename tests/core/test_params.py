"""Declared parameters: what is refused and how it is said, what becomes of them in GLSL and in a cache key."""

from __future__ import annotations

import json
import math
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field, model_validator

from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import (
    Colour,
    Model,
    Vector2,
    Vector3,
    bake_arguments,
    defines,
    glsl_type,
    merge,
    param,
    radians_of,
    set_path,
    uniform_declarations,
    uniforms,
    union_members,
    validate,
)


class Soft(Model):
    """A shadow with several kinds of parameter."""

    kind: Literal["soft"] = "soft"
    width: float = param(2.0, label="Width", help="Width of the edge.", unit="deg", ge=0, le=90)
    taps: int = param(4, label="Taps", help="Samples.", cost="build", ge=1, le=64)
    mode: Literal["box", "half-cosine"] = param("box", label="Mode", help="Shape.", cost="build")
    shape: Literal["near", "far"] = param("far", label="Shape", help="Which.")
    hard: bool = param(False, label="Hard", help="No edge.")
    tint: Colour = param((0.2, 0.4, 0.6), label="Tint", help="Colour.", cost="build")
    angles: Vector2 = param((10.0, 180.0), label="Angles", help="Two directions.", unit="deg")
    size: Literal[64, 128] = param(128, label="Size", help="Of the map.", cost="bake", unit="px")


class Sharp(Model):
    """A sibling one of whose parameters is called as the other's kind."""

    kind: Literal["sharp"] = "sharp"
    soft: float = param(1.0, label="Soft", help="Softness.", gt=0, lt=2)
    note: str = param("", label="Note", help="Words.", max_length=5, pattern="^[a-z]*$")


class Inner(Model):
    """A nested model."""

    at: Vector3 = param((0.0, 0.0, 1.0), label="At", help="A point.", unit="m")


class Whole(Model):
    """A document with a union, a nested model and an optional value."""

    shadow: Annotated[Soft | Sharp, Field(discriminator="kind")] = param(Soft(), label="Shadow", help="Which.")
    inner: Inner = param(Inner(), label="Inner", help="Nested.", cost="bake")
    limit: float | None = param(None, label="Limit", help="If any.")
    first: int = param(0, label="First", help="Lower end.")
    last: int = param(9, label="Last", help="Upper end.")

    @model_validator(mode="after")
    def _ordered(self) -> Whole:
        if self.first > self.last:
            raise ValueError("first must not exceed last")
        return self


WIDTH = "at least 0, at most 90 deg"


def refusals(document: Any) -> list[tuple[str, str, str]]:
    with pytest.raises(InvalidDocument) as refused:
        validate(Whole, document)
    json.dumps([error.as_dict() for error in refused.value.errors], ensure_ascii=False).encode()
    return [(error.field, error.message, error.allowed) for error in refused.value.errors]


@pytest.mark.parametrize(("document", "field", "message", "allowed"), [
    ({"shadow": {"kind": "soft", "width": math.nan}}, "shadow.width", "must be a finite number", WIDTH),
    ({"shadow": {"kind": "soft", "width": math.inf}}, "shadow.width", "must be a finite number", WIDTH),
    ({"shadow": {"kind": "soft", "width": 91}}, "shadow.width", "is too large", WIDTH),
    ({"shadow": {"kind": "soft", "width": "12"}}, "shadow.width", "must be a number", WIDTH),
    ({"shadow": {"kind": "soft", "width": True}}, "shadow.width", "must be a number", WIDTH),
    ({"shadow": {"kind": "soft", "width": None}}, "shadow.width", "must be a number", WIDTH),
    ({"shadow": {"kind": "soft", "taps": 2.5}}, "shadow.taps", "must be a whole number", "at least 1, at most 64"),
    ({"shadow": {"kind": "soft", "taps": True}}, "shadow.taps", "must be a whole number", "at least 1, at most 64"),
    ({"shadow": {"kind": "soft", "taps": 10**400}}, "shadow.taps", "is too large", "at least 1, at most 64"),
    ({"shadow": {"kind": "soft", "hard": 1}}, "shadow.hard", "must be true or false", ""),
    ({"shadow": {"kind": "soft", "mode": "round"}}, "shadow.mode", "is none of the choices", "box, half-cosine"),
    ({"shadow": {"kind": "soft", "size": True}}, "shadow.size", "is none of the choices", "64, 128"),
    ({"shadow": {"kind": "soft", "tint": [0, 0, 1.5]}}, "shadow.tint.2", "is too large", "at most 1"),
    ({"shadow": {"kind": "soft", "tint": [0, 0]}}, "shadow.tint.2", "is required", ""),
    ({"shadow": {"kind": "soft", "tint": [0, 0, 0, 0]}}, "shadow.tint", "has too many values", "at most 3"),
    ({"shadow": {"kind": "soft", "tint": ["0", 0, 0]}}, "shadow.tint.0", "must be a number", ""),
    ({"shadow": {"kind": "soft", "tint": "red"}}, "shadow.tint", "must be a list", ""),
    ({"shadow": {"kind": "sharp", "soft": 0}}, "shadow.soft", "is too small", "more than 0, less than 2"),
    ({"shadow": {"kind": "sharp", "note": "abcdef"}}, "shadow.note", "is too long", "at most 5"),
    ({"shadow": {"kind": "sharp", "note": "A"}}, "shadow.note", "is not written as it must be", "^[a-z]*$"),
    ({"shadow": {"kind": "sharp", "note": 5}}, "shadow.note", "must be text", ""),
    ({"shadow": {"kind": "sharp", "width": 1}}, "shadow.width", "is not a parameter", "kind, soft, note"),
    ({"shadow": {"kind": "round"}}, "shadow.kind", "is none of the kinds", "soft, sharp"),
    ({"shadow": {"kind": [1]}}, "shadow.kind", "is none of the kinds", "soft, sharp"),
    ({"shadow": {}}, "shadow.kind", "is required", "soft, sharp"),
    ({"shadow": 5}, "shadow", "must be an object", ""),
    ({"inner": {"at": [0, 0, math.nan]}}, "inner.at.2", "must be a finite number", ""),
    ({"inner": {"soft": 1}}, "inner.soft", "is not a parameter", "at"),
    ({"limit": "x"}, "limit", "must be a number", ""),
    ({"first": 10}, "", "first must not exceed last", ""),
    ({"nothing": 1}, "nothing", "is not a parameter", "shadow, inner, limit, first, last"),
    ([], "", "must be an object", ""),
    (None, "", "must be an object", ""),
    ("{}", "", "must be an object", ""),
])
def test_a_refusal_names_the_field_and_what_is_allowed(document: Any, field: str, message: str, allowed: str) -> None:
    assert refusals(document) == [(field, message, allowed)]


def test_every_mistake_is_named_at_once() -> None:
    found = refusals({"shadow": {"kind": "soft", "width": -1, "taps": 0}, "limit": math.inf})
    assert [field for field, _, _ in found] == ["shadow.width", "shadow.taps", "limit"]


def test_a_sender_gets_back_no_flood_of_his_own() -> None:
    """Ten thousand unknown fields, one of a megabyte, one that is no text, and a long kind."""
    found = refusals({f"f{index}": 1 for index in range(10_000)} | {"x" * 1_000_000: 1})
    assert len(found) == 20
    (field, message, allowed), = refusals({"shadow": {"kind": "y" * 1_000_000}})
    assert (field, message, allowed) == ("shadow.kind", "is none of the kinds", "soft, sharp")
    assert all(len(field) < 100 for field, _, _ in refusals({"x" * 1_000_000: 1}))
    assert refusals({"shadow": {"kind": "sharp", "note": "\ud800"}})[0][0] == "shadow.note"
    assert refusals({"\ud800": 1})[0][1] == "must be text"


def test_what_is_right_is_accepted() -> None:
    state = validate(Whole, json.loads('{"shadow": {"kind": "soft", "width": 3, "tint": [1, 0, 0.5]}, "limit": 4}'))
    assert state.shadow == Soft(width=3.0, tint=(1.0, 0.0, 0.5))
    assert state.limit == 4.0
    assert validate(Whole, json.loads(state.model_dump_json())) == state


def test_an_input_error_raised_inside_a_validator_becomes_a_refusal() -> None:
    class Checked(Model):
        """A model that checks one field against the world."""

        @model_validator(mode="before")
        @classmethod
        def _zone(cls, data: Any) -> Any:
            raise InputError("sun.time_zone", "there is no such time zone", "names as Europe/Paris")

    with pytest.raises(InvalidDocument, match=r"sun\.time_zone: there is no such time zone"):
        validate(Checked, {})


def test_uniforms_are_declared_and_uploaded_alike() -> None:
    declared = uniform_declarations(Soft, "shadow")
    assert declared.splitlines() == [
        "uniform float shadow_width; // rad",
        "uniform int shadow_shape;",
        "const int shadow_shape_near = 0;",
        "const int shadow_shape_far = 1;",
        "uniform bool shadow_hard;",
        "uniform vec2 shadow_angles; // rad",
    ]
    values = uniforms(Soft(), "shadow")
    assert values == {"shadow_width": math.radians(2), "shadow_shape": 1, "shadow_hard": False,
                      "shadow_angles": (math.radians(10), math.pi)}
    assert all(f" {name};" in declared for name in values)


def test_defines_are_glsl_text() -> None:
    assert defines(Soft(taps=0 + 8, mode="half-cosine"), "shadow") == {
        "SHADOW_TAPS": "8", "SHADOW_MODE_BOX": "0", "SHADOW_MODE_HALF_COSINE": "1", "SHADOW_MODE": "1",
        "SHADOW_TINT": "vec3(0.2, 0.4, 0.6)"}


def test_bake_arguments_hold_what_a_bake_depends_on_and_no_more() -> None:
    assert bake_arguments(Soft(width=5.0)) == {"kind": "soft", "size": 128}
    assert bake_arguments(Whole()) == {"inner": {"at": [0.0, 0.0, 1.0]}}


def test_what_has_no_glsl_type_has_no_uniform() -> None:
    assert [glsl_type(kind) for kind in (float, int, bool, Vector2, Vector3, Colour, Literal["a"])] == [
        "float", "int", "bool", "vec2", "vec3", "vec3", "int"]
    assert [glsl_type(kind) for kind in (str, Inner, float | None)] == [None, None, None]
    assert uniforms(Sharp(), "shadow") == {"shadow_soft": 1.0}


def test_angles_are_degrees_outside_and_radians_inside() -> None:
    assert radians_of(Soft(width=90.0), "width") == pytest.approx(math.pi / 2)


def test_the_schema_carries_all_that_a_control_needs() -> None:
    width = Soft.model_json_schema()["properties"]["width"]
    assert width == {"default": 2.0, "description": "Width of the edge.", "maximum": 90, "minimum": 0, "title": "Width",
                     "type": "number", "umbrage": {"cost": "live", "unit": "deg"}}


def test_union_members() -> None:
    assert union_members(Whole.model_fields["shadow"].annotation) == {"soft": Soft, "sharp": Sharp}


def test_set_path_copies_and_starts_a_union_afresh() -> None:
    document = {"shadow": {"kind": "soft", "width": 3}, "inner": {}}
    assert set_path(document, "shadow.width", 4) == {"shadow": {"kind": "soft", "width": 4}, "inner": {}}
    assert set_path(document, "shadow.kind", "sharp") == {"shadow": {"kind": "sharp"}, "inner": {}}
    assert set_path(document, "shadow.kind", "soft") == document
    assert set_path(document, "camera.target", [1]) == document | {"camera": {"target": [1]}}
    assert document == {"shadow": {"kind": "soft", "width": 3}, "inner": {}}


@pytest.mark.parametrize("path", ["", ".", "shadow.", ".kind", "shadow..kind", "shadow.width.x"])
def test_set_path_refuses_what_is_no_path(path: str) -> None:
    with pytest.raises(InputError) as refused:
        set_path({"shadow": {"width": 3}}, path, 1)
    assert refused.value.field == path


def test_merge_follows_rfc_7396_but_for_kinds() -> None:
    document = {"shadow": {"kind": "soft", "width": 3}, "view": {"a": 1}, "list": [1, 2]}
    assert merge(document, {"shadow": {"width": 4}})["shadow"] == {"kind": "soft", "width": 4}
    assert merge(document, {"shadow": {"kind": "soft", "taps": 2}})["shadow"] == {"kind": "soft", "width": 3, "taps": 2}
    assert merge(document, {"shadow": {"kind": "sharp", "soft": 1}})["shadow"] == {"kind": "sharp", "soft": 1}
    assert merge(document, {"view": None}) == {"shadow": document["shadow"], "list": [1, 2]}
    assert merge(document, {"new": {"a": None, "b": {"c": None}}})["new"] == {"b": {}}
    assert merge(document, {"list": [3]})["list"] == [3]
    assert merge(document, {"list": {"x": 1}})["list"] == {"x": 1}
    assert document == {"shadow": {"kind": "soft", "width": 3}, "view": {"a": 1}, "list": [1, 2]}


def test_set_path_reaches_items_of_lists() -> None:
    document = {"things": [{"kind": "ball", "radius": 1}, {"kind": "box"}]}
    assert set_path(document, "things.0.radius", 2)["things"] == [{"kind": "ball", "radius": 2}, {"kind": "box"}]
    assert set_path(document, "things.0.kind", "box")["things"][0] == {"kind": "box"}
    assert set_path(document, "things.1", {"kind": "cup"})["things"][1] == {"kind": "cup"}
    assert document["things"][0]["radius"] == 1
    for path in ("things.2.radius", "things.first.radius", "things.-1"):
        with pytest.raises(InputError, match="no item of its list"):
            set_path(document, path, 1)
