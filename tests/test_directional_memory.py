"""The study of memory: what it takes from a share of the layers holds for all of them."""

from __future__ import annotations

import numpy as np
import pytest

from renderer import directional_code_study as code_study
from renderer import directional_memory as study
from renderer.directional.casting import Caster
from renderer.directional.cloud import bake_cloud
from renderer.directional.subject import knot
from renderer.directional.subjects import bake_subject


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(knot, "ALONG", 300)
    monkeypatch.setattr(knot, "AROUND", 24)
    monkeypatch.setattr(study, "SUBJECTS", ("knot",))
    monkeypatch.setattr(study, "WHOLE", ((32, 33, 5000), (32, 33, 20_000)))
    monkeypatch.setattr(study, "TEXELS", (16, 32))
    monkeypatch.setattr(study, "DIRECTIONS", (33,))
    monkeypatch.setattr(study, "RAYS", 100_000)
    monkeypatch.setattr(code_study, "SIZES", ((32, 33),))


@pytest.mark.usefixtures("small")
def test_a_share_of_the_layers_tells_the_size_of_all() -> None:
    whole = study.whole("knot", 32, 33, 20_000)
    subject = bake_subject({"kind": "knot"}, {}, lambda share, words: None)
    cloud = bake_cloud({"points": 20_000}, {"subject": subject}, lambda share, words: None)
    caster = Caster(subject, cloud)
    every = study.sampled(caster, 32, 33, 10**9)
    assert every["share"] == 1
    assert every["bytes"] == whole["bytes"]
    some = study.sampled(caster, 32, 33, 60 * 32 * 32)
    assert some["share"] == pytest.approx(60 / 198)
    assert some["bytes"] == pytest.approx(every["bytes"], rel=0.1)
    assert some["raw_ratio"] == pytest.approx(24 / some["bits"])


@pytest.mark.usefixtures("small")
def test_the_study_leaves_its_files(tmp_path) -> None:
    text = study.run(tmp_path, lambda share, words: None)
    assert all((tmp_path / name).stat().st_size > 0 for name in study.FILES)
    rows = [line for line in text.splitlines() if line.startswith("| knot")]
    assert len(rows) == 2 + 2 + 4
    used = float(next(line for line in text.splitlines() if "in use |" in line and "Zstandard" in line).split("|")[2])
    # The same steps, but for the planes of zeros that are left out.
    same = float(next(line for line in text.splitlines() if "by zlib" in line).split("|")[2])
    assert used == pytest.approx(same, rel=0.1)
    errors = [float(row.split("|")[3].split()[0]) for row in rows[-4:]]
    # Four bits more are a sixteenth of the error, but for what single precision keeps of the places themselves.
    assert np.array(errors[:2]) / errors[1] == pytest.approx([4, 1], rel=0.1)
    assert errors[0] / errors[3] > 200
