"""What comments cite by a short name can be looked up: formulas and errata stand in docs/formulas.md."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
CITED = re.compile(r"[Ff]ormulas \(?([a-z]\d?)\)?(?![a-z])|\b(00[012]-\d+)\b")


def test_every_cited_formula_and_erratum_is_written_down() -> None:
    written = set(re.findall(r"^## (\S+)$", (ROOT / "docs/formulas.md").read_text(), re.MULTILINE))
    cited: dict[str, str] = {}
    for folder in ("renderer", "shaders"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in {".py", ".glsl", ".frag", ".vert"}:
                for formula, erratum in CITED.findall(path.read_text()):
                    cited[formula or erratum] = str(path.relative_to(ROOT))
    assert {"b1", "i", "000-1", "000-2"} <= set(cited), "the search finds what is known to be cited"
    assert {name: path for name, path in cited.items() if name not in written} == {}
