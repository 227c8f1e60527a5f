"""A page that lists the HTTP interface; drawn here, since the usual ones load their scripts from another host."""

from __future__ import annotations

import json
from html import escape
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import HTMLResponse

router = APIRouter()
STYLE = """
:root { color-scheme: dark light; font: 16px/1.5 system-ui, sans-serif }
body { max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
section { border-top: 1px solid #8886; padding: 1rem 0 } h2 { font-size: 1.05rem; margin: 0 }
code, pre { font: 0.9em/1.45 ui-monospace, monospace } pre { overflow: auto; background: #8882; padding: .7rem }
table { border-collapse: collapse } td, th { text-align: left; padding: .15rem 1rem .15rem 0; vertical-align: top }
.method { display: inline-block; min-width: 4rem; font-weight: 700 }
"""


def _type(schema: dict[str, Any]) -> str:
    if "$ref" in schema:
        return str(schema["$ref"]).rsplit("/", 1)[-1]
    if "anyOf" in schema:
        return " or ".join(_type(option) for option in schema["anyOf"])
    if "enum" in schema or "const" in schema:
        return " | ".join(json.dumps(value) for value in schema.get("enum", [schema.get("const")]))
    bounds = [f"{word} {schema[key]:g}" for key, word in (("minimum", "≥"), ("maximum", "≤")) if key in schema]
    return " ".join([str(schema.get("type", "any")), *bounds])


def _rows(entries: list[tuple[str, str, str]]) -> str:
    rows = "".join(
        f"<tr><td><code>{escape(a)}</code></td><td>{escape(b)}</td><td>{escape(c)}</td></tr>" for a, b, c in entries
    )
    return f"<table><tr><th>field</th><th>type</th><th></th></tr>{rows}</table>" if rows else ""


def _fields(api: dict[str, Any], operation: dict[str, Any]) -> list[tuple[str, str, str]]:
    fields = [(entry["name"], _type(entry.get("schema", {})), entry["in"]) for entry in operation.get("parameters", [])]
    for content in operation.get("requestBody", {}).get("content", {}).values():
        schema = content.get("schema", {})
        found = api.get("components", {}).get("schemas", {}).get(str(schema.get("$ref", "")).rsplit("/", 1)[-1], schema)
        fields += [
            (name, _type(field), field.get("description", "")) for name, field in found.get("properties", {}).items()
        ]
    return fields


def _section(api: dict[str, Any], path: str, method: str, operation: dict[str, Any]) -> str:
    answers = [
        f"{code}: {answer.get('description', '')} {' '.join(answer.get('content', {}))}"
        for code, answer in operation.get("responses", {}).items()
    ]
    return (
        f"<section><h2><span class=method>{escape(method.upper())}</span> <code>{escape(path)}</code> "
        f"{escape(operation.get('summary', ''))}</h2><p>{escape(operation.get('description', ''))}</p>"
        f"{_rows(_fields(api, operation))}<pre>{escape(chr(10).join(answers))}</pre></section>"
    )


@router.get("/docs", include_in_schema=False)
async def docs(request: Request) -> HTMLResponse:
    """Every path of the HTTP interface with its fields and answers."""
    api = request.app.openapi()
    sections = "".join(
        _section(api, path, method, operation)
        for path, methods in api["paths"].items()
        for method, operation in methods.items()
    )
    return HTMLResponse(
        f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
        f"<title>{escape(api['info']['title'])}: HTTP interface</title><style>{STYLE}</style>"
        f"<main><h1>HTTP interface</h1>"
        f"<p>{escape(api['info']['description'])}</p><p>Machine-readable: <a href=/openapi.json>OpenAPI</a>, "
        f"<a href=/api/schema>message schema</a>.</p>{sections}</main></html>",
        headers={"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'"},
    )
