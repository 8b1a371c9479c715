"""Merges and sorts warnings for the user: one sentence per kind, first those that change the
picture most.
"""

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
    # Nothing, or little, of the scene is rendered.
    (
        4,
        re.compile(
            r"camera samples were not finite|camera samples .* too bright|triangles left out: .* "
            r"without area"
        ),
    ),
    # Features of Blender that are not supported.
    (0, re.compile(r"(?s)[Nn]ot supported.*left out")),
    # Other things that are missing from the picture, or pink.
    (
        1,
        re.compile(
            r"left out|cannot be read|in pink|no image|count(s|ed)? as not there|as empty|hits "
            r"nothing"
        ),
    ),
    # Things that are rendered but look different.
    (
        2,
        re.compile(
            r"not supported|taken as|read as|ignored|as usual|all the same|stand still|keep their "
            r"shape|as a bump|is used|are used|not displaced|which stay"
        ),
    ),
)
_NOTE = 3


def told(warnings: Iterable[str]) -> list[str]:
    """One sentence per kind of warning, which names all that the kind names. Sentences about
    missing things come first, notes last.
    """
    kinds: dict[str, list[str]] = {}
    for warning in warnings:
        alike = kinds.setdefault(_kind(warning), [])
        if warning not in alike:
            alike.append(warning)
    return sorted((_one_sentence(alike) for alike in kinds.values()), key=_rank)


def names_in(warning: str) -> list[str]:
    """The names in quotes, in their order."""
    return list(dict.fromkeys(quoted[1:-1] for quoted in _QUOTED.findall(warning)))


def _rank(sentence: str) -> int:
    return next((rank for rank, words in _ORDER if words.search(sentence)), _NOTE)


def _parts(warning: str) -> tuple[str, str]:
    """Who a warning is about ("": nobody), and what it says."""
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
