"""A folder with what a scheduler needs of a job."""

from __future__ import annotations

import contextlib
from pathlib import Path

from . import flamenco, openjd, slurm
from .job import FarmError, Job, System

MAKERS = {System.OPENJD: openjd.files, System.FLAMENCO: flamenco.files, System.SLURM: slurm.files}
NEXT = {
    System.OPENJD: "openjd run '{folder}/template.json' -p 'file://{folder}/parameters.json'",
    System.FLAMENCO: "copy '{folder}/{script}' to the Manager's folder scripts, then: curl -H "
    "'Content-Type: application/json' --data '@{folder}/job.json' "
    "http://MANAGER:8080/api/v3/jobs",
    System.SLURM: "'{folder}/submit.sh'",
}
"""What to do with it."""


def write_bundle(job: Job, system: System, folder: Path) -> str:
    """Makes the folder, or files in it anew; returns what to do next. Raises FarmError."""
    made = MAKERS[system](job)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in made.items():
            file = folder / name
            file.write_text(text, encoding="utf-8", newline="\n")
            if name.endswith(".sh"):
                with contextlib.suppress(OSError):
                    file.chmod(file.stat().st_mode | 0o111)
    except OSError as error:
        raise FarmError(f"{folder} cannot be written: {error.strerror or error}") from error
    script = next((name for name in made if name.endswith(".js")), "")
    return NEXT[system].format(folder=folder, script=script)
