"""How warnings are told: one sentence a kind, what is missing in the picture first."""

from __future__ import annotations

from photon_splat.blender.told import MOST_ALIKE, names_in, told
from photon_splat.export.report import Report


def _missing(material: str, image: str) -> str:
    return (
        f"Material '{material}', node 'Image Texture': image '{image}': //textures/{image} "
        "cannot be read; shown in pink"
    )


def test_one_sentence_a_kind() -> None:
    images = [_missing(f"M{k}", f"wood.00{k}.png") for k in range(8)]
    triangles = [
        "Object 'A', 'B': triangles left out: 12 without area",
        "Object 'C': triangles left out: 1,003 without area",
    ]
    said = told([images[0], triangles[0], *images[1:], triangles[1], images[2]])
    assert len(said) == 2
    assert said[0].startswith(
        images[0] + "; likewise Material 'M1', node 'Image Texture' ('wood.001.png'); "
    )
    assert said[1] == triangles[0] + "; likewise Object 'C' (1,003)"
    for k in range(8):
        assert f"'M{k}'" in said[0]
        assert f"'wood.00{k}.png'" in said[0]


def test_what_differs_in_more_than_names_stays_apart() -> None:
    warnings = [
        "Material 'A', node 'X': Volume not supported; left out",
        "World 'A', node 'X': Volume not supported; left out",
    ]
    assert told(warnings) == warnings
    assert told(["The picture is noisy"] * 2) == ["The picture is noisy"]


def test_what_is_missing_comes_first_and_notes_last() -> None:
    note = (
        "Only Combined is denoised; the passes of light groups are not, so that their sum is "
        "noisier."
    )
    changed = "Light Path in a world is that of a diffuse ray, not supported otherwise"
    slivers = "Object 'A': triangles left out: 12 without area"
    missing = ["Not supported yet and left out, hair of: 'Cat'", _missing("M", "a.png")]
    assert told([slivers, note, changed, missing[1], missing[0]]) == [
        *missing,
        changed,
        note,
        slivers,
    ]


def test_very_many_are_counted() -> None:
    (said,) = told(_missing(f"M{k}", f"{k}.png") for k in range(MOST_ALIKE + 11))
    assert said.endswith(" and 10 more")
    assert len(names_in(said)) == 1 + 2 * (MOST_ALIKE + 1)


def test_names_with_quotes_in_them() -> None:
    assert names_in("Hair of objects is left out: 'It's one', 'Other'") == ["It's one", "Other"]


def test_bytes_that_are_no_text_can_be_shown() -> None:
    report = Report()
    report.warn("Material 'M': //\udcff.png cannot be read")
    report.warn("Odd: {}", "\ud800")
    assert report.messages() == ["Material 'M': //\\xff.png cannot be read", "Odd: '\\ud800'"]
