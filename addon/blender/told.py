"""How warnings are told: one sentence a kind, those first that change the picture most."""

from __future__ import annotations

import re
from collections.abc import Iterable

MOST_ALIKE = 50

_OWNED = re.compile(
    r"((?:Material|Object|Light|World|Camera)\b.*?'(?: and \d+ more)?): (.+)", re.DOTALL
)
_QUOTED = re.compile(r"'.+?'(?=[\s,:;.)]|$)")
_PATH = re.compile(r"(?<=: )[^:;]+(?= cannot be read)")
_NUMBER = re.compile(r"\d[\d,.]*")
_ORDER = (
    # Few, or none of the scene's things.
    (
        4,
        re.compile(
            r"camera samples were not finite|camera samples .* too bright|triangles left out: .* "
            r"without area"
        ),
    ),
    # What Blender shows and this does not.
    (0, re.compile(r"(?s)[Nn]ot supported.*left out")),
    # What else is not in the picture at all, or in pink.
    (
        1,
        re.compile(
            r"left out|cannot be read|in pink|no image|count(s|ed)? as not there|as empty|hits "
            r"nothing"
        ),
    ),
    # What is there and looks otherwise.
    (
        2,
        re.compile(
            r"not supported|taken as|read as|ignored|as usual|all the same|stands still|as a "
            r"bump|is used|are used"
        ),
    ),
)
_NOTE = 3


def told(warnings: Iterable[str]) -> list[str]:
    """The sentences, those of one kind made one that names all they name; what is missing in the
    picture first, notes last.
    """
    kinds: dict[str, list[str]] = {}
    for warning in warnings:
        alike = kinds.setdefault(_kind(warning), [])
        if warning not in alike:
            alike.append(warning)
    return sorted((_one_sentence(alike) for alike in kinds.values()), key=_rank)


def names_in(warning: str) -> list[str]:
    """What stands in quotes, in its order."""
    return list(dict.fromkeys(quoted[1:-1] for quoted in _QUOTED.findall(warning)))


def _rank(sentence: str) -> int:
    return next((rank for rank, words in _ORDER if words.search(sentence)), _NOTE)


def _parts(warning: str) -> tuple[str, str]:
    """Whom a warning is about, or "", and what it says."""
    owned = _OWNED.fullmatch(warning)
    return (owned[1], owned[2]) if owned else ("", warning)


def _kind(warning: str) -> str:
    owner, said = _parts(warning)
    if not owner:
        return warning
    said = _NUMBER.sub("#", _PATH.sub("{}", _QUOTED.sub("{}", said)))
    return f"{owner.split()[0]}: {said}"


def _one_sentence(alike: list[str]) -> str:
    first, *others = alike
    if not others:
        return first
    said = _parts(first)[1]
    named = []
    for other in others[:MOST_ALIKE]:
        owner, its = _parts(other)
        details = (
            [*_QUOTED.findall(its), *_NUMBER.findall(_PATH.sub("", _QUOTED.sub("", its)))]
            if its != said
            else []
        )
        named.append(f"{owner} ({', '.join(details)})" if details else owner)
    more = f" and {len(others) - MOST_ALIKE} more" if len(others) > MOST_ALIKE else ""
    return f"{first.rstrip('.')}; likewise {'; '.join(named)}{more}"
